//! The numbers of a patient that enter a cohort.

use super::DoubtedFilm;
use super::numbers::Numbers;
use crate::action::LineKind;
use crate::analysis::{
    Analysis, ComparedLine, FilmMovement, FilmPredictor, FilmRole, LineModel, LinesCompared,
    Movement, ferguson_errors_deg,
};
use crate::anatomy::{Levels, Posture, named};
use crate::evaluate::statistics::Summary;
use crate::evaluate::{Baseline, BendRotations, FilmFromTop, Links, Simulation, joint_rotations};
use crate::hypothesis::{Hypothesis, HypothesisFit, Role};
use crate::measure::LengthScale;
use crate::motion::SegmentEstimate;
use crate::multibody::PathEnding;
use crate::personalize::TestOutcome;
use crate::spatial::Angle;

/// The numbers of a patient that enter a [`super::Cohort`].
///
/// It has no curves, chains or outlines. The errors of all films stand in one row of numbers. Making it takes one more
/// fit per line and bend ([`Analysis::comparison`]).
#[derive(Debug, Clone, PartialEq)]
pub struct CohortPatient {
    pub(super) case_id: Box<str>,
    pub(super) synthetic: bool,
    pub(super) levels: Levels,
    pub(super) segments: usize,
    pub(super) segment_mm: f64,
    /// Rotations of all segments over all films.
    pub(super) rotation_deg: Summary,
    /// Inflections of the erect curve.
    pub(super) inflections: usize,
    pub(super) doubts: Box<[DoubtedFilm]>,
    /// Whether the distribution of joint rotations was given and not left to the cohort.
    pub(super) has_rotation_prior: bool,
    /// The erect film first.
    pub(super) films: Box<[PatientFilm]>,
    /// Links of the erect spine.
    pub(super) links: Links,
    /// The other films, as T2 predicts them.
    pub(super) from_top: Box<[FilmFromTop]>,
    /// Rotations of every bend.
    bends: Vec<Vec<Angle>>,
    /// Lines with a model that are not fitted to the films: the test of a single force along them, of all bends together.
    pub(super) tested: Box<[(LineKind, TestOutcome)]>,
    /// The same of every bend alone.
    pub(super) tested_bends: Box<[(LineKind, TestOutcome)]>,
    pub(super) lines: Box<[ComparedLine]>,
    pub(super) same_data: bool,
    /// Every film once per role.
    pub(super) compared: Box<[(Posture, FilmRole)]>,
    /// By place of the film in `compared` and line: why the errors are missing.
    missing: Box<[Missing]>,
    /// By place of the film in `compared` and line ([`FilmErrors`]).
    errors: Numbers<(u8, LineKind)>,
    /// Location errors by lines with T2's tilt, and without mechanics and other patients, in mm, by place of the film.
    predicted_mm: Numbers<(u8, FilmPredictor)>,
    pub(super) hypotheses: Box<[Hypothesis]>,
    /// Location errors of other loads and bases, in mm, by place of a film that they were not fitted to.
    hypotheses_mm: Numbers<(u8, Hypothesis, bool)>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct PatientFilm {
    pub posture: Posture,
    /// Whether its movement from the erect film is known.
    pub has_motion: bool,
    /// Without a scale its lengths belong to a typical spine, and do not count.
    pub has_scale: bool,
    /// `None` without a scale.
    pub rmse_mm: Option<f64>,
    pub rmse_deg: f64,
    pub least_rotations_deg: Option<[f64; 2]>,
    pub inflection_estimates: Option<[Estimate; 2]>,
    pub mean_least_estimates: Option<[Estimate; 2]>,
}

/// A [`SegmentEstimate`] without its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    pub distance_segments: f64,
    /// On the erect film; NaN where this has no scale.
    pub distance_mm: f64,
    pub rotation_deg: f64,
}

/// A line without a result on a film.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Missing {
    film: u8,
    kind: LineKind,
    why: NoResult,
}

/// Errors of a line on a film: of the Ferguson angles, the joints that turn against the force, and the location errors.
#[derive(Clone, Copy)]
pub(super) struct FilmErrors<'a>(&'a [f64]);

