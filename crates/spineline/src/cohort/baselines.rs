//! Predictions without mechanics over many patients, and whether lines of action predict better.

use super::comparison::corrected_by_holm;
use super::patient::{CohortPatient, PatientFilmUnderLines};
use super::rotation_prior::priors_of_others;
use super::{Clustered, PairedComparison};
use crate::action::LineKind;
use crate::analysis::{FilmRole, listed, probability};
use crate::anatomy::Levels;
use crate::evaluate::statistics::Resampling;
use crate::evaluate::{
    Baseline, BaselinePrediction, RotationPrior, predict_baseline, predict_from_prior,
};
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

/// A line against a baseline, on the films of a role that both predict.
#[derive(Debug, Clone, PartialEq)]
pub struct BaselineTest {
    /// The line.
    pub line: LineKind,
    /// The baseline.
    pub baseline: Baseline,
    /// What the films were to the models.
    pub role: FilmRole,
    /// Films in the comparison.
    pub films: usize,
    /// Location errors, line minus baseline: a negative difference is the line's advantage.
    pub comparison: PairedComparison,
    /// The sign-flip probability, corrected by Holm over all tests of lines against baselines.
    pub holm_p: Option<f64>,
}

impl BaselineTest {
    /// Whether the two differ beyond chance in the whole family.
    #[must_use]
    pub fn is_significant(&self) -> bool {
        self.holm_p.is_some_and(|p| p < SIGNIFICANCE)
    }

    /// Whether the line predicts better, beyond chance.
    #[must_use]
    pub fn line_is_better(&self) -> bool {
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
        let cells = || Baseline::ALL.into_iter().flat_map(|one| PREDICTED.map(|role| (one, role)));
        let fair = || cells().filter(|(baseline, _)| !baseline.knows_tilt());
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
        let pairs = kinds.into_iter().flat_map(|line| fair().map(move |cell| (line, cell)));
        let mut tests: Vec<BaselineTest> =
            pairs.filter_map(|(line, cell)| test(&patients, line, cell, resampling)).collect();
        let corrected = corrected_by_holm(tests.iter().map(|test| &test.comparison));
        for (test, holm_p) in tests.iter_mut().zip(corrected) {
            test.holm_p = holm_p;
        }
        Self { errors, tests }
    }
}

impl BaselinesOverPatients {
    /// What patterns of rotations predict without mechanics, and which lines predict better.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        PREDICTED.into_iter().flat_map(|role| self.of_role(role)).collect()
    }

    fn of_role(&self, role: FilmRole) -> Vec<String> {
        let mut found: Vec<&BaselineErrors> =
            self.errors.iter().filter(|one| one.role == role).collect();
        let mean = |one: &BaselineErrors| one.location_mm.patients.mean;
        found.sort_by(|a, b| mean(a).total_cmp(&mean(b)));
        let with_tilt = found.iter().position(|one| one.baseline.knows_tilt());
        let with_tilt = with_tilt.map(|place| found.remove(place));
        let Some(best) = found.first() else { return Vec::new() };
        let parts: Vec<String> =
            found.iter().map(|one| format!("{} {:.1} mm", one.baseline, mean(one))).collect();
        let films = films_words(role);
        let mut all = vec![format!("{films}, predicted without mechanics: {}.", listed(&parts))];
        all.extend(with_tilt.map(|one| {
            format!(
                "With T2's tilt as well as its location, the distribution of rotations predicts them to {:.1} mm; no line is compared with it, since a line knows T2's location alone.",
                mean(one)
            )
        }));
        let tests = self.tests.iter().filter(|test| test.role == role);
        let tests: Vec<&BaselineTest> =
            tests.filter(|test| test.baseline == best.baseline).collect();
        all.extend(tests.iter().filter(|test| test.is_significant()).filter_map(|test| {
            let [low, high] = test.comparison.bootstrap?;
            let difference = test.comparison.mean_difference;
            let sense = if difference < 0.0 { "smaller" } else { "larger" };
            let (least, most) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
            Some(format!(
                "There the error of the {} is {sense} than that of {} by {:.1} mm (95 % interval over {} patients {least:.1} to {most:.1} mm; p {} after Holm's correction).",
                test.line,
                best.baseline,
                difference.abs(),
                test.comparison.patients(),
                probability(test.holm_p?)
            ))
        }));
        if !tests.is_empty() && !tests.iter().any(|test| test.line_is_better()) {
            all.push(format!(
                "No line predicts them significantly better than {}: these films are no evidence that a prediction needs mechanics.",
                best.baseline
            ));
        }
        all
    }
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

/// A line against a baseline; `None` where they have no film in common.
fn test(
    patients: &[Predicted<'_>],
    line: LineKind,
    (baseline, role): (Baseline, FilmRole),
    resampling: &Resampling,
) -> Option<BaselineTest> {
    let mut films = 0;
    let (mut of_line, mut of_baseline) = (Vec::new(), Vec::new());
    for patient in patients {
        let place = patient.patient.lines.iter().position(|one| one.kind == line);
        let both = patient.films(role).filter_map(|one| {
            let simulated = one.film.by_line[place?].as_ref().ok()?;
            Some((&simulated.location_mm, one.errors_mm(baseline)?))
        });
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for (first, second) in both {
            films += 1;
            a.extend_from_slice(first);
            b.extend_from_slice(second);
        }
        of_line.push(a);
        of_baseline.push(b);
    }
    let comparison = PairedComparison::new(&of_line, &of_baseline, resampling);
    (films > 0).then_some(BaselineTest { line, baseline, role, films, comparison, holm_p: None })
}
