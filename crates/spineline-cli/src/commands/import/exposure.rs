//! Whether the lateral film was exposed together with the erect one: by its file, or as said.

use spineline::anatomy::{FilmView, Posture};
use spineline_films::Exposures;

use super::args::ImportArgs;
use super::candidates::ChosenFilm;
use super::resolve::ResolvedFilm;
use crate::run::failure::Failure;

/// Sets on the lateral film whether both were exposed together, with a note on the source and the assumption.
pub fn decide(
    args: &ImportArgs,
    seen: &[ChosenFilm<'_>],
    films: &mut [ResolvedFilm],
) -> Result<(), Failure> {
    let Some(lateral) = films.iter_mut().find(|film| film.view == FilmView::Lateral) else {
        return Ok(());
    };
    let marks = |wanted: FilmView| {
        let found = seen.iter().find(|film| film.view == wanted)?;
        Some(found.seen.tags.exposure)
    };
    let pair = marks(FilmView::Frontal(Posture::Erect)).zip(marks(FilmView::Lateral));
    let stated = pair.map_or(Exposures::NotStated, |(erect, lateral)| erect.with(&lateral));
    let (simultaneous, note) = match (args.simultaneous, stated.together()) {
        (Some(said), Some(by_file)) if said != by_file => {
            let text = format!(
                "{stated}, so they were {}exposed together, but --simultaneous says the opposite",
                if by_file { "" } else { "not " }
            );
            if !args.accept {
                return Err(Failure::usage(format!("lateral film: {text}"))
                    .with_line("    leave out --simultaneous, or --accept if you are sure"));
            }
            (said, Some(format!("{text}; accepted by --accept")))
        }
        (Some(said), _) => (said, None),
        (None, Some(true)) => {
            let text = format!(
                "{stated}: taken as exposed together with the erect film, with one vertical and one scale; --simultaneous no if that is wrong"
            );
            (true, Some(text))
        }
        (None, Some(false)) => (false, None),
        (None, None) => {
            let text = format!(
                "{stated}: taken as not exposed together with the erect film, so that its scale and turn are estimated from the heights of the vertebrae; for films of a biplanar scanner give --simultaneous yes"
            );
            (false, Some(text))
        }
    };
    lateral.simultaneous = simultaneous;
    lateral.notes.extend(note);
    Ok(())
}
