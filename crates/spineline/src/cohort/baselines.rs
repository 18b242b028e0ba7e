//! Predictions without mechanics over many patients, and whether lines of action and other loads predict better.

use std::collections::BTreeSet;
use std::fmt::Display;

use super::comparison::{ComparisonOutcome, corrected_by_holm, too_few_words};
use super::others::Seen;
use super::patient::CohortPatient;
use super::patients::Patients;
use super::workers::OneThread;
use super::{Clustered, PairedComparison};
use crate::action::LineKind;
use crate::analysis::{Analysis, FilmPredictor, FilmRole, listed};
use crate::evaluate::Baseline;
use crate::evaluate::statistics::Resampling;
use crate::hypothesis::Hypothesis;
use crate::number::{fixed, probability, signed};

/// Location errors over all films of a role: of a prediction without mechanics, or of a line.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictionErrors<By = Baseline> {
    /// What predicts the films.
    pub by: By,
    /// Role of the films in the fits.
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
    /// Role of the films in the fits.
    pub role: FilmRole,
    /// Films in the comparison.
    pub films: usize,
    /// Location errors, model minus baseline: a negative difference is the model's advantage.
    pub comparison: PairedComparison,
    /// The sign-flip probability, corrected by Holm over all tests of such models against baselines; `None` where patients are too few
    /// for any significant difference.
    pub holm_p: Option<f64>,
}

impl<Model> BaselineTest<Model> {
    /// The outcome of the test for the model.
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

impl BaselineTest {
    /// Whether the line takes no more numbers from a film than the baseline: a free line does, unless both know T2's tilt.
    #[must_use]
    pub fn is_fair(&self) -> bool {
        self.model != LineKind::Estimated || self.baseline.knows_tilt()
    }

    /// The line as it was tested.
    #[must_use]
    pub const fn predictor(&self) -> FilmPredictor {
        if self.baseline.knows_tilt() {
            FilmPredictor::LineWithTilt(self.model)
        } else {
            FilmPredictor::Line(self.model)
        }
    }
}

/// The baselines of many patients.
#[derive(Debug, Clone, PartialEq)]
pub struct BaselinesOverPatients {
    /// By baseline and role; only those with a film.
    pub errors: Vec<PredictionErrors>,
    /// Of lines with T2's tilt, by line and role; only those with a film.
    pub lines_with_tilt: Vec<PredictionErrors<LineKind>>,
    /// By line, baseline and role: one family.
    pub tests: Vec<BaselineTest>,
    /// By other load and base, baseline and role: one family; empty if not requested.
    pub hypothesis_tests: Vec<BaselineTest<Hypothesis>>,
}

impl BaselinesOverPatients {
    /// `kinds` are the lines with a model.
    pub(super) fn of(all: &[CohortPatient], patients: &Patients<'_>, kinds: &[LineKind]) -> Self {
        let fitted = all.iter().flat_map(|patient| patient.hypotheses.iter().copied());
        let hypotheses: Vec<Hypothesis> = fitted.collect::<BTreeSet<_>>().into_iter().collect();
        Self {
            errors: errors(&Baseline::ALL, patients, |seen, film, one| seen.baseline_mm(film, one)),
            lines_with_tilt: errors(kinds, patients, |seen, film, kind| {
                seen.patient.line_mm(film, kind, true)
            }),
            tests: tests(kinds, CohortPatient::line_mm, patients),
            hypothesis_tests: tests(&hypotheses, CohortPatient::hypothesis_mm, patients),
        }
    }

    /// The models of one patient beside what is predicted without mechanics and without other patients: differences, without
    /// intervals and tests.
    #[must_use]
    pub fn of_patient(analysis: &Analysis) -> Self {
        let patient = &[CohortPatient::of(analysis)];
        // One patient is not resampled.
        let patients = Patients::new(patient, Resampling::new(1, 0), &OneThread, |_| true);
        let kinds: BTreeSet<LineKind> = patient[0].lines.iter().map(|line| line.kind).collect();
        Self::of(patient, &patients, &Vec::from_iter(kinds))
    }

    /// The prediction without mechanics with the smallest error on the films of a role, of those that lines are tested against, with or
    /// without T2's tilt.
    #[must_use]
    pub fn best(&self, role: FilmRole, with_tilt: bool) -> Option<&PredictionErrors> {
        let of_role = self.errors.iter().filter(|one| one.role == role);
        let same = of_role.filter(|one| one.by.is_tested() && one.by.knows_tilt() == with_tilt);
        same.min_by(|a, b| a.mean_mm().total_cmp(&b.mean_mm()))
    }

