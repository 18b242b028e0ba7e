//! Predictions without mechanics over many patients, and whether lines of action and other loads predict better.

use super::comparison::corrected_by_holm;
use super::patient::{CohortPatient, PatientFilmUnderLines};
use super::rotation_prior::priors_of_others;
use super::{Clustered, PairedComparison};
use crate::action::LineKind;
use crate::analysis::{Analysis, FilmRole, LinesCompared, listed, probability};
use crate::anatomy::Levels;
use crate::evaluate::statistics::Resampling;
use crate::evaluate::{
    Baseline, BaselinePrediction, RotationPrior, predict_baseline, predict_from_prior,
};
use crate::hypothesis::Hypothesis;
use crate::personalize::SIGNIFICANCE;
use crate::spatial::Angle;

/// Location errors of a baseline over all films of a role.
#[derive(Debug, Clone, PartialEq)]
pub struct BaselineErrors {
    /// The pattern of rotations.
    pub baseline: Baseline,
    /// What the films were to the models.
    pub role: FilmRole,
    /// Films that it predicts.
    pub films: usize,
    /// Location errors, in mm.
    pub location_mm: Clustered,
}

/// A model against a baseline, on the films of a role that both predict: a line of action, or another load and base.
#[derive(Debug, Clone, PartialEq)]
pub struct BaselineTest<Model = LineKind> {
    /// The model.
    pub model: Model,
    /// The baseline.
    pub baseline: Baseline,
    /// What the films were to the models.
    pub role: FilmRole,
    /// Films in the comparison.
    pub films: usize,
    /// Location errors, model minus baseline: a negative difference is the model's advantage.
    pub comparison: PairedComparison,
    /// The sign-flip probability, corrected by Holm over all tests of such models against baselines.
    pub holm_p: Option<f64>,
}

impl<Model> BaselineTest<Model> {
    /// Whether the two differ beyond chance in the whole family.
    #[must_use]
    pub fn is_significant(&self) -> bool {
        self.holm_p.is_some_and(|p| p < SIGNIFICANCE)
    }

    /// Whether the model predicts better, beyond chance.
    #[must_use]
    pub fn is_better(&self) -> bool {
        self.is_significant() && self.comparison.mean_difference < 0.0
    }
}

/// The baselines of many patients.
#[derive(Debug, Clone, PartialEq)]
pub struct BaselinesOverPatients {
    /// By baseline and role; only those with a film.
    pub errors: Vec<BaselineErrors>,
    /// By line, baseline and role: one family.
    pub tests: Vec<BaselineTest>,
    /// By other load and base, baseline and role: one family; none where they were not requested.
    pub hypothesis_tests: Vec<BaselineTest<Hypothesis>>,
}

/// The roles of films that are predicted.
const PREDICTED: [FilmRole; 2] = [FilmRole::LeftOutBend, FilmRole::HeldOut];

