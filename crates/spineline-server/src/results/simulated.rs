//! Simulated films of one model.

use spineline::action::Application;
use spineline::analysis::{Analysis, LineModel};
use spineline::anatomy::Level;
use spineline::evaluate::{FilmShape, Simulation};
use spineline::multibody::{Deformed, PathEnding, Residual, SpineModel};
use spineline::number::fixed;
use spineline::personalize::evidence::ContradictedJoint;
use spineline::spatial::{Mat3, Vec3};

use crate::api::{LevelError, Shape, SimulatedPosture, Wire};

/// Number of equal steps of the load factor from 0 to 1 whose shapes are sent.
const PARTS: [f64; 11] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

/// A spine with the given poses of its vertebrae.
pub fn shape(spine: &SpineModel, midpoints_mm: &[Vec3], axes: &[Mat3]) -> Shape {
    let points = |points: &[Vec3]| points.iter().map(|&point| point.into()).collect();
    Shape {
        midpoints_mm: points(midpoints_mm),
        // Stored by columns, sent by rows.
        rotations: axes.iter().map(|axes| std::array::from_fn(|i| axes[(i / 3, i % 3)])).collect(),
        joints_mm: points(&spine.joint_centres_mm(midpoints_mm, axes)),
    }
}

pub fn deformed_shape(spine: &SpineModel, deformed: &Deformed) -> Shape {
    shape(spine, &deformed.midpoints_mm, &deformed.axes)
}

/// One simulated film.
pub fn simulated(
    analysis: &Analysis,
    model: &LineModel,
    simulation: &Simulation,
) -> SimulatedPosture {
    let path = analysis.force_shapes(model, simulation.shape.posture, &PARTS).unwrap_or_default();
    let line = &simulation.line;
    let sign = if simulation.force_n < 0.0 { -1.0 } else { 1.0 };
    let fixed = [simulation.depth_mm, line.point.y_mm, line.point.z_mm];
    let top = path.last().and_then(|shape| shape.midpoints_mm.last());
    let usable = simulation.is_usable();
    SimulatedPosture {
        posture: Wire(simulation.shape.posture),
        fitted: simulation.fitted,
        converged: usable,
        status_text: status_text(simulation, analysis.movement.levels().top()),
        force_text: analysis.force_words(model, simulation),
        line_point_mm: match (line.application, top) {
            (Application::AtT2, Some(&top)) => top.into(),
            _ => fixed,
        },
        line_direction: [0.0, sign * line.direction.y_mm, sign * line.direction.z_mm],
        path: path.iter().map(|part| deformed_shape(&analysis.movement.spine, part)).collect(),
        errors: errors_by_level(&simulation.shape),
        mean_error_mm: usable.then(|| simulation.shape.mean_location_error_mm()),
        contradictions: simulation
            .contradicted
            .iter()
            .filter(|_| usable)
            .map(contradiction_text)
            .collect(),
    }
}

/// The location error of every vertebra above the base that the film shows.
pub fn errors_by_level(shape: &FilmShape) -> Vec<LevelError> {
    let errors = shape.compared.iter().zip(&shape.location_errors_mm);
    errors.map(|(level, &error_mm)| LevelError { level: level.to_string(), error_mm }).collect()
}

fn status_text(simulation: &Simulation, top: Level) -> String {
    let left = match simulation.residual {
        Residual::Amplitude(angle) => {
            format!("{}° from the measured lateral tilt", fixed(angle.abs().deg(), 2))
        }
        Residual::Distance { mm } => {
            format!("{top} {} mm from its measured location", fixed(mm.abs(), 1))
        }
    };
    let status = simulation.status.key().replace('_', " ");
    if simulation.is_usable() {
        format!("{status}; {left}")
    } else if simulation.status == PathEnding::BeyondHumanRange {
        format!("{status}: no human spine takes this shape, and it is not a result; {left}")
    } else if simulation.status == PathEnding::FitNotConverged {
        format!("{status}: the shape where the fit stopped is shown and is not a result; {left}")
    } else {
        format!("{status}: the nearest shape is shown and is not a result; {left}")
    }
}

fn contradiction_text(joint: &ContradictedJoint) -> String {
    let noise = if joint.beyond_noise { "beyond noise" } else { "within noise" };
    format!(
        "{}/{} turns {}, counter-rotating: lever arm {} mm, {} % of the work, {noise}",
        joint.inferior,
        joint.superior,
        joint.rotation.leaning(),
        fixed(joint.lever_arm_mm.abs(), 0),
        fixed(100.0 * joint.weight, 0)
    )
}
