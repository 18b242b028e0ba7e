//! The comment at the top of every file: content, provenance, meaning of numbers.

use spineline::action::Application;
use spineline::analysis::PersonalisedModel;
use spineline::multibody::Support;
use spineline::spatial::Vec3;

use super::assembly::Assembly;
use super::films::Film;
use super::standing::sources;
use super::xml::vector;
use crate::content::{ContentHash, ContentMark};
use crate::to_line;

/// Differences between the formats.
pub(super) struct Dialect {
    /// Name of the format.
    pub(super) format: &'static str,
    /// Its frame.
    pub(super) frame: &'static str,
    /// Where springs and hinges are, and the limits of the format.
    pub(super) notes: &'static str,
    /// Where the poses and loads of the films are.
    pub(super) films: &'static str,
    /// The nominal inertia and damping.
    pub(super) nominal: fn() -> String,
    /// From `G` to its frame.
    pub(super) from_global: fn(&Vec3) -> Vec3,
}

/// The comment of a file of vertebral bodies, line by line.
pub(super) fn about_bodies(
    model: &PersonalisedModel,
    generator: &str,
    [format, frame]: [&str; 2],
) -> Vec<String> {
    let mut lines = opening(model, &format!("Vertebral bodies of a spine as {format}"), generator);
    lines.push(format!("Frame: {frame}"));
    lines.push(format!("Bodies: boxes at the midpoints and in the axes of the vertebrae of the personalised model, erect, {}. The origin is the midpoint of the lowest vertebra.", carried(model)));
    lines.push("Angles: lateral tilt about the anterior axis of the patient (positive to the patient's right), then pitch about the left axis (flexion positive), then axial rotation about the cranial axis (positive where the front turns to the patient's left).".to_owned());
    lines.extend(sources(model));
    lines.push("NOMINAL, not measured: the depths and heights of the boxes, which are typical ones, scaled to the distances between vertebrae.".to_owned());
    lines
}

/// Title, maker, warning and case.
fn opening(model: &PersonalisedModel, title: &str, generator: &str) -> Vec<String> {
    let mut lines = vec![
        format!("{title}, written by {generator}."),
        "Research software, not a medical device.".to_owned(),
        format!("Case: {}", model.case_id),
    ];
    if model.synthetic {
        lines.push("SYNTHETIC: made from synthetic films, not of a patient.".to_owned());
    }
    lines
}

/// What the springs carry in the erect shape.
fn carried(model: &PersonalisedModel) -> String {
    match model.carried_body_mass_kg {
        None => "unloaded".to_owned(),
        Some(kg) => format!("in balance with the weight of the trunk of a body of {kg} kg"),
    }
}

/// The case and the place of the hash. XML allows no two hyphens in a row in a comment, so the second one is written as its code.
pub(super) fn mark(model: &PersonalisedModel) -> String {
    let mark = ContentMark { case_ids: [&model.case_id], content_sha256: ContentHash };
    to_line(&mark).replace("--", "-\\u002d")
}

/// The comment's text.
pub(super) fn header(
    model: &PersonalisedModel,
    assembly: &Assembly,
    generator: &str,
    dialect: &Dialect,
) -> String {
    let title = format!("Personalised multibody model of a spine as {}", dialect.format);
    let mut lines = opening(model, &title, generator);
    lines.push(format!("Frame: {}", dialect.frame));
    lines.push(units(model.absolute).to_owned());
    lines.push(format!(
        "Bodies: vertebrae in the erect posture, {}; a body's origin is the vertebra's midpoint. The lowest is fixed.",
        carried(model)
    ));
    lines.extend(sources(model));
    lines.push(
        "Joints: three hinges in series (lateral, flexion, axial) about the inferior vertebra's anterior, left and cranial axes, each with a linear spring that rests at zero."
            .to_owned(),
    );
    lines.push(dialect.notes.to_owned());
    lines.push(support(model.support).to_owned());
    lines.push(format!("Stiffness: fitted with the line of action `{}`.", model.line.key()));
    lines.extend(model.doubts.iter().map(|doubt| format!("DOUBT: {doubt}.")));
    lines.push(format!(
        "NOMINAL, not measured, without influence on an equilibrium: {}; and all shapes but the widths named above. Gravity is off.",
        (dialect.nominal)(),
    ));
    if !assembly.films.is_empty() {
        let (top, unit) = (model.top(), model.force_unit());
        lines.push(format!("Films: {} The forces on {top} ({unit}):", dialect.films));
        lines.extend(assembly.films.iter().map(|film| words(film, dialect)));
    }
    lines.push(mark(model));
    lines.join("\n  ")
}

const fn support(support: Support) -> &'static str {
    match support {
        Support::Free => "Support: free; every hinge turns.",
        Support::Frontal => {
            "Support: frontal; flexion and axial hinges are locked, only the lateral ones turn."
        }
    }
}

const fn units(absolute: bool) -> &'static str {
    if absolute {
        "Units: m, kg, s, rad, N, N m/rad. A measured force makes springs and forces absolute."
    } else {
        "Units: m, kg, s, rad. Springs and forces are RELATIVE: all have one unknown common factor, which the format reads as N m/rad and N."
    }
}

fn words(film: &Film, dialect: &Dialect) -> String {
    let load = &film.load;
    let force_n = (dialect.from_global)(&load.force_vector_n());
    let place = match load.application {
        Application::Fixed => {
            let point_m = (dialect.from_global)(&(Vec3::from(load.point_mm) / 1000.0));
            format!("along the line fixed in space through {} m", rounded(&point_m))
        }
        Application::AtT2 => "at the midpoint, and moves with it".to_owned(),
    };
    let pose = match &film.pose {
        Ok(_) => "converged".to_owned(),
        Err(reason) => format!("no equilibrium, so no pose: {reason}"),
    };
    format!("  {}: {} {place} ({pose})", film.name(), rounded(&force_n))
}

/// A vector for the comment, with at most six decimals, as the file writes numbers: a user can copy it.
fn rounded(v: &Vec3) -> String {
    vector(&v.map(|part| (1e6 * part).round() / 1e6))
}