    /// The prediction with T2's tilt that lines are not tested against, where its error is smaller than the error of a line that is better
    /// than the best tested prediction.
    #[must_use]
    pub fn untested_sentence(&self, role: FilmRole) -> Option<String> {
        let best = self.best(role, true)?;
        let untested = self.errors.iter().find(|one| one.role == role && !one.by.is_tested())?;
        let lines = self.lines_with_tilt.iter().filter(|line| line.role == role);
        let mut above = lines.filter(|line| line.mean_mm() > untested.mean_mm());
        let is_better = |line: &PredictionErrors<LineKind>| {
            self.tests_against(best).any(|test| test.model == line.by && test.is_better())
        };
        above.any(is_better).then(|| {
            format!(
                "The {} has a smaller mean error on {} than such a line, {} mm; no line is tested against it, because it knows more.",
                untested.by.long_name(),
                role.films_words(),
                fixed(untested.mean_mm(), 1)
            )
        })
    }

    /// Tests of lines in the family that Holm's correction is over.
    #[must_use]
    pub fn family(&self) -> usize {
        self.tests.iter().filter(|test| test.comparison.is_compared()).count()
    }

    /// The tests of every line against this prediction.
    pub fn tests_against(&self, best: &PredictionErrors) -> impl Iterator<Item = &BaselineTest> {
        let of_best = |test: &&BaselineTest| (test.role, test.baseline) == (best.role, best.by);
        self.tests.iter().filter(of_best)
    }
}

impl<By> PredictionErrors<By> {
    /// Mean over patients of one mean per patient.
    #[must_use]
    pub fn mean_mm(&self) -> f64 {
        self.location_mm.patients.mean
    }
}

/// Each of these in every role of films that are predicted.
fn in_roles<By: Copy>(all: &[By]) -> impl Iterator<Item = (By, FilmRole)> {
    all.iter().flat_map(|&one| FilmRole::PREDICTED.map(|role| (one, role)))
}

/// The errors of every prediction on the films of a role, where it predicts any.
fn errors<By: Copy + Sync>(
    all: &[By],
    patients: &Patients<'_>,
    errors_mm: for<'a> fn(&'a Seen<'_>, u8, By) -> Option<&'a [f64]>,
) -> Vec<PredictionErrors<By>> {
    let cells: Vec<_> = in_roles(all).collect();
    let found = patients.clustered(&cells, |seen, &(by, role), values| {
        let films = seen.patient.places(role);
        let errors = films.filter_map(|film| errors_mm(seen, film, by));
        errors.for_each(|errors| values.extend_from_slice(errors));
    });
    let of_cell = |(&(by, role), location_mm): (&(By, FilmRole), Clustered)| {
        let films = patients.count(|seen| {
            let films = seen.patient.places(role);
            films.filter(|&film| errors_mm(seen, film, by).is_some()).count()
        });
        (films > 0).then_some(PredictionErrors { by, role, films, location_mm })
    };
    cells.iter().zip(found).filter_map(of_cell).collect()
}

/// The location errors of a model on a film of a patient, with or without T2's tilt; `None` where it has no result.
type ErrorsOf<Model> = fn(&CohortPatient, u8, Model, bool) -> Option<&[f64]>;

/// All models against every baseline, where both predict a film from the same numbers of T2, as one family.
fn tests<Model: Copy + Sync>(
    models: &[Model],
    errors_mm: ErrorsOf<Model>,
    patients: &Patients<'_>,
) -> Vec<BaselineTest<Model>> {
    let both = |seen: &Seen<'_>,
                (model, (baseline, role)): (Model, (Baseline, FilmRole)),
                take: &mut dyn FnMut(&[f64], &[f64])| {
        for film in seen.patient.places(role) {
            let of_model = errors_mm(seen.patient, film, model, baseline.knows_tilt());
            if let Some((first, second)) = of_model.zip(seen.baseline_mm(film, baseline)) {
                take(first, second);
            }
        }
    };
    let count = |pair| {
        patients.count(|seen| {
            let mut films = 0;
            both(seen, pair, &mut |_, _| films += 1);
            films
        })
    };
    let cells = || in_roles(&Baseline::ALL).filter(|(one, _)| one.is_tested());
    let pairs = models.iter().flat_map(|&model| cells().map(move |cell| (model, cell)));
    let (pairs, films): (Vec<_>, Vec<usize>) =
        pairs.map(|pair| (pair, count(pair))).filter(|(_, films)| *films > 0).unzip();
    let found = patients.compared(&pairs, |seen, &pair, [a, b]| {
        both(seen, pair, &mut |first, second| {
            a.extend_from_slice(first);
            b.extend_from_slice(second);
        });
    });
    let corrected = corrected_by_holm(&found);
    let test = |(((&(model, (baseline, role)), films), comparison), holm_p)| BaselineTest {
        model,
        baseline,
        role,
        films,
        comparison,
        holm_p,
    };
    pairs.iter().zip(films).zip(found).zip(corrected).map(test).collect()
}

impl BaselinesOverPatients {
    /// Errors of the predictions without mechanics, and the lines that predict better.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        FilmRole::PREDICTED.into_iter().flat_map(|role| self.of_role(role)).collect()
    }

