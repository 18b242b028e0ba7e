//! Maps of pads in the background.

use spineline::analysis::PersonalisedModel;
use spineline::multibody::Loading;
use spineline::response::{PadEffect, PadTrial};

use crate::api::{LineName, PadMapRequest};
use crate::jobs::{Job, Jobs};

/// All maps: one per study, of whichever line. A map uses all cores.
pub type PadMapJobs = Jobs<(), PadMapWork, Vec<PadEffect>>;
/// A map of one result; it finds what every pad does, in the order of the trials.
pub type PadMapJob = Job<PadMapWork, Vec<PadEffect>>;

/// What is mapped.
#[derive(Debug)]
pub struct PadMapWork {
    /// Line of action whose model is loaded.
    pub line: LineName,
    /// Force, stiffness and other loads.
    pub request: PadMapRequest,
    /// The other loads on the model.
    pub others: Loading,
    /// The model.
    pub model: PersonalisedModel,
    /// The pads.
    pub trials: Vec<PadTrial>,
}
