//! Model options: every result of a study equals the library's result with these options.

use axum::http::StatusCode;
use serde_json::{Value, json};
use spineline::analysis::{AnalysisOptions, analyze};
use spineline::anatomy::Posture;
use spineline::multibody::Support;
use spineline::personalize::FitTarget;
use spineline_files::method_text::set_option;
use spineline_phantom::{Readers, Scenario, generate};

use super::server::{Running, add_read_study, name, phantom, serve};
use crate::browser::{App, changed_options};

const OPTIONS: &str = "/api/studies/S1/options";
/// JSON keeps doubles exactly; only the order of sums differs.
const SAME_MM: f64 = 1e-9;

fn put(running: &Running, body: &Value) -> (u16, Value) {
    running.ask("PUT", OPTIONS, Some(body))
}

fn option<'v>(view: &'v Value, name: &str) -> &'v Value {
    let all = view["options"].as_array().expect("options");
    all.iter().find(|one| one["name"] == name).expect("a known option")
}

/// Mean location error of the first line on fitted films.
fn error_mm(running: &Running) -> f64 {
    let model = running.get("/api/studies/S1/model");
    model["lines"][0]["fitted_error_mm"].as_f64().expect("a number")
}

#[test]
fn results_are_those_of_the_library_with_the_options_until_they_are_reset() {
    let mut exported = None;
    let two = generate(1, Scenario::Rod, &Readers::exact(), 1).expect("subject 2 exists").case;
    let running = serve(|store| {
        add_read_study(store, "S1", &phantom().case);
        add_read_study(store, "S2", &two);
        exported = Some(store.export_case(&name("S1")).expect("a case").text);
    });
    let case = spineline_files::parse_case(&exported.expect("exported")).expect("our own file");
    let before = running.get(OPTIONS);
    assert_eq!((&before["revision"], &before["may_change"]), (&json!(0), &json!(true)));
    assert_eq!(before["changed_text"], Value::Null);
    let support = option(&before, "support");
    assert_eq!((&support["value"], &support["is_closed"]), (&json!("frontal"), &json!(true)));
    assert!(option(&before, "order_rule")["help"].as_str().is_some_and(|h| h.contains("4 to 12")));
    let default_mm = error_mm(&running);

    let chosen = [("support", "free"), ("multipliers", "per-joint"), ("inflections", "L1/T12,T6")];
    let (status, after) = put(&running, &changed_options(0, &chosen));
    assert_eq!((status, &after["revision"]), (200, &json!(1)), "{after}");
    let mut options = AnalysisOptions::default();
    chosen
        .iter()
        .for_each(|(name, value)| drop(set_option(&mut options, name, value).expect("valid")));
    let expected = analyze(&case, &options).expect("a phantom");
    let expected_mm = expected.models[0].mean_location_error_mm(true).expect("fitted films");
    assert!((expected_mm - default_mm).abs() > 1e-3, "the options matter");
    assert!((error_mm(&running) - expected_mm).abs() < SAME_MM);

    let words = "Support: free; Multipliers: per-joint; Inflections: L1/T12,T6";
    assert_eq!(after["changed_text"], words);
    assert_eq!(running.get("/api/studies/S1/model")["options_text"], words);
    let findings = running.get("/api/studies/S1/findings");
    assert_eq!(findings["options_text"], words);
    let inflections = findings["study"]["inflections_text"].as_str().expect("words");
    assert_eq!(inflections, expected.inflection_words());
    let cohort = running.get("/api/cohort");
    assert_eq!(cohort["rows"][0]["options_text"], words);
    assert_eq!(cohort["rows"][1]["options_text"], Value::Null);
    let notices = cohort["notices"].as_array().expect("notices");
    let mixed = notices.iter().find(|one| one["code"] == "options_changed").expect("a notice");
    assert_eq!(mixed["severity"], "warning");
    let exported = running.get("/api/studies/S1/exports/analysis");
    assert_eq!(exported["provenance"]["options"]["support"], "free");

    let (status, reset) =
        put(&running, &json!({ "expected_revision": 1, "reset": true, "options": [] }));
    assert_eq!((status, &reset["changed_text"]), (200, &Value::Null), "{reset}");
    assert!((error_mm(&running) - default_mm).abs() < SAME_MM);
}

