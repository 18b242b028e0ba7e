//! What a cohort keeps of a patient.

use super::DoubtedFilm;
use super::lines::{NoResult, result_on};
use crate::action::LineKind;
use crate::analysis::{
    Analysis, ComparedFilm, ComparedLine, FilmMovement, FilmRole, LineModel, LinesCompared,
    ferguson_errors_deg,
};
use crate::anatomy::{Levels, Posture, Side};
use crate::evaluate::statistics::Summary;
use crate::evaluate::{Baseline, FilmFromTop, Links, Simulation, joint_rotations};
use crate::hypothesis::{Hypothesis, HypothesisFit, Role};
use crate::motion::SegmentEstimate;
use crate::personalize::TestOutcome;
use crate::spatial::Angle;

/// The numbers of a patient that enter a [`super::Cohort`].
///
/// It holds no curve, no chain and no outline: about 10 kB. Making it takes one more fit per line and bend
/// ([`Analysis::comparison`]).
#[derive(Debug, Clone, PartialEq)]
pub struct CohortPatient {
    pub(super) case_id: String,
    pub(super) synthetic: bool,
    pub(super) levels: Levels,
    pub(super) segments: usize,
    pub(super) segment_mm: f64,
    /// Rotations of all segments over all films.
    pub(super) rotation_deg: Summary,
    /// Inflections of the erect curve.
    pub(super) inflections: usize,
    pub(super) doubts: Vec<DoubtedFilm>,
    /// Whether the distribution of joint rotations was given and not left to the cohort.
    pub(super) has_rotation_prior: bool,
    /// The erect film first.
    pub(super) films: Vec<PatientFilm>,
    /// Links of the erect spine.
    pub(super) links: Links,
    /// The other films, as T2 predicts them.
    pub(super) from_top: Vec<FilmFromTop>,
    /// Rotations of every bend, as if it were to the right.
    pub(super) bends: Vec<Vec<Angle>>,
    pub(super) models: Vec<PatientModel>,
    /// Lines with a model that are not fitted to the films: what all bends say of a single force along them.
    pub(super) tested: Vec<(LineKind, TestOutcome)>,
    pub(super) lines: Vec<ComparedLine>,
    pub(super) same_data: bool,
    /// Every film once per role.
    pub(super) compared: Vec<PatientFilmUnderLines>,
    /// Other loads and bases, on films that they were not fitted to.
    pub(super) hypotheses: Vec<PatientHypothesis>,
}

/// Another load and base of a patient.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PatientHypothesis {
    pub hypothesis: Hypothesis,
    /// Location errors, in mm, of the films that it predicts.
    pub films: Vec<(Posture, FilmRole, Vec<f64>)>,
}

/// A film of a patient.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PatientFilm {
    pub posture: Posture,
    /// Whether its movement from the erect film is known.
    pub has_motion: bool,
    pub rmse_mm: f64,
    pub rmse_deg: f64,
    pub least_rotations_deg: Vec<f64>,
    pub inflection_estimates: Option<[SegmentEstimate; 2]>,
    pub mean_least_estimates: Option<[SegmentEstimate; 2]>,
    /// The same lines on it alone, where it is a bend.
    pub tested: Vec<(LineKind, TestOutcome)>,
}

/// A line of action of a patient.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PatientModel {
    pub kind: LineKind,
    pub films: Vec<SimulatedFilm>,
}

/// A film under a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SimulatedFilm {
    pub posture: Posture,
    pub fitted: bool,
    pub is_usable: bool,
    pub errors: FilmErrors,
    pub contradicted: usize,
    pub contradicted_weight: f64,
}

/// Errors of a shape on a film.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FilmErrors {
    pub location_mm: Vec<f64>,
    pub ferguson_deg: Vec<f64>,
}

/// A film in one role, under every line of [`CohortPatient::lines`].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PatientFilmUnderLines {
    pub posture: Posture,
    pub role: FilmRole,
    /// By line.
    pub by_line: Vec<Result<FilmErrors, NoResult>>,
    /// Location errors without mechanics, in mm; `None` where there is no result.
    pub baselines_mm: Vec<(Baseline, Option<Vec<f64>>)>,
}

impl CohortPatient {
    /// Of an analysed patient.
    #[must_use]
    pub fn of(analysis: &Analysis) -> Self {
        let movement = &analysis.movement;
        let compared = analysis.comparison();
        let tested =
            candidates(analysis).map(|model| (model.kind, analysis.compatibility(model).outcome()));
        let erect = &movement.films[0].outline;
        let moved = movement.films[1..].iter().map(|film| &film.outline);
        Self {
            case_id: analysis.case_id.clone(),
            synthetic: analysis.synthetic,
            levels: movement.levels(),
            segments: movement.chain.segments,
            segment_mm: movement.chain.segment_mm,
            rotation_deg: Summary::of(&rotations_deg(analysis)),
            inflections: movement.inflections.all.len(),
            doubts: DoubtedFilm::of(analysis),
            has_rotation_prior: analysis.options.rotation_prior.is_some(),
            films: movement.films.iter().map(|film| PatientFilm::of(film, analysis)).collect(),
            links: Links::of(erect),
            from_top: moved.map(|film| FilmFromTop::of(erect, film)).collect(),
            bends: bend_rotations(analysis),
            models: analysis.models.iter().map(PatientModel::of).collect(),
            tested: tested.collect(),
            same_data: compared.same_data(),
            compared: compared
                .films
                .iter()
                .map(|film| PatientFilmUnderLines::of(film, compared, &analysis.models))
                .collect(),
            lines: compared.lines.clone(),
            hypotheses: analysis.hypotheses.iter().map(PatientHypothesis::of).collect(),
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

    /// A film other than the erect one, as T2 predicts it.
    pub(super) fn film_from_top(&self, posture: Posture) -> Option<&FilmFromTop> {
        self.from_top.iter().find(|film| film.posture == posture)
    }

    /// Errors of a line on a film; `None` where it has no result.
    pub(super) fn errors<'a>(
        &self,
        film: &'a PatientFilmUnderLines,
        kind: LineKind,
    ) -> Option<&'a FilmErrors> {
        let place = self.lines.iter().position(|line| line.kind == kind)?;
        film.by_line[place].as_ref().ok()
    }

