//! Loads and bases other than the lines of action, fitted and left out, over one patient or several.

use spineline::analysis::{Analysis, FilmRole};
use spineline::cohort::{BaselinesOverPatients, ComparisonOutcome};
use spineline::evaluate::Baseline;
use spineline::hypothesis::{Hypothesis, HypothesisComparison, HypothesisScores, Role, compare};
use spineline::number::{fixed, signed};

use crate::document::{Section, Table};
use crate::phrases::{difference_words, none};

const LEGEND: &str = "Mean location errors (mm) and rotation errors of the joints (°, root mean square). Fitted: both bends. Left out: a bend, by the stiffness of the other bend and the smallest load that brings the top near; with prior: by the most probable load for the location of the top and the distribution of joint rotations; with tilt: for its tilt too; load fitted: by the load of the whole shape. Held out: neutral and traction films. Counter-rotating: joints per bend that turn against the load. AICc, BIC: less the first row. Best: patients without a smaller left-out error / AICc by another load. No result: films and fits.";

/// The hypotheses of one patient or several, each with whether the patient is synthetic; `None` if none was requested.
///
/// `baselines` are the predictions without mechanics of these patients.
pub fn section<'a>(
    patients: impl Iterator<Item = (bool, &'a [HypothesisScores])>,
    baselines: &BaselinesOverPatients,
) -> Option<Section> {
    let (synthetic, fits): (Vec<bool>, Vec<&[HypothesisScores]>) = patients.unzip();
    let blocks = compare(&fits);
    if blocks.is_empty() {
        return None;
    }
    let synthetic = if synthetic.contains(&true) { " (synthetic)" } else { "" };
    let mut section = Section::new("hypotheses", format!("Loads and bases compared{synthetic}"));
    for block in &blocks {
        let who = match fits.len() {
            1 => String::new(),
            all => format!(", {} of {all} patients, who have all of these", block.patients),
        };
        section.table(table(block, format!("Errors by load and base{who}")));
    }
    section.paragraph(LEGEND);
    let roles = FilmRole::PREDICTED;
    for table in roles.into_iter().filter_map(|role| against_baselines(baselines, role)) {
        section.table(table);
    }
    Some(section)
}

/// The same of one patient.
pub fn of_patient(analysis: &Analysis) -> Option<Section> {
    if analysis.hypotheses.is_empty() {
        return None;
    }
    let baselines = BaselinesOverPatients::of_patient(analysis);
    let scores = HypothesisScores::all(&analysis.hypotheses);
    section(std::iter::once((analysis.synthetic, &scores[..])), &baselines)
}

/// Error of every hypothesis minus error of every prediction without mechanics; `None` where nothing is compared.
fn against_baselines(baselines: &BaselinesOverPatients, role: FilmRole) -> Option<Table> {
    let tests = || baselines.hypothesis_tests.iter().filter(move |test| test.role == role);
    let known = |baseline: &Baseline| tests().any(|test| test.baseline == *baseline);
    let against: Vec<Baseline> = Baseline::ALL.into_iter().filter(known).collect();
    let mut hypotheses: Vec<Hypothesis> = tests().map(|test| test.model).collect();
    hypotheses.dedup();
    let best = baselines.best(role, false)?;
    let has_intervals = tests().any(|test| test.comparison.bootstrap.is_some());
    let interval = if has_intervals { ", 95 %" } else { "" };
    let caption =
        format!("Loads and bases less predictions without mechanics, {role} (mm{interval})");
    let mut table = Table::of(caption, &hypotheses, |add| {
        add.words("Load and base", |hypothesis| hypothesis.to_string());
        for baseline in against {
            add.words(baseline.long_name(), |hypothesis| {
                let found = tests().find(|t| t.model == **hypothesis && t.baseline == baseline);
                found.map_or_else(none, |test| {
                    let mark = match test.outcome() {
                        ComparisonOutcome::Better => ", better",
                        ComparisonOutcome::Worse => ", worse",
                        ComparisonOutcome::NoDifference | ComparisonOutcome::NotTested => "",
                    };
                    difference_words(&test.comparison) + mark
                })
            });
        }
    });
    table.note = format!(
        "Location error, load minus prediction, on the films that both predict: below zero, the load is better. Predictions with the tilt of the top are compared with loads that know it too, by the published or the given distribution of rotations. The best prediction without mechanics: {}, {} mm.",
        best.by,
        fixed(best.mean_mm(), 1)
    );
    if tests().any(|test| test.outcome() != ComparisonOutcome::NotTested) {
        table.note +=
            " Better: significantly, after Holm's correction over these tests; worse: likewise.";
    }
    (!hypotheses.is_empty()).then_some(table)
}

fn table(block: &HypothesisComparison, caption: String) -> Table {
    let number = |value: Option<f64>| value.map_or_else(none, |value| fixed(value, 1));
    let of = |values: &[Option<f64>], role: Role| {
        let place = Role::ALL.iter().position(|one| *one == role).expect("it is one of all");
        number(values[place])
    };
    Table::of(caption, &block.hypotheses, |add| {
        add.words("Load and base", |one| one.hypothesis.to_string());
        add.numbers("Free", |one| one.free.to_string());
        add.numbers("Fitted (mm)", |one| of(&one.location_mm, Role::Fitted));
        add.numbers("Left out (mm)", |one| of(&one.location_mm, Role::LeftOut));
        add.numbers("With prior (mm)", |one| of(&one.location_mm, Role::LeftOutWithPrior));
        add.numbers("With tilt (mm)", |one| of(&one.location_mm, Role::LeftOutWithTilt));
        add.numbers("Load fitted (mm)", |one| of(&one.location_mm, Role::LeftOutLoadFitted));
        add.numbers("Held out (mm)", |one| of(&one.location_mm, Role::HeldOut));
        add.numbers("Fitted (°)", |one| of(&one.rotation_deg, Role::Fitted));
        add.numbers("Left out (°)", |one| of(&one.rotation_deg, Role::LeftOut));
        add.numbers("Counter-rotating", |one| number(one.against));
        add.numbers("AICc", |one| signed(one.aicc_difference, 0));
        add.numbers("BIC", |one| signed(one.bic_difference, 0));
        add.numbers("Best", |one| format!("{} / {}", one.best_left_out, one.best_aicc));
        add.numbers("No result", |one| one.lost.to_string());
    })
}
