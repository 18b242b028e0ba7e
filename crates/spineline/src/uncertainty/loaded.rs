//! Effect of landmark noise on a personalised model under loads: every replicate has its own model under the same loads.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::centred::Centred;
use super::values::fitted_model;
use super::words::noise_words;
use super::{FilmNoise, MonteCarlo, Spread};
use crate::action::LineKind;
use crate::analysis::Analysis;
use crate::multibody::{GeneralStatics, Goal, Loading, Support};
use crate::number::fixed;
use crate::response::{
    LoadedMeasure, LoadedQuantity, LoadedState, go_on, loaded_measures, respond, usual_limit,
};

/// Loads on the model of one line of action, and the goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppliedLoads<'a> {
    /// Line of action that the stiffness was fitted with.
    pub kind: LineKind,
    /// Support of the patient.
    pub support: Support,
    /// The same loads for every replicate.
    pub loading: &'a Loading,
    /// The goal.
    pub goal: Goal,
    /// Largest load factor that is looked at; the usual one of each model if not given.
    pub largest_factor: Option<f64>,
}

impl AppliedLoads<'_> {
    /// Measures of the model of an analysis before and under these loads, or the code of a missing result.
    fn on(&self, analysis: &Analysis) -> Result<Vec<LoadedMeasure>, &'static str> {
        let movement = &analysis.movement;
        let model = fitted_model(analysis, self.kind).map_err(|absent| absent.key())?;
        let springs = model.stiffness_matrices(&movement.library);
        let (spine, loading, goal) = (&movement.spine, self.loading, self.goal);
        let limit =
            self.largest_factor.unwrap_or_else(|| usual_limit(spine, &springs, loading, goal));
        let statics = GeneralStatics::new(spine, springs, self.support)
            .map_err(|_| LoadedUncertainty::NO_SPRINGS)?;
        let response = respond(&statics, loading, goal, limit, &mut go_on)
            .map_err(|_| LoadedUncertainty::NOT_APPLICABLE)?;
        if response.result().is_none() {
            return Err(response.ending.key());
        }
        let film = &movement.erect().outline;
        Ok(loaded_measures(spine, &movement.curve_places(), Some(film), &response))
    }
}

/// The result of one replicate under loads: measures, or the code of a missing result.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedReplicate(Result<Vec<LoadedMeasure>, &'static str>);

impl MonteCarlo<'_> {
    /// One replicate under loads: its films are measured, its model is personalised, and the loads are applied to that. Any may be
    /// computed alone, in any order.
    #[must_use]
    pub fn loaded_replicate(&self, index: u64, loads: &AppliedLoads<'_>) -> LoadedReplicate {
        LoadedReplicate(self.analysis_of(index).and_then(|analysis| loads.on(&analysis)))
    }

    /// An empty tally of replicates under loads, for the measures of the case's own model.
    #[must_use]
    pub fn loaded_tally(&self, nominal: &[LoadedMeasure]) -> LoadedTally<'_> {
        let numbers = nominal.iter().flat_map(|measure| {
            LoadedState::ALL.into_iter().map(|state| {
                let (quantity, nominal) = (measure.quantity, measure.value(state));
                let period = quantity.is_angle().then_some(360.0);
                let values = Centred::around(nominal, period);
                Counted { quantity, state, nominal, values }
            })
        });
        let numbers = numbers.filter(Counted::exists).collect();
        LoadedTally { of: self, done: 0, usable: 0, endings: BTreeMap::new(), numbers }
    }
}

/// The results of the replicates so far under loads; its size does not depend on their number.
#[derive(Debug, Clone)]
pub struct LoadedTally<'a> {
    of: &'a MonteCarlo<'a>,
    done: u64,
    usable: u64,
    endings: BTreeMap<&'static str, u64>,
    numbers: Vec<Counted>,
}

#[derive(Debug, Clone)]
struct Counted {
    quantity: LoadedQuantity,
    state: LoadedState,
    nominal: Option<f64>,
    values: Centred,
}

impl Counted {
    /// The factor is only one of loads.
    fn exists(&self) -> bool {
        self.quantity != LoadedQuantity::Factor || self.state == LoadedState::Loaded
    }
}

