//! The load file within the interface, with the file's own schema.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use spineline_files::AppliedLoad;
use utoipa::openapi::{RefOr, Schema};
use utoipa::{PartialSchema, ToSchema};

/// One load, as load files have it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FileLoad(pub AppliedLoad);

/// A load file, as `simulate --load` reads it.
#[derive(Debug, Clone, Copy)]
pub struct FileOfLoads;

impl PartialSchema for FileLoad {
    fn schema() -> RefOr<Schema> {
        definition("AppliedLoad")
    }
}

impl ToSchema for FileLoad {
    fn name() -> Cow<'static, str> {
        "AppliedLoad".into()
    }

    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.extend(["Level", "TimingKey"].map(|name| (name.to_owned(), definition(name))));
    }
}

impl PartialSchema for FileOfLoads {
    fn schema() -> RefOr<Schema> {
        described(whole())
    }
}

impl ToSchema for FileOfLoads {
    fn name() -> Cow<'static, str> {
        "LoadFile".into()
    }

    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push((FileLoad::name().into_owned(), FileLoad::schema()));
        FileLoad::schemas(schemas);
    }
}

fn whole() -> Value {
    let text = spineline_files::schema("load").unwrap_or_default();
    serde_json::from_str(text).unwrap_or_default()
}

fn definition(name: &str) -> RefOr<Schema> {
    described(whole()["$defs"][name].take())
}

/// Schema of a file as a schema of the interface, with all schemas that it refers to.
fn described(mut schema: Value) -> RefOr<Schema> {
    settle(&mut schema);
    serde_json::from_value(schema).unwrap_or_else(|_| Schema::default().into())
}

fn settle(schema: &mut Value) {
    match schema {
        Value::Object(keys) => {
            for key in ["$schema", "$defs", "title"] {
                keys.remove(key);
            }
            if let Some(value) = keys.remove("const") {
                keys.insert("enum".to_owned(), Value::Array(vec![value]));
            }
            if let Some(Value::String(place)) = keys.get_mut("$ref") {
                *place = place.replace("#/$defs/", "#/components/schemas/");
            }
            keys.values_mut().for_each(settle);
        }
        Value::Array(items) => items.iter_mut().for_each(settle),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interface_knows_every_kind_of_load_with_its_keys() {
        let schema = serde_json::to_value(FileLoad::schema()).expect("a schema");
        let own = whole()["$defs"]["AppliedLoad"]["oneOf"].take();
        let (own, kinds) = (own.as_array().expect("kinds"), schema["oneOf"].as_array());
        let kinds = kinds.expect("kinds");
        assert_eq!(kinds.len(), own.len());
        for (kind, own) in kinds.iter().zip(own) {
            assert_eq!(kind["properties"]["kind"]["enum"][0], own["properties"]["kind"]["const"]);
            assert_eq!(kind["required"], own["required"]);
            let keys = |value: &Value| {
                let keys = value["properties"].as_object().expect("keys").keys();
                keys.cloned().collect::<std::collections::BTreeSet<_>>()
            };
            assert_eq!(keys(kind), keys(own));
        }
        let file = serde_json::to_value(FileOfLoads::schema()).expect("a schema");
        assert_eq!(
            file["properties"]["loads"]["items"]["$ref"],
            "#/components/schemas/AppliedLoad"
        );
    }
}
