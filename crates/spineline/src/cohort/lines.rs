//! The lines of action of many patients on the same films.

use super::comparison::corrected_by_holm;
use super::patient::{CohortPatient, FilmErrors};
use super::samples::Samples;
use super::{Clustered, PairedComparison, Seen};
use crate::action::LineKind;
use crate::analysis::{FilmRole, FreeNumbers, LineModel};
use crate::anatomy::Posture;
use crate::anatomy::named;
use crate::evaluate::Simulation;
use crate::multibody::MatchStatus;
use crate::personalize::SIGNIFICANCE;

named! {
    /// Which error is compared.
    pub enum ErrorKind {
        /// Distance of vertebrae, in mm: what a verdict is about.
        Location = "location_mm",
        /// Absolute errors of Ferguson angles, in degrees.
        Ferguson = "ferguson_deg",
    }
}

impl ErrorKind {
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

/// Errors of one line over the films of a role on which it has a result. Lines with results on different films are compared by
/// [`LinePairTest`] alone.
#[derive(Debug, Clone, PartialEq)]
pub struct RoleErrors {
    /// The line.
    pub kind: LineKind,
    /// What the stiffness knew of the films.
    pub role: FilmRole,
    /// Films with a result.
    pub films: usize,
    /// Films on which it has none.
    pub without_result: usize,
    /// Location errors, in mm.
    pub location_mm: Clustered,
    /// Absolute Ferguson errors, in degrees.
    pub ferguson_deg: Clustered,
    /// Mean location error of every patient, in mm; NaN for one without such a film; as [`super::Listed`].
    pub by_patient_mm: Vec<f64>,
}

impl RoleErrors {
    /// Mean over patients of one mean location error per patient, in mm.
    #[must_use]
    pub const fn mean_location_mm(&self) -> f64 {
        self.location_mm.patients.mean
    }
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
    /// Films on which one of the two has no result, or both.
    pub without_result: usize,
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

