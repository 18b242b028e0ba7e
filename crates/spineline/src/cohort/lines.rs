//! The lines of action of many patients on the same films.

use super::comparison::corrected_by_holm;
use super::patient::{CohortPatient, FilmErrors, PatientFilmUnderLines};
use super::{Clustered, PairedComparison};
use crate::action::LineKind;
use crate::analysis::{FilmRole, FreeNumbers, LineModel};
use crate::anatomy::Posture;
use crate::evaluate::Simulation;
use crate::evaluate::statistics::Resampling;
use crate::multibody::MatchStatus;
use crate::personalize::SIGNIFICANCE;

/// Which error is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// Distance of vertebrae, in mm: what a verdict is about.
    Location,
    /// Absolute errors of Ferguson angles, in degrees.
    Ferguson,
}

impl ErrorKind {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Location, Self::Ferguson];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Location => "location_mm",
            Self::Ferguson => "ferguson_deg",
        }
    }

    /// What it is measured in.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Location => "mm",
            Self::Ferguson => "°",
        }
    }

    fn of(self, errors: &FilmErrors) -> &[f64] {
        match self {
            Self::Location => &errors.location_mm,
            Self::Ferguson => &errors.ferguson_deg,
        }
    }
}

/// Errors of one line over the films of a role that all lines of the cohort could simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct RoleErrors {
    /// The line.
    pub kind: LineKind,
    /// What the stiffness knew of the films.
    pub role: FilmRole,
    /// Films in the comparison.
    pub films: usize,
    /// Films that are not, since some line has no result on them.
    pub left_out: usize,
    /// Location errors, in mm.
    pub location_mm: Clustered,
    /// Absolute Ferguson errors, in degrees.
    pub ferguson_deg: Clustered,
}

/// Two lines on the films of a role that both could simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct LinePairTest {
    /// First and second line; differences are first minus second, so that a negative one is the first's advantage.
    pub lines: [LineKind; 2],
    /// What the stiffness knew of the films.
    pub role: FilmRole,
    /// Which error.
    pub error: ErrorKind,
    /// Films in the comparison.
    pub films: usize,
    /// Films that are not, since one of the two has no result on them.
    pub left_out: usize,
    /// The tests.
    pub comparison: PairedComparison,
    /// The sign-flip probability, corrected by Holm over all tests of the cohort's lines.
    pub holm_p: Option<f64>,
    /// Numbers that each line takes from a film before it predicts it.
    pub per_predicted_film: [usize; 2],
}

impl LinePairTest {
    /// The nearer line, where the difference is beyond chance in the whole family.
    #[must_use]
    pub fn nearer(&self) -> Option<LineKind> {
        let [first, second] = self.lines;
        self.holm_p
            .filter(|p| *p < SIGNIFICANCE)
            .map(|_| if self.comparison.mean_difference < 0.0 { first } else { second })
    }

    /// The line that predicts better: nearer on films that were not fitted, beyond chance, and without taking more
    /// numbers from them than the other.
    #[must_use]
    pub fn predicts_better(&self) -> Option<LineKind> {
        let nearer = self.nearer().filter(|_| self.role != FilmRole::Fitted)?;
        let [first, second] = self.per_predicted_film;
        let (own, other) = if nearer == self.lines[0] { (first, second) } else { (second, first) };
        (own <= other).then_some(nearer)
    }
}

/// Why a line has no result on a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoResult {
    /// The patient has no model of this line; for a left-out bend, none that was fitted to the other bend.
    NoModel,
    /// The line has no place on the film.
    NoLine,
    /// No force up to the limit gives the shape that was asked for.
    Unreachable,
    /// The search for the force did not converge.
    NotConverged,
    /// The shape that was found is beyond the human range of motion.
    BeyondHumanRange,
}

impl NoResult {
    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::NoModel => "no_model",
            Self::NoLine => "no_line",
            Self::Unreachable => MatchStatus::Unreachable.key(),
            Self::NotConverged => MatchStatus::NotConverged.key(),
            Self::BeyondHumanRange => MatchStatus::BeyondHumanRange.key(),
        }
    }
}

/// The shape of a line's model on a film, or why there is none.
pub(super) fn result_on(
    models: &[LineModel],
    kind: LineKind,
    posture: Posture,
) -> Result<&Simulation, NoResult> {
    let model = models.iter().find(|model| model.kind == kind).ok_or(NoResult::NoModel)?;
    let simulation = model.posture(posture).ok_or(NoResult::NoLine)?;
    match simulation.status {
        MatchStatus::Matched => Ok(simulation),
        MatchStatus::Unreachable => Err(NoResult::Unreachable),
        MatchStatus::NotConverged => Err(NoResult::NotConverged),
        MatchStatus::BeyondHumanRange => Err(NoResult::BeyondHumanRange),
    }
}

/// A line without a result on a film: the film is left out of the comparison of all lines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingResult {
    /// The patient.
    pub case_id: String,
    /// The film.
    pub posture: Posture,
    /// What the stiffness knew of the film.
    pub role: FilmRole,
    /// The line.
    pub kind: LineKind,
    /// Why.
    pub reason: NoResult,
}

/// The lines of many patients, on the same films.
#[derive(Debug, Clone, PartialEq)]
pub struct LinesOverPatients {
    /// Numbers that each line takes from films, of the first patient with a model of it.
    pub numbers: Vec<(LineKind, FreeNumbers)>,
    /// Whether all lines were fitted to the same data in every patient.
    pub same_data: bool,
    /// By line and role.
    pub errors: Vec<RoleErrors>,
    /// By pair of lines, role and error: one family.
    pub tests: Vec<LinePairTest>,
    /// Every film that is left out of the comparison of all lines, once per line without a result.
    pub missing: Vec<MissingResult>,
}

