use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::cohort::LearnedRotations;
use spineline::evaluate::RotationPrior;
use spineline::measure::TiltRule;

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
    /// Identifiers of the cases that the prior was learned from.
    case_ids: Vec<String>,
    /// Landmarks from which tilts were measured (`endplates` or `axis`): rotations of another rule are not predicted from it.
    tilt: TiltRule,
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
    /// From the location and the tilt of T2, with published mobilities instead of other patients.
    published_with_tilt_mm: Option<f64>,
}

/// A prior as it is read.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredRotationPrior {
    /// The distribution.
    pub prior: RotationPrior,
    /// SHA-256 of the cases that it was learned from.
    pub learned_from: Vec<String>,
    /// Their identifiers: a case that was saved again has other bytes.
    pub case_ids: Vec<String>,
    /// How their tilts were measured.
    pub tilt: TiltRule,
}

impl StoredRotationPrior {
    /// Refuses a case that the distribution was learned from (by SHA-256, or by identifier in any case of its letters): the
    /// distribution knows its films.
    ///
    /// # Errors
    /// [`FileError::LearnedFrom`].
    pub fn check_case(&self, sha256: &str, case_id: &str) -> Result<(), FileError> {
        let is_known = self.learned_from.iter().any(|one| one == sha256)
            || self.case_ids.iter().any(|one| one.eq_ignore_ascii_case(case_id));
        if is_known { Err(FileError::LearnedFrom { case_id: case_id.to_owned() }) } else { Ok(()) }
    }

    /// Refuses tilts that are measured by another rule than in learning.
    ///
    /// # Errors
    /// [`FileError::LearnedWithTilt`].
    pub fn check_tilt(&self, asked: TiltRule) -> Result<(), FileError> {
        if self.tilt == asked {
            return Ok(());
        }
        let [learned, asked] = [self.tilt, asked].map(|rule| rule.key());
        Err(FileError::LearnedWithTilt { learned, asked })
    }
}

/// Reads a prior of joint rotations from the text of its file.
pub fn parse_rotation_prior(text: &str) -> Result<StoredRotationPrior, FileError> {
    let file = parse::<RotationPriorFile>(text, FORMAT, VERSION)?;
    let learned_from = file.provenance.inputs.iter().map(|input| input.sha256.clone()).collect();
    Ok(StoredRotationPrior {
        prior: file.prior.prior()?,
        learned_from,
        case_ids: file.case_ids,
        tilt: file.tilt,
    })
}

impl RotationPriorFile {
    /// A prior with its errors, the identifiers of its cases and the rule of their tilts; the inputs of the provenance are the
    /// cases.
    ///
    /// # Panics
    /// If the prior was not learned.
    #[must_use]
    pub fn new(
        learned: &LearnedRotations,
        case_ids: Vec<String>,
        tilt: TiltRule,
        provenance: Provenance,
    ) -> Self {
        let record = RotationPriorRecord::new(&learned.prior).expect("it was learned");
        let mean = |errors: &spineline::cohort::Clustered| {
            let patients = &errors.patients;
            (patients.n > 0).then_some(patients.mean)
        };
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            synthetic: provenance.films != FilmOrigin::Real,
            case_ids,
            tilt,
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
