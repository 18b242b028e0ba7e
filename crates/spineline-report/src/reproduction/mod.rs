//! The paper's numbers beside ours: a short answer, and every number.

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

use spineline::analysis::Method;
use spineline::cohort::{Claims, Cohort};
use spineline::multibody::Support;
use spineline::reliability::QuantityReliability;

/// Patients that are analysed together: of one loading scenario, or the patients that were given.
#[derive(Debug, Clone)]
pub struct Group<'a> {
    /// Its name.
    pub name: &'static str,
    /// What it means, in a few words.
    pub meaning: String,
    /// With free support, which is the paper's.
    pub free: &'a Cohort,
    /// With the patient held in the frontal plane.
    pub frontal: &'a Cohort,
    /// The paper's claims with free support.
    pub claims: Claims,
    /// The repeatability of the readings.
    pub readings: Vec<QuantityReliability>,
}

/// The films that a reproduction reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Films {
    /// Phantoms: one group per loading scenario.
    Phantoms {
        /// Patients of each scenario.
        subjects: usize,
        /// Seed of the phantoms.
        seed: u64,
    },
    /// The films of one group of patients.
    Given,
}

/// What was analysed, and how.
#[derive(Debug, Clone)]
pub struct Reproduction<'a> {
    /// The films.
    pub films: Films,
    /// How they were analysed.
    pub method: Method,
    /// In the order of the columns.
    pub groups: Vec<Group<'a>>,
}

impl Reproduction<'_> {
    fn names(&self) -> Vec<&'static str> {
        self.groups.iter().map(|group| group.name).collect()
    }

    /// ` (SYNTHETIC)` where a film is.
    fn synthetic(&self) -> &'static str {
        if self.groups.iter().any(|group| group.free.synthetic) { " (SYNTHETIC)" } else { "" }
    }

    fn columns(&self, support: Support) -> Columns<'_> {
        Columns { of: self, support }
    }

    /// How the films were analysed.
    fn method_sentence(&self) -> &'static str {
        match self.method {
            Method::Paper => {
                "Method: the paper's. `--method default` analyses the same films as `spineline analyze` does."
            }
            Method::Default => "Method: the default of `spineline analyze`, not the paper's.",
        }
    }
}

/// One cohort per group.
struct Columns<'a> {
    of: &'a Reproduction<'a>,
    support: Support,
}

impl<'a> Columns<'a> {
    fn map<T>(&self, of: impl FnMut(&'a Cohort) -> T) -> Vec<T> {
        let cohorts = self.of.groups.iter().map(|group| match self.support {
            Support::Free => group.free,
            Support::Frontal => group.frontal,
        });
        cohorts.map(of).collect()
    }

    /// A note, and what holds for phantoms only.
    fn note(&self, common: &str, of_phantoms: &str) -> String {
        match self.of.films {
            Films::Phantoms { .. } => [common, of_phantoms].join(" ").trim().to_owned(),
            Films::Given => common.to_owned(),
        }
    }
}
