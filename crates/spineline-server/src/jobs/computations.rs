//! Computations in the background, and their results.

use std::sync::Arc;

use spineline::analysis::Analysis;
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;

use super::{Job, Jobs, Work};
use crate::api::Computation;
use crate::result_cache::StudyResult;

/// A computation from one result.
pub type ComputationJob = Job<Computation>;

impl Work for Computation {
    type Found = Found;

    fn key(&self) -> &'static str {
        Self::key(*self)
    }
}

/// Result of a computation.
#[derive(Debug)]
pub enum Found {
    /// The effect of landmark noise on the numbers.
    Replicates(Box<Uncertainty>),
    /// By model of a line; `None` where its fit did not converge.
    Identifiability(Vec<Option<Identifiability>>),
    /// The analysis with the other loads and bases.
    Models(Box<Analysis>),
}

/// The finished computations of one result.
#[derive(Default)]
pub struct Computed(Vec<Arc<ComputationJob>>);

impl Computed {
    /// The effect of landmark noise on the results.
    pub fn uncertainty(&self) -> Option<&Uncertainty> {
        self.0.iter().find_map(|job| match job.found()? {
            Found::Replicates(found) => Some(&**found),
            _ => None,
        })
    }

    /// The identifiability of every multiplier, by model.
    pub fn identifiability(&self) -> Option<&[Option<Identifiability>]> {
        self.0.iter().find_map(|job| match job.found()? {
            Found::Identifiability(found) => Some(&found[..]),
            _ => None,
        })
    }

    /// The analysis with other loads and bases.
    pub fn models(&self) -> Option<&Analysis> {
        self.0.iter().find_map(|job| match job.found()? {
            Found::Models(found) => Some(&**found),
            _ => None,
        })
    }
}

impl Jobs<Computation> {
    /// The finished computations of these results.
    pub fn computed(&self, result: &Arc<StudyResult>) -> Computed {
        Computed(Computation::ALL.iter().filter_map(|name| self.of(result, name.key())).collect())
    }
}