    /// The films of a role on which all of some lines have a result, with the errors of each.
    pub(super) fn films_of<const N: usize>(
        &self,
        role: FilmRole,
        kinds: [LineKind; N],
    ) -> impl Iterator<Item = [&FilmErrors; N]> {
        let films = self.compared.iter().filter(move |film| film.role == role);
        films.filter_map(move |film| {
            let errors: Option<Vec<&FilmErrors>> =
                kinds.iter().map(|&kind| self.errors(film, kind)).collect();
            errors?.try_into().ok()
        })
    }

    /// Films under a line, fitted or held out.
    pub(super) fn simulated(
        &self,
        kind: LineKind,
        fitted: bool,
    ) -> impl Iterator<Item = &SimulatedFilm> {
        let models = self.models.iter().filter(move |model| model.kind == kind);
        models.flat_map(|model| &model.films).filter(move |film| film.fitted == fitted)
    }
}

/// Rotations of every bend, as if it were to the right.
fn bend_rotations(analysis: &Analysis) -> Vec<Vec<Angle>> {
    let erect = &analysis.movement.films[0].outline;
    let bends = analysis.movement.films.iter().filter_map(|film| {
        let sign = match film.outline.posture.bend()? {
            Side::Right => 1.0,
            Side::Left => -1.0,
        };
        let rotations = joint_rotations(erect, &film.outline);
        Some(rotations.into_iter().map(|rotation| rotation * sign).collect())
    });
    bends.collect()
}

/// Rotations of all segments over all films.
fn rotations_deg(analysis: &Analysis) -> Vec<f64> {
    let motions = analysis.movement.films.iter().filter_map(|film| film.motion.as_ref());
    motions.flat_map(|motion| motion.rotations.iter().map(|rotation| rotation.deg())).collect()
}

/// The lines of a patient that are not fitted to the films, and so can be tested.
fn candidates(analysis: &Analysis) -> impl Iterator<Item = &LineModel> {
    analysis.models.iter().filter(|model| model.kind != LineKind::Estimated)
}

impl PatientFilm {
    fn of(film: &FilmMovement, analysis: &Analysis) -> Self {
        let motion = film.motion.as_ref();
        let is_bend = film.outline.posture.bend().is_some();
        let outcome =
            |kind| TestOutcome::of(film.line_comparison(kind).map(|found| found.test.p_value));
        Self {
            posture: film.outline.posture,
            has_motion: motion.is_some(),
            rmse_mm: film.fit.rmse_mm,
            rmse_deg: film.fit.rmse_tilt.deg(),
            least_rotations_deg: motion
                .map_or_else(Vec::new, |m| m.least.map(|k| m.rotations[k].deg()).to_vec()),
            inflection_estimates: film.inflection_estimates,
            mean_least_estimates: film.mean_least_estimates,
            tested: candidates(analysis)
                .filter(|_| is_bend)
                .map(|model| (model.kind, outcome(model.kind)))
                .collect(),
        }
    }
}

impl PatientHypothesis {
    fn of(fit: &HypothesisFit) -> Self {
        let films = fit.predictions.iter().filter_map(|film| {
            let role = match film.role {
                Role::LeftOut => FilmRole::LeftOutBend,
                Role::HeldOut => FilmRole::HeldOut,
                // A load that was fitted to the film predicts nothing, and what knows more of a film than T2's place is not
                // compared with what does not.
                Role::Fitted
                | Role::LeftOutWithPrior
                | Role::LeftOutWithTilt
                | Role::LeftOutLoadFitted => return None,
            };
            Some((film.posture, role, film.location_errors_mm.clone()))
        });
        Self { hypothesis: fit.hypothesis, films: films.collect() }
    }
}

impl PatientModel {
    fn of(model: &LineModel) -> Self {
        let films = model.postures.iter().map(|simulation| SimulatedFilm {
            posture: simulation.posture,
            fitted: simulation.fitted,
            is_usable: simulation.is_usable(),
            errors: FilmErrors::of(simulation),
            contradicted: simulation.contradicted.len(),
            contradicted_weight: simulation.contradicted_weight(),
        });
        Self { kind: model.kind, films: films.collect() }
    }
}

impl FilmErrors {
    fn of(simulation: &Simulation) -> Self {
        Self {
            location_mm: simulation.location_errors_mm.clone(),
            ferguson_deg: ferguson_errors_deg(simulation),
        }
    }
}

impl PatientFilmUnderLines {
    fn of(film: &ComparedFilm, compared: &LinesCompared, models: &[LineModel]) -> Self {
        let left_out = compared.left_out.iter().find(|bend| bend.posture == film.posture);
        let models = match (film.role, left_out) {
            (FilmRole::LeftOutBend, Some(bend)) => &bend.models,
            _ => models,
        };
        let of_line =
            |line: &ComparedLine| result_on(models, line.kind, film.posture).map(FilmErrors::of);
        let baselines = film.baselines.iter();
        Self {
            posture: film.posture,
            role: film.role,
            by_line: compared.lines.iter().map(of_line).collect(),
            baselines_mm: baselines
                .map(|one| {
                    let errors = one.is_usable().then(|| one.location_errors_mm.clone());
                    (one.baseline, errors)
                })
                .collect(),
        }
    }
}
