//! Predictions without mechanics over many patients, and whether lines of action and other loads predict better.

use super::census::Gathering;
use super::comparison::{ComparisonOutcome, corrected_by_holm};
use super::others::PREDICTED;
use super::patient::{CohortPatient, PatientFilmUnderLines};
use super::rows::RowsInMemory;
use super::samples::{Kept, Samples};
use super::workers::OneThread;
use super::{Clustered, PairedComparison, Seen};
use crate::action::LineKind;
use crate::analysis::{Analysis, FilmRole, listed, probability};
use crate::evaluate::Baseline;
use crate::evaluate::statistics::Resampling;
use crate::hypothesis::Hypothesis;

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
    /// What the test says of the model.
    #[must_use]
    pub fn outcome(&self) -> ComparisonOutcome {
        self.comparison.outcome(self.holm_p)
    }

    /// Whether the model predicts better, significantly.
    #[must_use]
    pub fn is_better(&self) -> bool {
        self.outcome() == ComparisonOutcome::Better
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

impl BaselinesOverPatients {
    /// Asks for the samples of the lines and of other loads and bases; gives what makes the result of them.
    pub(super) fn ask(
        kinds: &[LineKind],
        hypotheses: &[Hypothesis],
        samples: &mut Samples,
    ) -> impl FnOnce(&mut Samples) -> Self + use<> {
        let errors: Vec<_> =
            cells().map(|(baseline, role)| errors(baseline, role, samples)).collect();
        let tests = tests_of(kinds, line_errors_mm, samples);
        let hypothesis_tests = tests_of(hypotheses, hypothesis_errors_mm, samples);
        move |samples| Self {
            errors: errors.into_iter().filter_map(|errors| errors(samples)).collect(),
            tests: tests(samples),
            hypothesis_tests: hypothesis_tests(samples),
        }
    }

    /// The models of one patient beside what is predicted without mechanics and without other patients: differences, with no
    /// interval and no test.
    #[must_use]
    pub fn of_patient(analysis: &Analysis) -> Self {
        // One patient is not resampled.
        let resampling = Resampling::new(1, 0);
        let mut patients = &[CohortPatient::of(analysis)][..];
        let Ok(mut gathering) =
            Gathering::begin(&mut patients, resampling, Kept { values: false, listed: 0 });
        let Gathering { census, samples, .. } = &mut gathering;
        let found = Self::ask(&census.kinds(), &census.hypotheses, samples);
        let rows = &mut RowsInMemory::default();
        let Ok(()) = gathering.go_through(&mut patients, rows, &OneThread);
        found(&mut gathering.samples)
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

/// Asks for the errors of a baseline on the films of a role; `None` where it predicts none.
fn errors(
    baseline: Baseline,
    role: FilmRole,
    samples: &mut Samples,
) -> impl FnOnce(&mut Samples) -> Option<BaselineErrors> + use<> {
    let location = samples.sample(move |seen, values| {
        seen.films(role)
            .filter_map(|film| film.errors_mm(baseline))
            .for_each(|errors| values.extend_from_slice(errors));
    });
    let films = samples.count(move |seen| {
        seen.films(role).filter(|film| film.errors_mm(baseline).is_some()).count()
    });
    move |samples| {
        let films = samples.number(films);
        (films > 0).then(|| {
            let location_mm = samples.clustered(location);
            BaselineErrors { baseline, role, films, location_mm }
        })
    }
}

/// Asks for all models against every baseline that knows no more of a film than they do, as one family.
fn tests_of<Model: Copy + 'static>(
    models: &[Model],
    errors_mm: ErrorsOf<Model>,
    samples: &mut Samples,
) -> impl FnOnce(&mut Samples) -> Vec<BaselineTest<Model>> + use<Model> {
    let fair = || cells().filter(|(baseline, _)| !baseline.knows_tilt());
    let pairs = models.iter().flat_map(|&model| fair().map(move |cell| (model, cell)));
    let asked: Vec<_> = pairs
        .map(|(model, (baseline, role))| test(model, errors_mm, baseline, role, samples))
        .collect();
    move |samples| {
        let found = asked.into_iter().filter_map(|test| test(samples));
        let mut tests: Vec<BaselineTest<Model>> = found.collect();
        let corrected = corrected_by_holm(tests.iter().map(|test| &test.comparison));
        for (test, holm_p) in tests.iter_mut().zip(corrected) {
            test.holm_p = holm_p;
        }
        tests
    }
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
        let of = |outcome: ComparisonOutcome| -> Vec<String> {
            let found = tests.iter().filter(|test| test.outcome() == outcome);
            found
                .map(|test| format!("{} ({:+.1} mm)", test.model, test.comparison.mean_difference))
                .collect()
        };
        let (worse, same) = (of(ComparisonOutcome::Worse), of(ComparisonOutcome::NoDifference));
        let parts: Vec<String> = [(worse, "worse"), (same, "not significantly different")]
            .into_iter()
            .filter(|(models, _)| !models.is_empty())
            .map(|(models, words)| format!("{} {words}: {}", models.len(), listed(&models)))
            .collect();
        (!parts.is_empty()).then(|| {
            format!(
                "Other loads and bases beside {best}, {} tested: {}.",
                tests.len(),
                parts.join("; ")
            )
        })
    }
}

/// A line beside the best prediction without mechanics: whether it is better or worse, or neither.
fn line_sentence(test: &BaselineTest) -> Option<String> {
    let [low, high] = test.comparison.bootstrap?;
    let difference = test.comparison.mean_difference;
    let sense = if difference < 0.0 { "smaller" } else { "larger" };
    let verdict = match test.outcome() {
        ComparisonOutcome::Better => "is better than",
        ComparisonOutcome::Worse => "is worse than",
        ComparisonOutcome::NoDifference => "is not significantly different from",
        ComparisonOutcome::NotTested => return None,
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

fn line_errors_mm<'a>(
    patient: &'a CohortPatient,
    line: LineKind,
    film: &'a PatientFilmUnderLines,
) -> Option<&'a [f64]> {
    Some(&patient.errors(film, line)?.location_mm)
}

fn hypothesis_errors_mm<'a>(
    patient: &'a CohortPatient,
    hypothesis: Hypothesis,
    film: &'a PatientFilmUnderLines,
) -> Option<&'a [f64]> {
    let fit = patient.hypotheses.iter().find(|fit| fit.hypothesis == hypothesis)?;
    let found = fit.films.iter().find(|one| one.0 == film.posture && one.1 == film.role)?;
    Some(&found.2)
}