#[test]
fn a_wrong_value_changes_nothing_and_an_impossible_one_is_a_refusal_of_the_results() {
    let mut case = phantom().case;
    case.films.retain(|film| film.posture != Posture::Traction);
    let running = serve(|store| add_read_study(store, "S1", &case));
    for (name, value, word) in [
        ("support", "fre", "expected one of"),
        ("order_rule", "3", "4 to 12"),
        ("stiffness", "/etc/passwd", "expected one of motion"),
        ("inflections", "T6,L1", "the caudal site comes first"),
        ("rotation_prior", "/etc/passwd", "expected a file of"),
    ] {
        let (status, refused) = put(&running, &changed_options(0, &[(name, value)]));
        let message = refused["message"].as_str().unwrap_or_default();
        assert!(status == 422 && message.contains(word), "{refused}");
    }
    assert_eq!(running.get(OPTIONS)["revision"], 0);

    let (status, view) =
        put(&running, &changed_options(0, &[("gauge", "known-force:traction=120")]));
    assert_eq!(status, 200, "{view}");
    let (status, refused) = running.ask("GET", "/api/studies/S1/model", None);
    assert_eq!(status, 422);
    assert!(refused["message"].as_str().is_some_and(|text| text.contains("traction film")));
    let findings = running.get("/api/studies/S1/findings");
    assert_eq!((&findings["status"], &findings["study"]), (&json!("refused"), &Value::Null));
    assert_eq!(findings["options_text"], "Scale constraint (gauge): known-force:traction=120");
    let stale = put(&running, &changed_options(0, &[("gauge", "")]));
    assert_eq!((stale.0, &stale.1["code"]), (409, &json!("conflict")));
    let (status, view) = put(&running, &changed_options(1, &[("gauge", "")]));
    assert_eq!((status, &view["changed_text"]), (200, &Value::Null));
    assert_eq!(running.ask("GET", "/api/studies/S1/model", None).0, 200);
}

#[test]
fn a_file_and_lines_of_ones_own_are_kept_used_and_named() {
    let running = serve(|store| add_read_study(store, "S1", &phantom().case));
    let default_mm = error_mm(&running);
    let springs = spineline::multibody::StiffnessTable::InVitro.library();
    let text = spineline_files::to_text(&spineline_files::StiffnessFile::from(&springs));
    let body = json!({
        "expected_revision": 0, "reset": false,
        "options": [
            { "name": "stiffness", "value": text, "file": "/home/ann/springs.json" },
            { "name": "given_line", "value": "left_bending=20,150,-5; right_bending=-20,150,5" },
        ]
    });
    let (status, view) = put(&running, &body);
    assert_eq!(status, 200, "{view}");
    let shown = option(&view, "stiffness")["value"].as_str().expect("words");
    assert!(shown.starts_with("springs.json (SHA-256 "), "{shown}");
    let words = view["changed_text"].as_str().expect("words");
    assert!(
        words.contains(shown) && words.contains("Given line of action: left_bending=20,150,-5")
    );

    let mut options = AnalysisOptions { library: springs, ..AnalysisOptions::default() };
    for line in ["left_bending=20,150,-5", "right_bending=-20,150,5"] {
        set_option(&mut options, "given_line", line).expect("a line");
    }
    let expected = analyze(&phantom().case, &options).expect("a phantom");
    let expected_mm = expected.models[0].mean_location_error_mm(true).expect("fitted films");
    assert!((error_mm(&running) - expected_mm).abs() < SAME_MM && expected_mm != default_mm);
    let model = running.get("/api/studies/S1/model");
    assert_eq!(model["lines"][3]["kind"], "given_line");

    // The name of the file stays with its text.
    let (status, again) = put(&running, &changed_options(1, &[("support", "free")]));
    assert_eq!((status, &option(&again, "stiffness")["value"]), (200, &json!(shown)), "{again}");
    for (name, value) in [("stiffness", "{}"), ("rotation_prior", "{}"), ("support", "free")] {
        let body = json!({
            "expected_revision": 2, "reset": false,
            "options": [{ "name": name, "value": value, "file": "own.json" }]
        });
        assert_eq!(put(&running, &body).0, 422, "{name}");
    }
}

#[test]
fn the_papers_method_is_one_option_that_others_replace() {
    let running = serve(|store| add_read_study(store, "S1", &phantom().case));
    let (status, view) = put(
        &running,
        &changed_options(0, &[("support", "frontal"), ("method", "paper"), ("fit", "shape")]),
    );
    assert_eq!(status, 200, "{view}");
    assert_eq!(view["changed_text"], "Method: paper; Support: frontal; Fitted to: shape");
    let [support, tilt] = ["support", "tilt"].map(|name| option(&view, name));
    assert_eq!((&support["value"], &support["default"]), (&json!("frontal"), &json!("free")));
    assert_eq!((&tilt["value"], &tilt["is_changed"]), (&json!("axis"), &json!(false)));
    let options = AnalysisOptions {
        support: Support::Frontal,
        target: FitTarget::Shape,
        ..AnalysisOptions::paper()
    };
    let expected = analyze(&phantom().case, &options).expect("a phantom");
    let expected_mm = expected.models[0].mean_location_error_mm(true).expect("fitted films");
    assert!((error_mm(&running) - expected_mm).abs() < SAME_MM);
    let (status, view) = put(&running, &changed_options(1, &[("method", "default")]));
    assert_eq!((status, &view["changed_text"]), (200, &Value::Null), "{view}");
}

#[test]
fn only_editors_change_options() {
    let app = App::with_accounts();
    let path = "/api/studies/S-1/options";
    let body = changed_options(0, &[("support", "free")]);
    let reader = app.account("reader");
    assert_eq!(reader.get(path).json()["may_change"], false);
    assert_eq!(reader.put(path, &body).status, StatusCode::FORBIDDEN);
    assert_eq!(app.account("editor").put(path, &body).json()["revision"], 1);
    assert_eq!(reader.get(path).json()["changed_text"], "Support: free");
    assert_eq!(app.account("ungranted").get(path).status, StatusCode::NOT_FOUND);
}
