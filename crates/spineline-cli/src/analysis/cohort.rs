//! Several patients together.

use std::path::PathBuf;

use spineline::analysis::Analysis;
use spineline::cohort::{Cohort, CohortPatient, RefusalStep, RefusedCase};

use super::case::{Refusal, analyze_member};
use super::record::{ReadCases, RunRecord};
use crate::run::failure::Failure;
use crate::run::inputs::CaseInput;
use crate::run::messages::say;
use crate::run::progress;
use crate::run::threads::{Pool, map_all};

/// Seed of the bootstrap over patients, where none is asked for.
pub const BOOTSTRAP_SEED: u64 = 1;

/// Statistics over all patients, with a seed of the bootstrap; 0 threads uses all cores.
pub fn of(patients: &[CohortPatient], seed: u64, threads: usize) -> Result<Cohort, Failure> {
    let pool = Pool::new(threads)?;
    // Half a minute for 100,000 patients.
    let shown = progress::working("statistics over all patients");
    let cohort = Cohort::by(patients, seed, &pool);
    shown.finish_and_clear();
    Ok(cohort)
}

/// The patients of a cohort, all in memory.
#[derive(Default)]
pub struct Members {
    /// One per patient.
    pub analyses: Vec<Analysis>,
    /// Their cases, with their files.
    pub sources: Vec<(PathBuf, CaseInput)>,
    /// Cases without a result.
    pub refused: Vec<RefusedCase>,
    pub read: ReadCases,
}

impl Members {
    /// Reads and analyses all cases; a case that fails is reported and left out.
    ///
    /// # Errors
    /// If no case is left, or the threads cannot be started.
    pub fn analyze(paths: &[PathBuf], record: &RunRecord, threads: usize) -> Result<Self, Failure> {
        let results = map_all("analysing", paths, threads, |path| analyze_member(path, record))?;
        let mut all = Self::default();
        for (path, result) in paths.iter().zip(results) {
            let found = result.and_then(|found| {
                all.read.add(&found.0, record).map_err(|failure| {
                    Refusal::new(path, Some(&found.0), RefusalStep::Counting, failure)
                })?;
                Ok(found)
            });
            match found {
                Ok((source, analysis)) => {
                    all.analyses.push(analysis);
                    all.sources.push((path.clone(), source));
                }
                Err(Refusal { case, failure }) => {
                    say(&failure);
                    all.refused.push(*case);
                }
            }
        }
        if all.analyses.is_empty() {
            return Err(Failure::usage("no case could be analysed"));
        }
        Ok(all)
    }
}
