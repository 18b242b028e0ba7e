use crate::anatomy::Region;
use crate::clinical::{CurvePlaces, EndAngles};
use crate::multibody::{Deformed, SpineModel};
use crate::spatial::{Angle, Frontal};

/// A hinge that turns farther is worth a word: about twice what a healthy motion segment allows in any direction.
///
/// # Assumption
/// A round number, not a measured limit.
pub const UNUSUAL_HINGE: Angle = Angle::from_deg(20.0);

/// What clinicians would measure on one curve of a frontal film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveAngles {
    /// Which curve.
    pub region: Region,
    /// Tilt range and Cobb angle between the end vertebrae, positive where convex to the left.
    pub ends: EndAngles,
    /// Ferguson angle, positive where convex to the left.
    pub ferguson: Angle,
}

/// What clinicians would measure on a frontal film of a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct SpineAngles {
    /// Lateral tilt of the line from the lowest to the uppermost vertebra.
    pub lateral_tilt: Angle,
    /// Curves, in the order of the places.
    pub curves: Vec<CurveAngles>,
}

/// Measures a shape between given vertebrae, as a frontal film would show them.
///
/// # Panics
/// If a place is not a vertebra of the shape.
#[must_use]
pub fn measure_angles(shape: &Deformed, places: &[CurvePlaces]) -> SpineAngles {
    let count = shape.midpoints_mm.len();
    let locations: Vec<Frontal> = (0..count).map(|i| shape.location(i)).collect();
    let tilts: Vec<Angle> = (0..count).map(|i| shape.tilt(i)).collect();
    let angles = |place: &CurvePlaces| CurveAngles {
        region: place.bounds.region,
        ends: place.angles(&tilts),
        ferguson: place.ferguson(&locations),
    };
    SpineAngles { lateral_tilt: shape.lateral_tilt(), curves: places.iter().map(angles).collect() }
}

/// The unloaded spine as a shape.
#[must_use]
pub fn erect_shape(model: &SpineModel) -> Deformed {
    Deformed {
        midpoints_mm: model.midpoints_mm.clone(),
        axes: model.axes.clone(),
        hinges_rad: vec![[0.0; 3]; model.joints.len()],
    }
}

/// The vertebra whose midpoint moved farthest from the erect spine, and how far.
#[must_use]
pub fn largest_displacement_mm(model: &SpineModel, shape: &Deformed) -> (usize, f64) {
    let moved = model.midpoints_mm.iter().zip(&shape.midpoints_mm).map(|(a, b)| (b - a).norm());
    moved.enumerate().fold((0, 0.0), |most, now| if now.1 > most.1 { now } else { most })
}

/// The joint and the axis (0 lateral, 1 flexion, 2 axial) that turned most, and how far.
#[must_use]
pub fn largest_hinge(shape: &Deformed) -> (usize, usize, Angle) {
    let hinges = shape.hinges_rad.iter().enumerate();
    let turns = hinges.flat_map(|(j, turns)| turns.iter().enumerate().map(move |(a, t)| (j, a, t)));
    let most = turns.fold((0, 0, 0.0_f64), |most, (joint, axis, &turn)| {
        if turn.abs() > most.2.abs() { (joint, axis, turn) } else { most }
    });
    (most.0, most.1, Angle::from_rad(most.2))
}
