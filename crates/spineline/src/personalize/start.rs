//! A start of a fit.

/// Where a fit may start from.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// `ln α` per group.
    pub log_multipliers: Vec<f64>,
    /// Components of every film's load, and the angle of a base that may turn, in rad.
    pub loads: Vec<Vec<f64>>,
}

impl Start {
    /// The same multipliers with a part of the loads.
    pub(super) fn smaller(&self, part: f64) -> Self {
        let smaller = |load: &Vec<f64>| load.iter().map(|number| number * part).collect();
        Self { loads: self.loads.iter().map(smaller).collect(), ..self.clone() }
    }
}
