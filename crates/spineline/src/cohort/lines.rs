//! The lines of action of many patients on the same films.

use super::comparison::corrected_by_holm;
use super::others::Seen;
use super::patient::{CohortPatient, FilmErrors, NoResult};
use super::patients::Patients;
use super::{Clustered, PairedComparison};
use crate::action::LineKind;
use crate::analysis::{FilmRole, FreeNumbers};
use crate::anatomy::Posture;
use crate::anatomy::named;
use crate::evaluate::statistics::Summary;
use crate::personalize::SIGNIFICANCE;

named! {
    /// Which error is compared.
    pub enum ErrorKind {
        /// Distance of vertebrae, in mm: the subject of a verdict.
        Location = "location_mm",
        /// Absolute errors of Ferguson angles, in degrees.
        Ferguson = "ferguson_deg",
    }
}

impl ErrorKind {
    /// Its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Location => "mm",
            Self::Ferguson => "°",
        }
    }

    pub(super) fn of(self, errors: FilmErrors<'_>) -> &[f64] {
        match self {
            Self::Location => errors.location_mm(),
            Self::Ferguson => errors.ferguson_deg(),
        }
    }
}

/// Errors of one line over the films of a role on which it has a result. Lines with results on different films are compared by
/// [`LinePairTest`] alone.
#[derive(Debug, Clone, PartialEq)]
pub struct RoleErrors {
    /// The line.
    pub kind: LineKind,
    /// Role of the films in the fit.
    pub role: FilmRole,
    /// Films with a result.
    pub films: usize,
    /// Films without a result.
    pub without_result: usize,
    /// Location errors, in mm.
    pub location_mm: Clustered,
    /// All of them, patient by patient.
    pub all_location_mm: Vec<f64>,
    /// Absolute Ferguson errors, in degrees.
    pub ferguson_deg: Clustered,
    /// Mean location error of every patient, in mm; NaN for one without such a film.
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
    /// Role of the films in the fit.
    pub role: FilmRole,
    /// Which error.
    pub error: ErrorKind,
    /// Films in the comparison.
    pub films: usize,
    /// Films on which one of the two lacks a result, or both.
    pub without_result: usize,
    /// The tests.
    pub comparison: PairedComparison,
    /// The sign-flip probability, corrected by Holm over all tests of the cohort's lines; `None` where patients are too few for any
    /// significant difference.
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

/// A line without a result on a film: the film does not count in a comparison of this line.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MissingResult {
    /// The patient.
    pub case_id: String,
    /// The film.
    pub posture: Posture,
    /// Role of the film in the fit.
    pub role: FilmRole,
    /// The line.
    #[serde(rename = "line")]
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
    /// The films on which a line lacks a result, once per such line.
    pub missing: Vec<MissingResult>,
}

impl LinesOverPatients {
    pub(super) fn of(all: &[CohortPatient], patients: &Patients<'_>) -> Self {
        let mut numbers: Vec<(LineKind, FreeNumbers)> = Vec::new();
        for line in all.iter().flat_map(|patient| &patient.lines) {
            if numbers.iter().all(|(kind, _)| *kind != line.kind) {
                numbers.push((line.kind, line.numbers));
            }
        }
        numbers.sort_by_key(|(kind, _)| *kind);
        let kinds: Vec<LineKind> = numbers.iter().map(|(kind, _)| *kind).collect();
        Self {
            same_data: all.iter().all(|patient| patient.same_data),
            errors: role_errors(&kinds, patients),
            tests: tests(&numbers, patients),
            missing: all.iter().flat_map(|patient| missing(patient, &kinds)).collect(),
            numbers,
        }
    }

    /// The lines with a model of some patient.
    pub fn kinds(&self) -> impl Iterator<Item = LineKind> {
        self.numbers.iter().map(|(kind, _)| *kind)
    }

    /// Errors of the lines on the films of a role.
    pub fn of_role(&self, role: FilmRole) -> impl Iterator<Item = &RoleErrors> {
        self.errors.iter().filter(move |errors| errors.role == role)
    }

    /// Errors of a line on the films of a role; `None` where no patient has a model of it.
    #[must_use]
    pub fn of_line(&self, kind: LineKind, role: FilmRole) -> Option<&RoleErrors> {
        self.of_role(role).find(|errors| errors.kind == kind)
    }

    /// Films of a role whose shape under a line does not count as a result.
    #[must_use]
    pub fn unusable(&self, kind: LineKind, role: FilmRole) -> usize {
        let of_line = self.missing.iter().filter(|one| (one.kind, one.role) == (kind, role));
        of_line.filter(|one| !matches!(one.reason, NoResult::NoModel | NoResult::NoLine)).count()
    }

