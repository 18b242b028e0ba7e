//! The paper's numbers beside the numbers of synthetic patients: a short answer, and every number.

mod claims;
mod fair;
mod full;
mod lengths;
mod numbers;
mod sections;
mod short;

pub use full::full;
pub use lengths::film_lengths;
pub use numbers::{Cell, PaperNumber, Part};
pub use sections::parts;
pub use short::short;

use spineline::cohort::{Claims, Cohort};

/// The patients of one loading scenario.
#[derive(Debug, Clone)]
pub struct ScenarioResults<'a> {
    /// Its name.
    pub name: &'static str,
    /// What it means, in a few words.
    pub meaning: &'static str,
    /// With free support, which is the paper's.
    pub free: &'a Cohort,
    /// With the patient held in the frontal plane.
    pub frontal: &'a Cohort,
    /// The paper's claims with free support.
    pub claims: Claims,
}

/// The loading scenarios, in the order of the columns.
pub type Scenarios<'a> = [ScenarioResults<'a>; 3];

/// One cohort per loading scenario, with the names.
#[derive(Clone, Copy)]
struct Columns<'a> {
    names: [&'static str; 3],
    cohorts: [&'a Cohort; 3],
}

impl<'a> Columns<'a> {
    fn map<T>(&self, of: impl FnMut(&'a Cohort) -> T) -> [T; 3] {
        self.cohorts.map(of)
    }
}
