//! Spines solved by nine other programs, where `SPINELINE_DATA` names a folder that holds them.

use std::path::PathBuf;

use serde_json::Value;
use spineline::spatial::Vec3;

use super::case::{number, vector};
use super::{Case, Solved, solve};

/// The programs agree with one another to 1.4e-10 mm; their files have fewer digits in the input.
const MIDPOINT_MM: f64 = 1e-6;
/// Relative: an amplitude to 1e-9 rad fixes the force at least to this.
const FORCE: f64 = 1e-6;

/// Name, force and midpoints of every program in a file.
fn solutions(json: &Value) -> Vec<(String, f64, Vec<Vec3>)> {
    let programs = json["solutions"]["euler-xyz"].as_object().expect("solutions by program");
    let programs = programs.iter().map(|(program, solution)| {
        let places = solution["midpoints_mm"].as_array().expect("a list");
        let places = places.iter().map(|place| vector(place).expect("a point")).collect();
        (program.clone(), number(&solution["F_N"]).expect("a force"), places)
    });
    programs.collect()
}

/// The solved cases, in the order of their names; empty without a folder.
fn solved_cases() -> Vec<Solved> {
    let Some(folder) = std::env::var_os("SPINELINE_DATA") else {
        println!("skipped: SPINELINE_DATA is not set");
        return Vec::new();
    };
    let folder = PathBuf::from(folder).join("oracle");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder)
        .expect("SPINELINE_DATA holds a folder `oracle`")
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| {
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            name.starts_with("case_") && name.ends_with(".json")
        })
        .collect();
    paths.sort();
    assert!(!paths.is_empty(), "no case_*.json in {}", folder.display());
    let read = |path: &PathBuf| std::fs::read_to_string(path).expect("a readable case");
    paths
        .iter()
        .map(|path| solve(Case::parse(&read(path)).expect("a case")).expect("a solution"))
        .collect()
}

#[test]
fn force_and_midpoints_are_those_of_other_programs() {
    // Oracle: MuJoCo, Pinocchio, OpenSim, Robotics Toolbox, numpy, C++ and Octave.
    for solved in solved_cases() {
        let name = &solved.case.name;
        assert!(solved.march_force_n.is_some(), "{name}: the march finds no force");
        for (program, force_n, midpoints) in solutions(&solved.case.json) {
            let off = (solved.force_n - force_n).abs() / force_n;
            assert!(off <= FORCE, "{name}, {program}: force off by {off:e}");
            for (ours, theirs) in solved.deformed.midpoints_mm.iter().zip(&midpoints) {
                let off = (ours - theirs).norm();
                assert!(off <= MIDPOINT_MM, "{name}, {program}: midpoint off by {off:e} mm");
            }
        }
    }
}

#[test]
fn a_case_without_its_parts_is_refused_by_name() {
    let error = Case::parse(r#"{"vertebrae": []}"#).expect_err("no joints");
    assert!(error.contains("/joints"), "{error}");
    assert!(Case::parse("{").is_err());
}
