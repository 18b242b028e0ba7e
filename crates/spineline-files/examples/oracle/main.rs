//! Spines that other programs have solved, solved by the march and by Newton.
//!
//! ```text
//! cargo run --release --package spineline-files --example oracle -- CASE.json… --out DIR
//! ```

mod case;
#[cfg(test)]
mod tests;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use spineline::action::Application;
use spineline::multibody::{
    Deformed, ForceSign, GeneralStatics, Goal, Loading, PathEnding, PathOptions, Solution, Statics,
    Support, Wrench, match_amplitude,
};
use spineline::spatial::{Mat3, Vec3};

use case::Case;

/// Largest distance between march and Newton in a solved case.
const AGREE_MM: f64 = 1e-9;
/// Unit of the force on Newton's path.
const UNIT_N: f64 = 50.0;
/// Largest force of the search: far more than a spine bears.
const MAX_FORCE_N: f64 = 20_000.0;
const MAX_HINGE_RAD: f64 = 1.5;

/// A case with its solution.
#[derive(Debug)]
struct Solved {
    case: Case,
    force_n: f64,
    deformed: Deformed,
    /// Largest distance between the march's and Newton's midpoints.
    difference_mm: f64,
    /// Force that the march's own search finds; `None` beyond its range or outside of a frontal plane.
    march_force_n: Option<f64>,
}

/// Solves the cases that are named, and writes each into a folder with the solution put beside the others.
fn main() -> Result<(), String> {
    const USAGE: &str = "usage: oracle CASE.json… --out DIR";
    let mut files: Vec<PathBuf> = Vec::new();
    let mut out = None;
    let mut rest = env::args().skip(1);
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--out" => out = Some(PathBuf::from(rest.next().ok_or(USAGE)?)),
            option if option.starts_with('-') => return Err(format!("unknown {option}; {USAGE}")),
            file => files.push(PathBuf::from(file)),
        }
    }
    let out = out.filter(|_| !files.is_empty()).ok_or(USAGE)?;
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let mut failed = Vec::new();
    for file in &files {
        match solve_file(file, &out) {
            Ok(solved) => println!(
                "{:20} {:10.4} N (by the march: {})   midpoints differ by {:.1e} mm",
                solved.case.name,
                solved.force_n,
                solved.march_force_n.map_or("not looked so far".into(), |n| format!("{n:.4} N")),
                solved.difference_mm
            ),
            Err(error) => failed.push(format!("{}: {error}", file.display())),
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n  ")) }
}

fn solve_file(file: &Path, out: &Path) -> Result<Solved, String> {
    let text = fs::read_to_string(file).map_err(|error| error.to_string())?;
    let solved = solve(Case::parse(&text)?)?;
    let mut json = solved.case.json.clone();
    let vectors = |places: &[Vec3]| places.iter().map(|p| json!([p.x, p.y, p.z])).collect();
    json["solutions"]["euler-xyz"]["spineline"] = json!({
        "F_N": solved.force_n,
        "midpoints_mm": Value::Array(vectors(&solved.deformed.midpoints_mm)),
        "joint_coordinates_rad": solved.deformed.hinges_rad,
    });
    let name = file.file_name().ok_or("a file needs a name")?;
    let mut text = serde_json::to_string_pretty(&json).map_err(|error| error.to_string())?;
    text.push('\n');
    fs::write(out.join(name), text).map_err(|error| error.to_string())?;
    Ok(solved)
}

/// The smallest force greater than zero that meets the amplitude: Newton follows the branch, and the march checks.
fn solve(case: Case) -> Result<Solved, String> {
    let springs: Vec<Mat3> =
        case.stiffness_nmm_per_rad.iter().map(|k| Mat3::from_diagonal(&Vec3::from(*k))).collect();
    let general = GeneralStatics::new(&case.model, springs, Support::Free)
        .map_err(|error| error.to_string())?;
    let loading = Loading::single(case.model.joints.len(), case.body_load(UNIT_N));
    let options = PathOptions {
        sign: ForceSign::Positive,
        largest_factor: MAX_FORCE_N / UNIT_N,
        largest_hinge_rad: MAX_HINGE_RAD,
        ..PathOptions::default()
    };
    let path = general
        .follow(&loading, Goal::LateralTilt(case.target), &options)
        .map_err(|error| error.to_string())?;
    let found = path
        .equilibria
        .into_iter()
        .min_by(|a, b| a.factor.total_cmp(&b.factor))
        .ok_or_else(|| format!("the amplitude is not met: {}", path.ending.key()))?;
    let force_n = found.factor * UNIT_N;

    let groups = vec![0; case.model.joints.len()];
    let statics = Statics::from_stiffness(
        &case.model,
        case.stiffness_nmm_per_rad.clone(),
        &groups,
        Support::Free,
    );
    // Where the force ends up, its line is a line in space like any other.
    let place_mm = match case.application {
        Application::Fixed => case.point_mm,
        Application::AtT2 => found.deformed.midpoints_mm[case.model.joints.len()],
    };
    let mut solution = Solution::default();
    let wrench = Wrench::at(place_mm, case.direction * force_n);
    statics.march(&wrench, &[], &[], &mut solution);
    let pairs = solution.deformed.midpoints_mm.iter().zip(&found.deformed.midpoints_mm);
    let difference_mm = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    if difference_mm > AGREE_MM {
        return Err(format!("march and Newton differ by {difference_mm:.1e} mm"));
    }
    let own = case
        .frontal_load()
        .map(|load| match_amplitude(&statics, &load, ForceSign::Positive, case.target))
        .filter(|own| own.status == PathEnding::Converged);
    let march_force_n = own.map(|own| own.force_n);
    if march_force_n.is_some_and(|own| (own - force_n).abs() > 1e-6 * force_n) {
        return Err(format!("the march finds {march_force_n:?} N, and Newton {force_n} N"));
    }
    Ok(Solved { case, force_n, deformed: found.deformed, difference_mm, march_force_n })
}