impl<'a> FilmErrors<'a> {
    const FERGUSON: usize = 3;
    const BEFORE_LOCATIONS: usize = Self::FERGUSON + 1;

    fn numbers(simulation: &Simulation) -> Vec<f64> {
        let mut numbers = ferguson_errors_deg(simulation);
        numbers.push(simulation.contradicted.len() as f64);
        numbers.extend_from_slice(&simulation.shape.location_errors_mm);
        numbers
    }

    /// Absolute errors of the Ferguson angles, in degrees.
    pub fn ferguson_deg(self) -> &'a [f64] {
        &self.0[..Self::FERGUSON]
    }

    /// Joints that turn against the force.
    pub fn contradicted(self) -> f64 {
        self.0[Self::FERGUSON]
    }

    /// Location errors of the vertebrae, in mm.
    pub fn location_mm(self) -> &'a [f64] {
        &self.0[Self::BEFORE_LOCATIONS..]
    }
}

named! {
    /// Why a line has no result on a film.
    pub enum NoResult {
        /// The patient has no model of this line; for a left-out bend, no model fitted to the other bend.
        NoModel = "no_model" as "the line has no model",
        /// The line has no place on the film.
        NoLine = "no_line" as "the line has no place on this film",
        /// No force up to the limit gives the shape that was asked for.
        Unreachable = "unreachable" as "no force up to the limit gives the shape",
        /// The search for the force did not converge.
        NotConverged = "not_converged" as "the search for the force did not converge",
        /// The shape that was found is beyond the human range of motion.
        BeyondHumanRange = "beyond_human_range" as "the shape found is beyond the human range of motion",
        /// The fit of the stiffness did not converge.
        FitNotConverged = "fit_not_converged" as "the fit of the stiffness did not converge",
    }
}

impl CohortPatient {
    /// Of an analysed patient.
    #[must_use]
    pub fn of(analysis: &Analysis) -> Self {
        let movement = &analysis.movement;
        let compared = analysis.comparison();
        let films: Box<[_]> = compared.films.iter().map(|film| (film.posture, film.role)).collect();
        let (missing, errors) = under_lines(compared, &analysis.models);
        let erect = &movement.films[0].outline;
        let moved = movement.films[1..].iter().map(|film| &film.outline);
        let tested = analysis
            .testable_models()
            .map(|model| (model.kind, analysis.compatibility(model).outcome()));
        Self {
            case_id: analysis.case_id.as_str().into(),
            synthetic: analysis.synthetic,
            levels: movement.levels(),
            segments: movement.chain.segments,
            segment_mm: movement.chain.segment_mm,
            rotation_deg: Summary::of(&rotations_deg(analysis)),
            inflections: movement.inflections.all.len(),
            doubts: DoubtedFilm::of(analysis).into(),
            has_rotation_prior: analysis.options.rotation_prior.is_some(),
            films: movement.films.iter().map(|film| PatientFilm::of(film, movement)).collect(),
            links: Links::of(erect),
            from_top: moved.clone().map(|film| FilmFromTop::of(erect, film)).collect(),
            bends: moved
                .filter(|film| film.posture.bend().is_some())
                .map(|film| joint_rotations(erect, film))
                .collect(),
            tested: tested.collect(),
            tested_bends: tested_bends(analysis),
            lines: compared.lines.as_slice().into(),
            same_data: compared.same_data(),
            missing,
            errors,
            predicted_mm: predicted_mm(compared),
            hypotheses: analysis.hypotheses.iter().map(|fit| fit.hypothesis).collect(),
            hypotheses_mm: hypotheses_mm(&analysis.hypotheses, &films),
            compared: films,
        }
    }

    /// Identifier of the case.
    #[must_use]
    pub fn case_id(&self) -> &str {
        &self.case_id
    }

    /// Whether its films are synthetic.
    #[must_use]
    pub const fn is_synthetic(&self) -> bool {
        self.synthetic
    }

    /// Whether a film may not show what it is named after.
    #[must_use]
    pub const fn has_doubted_film(&self) -> bool {
        !self.doubts.is_empty()
    }

    /// Whether all its films have a scale.
    pub(super) fn has_scale(&self) -> bool {
        self.films.iter().all(|film| film.has_scale)
    }

