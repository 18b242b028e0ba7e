//! The native module `spineline._native`, which the Python package wraps.
//!
//! It parses, calls the library and returns results. The Python interface is in `python/spineline`; neither part
//! computes. Long calls let other Python threads run, and check for Ctrl-C ten times a second.

mod analysis;
mod case;
mod cohort;
mod exports;
mod fault;
mod films;
mod landmarks;
mod model;
mod numbers;
mod patient;
mod replicates;
mod table;
mod wait;

/// The native module.
#[pyo3::pymodule(gil_used = false)]
mod _native {
    #[pymodule_export]
    use super::analysis::{Analysis, time_analysis};
    #[pymodule_export]
    use super::case::{Case, parse_case, phantom, read_case};
    #[pymodule_export]
    use super::cohort::{analyze_paths, check_options, identify_cases};
    #[pymodule_export]
    use super::exports::{landmark_files, landmark_table};
    #[pymodule_export]
    use super::films::{case_of_films, film_of, plane_of};
    #[pymodule_export]
    use super::landmarks::films_of_landmarks;
    #[pymodule_export]
    use super::model::{Model, Simulation, force_vector, parse_model_text};
    #[pymodule_export]
    use super::patient::{did_you_mean, names_a_file, option_names};
    #[pymodule_export]
    use super::replicates::Replicates;
    #[pymodule_export]
    use super::table::Table;

    #[pymodule_init]
    fn init() {
        #[cfg(feature = "weights")]
        spineline::measure::completion::provide_shape(spineline_weights::ERECT_SPINES);
    }

    /// The version of the program.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    /// Identity of its sources: it changes with the code.
    #[pymodule_export]
    const BUILD: &str = env!("SPINELINE_BUILD");

    /// Whether it was built for development, which is slower than a release.
    #[pymodule_export]
    const IS_DEVELOPMENT: bool = cfg!(debug_assertions);

    /// Largest file of a case or of landmarks.
    #[pymodule_export]
    const MAX_FILE_BYTES: u64 = spineline_files::MAX_FILE_BYTES;

    /// A 95 % interval needs at least this number of replicates.
    #[pymodule_export]
    const MIN_REPLICATES: u64 = spineline::uncertainty::Spread::MIN_COUNT;
}
