//! `spineline import`: films from folders and archives as a case.

mod aasce;
mod args;
mod assignment;
mod candidates;
mod dialogue;
mod exposure;
mod landmarks;
mod midlines;
mod pictures;
mod resolve;
mod text;
mod write;

pub use args::{EXAMPLES, ImportArgs};

use spineline::anatomy::{FilmView, ImageSide};
use spineline_films::intake::Place;
use spineline_films::{FilmDoubt, Stated, film_doubts};

use candidates::{Candidates, ChosenFilm};
use pictures::Pictures;
use resolve::{Question, ResolvedFilm, check_films, resolve, same_identifier};
use write::Marks;

use crate::run::failure::{Ending, Failure};
use crate::run::messages::say;
use crate::run::outputs::print;

pub fn run(args: &ImportArgs) -> Result<Ending, Failure> {
    args.check_kind()?;
    if args.aasce {
        return aasce::run(args);
    }
    if args.midlines {
        return midlines::run(args);
    }
    let (Some(folder), Some(case_id), false) = (&args.out, &args.case_id, args.list) else {
        return print(text::list(&Candidates::find(args)?));
    };
    write::check_free(folder)?;
    args.check_answers()?;
    let candidates = Candidates::find(args)?;
    let mut chosen = chosen(args, &candidates)?;
    let ask = dialogue::possible();
    if ask && chosen.is_empty() {
        dialogue::choose_films(&candidates, &mut chosen)?;
    }
    if chosen.is_empty() {
        say(text::list(&candidates));
        return Err(Failure::usage(
            "which film shows which posture? Give their numbers, as in --film erect=1 --film left-bending=2",
        ));
    }
    note_other_files(args, &candidates);
    chosen.sort_unstable();
    let seen = chosen
        .iter()
        .map(|&(view, index)| Ok(ChosenFilm { view, index, seen: candidates.seen(index)? }))
        .collect::<Result<Vec<_>, Failure>>()?;
    check_films(&seen)?;
    args.check_chosen(&chosen.iter().map(|(view, _)| *view).collect::<Vec<_>>())?;
    let mut films = resolve_all(args, &seen, ask)?;
    if let Some(first) = films.first_mut() {
        first.notes.extend(same_identifier(&seen));
    }
    exposure::decide(args, &seen, &mut films)?;
    let landmarks = landmarks::read_onto(args, &films, &Pictures::of(&films, &candidates))?;
    let lateral = match films.iter().find(|film| film.view == FilmView::Lateral) {
        Some(film) => Some(film.lateral(landmarks::read_lateral(args, film)?)),
        None => None,
    };
    landmarks::check_all(&landmarks, lateral.as_ref())?;
    let marked = landmarks.len()
        + usize::from(lateral.as_ref().is_some_and(|film| !film.readings.is_empty()));
    landmarks::note_alike_observers(&landmarks, lateral.as_ref());
    let marks = Marks { frontal: landmarks, lateral };
    write::write(args, folder, case_id, &candidates, &films, &marks)?;
    print(text::outcome(&films, folder, marked))
}

/// Notes files that the command line names one by one as films and that are none: a shell gives an option the first file of a
/// pattern such as FOLDER/* only, and the others count as films.
fn note_other_files(args: &ImportArgs, candidates: &Candidates) {
    for passed in &candidates.survey.passed_over {
        if matches!(&passed.place, Place::File(path) if args.paths.contains(path)) {
            let (place, reason) = (&passed.place, &passed.reason);
            say(format!(
                "note: {place} is passed over as a film: {reason}; a file of landmarks needs its own --landmarks"
            ));
        }
    }
}

/// The films that the command line chooses.
fn chosen(args: &ImportArgs, candidates: &Candidates) -> Result<Vec<(FilmView, usize)>, Failure> {
    let mut chosen = Vec::new();
    if args.films().len() < args.film.len() {
        return Err(Failure::usage("--film gives one posture two films; a case holds one of each"));
    }
    for (posture, choice) in args.films() {
        chosen.push((FilmView::Frontal(posture), candidates.index(choice)?));
    }
    if let Some(choice) = &args.lateral {
        chosen.push((FilmView::Lateral, candidates.index(choice)?));
    }
    Ok(chosen)
}

/// Resolves every film; open questions are asked at the terminal, or listed with the options that answer them.
fn resolve_all(
    args: &ImportArgs,
    seen: &[ChosenFilm<'_>],
    ask: bool,
) -> Result<Vec<ResolvedFilm>, Failure> {
    let mut films = Vec::new();
    let mut open: Vec<Question> = Vec::new();
    let stated = |film: &ChosenFilm<'_>| {
        (film.view.to_string(), Stated::by_remarks(film.seen.tags.patient, &film.seen.remarks))
    };
    let doubts = film_doubts(&seen.iter().map(stated).collect::<Vec<_>>());
    for (chosen, doubts) in seen.iter().zip(&doubts) {
        match resolve(args, chosen, doubts, None)? {
            Ok(film) => films.push(film),
            Err(questions) if ask => {
                films.push(resolve_by_asking(args, chosen, doubts, &questions)?)
            }
            Err(questions) => open.extend(questions),
        }
    }
    if open.is_empty() {
        return Ok(films);
    }
    let what = format!("{} to answer before these films make a case", counted(open.len()));
    Err(open.iter().fold(Failure::usage(what), |failure, question| {
        failure.with_line(format!("  {question}")).with_line(format!("    {}", question.answer()))
    }))
}

fn resolve_by_asking(
    args: &ImportArgs,
    chosen: &ChosenFilm<'_>,
    doubts: &[FilmDoubt],
    questions: &[Question],
) -> Result<ResolvedFilm, Failure> {
    let mut side: Option<ImageSide> = None;
    for question in questions {
        side = dialogue::ask(question)?.or(side);
    }
    // Every contradiction was looked at and confirmed.
    let accepted = ImportArgs { accept: true, ..args.clone() };
    resolve(&accepted, chosen, doubts, side)?.map_err(|open| {
        Failure::internal(format!("{} still open after asking", counted(open.len())))
    })
}

fn counted(questions: usize) -> String {
    if questions == 1 { "one question is".to_owned() } else { format!("{questions} questions are") }
}

/// Examples, and the formats of landmarks.
pub fn long_help() -> String {
    format!("{EXAMPLES}\n\n{}", spineline_landmarks::LANDMARK_FORMATS)
}
