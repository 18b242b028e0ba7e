//! Film, observer and repeat, as Spineline adds them to files of other programs under the key `spineline`.

use serde::{Deserialize, Serialize};
use spineline::anatomy::Posture;
use spineline::measure::ReadingId;

use super::film::named;
use super::names::observer;
use super::number::Whole;
use super::{LandmarkError, LandmarkHint};

/// The parts that a file states.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Identity {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub film: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observer: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "whole")]
    pub repeat: Option<u32>,
}

fn whole<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<u32>, D::Error> {
    Ok(Option::<Whole>::deserialize(deserializer)?.map(|whole| whole.0))
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
        self.film.as_ref().map(|name| named(name, "posture", at)).transpose()
    }

    /// The stated reading; the caller's values replace missing ones.
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
