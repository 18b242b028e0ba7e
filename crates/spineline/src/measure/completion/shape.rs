//! Corners of a spine as angles and logarithms of lengths, which depend neither on how a film lies nor on how large it is.

use nalgebra::{DMatrix, DVector};

use crate::anatomy::Level;
use crate::measure::{CornerName, Corners};
use crate::spatial::{Angle, Frontal};

/// Vertebrae from L5 to T1.
pub(super) const LEVELS: usize = Level::ALL.len();
const STEPS: usize = LEVELS - 1;
/// Rotations and offsets of the steps, wedges and shears of the bodies.
pub(super) const ANGLES: usize = 2 * STEPS + 2 * LEVELS;
/// Steps, heights, superior and inferior widths.
pub(super) const LENGTHS: usize = STEPS + 3 * LEVELS;
/// Place of L5's centre (two coordinates) and direction of its endplates come first.
pub(super) const PLACE: usize = 3;
/// All parameters; as many as coordinates of corners.
pub(super) const PARAMETERS: usize = PLACE + ANGLES + LENGTHS;

/// First parameter of the angles and of the lengths.
pub(super) const FIRST_ANGLE: usize = PLACE;
pub(super) const FIRST_LENGTH: usize = PLACE + ANGLES;

const OFFSET: usize = FIRST_ANGLE + STEPS;
const WEDGE: usize = OFFSET + STEPS;
const SHEAR: usize = WEDGE + LEVELS;
const HEIGHT: usize = FIRST_LENGTH + STEPS;
const SUPERIOR: usize = HEIGHT + LEVELS;
const INFERIOR: usize = SUPERIOR + LEVELS;

/// A spine by its parameters:
///
/// | parameter | of | definition |
/// |---|---|---|
/// | rotation | step to the next vertebra | from the lower body's direction to the upper one's |
/// | offset | step | direction of the line between both centres against the mean of both bodies' normals |
/// | wedge | body | from the inferior to the superior endplate's direction |
/// | shear | body | axis through the endplates' centres against the normal of the body's direction |
/// | step, height, superior, inferior | step, body | logarithm of the length |
///
/// A body's direction is the mean of its endplates' directions, each from the patient's right to the left; its centre is the
/// mean of its corners.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shape {
    pub parameters: DVector<f64>,
}

/// A body as half vectors: from the centre to the superior endplate, and from the endplates' centres to their left ends.
#[derive(Debug, Clone, Copy)]
struct HalfVectors {
    centre: Frontal,
    axis: Frontal,
    superior: Frontal,
    inferior: Frontal,
}

impl HalfVectors {
    fn corners(&self) -> Corners<Frontal> {
        let (above, below) = (self.centre + self.axis, self.centre - self.axis);
        Corners {
            superior_left: above + self.superior,
            superior_right: above - self.superior,
            inferior_left: below + self.inferior,
            inferior_right: below - self.inferior,
        }
    }
}

/// Whether a corner lies on the superior endplate, and on the patient's left; as signs.
fn signs(corner: CornerName) -> (f64, f64) {
    match corner {
        CornerName::SuperiorLeft => (1.0, 1.0),
        CornerName::SuperiorRight => (1.0, -1.0),
        CornerName::InferiorLeft => (-1.0, 1.0),
        CornerName::InferiorRight => (-1.0, -1.0),
    }
}

/// A quarter turn from the patient's left to cranial.
fn turned(vector: Frontal) -> Frontal {
    Frontal::new(-vector.z_mm, vector.y_mm)
}

/// Coordinates of the corners of a vertebra.
pub(super) const CORNERS: usize = 8;

/// The index of the first of them in vectors and matrices of all vertebrae.
pub(super) fn corners_at(level: Level) -> usize {
    CORNERS * level as usize
}

/// The index of the first of two coordinates of a corner.
pub(super) fn coordinate(level: Level, corner: CornerName) -> usize {
    corners_at(level) + 2 * corner as usize
}

