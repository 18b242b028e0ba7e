//! One analysis as text.

use std::fmt::Write;

use spineline::analysis::{Analysis, LineModel, probability};
use spineline::personalize::{FitStatus, LineTest, StiffnessBound};

use super::lines;
use super::table::{Table, wrap};

const WIDTH: usize = 110;

/// The whole report of one patient.
pub fn text(analysis: &Analysis) -> String {
    let mut text = String::new();
    let synthetic = if analysis.synthetic { " · SYNTHETIC" } else { "" };
    let unit = analysis.erect().outline.scale;
    let films = analysis.postures.len();
    let _ = writeln!(text, "{}{synthetic} · films: {films} · lengths in {unit}", analysis.case_id);
    let compared = analysis.compare_lines();
    for sentence in analysis.verdict(&compared) {
        text.push_str(&wrap(&sentence, WIDTH, "  "));
    }
    text.push('\n');
    text.push_str(&curve_text(analysis));
    text.push_str(&clinical_text(analysis));
    text.push_str(&motion_text(analysis));
    text.push_str(&best_fit_lines_text(analysis));
    if !analysis.models.is_empty() {
        text.push_str(&models_text(analysis));
        text.push('\n');
        text.push_str(&lines::patient_text(&compared));
    }
    text
}

/// The warnings of an analysis, for the error stream.
pub fn warnings(analysis: &Analysis) -> String {
    let mut text = String::new();
    for warning in analysis.warnings.all() {
        let place: Vec<String> = [
            Some(analysis.case_id.clone()),
            warning.posture.map(|posture| format!("{posture} film")),
            warning.level.map(|level| level.to_string()),
        ]
        .into_iter()
        .flatten()
        .collect();
        let (place, said) = (place.join(", "), warning.text());
        let _ = writeln!(text, "warning: {place}: {said} [{}]", warning.code);
    }
    text
}

fn curve_text(analysis: &Analysis) -> String {
    let mut text = String::new();
    let scale = analysis.scale();
    text.push_str(&analysis.inflection_words());
    text.push('\n');
    let chain = &analysis.chain;
    let segment = scale.mm(chain.segment_mm).map_or_else(
        || format!("{:.3} px", scale.px(chain.segment_mm).unwrap_or_default()),
        |_| scale.text(chain.segment_mm, 4),
    );
    let _ = writeln!(text, "Chain of {} segments of {segment}\n", chain.segments);
    text
}

fn clinical_text(analysis: &Analysis) -> String {
    let postures: Vec<String> =
        analysis.postures.iter().map(|p| p.outline.posture.to_string()).collect();
    let heading = ["Cobb angle", "convex", "ends", "apex"].into_iter();
    let heading = heading.chain(postures.iter().map(String::as_str)).chain(["flexibility"]);
    let mut table = Table::new(heading);
    for curve in &analysis.clinical {
        let sign = curve.cobb[0].1.rad().signum();
        let mut row = vec![
            curve.region.to_string(),
            curve.convex.map_or_else(|| "-".to_owned(), |side| side.to_string()),
            format!("{}-{}", curve.ends.superior, curve.ends.inferior),
            curve.apex.to_string(),
        ];
        // In the direction of the erect curve: a negative angle is convex to the other side.
        row.extend(curve.cobb.iter().map(|(_, angle)| format!("{:.1}°", angle.deg() * sign)));
        row.push(
            curve.flexibility.map_or_else(|| "-".to_owned(), |f| format!("{:.0} %", 100.0 * f)),
        );
        table.row(row);
    }
    format!("{}{}\n\n", table.text(), analysis.lenke_words())
}

fn motion_text(analysis: &Analysis) -> String {
    let mut table = Table::new([
        "Posture",
        "L4-T2 lateral tilt",
        "curve order",
        "fit",
        "fit (°)",
        "mean rotation (°)",
        "inflection to least rotating (segments)",
    ]);
    for p in &analysis.postures {
        let distances = p
            .inflection_estimates
            .map(|pair| format!("{}, {}", pair[0].distance_segments, pair[1].distance_segments));
        table.row(vec![
            p.outline.posture.to_string(),
            p.outline.amplitude().leaning(),
            p.fit.order.to_string(),
            p.outline.scale.residual_text(p.fit.rmse_mm),
            format!("{:.2}", p.fit.rmse_tilt.deg()),
            p.mean_rotation().map_or_else(String::new, |r| format!("{:.4}", r.deg())),
            distances.unwrap_or_default(),
        ]);
    }
    format!("{}\n", table.text())
}