    /// Whether both the erect film and this one have a scale, so that locations on it are predicted in millimetres.
    pub(super) fn has_lengths(&self, posture: Posture) -> bool {
        let mut both =
            self.films.iter().filter(|film| [Posture::Erect, posture].contains(&film.posture));
        both.all(|film| film.has_scale)
    }

    /// Every bend as if it were to the right.
    pub(super) fn bends(&self) -> Vec<BendRotations> {
        let sides = self.from_top.iter().filter_map(|film| film.posture.bend());
        let bends = sides.zip(&self.bends);
        bends
            .map(|(side, bend)| BendRotations::mirrored(side, bend, &self.links.joint_angles))
            .collect()
    }

    /// Places in `compared` of the films of a role.
    pub(super) fn places(&self, role: FilmRole) -> impl Iterator<Item = u8> {
        let films = (0..).zip(&self.compared).filter(move |(_, film)| film.1 == role);
        films.map(|(place, _)| place)
    }

    /// Errors of a line on a film, or why they are missing.
    pub(super) fn result(&self, film: u8, kind: LineKind) -> Result<FilmErrors<'_>, NoResult> {
        self.errors.get(&(film, kind)).map(FilmErrors).ok_or_else(|| {
            let found = self.missing.iter().find(|one| (one.film, one.kind) == (film, kind));
            found.map_or(NoResult::NoModel, |one| one.why)
        })
    }

    /// The films of a role on which all of some lines have a result, with the errors of each.
    pub(super) fn films_of<const N: usize>(
        &self,
        role: FilmRole,
        kinds: [LineKind; N],
    ) -> impl Iterator<Item = [FilmErrors<'_>; N]> {
        self.places(role).filter_map(move |film| {
            let errors: Option<Vec<FilmErrors<'_>>> =
                kinds.iter().map(|&kind| self.result(film, kind).ok()).collect();
            errors?.try_into().ok()
        })
    }

    /// Location errors of a prediction without mechanics from the patient's films; `None` without a result.
    pub(super) fn baseline_mm(&self, film: u8, baseline: Baseline) -> Option<&[f64]> {
        self.predicted_mm.get(&(film, FilmPredictor::Baseline(baseline)))
    }

    /// Location errors of a line on a film, from T2's place with or without its tilt; `None` without a result.
    pub(super) fn line_mm(&self, film: u8, kind: LineKind, with_tilt: bool) -> Option<&[f64]> {
        if with_tilt {
            return self.predicted_mm.get(&(film, FilmPredictor::LineWithTilt(kind)));
        }
        self.result(film, kind).ok().map(FilmErrors::location_mm)
    }

    /// Location errors of another load and base on a film, from T2's place with or without its tilt; `None` where it does not predict the
    /// film.
    pub(super) fn hypothesis_mm(
        &self,
        film: u8,
        hypothesis: Hypothesis,
        with_tilt: bool,
    ) -> Option<&[f64]> {
        self.hypotheses_mm.get(&(film, hypothesis, with_tilt))
    }
}

/// The shape of a line's model on a film, or why it is missing.
fn result_on(
    models: &[LineModel],
    kind: LineKind,
    posture: Posture,
) -> Result<&Simulation, NoResult> {
    let model = models.iter().find(|model| model.kind == kind).ok_or(NoResult::NoModel)?;
    let simulation = model.simulation(posture).ok_or(NoResult::NoLine)?;
    match simulation.status {
        ending if ending.is_usable() => Ok(simulation),
        PathEnding::Unreachable => Err(NoResult::Unreachable),
        PathEnding::BeyondHumanRange => Err(NoResult::BeyondHumanRange),
        PathEnding::FitNotConverged => Err(NoResult::FitNotConverged),
        _ => Err(NoResult::NotConverged),
    }
}