impl BaselinesOverPatients {
    pub(super) fn of(all: &[CohortPatient], resampling: &Resampling) -> Self {
        let bends: Vec<Vec<Vec<Angle>>> = all.iter().map(CohortPatient::bend_rotations).collect();
        let priors = priors_of_others(all, &bends);
        let sums = BendSums::of(all, &bends);
        let patients: Vec<Predicted<'_>> = all
            .iter()
            .enumerate()
            .map(|(place, patient)| {
                let mean = sums.mean_of_others(patient.levels, &bends[place]);
                Predicted::of(patient, mean.as_deref(), priors[place].as_ref())
            })
            .collect();
        let mut errors: Vec<BaselineErrors> = cells()
            .map(|(baseline, role)| {
                let of = |patient: &Predicted<'_>| -> Vec<Vec<f64>> {
                    let films = patient.films(role);
                    films.filter_map(|one| one.errors_mm(baseline).map(<[f64]>::to_vec)).collect()
                };
                let by_patient: Vec<Vec<Vec<f64>>> = patients.iter().map(of).collect();
                let films = by_patient.iter().map(Vec::len).sum();
                let values = by_patient.into_iter().map(|films| films.concat()).collect();
                BaselineErrors {
                    baseline,
                    role,
                    films,
                    location_mm: Clustered::new(values, resampling),
                }
            })
            .collect();
        errors.retain(|one| one.films > 0);
        let mut kinds: Vec<LineKind> =
            all.iter().flat_map(|one| one.lines.iter().map(|line| line.kind)).collect();
        kinds.sort();
        kinds.dedup();
        let mut hypotheses: Vec<Hypothesis> =
            all.iter().flat_map(|one| one.hypotheses.iter().map(|fit| fit.hypothesis)).collect();
        hypotheses.sort();
        hypotheses.dedup();
        Self {
            errors,
            tests: tests_of(&patients, &kinds, line_errors_mm, resampling),
            hypothesis_tests: tests_of(&patients, &hypotheses, hypothesis_errors_mm, resampling),
        }
    }

    /// The models of one patient beside what is predicted without mechanics and without other patients: differences, with no
    /// interval and no test. `compared` is what [`Analysis::compare_lines`] gives.
    #[must_use]
    pub fn of_patient(analysis: &Analysis, compared: &LinesCompared) -> Self {
        /// One patient is not resampled.
        const NO_SEED: u64 = 0;
        let patient = CohortPatient::of_compared(analysis, compared);
        Self::of(&[patient], &Resampling::new(1, 1, NO_SEED))
    }

    /// The prediction without mechanics with the smallest error on the films of a role, of those that know no more of a
    /// film than a line does.
    #[must_use]
    pub fn best(&self, role: FilmRole) -> Option<&BaselineErrors> {
        let fair = self.errors.iter().filter(|one| one.role == role && !one.baseline.knows_tilt());
        fair.min_by(|a, b| a.mean_mm().total_cmp(&b.mean_mm()))
    }
}

impl BaselineErrors {
    /// Mean over patients of one mean per patient.
    #[must_use]
    pub fn mean_mm(&self) -> f64 {
        self.location_mm.patients.mean
    }
}

/// Every baseline in every role of films that are predicted.
fn cells() -> impl Iterator<Item = (Baseline, FilmRole)> {
    Baseline::ALL.into_iter().flat_map(|one| PREDICTED.map(|role| (one, role)))
}

/// All models against every baseline that knows no more of a film than they do, as one family.
fn tests_of<Model: Copy>(
    patients: &[Predicted<'_>],
    models: &[Model],
    errors_mm: ErrorsOf<Model>,
    resampling: &Resampling,
) -> Vec<BaselineTest<Model>> {
    let fair = || cells().filter(|(baseline, _)| !baseline.knows_tilt());
    let pairs = models.iter().flat_map(|&model| fair().map(move |cell| (model, cell)));
    let found =
        pairs.filter_map(|(model, cell)| test(patients, (model, errors_mm), cell, resampling));
    let mut tests: Vec<BaselineTest<Model>> = found.collect();
    let corrected = corrected_by_holm(tests.iter().map(|test| &test.comparison));
    for (test, holm_p) in tests.iter_mut().zip(corrected) {
        test.holm_p = holm_p;
    }
    tests
}

impl BaselinesOverPatients {
    /// What patterns of rotations predict without mechanics, and which lines predict better.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        PREDICTED.into_iter().flat_map(|role| self.of_role(role)).collect()
    }

    fn of_role(&self, role: FilmRole) -> Vec<String> {
        let Some(best) = self.best(role) else { return Vec::new() };
        let mut found: Vec<&BaselineErrors> =
            self.errors.iter().filter(|one| one.role == role).collect();
        found.sort_by(|a, b| a.mean_mm().total_cmp(&b.mean_mm()));
        let (with_tilt, found): (Vec<_>, Vec<_>) =
            found.into_iter().partition(|one| one.baseline.knows_tilt());
        let parts: Vec<String> =
            found.iter().map(|one| format!("{} {:.1} mm", one.baseline, one.mean_mm())).collect();
        let films = films_words(role);
        let mut all = vec![format!("{films}, predicted without mechanics: {}.", listed(&parts))];
        all.extend(with_tilt.first().map(|one| {
            format!(
                "With T2's tilt as well as its location, the distribution of rotations predicts them to {:.1} mm; no line is compared with it, since a line knows T2's location alone.",
                one.mean_mm()
            )
        }));
        let of_best = |test: &&BaselineTest| test.role == role && test.baseline == best.baseline;
        let tests: Vec<&BaselineTest> = self.tests.iter().filter(of_best).collect();
        all.extend(tests.iter().filter_map(|test| line_sentence(test)));
        if !tests.is_empty() && !tests.iter().any(|test| test.is_better()) {
            all.push(format!(
                "No line predicts them significantly better than {}: these films are no evidence that a prediction needs mechanics.",
                best.baseline
            ));
        }
        all.extend(self.hypotheses_sentence(role, best.baseline));
        all
    }

    /// Which of the other loads and bases do not predict better than the best prediction without mechanics.
    fn hypotheses_sentence(&self, role: FilmRole, best: Baseline) -> Option<String> {
        let of_best = |test: &&BaselineTest<Hypothesis>| {
            test.role == role && test.baseline == best && test.holm_p.is_some()
        };
        let tests: Vec<_> = self.hypothesis_tests.iter().filter(of_best).collect();
        let behind: Vec<String> = tests
            .iter()
            .filter(|test| !test.is_better())
            .map(|test| format!("{} ({:+.1} mm)", test.model, test.comparison.mean_difference))
            .collect();
        (!behind.is_empty()).then(|| {
            format!(
                "Of {} other loads and bases, {} do not predict them significantly better than {best}: {}.",
                tests.len(),
                behind.len(),
                listed(&behind)
            )
        })
    }
}

