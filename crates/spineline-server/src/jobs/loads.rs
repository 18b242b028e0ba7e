//! Models under loads, computed in the background: intervals, and maps of pads.

use std::sync::Arc;

use spineline::analysis::PersonalisedModel;
use spineline::multibody::Loading;
use spineline::response::{PadEffect, PadTrial};
use spineline::uncertainty::{LandmarkNoise, LoadedUncertainty};
use spineline_files::{Replicates, Request, Simulated};

use super::{Job, Jobs, Work};
use crate::api::{LineKindName, PadMapRequest};
use crate::result_cache::StudyResult;

/// The intervals of one result: one job per study, for any line and loads.
pub type LoadIntervalJob = Job<LoadIntervalWork>;
/// A map of one result: one job per study, for any line. A map uses all cores.
pub type PadMapJob = Job<PadMapWork>;

/// The model and loads of the intervals.
#[derive(Debug)]
pub struct LoadIntervalWork {
    /// Line of action whose model is loaded.
    pub line: LineKindName,
    /// The load file as it was sent.
    pub file: String,
    /// The case's own model under these loads.
    pub simulated: Simulated,
}

impl LoadIntervalWork {
    /// Name of its kind.
    pub const KEY: &str = "load_intervals";
}

impl Work for LoadIntervalWork {
    type Found = LoadedUncertainty;

    fn key(&self) -> &'static str {
        Self::KEY
    }
}

/// A pad that is tried at every level.
#[derive(Debug)]
pub struct PadMapWork {
    /// Line of action whose model is loaded.
    pub line: LineKindName,
    /// Force, stiffness and other loads.
    pub request: PadMapRequest,
    /// The other loads on the model.
    pub others: Loading,
    pub model: PersonalisedModel,
    pub trials: Vec<PadTrial>,
}

impl PadMapWork {
    /// Name of its kind.
    pub const KEY: &str = "pad_map";
}

impl Work for PadMapWork {
    /// The effect of every pad, in the order of the trials.
    type Found = Vec<PadEffect>;

    fn key(&self) -> &'static str {
        Self::KEY
    }
}

impl Jobs<LoadIntervalWork> {
    /// The intervals of this line; they are not shown for other lines.
    pub fn of_line(
        &self,
        result: &Arc<StudyResult>,
        line: LineKindName,
    ) -> Option<Arc<LoadIntervalJob>> {
        self.of(result, LoadIntervalWork::KEY).filter(|job| job.work.line == line)
    }
}

impl LoadIntervalJob {
    /// The intervals for this load file only, and the request.
    pub fn found_of(&self, file: &str) -> Option<(&LoadedUncertainty, Request)> {
        let found = self.found()?;
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
