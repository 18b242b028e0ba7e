//! JSON schemas of the file formats. They are files, so that a change of a format is read like one of the code, and a test makes
//! them from the types and compares.

#[cfg(test)]
mod of_types;

/// The schemas of all file formats by name.
const SCHEMAS: [(&str, &str); 11] = [
    ("case", include_str!("../../schemas/case.json")),
    ("analysis", include_str!("../../schemas/analysis.json")),
    ("cohort", include_str!("../../schemas/cohort.json")),
    ("model", include_str!("../../schemas/model.json")),
    ("load", include_str!("../../schemas/load.json")),
    ("provenance", include_str!("../../schemas/provenance.json")),
    ("refused-case", include_str!("../../schemas/refused-case.json")),
    ("reliability", include_str!("../../schemas/reliability.json")),
    ("rotation-prior", include_str!("../../schemas/rotation-prior.json")),
    ("simulation", include_str!("../../schemas/simulation.json")),
    ("stiffness", include_str!("../../schemas/stiffness.json")),
];

/// The names of all file formats that have a schema.
pub fn schema_names() -> impl Iterator<Item = &'static str> {
    SCHEMAS.iter().map(|(name, _)| *name)
}

/// The schema of a file format by its name, as text.
///
/// ```
/// let schema: serde_json::Value = serde_json::from_str(spineline_files::schema("case").unwrap())?;
/// assert_eq!(schema["title"], "Spineline case, version 1");
/// # Ok::<(), serde_json::Error>(())
/// ```
#[must_use]
pub fn schema(name: &str) -> Option<&'static str> {
    SCHEMAS.iter().find(|(known, _)| *known == name).map(|(_, schema)| *schema)
}
