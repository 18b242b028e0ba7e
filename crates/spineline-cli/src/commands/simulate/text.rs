//! One simulation as a report for the terminal.

use spineline::clinical::convex_side;
use spineline::multibody::{Equilibrium, ForceSign, Goal, PathEnding, Support};
use spineline::response::{
    ActingKind, CurveAngles, GoalEquilibrium, SpineAngles, Verdict, acting_loads, erect_shape,
    largest_displacement_mm, largest_hinge, measure_angles,
};
use spineline::spatial::{Angle, moment_words, vector_words};
use spineline_files::SimulationWarning;
use spineline_report::document::{Column, Document, Notice, NoticeKind, Section, Table};
use spineline_report::terminal;

use super::outcome::Outcome;
use super::words::{load_words, timing_words};
use crate::run::provenance::generator;

/// The whole report as text.
pub fn report(outcome: &Outcome) -> String {
    let mut sections = vec![target(outcome), ending(outcome)];
    sections.extend(outcome.response.result().map(|result| shape(outcome, result)));
    sections.push(path(outcome));
    sections.retain(|section| !section.blocks.is_empty());
    let document = Document {
        title: "Simulation".to_owned(),
        subject: subject(outcome),
        generator: generator(),
        banners: Vec::new(),
        sections,
        analysis: String::new(),
    };
    terminal::terminal(&document, terminal::WIDTH)
}

/// The warnings.
pub fn notices(outcome: &Outcome) -> Vec<Notice> {
    let notice = |warning: &SimulationWarning| Notice {
        code: warning.code.to_owned(),
        ..Notice::new(NoticeKind::Warning, warning.message.clone())
    };
    outcome.warnings.iter().map(notice).collect()
}

fn subject(outcome: &Outcome) -> String {
    let model = &outcome.model;
    let synthetic = if model.synthetic { " · SYNTHETIC" } else { "" };
    let support = match model.support {
        Support::Free => "free",
        Support::Frontal => "frontal",
    };
    format!(
        "{}{synthetic} · model with the {} · {support} support · forces in {}",
        model.case_id,
        model.line.replace('_', " "),
        model.force_unit()
    )
}

/// The loads, and what is searched for.
fn target(outcome: &Outcome) -> Section {
    let mut section = Section::new("target", "");
    for (number, load) in outcome.loads.loads.iter().enumerate() {
        section.paragraph(format!("Load {}: {}", number + 1, load_words(load)));
    }
    section.paragraph(match outcome.response.goal {
        Goal::FullLoad => "Target: the shape under these loads".to_owned(),
        Goal::LateralTilt(tilt) => format!(
            "Target: the factor of the proportional loads for a lateral tilt of {} of {}, up to {:.4} in either direction",
            ends(outcome),
            tilt.leaning(),
            outcome.response.largest_factor
        ),
    });
    section
}

/// The status first, then what it means and what to do.
fn ending(outcome: &Outcome) -> Section {
    let mut section = Section::new("ending", "");
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
    section.paragraph(format!("{} · {meaning}", name.to_uppercase()));
    if let (None, Some(point)) = (outcome.response.result(), outcome.response.nearest()) {
        section.paragraph(format!(
            "Nearest shape on the path: factor {:.4} of the {} loads, lateral tilt {}, largest joint rotation {:.1}°",
            point.factor,
            timing_words(point.timing),
            point.deformed.lateral_tilt().leaning(),
            largest_hinge(&point.deformed).2.abs().deg()
        ));
    }
    section
}

/// The shape that is the result.
fn shape(outcome: &Outcome, result: &Equilibrium) -> Section {
    let mut section = Section::new("shape", "");
    section.table(numbers(outcome, result));
    section.table(forces(outcome, result));
    section.table(angles(outcome, result));
    section
}

