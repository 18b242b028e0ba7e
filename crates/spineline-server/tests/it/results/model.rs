#![expect(clippy::disallowed_methods, reason = "the oracle has its own formulas")]
use serde_json::{Value, json};
use spineline::analysis::{Analysis, analyze};
use spineline::anatomy::Level;
use spineline::multibody::{Support, Wrench};
use spineline::spatial::Vec3;
use spineline_store::Store;

use super::server::{Running, add_read_study, add_study, assert_numbers, name, phantom, serve};

/// JSON keeps doubles exactly; only the order of sums differs.
const SAME_MM: f64 = 1e-9;

fn running() -> (Running, Analysis) {
    let mut exported = None;
    let running = serve(|store: &mut Store| {
        add_read_study(store, "S1", &phantom().case);
        exported = Some(store.export_case(&name("S1")).expect("a case").text);
    });
    let case = spineline_files::parse_case(&exported.expect("exported")).expect("our own file");
    let analysis = analyze(&case, &Default::default()).expect("a phantom");
    (running, analysis)
}

fn points(value: &Value) -> Vec<Vec3> {
    let number = |v: &Value| v.as_f64().expect("a number");
    let point = |p: &Value| Vec3::new(number(&p[0]), number(&p[1]), number(&p[2]));
    value.as_array().expect("points").iter().map(point).collect()
}

