//! Intervals of a model under loads, computed in the background.

use std::sync::Arc;

use spineline::uncertainty::{LandmarkNoise, LoadedUncertainty};
use spineline_files::{Replicates, Request, Simulated};

use crate::api::LineName;
use crate::jobs::{Ending, Job, Jobs};
use crate::result_cache::StudyResult;

/// All of them: one per study, of whichever line and loads.
pub type LoadIntervalJobs = Jobs<(), LoadIntervalWork, LoadedUncertainty>;
/// The intervals of one result.
pub type LoadIntervalJob = Job<LoadIntervalWork, LoadedUncertainty>;

/// What intervals are computed of.
#[derive(Debug)]
pub struct LoadIntervalWork {
    /// Line of action whose model is loaded.
    pub line: LineName,
    /// The load file as it was sent.
    pub file: String,
    /// The case's own model under these loads.
    pub simulated: Simulated,
}

impl LoadIntervalJobs {
    /// The intervals of this line; those of another line are none.
    pub fn of_line(
        &self,
        result: &Arc<StudyResult>,
        line: LineName,
    ) -> Option<Arc<LoadIntervalJob>> {
        self.of(result, ()).filter(|job| job.work.line == line)
    }
}

impl LoadIntervalJob {
    /// The intervals under the loads of this file and no others, and what was asked.
    pub fn found_of(&self, file: &str) -> Option<(&LoadedUncertainty, Request)> {
        let Ending::Done(found) = self.ending.get()? else { return None };
        if self.work.file != file {
            return None;
        }
        let (count, seed, noise) = (found.requested, found.seed, LandmarkNoise::Measured);
        let request = Request {
            options: self.result.analysis()?.options.clone(),
            replicates: Some(Replicates { count, noise, seed }),
            identifiability: false,
        };
        Some((found, request))
    }
}