/// The line of best fit to the rotations of each film, and tests of the proposed lines.
fn best_fit_lines_text(analysis: &Analysis) -> String {
    let mut table = Table::new([
        "Line of best fit to the rotations",
        "lateral tilt",
        "at the caudal inflection (mm left, - right)",
        "at the cranial one",
        "p: through both",
        "p: parallel to iliac",
    ]);
    let p_value = |test: Option<LineTest>| {
        test.map_or_else(|| "-".to_owned(), |test| probability(test.p_value).replace("= ", ""))
    };
    let own = analysis.postures.iter().filter_map(|p| Some((p, p.preferred_line.as_ref()?)));
    for (posture, own) in own.clone() {
        let [caudal, cranial] = &own.crossings;
        table.row(vec![
            posture.outline.posture.to_string(),
            own.line.lean().leaning(),
            caudal.to_string(),
            cranial.to_string(),
            p_value(own.inflection.map(|found| found.test)),
            p_value(own.iliac),
        ]);
    }
    let Some((_, any)) = own.clone().next() else { return String::new() };
    let mut text = table.text();
    let said = format!(
        "In brackets: 95 % confidence interval of this crossing alone. p below 0.05 rejects the line. Joints of a region differ in stiffness by {:.0} % on these films.",
        100.0 * any.joint_log_sd
    );
    text.push_str(&wrap(&said, WIDTH, "  "));
    text.push('\n');
    text
}

fn models_text(analysis: &Analysis) -> String {
    let mut table = Table::new([
        "Line of action",
        "posture",
        "film",
        "location error (mm)",
        "Ferguson errors (°)",
        force_heading(analysis),
        "counter-rotating joints",
    ]);
    for model in &analysis.models {
        for s in &model.postures {
            let usable = s.is_usable();
            let angles: Vec<String> =
                s.ferguson_difference.iter().map(|a| format!("{:.1}", a.abs().deg())).collect();
            let or_status = |value: String| if usable { value } else { s.status.key().to_owned() };
            table.row(vec![
                model.kind.to_string(),
                s.posture.to_string(),
                if s.fitted { "fitted" } else { "held out" }.to_owned(),
                or_status(format!("{:.2}", s.mean_location_error_mm())),
                if usable { angles.join(" / ") } else { "-".to_owned() },
                or_status(format!("{:.0}", s.force_n)),
                format!("{} of {}", s.contradicted.len(), s.location_errors_mm.len()),
            ]);
        }
    }
    let mut text = format!("{}\n", table.text());
    let _ = writeln!(text, "Lateral stiffness relative to the table ({})", analysis.gauge_words());
    for model in &analysis.models {
        let _ = writeln!(text, "  {:15} {}", model.kind, multipliers_text(model));
    }
    text
}

fn force_heading(analysis: &Analysis) -> &'static str {
    let gauge = analysis.options.gauge;
    let absolute = analysis.models.iter().all(|model| model.is_absolute(gauge));
    if absolute { "force (N)" } else { "force (relative)" }
}

fn multipliers_text(model: &LineModel) -> String {
    let parts: Vec<String> = model
        .groups
        .names()
        .iter()
        .zip(model.multipliers())
        .zip(&model.fit.bounds)
        .map(|((name, value), bound)| {
            let note = match bound {
                StiffnessBound::Inside => "",
                _ => " (at its limit: not identified)",
            };
            format!("{} {:.2}{note}", name.replace('_', " "), value * model.fit.absolute_scale)
        })
        .collect();
    let status = match model.fit.status {
        FitStatus::Converged => String::new(),
        other => format!("  NOT CONVERGED ({})", other.key()),
    };
    format!("{}{status}", parts.join("  "))
}
