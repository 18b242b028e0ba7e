//! The questions of an import, asked one by one at an interactive terminal.

use std::io::IsTerminal;

use dialoguer::{Confirm, Select};
use spineline::anatomy::{FilmView, ImageSide, Posture};
use spineline_marking::View;
use spineline_report::terminal::shown;

use super::candidates::Candidates;
use super::resolve::{About, Question, asked_side};
use super::text;
use crate::run::failure::Failure;
use crate::run::messages::say;

/// Whether a user can answer.
pub fn possible() -> bool {
    std::io::stdin().is_terminal() && std::io::stderr().is_terminal()
}

/// Asks for the film of every posture that has none yet, and offers lateral views for the sagittal profile.
pub fn choose_films(
    candidates: &Candidates,
    chosen: &mut Vec<(FilmView, usize)>,
) -> Result<(), Failure> {
    say(text::list(candidates));
    say("");
    for posture in Posture::ALL {
        let view = FilmView::Frontal(posture);
        let has_one = chosen.iter().any(|(other, _)| *other == view);
        let mut free = open(candidates, chosen, View::Lateral);
        if has_one || free.is_empty() {
            continue;
        }
        // A case needs the erect film.
        if posture != Posture::Erect {
            free.push(None);
        }
        let question = format!("Which film shows the patient {}?", meaning(posture));
        if let Some(index) = pick(candidates, &question, &free)? {
            chosen.push((view, index));
        }
    }
    let lateral = chosen.iter().any(|(view, _)| *view == FilmView::Lateral);
    let mut side_views = open(candidates, chosen, View::Frontal);
    side_views.retain(|index| {
        index.is_some_and(|i| {
            candidates.films[i].seen.as_ref().is_ok_and(|s| s.view().view == Some(View::Lateral))
        })
    });
    if !lateral && !side_views.is_empty() {
        side_views.push(None);
        let question = "A lateral view was found. Take the sagittal profile from it?";
        if let Some(index) = pick(candidates, question, &side_views)? {
            chosen.push((FilmView::Lateral, index));
        }
    }
    Ok(())
}

const fn meaning(posture: Posture) -> &'static str {
    match posture {
        Posture::Erect => "standing (the reference of all others)",
        Posture::LeftBending => "bending to the patient's left",
        Posture::RightBending => "bending to the patient's right",
        Posture::Neutral => "lying at rest",
        Posture::Traction => "pulled along the spine",
    }
}

/// Films that can be used, are not chosen yet, and are not of a view.
fn open(candidates: &Candidates, chosen: &[(FilmView, usize)], not: View) -> Vec<Option<usize>> {
    let films = candidates.films.iter().enumerate();
    films
        .filter(|(index, film)| {
            let of_view = film.seen.as_ref().is_ok_and(|seen| seen.view().view != Some(not));
            of_view && !chosen.iter().any(|(_, other)| other == index)
        })
        .map(|(index, _)| Some(index))
        .collect()
}

fn pick(
    candidates: &Candidates,
    question: &str,
    options: &[Option<usize>],
) -> Result<Option<usize>, Failure> {
    let words: Vec<String> = options
        .iter()
        .map(|option| match option {
            Some(index) => shown(&text::line(candidates, *index)),
            None => "none".to_owned(),
        })
        .collect();
    let answer = Select::new()
        .with_prompt(question)
        .items(&words)
        .default(0)
        .interact_opt()
        .map_err(asked)?;
    match answer {
        Some(place) => Ok(options[place]),
        None => Err(cancelled()),
    }
}

fn cancelled() -> Failure {
    Failure::usage("the import was cancelled; nothing was written")
}

/// Asks one question; the side that was answered, or `None` where the answer was to go on.
pub fn ask(question: &Question) -> Result<Option<ImageSide>, Failure> {
    match &question.about {
        About::Side => {
            let (view, of) = (question.view, asked_side(question.view));
            let prompt =
                format!("{view} film: on which side of the picture is the patient's {of}?");
            let words = ["left of the picture", "right of the picture"];
            let answer =
                Select::new().with_prompt(prompt).items(words).interact_opt().map_err(asked)?;
            match answer {
                Some(0) => Ok(Some(ImageSide::Left)),
                Some(_) => Ok(Some(ImageSide::Right)),
                None => Err(cancelled()),
            }
        }
        // A spacing must be given as an option.
        About::Spacing(_) => {
            Err(Failure::usage(question.to_string())
                .with_line(format!("    {}", question.answer())))
        }
        About::Contradiction(text) => {
            say(format!("{} film: {text}.", question.view));
            let prompt = "Continue with your options?";
            let sure =
                Confirm::new().with_prompt(prompt).default(false).interact().map_err(asked)?;
            if sure { Ok(None) } else { Err(cancelled()) }
        }
    }
}

fn asked(error: dialoguer::Error) -> Failure {
    let dialoguer::Error::IO(error) = error;
    Failure::internal(format!("the terminal did not answer: {error}"))
}
