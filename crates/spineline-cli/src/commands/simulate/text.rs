//! One simulation as text.

use std::fmt::Write;

use spineline::clinical::convex_side;
use spineline::multibody::{Equilibrium, ForceSign, Goal, PathEnding, Support};
use spineline::response::{
    ActingKind, GoalEquilibrium, SpineAngles, Verdict, acting_loads, erect_shape,
    largest_displacement_mm, largest_hinge, measure_angles,
};
use spineline::spatial::{Angle, moment_words, vector_words};
use spineline_files::SimulationWarning;
use spineline_report::document::{Column, Notice, NoticeKind, Table};
use spineline_report::terminal;

use super::outcome::Outcome;
use super::words::{load_words, timing_words};

/// The whole report of one simulation.
pub fn report(outcome: &Outcome) -> String {
    let mut text = head(outcome);
    text.push_str(&ending_text(outcome));
    text.push('\n');
    if let Some(result) = outcome.response.result() {
        text.push_str(&result_text(outcome, result));
        text.push_str(&angles_text(outcome, result));
    }
    text.push_str(&solutions_text(outcome));
    text.push_str(&events_text(outcome));
    text.extend(notices(outcome).iter().map(|one| terminal::notice(one, terminal::WIDTH)));
    text
}

/// The warnings.
pub fn notices(outcome: &Outcome) -> Vec<Notice> {
    let notice = |warning: &SimulationWarning| Notice {
        code: warning.code.to_owned(),
        ..Notice::new(NoticeKind::Warning, warning.message.clone())
    };
    outcome.warnings.iter().map(notice).collect()
}

fn head(outcome: &Outcome) -> String {
    let model = &outcome.model;
    let synthetic = if model.synthetic { " · SYNTHETIC" } else { "" };
    let support = match model.support {
        Support::Free => "free",
        Support::Frontal => "frontal",
    };
    let mut text = format!(
        "{}{synthetic} · model with the {} · {support} support · forces in {}\n",
        model.case_id,
        model.line.replace('_', " "),
        model.force_unit()
    );
    for (number, load) in outcome.loads.loads.iter().enumerate() {
        let _ = writeln!(text, "  load {}: {}", number + 1, load_words(load));
    }
    let _ = match outcome.response.goal {
        Goal::FullLoad => writeln!(text, "  target: the shape under these loads"),
        Goal::LateralTilt(tilt) => writeln!(
            text,
            "  target: the factor of the proportional loads for a lateral tilt of {} of {}, up to {:.4} in either direction",
            ends(outcome),
            tilt.leaning(),
            outcome.response.largest_factor
        ),
    };
    text
}

/// The status first, then what it means and what to do.
fn ending_text(outcome: &Outcome) -> String {
    let ending = outcome.response.ending;
    let meaning = match ending {
        PathEnding::Converged if !outcome.response.is_complete() => {
            "a shape that meets the target, reached from the erect spine; the path was lost beyond it, where there may be more".to_owned()
        }
        PathEnding::Converged => {
            "the only shape that meets the target within the limits, reached from the erect spine".to_owned()
        }
        PathEnding::SeveralEquilibria => {
            "several shapes meet the target; the first one that the erect spine reaches is the result".to_owned()
        }
        PathEnding::Interrupted => {
            "NO RESULT: interrupted; the files hold the path so far".to_owned()
        }
        other => format!("NO RESULT: {}", other.meaning()),
    };
    let name = ending.key().replace('_', " ");
    let status = format!("{} · {meaning}", name.to_uppercase());
    let mut text = terminal::paragraph(&status, terminal::WIDTH, "");
    if let (None, Some(point)) = (outcome.response.result(), outcome.response.nearest()) {
        let _ = writeln!(
            text,
            "  nearest shape on the path: factor {:.4} of the {} loads, lateral tilt {}, largest joint rotation {:.1}°",
            point.factor,
            timing_words(point.timing),
            point.deformed.lateral_tilt().leaning(),
            largest_hinge(&point.deformed).2.abs().deg()
        );
    }
    text
}

fn result_text(outcome: &Outcome, result: &Equilibrium) -> String {
    let mut text = String::new();
    let levels = &outcome.model.levels;
    let shape = &result.deformed;
    let (vertebra, moved_mm) = largest_displacement_mm(&outcome.model.spine, shape);
    let (joint, axis, turn) = largest_hinge(shape);
    let axis = ["lateral", "flexion", "axial"][axis];
    let _ = writeln!(text, "factor of proportional loads {:.6}", result.factor);
    let _ =
        writeln!(text, "largest displacement         {moved_mm:.1} mm, at {}", levels[vertebra]);
    let _ = writeln!(
        text,
        "largest joint rotation       {:.1}° ({axis}, {}/{})",
        turn.abs().deg(),
        levels[joint],
        levels[joint + 1]
    );
    let _ = writeln!(
        text,
        "residual                     {:.0e} rad; smallest singular value {:.3} (1 unloaded, 0 at a limit or branch point)",
        result.residual_rad, result.smallest_singular_value
    );
    text.push_str(&forces_text(outcome, result));
    text.push('\n');
    text
}

