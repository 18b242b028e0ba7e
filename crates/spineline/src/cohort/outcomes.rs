//! How often the bends of a cohort reject and keep a single force along a line.

use std::collections::BTreeSet;

use super::CohortPatient;
use crate::action::LineKind;
use crate::analysis::listed;
use crate::personalize::TestOutcome;
use crate::warning::counted;

/// How the tests of one hypothesis ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OutcomeCounts {
    /// Tests that reject it.
    pub rejected: usize,
    /// Tests that keep it.
    pub kept: usize,
    /// Tests that could not be made.
    pub not_tested: usize,
    /// Tests of patients with a film that may not show what it is named after: they are counted here alone.
    pub doubted: usize,
}

impl OutcomeCounts {
    /// Tests that were made.
    #[must_use]
    pub const fn tested(&self) -> usize {
        self.rejected + self.kept
    }

    fn add(&mut self, outcome: TestOutcome, is_doubted: bool) {
        let count = match outcome {
            _ if is_doubted => &mut self.doubted,
            TestOutcome::Rejected => &mut self.rejected,
            TestOutcome::Kept => &mut self.kept,
            TestOutcome::NotTested => &mut self.not_tested,
        };
        *count += 1;
    }

    /// The tests without an outcome, behind a comma; empty where all have one.
    fn others(&self) -> String {
        let counts = [(self.not_tested, "not tested"), (self.doubted, "with doubted films")];
        let parts: Vec<String> = counts
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, words)| format!("{count} {words}"))
            .collect();
        if parts.is_empty() { String::new() } else { format!(", {}", listed(&parts)) }
    }
}

/// How the bends of a cohort test a single force along a line that is not fitted to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LineOutcomes {
    /// The line.
    #[serde(skip)]
    pub kind: LineKind,
    /// By patient with a model of the line: all bends together.
    pub patients: OutcomeCounts,
    /// By bend, one by one: the line of best fit to its rotations against the line (p < 0.05), not corrected for many tests.
    pub bends: OutcomeCounts,
}

/// The level of the test, in words.
const LEVEL_OF_TEST: &str = "level of the test 5 %";

/// Least and most percent of synthetic patients and of their bends in which the test rejects a true line (`validation/claims.md`).
#[derive(Clone, Copy)]
struct TrueLineRejected {
    patients: [u8; 2],
    bends: [u8; 2],
}

impl TrueLineRejected {
    /// `None` where this was not counted.
    const fn of(kind: LineKind) -> Option<Self> {
        match kind {
            LineKind::Inflection => Some(Self { patients: [0, 4], bends: [1, 4] }),
            LineKind::Iliac => Some(Self { patients: [3, 11], bends: [6, 12] }),
            LineKind::Given | LineKind::Estimated => None,
        }
    }
}

/// How often the test rejects a true line.
fn size_of_test(of: &str, percent: Option<[u8; 2]>) -> String {
    percent.map_or_else(
        || LEVEL_OF_TEST.to_owned(),
        |[low, high]| format!("on synthetic {of} a true line is rejected in {low} to {high} %"),
    )
}

impl LineOutcomes {
    /// By line with a test in some patient.
    pub(super) fn all(patients: &[CohortPatient]) -> Vec<Self> {
        let kinds = patients.iter().flat_map(|patient| patient.tested.iter().map(|one| one.0));
        let all = kinds.collect::<BTreeSet<LineKind>>();
        all.into_iter().map(|kind| Self::of(kind, patients)).collect()
    }

    fn of(kind: LineKind, patients: &[CohortPatient]) -> Self {
        let [mut by_patient, mut by_bend] = [OutcomeCounts::default(); 2];
        for patient in patients {
            let is_doubted = patient.has_doubted_film();
            for (counts, tested) in
                [(&mut by_patient, &patient.tested), (&mut by_bend, &patient.tested_bends)]
            {
                let own = tested.iter().filter(|one| one.0 == kind);
                own.for_each(|one| counts.add(one.1, is_doubted));
            }
        }
        Self { kind, patients: by_patient, bends: by_bend }
    }

    /// In how many patients, and in how many bends alone, the line is rejected.
    pub(super) fn sentences(&self) -> Vec<String> {
        let Self { kind, patients, bends } = self;
        let others = patients.others();
        if patients.tested() == 0 {
            let needs = match kind {
                LineKind::Iliac => "the iliac crests and a line of best fit to the rotations",
                _ => "a line of best fit to the rotations",
            };
            return vec![format!(
                "A single force along the {kind} is tested in no patient: {}. A test needs {needs}.",
                others.trim_start_matches(", ")
            )];
        }
        let sizes = TrueLineRejected::of(*kind);
        let mut all = vec![format!(
            "A single force along the {kind} is rejected in {} of {} (kept in {}{others}); {}.",
            patients.rejected,
            counted_tested(patients.tested(), "patient"),
            patients.kept,
            size_of_test("patients", sizes.map(|sizes| sizes.patients)),
        )];
        let claim = match kind {
            LineKind::Inflection => "runs through the inflections",
            LineKind::Iliac => "is parallel to the iliac line",
            LineKind::Given | LineKind::Estimated => "is the given line",
        };
        if bends.tested() > 0 {
            all.push(format!(
                "That the line of best fit to the rotations {claim} is rejected in {} of {} one by one (kept in {}{}); {}.",
                bends.rejected,
                counted_tested(bends.tested(), "bend"),
                bends.kept,
                bends.others(),
                size_of_test("bends", sizes.map(|sizes| sizes.bends)),
            ));
        }
        all
    }
}

/// "1 tested patient", "3 tested patients".
fn counted_tested(number: usize, of: &str) -> String {
    counted(number, &format!("tested {of}"))
}
