use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::centred::{Centred, Spread};
use super::words::noise_words;
use super::{Absent, AnalysisQuantity, FilmNoise, MonteCarlo, Replicate};
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::number::fixed;

/// The results of the replicates so far; its size does not depend on their number.
#[derive(Debug, Clone)]
pub struct Tally<'a> {
    of: &'a MonteCarlo<'a>,
    done: u64,
    failed: u64,
    failures: BTreeMap<(&'static str, Option<LineKind>, Option<Posture>), u64>,
    quantities: Vec<Counted>,
}

#[derive(Debug, Clone)]
struct Counted {
    nominal: Result<f64, Absent>,
    values: Centred,
    at_bound: u64,
    absent: BTreeMap<Absent, u64>,
}

/// Distribution of one quantity of an analysis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuantitySpread {
    /// Which number.
    pub quantity: AnalysisQuantity,
    /// Its value in the case itself, or why it has none.
    pub nominal: Result<f64, Absent>,
    /// Replicates that have it.
    pub count: u64,
    /// Replicates that were analysed and do not have it, by reason.
    pub absent: Vec<(Absent, u64)>,
    /// Mean, standard deviation and quantiles; `None` where no replicate has it.
    pub spread: Option<Spread>,
    /// Replicates in which bounds of the fit determine it: its bound, or the bounds of all other multipliers.
    pub replicates_at_bound: u64,
    /// Whether bounds of the fit determine the value in the case itself, or an end of the interval: the films do not identify it.
    ///
    /// # Definition
    /// A bound hides where a replicate would lie without it. The ends of the interval are known where such replicates are at most 2.5 % of
    /// all: no end rests on them, even if all lie on one side.
    pub at_bound: bool,
}

/// Distribution of a multiplier, whose logarithm an analysis uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MultiplierSpread {
    /// In the case itself.
    pub value: Option<f64>,
    /// The quantiles at [`Spread::PARTS`], `None` without an interval: the exponential keeps the order of values, so that it takes quantiles to quantiles.
    pub quantiles: Option<[f64; 5]>,
}

impl QuantitySpread {
    /// The multiplier of which it is the logarithm; `None` for any other quantity.
    #[must_use]
    pub fn multiplier(&self) -> Option<MultiplierSpread> {
        self.quantity.multiplier?;
        let value = self.nominal.ok().map(f64::exp);
        let spread = self.interval_95().and(self.spread);
        Some(MultiplierSpread { value, quantiles: spread.map(|s| s.quantiles.map(f64::exp)) })
    }

    /// The central 95 % of the replicates. `None` where fewer than [`Spread::MIN_COUNT`] have the number, where it or an end is at a bound of the fit, and for
    /// distances, absolute errors and counter-rotating joints: any noise makes these larger, a replicate has it twice, and the interval
    /// would lie too high.
    #[must_use]
    pub fn interval_95(&self) -> Option<[f64; 2]> {
        self.spread.filter(|_| self.may_have_interval())?.interval_95(self.count)
    }

    /// Whether the fit of its line converged in no replicate.
    #[must_use]
    pub fn never_converged(&self) -> bool {
        self.count == 0 && self.absent.iter().any(|(why, _)| *why == Absent::FitNotConverged)
    }

    /// Whether it has an interval where enough replicates have the number.
    fn may_have_interval(&self) -> bool {
        !self.at_bound && !self.quantity.kind.grows_with_noise()
    }
}

/// How often something ended without result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailureCount {
    /// What: the code of an error, `fit_not_converged` or `force_not_found`.
    pub code: Cow<'static, str>,
    /// In the model of which line; `None` where the whole analysis stopped.
    pub line: Option<LineKind>,
    /// On which film.
    pub posture: Option<Posture>,
    /// In how many replicates.
    pub count: u64,
}

/// Effect of landmark noise on every number of an analysis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Uncertainty {
    /// Seed of the random streams.
    pub seed: u64,
    /// Requested replicates.
    pub requested: u64,
    /// Replicates that were run.
    pub done: u64,
    /// Replicates whose analysis stopped with an error.
    pub failed: u64,
    /// Everything that ended without result, by code, line and film.
    pub failures: Vec<FailureCount>,
    /// The noise of every film.
    pub noise: Vec<FilmNoise>,
    /// Every number.
    pub quantities: Vec<QuantitySpread>,
}

impl MonteCarlo<'_> {
    /// An empty tally of this case's quantities.
    #[must_use]
    pub fn tally(&self) -> Tally<'_> {
        let counted = |(nominal, quantity): (Result<f64, Absent>, &AnalysisQuantity)| Counted {
            nominal,
            values: Centred::around(nominal.ok(), quantity.kind.period_deg()),
            at_bound: 0,
            absent: BTreeMap::new(),
        };
        let quantities = self.values_in(self.nominal).into_iter().zip(&self.quantities);
        let quantities = quantities.map(counted).collect();
        Tally { of: self, done: 0, failed: 0, failures: BTreeMap::new(), quantities }
    }
}

