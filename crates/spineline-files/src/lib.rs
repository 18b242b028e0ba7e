//! Files of Spineline: cases, analyses, cohorts, personalised models, loads, simulations, reliabilities, stiffness tables,
//! priors of joint rotations and provenance, all JSON with a format and a version; tables of readings as CSV ([`parse_readings`]); and models as
//! other multibody programs read them ([`export`]).
//!
//! The types here have the layout of the files; [`spineline`]'s types are for computation. Every file format
//! has a JSON schema, compared with the types. Unknown keys are errors that name the nearest known one, a level given
//! twice is an error, and nothing is repaired.
//!
//! ```
//! let text = r#"{ "format": "spineline-case", "version": 1, "case_id": "a", "synthetic": true, "filmes": [] }"#;
//! let error = spineline_files::parse_case(text).expect_err("a misspelt key");
//! assert!(error.to_string().contains("did you mean `films`?"));
//! ```

mod analysis_file;
mod case_file;
mod cohort_file;
mod content;
mod digest;
mod error;
mod export;
mod json;
mod json_reason;
mod keys;
mod keys_once;
mod load_file;
pub mod method_text;
mod model_file;
mod model_source;
mod nearest;
mod provenance;
mod published_record;
mod read;
mod readings_table;
mod refused_file;
mod reliability_file;
mod request;
mod rotation_prior_file;
mod rotation_prior_record;
mod schemas;
mod simulated;
mod simulation_file;
mod simulation_uncertainty;
mod stiffness_file;
mod table_text;
mod text;

pub use analysis_file::{
    AnalysisFile, StoredAnalysis, parse_analysis, parse_case_within, picture_warnings,
};
pub use case_file::{
    CaseFile, FilmSource, image_value, is_picture_name, parse_case, parse_case_file, parse_image,
    with_geometry, written_axis_deg,
};
pub use cohort_file::CohortFile;
pub use content::{
    Content, RunningContent, case_ids, content_words, film_names, text_with_hash, with_hash,
};
pub use digest::{is_sha256, sha256_hex};
pub use error::FileError;
pub use export::{ExportError, ExportFormat, export};
pub use json::{file_format, parse_json, parse_value};
pub use load_file::{
    AppliedLoad, DIRECTIONS, LoadFault, LoadFile, PlacedLoads, direction, parse_load,
};
pub use model_file::{ModelFile, StoredModel, parse_model};
pub use model_source::{ModelSource, ModelSourceError};
pub use nearest::nearest;
pub use provenance::{
    FilmOrigin, InputFile, PROVENANCE_FORMAT, ProgramRun, Provenance, ProvenanceFile,
    parse_provenance,
};
pub use read::{
    MAX_ANALYSES_BYTES, MAX_FILE_BYTES, SQLITE_SIGNATURE, read_bytes, read_text, text_of,
};
pub use readings_table::{ReadingsTable, parse_readings};
pub use refused_file::RefusedFile;
pub use reliability_file::ReliabilityFile;
pub use request::{Replicates, Request};
pub use rotation_prior_file::{RotationPriorFile, StoredRotationPrior, parse_rotation_prior};
pub use schemas::{schema, schema_names};
pub use simulated::{Simulated, SimulationError, SimulationWarning};
pub use simulation_file::SimulationFile;
pub use stiffness_file::{StiffnessFile, parse_stiffness};
pub use table_text::{
    column_name, decode_text, guarded, is_no_number, starts_formula, stated_separator, unguarded,
    whole_number,
};
pub use text::{ListText, results_line, results_text, to_line, to_text};