/// A line beside the best prediction without mechanics: whether it is better or worse beyond chance, or neither.
fn line_sentence(test: &BaselineTest) -> Option<String> {
    let [low, high] = test.comparison.bootstrap?;
    let difference = test.comparison.mean_difference;
    let sense = if difference < 0.0 { "smaller" } else { "larger" };
    let verdict = match (test.is_significant(), difference < 0.0) {
        (true, true) => "is better than",
        (true, false) => "is worse than",
        (false, _) => "is not significantly better than",
    };
    Some(format!(
        "There the {} {verdict} {}: its error is {sense} by {:.1} mm (line minus baseline, 95 % interval over {} patients {low:.1} to {high:.1} mm; p {} after Holm's correction).",
        test.model,
        test.baseline,
        difference.abs(),
        test.comparison.patients(),
        probability(test.holm_p?)
    ))
}

/// Films of a role, at the start of a sentence.
const fn films_words(role: FilmRole) -> &'static str {
    match role {
        FilmRole::HeldOut => "Neutral and traction films",
        FilmRole::LeftOutBend | FilmRole::Fitted => "Bends left out",
    }
}

/// A predicted film, with every baseline that it has.
struct PredictedFilm<'a> {
    film: &'a PatientFilmUnderLines,
    /// Location errors; `None` where there is no result.
    baselines_mm: Vec<(Baseline, Option<Vec<f64>>)>,
}

impl PredictedFilm<'_> {
    fn errors_mm(&self, baseline: Baseline) -> Option<&[f64]> {
        let found = self.baselines_mm.iter().find(|one| one.0 == baseline);
        found.and_then(|one| one.1.as_deref())
    }
}

/// The predicted films of a patient.
struct Predicted<'a> {
    patient: &'a CohortPatient,
    films: Vec<PredictedFilm<'a>>,
}

impl<'a> Predicted<'a> {
    /// `mean` are the mean rotations of other patients, `prior` the distribution of their rotations.
    fn of(
        patient: &'a CohortPatient,
        mean: Option<&[Angle]>,
        prior: Option<&RotationPrior>,
    ) -> Self {
        let errors = |one: BaselinePrediction| {
            let is_usable = one.is_usable();
            (one.baseline, is_usable.then_some(one.location_errors_mm))
        };
        let films = patient.compared.iter().filter(|film| PREDICTED.contains(&film.role));
        let with_others = |film: &'a PatientFilmUnderLines| {
            let (erect, outline) = (patient.erect(), patient.outline(film.posture));
            let from_mean = outline.zip(mean).map(|(outline, pattern)| {
                errors(predict_baseline(Baseline::OtherPatients, pattern, erect, outline))
            });
            // One that was given was learned elsewhere and is kept; a published one gives way.
            let learned = prior.filter(|_| !patient.has_rotation_prior);
            let learned = learned.filter(|_| film.posture.bend().is_some());
            let from_prior = outline.zip(learned).map_or_else(Vec::new, |(outline, prior)| {
                let both = [Baseline::RotationPrior, Baseline::RotationPriorWithTilt];
                both.map(|one| errors(predict_from_prior(one, prior, erect, outline))).into()
            });
            let is_kept = |one: &&(Baseline, Option<Vec<f64>>)| {
                from_prior.iter().all(|(baseline, _)| *baseline != one.0)
            };
            let own = film.baselines_mm.iter().filter(is_kept).cloned();
            let baselines_mm = own.chain(from_mean).chain(from_prior.iter().cloned()).collect();
            PredictedFilm { film, baselines_mm }
        };
        Self { patient, films: films.map(with_others).collect() }
    }

    fn films(&self, role: FilmRole) -> impl Iterator<Item = &PredictedFilm<'a>> {
        self.films.iter().filter(move |one| one.film.role == role)
    }
}