/// Every film under every line, by place of the film: why the result is missing, and the errors of a result.
fn under_lines(
    compared: &LinesCompared,
    models: &[LineModel],
) -> (Box<[Missing]>, Numbers<(u8, LineKind)>) {
    let (mut missing, mut errors) = (Vec::new(), Vec::new());
    for (place, film) in (0_u8..).zip(&compared.films) {
        let left_out = compared.left_out.iter().find(|bend| bend.posture == film.posture);
        let models = match (film.role, left_out) {
            (FilmRole::LeftOutBend, Some(bend)) => &bend.models,
            _ => models,
        };
        for kind in compared.lines.iter().map(|line| line.kind) {
            match result_on(models, kind, film.posture) {
                Ok(found) => errors.push(((place, kind), FilmErrors::numbers(found))),
                Err(why) => missing.push(Missing { film: place, kind, why }),
            }
        }
    }
    let errors = errors.iter().map(|(key, numbers)| (*key, &numbers[..]));
    (missing.into(), Numbers::of(errors))
}

fn predicted_mm(compared: &LinesCompared) -> Numbers<(u8, FilmPredictor)> {
    // Errors of lines without the tilt stand beside their other errors.
    let of_film = |(place, film)| {
        let others = compared.predictors().filter(|by| !matches!(by, FilmPredictor::Line(_)));
        others.filter_map(move |by| {
            Some(((place, by), &compared.shape(film, by)?.location_errors_mm[..]))
        })
    };
    Numbers::of((0..).zip(&compared.films).flat_map(of_film))
}

fn hypotheses_mm(
    fits: &[HypothesisFit],
    films: &[(Posture, FilmRole)],
) -> Numbers<(u8, Hypothesis, bool)> {
    let predictions = fits
        .iter()
        .flat_map(|fit| fit.predictions.iter().map(|prediction| (fit.hypothesis, prediction)));
    let on_films = predictions.filter_map(|(hypothesis, prediction)| {
        let (role, with_tilt) = match prediction.role {
            Role::LeftOut => (FilmRole::LeftOutBend, false),
            Role::LeftOutWithTilt => (FilmRole::LeftOutBend, true),
            Role::HeldOut => (FilmRole::HeldOut, false),
            // A load that was fitted to the film does not predict it. No baseline of every analysis has the input of the prior.
            Role::Fitted | Role::LeftOutWithPrior | Role::LeftOutLoadFitted => return None,
        };
        let film = (prediction.shape.posture, role);
        let (place, _) = (0..).zip(films).find(|(_, one)| **one == film)?;
        Some(((place, hypothesis, with_tilt), &prediction.shape.location_errors_mm[..]))
    });
    Numbers::of(on_films)
}

/// Rotations of all segments over all films.
fn rotations_deg(analysis: &Analysis) -> Vec<f64> {
    let motions = analysis.movement.films.iter().filter_map(|film| film.motion.as_ref());
    motions.flat_map(|motion| motion.rotations.iter().map(|rotation| rotation.deg())).collect()
}

fn tested_bends(analysis: &Analysis) -> Box<[(LineKind, TestOutcome)]> {
    let of_bend = |film: &FilmMovement| {
        let p_value = |kind| film.line_comparison(kind).map(|found| found.test.p_value);
        let models = analysis.testable_models();
        let tested = models.map(|model| (model.kind, TestOutcome::of(p_value(model.kind))));
        tested.collect::<Vec<_>>()
    };
    analysis.movement.bends().flat_map(of_bend).collect()
}

impl PatientFilm {
    fn of(film: &FilmMovement, movement: &Movement) -> Self {
        let motion = film.motion.as_ref();
        let estimates = |all: &Option<[SegmentEstimate; 2]>| {
            all.as_ref().map(|e| e.each_ref().map(|one| Estimate::of(one, movement.scale())))
        };
        let has_scale = film.outline.scale.has_millimetres();
        Self {
            posture: film.outline.posture,
            has_motion: motion.is_some(),
            has_scale,
            rmse_mm: film.outline.scale.mm(film.fit.rmse_mm),
            rmse_deg: film.fit.rmse_tilt.deg(),
            least_rotations_deg: motion.map(|m| m.least.map(|k| m.rotations[k].deg())),
            inflection_estimates: estimates(&film.inflection_estimates),
            mean_least_estimates: estimates(&film.mean_least_estimates),
        }
    }
}

impl Estimate {
    fn of(estimate: &SegmentEstimate, erect: &LengthScale) -> Self {
        Self {
            distance_segments: estimate.distance_segments as f64,
            distance_mm: erect.mm(estimate.distance_mm).unwrap_or(f64::NAN),
            rotation_deg: estimate.rotation.deg(),
        }
    }
}
