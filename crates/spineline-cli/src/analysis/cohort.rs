//! Several patients together.

use spineline::cohort::{Cohort, CohortPatient, Listed, RefusedCase};
use spineline_files::CohortFile;

use super::kept::{KeptPatients, KeptRows};
use crate::run::failure::Failure;
use crate::run::progress;
use crate::run::threads::Pool;

/// Seed of the bootstrap over patients.
const BOOTSTRAP_SEED: u64 = 1;

/// Statistics over all patients.
pub fn of(patients: &[CohortPatient]) -> Cohort {
    Cohort::of(patients, BOOTSTRAP_SEED)
}

/// The same without the values behind them, which pictures alone show.
///
/// # Errors
/// If a patient cannot be read again, or the threads cannot be started.
pub fn of_kept(
    patients: &mut KeptPatients,
    listed: Listed,
    threads: usize,
) -> Result<Cohort, Failure> {
    let (rows, pool) = (&mut KeptRows::default(), Pool::new(threads)?);
    // Half a minute for 100,000 patients.
    let shown = progress::working("statistics over all patients");
    let cohort = Cohort::of_source(patients, rows, listed, BOOTSTRAP_SEED, &pool);
    shown.finish_and_clear();
    cohort
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
