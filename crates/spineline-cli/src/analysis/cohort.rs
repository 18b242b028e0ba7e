//! Several patients together.

use spineline::cohort::{Cohort, CohortPatient, RefusedCase};
use spineline_files::CohortFile;

use crate::run::failure::Failure;
use crate::run::progress;
use crate::run::threads::Pool;

/// Seed of the bootstrap over patients.
const BOOTSTRAP_SEED: u64 = 1;

/// Statistics over all patients; 0 threads uses all cores.
///
/// # Errors
/// If the threads cannot be started.
pub fn of(patients: &[CohortPatient], threads: usize) -> Result<Cohort, Failure> {
    let pool = Pool::new(threads)?;
    // Half a minute for 100,000 patients.
    let shown = progress::working("statistics over all patients");
    let cohort = Cohort::by(patients, BOOTSTRAP_SEED, &pool);
    shown.finish_and_clear();
    Ok(cohort)
}

/// The statistics as a file.
pub fn file(
    case_ids: Vec<String>,
    cohort: &Cohort,
    refused: &[RefusedCase],
    generator: &str,
) -> CohortFile {
    CohortFile::new(cohort, case_ids, refused, BOOTSTRAP_SEED, generator)
}
