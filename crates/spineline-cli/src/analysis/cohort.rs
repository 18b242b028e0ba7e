//! Several patients together.

use spineline::cohort::{Cohort, CohortPatient};
use spineline_files::CohortFile;

/// Seed of the bootstrap over patients.
const BOOTSTRAP_SEED: u64 = 1;

/// Statistics over all patients.
pub fn of(patients: &[CohortPatient]) -> Cohort {
    Cohort::of(patients, BOOTSTRAP_SEED)
}

/// The statistics as a file.
pub fn file(patients: &[CohortPatient], cohort: &Cohort, generator: &str) -> CohortFile {
    let ids = patients.iter().map(|patient| patient.case_id().to_owned()).collect();
    CohortFile::new(cohort, ids, BOOTSTRAP_SEED, generator)
}
