//! Named values as strings, for serde.

use std::fmt;

use serde::de::{DeserializeSeed, EnumAccess, Error, VariantAccess, Visitor};
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
    // The type is an enum also for serde, as if it were derived: names and variants are only for formats without names.
    deserializer.deserialize_enum("", &[], OneOf(allowed))
}

/// Reads the name in place, so that an error carries its line and not that of the object's end.
struct OneOf<T: 'static>(&'static [T]);

impl<'de, T: Named> Visitor<'de> for OneOf<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a value")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<T, A::Error> {
        let (value, content) = access.variant_seed(self)?;
        content.unit_variant()?;
        Ok(value)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        let found = T::from_key(text).filter(|value| self.0.contains(value));
        found.ok_or_else(|| E::custom(UnknownKey::new(text, self.0)))
    }
}

impl<'de, T: Named> DeserializeSeed<'de> for OneOf<T> {
    type Value = T;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<T, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}