impl Shape {
    fn angle(&self, parameter: usize) -> Angle {
        Angle::from_rad(self.parameters[parameter])
    }

    fn length_mm(&self, parameter: usize) -> f64 {
        self.parameters[parameter].exp()
    }

    /// Bodies from L5 to T1, and the steps between their centres.
    fn bodies(&self) -> ([HalfVectors; LEVELS], [Frontal; STEPS]) {
        let zero = Frontal::default();
        let nothing = HalfVectors { centre: zero, axis: zero, superior: zero, inferior: zero };
        let (mut bodies, mut steps) = ([nothing; LEVELS], [zero; STEPS]);
        let mut centre = Frontal::new(self.parameters[0], self.parameters[1]);
        let mut direction = self.angle(2);
        for level in 0..LEVELS {
            let half = |length: usize| 0.5 * self.length_mm(length + level);
            let wedge = self.angle(WEDGE + level) * 0.5;
            let left = Frontal::new(1.0, 0.0);
            bodies[level] = HalfVectors {
                centre,
                axis: Frontal::leaning(direction + self.angle(SHEAR + level)) * half(HEIGHT),
                superior: left.rotated(direction + wedge) * half(SUPERIOR),
                inferior: left.rotated(direction - wedge) * half(INFERIOR),
            };
            if level < STEPS {
                let rotation = self.angle(FIRST_ANGLE + level);
                let step = direction + rotation * 0.5 + self.angle(OFFSET + level);
                steps[level] = Frontal::leaning(step) * self.length_mm(FIRST_LENGTH + level);
                centre = centre + steps[level];
                direction = direction + rotation;
            }
        }
        (bodies, steps)
    }

    /// Corners from L5 to T1.
    pub fn corners(&self) -> [Corners<Frontal>; LEVELS] {
        self.bodies().0.map(|body| body.corners())
    }

    /// The coordinates of all corners, in the order of [`coordinate`].
    pub fn coordinates(&self) -> DVector<f64> {
        let corners = self.corners();
        let places = corners.iter().flat_map(|body| CornerName::ALL.map(|name| name.of(body)));
        DVector::from_iterator(PARAMETERS, places.flat_map(|place| [place.y_mm, place.z_mm]))
    }

    /// Derivatives of [`Shape::coordinates`] by the parameters.
    pub fn jacobian(&self) -> DMatrix<f64> {
        let (bodies, steps) = self.bodies();
        let mut jacobian = DMatrix::zeros(PARAMETERS, PARAMETERS);
        for (level, body) in bodies.iter().enumerate() {
            for corner in CornerName::ALL {
                let row = coordinate(Level::ALL[level], corner);
                let mut set = |column: usize, by: Frontal| {
                    jacobian[(row, column)] = by.y_mm;
                    jacobian[(row + 1, column)] = by.z_mm;
                };
                set(0, Frontal::new(1.0, 0.0));
                set(1, Frontal::new(0.0, 1.0));
                let (up, left) = signs(corner);
                let half = if up > 0.0 { body.superior } else { body.inferior };
                let from_centre = body.axis * up + half * left;
                set(2, turned(body.centre + from_centre - bodies[0].centre));
                for (step, &vector) in steps.iter().enumerate().take(level) {
                    // Bodies above a step turn with it; the step itself by half of its rotation.
                    let above = body.centre + from_centre - bodies[step + 1].centre;
                    set(FIRST_ANGLE + step, turned(above + vector * 0.5));
                    set(OFFSET + step, turned(vector));
                    set(FIRST_LENGTH + step, vector);
                }
                set(WEDGE + level, turned(half) * (0.5 * up * left));
                set(SHEAR + level, turned(body.axis) * up);
                set(HEIGHT + level, body.axis * up);
                set(if up > 0.0 { SUPERIOR } else { INFERIOR } + level, half * left);
            }
        }
        jacobian
    }
}
