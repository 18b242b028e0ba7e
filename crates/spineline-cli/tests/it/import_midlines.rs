//! `spineline import --midlines`: cases from the surface of the back.

use serde_json::Value as Json;

use crate::program::folder;

/// A line of the back that bends, as a scanner with x to the patient's right and y down has it.
fn midline(posture: &str, bend_mm: f64) -> Json {
    let points = (0..=90).map(|i| {
        let part = f64::from(i) / 90.0;
        let bend = bend_mm * (1.0 - part) + 12.0 * (2.0 * std::f64::consts::PI * part).sin();
        [bend, 430.0 * part, 1000.0]
    });
    serde_json::json!({
        "posture": posture, "observer": "scan", "repeat": 1, "cranial_end": "C7", "caudal_end": "S1",
        "axes": ["right", "caudal", "anterior"], "points_mm": points.collect::<Vec<_>>(),
    })
}

#[test]
fn midlines_of_the_back_make_a_case_that_says_its_levels_are_estimates() {
    let here = folder();
    let lines =
        serde_json::json!({ "midlines": [midline("erect", 0.0), midline("left_bending", -120.0)] });
    here.write("lines.json", lines.to_string());
    let import = ["--midlines", "lines.json", "--case-id", "P07", "--out", "p07"];
    let out = here.imported(&import);
    assert!(out.contains("No vertebra was seen"), "{out}");
    let case = here.json("p07/case.json");
    assert_eq!(case["films"][0]["placement_source"], "surface_midline");
    assert_eq!(case["films"][1]["posture"], "left_bending");
    let t2 = &case["films"][1]["readings"][0]["vertebrae"]["T2"];
    // The bend is to the patient's left, where tilts are negative.
    assert!(t2["location_mm"][0].as_f64() > Some(90.0), "{t2}");
    assert!(t2["tilt_deg"].as_f64() < Some(-5.0), "{t2}");
    let (out, error, _) = here.run(&["check", "p07/case.json"]);
    assert!(out.contains("no vertebra was seen"), "{out}{error}");
    // Nothing is overwritten, and a file of landmarks is not a file of midlines.
    assert_ne!(here.import(&import).2, 0);
    here.write("marks.json", r#"{"shapes":[]}"#);
    here.import_refused(&["--midlines", "marks.json", "--case-id", "B", "--out", "b"], 3);
    let (_, error, _) =
        here.import(&["--midlines", "lines.json", "lines.json", "--case-id", "B", "--out", "b"]);
    assert!(error.contains("second erect midline"), "{error}");
    // Estimated levels are not passed on as seen ones.
    let (_, error, code) = here.run(&["export", "p07/case.json", "--to", "csv"]);
    assert!(code != 0 && error.contains("surface midline"), "{error}");
}
