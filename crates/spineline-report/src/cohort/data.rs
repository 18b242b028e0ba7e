//! Data for the report of a cohort.

use spineline::analysis::{Analysis, Subject};
use spineline::cohort::{Cohort, RefusedCase};

/// Data for the report of a cohort.
#[derive(Debug, Clone, Copy)]
pub struct Patients<'a> {
    /// The results of every patient.
    pub analyses: &'a [Analysis],
    /// Data of the patients, in the same order.
    pub subjects: &'a [Subject],
    /// Their statistics.
    pub together: &'a Cohort,
    /// Excluded cases.
    pub refused: &'a [RefusedCase],
    /// Program that makes the report.
    pub generator: &'a str,
    /// The analyses as a JSON array, to be embedded.
    pub json: &'a str,
}