fn farthest_mm(a: &[Vec3], b: &[Vec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn models_equal_those_of_the_exported_case() {
    let (running, analysis) = running();
    let model = running.get("/api/studies/S1/model");
    assert_numbers(&model, "model");
    assert_eq!(model["synthetic"], true);
    // The app compares this text.
    assert_eq!(model["length_unit"], "mm (patient)");
    let population = analysis.movement.levels().iter().map(|_| "population");
    assert_eq!(model["pitch_from"], population.collect::<Value>());
    assert!(
        farthest_mm(
            &points(&model["erect"]["midpoints_mm"]),
            &analysis.movement.spine.midpoints_mm
        ) < SAME_MM
    );
    let compared = analysis.comparison();
    let automatic = analysis.choose_model().expect("a model");
    assert_eq!(model["automatic"], automatic.kind.key());
    assert_eq!(model["automatic_text"], json!(compared.choice_words()));
    let lines = model["lines"].as_array().expect("lines");
    assert_eq!(lines.len(), analysis.models.len());
    for (line, expected) in lines.iter().zip(&analysis.models) {
        assert_eq!(line["kind"], expected.kind.key());
        let error = line["fitted_error_mm"].as_f64().expect("fitted films");
        let own = expected.mean_location_error_mm(true).expect("fitted films");
        assert!((error - own).abs() < SAME_MM);
        for (view, factor) in
            line["multipliers"].as_array().expect("a list").iter().zip(expected.multipliers())
        {
            assert!((view["factor"].as_f64().expect("a number") - factor).abs() < 1e-9);
            // Without a known force, values are not absolute.
            assert_ne!(view["identified"], "absolute");
        }
        for (posture, simulation) in
            line["postures"].as_array().expect("a list").iter().zip(&expected.simulations)
        {
            let path = posture["path"].as_array().expect("shapes");
            assert_eq!(path.len(), 11);
            let first = points(&path[0]["midpoints_mm"]);
            assert!(farthest_mm(&first, &analysis.movement.spine.midpoints_mm) < SAME_MM);
            let last = points(&path[10]["midpoints_mm"]);
            for (point, location) in last.iter().zip(&simulation.shape.locations) {
                assert!((point.y - location.y_mm).hypot(point.z - location.z_mm) < 1e-6);
            }
        }
    }
}

#[test]
fn joints_are_at_the_same_place_in_both_vertebrae() {
    let (running, analysis) = running();
    let model = running.get("/api/studies/S1/model");
    let shape = &model["lines"][0]["postures"][0]["path"][10];
    let (midpoints, joints) = (points(&shape["midpoints_mm"]), points(&shape["joints_mm"]));
    assert_eq!((midpoints.len(), joints.len()), (15, 14));
    for (j, joint) in analysis.movement.spine.joints.iter().enumerate() {
        // Vertebrae are rigid: loads do not change the distance of a joint from the midpoints beside it.
        let below = (joints[j] - midpoints[j]).norm();
        let above = (midpoints[j + 1] - joints[j]).norm();
        assert!((below - joint.centre_in_inferior_mm.norm()).abs() < SAME_MM);
        assert!((above - joint.rise_in_inferior_mm.norm()).abs() < SAME_MM);
    }
}

#[test]
fn joint_colours_span_the_stiffness_of_all_models() {
    let (running, _) = running();
    let model = running.get("/api/studies/S1/model");
    let joints = model["lines"]
        .as_array()
        .expect("lines")
        .iter()
        .flat_map(|l| l["joints"].as_array().expect("joints"));
    let relative: Vec<f64> = joints.map(|j| j["relative"].as_f64().expect("a number")).collect();
    assert!(relative.iter().all(|r| (0.0..=1.0).contains(r)));
    assert!(relative.contains(&0.0) && relative.contains(&1.0));
}

#[test]
fn a_zero_load_gives_the_erect_shape() {
    let (running, analysis) = running();
    let erect = analysis.movement.spine.midpoints_mm[9];
    let load = json!({ "kind": "iliac_line", "level": Level::MODEL[9].name(), "tip_mm": [erect.x, erect.y, erect.z] });
    let answer = running.post("/api/studies/S1/load", &load);
    assert_eq!((&answer["converged"], &answer["part"]), (&json!(true), &json!(1.0)));
    let shape = points(&answer["shape"]["midpoints_mm"]);
    assert!(farthest_mm(&shape, &analysis.movement.spine.midpoints_mm) < SAME_MM);
}

/// Equilibrium at every joint, computed independently: the springs' moment along each hinge equals the moment of the
/// force about the joint.
#[test]
fn a_loaded_shape_is_in_equilibrium_at_every_joint() {
    let (running, analysis) = running();
    assert_eq!(analysis.options.support, Support::Frontal);
    let vertebra = 10;
    let force_n = Vec3::new(2.0, 16.0, -4.0);
    let tip = analysis.movement.spine.midpoints_mm[vertebra] + force_n;
    let load = json!({ "kind": "iliac_line", "level": Level::MODEL[vertebra].name(), "tip_mm": [tip.x, tip.y, tip.z] });
    let answer = running.post("/api/studies/S1/load", &load);
    assert_numbers(&answer, "load");
    assert_eq!(answer["converged"], true, "{answer}");
    let shape = &answer["shape"];
    let (midpoints, joints) = (points(&shape["midpoints_mm"]), points(&shape["joints_mm"]));
    assert!((midpoints[vertebra] - analysis.movement.spine.midpoints_mm[vertebra]).norm() > 5.0);
    let rotation = |i: usize| {
        let rows: Vec<f64> =
            serde_json::from_value(shape["rotations"][i].clone()).expect("nine numbers");
        nalgebra::Matrix3::from_row_slice(&rows)
    };
    let model = analysis.models.iter().find(|m| m.kind.key() == "iliac_line").expect("a model");
    let springs = model.stiffness_nmm_per_rad(&analysis.options.library);
    let wrench = Wrench::at(midpoints[vertebra], force_n);
    for (j, spring) in springs.iter().enumerate() {
        let (below, above) = (rotation(j), rotation(j + 1));
        // Rotations of the hinges, as angles about x, then y, then z of the inferior vertebra: the first carries the
        // load.
        let turned = below.transpose()
            * above
            * analysis.movement.spine.joints[j].inferior_from_superior.transpose();
        let y = turned[(0, 2)].asin();
        let x = (-turned[(1, 2)]).atan2(turned[(2, 2)]);
        let z = (-turned[(0, 1)]).atan2(turned[(0, 0)]);
        let carried = if j < vertebra {
            wrench.moment_nmm - joints[j].cross(&wrench.force_n)
        } else {
            Vec3::zeros()
        };
        // Flexion and axial hinges are locked.
        assert!(y.abs() < 1e-9 && z.abs() < 1e-9, "joint {j}: {y} {z}");
        let in_below = below.transpose() * carried;
        // A thousandth of a N·mm, beside thousands.
        assert!((in_below.x - x * spring[0]).abs() < 1e-3, "joint {j}");
    }
}

#[test]
fn invalid_loads_are_refused_with_a_message() {
    let (running, _) = running();
    for (level, tip) in
        [("L4", [0.0, 10.0, 0.0]), ("C3", [0.0, 10.0, 0.0]), ("T5", [0.0, 1e9, 0.0])]
    {
        let load = json!({ "kind": "iliac_line", "level": level, "tip_mm": tip });
        let (status, body) = running.ask("POST", "/api/studies/S1/load", Some(&load));
        assert_eq!(status, 422, "{level}");
        assert!(body["help"].as_str().is_some_and(|help| !help.is_empty()));
    }
    let unknown = json!({ "kind": "iliac_line", "level": "T5", "tip_mm": [0.0, 0.0, 0.0] });
    assert_eq!(running.ask("POST", "/api/studies/S9/load", Some(&unknown)).0, 404);
}

#[test]
fn the_analysis_file_equals_that_of_the_command_line() {
    let (running, analysis) = running();
    let file = running.get("/api/studies/S1/exports/analysis");
    let stored = spineline_files::parse_analysis(&file.to_string()).expect("enough to repeat it");
    let own = spineline_files::AnalysisFile::new(&analysis, stored.case_file, stored.provenance);
    let own: Value = serde_json::from_str(&spineline_files::results_text(&own)).expect("JSON");
    assert_eq!(file["chain"], own["chain"]);
    assert_eq!(file["inflections"], own["inflections"]);
    let again = spineline::analysis::analyze(&stored.case, &stored.request.options);
    assert_eq!(again.expect("the same case").movement.chain, analysis.movement.chain);
}

#[test]
fn a_study_without_readings_says_what_is_missing() {
    let running = serve(|store| drop(add_study(store, "S1", &phantom().case)));
    let (status, body) = running.ask("GET", "/api/studies/S1/model", None);
    assert_eq!((status, &body["code"]), (409, &json!("not_ready")));
    let findings = running.get("/api/studies/S1/findings");
    assert_eq!(findings["status"], "partial");
    assert!(findings["study"].is_null());
}
