//! Films of a case: taken out and put together.

use pyo3::prelude::*;
use spineline::analysis::{self, check_repeated};
use spineline::anatomy::FilmView;
use spineline::error::Error;
use spineline::measure::{Film, FilmLandmarks, LateralFilm, SpacingPlane};
use spineline_files::method_text::named;
use spineline_files::{CaseFile, FilmSource, nearest};

use crate::case::{Case, Origin};
use crate::fault::Fault;

/// Identifier of a case that is one film.
const ALONE: &str = "film";

/// A film by its name.
///
/// # Errors
/// For an unknown name, with a similar one.
pub fn view(film: &str) -> Result<FilmView, Fault> {
    named(film).map_err(|_| {
        let names = FilmView::ALL.map(FilmView::key);
        let meant = nearest(film, &names).map(|name| format!("; did you mean `{name}`?"));
        let text = format!("unknown film `{film}`{}", meant.unwrap_or_default());
        Fault::new(text, format!("give one of {}", names.join(", ")))
    })
}

/// A case of one film, which is in one of both lists, and the file of its picture.
///
/// # Errors
/// If the file cannot hold it.
pub fn one_film(
    films: Vec<Film>,
    lateral: Option<LateralFilm>,
    source: FilmSource,
) -> Result<Case, Fault> {
    let view = films.first().map_or(FilmView::Lateral, |film| film.posture.into());
    let case = analysis::Case { lateral, ..analysis::Case::of_films(ALONE, films) };
    Case::new(CaseFile::from_case(&case).with_source(view, source), Origin::default())
}

/// One case of the films of these cases. It is synthetic if it is said to be, or if one of them is.
#[pyfunction]
pub fn case_of_films(
    films: Vec<PyRef<'_, Case>>,
    case_id: String,
    synthetic: bool,
) -> Result<Case, Fault> {
    let parts: Vec<&Case> = films.iter().map(|one| &**one).collect();
    let synthetic = synthetic || parts.iter().any(|one| one.case.synthetic);
    let views: Vec<FilmView> = parts.iter().flat_map(|one| one.all_films()).collect();
    if let Some((_, view)) = views.iter().enumerate().find(|(i, view)| views[..*i].contains(view)) {
        return Err(Fault::new(format!("two films are {view}"), "give every film once"));
    }
    let films: Vec<Film> = parts.iter().flat_map(|one| one.case.films.iter().cloned()).collect();
    let lateral = parts.iter().find_map(|one| one.case.lateral.clone());
    check_repeated(&films, lateral.as_ref()).map_err(Error::from)?;
    let case = analysis::Case { synthetic, lateral, ..analysis::Case::of_films(case_id, films) };
    let file = parts.iter().fold(CaseFile::from_case(&case), |file, one| with_pictures(file, one));
    let made_from = parts.iter().flat_map(|one| one.sources()).collect();
    Case::new(file, Origin::of(made_from))
}

/// Names the pictures of the films of another case.
fn with_pictures(file: CaseFile, of: &Case) -> CaseFile {
    of.all_films().into_iter().fold(file, |file, view| match of.file.source(view) {
        Some(source) => file.with_source(view, source),
        None => file,
    })
}

/// One film of a case, as a case.
#[pyfunction]
pub fn film_of(case: &Case, name: &str) -> Result<Case, Fault> {
    let wanted = view(name)?;
    let films = case.case.films.iter().filter(|film| wanted.posture() == Some(film.posture));
    let films: Vec<Film> = films.cloned().collect();
    let lateral = case.case.lateral.clone().filter(|_| wanted == FilmView::Lateral);
    if films.is_empty() && lateral.is_none() {
        let names: Vec<&str> = case.all_films().into_iter().map(FilmView::key).collect();
        let text = format!("{}: the case has no {wanted} film", case.case.id);
        return Err(Fault::new(text, format!("give one of {}", names.join(", "))));
    }
    let synthetic = case.case.synthetic;
    let alone = analysis::Case { synthetic, lateral, ..analysis::Case::of_films(ALONE, films) };
    Case::new(with_pictures(CaseFile::from_case(&alone), case), Origin::of(case.sources()))
}

/// The plane of the millimetres of a case with one frontal film; None for a lateral film.
#[pyfunction]
pub fn plane_of(case: &Case) -> Option<&'static str> {
    let plane = match &case.case.films.first()?.landmarks {
        FilmLandmarks::Corners { image, .. } => {
            image.spacing.map_or(SpacingPlane::Pixels, |spacing| spacing.plane)
        }
        FilmLandmarks::Placements { spacing_plane, .. } => *spacing_plane,
    };
    Some(plane.key())
}
