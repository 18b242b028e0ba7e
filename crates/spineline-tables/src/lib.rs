//! Tidy tables of analyses, as CSV and Parquet: one row per patient × posture × line × level, or as each table states. Units end
//! the names of columns, a dictionary explains every column, and a missing value is empty.
//!
//! ```
//! use spineline_tables::{dictionary, OptionalTables};
//!
//! let text = dictionary(OptionalTables::ALL).to_csv().expect("a table of texts");
//! assert!(text.contains("vertebrae,location_error_mm,mm,number,"));
//! ```

mod chain;
mod clinical;
mod cohort_tests;
mod data;
mod define;
mod dictionary;
mod error;
mod joints;
mod loaded;
mod merge;
mod models;
mod noise_study;
mod path;
mod patients;
mod postures;
mod predictions;
mod reliability;
mod reproduction;
mod space;
mod statistics;
mod table;
mod uncertainty;
mod verdicts;
mod vertebrae;
mod warnings;
mod write;

pub use chain::chain_table;
pub use cohort_tests::cohort_tests_table;
pub use data::Patient;
pub use dictionary::{dictionary, dictionary_markdown};
pub use error::TableError;
pub use loaded::loaded_measures_table;
pub use merge::{CsvMerger, MergeError, ParquetMerger, csv_case_ids, parquet_case_ids};
pub use noise_study::{NoisePoint, noise_study_table};
pub use path::{LoadedShape, path_table};
pub use reproduction::{ReproducedNumber, reproduction_table};
pub use statistics::statistics_table;
pub use table::{NumberFormat, Series, Table, Values};
pub use verdicts::{RowVerdict, verdicts_table};
pub use vertebrae::errors_table;
pub use write::{ParquetWriter, SCHEMA_VERSION};

use spineline::cohort::RefusedCase;

/// Which optional tables are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OptionalTables {
    /// Distribution of every quantity.
    pub uncertainty: bool,
    /// Other loads and bases.
    pub hypotheses: bool,
    /// The erect spine in space, from a lateral film.
    pub space: bool,
    /// Axial rotations, from pedicles.
    pub axial: bool,
}

impl OptionalTables {
    /// Everything.
    pub const ALL: Self = Self { uncertainty: true, hypotheses: true, space: true, axial: true };

    /// The tables that either asks for.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self {
            uncertainty: self.uncertainty || other.uncertainty,
            hypotheses: self.hypotheses || other.hypotheses,
            space: self.space || other.space,
            axial: self.axial || other.axial,
        }
    }

    /// Which optional results these patients have.
    #[must_use]
    pub fn of(patients: &[Patient<'_>]) -> Self {
        Self {
            uncertainty: patients.iter().any(|patient| patient.uncertainty.is_some()),
            hypotheses: patients.iter().any(|p| !p.analysis.options.hypotheses.is_empty()),
            space: patients.iter().any(|patient| patient.analysis.movement.space.is_some()),
            axial: patients.iter().any(|patient| !patient.analysis.movement.axial.is_empty()),
        }
    }
}

/// All tables of some patients, in the order of the dictionary.
#[must_use]
pub fn tables(patients: &[Patient<'_>]) -> Vec<Table> {
    tables_of(patients, OptionalTables::of(patients))
}

/// The rows of a case without a result in [`tables`]: one among the patients.
#[must_use]
pub fn tables_of_refused(case: &RefusedCase) -> Vec<Table> {
    let mut all = tables(&[]);
    let patients = all.remove(0).refused(case);
    all.insert(0, patients);
    all
}

fn tables_of(patients: &[Patient<'_>], optional: OptionalTables) -> Vec<Table> {
    let mut all = vec![
        patients::table(patients),
        postures::table(patients),
        vertebrae::table(patients),
        joints::table(patients),
        models::models(patients),
        models::multipliers(patients),
        models::springs(patients),
        models::lines(patients),
        predictions::table(patients),
        clinical::table(patients),
        reliability::table(patients),
        warnings::table(patients),
    ];
    if optional.hypotheses {
        all.push(models::hypotheses(patients));
    }
    if optional.space {
        all.push(space::vertebrae(patients));
        all.push(space::measures(patients));
    }
    if optional.axial {
        all.push(space::axial(patients));
    }
    if optional.uncertainty {
        all.push(uncertainty::table(patients));
    }
    all
}

/// Tables of other options and commands than `analyze --tables`, without rows.
fn other_files() -> [Table; 9] {
    [
        chain_table(&[]),
        errors_table(&[]),
        cohort_tests::of_tests(&[]),
        noise_study_table(&[]),
        path::of_shapes("<top>", &["<region>"], &[]),
        loaded::of_numbers(&[]),
        statistics_table(&[], false),
        reproduction_table(&[]),
        verdicts_table(&[]),
    ]
}
