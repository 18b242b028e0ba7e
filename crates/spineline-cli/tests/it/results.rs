//! What a file holds beside when and by which command it was made.

use serde_json::Value;

/// A text without the command line, the date and the hash of both, which differ by nature; everything else stays as it is.
pub fn results(text: &str) -> String {
    if let Some((before, rest)) = text.split_once("<metadata>") {
        let (metadata, after) = rest.split_once("</metadata>").expect("an end");
        return format!("{before}{}{after}", results(metadata));
    }
    let Ok(mut json) = serde_json::from_str::<Value>(text) else { return text.to_owned() };
    assert!(strip(&mut json) > 0, "it says when and by which command it was made");
    serde_json::to_string_pretty(&json).expect("string keys")
}

/// Strips every provenance, and says how many there were.
fn strip(value: &mut Value) -> usize {
    match value {
        Value::Array(all) => all.iter_mut().map(strip).sum(),
        Value::Object(all) => {
            let here = usize::from(all.remove("command").is_some());
            assert_eq!(all.remove("date_utc").is_some(), here == 1, "a command has a date");
            all.remove("content_sha256");
            here + all.values_mut().map(strip).sum::<usize>()
        }
        _ => 0,
    }
}