/// Films of one patient with the place of each of the cohort's lines among that patient's.
struct Patient<'a> {
    films: &'a [PatientFilmUnderLines],
    places: Vec<Option<usize>>,
}

impl<'a> Patient<'a> {
    fn films(&self, role: FilmRole) -> impl Iterator<Item = &'a PatientFilmUnderLines> + use<'a> {
        self.films.iter().filter(move |film| film.role == role)
    }

    fn errors(&self, film: &'a PatientFilmUnderLines, line: usize) -> Option<&'a FilmErrors> {
        film.by_line[self.places[line]?].as_ref().ok()
    }
}

impl LinesOverPatients {
    pub(super) fn of(all: &[CohortPatient], resampling: &Resampling) -> Self {
        let mut numbers: Vec<(LineKind, FreeNumbers)> = Vec::new();
        for line in all.iter().flat_map(|patient| &patient.lines) {
            if numbers.iter().all(|(kind, _)| *kind != line.kind) {
                numbers.push((line.kind, line.numbers));
            }
        }
        numbers.sort_by_key(|(kind, _)| *kind);
        let same_data = all.iter().all(|patient| patient.same_data);
        let kinds: Vec<LineKind> = numbers.iter().map(|(kind, _)| *kind).collect();
        let missing = all.iter().flat_map(|patient| missing(patient, &kinds)).collect();
        let patients: Vec<Patient<'_>> = all
            .iter()
            .map(|patient| {
                let place =
                    |kind: &LineKind| patient.lines.iter().position(|line| line.kind == *kind);
                Patient { places: kinds.iter().map(place).collect(), films: &patient.compared }
            })
            .collect();
        let lines: Vec<usize> = (0..numbers.len()).collect();
        let mut errors = Vec::new();
        for role in FilmRole::ALL {
            let common = common_films(&patients, role, &lines);
            for (place, &line) in lines.iter().enumerate() {
                let clustered = |error| Clustered::new(common.values(place, error), resampling);
                errors.push(RoleErrors {
                    kind: numbers[line].0,
                    role,
                    films: common.films,
                    left_out: common.left_out,
                    location_mm: clustered(ErrorKind::Location),
                    ferguson_deg: clustered(ErrorKind::Ferguson),
                });
            }
        }
        Self { tests: tests(&patients, &numbers, resampling), numbers, same_data, errors, missing }
    }
}

/// The lines of a cohort that have no result on a film of one patient.
fn missing(patient: &CohortPatient, kinds: &[LineKind]) -> Vec<MissingResult> {
    let mut all = Vec::new();
    for film in &patient.compared {
        all.extend(kinds.iter().filter_map(|&kind| {
            let line = patient.lines.iter().position(|line| line.kind == kind);
            let reason = match line {
                Some(line) => *film.by_line[line].as_ref().err()?,
                None => NoResult::NoModel,
            };
            let case_id = patient.case_id.clone();
            Some(MissingResult { case_id, posture: film.posture, role: film.role, kind, reason })
        }));
    }
    all
}

/// Errors on the films that some lines share: by patient and film, one per line.
struct Common<'a> {
    by_patient: Vec<Vec<Vec<&'a FilmErrors>>>,
    films: usize,
    left_out: usize,
}

impl Common<'_> {
    fn values(&self, place: usize, error: ErrorKind) -> Vec<Vec<f64>> {
        let patient = |films: &Vec<Vec<&FilmErrors>>| {
            films.iter().flat_map(|film| error.of(film[place])).copied().collect()
        };
        self.by_patient.iter().map(patient).collect()
    }
}

fn common_films<'a>(patients: &[Patient<'a>], role: FilmRole, lines: &[usize]) -> Common<'a> {
    let all: usize = patients.iter().map(|p| p.films(role).count()).sum();
    let by_patient: Vec<Vec<Vec<&FilmErrors>>> = patients
        .iter()
        .map(|p| {
            p.films(role)
                .filter_map(|film| lines.iter().map(|&line| p.errors(film, line)).collect())
                .collect()
        })
        .collect();
    let films = by_patient.iter().map(Vec::len).sum();
    Common { by_patient, films, left_out: all - films }
}

/// Every pair of lines on every kind of films by either error, corrected as one family.
fn tests(
    patients: &[Patient<'_>],
    numbers: &[(LineKind, FreeNumbers)],
    resampling: &Resampling,
) -> Vec<LinePairTest> {
    let mut tests = Vec::new();
    for first in 0..numbers.len() {
        for second in first + 1..numbers.len() {
            let of = |place: usize| numbers[place];
            for role in FilmRole::ALL {
                let common = common_films(patients, role, &[first, second]);
                for error in ErrorKind::ALL {
                    let [a, b] = [0, 1].map(|place| common.values(place, error));
                    tests.push(LinePairTest {
                        lines: [of(first).0, of(second).0],
                        role,
                        error,
                        films: common.films,
                        left_out: common.left_out,
                        comparison: PairedComparison::new(&a, &b, resampling),
                        holm_p: None,
                        per_predicted_film: [first, second].map(|i| of(i).1.per_predicted_film),
                    });
                }
            }
        }
    }
    let corrected = corrected_by_holm(tests.iter().map(|test| &test.comparison));
    for (test, holm_p) in tests.iter_mut().zip(corrected) {
        test.holm_p = holm_p;
    }
    tests
}
