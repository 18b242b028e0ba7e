use crate::anatomy::Region;
use crate::clinical::{CurvePlaces, EndAngles};
use crate::multibody::{Deformed, SpineModel};
use crate::spatial::Angle;

/// A hinge that turns farther gets a warning: about twice the range of a healthy motion segment in any direction.
///
/// # Assumption
/// A round number, not a measured limit.
pub const UNUSUAL_HINGE: Angle = Angle::from_deg(20.0);

/// Clinical measures of one curve on a frontal film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveAngles {
    /// Which curve.
    pub region: Region,
    /// Tilt range and Cobb angle between the end vertebrae, positive where convex to the left.
    pub ends: EndAngles,
    /// Ferguson angle, positive where convex to the left.
    pub ferguson: Angle,
}

/// Clinical measures of a shape on a frontal film.
#[derive(Debug, Clone, PartialEq)]
pub struct SpineAngles {
    /// Lateral tilt of the line from the lowest to the uppermost vertebra.
    pub lateral_tilt: Angle,
    /// Distance of the uppermost vertebra's midpoint from the cranial axis of the lowest one; positive to the patient's left.
    pub top_offset_mm: f64,
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
    let tilts: Vec<Angle> = (0..count).map(|i| shape.tilt(i)).collect();
    let angles = |place: &CurvePlaces| CurveAngles {
        region: place.bounds.region,
        ends: place.angles(&tilts),
        ferguson: place.bounds.ferguson_angle(|i| shape.location(i)),
    };
    SpineAngles {
        lateral_tilt: shape.lateral_tilt(),
        top_offset_mm: shape.location(count - 1).y_mm,
        curves: places.iter().map(angles).collect(),
    }
}

/// One curve of a spine, before and after.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveChange {
    /// Which curve.
    pub region: Region,
    /// Whether the sizes are Cobb angles; else they are tilt ranges.
    pub is_cobb: bool,
    /// Size before; not negative.
    pub before: Angle,
    /// Size after, in the direction of before: negative where the curve is reversed.
    pub after: Angle,
}

impl CurveChange {
    /// Of the largest erect curve, between the angles of two shapes at the same places; `None` without curves.
    #[must_use]
    pub fn between(erect: &SpineAngles, after: &SpineAngles) -> Option<Self> {
        Self::of_largest(erect, [erect, after])
    }

    /// Of the largest erect curve, from one loaded shape to another one; `None` without curves.
    #[must_use]
    pub fn of_largest(erect: &SpineAngles, [before, after]: [&SpineAngles; 2]) -> Option<Self> {
        let size = |curve: &CurveAngles| curve.ends.size();
        let all = erect.curves.iter().zip(before.curves.iter().zip(&after.curves));
        let larger =
            |a: &CurveAngles, b: &CurveAngles| size(a).abs().rad().total_cmp(&size(b).abs().rad());
        let (_, (before, after)) = all.max_by(|(a, _), (b, _)| larger(a, b))?;
        let sign = if size(before).rad() < 0.0 { -1.0 } else { 1.0 };
        Some(Self {
            region: before.region,
            is_cobb: before.ends.cobb.is_some(),
            before: size(before) * sign,
            after: size(after) * sign,
        })
    }

    /// What the size is called.
    #[must_use]
    pub const fn size_name(&self) -> &'static str {
        if self.is_cobb { "Cobb angle" } else { "tilt range" }
    }

    /// Growth of the curve; negative where it is corrected.
    #[must_use]
    pub fn growth(&self) -> Angle {
        self.after - self.before
    }
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