fn numbers(outcome: &Outcome, result: &Equilibrium) -> Table {
    let levels = &outcome.model.levels;
    let (vertebra, moved_mm) = largest_displacement_mm(&outcome.model.spine, &result.deformed);
    let (joint, axis, turn) = largest_hinge(&result.deformed);
    let axis = ["lateral", "flexion", "axial"][axis];
    let mut table = Table::new("", vec![Column::words("Shape under load"), Column::words("Value")]);
    let mut add = |name: &str, value: String| table.row(vec![name.to_owned(), value]);
    add("Factor of proportional loads", format!("{:.6}", result.factor));
    add("Largest displacement", format!("{moved_mm:.1} mm, at {}", levels[vertebra]));
    add(
        "Largest joint rotation",
        format!("{:.1}° ({axis}, {}/{})", turn.abs().deg(), levels[joint], levels[joint + 1]),
    );
    add("Residual", format!("{:.0e} rad", result.residual_rad));
    add(
        "Smallest singular value",
        format!("{:.3} (1 unloaded, 0 at a limit or branch point)", result.smallest_singular_value),
    );
    table
}

/// The force or moment of each load in the final shape; slices of gravity are left out.
fn forces(outcome: &Outcome, result: &Equilibrium) -> Table {
    let (model, placed) = (&outcome.model, &outcome.placed);
    let columns = vec![
        Column::words("Load"),
        Column::words("Acts on"),
        Column::words(format!("Force in {}", model.force_unit())),
        Column::words("Moment (force × mm)"),
    ];
    let mut table = Table::new("", columns);
    let mut add = |load: usize, place: String, force: String, moment: String| {
        table.row(vec![(load + 1).to_string(), place, force, moment]);
    };
    let acting =
        acting_loads(&placed.loading, &result.deformed, result.factor, &result.spring_forces_n);
    for load in acting {
        let number = placed.load_of_item[load.item];
        if placed.load_of_item.iter().filter(|other| **other == number).count() > 1 {
            continue;
        }
        let (force, moment) = match load.kind {
            ActingKind::Force(force) => (vector_words(force.into()), String::new()),
            ActingKind::Moment(moment) => (String::new(), moment_words(moment.into())),
        };
        add(number, model.levels[load.vertebra].to_string(), force, moment);
    }
    for ((force, moment), (number, rod)) in
        result.rod_reactions.iter().zip(placed.load_of_rod.iter().zip(&placed.loading.rods))
    {
        let place = format!("{}, held by the rod", model.levels[rod.superior]);
        add(*number, place, vector_words((*force).into()), moment_words((*moment).into()));
    }
    table
}

fn angles(outcome: &Outcome, result: &Equilibrium) -> Table {
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
            let of = |curve: &CurveAngles| [curve.ends.size(), curve.ferguson][pick];
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
        format!("Lateral tilt of {}", ends(outcome)),
        before.lateral_tilt.leaning(),
        tilt.leaning(),
        (tilt - before.lateral_tilt).wrapped().leaning(),
    ]);
    table
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

/// The shapes that meet the target and the events on the way, then the warnings.
fn path(outcome: &Outcome) -> Section {
    let mut section = Section::new("path", "");
    section.table(solutions(outcome));
    for signed in &outcome.response.paths {
        let way = match signed.sign {
            ForceSign::Positive => "",
            ForceSign::Negative => " (loads against their direction)",
        };
        for event in &signed.path.events {
            let name = event.kind.key().replace('_', " ");
            let (factor, timing) = (event.factor, timing_words(event.timing));
            section.paragraph(format!(
                "Event: {name} at a factor of {factor:.4} of the {timing} loads{way}"
            ));
        }
    }
    notices(outcome).into_iter().for_each(|notice| section.notice(notice));
    section
}

/// Every shape that meets the target, where there is a choice or no result.
fn solutions(outcome: &Outcome) -> Table {
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
    let response = &outcome.response;
    if response.goal == Goal::FullLoad && response.ending == PathEnding::Converged {
        return table;
    }
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
    table
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
