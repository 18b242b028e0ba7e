//! Computations in the background: progress, cancel, results, and their place in exports.

use axum::http::StatusCode;
use serde_json::{Value, json};
use spineline::hypothesis::Hypothesis;

use crate::browser::changed_options;
use crate::demo::app_with_demo;
use crate::films::decoding;

const PATH: &str = "/api/studies/demo-rod-01/computations/replicates";

#[test]
fn replicates_are_computed_and_shown_and_cancelled() {
    let app = app_with_demo();
    let lead = app.observer("Ann");
    assert_eq!(lead.get(PATH).json()["state"], "none");
    for count in [0, 2001] {
        let refused = lead.post(PATH, &json!({ "count": count }));
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
    }

    let begun = lead.post(PATH, &json!({ "count": 60 }));
    assert_eq!((begun.status, &begun.json()["asked"]), (StatusCode::OK, &json!(60)));
    let done = lead.ended(PATH);
    assert_eq!((&done["state"], &done["done"]), (&json!("done"), &json!(60)), "{done}");
    let intervals = done["intervals"].as_array().expect("intervals");
    let has = |word: &str| {
        intervals.iter().any(|one| one["label"].as_str().is_some_and(|l| l.contains(word)))
    };
    assert!(has("Cobb angle") && has("multiplier") && has("force"), "{done}");
    let of = |text: &str| text.contains(" to ") || text == "none: at its bound, not identified";
    assert!(intervals.iter().all(|one| one["interval"].as_str().is_some_and(of)));
    let report = lead.get("/api/studies/demo-rod-01/exports/report").text();
    assert!(report.contains("Effect of landmark noise on the results"));

    // Kept over a restart for these landmarks and options only.
    let app = app.restarted(decoding());
    let lead = app.observer("Ann");
    let report = lead.get("/api/studies/demo-rod-01/exports/report").text();
    assert!(report.contains("Effect of landmark noise on the results"));
    assert_eq!(lead.get(PATH).json(), done);
    let change = |revision: u64, value: &str| changed_options(revision, &[("support", value)]);
    let options = "/api/studies/demo-rod-01/options";
    lead.put(options, &change(0, "free")).succeeded();
    assert_eq!(lead.get(PATH).json()["state"], "none");
    lead.put(options, &change(1, "")).succeeded();
    assert_eq!(lead.get(PATH).json(), done);

    assert_eq!(lead.post(PATH, &json!({ "count": 2000 })).status, StatusCode::OK);
    let twice = lead.post(PATH, &json!({ "count": 10 }));
    assert_eq!((twice.status, twice.code().as_str()), (StatusCode::CONFLICT, "running"));
    assert_eq!(lead.delete(PATH).status, StatusCode::OK);
    let cancelled = lead.ended(PATH);
    assert_eq!(cancelled["state"], "cancelled");
    assert!(cancelled["done"].as_u64().is_some_and(|done| done < 2000), "{cancelled}");
}

/// All cells of the first column of a section's tables, and the names of its pictures.
fn parts(view: &Value) -> (Vec<String>, Vec<String>) {
    let blocks = |section: &Value| section["blocks"].as_array().expect("blocks").clone();
    let sections = view["sections"].as_array().expect("sections");
    let (mut cells, mut pictures) = (Vec::new(), Vec::new());
    for block in sections.iter().flat_map(blocks) {
        let of = &block["of"];
        match block["kind"].as_str() {
            Some("table") => cells.extend(
                of["rows"]
                    .as_array()
                    .expect("rows")
                    .iter()
                    .map(|row| row[0].as_str().expect("a text").to_owned()),
            ),
            Some("figure") => {
                assert!(
                    of["svg"].as_str().is_some_and(|svg| svg.to_lowercase().contains("synthetic"))
                );
                pictures.push(of["name"].as_str().expect("a name").to_owned());
            }
            _ => {}
        }
    }
    (cells, pictures)
}

#[test]
fn identifiability_and_other_models_are_computed_and_exported() {
    let app = app_with_demo();
    let lead = app.observer("Ann");
    let path = |kind: &str| format!("/api/studies/demo-rod-01/computations/{kind}");
    let unknown = lead.get(&path("everything"));
    assert_eq!(unknown.status, StatusCode::NOT_FOUND, "{}", unknown.text());
    for kind in ["identifiability", "models"] {
        let path = path(kind);
        assert_eq!(lead.get(&path).json()["state"], "none");
        let refused = lead.post(&path, &json!({ "count": 5 }));
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert_eq!(lead.post(&path, &json!({})).status, StatusCode::OK);
    }
    let found = lead.ended(&path("identifiability"));
    assert_eq!((&found["state"], &found["done"]), (&json!("done"), &json!(3)), "{found}");
    let (cells, pictures) = parts(&found);
    assert_eq!(pictures, ["profiles"]);
    assert_eq!(cells.iter().filter(|cell| *cell == "inflection line").count(), 3, "{cells:?}");

    let found = lead.ended(&path("models"));
    assert_eq!(found["state"], "done", "{found}");
    let (cells, _) = parts(&found);
    for hypothesis in Hypothesis::compared() {
        assert!(cells.contains(&hypothesis.to_string()), "{hypothesis}: {cells:?}");
    }
    let report = lead.get("/api/studies/demo-rod-01/exports/report").text();
    assert!(report.contains("Identifiability of the multipliers, case"));
    assert!(report.contains("Loads and bases compared"));
    let analysis = lead.get("/api/studies/demo-rod-01/exports/analysis").text();
    let again = spineline_files::parse_analysis(&analysis).expect("an analysis to repeat");
    let request = again.provenance.request().expect("valid").expect("a request");
    assert!(request.identifiability);
    assert_eq!(request.options.hypotheses, Hypothesis::compared());

    // Both are kept over a restart, for these landmarks and options, with every number and warning.
    let kinds = ["identifiability", "models"];
    let said = kinds.map(|kind| lead.get(&path(kind)).json());
    let written = |text: &str| {
        let analysis: Value = serde_json::from_str(text).expect("JSON");
        ["hypotheses", "warnings"].map(|key| analysis[key].clone())
    };
    let before = written(&analysis);
    let app = app.restarted(decoding());
    let lead = app.observer("Ann");
    let analysis = lead.get("/api/studies/demo-rod-01/exports/analysis").text();
    assert_eq!(written(&analysis), before);
    assert_eq!(kinds.map(|kind| lead.get(&path(kind)).json()), said);
    let report = lead.get("/api/studies/demo-rod-01/exports/report").text();
    assert!(report.contains("Identifiability of the multipliers, case"));
    assert!(report.contains("Loads and bases compared"));

    // Other options give other results.
    let change = changed_options(0, &[("support", "free")]);
    lead.put("/api/studies/demo-rod-01/options", &change).succeeded();
    for kind in ["identifiability", "models"] {
        assert_eq!(lead.get(&path(kind)).json()["state"], "none", "{kind}");
    }
}

#[test]
fn the_lines_have_baselines_the_choice_and_pictures() {
    let app = app_with_demo();
    let lead = app.observer("Ann");
    let sections = lead.get("/api/studies/demo-rod-01/lines").json();
    let (cells, pictures) = parts(&json!({ "sections": sections }));
    assert_eq!(pictures, ["predictions", "line"]);
    assert!(cells.iter().any(|cell| cell.starts_with("* ")), "{cells:?}");
    assert!(sections.to_string().contains("Of the lines that take fewest numbers"));
}
