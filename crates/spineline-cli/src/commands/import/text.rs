//! The list of films, and the outcome of an import, as text.

use spineline::anatomy::{FilmView, ImageSide};
use spineline::measure::{LengthScale, Spacing};
use spineline::warning::counted;
use spineline_marking::View;
use spineline_report::document::Table;
use spineline_report::terminal::{self, Lines};

use super::candidates::{Candidate, Candidates, Seen};
use super::resolve::ResolvedFilm;
use crate::run::outputs::width;

/// Lengths of a film without a spacing.
const SQUARE_PIXELS: &str = "pixels (taken as square)";

/// Everything that was found, with numbers to choose by.
pub fn list(candidates: &Candidates) -> Lines {
    let mut text = Lines::default();
    let table = Table::of("", candidates.films.iter().enumerate(), |add| {
        add.numbers("Film", |(index, _)| (index + 1).to_string());
        add.words("Kind", |(_, film)| kind(film));
        add.words("Size", |(_, film)| seen(film, |seen| size(seen.columns, seen.rows)));
        add.words("View", |(_, film)| seen(film, |seen| view(seen).to_owned()));
        add.words("Patient's left", |(_, film)| {
            seen(film, |seen| side(seen.view().patient_left).to_owned())
        });
        add.words("Lengths", |(_, film)| {
            seen(film, |seen| lengths(seen.spacing().spacing.as_ref()))
        });
        add.words("File", |(_, film)| film.found.place.to_string());
    });
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
            let size = size(seen.columns, seen.rows);
            format!("{}, {size}, {} view, ", kind(film), view(seen))
        },
    );
    format!("{}: {what}{}", index + 1, film.found.place)
}

/// The cell of a readable film; `-` for any other.
fn seen(film: &Candidate, cell: impl Fn(&Seen) -> String) -> String {
    film.seen.as_ref().map_or_else(|_| "-".to_owned(), cell)
}

fn kind(film: &Candidate) -> String {
    let mut text = film.found.kind.to_string();
    if let Ok(Seen { tags, .. }) = &film.seen {
        text.extend(tags.modality.iter().map(|modality| format!(" {modality}")));
        text.push_str(if tags.is_phantom { " (phantom)" } else { "" });
    }
    text
}

fn size(columns: u32, rows: u32) -> String {
    format!("{columns} × {rows}")
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
    let table = Table::of("", films, |add| {
        add.words("Film", |film| film.view.to_string());
        add.words("Size", |film| size(film.image.columns, film.image.rows));
        add.words("Patient's left", |film| {
            let front = if film.view == FilmView::Lateral { "front: " } else { "" };
            format!("{front}{}", side(Some(film.image.patient_left)))
        });
        add.words("Lengths", |film| match &film.image.spacing {
            Some(spacing) => LengthScale::of(spacing).to_string(),
            None => SQUARE_PIXELS.to_owned(),
        });
    });
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
