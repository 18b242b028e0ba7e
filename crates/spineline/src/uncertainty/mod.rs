//! The noise of landmarks through the whole pipeline: case → distribution of every number of its analysis.
//!
//! # Model
//! A replicate is the case with every landmark of every reading perturbed by independent normal noise, analysed again from
//! the corners on. The mean of `n` readings has the standard deviation of one over `√n`. The variation of the case's
//! readings is the default standard deviation ([`LandmarkNoise::Measured`]). The distribution of a quantity over replicates
//! shows the effect of that noise. Its random numbers depend on the seed, the case's identifier and the number of the replicate.
//!
//! The corners of a lateral film are perturbed too, with their own deviation ([`crate::measure::SpatialOutline`]).
//!
//! Every replicate takes two things from the case without a change: the options, and the deviations by which frontal films are
//! weighted ([`crate::measure::Noise`]: perturbed readings contain noise twice, and would give too large ones).
//!
//! # What it does not say
//! Noise that all readers share, the error of the erect film's own scale, the choice of levels and the model's own faults are
//! not in it. The scale of every other film against the erect one is found anew in every replicate. Where a
//! number is found by a choice (which inflections, which order, which force) its distribution may have several modes; the
//! interval covers them all. Replicates vary about the case as it was read, not about the true values.
//!
//! # Use
//! ```
//! use spineline::{analysis::analyze, uncertainty::{LandmarkNoise, MonteCarlo}};
//! # let case = spineline_phantom::generate(0, spineline_phantom::Scenario::Rod, &Default::default(), 1)?.case;
//! let nominal = analyze(&case, &Default::default())?;
//! let monte_carlo = MonteCarlo::new(&case, &nominal, LandmarkNoise::Measured, 1)?;
//! let mut tally = monte_carlo.tally();
//! for index in 0..3 {
//!     // Compute on any thread, in any order; add in the order of the indices.
//!     tally.add(&monte_carlo.replicate(index));
//! }
//! assert_eq!(tally.finish(3).done, 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # References
//! [efron-tibshirani-1993], chapter 6 (parametric bootstrap) and 13 (percentile intervals).

mod centred;
mod distribution;
mod landmarks;
mod loaded;
mod quantities;
mod stream;
mod tally;
mod values;
mod words;

pub use centred::Spread;
pub use landmarks::{FilmNoise, LandmarkNoise, NoiseSource, UncertaintyError, VertebraNoise};
pub use loaded::{AppliedLoads, LoadedReplicate, LoadedSpread, LoadedTally, LoadedUncertainty};
pub use quantities::{AnalysisQuantity, QuantityKind, QuantityUnit};
pub use tally::{FailureCount, MultiplierSpread, QuantitySpread, Tally, Uncertainty};
pub use values::Absent;

use crate::action::LineKind;
use crate::analysis::{Analysis, Case, FitStarts, Replicated, analyze_films};
use crate::anatomy::Posture;
use crate::measure::OutlineNoise;
use crate::personalize::FitStatus;
use crate::warning::WarningCode;
use landmarks::NoisyCase;

/// A case, its analysis, and the noise that is laid on it.
#[derive(Debug, Clone)]
pub struct MonteCarlo<'a> {
    nominal: &'a Analysis,
    noisy: NoisyCase,
    /// Standard deviations of the case's films, in the order of the postures.
    noise: Vec<OutlineNoise>,
    /// The case's fits.
    starts: Option<FitStarts<'a>>,
    quantities: Vec<AnalysisQuantity>,
    seed: u64,
}

/// The result of one replicate.
#[derive(Debug, Clone, PartialEq)]
pub struct Replicate {
    /// One value per quantity, or why it has none; or the code of the error that stopped the analysis.
    values: Result<Vec<Result<f64, Absent>>, &'static str>,
    /// Places of the quantities that bounds of a fit determine.
    at_bounds: Vec<usize>,
    /// Fits and simulations without result: code, line, and film.
    endings: Vec<(&'static str, LineKind, Option<Posture>)>,
}

impl<'a> MonteCarlo<'a> {
    /// Prepares replicates of a case that was analysed already, with the options of that analysis.
    ///
    /// # Errors
    /// [`UncertaintyError`]: a deviation below zero, or one in pixels for a film without corners.
    pub fn new(
        case: &Case,
        nominal: &'a Analysis,
        noise: LandmarkNoise,
        seed: u64,
    ) -> Result<Self, UncertaintyError> {
        let movement = &nominal.movement;
        let has_models =
            movement.bends().next().is_some() && movement.film_without_scale().is_none();
        let kinds = if has_models { nominal.options.line_kinds() } else { Vec::new() };
        Ok(Self {
            nominal,
            noisy: NoisyCase::new(case, nominal, noise, seed)?,
            noise: nominal.movement.films.iter().map(|p| OutlineNoise::of(&p.outline)).collect(),
            starts: Some(FitStarts::of(nominal)),
            quantities: quantities::all_of(nominal, &kinds),
            seed,
        })
    }

    /// The same, where every replicate searches for its fits as if the case had none: slower.
    ///
    /// Else a replicate follows all minima that were found for the case, and searches anew where it fits much worse.
    #[must_use]
    pub fn searching_anew(mut self) -> Self {
        self.starts = None;
        self
    }

    /// One replicate; every case, by its identifier, and index has its own random stream, so that any may be computed alone, in
    /// any order.
    #[must_use]
    pub fn replicate(&self, index: u64) -> Replicate {
        match self.analysis_of(index) {
            Ok(analysis) => Replicate {
                values: Ok(self.values_in(&analysis)),
                at_bounds: self.at_bounds_in(&analysis),
                endings: endings(&analysis),
            },
            Err(code) => {
                Replicate { values: Err(code), at_bounds: Vec::new(), endings: Vec::new() }
            }
        }
    }

    /// The analysis of one replicate, or the code of the error that stopped it.
    fn analysis_of(&self, index: u64) -> Result<Analysis, &'static str> {
        let (case, errors) = self.noisy.replicate(index);
        let replicated = Replicated { noise: &self.noise, errors: &errors };
        analyze_films(&case, &self.nominal.options, Some(replicated), self.starts.as_ref())
            .map_err(|error| error.code())
    }

    /// One value per quantity of an analysis of this case, or why it has none.
    fn values_in(&self, analysis: &Analysis) -> Vec<Result<f64, Absent>> {
        let measures = analysis.movement.spatial_measures();
        let value =
            |quantity: &AnalysisQuantity| quantity.value(analysis, measures.as_ref(), self.nominal);
        self.quantities.iter().map(value).collect()
    }

    /// Places of the quantities that bounds of a fit determine in an analysis of this case.
    fn at_bounds_in(&self, analysis: &Analysis) -> Vec<usize> {
        let places = 0..self.quantities.len();
        places.filter(|&place| self.quantities[place].is_at_bound(analysis)).collect()
    }
}

fn endings(analysis: &Analysis) -> Vec<(&'static str, LineKind, Option<Posture>)> {
    let mut endings = Vec::new();
    for model in &analysis.models {
        if model.fit.status != FitStatus::Converged {
            // Nothing that follows from such a fit counts.
            endings.push((WarningCode::FitNotConverged.key(), model.kind, None));
            continue;
        }
        let lost = model.simulations.iter().filter(|simulation| !simulation.is_usable());
        endings.extend(
            lost.map(|s| (WarningCode::ForceNotFound.key(), model.kind, Some(s.shape.posture))),
        );
    }
    endings
}
