//! Named values as strings, for serde.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserializer, Serializer};
use spineline::anatomy::{Named, UnknownKey};

/// Writes a value as its name.
///
/// # Errors
/// Those of the serializer.
pub fn serialize<T: Named, S: Serializer>(value: T, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(value.key())
}

/// Reads one of some values by its name.
///
/// # Errors
/// If the text is not the name of an allowed value; the message lists the allowed names.
pub fn deserialize<'de, T: Named, D: Deserializer<'de>>(
    allowed: &'static [T],
    deserializer: D,
) -> Result<T, D::Error> {
    deserializer.deserialize_str(OneOf(allowed))
}

/// Visits in place, so that the error carries the line of the name and not that of the object's end.
struct OneOf<T: 'static>(&'static [T]);

impl<T: Named> Visitor<'_> for OneOf<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a value")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        let found = T::from_key(text).filter(|value| self.0.contains(value));
        found.ok_or_else(|| E::custom(UnknownKey::new(text, self.0)))
    }
}