/// The force or moment of each load in the final shape; slices of gravity are left out.
fn forces_text(outcome: &Outcome, result: &Equilibrium) -> String {
    let (model, placed) = (&outcome.model, &outcome.placed);
    let mut text = String::new();
    let acting =
        acting_loads(&placed.loading, &result.deformed, result.factor, &result.spring_forces_n);
    for load in acting {
        let number = placed.load_of_item[load.item];
        if placed.load_of_item.iter().filter(|other| **other == number).count() > 1 {
            continue;
        }
        let level = model.levels[load.vertebra];
        let words = match load.kind {
            ActingKind::Force(force) => vector_words(force.into()),
            ActingKind::Moment(moment) => format!("{} (force × mm)", moment_words(moment.into())),
        };
        let _ = writeln!(
            text,
            "load {:<3} acts on {level:<4}        {words} · {}",
            number + 1,
            model.force_unit()
        );
    }
    for ((force, moment), (number, rod)) in
        result.rod_reactions.iter().zip(placed.load_of_rod.iter().zip(&placed.loading.rods))
    {
        let level = model.levels[rod.superior];
        let _ = writeln!(
            text,
            "load {:<3} rod holds {level:<4}      {}; moment (force × mm) {} · {}",
            number + 1,
            vector_words((*force).into()),
            moment_words((*moment).into()),
            model.force_unit()
        );
    }
    text
}

fn angles_text(outcome: &Outcome, result: &Equilibrium) -> String {
    let before = measure_angles(&erect_shape(&outcome.model.spine), &outcome.places);
    let after = measure_angles(&result.deformed, &outcome.places);
    let columns = vec![
        Column::words("Angle"),
        Column::numbers("Erect"),
        Column::numbers("Under load"),
        Column::numbers("Change"),
    ];
    let mut table = Table::new("", columns);
    let has_cobb = before.curves.iter().all(|curve| curve.ends.cobb.is_some());
    for (name, pick) in [(if has_cobb { "Cobb" } else { "Tilt range" }, 0), ("Ferguson", 1)] {
        for (now, then) in after.curves.iter().zip(&before.curves) {
            let of = |curve: &spineline::response::CurveAngles| {
                [curve.ends.size(), curve.ferguson][pick]
            };
            table.row(vec![
                format!("{name}, {}", now.region),
                convex_words(of(then)),
                convex_words(of(now)),
                change_words(of(then), of(now)),
            ]);
        }
    }
    let SpineAngles { lateral_tilt: tilt, .. } = after;
    table.row(vec![
        format!("lateral tilt of {}", ends(outcome)),
        before.lateral_tilt.leaning(),
        tilt.leaning(),
        (tilt - before.lateral_tilt).wrapped().leaning(),
    ]);
    format!("{}\n", terminal::table(&table, terminal::WIDTH))
}

/// The base and the top of the model, such as `L4-T2`.
fn ends(outcome: &Outcome) -> String {
    let base = outcome.model.levels.first().map_or("?", |level| level.name());
    format!("{base}-{}", outcome.model.top())
}

fn convex_words(angle: Angle) -> String {
    let side = convex_side(angle).map_or_else(String::new, |side| format!(" convex {side}"));
    format!("{}{side}", angle.abs())
}

fn change_words(before: Angle, after: Angle) -> String {
    if before.side() != after.side() {
        return "reversed".to_owned();
    }
    let more = after.abs() - before.abs();
    let word = if more.rad() < 0.0 { "less" } else { "more" };
    format!("{} {word}", more.abs())
}

/// Every shape that meets the target, where there is a choice or no result.
fn solutions_text(outcome: &Outcome) -> String {
    let response = &outcome.response;
    let is_plain = response.goal == Goal::FullLoad && response.ending == PathEnding::Converged;
    if response.equilibria.is_empty() || is_plain {
        return String::new();
    }
    let columns = vec![
        Column::words("Shapes that meet the target"),
        Column::numbers("Factor"),
        Column::numbers("Limit points"),
        Column::numbers("Branch points"),
        Column::numbers("Largest joint rotation"),
        Column::numbers(format!("Lateral tilt of {}", ends(outcome))),
        Column::words("Verdict"),
    ];
    let mut table = Table::new("", columns);
    for met in &response.equilibria {
        let equilibrium = &met.equilibrium;
        let way = match met.sign {
            ForceSign::Positive => "loads along their direction",
            ForceSign::Negative => "loads against their direction",
        };
        table.row(vec![
            way.to_owned(),
            format!("{:.6}", equilibrium.factor),
            equilibrium.limit_points.to_string(),
            equilibrium.branch_points.to_string(),
            format!("{:.1}°", largest_hinge(&equilibrium.deformed).2.abs().deg()),
            equilibrium.deformed.lateral_tilt().leaning(),
            verdict_words(met).to_owned(),
        ]);
    }
    // One line per shape, whatever its length.
    format!("{}\n", terminal::table(&table, usize::MAX))
}

fn verdict_words(met: &GoalEquilibrium) -> &'static str {
    match met.verdict {
        Verdict::Reached => "chosen: smallest factor on the erect branch",
        Verdict::Later => "not chosen: larger factor, or later on the path",
        Verdict::BeyondLimitPoint => "not chosen: beyond a limit point (snapped)",
        Verdict::BeyondHumanRange => "not chosen: beyond the human range of motion",
        Verdict::BeyondBranchPoint => "not chosen: beyond a branch point (buckled)",
    }
}

fn events_text(outcome: &Outcome) -> String {
    let mut text = String::new();
    for signed in &outcome.response.paths {
        let way = match signed.sign {
            ForceSign::Positive => "",
            ForceSign::Negative => " (loads against their direction)",
        };
        for event in &signed.path.events {
            let _ = writeln!(
                text,
                "{} at a factor of {:.4} of the {} loads{way}",
                event.kind.key().replace('_', " "),
                event.factor,
                timing_words(event.timing)
            );
        }
    }
    text
}