/// The location errors of a model on a film of a patient; `None` where it has no result.
type ErrorsOf<Model> =
    for<'a> fn(&'a CohortPatient, Model, &'a PatientFilmUnderLines) -> Option<&'a [f64]>;

/// Asks for a model against a baseline; `None` where they have no film in common.
fn test<Model: Copy + 'static>(
    model: Model,
    errors_mm: ErrorsOf<Model>,
    baseline: Baseline,
    role: FilmRole,
    samples: &mut Samples,
) -> impl FnOnce(&mut Samples) -> Option<BaselineTest<Model>> + use<Model> {
    let both = move |seen: &Seen<'_>, take: &mut dyn FnMut(&[f64], &[f64])| {
        for one in seen.films(role) {
            let of_model = errors_mm(seen.patient, model, one.film);
            if let Some((first, second)) = of_model.zip(one.errors_mm(baseline)) {
                take(first, second);
            }
        }
    };
    let compared = samples.pair(move |seen, [a, b]| {
        both(seen, &mut |first, second| {
            a.extend_from_slice(first);
            b.extend_from_slice(second);
        });
    });
    let films = samples.count(move |seen| {
        let mut films = 0;
        both(seen, &mut |_, _| films += 1);
        films
    });
    move |samples| {
        let films = samples.number(films);
        (films > 0).then(|| {
            let comparison = samples.comparison(compared);
            BaselineTest { model, baseline, role, films, comparison, holm_p: None }
        })
    }
}
