//! Names that stand in files.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use spineline::action::Application;
use spineline::anatomy::{Level, Posture, Region};
use spineline::measure::SpacingSource;
use spineline::multibody::Support;

/// A vertebra as a key: `L4`, `T12` (`Th12` and `D12` are read too).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct LevelKey(pub Level);

impl Serialize for LevelKey {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<'de> Deserialize<'de> for LevelKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map(Self).map_err(D::Error::custom)
    }
}

impl JsonSchema for LevelKey {
    fn schema_name() -> Cow<'static, str> {
        "Level".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names = Level::ALL.map(Level::name);
        json_schema!({ "type": "string", "enum": names, "description": "A vertebra" })
    }
}

/// A joint as a key, the lower vertebra first: `T12/T11`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct JointKey(pub Level, pub Level);

impl Serialize for JointKey {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{}/{}", self.0, self.1))
    }
}

impl<'de> Deserialize<'de> for JointKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let (below, above) = text.split_once('/').unwrap_or((&text, ""));
        let level = |name: &str| name.parse().map_err(D::Error::custom);
        Ok(Self(level(below)?, level(above)?))
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

/// A posture.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum PostureKey {
    /// Standing.
    Erect,
    /// Bending to the patient's left.
    LeftBending,
    /// Bending to the patient's right.
    RightBending,
    /// Lying at rest.
    Neutral,
    /// Lying under traction.
    Traction,
}

impl From<PostureKey> for Posture {
    fn from(key: PostureKey) -> Self {
        match key {
            PostureKey::Erect => Self::Erect,
            PostureKey::LeftBending => Self::LeftBending,
            PostureKey::RightBending => Self::RightBending,
            PostureKey::Neutral => Self::Neutral,
            PostureKey::Traction => Self::Traction,
        }
    }
}

impl From<Posture> for PostureKey {
    fn from(posture: Posture) -> Self {
        match posture {
            Posture::Erect => Self::Erect,
            Posture::LeftBending => Self::LeftBending,
            Posture::RightBending => Self::RightBending,
            Posture::Neutral => Self::Neutral,
            Posture::Traction => Self::Traction,
        }
    }
}

/// How a film's spacing became known, as a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SourceKey(pub SpacingSource);

impl Serialize for SourceKey {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.key())
    }
}

impl<'de> Deserialize<'de> for SourceKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let known = SpacingSource::ALL.map(SpacingSource::key);
        SpacingSource::ALL
            .into_iter()
            .find(|source| source.key() == text)
            .map(Self)
            .ok_or_else(|| D::Error::custom(format!("`{text}` is none of {}", known.join(", "))))
    }
}

impl JsonSchema for SourceKey {
    fn schema_name() -> Cow<'static, str> {
        "SpacingSource".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names = SpacingSource::ALL.map(SpacingSource::key);
        json_schema!({ "type": "string", "enum": names, "description": "How a spacing became known" })
    }
}

/// A region of the spine.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum RegionKey {
    /// Thoracolumbar or lumbar.
    ThoracolumbarLumbar,
    /// Main thoracic.
    MainThoracic,
    /// Proximal thoracic.
    ProximalThoracic,
}

impl From<RegionKey> for Region {
    fn from(key: RegionKey) -> Self {
        match key {
            RegionKey::ThoracolumbarLumbar => Self::ThoracolumbarLumbar,
            RegionKey::MainThoracic => Self::MainThoracic,
            RegionKey::ProximalThoracic => Self::ProximalThoracic,
        }
    }
}

impl From<Region> for RegionKey {
    fn from(region: Region) -> Self {
        match region {
            Region::ThoracolumbarLumbar => Self::ThoracolumbarLumbar,
            Region::MainThoracic => Self::MainThoracic,
            Region::ProximalThoracic => Self::ProximalThoracic,
        }
    }
}

/// What holds a patient.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SupportKey {
    /// Nothing but L4.
    Free,
    /// A table: flexion and axial hinges are locked.
    Frontal,
}

impl From<Support> for SupportKey {
    fn from(support: Support) -> Self {
        match support {
            Support::Free => Self::Free,
            Support::Frontal => Self::Frontal,
        }
    }
}

impl From<SupportKey> for Support {
    fn from(key: SupportKey) -> Self {
        match key {
            SupportKey::Free => Self::Free,
            SupportKey::Frontal => Self::Frontal,
        }
    }
}

/// How a force is applied.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ApplicationKey {
    /// Along a line fixed in space.
    Fixed,
    /// At T2's midpoint.
    AtT2,
}

impl From<Application> for ApplicationKey {
    fn from(application: Application) -> Self {
        match application {
            Application::Fixed => Self::Fixed,
            Application::AtT2 => Self::AtT2,
        }
    }
}

impl From<ApplicationKey> for Application {
    fn from(key: ApplicationKey) -> Self {
        match key {
            ApplicationKey::Fixed => Self::Fixed,
            ApplicationKey::AtT2 => Self::AtT2,
        }
    }
}

/// A map by level in which a level that is given twice is an error, not an overwriting.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct ByLevel<T>(pub BTreeMap<LevelKey, T>);

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
                while let Some((level, value)) = map.next_entry::<LevelKey, T>()? {
                    if found.insert(level, value).is_some() {
                        let text = format!("{} is given twice in one reading", level.0);
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