impl LoadedTally<'_> {
    /// Adds one replicate. Added in the order of their indices, they give the same bytes however they were computed.
    pub fn add(&mut self, replicate: &LoadedReplicate) {
        self.done += 1;
        let measures = match &replicate.0 {
            Ok(measures) => measures,
            Err(code) => {
                *self.endings.entry(code).or_default() += 1;
                return;
            }
        };
        self.usable += 1;
        for number in &mut self.numbers {
            let measure = measures.iter().find(|measure| measure.quantity == number.quantity);
            if let Some(value) = measure.and_then(|measure| measure.value(number.state)) {
                number.values.add(value);
            }
        }
    }

    /// The result, of this number of requested replicates.
    #[must_use]
    pub fn finish(self, requested: u64) -> LoadedUncertainty {
        let spread = |number: Counted| LoadedSpread {
            quantity: number.quantity,
            state: number.state,
            nominal: number.nominal,
            count: number.values.count(),
            spread: number.values.spread(),
        };
        let endings = self.endings.into_iter();
        LoadedUncertainty {
            seed: self.of.seed,
            requested,
            done: self.done,
            usable: self.usable,
            endings: endings.map(|(code, count)| (Cow::Borrowed(code), count)).collect(),
            noise: self.of.noisy.films.clone(),
            numbers: self.numbers.into_iter().map(spread).collect(),
        }
    }
}

/// Distribution of one number before, under or by loads, in the unit of its quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadedSpread {
    /// What is measured.
    pub quantity: LoadedQuantity,
    /// Which value of it.
    pub state: LoadedState,
    /// In the case's own model; `None` if its result is missing.
    pub nominal: Option<f64>,
    /// Replicates that have it.
    pub count: u64,
    /// Mean, standard deviation and quantiles; `None` where no replicate has it.
    pub spread: Option<Spread>,
}

impl LoadedSpread {
    /// The central 95 % of the replicates with a result. `None` where fewer than [`Spread::MIN_COUNT`] have the number.
    #[must_use]
    pub fn interval_95(&self) -> Option<[f64; 2]> {
        self.spread?.interval_95(self.count)
    }
}

/// Effect of landmark noise on every number before and under loads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadedUncertainty {
    /// Seed of the random streams.
    pub seed: u64,
    /// Requested replicates.
    pub requested: u64,
    /// Replicates that were run.
    pub done: u64,
    /// Replicates with a result under the loads. All intervals are theirs.
    pub usable: u64,
    /// Number of replicates without a result, by code: of the error that stopped an analysis, of the reason for a missing model
    /// ([`super::Absent::key`]), or the ending of the search ([`crate::multibody::PathEnding::key`]).
    pub endings: Vec<(Cow<'static, str>, u64)>,
    /// The noise of every film.
    pub noise: Vec<FilmNoise>,
    /// Every number.
    pub numbers: Vec<LoadedSpread>,
}

impl LoadedUncertainty {
    /// What the intervals cover.
    pub const CAVEAT: &'static str = "Intervals cover the noise of the landmarks and the scales of the films against the erect one, with the same loads on the \
                                      model of every replicate. They do not cover the errors of the model, of the loads and of the erect film's scale, and no \
                                      bias that all observers share.";
    /// Code of a replicate whose springs are not positive.
    const NO_SPRINGS: &'static str = "springs_not_positive";
    /// Code of a replicate to whose model the loads cannot be applied.
    const NOT_APPLICABLE: &'static str = "loads_not_applicable";

    /// The distribution of a number.
    #[must_use]
    pub fn of(&self, quantity: LoadedQuantity, state: LoadedState) -> Option<&LoadedSpread> {
        self.numbers.iter().find(|one| one.quantity == quantity && one.state == state)
    }

    /// How many replicates have a result, how the others ended, the noise, and what the intervals cover: a sentence each.
    #[must_use]
    pub fn words(&self) -> Vec<String> {
        let (usable, done, seed) = (self.usable, self.done, self.seed);
        let counts =
            format!("Monte Carlo replicates with a result, {usable} of {done} (seed {seed})");
        let counts = if usable < Spread::MIN_COUNT {
            format!("{counts}; a 95 % interval needs {}", Spread::MIN_COUNT)
        } else {
            format!("95 % intervals: the central 95 % of the {counts}")
        };
        let ending = |(code, count): &(Cow<'static, str>, u64)| {
            let percent = 100.0 * *count as f64 / done.max(1) as f64;
            format!("`{code}` in {count} of {done} ({} %)", fixed(percent, 1))
        };
        let endings: Vec<String> = self.endings.iter().map(ending).collect();
        let without = (!endings.is_empty())
            .then(|| format!("Without a result, and in no interval: {}", endings.join(", ")));
        let noise = noise_words(&self.noise).into_iter().map(|words| format!("Noise: {words}"));
        let all = [counts].into_iter().chain(without).chain(noise);
        all.chain([Self::CAVEAT.to_owned()]).collect()
    }
}