impl Tally<'_> {
    /// Adds one replicate. Added in the order of their indices, they give the same bytes however they were computed.
    pub fn add(&mut self, replicate: &Replicate) {
        self.done += 1;
        for &(code, line, posture) in &replicate.endings {
            *self.failures.entry((code, Some(line), posture)).or_default() += 1;
        }
        let values = match &replicate.values {
            Ok(values) => values,
            Err(code) => {
                self.failed += 1;
                *self.failures.entry((code, None, None)).or_default() += 1;
                return;
            }
        };
        for (counted, value) in self.quantities.iter_mut().zip(values) {
            match value {
                Ok(value) => counted.values.add(*value),
                Err(reason) => *counted.absent.entry(*reason).or_default() += 1,
            }
        }
        replicate.at_bounds.iter().for_each(|&place| self.quantities[place].at_bound += 1);
    }

    /// The result, of this number of requested replicates.
    #[must_use]
    pub fn finish(self, requested: u64) -> Uncertainty {
        let nominal = self.of.nominal;
        let spread = |(counted, &quantity): (Counted, &AnalysisQuantity)| {
            let (count, spread) = (counted.values.count(), counted.values.spread());
            let absent = counted.absent.into_iter().collect();
            let replicates_at_bound = counted.at_bound;
            let hides = hides_an_end(replicates_at_bound, count);
            QuantitySpread {
                quantity,
                nominal: counted.nominal,
                count,
                absent,
                spread,
                replicates_at_bound,
                at_bound: hides || quantity.is_at_bound(nominal),
            }
        };
        let failure = |((code, line, posture), count)| FailureCount {
            code: Cow::Borrowed(code),
            line,
            posture,
            count,
        };
        Uncertainty {
            seed: self.of.seed,
            requested,
            done: self.done,
            failed: self.failed,
            failures: self.failures.into_iter().map(failure).collect(),
            noise: self.of.noisy.films.clone(),
            quantities: self.quantities.into_iter().zip(&self.of.quantities).map(spread).collect(),
        }
    }
}

/// Whether an end of the interval of this number of replicates may rest on those at bounds, on whichever side they lie.
fn hides_an_end(at_bound: u64, count: u64) -> bool {
    let beyond_an_end = Spread::PARTS[0] * count.saturating_sub(1) as f64;
    count >= Spread::MIN_COUNT && at_bound as f64 > beyond_an_end
}

impl Uncertainty {
    /// A caveat on the intervals.
    pub const CAVEAT: &'static str = "Intervals hold the result of landmarks without noise; they contain no bias that all \
                                      observers share, and no error of the model. Distances, angles between lines, absolute \
                                      errors, and the counter-rotating joints of a true line increase with any noise: their means \
                                      exceed the values of landmarks without noise, and they have no interval.";

    /// Distribution of a quantity; `None` if this analysis lacks the number, or no replicate had it.
    #[must_use]
    pub fn spread(&self, quantity: AnalysisQuantity) -> Option<&Spread> {
        self.of(quantity)?.spread.as_ref()
    }

    /// The distribution of a number.
    #[must_use]
    pub fn of(&self, quantity: AnalysisQuantity) -> Option<&QuantitySpread> {
        self.quantities.iter().find(|spread| spread.quantity == quantity)
    }

    /// The number of replicates that an interval needs, in words; `None` where the replicates and every reported number have enough.
    #[must_use]
    pub fn few_words(&self) -> Option<String> {
        let (fewest, usable) = (Spread::MIN_COUNT, self.done - self.failed);
        if usable < fewest {
            return Some(format!(
                "A 95 % interval needs {fewest} replicates; with a result: {usable}."
            ));
        }
        let is_few = |one: &QuantitySpread| {
            let is_counted = one.quantity.is_reported() && one.may_have_interval();
            is_counted && (1..fewest).contains(&one.count)
        };
        let words = || format!("A 95 % interval needs {fewest} replicates that have the number.");
        self.quantities.iter().any(is_few).then(words)
    }

    /// Which noise was added to the landmarks, and where it comes from: a sentence for all films that have the same.
    #[must_use]
    pub fn noise_words(&self) -> Vec<String> {
        noise_words(&self.noise)
    }

    /// The endings without a result, a sentence each.
    #[must_use]
    pub fn failure_words(&self) -> Vec<String> {
        let share = |count: u64| 100.0 * count as f64 / self.done.max(1) as f64;
        self.failures
            .iter()
            .map(|failure| {
                let places = [
                    failure.line.map(|line| line.to_string()),
                    failure.posture.map(|posture| format!("{posture} film")),
                ];
                let places: Vec<String> = places.into_iter().flatten().collect();
                let place =
                    if places.is_empty() { "whole analysis".to_owned() } else { places.join(", ") };
                let (count, done) = (failure.count, self.done);
                let percent = share(count);
                format!(
                    "{place}: `{}` in {count} of {done} ({} %)",
                    failure.code,
                    fixed(percent, 1)
                )
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::statistics::quantile;

    #[test]
    fn an_end_of_an_interval_is_not_the_bound_of_the_fit() {
        // Oracle: quantiles of sorted replicates of which some are at the upper bound.
        const BOUND: f64 = 10.0;
        for count in Spread::MIN_COUNT..300 {
            for at_bound in 0..12 {
                let inside = (0..count - at_bound).map(|i| i as f64 / count as f64);
                let values: Vec<f64> = inside.chain((0..at_bound).map(|_| BOUND)).collect();
                let [.., part] = Spread::PARTS;
                let hides = quantile(&values, part) > 1.0 + 1e-9;
                assert_eq!(hides_an_end(at_bound, count), hides, "{at_bound} of {count}");
            }
        }
        assert!(!hides_an_end(1, Spread::MIN_COUNT - 1), "too few replicates for an interval");
    }
}