    fn of_role(&self, role: FilmRole) -> Vec<String> {
        let baselines = |with_tilt| {
            let known = self.errors.iter().filter(move |one| one.by.knows_tilt() == with_tilt);
            errors_words(known, role)
        };
        let mut all = Vec::new();
        if let Some((best, words)) = self.best(role, false).zip(baselines(false)) {
            all.push(format!(
                "Errors of predictions without mechanics on {}: {words}.",
                role.films_words()
            ));
            all.extend(self.tests_against(best).filter_map(line_sentence));
            let is_tested = self.tests_against(best).any(|test| test.holm_p.is_some());
            let compared = || {
                let tests = self.tests_against(best).map(|test| &test.comparison);
                tests.filter(|comparison| comparison.is_compared())
            };
            let mut tests = self.tests_against(best);
            if !is_tested && compared().next().is_some() {
                all.push(format!(
                    "Too few patients to test the lines against {}: {}.",
                    best.by,
                    too_few_words(self.family(), compared())
                ));
            } else if is_tested && !tests.any(|test| test.is_fair() && test.is_better()) {
                all.push(format!(
                    "No line with one number from each film predicts them significantly better than {}: these films are not evidence that a prediction needs mechanics.",
                    best.by
                ));
            }
        }
        let lines = errors_words(self.lines_with_tilt.iter(), role);
        if let Some((best, words)) = self.best(role, true).zip(baselines(true)) {
            let lines = lines.map_or_else(String::new, |lines| format!("; by lines: {lines}"));
            all.push(format!("With the tilt of the top vertebra too: {words}{lines}."));
            all.extend(self.tests_against(best).filter_map(line_sentence));
            all.extend(self.untested_sentence(role));
        }
        let best = [false, true].into_iter().filter_map(|tilt| self.best(role, tilt));
        all.extend(best.filter_map(|best| self.hypotheses_sentence(role, best.by)));
        all
    }

    /// Which of the other loads and bases predict better and worse than the best prediction without mechanics.
    fn hypotheses_sentence(&self, role: FilmRole, best: Baseline) -> Option<String> {
        let of_best = |test: &&BaselineTest<Hypothesis>| {
            test.role == role && test.baseline == best && test.holm_p.is_some()
        };
        let tests: Vec<_> = self.hypothesis_tests.iter().filter(of_best).collect();
        let of = |outcome: ComparisonOutcome| -> Vec<String> {
            let found = tests.iter().filter(|test| test.outcome() == outcome);
            found
                .map(|test| {
                    format!("{} ({} mm)", test.model, signed(test.comparison.mean_difference, 1))
                })
                .collect()
        };
        let endings = [
            (ComparisonOutcome::Better, "better"),
            (ComparisonOutcome::Worse, "worse"),
            (ComparisonOutcome::NoDifference, "not significantly different"),
        ];
        let parts: Vec<String> = endings
            .into_iter()
            .map(|(outcome, words)| (of(outcome), words))
            .filter(|(models, _)| !models.is_empty())
            .map(|(models, words)| format!("{} {words}: {}", models.len(), listed(&models)))
            .collect();
        (!parts.is_empty()).then(|| {
            format!(
                "Other loads and bases beside {}, {} tested: {}.",
                best.long_name(),
                tests.len(),
                parts.join("; ")
            )
        })
    }
}

/// Mean errors of some predictions of the films of a role, the smallest first.
fn errors_words<'a, By: Display + 'a>(
    all: impl Iterator<Item = &'a PredictionErrors<By>>,
    role: FilmRole,
) -> Option<String> {
    let mut found: Vec<_> = all.filter(|one| one.role == role).collect();
    found.sort_by(|a, b| a.mean_mm().total_cmp(&b.mean_mm()));
    let words = |one: &&PredictionErrors<By>| format!("{} {} mm", one.by, fixed(one.mean_mm(), 1));
    (!found.is_empty()).then(|| listed(&found.iter().map(words).collect::<Vec<_>>()))
}

/// A line beside the best prediction without mechanics: whether it is better or worse, or neither.
fn line_sentence(test: &BaselineTest) -> Option<String> {
    let difference = test.comparison.mean_difference;
    let (sense, sign) = if difference < 0.0 { ("smaller", -1.0) } else { ("larger", 1.0) };
    let more = if test.is_fair() { "" } else { " (two more numbers from each film)" };
    let verdict = match test.outcome() {
        ComparisonOutcome::Better => "is better than",
        ComparisonOutcome::Worse => "is worse than",
        ComparisonOutcome::NoDifference => "is not significantly different from",
        ComparisonOutcome::NotTested => return None,
    };
    Some(format!(
        "There the {}{more} {verdict} {}: its error is {sense} by {} mm ({}; p {} after Holm's correction).",
        test.model,
        test.baseline.long_name(),
        fixed(difference.abs(), 1),
        test.comparison.patients_words(sign),
        probability(test.holm_p?)
    ))
}
