//! Several patients together.

use spineline::analysis::Analysis;
use spineline::cohort::Cohort;
use spineline_files::CohortFile;

/// Seed of the bootstrap over patients.
const BOOTSTRAP_SEED: u64 = 1;

/// Statistics over all patients.
pub fn of(analyses: &[Analysis]) -> Cohort {
    Cohort::of(&analyses.iter().collect::<Vec<_>>(), BOOTSTRAP_SEED)
}

/// The statistics as a file.
pub fn file(analyses: &[Analysis], cohort: &Cohort, generator: &str) -> CohortFile {
    let ids = analyses.iter().map(|analysis| analysis.case_id.clone()).collect();
    CohortFile::new(cohort, ids, BOOTSTRAP_SEED, generator)
}
