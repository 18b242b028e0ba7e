//! Checks of films and landmarks on the public spine lines of patients in three postures: they find nothing there.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use spineline::analysis::{AnalysisOptions, analyze_movement};
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

#[test]
fn films_of_real_patients_raise_no_alarm_but_about_lengths() {
    let Some(data) = std::env::var_os("SPINELINE_DATA") else {
        println!("skipped: SPINELINE_DATA is not set");
        return;
    };
    let folder = PathBuf::from(data).join("pcdare/cases");
    if !folder.is_dir() {
        println!("skipped: SPINELINE_DATA holds no folder `pcdare/cases`");
        return;
    }
    let (mut cases, mut counts) = (0, BTreeMap::<String, usize>::new());
    for entry in fs::read_dir(folder).expect("cases") {
        let path = entry.expect("a file").path();
        let text = fs::read_to_string(&path).expect("a case");
        let case = parse_case(&text).expect("a case");
        cases += 1;
        match analyze_movement(&case, &AnalysisOptions::default()) {
            Err(error) => *counts.entry(error.code().to_owned()).or_default() += 1,
            Ok(analysis) => {
                for warning in analysis.warnings.all() {
                    *counts.entry(warning.code.key().to_owned()).or_default() += 1;
                }
            }
        }
    }
    println!("{cases} cases of three films: {counts:?}");
    let alarms: usize = CHECKS.iter().filter_map(|code| counts.get(*code)).sum();
    assert_eq!(alarms, 0, "{counts:?}");
    // These are lines on the skin of the back, which a bend stretches.
    let longer = counts.get("lengths_differ").copied().unwrap_or_default();
    assert!(longer * 10 <= 2 * cases * 3, "{longer} of {} bends", 2 * cases);
}
