//! Film, observer and repeat, as Spineline adds them to files of other programs under the key `spineline`.

use serde::{Deserialize, Serialize};
use spineline::anatomy::{Named, Posture};
use spineline::measure::ReadingId;
use spineline_files::nearest;

use super::names::{observer, shown};
use super::{LandmarkError, LandmarkHint};

/// What of it a file states.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Identity {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub film: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observer: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeat: Option<u32>,
}

impl Identity {
    pub fn of_film(posture: Posture) -> Self {
        Self { film: Some(posture.key().to_owned()), ..Self::default() }
    }

    pub fn with_reading(self, id: &ReadingId) -> Self {
        Self { observer: Some(id.observer.clone()), repeat: Some(id.repeat), ..self }
    }

    /// The stated posture.
    pub fn posture(&self, at: &str) -> Result<Option<Posture>, LandmarkError> {
        let Some(name) = &self.film else { return Ok(None) };
        Posture::from_key(name).map(Some).ok_or_else(|| LandmarkError::Unknown {
            at: at.to_owned(),
            what: "posture",
            name: shown(name),
            nearest: nearest(&shown(name), &Posture::ALL.map(Posture::key)),
        })
    }

    /// The stated reading; what is not stated is that of the caller.
    pub fn reading(&self, hint: &LandmarkHint, at: &str) -> Result<ReadingId, LandmarkError> {
        let mut id = hint.reading.clone();
        if let Some(name) = &self.observer {
            id.observer = observer(name, at)?;
        }
        if let Some(repeat) = self.repeat {
            if repeat == 0 {
                return Err(LandmarkError::Value {
                    at: at.to_owned(),
                    value: repeat.to_string(),
                    expected: "a repeat from 1",
                });
            }
            id.repeat = repeat;
        }
        Ok(id)
    }
}
