//! Names in files.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use spineline::anatomy::Level;

/// A joint as a key, the lower vertebra first: `T12/T11`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct JointKey(pub Level, pub Level);

impl Serialize for JointKey {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{}/{}", self.0, self.1))
    }
}

impl JsonSchema for JointKey {
    fn schema_name() -> Cow<'static, str> {
        "Joint".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "description": "Lower and upper vertebra, such as T12/T11" })
    }
}

/// A map by level in which a level that is given twice is an error, not an overwriting.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct ByLevel<T>(pub BTreeMap<Level, T>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for ByLevel<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Levels<T>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for Levels<T> {
            type Value = ByLevel<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("vertebrae by name")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut found = BTreeMap::new();
                while let Some((level, value)) = map.next_entry::<Level, T>()? {
                    if found.insert(level, value).is_some() {
                        let text = format!("{} is given twice in one reading", level);
                        return Err(A::Error::custom(text));
                    }
                }
                Ok(ByLevel(found))
            }
        }

        deserializer.deserialize_map(Levels(PhantomData))
    }
}

impl<T: JsonSchema> JsonSchema for ByLevel<T> {
    fn schema_name() -> Cow<'static, str> {
        format!("ByLevel_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let value = generator.subschema_for::<T>();
        let names = Level::ALL.map(Level::name);
        json_schema!({
            "type": "object",
            "propertyNames": { "enum": names },
            "additionalProperties": value,
            "description": "Vertebrae by name, each at most once"
        })
    }
}

#[cfg(test)]
mod tests {
    use serde::de::DeserializeOwned;
    use spineline::multibody::Support;

    use super::*;
    use crate::json::parse_value;
    use crate::to_text;

    #[derive(Debug, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Derived {
        Free,
        Frontal,
    }

    /// A list of values read and written again, or what is wrong with it.
    fn again<T: Serialize + DeserializeOwned>(text: &str) -> String {
        match parse_value::<Vec<T>>(text) {
            Ok(values) => to_text(&values),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn a_named_value_is_read_and_written_as_a_derived_enum() {
        for text in ["[\n\"free\"]", "[\n\"fre\"\n]", "[5]", "[{\n\"free\": null}]", "[null]"] {
            assert_eq!(again::<Support>(text), again::<Derived>(text), "{text}");
        }
    }
}