    /// Whether both lines take equally many numbers from a film before they predict it.
    #[must_use]
    pub const fn is_fair(&self) -> bool {
        self.per_predicted_film[0] == self.per_predicted_film[1]
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

named! {
    /// Why a line has no result on a film.
    pub enum NoResult {
        /// The patient has no model of this line; for a left-out bend, none that was fitted to the other bend.
        NoModel = "no_model" as "the line has no model",
        /// The line has no place on the film.
        NoLine = "no_line" as "the line has no place on this film",
        /// No force up to the limit gives the shape that was asked for.
        Unreachable = "unreachable" as "no force up to the limit gives the shape",
        /// The search for the force did not converge.
        NotConverged = "not_converged" as "the search for the force did not converge",
        /// The shape that was found is beyond the human range of motion.
        BeyondHumanRange = "beyond_human_range" as "the shape found is beyond the human range of motion",
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
        MatchStatus::Converged => Ok(simulation),
        MatchStatus::Unreachable => Err(NoResult::Unreachable),
        MatchStatus::NotConverged => Err(NoResult::NotConverged),
        MatchStatus::BeyondHumanRange => Err(NoResult::BeyondHumanRange),
    }
}

/// A line without a result on a film: the film has no part in a comparison of this line.
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
    /// The films on which a line has no result, once per such line, as [`super::Listed`].
    pub missing: Vec<MissingResult>,
    /// All patients with such a film.
    pub with_missing: usize,
}

impl LinesOverPatients {
    /// Asks for the samples of these lines; gives what makes the result of them, without the films that lack a result.
    pub(super) fn ask(
        numbers: Vec<(LineKind, FreeNumbers)>,
        same_data: bool,
        samples: &mut Samples,
    ) -> impl FnOnce(&mut Samples) -> Self + use<> {
        let kinds: Vec<LineKind> = numbers.iter().map(|(kind, _)| *kind).collect();
        let errors: Vec<_> = FilmRole::ALL
            .into_iter()
            .flat_map(|role| kinds.iter().map(move |&kind| (role, kind)))
            .map(|(role, kind)| role_errors(role, kind, samples))
            .collect();
        let tests = tests(&numbers, samples);
        move |samples| Self {
            tests: tests(samples),
            numbers,
            same_data,
            errors: errors.into_iter().map(|errors| errors(samples)).collect(),
            missing: Vec::new(),
            with_missing: 0,
        }
    }
}

/// Asks for the errors of a line over the films of a role on which it has a result.
fn role_errors(
    role: FilmRole,
    kind: LineKind,
    samples: &mut Samples,
) -> impl FnOnce(&mut Samples) -> RoleErrors + use<> {
    let values = |error: ErrorKind| {
        move |seen: &Seen<'_>, values: &mut Vec<f64>| {
            for [film] in seen.patient.films_of(role, [kind]) {
                values.extend_from_slice(error.of(film));
            }
        }
    };
    let [location, ferguson] = ErrorKind::ALL.map(|error| samples.sample(values(error)));
    let by_patient = samples.average(values(ErrorKind::Location));
    let films = count_films(role, [kind], samples);
    move |samples| {
        let (films, without_result) = films(samples);
        RoleErrors {
            kind,
            role,
            films,
            without_result,
            location_mm: samples.clustered(location),
            ferguson_deg: samples.clustered(ferguson),
            by_patient_mm: samples.averages(by_patient),
        }
    }
}

/// Asks on how many films of a role some lines all have a result, and how many others there are.
fn count_films<const N: usize>(
    role: FilmRole,
    kinds: [LineKind; N],
    samples: &mut Samples,
) -> impl Fn(&Samples) -> (usize, usize) + use<N> {
    let all = samples
        .count(move |seen| seen.patient.compared.iter().filter(|film| film.role == role).count());
    let shared = samples.count(move |seen| seen.patient.films_of(role, kinds).count());
    move |samples| {
        let shared = samples.number(shared);
        (shared, samples.number(all) - shared)
    }
}

/// The lines of a cohort that have no result on a film of one patient.
pub(super) fn missing(patient: &CohortPatient, kinds: &[LineKind]) -> Vec<MissingResult> {
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

/// Asks for every pair of lines on every kind of films by either error, corrected as one family.
fn tests(
    numbers: &[(LineKind, FreeNumbers)],
    samples: &mut Samples,
) -> impl FnOnce(&mut Samples) -> Vec<LinePairTest> + use<> {
    let mut asked = Vec::new();
    for (place, &first) in numbers.iter().enumerate() {
        for &second in &numbers[place + 1..] {
            for role in FilmRole::ALL {
                asked.extend(
                    ErrorKind::ALL.map(|error| pair([first, second], role, error, samples)),
                );
            }
        }
    }
    move |samples| {
        let mut tests: Vec<LinePairTest> = asked.into_iter().map(|test| test(samples)).collect();
        let corrected = corrected_by_holm(tests.iter().map(|test| &test.comparison));
        for (test, holm_p) in tests.iter_mut().zip(corrected) {
            test.holm_p = holm_p;
        }
        tests
    }
}

/// Asks for two lines on the films of a role that both have a result on.
fn pair(
    both: [(LineKind, FreeNumbers); 2],
    role: FilmRole,
    error: ErrorKind,
    samples: &mut Samples,
) -> impl FnOnce(&mut Samples) -> LinePairTest + use<> {
    let lines = both.map(|(kind, _)| kind);
    let compared = samples.pair(move |seen, [a, b]| {
        for [first, second] in seen.patient.films_of(role, lines) {
            a.extend_from_slice(error.of(first));
            b.extend_from_slice(error.of(second));
        }
    });
    let films = count_films(role, lines, samples);
    move |samples| {
        let (films, without_result) = films(samples);
        LinePairTest {
            lines,
            role,
            error,
            films,
            without_result,
            comparison: samples.comparison(compared),
            holm_p: None,
            per_predicted_film: both.map(|(_, numbers)| numbers.per_predicted_film),
        }
    }
}
