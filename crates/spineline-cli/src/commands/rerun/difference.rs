//! Two JSON texts, number by number.

use serde_json::Value;

/// Keys that say when and how a file was made, which always differ.
const NOT_RESULTS: [&str; 1] = ["provenance"];
/// Longer texts are cut where they are shown.
const SHOWN: usize = 60;

/// A value that differs.
#[derive(Debug, PartialEq)]
pub struct Difference {
    /// Where, with dots between keys and places.
    pub path: String,
    pub then: String,
    pub now: String,
    /// Of two numbers: their difference relative to the larger one.
    pub relative: Option<f64>,
}

/// The result of a comparison.
#[derive(Debug, Default, PartialEq)]
pub struct Found {
    pub all: Vec<Difference>,
    pub numbers: usize,
    /// Pairs of texts, booleans and nulls, and values on one side only.
    pub others: usize,
}

/// Every value that differs between two analysis files; the tolerance of numbers is relative, and absolute below 1.
pub fn differences(then: &Value, now: &Value, tolerance: f64) -> Found {
    let mut walk = Walk { tolerance, found: Found::default() };
    walk.pair("", Some(then), Some(now));
    walk.found
}

struct Walk {
    tolerance: f64,
    found: Found,
}

impl Walk {
    fn pair(&mut self, path: &str, then: Option<&Value>, now: Option<&Value>) {
        match (then, now) {
            (Some(Value::Object(then)), Some(Value::Object(now))) => {
                let added = now.keys().filter(|key| !then.contains_key(*key));
                for key in then.keys().chain(added) {
                    if !(path.is_empty() && NOT_RESULTS.contains(&key.as_str())) {
                        self.pair(&joined(path, key), then.get(key), now.get(key));
                    }
                }
            }
            (Some(Value::Array(then)), Some(Value::Array(now))) => {
                for i in 0..then.len().max(now.len()) {
                    self.pair(&joined(path, &i.to_string()), then.get(i), now.get(i));
                }
            }
            (Some(Value::Number(then)), Some(Value::Number(now))) => {
                self.numbers(path, then, now);
            }
            (then, now) => {
                self.found.others += 1;
                if then != now {
                    self.add(path, shown(then), shown(now), None);
                }
            }
        }
    }

    fn numbers(&mut self, path: &str, then: &serde_json::Number, now: &serde_json::Number) {
        self.found.numbers += 1;
        if then == now {
            return;
        }
        let (Some(a), Some(b)) = (then.as_f64(), now.as_f64()) else {
            return self.add(path, then.to_string(), now.to_string(), None);
        };
        let (apart, larger) = ((a - b).abs(), a.abs().max(b.abs()));
        if apart > self.tolerance * larger.max(1.0) {
            self.add(path, then.to_string(), now.to_string(), Some(apart / larger));
        }
    }

    fn add(&mut self, path: &str, then: String, now: String, relative: Option<f64>) {
        self.found.all.push(Difference { path: path.to_owned(), then, now, relative });
    }
}

fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

fn shown(value: Option<&Value>) -> String {
    let Some(value) = value else { return "(absent)".to_owned() };
    let text = value.to_string();
    if text.chars().count() <= SHOWN {
        return text;
    }
    text.chars().take(SHOWN - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_difference_is_named_with_its_place_and_equal_values_are_counted() {
        let then = json!({ "provenance": { "date_utc": "then" }, "a": { "b": [1.0, 200.0, 3] }, "c": "x", "gone": 1 });
        let now = json!({ "provenance": { "date_utc": "now" }, "a": { "b": [1.0, 201.0, 3, 4] }, "c": "y", "new": null });
        let found = differences(&then, &now, 1e-9);
        let paths: Vec<&str> = found.all.iter().map(|one| one.path.as_str()).collect();
        assert_eq!(paths, ["a.b.1", "a.b.3", "c", "gone", "new"]);
        let number = &found.all[0];
        assert_eq!((number.then.as_str(), number.now.as_str()), ("200.0", "201.0"));
        assert!((number.relative.expect("of numbers") - 1.0 / 201.0).abs() < 1e-15);
        assert_eq!((found.all[1].then.as_str(), found.all[4].now.as_str()), ("(absent)", "null"));
        assert_eq!((found.numbers, found.others), (3, 4));
    }

    #[test]
    fn the_tolerance_is_relative_for_large_numbers_and_absolute_for_small_ones() {
        let differ = |a: f64, b: f64| !differences(&json!(a), &json!(b), 1e-3).all.is_empty();
        assert!(differ(1000.0, 1002.0) && !differ(1000.0, 1000.5));
        assert!(differ(0.1, 0.102) && !differ(0.1, 0.1005));
        assert!(!differences(&json!(1.0), &json!(1.0 + f64::EPSILON), 0.0).all.is_empty());
    }
}
