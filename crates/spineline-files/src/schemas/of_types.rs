//! The required schemas: made from the types, and compared with the files.

use std::path::Path;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, schema_for};

use super::{SCHEMAS, schema};
use crate::{
    AnalysisFile, CaseFile, CohortFile, LoadFile, ModelFile, ProvenanceFile, RefusedFile,
    ReliabilityFile, RotationPriorFile, SimulationFile, StiffnessFile, to_text,
};

/// The schema of a file that is only written: a key is required where it is always written.
fn written<T: JsonSchema>() -> Schema {
    SchemaSettings::default().for_serialize().into_generator().into_root_schema_for::<T>()
}

fn of_types() -> [(&'static str, Schema); SCHEMAS.len()] {
    [
        ("analysis", written::<AnalysisFile>()),
        ("case", schema_for!(CaseFile)),
        ("cohort", written::<CohortFile>()),
        ("load", schema_for!(LoadFile)),
        ("model", schema_for!(ModelFile)),
        ("provenance", schema_for!(ProvenanceFile)),
        ("refused-case", written::<RefusedFile>()),
        ("reliability", written::<ReliabilityFile>()),
        ("rotation-prior", schema_for!(RotationPriorFile)),
        ("simulation", written::<SimulationFile>()),
        ("stiffness", schema_for!(StiffnessFile)),
    ]
}

/// After a change of a file's type, `SPINELINE_WRITE_SCHEMAS=1 cargo test -p spineline-files --lib schemas` writes the new schemas.
#[test]
fn schemas_equal_those_from_the_types() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas");
    let is_writing = std::env::var_os("SPINELINE_WRITE_SCHEMAS").is_some();
    for (name, made) in of_types() {
        let text = to_text(&made);
        if is_writing {
            std::fs::write(folder.join(format!("{name}.json")), text).expect("a written schema");
        } else {
            assert!(
                schema(name) == Some(text.as_str()),
                "schemas/{name}.json differs from its type: set SPINELINE_WRITE_SCHEMAS=1 and run this test again"
            );
        }
    }
}