fn line_errors_mm<'b>(
    patient: &'b Predicted<'_>,
    line: LineKind,
    film: &'b PredictedFilm<'_>,
) -> Option<&'b [f64]> {
    let place = patient.patient.lines.iter().position(|one| one.kind == line)?;
    Some(&film.film.by_line[place].as_ref().ok()?.location_mm)
}

fn hypothesis_errors_mm<'b>(
    patient: &'b Predicted<'_>,
    hypothesis: Hypothesis,
    film: &'b PredictedFilm<'_>,
) -> Option<&'b [f64]> {
    let fits = &patient.patient.hypotheses;
    let fit = fits.iter().find(|fit| fit.hypothesis == hypothesis)?;
    let (posture, role) = (film.film.posture, film.film.role);
    let found = fit.films.iter().find(|one| one.0 == posture && one.1 == role)?;
    Some(&found.2)
}

/// Sums of the rotations over the bends of all patients with the same vertebrae, as if all bent to the right.
struct BendSums {
    by_levels: Vec<(Levels, Vec<Angle>, usize)>,
}

impl BendSums {
    fn of(patients: &[CohortPatient], bends: &[Vec<Vec<Angle>>]) -> Self {
        let mut by_levels: Vec<(Levels, Vec<Angle>, usize)> = Vec::new();
        for (levels, bends) in patients.iter().map(|one| one.levels).zip(bends) {
            let place = by_levels.iter().position(|one| one.0 == levels).unwrap_or_else(|| {
                by_levels.push((levels, vec![Angle::ZERO; levels.joints()], 0));
                by_levels.len() - 1
            });
            let (_, sums, count) = &mut by_levels[place];
            *count += bends.len();
            for bend in bends {
                for (sum, rotation) in sums.iter_mut().zip(bend) {
                    *sum = *sum + *rotation;
                }
            }
        }
        Self { by_levels }
    }

    /// The mean over the bends of all other patients than one with these bends; `None` where there is none.
    fn mean_of_others(&self, levels: Levels, own: &[Vec<Angle>]) -> Option<Vec<Angle>> {
        let (_, sums, count) = self.by_levels.iter().find(|one| one.0 == levels)?;
        let others = count - own.len();
        let mean = |(joint, sum): (usize, &Angle)| {
            let of_own: f64 = own.iter().map(|bend| bend[joint].rad()).sum();
            Angle::from_rad((sum.rad() - of_own) / others as f64)
        };
        (others > 0).then(|| sums.iter().enumerate().map(mean).collect())
    }
}

/// The location errors of a model on a film of a patient; `None` where it has no result.
type ErrorsOf<Model> =
    for<'a> fn(&'a Predicted<'_>, Model, &'a PredictedFilm<'_>) -> Option<&'a [f64]>;

/// A model against a baseline; `None` where they have no film in common.
fn test<Model: Copy>(
    patients: &[Predicted<'_>],
    (model, errors_mm): (Model, ErrorsOf<Model>),
    (baseline, role): (Baseline, FilmRole),
    resampling: &Resampling,
) -> Option<BaselineTest<Model>> {
    let mut films = 0;
    let (mut of_model, mut of_baseline) = (Vec::new(), Vec::new());
    for patient in patients {
        let both = patient
            .films(role)
            .filter_map(|one| Some((errors_mm(patient, model, one)?, one.errors_mm(baseline)?)));
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for (first, second) in both {
            films += 1;
            a.extend_from_slice(first);
            b.extend_from_slice(second);
        }
        of_model.push(a);
        of_baseline.push(b);
    }
    let comparison = PairedComparison::new(&of_model, &of_baseline, resampling);
    (films > 0).then_some(BaselineTest { model, baseline, role, films, comparison, holm_p: None })
}
