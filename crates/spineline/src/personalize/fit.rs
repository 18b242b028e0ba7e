//! The fit of bends under loads on T2.

use super::estimate::JointResponses;
use super::film::FilmData;
use super::problem::Problem;
use super::search::fit;
use super::{Base, FitFilm, FitSettings, Personalization};
use crate::multibody::{FittedSprings, MarchedFilm};

/// Fits multipliers and loads to bending films.
///
/// The returned loads are in N and N·mm in `G`, up to the level that the gauge fixes. `start` is the fit to other readings of these
/// films: its minima are followed first, and where they fit these readings much worse, all starts are tried as without it.
///
/// # Errors
/// None: an ending without result is a status. With no film, the nominal stiffness is returned as not evaluable.
///
/// ```
/// use spineline::action::LineOfAction;
/// use spineline::analysis::{AnalysisOptions, analyze_movement};
/// use spineline::multibody::{FittedSprings, JointGroups, Load, StiffnessLibrary, Support};
/// use spineline::personalize::{FitFilm, FitSettings, personalize};
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Rod, &Readers::exact(), 1)?.case;
/// let movement = analyze_movement(&case, &AnalysisOptions::default())?.movement;
/// let mut films = Vec::new();
/// for posture in movement.bends() {
///     let [caudal, cranial] = posture.inflection_points.ok_or("no two inflections")?;
///     let line = LineOfAction::through(caudal, cranial)?;
///     let evidence = posture.evidence.as_ref().ok_or("no joint rotations")?;
///     films.push(FitFilm { outline: &posture.outline, evidence, load: Load::along(line, 0.0) });
/// }
/// let settings = FitSettings::of_shapes(&movement.regions, Support::Free);
/// let (library, groups) =
///     (StiffnessLibrary::default(), JointGroups::regional(&movement.regions));
/// let erect = &movement.erect().outline;
/// let springs =
///     FittedSprings { model: &movement.spine, erect, library: &library, groups: &groups };
/// let fit = personalize(springs, &films, &settings, None);
/// // Only ratios are identified: the mean of ln α is held at zero.
/// assert!(fit.log_multipliers.iter().sum::<f64>().abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn personalize(
    springs: FittedSprings<'_>,
    films: &[FitFilm<'_>],
    settings: &FitSettings<'_>,
    start: Option<&Personalization>,
) -> Personalization {
    fit(&mut problem_of(springs, films, settings), settings.hints, start)
}

/// The least squares of bends under loads on T2.
pub(super) fn problem_of<'a>(
    springs: FittedSprings<'a>,
    films: &[FitFilm<'a>],
    settings: &FitSettings<'a>,
) -> Problem<'a, MarchedFilm> {
    let film = |film: &FitFilm<'a>| {
        let measured = JointResponses::to(&film.load, film.evidence);
        let loaded = MarchedFilm::new(film.load, springs.groups.len());
        FilmData::new(springs, film.outline, measured, settings.regions, loaded, Base::Fixed)
    };
    Problem::new(springs, films.iter().map(film).collect(), settings, None)
}
