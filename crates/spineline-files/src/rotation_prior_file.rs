use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::cohort::LearnedRotations;
use spineline::evaluate::RotationPrior;

use crate::FileError;
use crate::json::parse;
use crate::provenance::{FilmOrigin, Provenance};
use crate::rotation_prior_record::RotationPriorRecord;

const FORMAT: &str = "spineline-rotation-prior";
const VERSION: u32 = 1;

/// The distribution of joint rotations of bends, learned from patients, with what it was learned from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Spineline prior of joint rotations, version 1")]
pub struct RotationPriorFile {
    /// `spineline-rotation-prior`.
    format: String,
    /// 1.
    version: u32,
    /// Whether any film is of a synthetic patient.
    synthetic: bool,
    prior: RotationPriorRecord,
    /// Errors on bends of patients who were left out.
    left_out: LeftOutRecord,
    /// Provenance; its inputs are the cases that the prior was learned from.
    provenance: Provenance,
}

/// Mean location errors over patients, each predicted from others, in mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LeftOutRecord {
    /// Patients who were predicted.
    patients: usize,
    /// From the location of T2.
    from_location_mm: Option<f64>,
    /// From the location and the tilt of T2.
    with_tilt_mm: Option<f64>,
    /// From the location and the tilt of T2, with published mobilities in the place of other patients.
    published_with_tilt_mm: Option<f64>,
}

/// A prior as it is read.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredRotationPrior {
    /// The distribution.
    pub prior: RotationPrior,
    /// SHA-256 of the cases that it was learned from.
    pub learned_from: Vec<String>,
}

/// Reads a prior of joint rotations from the text of its file.
///
/// # Errors
/// [`FileError`].
pub fn parse_rotation_prior(text: &str) -> Result<StoredRotationPrior, FileError> {
    let file = parse::<RotationPriorFile>(text, FORMAT, VERSION)?;
    let learned_from = file.provenance.inputs().iter().map(|input| input.sha256.clone()).collect();
    Ok(StoredRotationPrior { prior: file.prior.prior()?, learned_from })
}

impl RotationPriorFile {
    /// A prior with its errors; the inputs of the provenance are the cases.
    ///
    /// # Panics
    /// If the prior was not learned.
    #[must_use]
    pub fn new(learned: &LearnedRotations, provenance: Provenance) -> Self {
        let record = RotationPriorRecord::new(&learned.prior).expect("it was learned");
        let mean = |errors: &spineline::cohort::Clustered| {
            let patients = &errors.patients;
            (patients.n > 0).then_some(patients.mean)
        };
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            synthetic: provenance.films() != FilmOrigin::Real,
            prior: record,
            left_out: LeftOutRecord {
                patients: learned.from_location_mm.patients.n,
                from_location_mm: mean(&learned.from_location_mm),
                with_tilt_mm: mean(&learned.with_tilt_mm),
                published_with_tilt_mm: mean(&learned.published_with_tilt_mm),
            },
            provenance,
        }
    }
}
