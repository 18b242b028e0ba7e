//! Spines solved by nine other programs, where `SPINELINE_DATA` names a folder that holds them.

mod common;

use std::path::{Path, PathBuf};

use common::assert_near;
use serde_json::Value;
use spineline::action::{Application, LineOfAction};
use spineline::multibody::{
    ForceSign, Load, MatchStatus, Solution, SpineModel, Statics, Support, match_amplitude,
};
use spineline::spatial::{Angle, Frontal, Mat3, Vec3};

/// The programs agree with one another to 1.4e-10 mm; their files have fewer digits in the input.
const MIDPOINT_MM: f64 = 1e-6;
/// Relative: an amplitude to 1e-9 rad holds the force at least so well.
const FORCE: f64 = 1e-6;

struct SolvedCase {
    name: String,
    model: SpineModel,
    stiffness: Vec<[f64; 3]>,
    load: Load,
    /// Lean of L4→T2: right positive, while the file counts left.
    target: Angle,
    /// Force and midpoints by program.
    solutions: Vec<(String, f64, Vec<Vec3>)>,
}

fn vector(value: &Value) -> Vec3 {
    let numbers: Vec<f64> = numbers(value);
    Vec3::new(numbers[0], numbers[1], numbers[2])
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("an array of numbers");
    list.iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("an array")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn read_case(path: &Path) -> SolvedCase {
    let text = std::fs::read_to_string(path).expect("a readable case");
    let json: Value = serde_json::from_str(&text).expect("a case is JSON");
    let vertebrae = list(&json["vertebrae"]);
    let midpoints: Vec<Vec3> = vertebrae.iter().map(|v| vector(&v["midpoint_mm"])).collect();
    let axes: Vec<Mat3> = vertebrae
        .iter()
        .map(|v| {
            let rows: Vec<Vec<f64>> = list(&v["rotation"]).iter().map(numbers).collect();
            Mat3::from_fn(|i, j| rows[i][j])
        })
        .collect();
    let joints = list(&json["joints"]);
    let centres: Vec<Vec3> = joints
        .iter()
        .enumerate()
        .map(|(i, joint)| axes[i].transpose() * (vector(&joint["position_mm"]) - midpoints[i]))
        .collect();
    let stiffness = joints
        .iter()
        .map(|joint| vector(&joint["stiffness_Nmm_per_rad"]).into())
        .collect::<Vec<[f64; 3]>>();
    let direction = vector(&json["load"]["direction"]);
    assert_near(direction.x, 0.0, 0.0, "the direction is frontal");
    let direction = Frontal::new(direction.y, direction.z);
    let line = |point: Vec3, application| {
        let place = Frontal::new(point.y, point.z);
        Load::along(LineOfAction { point: place, direction, application }, point.x)
    };
    let load = match json["load"]["type"].as_str() {
        Some("A") => line(vector(&json["load"]["point_mm"]), Application::Fixed),
        Some("B") => line(midpoints[midpoints.len() - 1], Application::AtT2),
        other => panic!("unknown load {other:?}"),
    };
    let solutions = json["solutions"]["euler-xyz"].as_object().expect("solutions by program");
    let solutions = solutions
        .iter()
        .map(|(program, solution)| {
            let places = list(&solution["midpoints_mm"]).iter().map(vector).collect();
            (program.clone(), number(&solution["F_N"]), places)
        })
        .collect();
    SolvedCase {
        name: json["name"].as_str().expect("a name").to_owned(),
        model: SpineModel::from_poses(midpoints, axes, &centres),
        stiffness,
        load,
        target: Angle::from_rad(-number(&json["target_amplitude_rad"])),
        solutions,
    }
}

/// The solved cases, in the order of their names; `None` where no folder was named.
fn solved_cases() -> Option<Vec<SolvedCase>> {
    let Some(folder) = std::env::var_os("SPINELINE_DATA") else {
        println!("skipped: SPINELINE_DATA is not set");
        return None;
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
    Some(paths.iter().map(|path| read_case(path)).collect())
}

impl SolvedCase {
    fn statics(&self) -> Statics<'_> {
        Statics::from_stiffness(&self.model, self.stiffness.clone(), &[0; 14], Support::Free)
    }
}

#[test]
fn under_the_force_of_other_programs_every_midpoint_is_theirs() {
    // Oracle: midpoints of MuJoCo, Pinocchio, OpenSim, Robotics Toolbox, numpy, C++ and Octave.
    for case in solved_cases().unwrap_or_default() {
        for (program, force_n, midpoints) in &case.solutions {
            let mut solution = Solution::default();
            case.statics().solve(&case.load, &[*force_n], &[], &mut solution);
            assert!(solution.converged);
            for (ours, theirs) in solution.deformed.midpoints_mm.iter().zip(midpoints) {
                let what = format!("{}, {program}: midpoint", case.name);
                assert_near((ours - theirs).norm(), 0.0, MIDPOINT_MM, &what);
            }
        }
    }
}

#[test]
fn the_force_that_meets_the_amplitude_is_that_of_other_programs() {
    // Oracle: the smallest positive force that each of those programs found.
    for case in solved_cases().unwrap_or_default() {
        let found = match_amplitude(&case.statics(), &case.load, ForceSign::Positive, case.target);
        assert_eq!(found.status, MatchStatus::Matched, "{}", case.name);
        assert!(found.is_usable());
        for (program, force_n, _) in &case.solutions {
            let what = format!("{}, {program}: force", case.name);
            assert_near(found.force_n, *force_n, FORCE * force_n, &what);
        }
    }
}
