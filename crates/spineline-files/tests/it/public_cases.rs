//! Checks of films and landmarks on the public spine lines of patients in three postures: they find nothing there.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use spineline::analysis::{AnalysisOptions, Case, analyze_movement};
use spineline_files::parse_case;

/// Errors and warnings of films that contradict themselves or one another.
const CHECKS: [&str; 15] = [
    "axes_exchanged",
    "bend_keeps_shape",
    "bend_leans_away",
    "bend_leans_little",
    "bends_exchanged",
    "corners",
    "erect_leans",
    "film_looks_mirrored",
    "film_mirrored",
    "film_repeated",
    "films_show_one_shape",
    "levels_may_be_shifted",
    "out_of_order",
    "spacing_unusual",
    "tilt_too_large",
];

/// The public cases, in the order of their names.
pub fn cases() -> Option<Vec<Case>> {
    let data = std::env::var_os("SPINELINE_DATA").map(PathBuf::from);
    let Some(folder) = data.and_then(|data| fs::read_dir(data.join("pcdare/cases")).ok()) else {
        println!("skipped: SPINELINE_DATA is not set, or holds no folder `pcdare/cases`");
        return None;
    };
    let mut paths: Vec<PathBuf> = folder.map(|entry| entry.expect("a file").path()).collect();
    paths.sort();
    let read = |path: &PathBuf| fs::read_to_string(path).expect("a case");
    Some(paths.iter().map(|path| parse_case(&read(path)).expect("a case")).collect())
}

#[test]
fn films_of_real_patients_raise_no_alarm_but_about_lengths() {
    let Some(cases) = cases() else { return };
    let mut counts = BTreeMap::<String, usize>::new();
    for case in &cases {
        match analyze_movement(case, &AnalysisOptions::default()) {
            Err(error) => *counts.entry(error.code().to_owned()).or_default() += 1,
            Ok(analysis) => {
                for warning in analysis.warnings.all() {
                    *counts.entry(warning.code.key().to_owned()).or_default() += 1;
                }
            }
        }
    }
    println!("{} cases of three films: {counts:?}", cases.len());
    let alarms: usize = CHECKS.iter().filter_map(|code| counts.get(*code)).sum();
    assert_eq!(alarms, 0, "{counts:?}");
    // These are lines on the skin of the back, which a bend stretches.
    let longer = counts.get("lengths_differ").copied().unwrap_or_default();
    let bends = 2 * cases.len();
    assert!(longer * 10 <= bends * 3, "{longer} of {bends} bends");
}
