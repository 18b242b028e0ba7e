//! The list of films, and the outcome of an import, as text.

use spineline::anatomy::ImageSide;
use spineline::measure::{LengthScale, Spacing};
use spineline::warning::counted;
use spineline_marking::View;
use spineline_report::document::{Column, Table};
use spineline_report::terminal::{self, Lines};

use super::candidates::{Candidate, Candidates, Seen};
use super::resolve::ResolvedFilm;
use crate::run::outputs::width;

/// Lengths of a film without a spacing.
const SQUARE_PIXELS: &str = "pixels (taken as square)";

/// Everything that was found, with numbers to choose by.
pub fn list(candidates: &Candidates) -> Lines {
    let mut text = Lines::default();
    let words = ["Kind", "Size", "View", "Patient's left", "Lengths", "File"].map(Column::words);
    let columns = [Column::numbers("Film")].into_iter().chain(words).collect();
    let mut table = Table::new("", columns);
    for (index, film) in candidates.films.iter().enumerate() {
        let number = (index + 1).to_string();
        let place = film.found.place.to_string();
        match &film.seen {
            Ok(seen) => table.row(vec![
                number,
                kind(film, seen),
                format!("{} × {}", seen.columns, seen.rows),
                view(seen).to_owned(),
                side(seen.view().patient_left).to_owned(),
                lengths(seen.spacing().spacing.as_ref()),
                place,
            ]),
            Err(_) => {
                let kind = film.found.kind.to_string();
                let blank = || "-".to_owned();
                table.row(vec![number, kind, blank(), blank(), blank(), blank(), place]);
            }
        }
    }
    if candidates.films.is_empty() {
        text.line("No film was found.");
    } else {
        text.text(&terminal::table(&table, width()));
    }
    for (note, films) in shared_notes(candidates) {
        let note = format!("! {}: {note}", numbered(&films));
        text.text(&terminal::paragraph(&note, width(), "  "));
    }
    add_passed_over(&mut text, candidates);
    text
}

/// One film in one line, to choose from.
pub fn line(candidates: &Candidates, index: usize) -> String {
    let film = &candidates.films[index];
    let what = film.seen.as_ref().map_or_else(
        |_| String::new(),
        |seen| {
            format!("{}, {} × {}, {} view, ", kind(film, seen), seen.columns, seen.rows, view(seen))
        },
    );
    format!("{}: {what}{}", index + 1, film.found.place)
}

fn kind(film: &Candidate, seen: &Seen) -> String {
    let phantom = if seen.tags.is_phantom { " (phantom)" } else { "" };
    match &seen.tags.modality {
        Some(modality) => format!("{} {modality}{phantom}", film.found.kind),
        None => format!("{}{phantom}", film.found.kind),
    }
}

fn view(seen: &Seen) -> &'static str {
    match seen.view().view {
        Some(View::Frontal) => "frontal",
        Some(View::Lateral) => "lateral",
        None => "not stated",
    }
}

const fn side(side: Option<ImageSide>) -> &'static str {
    match side {
        Some(ImageSide::Left) => "image left",
        Some(ImageSide::Right) => "image right",
        None => "not stated",
    }
}

fn lengths(spacing: Option<&Spacing>) -> String {
    spacing.map_or_else(
        || SQUARE_PIXELS.to_owned(),
        |s| format!("{} × {} {}", round(s.column_mm), round(s.row_mm), s.plane.unit()),
    )
}

fn round(mm: f64) -> f64 {
    (mm * 1e4).round() / 1e4
}

/// Every note once, with the numbers of the films that it is about, in the order of the first of them.
fn shared_notes(candidates: &Candidates) -> Vec<(String, Vec<usize>)> {
    let mut shared: Vec<(String, Vec<usize>)> = Vec::new();
    for (index, film) in candidates.films.iter().enumerate() {
        for note in notes(film) {
            match shared.iter_mut().find(|(other, _)| *other == note) {
                Some((_, films)) => films.push(index + 1),
                None => shared.push((note, vec![index + 1])),
            }
        }
    }
    shared
}

/// Numbers of films in words: `film 3`, `films 1-4, 7`.
fn numbered(films: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &film in films {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == film => *last = film,
            _ => runs.push((film, film)),
        }
    }
    let run = |&(first, last): &(usize, usize)| match last - first {
        0 => first.to_string(),
        _ => format!("{first}-{last}"),
    };
    let word = if films.len() == 1 { "film" } else { "films" };
    format!("{word} {}", runs.iter().map(run).collect::<Vec<_>>().join(", "))
}

/// Remarks on a film, or why it cannot be used.
fn notes(film: &Candidate) -> Vec<String> {
    match &film.seen {
        Err(why) => vec![why.clone()],
        Ok(seen) => {
            let remarks = seen.remarks.iter().map(ToString::to_string);
            let spacing = seen.spacing().remarks;
            remarks.chain(spacing.iter().map(ToString::to_string)).collect()
        }
    }
}

/// Adds the files that are not films: the first few by name, the rest by number.
fn add_passed_over(text: &mut Lines, candidates: &Candidates) {
    const SHOWN: usize = 8;
    let all = &candidates.survey.passed_over;
    for passed in all.iter().take(SHOWN) {
        text.line(format!("  skipped: {}: {}", passed.place, passed.reason));
    }
    if all.len() > SHOWN {
        text.line(format!("  skipped: {} more", all.len() - SHOWN));
    }
}

/// The content of the new case.
pub fn outcome(films: &[ResolvedFilm], folder: &std::path::Path, marked: usize) -> Lines {
    let mut text = Lines::default();
    let heads = ["Film", "Size", "Patient's left", "Lengths"];
    let mut table = Table::new("", heads.map(Column::words).to_vec());
    for film in films {
        let image = &film.image;
        let scale = image.spacing.as_ref().map_or_else(
            || SQUARE_PIXELS.to_owned(),
            |spacing| LengthScale::of(spacing).to_string(),
        );
        let side = side(Some(image.patient_left));
        let left = match film.view.posture() {
            Some(_) => side.to_owned(),
            None => format!("front: {side}"),
        };
        let size = format!("{} × {}", image.columns, image.rows);
        table.row(vec![film.view.to_string(), size, left, scale]);
    }
    text.text(&terminal::table(&table, width()));
    for film in films {
        for note in &film.notes {
            let note = format!("! {} film: {note}", film.view);
            text.text(&terminal::paragraph(&note, width(), "  "));
        }
    }
    let case = folder.join("case.json");
    let films_words = counted(films.len(), "film");
    text.line("").line(format!("Wrote {} and {films_words}.", case.display()));
    if films.iter().all(|film| film.is_phantom) {
        text.line("All films are phantoms: the case is marked SYNTHETIC.");
    }
    if marked == 0 {
        text.line("No landmarks yet: place them in the browser app, or add them with --landmarks.");
    } else {
        text.line(format!("Try: spineline check {}", case.display()));
    }
    text
}