    /// The test of two lines on the films of a role; `None` where no patient has a model of one of them.
    #[must_use]
    pub fn test(
        &self,
        lines: [LineKind; 2],
        role: FilmRole,
        error: ErrorKind,
    ) -> Option<&LinePairTest> {
        self.tests.iter().find(|one| (one.lines, one.role, one.error) == (lines, role, error))
    }

    /// The inflection line against the iliac line on fitted films, as the paper tests them.
    pub(super) fn paper_test(&self, error: ErrorKind, seed: u64) -> PairedComparison {
        let found = self.test([LineKind::Inflection, LineKind::Iliac], FilmRole::Fitted, error);
        found.map_or_else(
            || PairedComparison::of_differences(Summary::of(&[]), &[], None, seed),
            |test| test.comparison,
        )
    }
}

/// A line on the films of a role, by one of the errors.
type LineSample = (FilmRole, LineKind, ErrorKind);

fn add(seen: &Seen<'_>, sample: &LineSample, values: &mut Vec<f64>) {
    let &(role, kind, error) = sample;
    for [film] in seen.patient.films_of(role, [kind]) {
        values.extend_from_slice(error.of(film));
    }
}

/// Errors of every line over the films of every role on which it has a result.
fn role_errors(kinds: &[LineKind], patients: &Patients<'_>) -> Vec<RoleErrors> {
    let cells =
        FilmRole::ALL.into_iter().flat_map(|role| kinds.iter().map(move |&kind| (role, kind)));
    let samples: Vec<_> =
        cells.map(|(role, kind)| ErrorKind::ALL.map(|error| (role, kind, error))).collect();
    let found = patients.clustered(samples.as_flattened(), add);
    let of_cell = |(samples, &[location_mm, ferguson_deg]): (&[LineSample; 2], &[Clustered; 2])| {
        let (role, kind, _) = samples[0];
        let (films, without_result) = count_films(role, [kind], patients);
        RoleErrors {
            kind,
            role,
            films,
            without_result,
            location_mm,
            all_location_mm: patients.values(|seen, values| add(seen, &samples[0], values)),
            ferguson_deg,
            by_patient_mm: patients.means(|seen, values| add(seen, &samples[0], values)),
        }
    };
    samples.iter().zip(found.as_chunks().0).map(of_cell).collect()
}

/// On how many films of a role some lines all have a result, and how many others there are.
fn count_films<const N: usize>(
    role: FilmRole,
    kinds: [LineKind; N],
    patients: &Patients<'_>,
) -> (usize, usize) {
    let all = patients.count(|seen| seen.patient.places(role).count());
    let shared = patients.count(|seen| seen.patient.films_of(role, kinds).count());
    (shared, all - shared)
}

/// The lines of a cohort without a result on a film of one patient.
fn missing(patient: &CohortPatient, kinds: &[LineKind]) -> Vec<MissingResult> {
    let mut all = Vec::new();
    for (film, &(posture, role)) in (0..).zip(&patient.compared) {
        all.extend(kinds.iter().filter_map(|&kind| {
            let reason = patient.result(film, kind).err()?;
            let case_id = patient.case_id.to_string();
            Some(MissingResult { case_id, posture, role, kind, reason })
        }));
    }
    all
}

/// Two lines on the films of a role.
type LinePair = ([(LineKind, FreeNumbers); 2], FilmRole, ErrorKind);

/// Every pair of lines on every kind of films by either error, corrected as one family.
fn tests(numbers: &[(LineKind, FreeNumbers)], patients: &Patients<'_>) -> Vec<LinePairTest> {
    let mut pairs: Vec<LinePair> = Vec::new();
    for (place, &first) in numbers.iter().enumerate() {
        for &second in &numbers[place + 1..] {
            for role in FilmRole::ALL {
                pairs.extend(ErrorKind::ALL.map(|error| ([first, second], role, error)));
            }
        }
    }
    let found = patients.compared(&pairs, |seen, &([first, second], role, error), [a, b]| {
        for [first, second] in seen.patient.films_of(role, [first.0, second.0]) {
            a.extend_from_slice(error.of(first));
            b.extend_from_slice(error.of(second));
        }
    });
    let corrected = corrected_by_holm(&found);
    let tests = pairs.into_iter().zip(found).zip(corrected);
    tests
        .map(|(((both, role, error), comparison), holm_p)| {
            let lines = both.map(|(kind, _)| kind);
            let (films, without_result) = count_films(role, lines, patients);
            let per_predicted_film = both.map(|(_, numbers)| numbers.per_predicted_film);
            LinePairTest {
                lines,
                role,
                error,
                films,
                without_result,
                comparison,
                holm_p,
                per_predicted_film,
            }
        })
        .collect()
}
