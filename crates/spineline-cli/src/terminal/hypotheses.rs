//! Comparison of other loads and base supports with the lines, as text.

use std::fmt::Write;

use spineline::analysis::Analysis;
use spineline::hypothesis::{
    HypothesisComparison, HypothesisFit, HypothesisSummary, Role, compare,
};

use super::table::{Table, wrap};

const WIDTH: usize = 110;
const LEGEND: &str = "E_LOC in mm, one mean per patient. Fitted: stiffness and loads to both bends. Left out: a bend predicted with the stiffness of the other one and the smallest load that brings T2 near. Load fitted: the same with the load fitted to the whole shape. Held out: neutral and traction, as left out. Rotations: root mean square error of joint rotations in degrees; the rotation of a base counts at the lowest joint. Counter-rotating: joints per bend that rotate against the load. AICc and BIC: differences from the first row. Best: patients in whom none is better, on left-out bends and by AICc. Lost: films without a prediction and fits that did not converge.";

/// The hypotheses that were asked for, over one patient or several; empty where there are none.
pub fn text(analyses: &[Analysis]) -> String {
    let patients: Vec<&[HypothesisFit]> = analyses.iter().map(|a| &a.hypotheses[..]).collect();
    let blocks = compare(&patients);
    if blocks.is_empty() {
        return String::new();
    }
    let synthetic = if analyses.iter().any(|a| a.synthetic) { " (synthetic)" } else { "" };
    let mut text = format!("Loads and bases compared{synthetic}\n");
    for block in &blocks {
        if analyses.len() > 1 {
            let _ = writeln!(
                text,
                "\n{} of {} patients, who have all of these",
                block.patients,
                analyses.len()
            );
        }
        text.push_str(&table(block));
    }
    text.push_str(&wrap(LEGEND, WIDTH, ""));
    text
}

fn table(block: &HypothesisComparison) -> String {
    let mut table = Table::new([
        "Load and base",
        "free",
        "fitted",
        "left out",
        "load fitted",
        "held out",
        "rotations fitted",
        "rotations left out",
        "counter-rotating",
        "AICc",
        "BIC",
        "best",
        "lost",
    ]);
    for summary in &block.hypotheses {
        table.row(row(summary));
    }
    table.text()
}

fn row(summary: &HypothesisSummary) -> Vec<String> {
    let number = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let of = |values: &[Option<f64>; 4], role: Role| {
        values[Role::ALL.iter().position(|one| *one == role).expect("it is one of all")]
    };
    let mm = |role| number(of(&summary.location_mm, role), 1);
    let deg = |role| number(of(&summary.rotation_deg, role), 1);
    vec![
        summary.hypothesis.to_string(),
        summary.free.to_string(),
        mm(Role::Fitted),
        mm(Role::LeftOut),
        mm(Role::LeftOutLoadFitted),
        mm(Role::HeldOut),
        deg(Role::Fitted),
        deg(Role::LeftOut),
        number(summary.against, 1),
        format!("{:+.0}", summary.aicc_difference),
        format!("{:+.0}", summary.bic_difference),
        format!("{}, {}", summary.best_left_out, summary.best_aicc),
        summary.lost.to_string(),
    ]
}
