//! Answers in the JSON of DICOM (PS3.18, annex F).

use serde_json::Value;

pub const PATIENT_ID: &str = "00100020";
pub const ACCESSION_NUMBER: &str = "00080050";
pub const STUDY_UID: &str = "0020000D";
pub const SERIES_UID: &str = "0020000E";
pub const INSTANCE_UID: &str = "00080018";
pub const STUDY_DATE: &str = "00080020";
pub const MODALITY: &str = "00080060";
pub const STUDY_DESCRIPTION: &str = "00081030";
pub const SERIES_DESCRIPTION: &str = "0008103E";
pub const BODY_PART: &str = "00180015";
pub const SERIES_INSTANCES: &str = "00201209";
pub const INSTANCE_NUMBER: &str = "00200013";
pub const COLUMNS: &str = "00280011";
pub const ROWS: &str = "00280010";
pub const VIEW_POSITION: &str = "00185101";

/// Longest text that is shown.
const MAX_TEXT: usize = 64;

/// The attributes of one entry.
pub struct Attributes<'a>(pub &'a Value);

impl Attributes<'_> {
    fn first(&self, tag: &str) -> Option<&Value> {
        self.0.get(tag)?.get("Value")?.get(0)
    }

    /// A text, cut to the maximum length of a DICOM attribute; `None` if it is absent or empty.
    pub fn text(&self, tag: &str) -> Option<String> {
        let text = self.first(tag)?.as_str()?;
        let text: String = text.chars().filter(|c| !c.is_control()).take(MAX_TEXT).collect();
        Some(text.trim().to_owned()).filter(|text| !text.is_empty())
    }

    /// A number of at least zero; some archives write numbers as texts.
    pub fn count(&self, tag: &str) -> Option<u32> {
        let value = self.first(tag)?;
        let text = || value.as_str()?.trim().parse().ok();
        value.as_u64().and_then(|number| u32::try_from(number).ok()).or_else(text)
    }

    /// A required UID.
    pub fn uid(&self, tag: &str) -> Result<String, &'static str> {
        self.text(tag).ok_or("an entry has no UID")
    }
}

/// The entries of an answer to a search.
pub fn entries(body: &[u8]) -> Result<Vec<Value>, &'static str> {
    // Some archives answer a search without matches with an empty body.
    if body.is_empty() {
        return Ok(Vec::new());
    }
    match serde_json::from_slice(body) {
        Ok(Value::Array(entries)) => Ok(entries),
        Ok(_) => Err("it is not a list"),
        Err(_) => Err("it is not JSON"),
    }
}
