//! Minimal bodies that the description of the interface allows.

use serde_json::{Map, Value, json};

pub fn of(description: &Value, schema: &Value) -> Value {
    if let Some(name) = schema["$ref"].as_str() {
        let pointer = name.trim_start_matches('#');
        return of(description, description.pointer(pointer).expect("a schema that is there"));
    }
    for choice in ["oneOf", "anyOf"] {
        if let Some(first) = schema[choice].as_array().and_then(|all| all.first()) {
            return of(description, first);
        }
    }
    if let Some(parts) = schema["allOf"].as_array() {
        let parts = parts.iter().map(|part| of(description, part));
        let objects = parts.filter_map(|part| part.as_object().cloned());
        return Value::Object(objects.flatten().collect());
    }
    if let Some(first) = schema["enum"].as_array().and_then(|all| all.first()) {
        return first.clone();
    }
    let kinds = schema["type"].as_array().cloned().unwrap_or_else(|| vec![schema["type"].clone()]);
    match kinds.first().and_then(Value::as_str) {
        Some("object") => object(description, schema),
        Some("array") => {
            let tuple = schema["prefixItems"].as_array().cloned().unwrap_or_default();
            let least = schema["minItems"].as_u64().unwrap_or(0);
            let rest = (tuple.len() as u64..least).map(|_| of(description, &schema["items"]));
            tuple.iter().map(|item| of(description, item)).chain(rest).collect()
        }
        Some("string") => json!("S-1"),
        Some("integer" | "number") => json!(1),
        Some("boolean") => json!(false),
        _ => Value::Null,
    }
}

fn object(description: &Value, schema: &Value) -> Value {
    let required = schema["required"].as_array().cloned().unwrap_or_default();
    let mut made = Map::new();
    for key in required.iter().filter_map(Value::as_str) {
        made.insert(key.to_owned(), of(description, &schema["properties"][key]));
    }
    made.into()
}
