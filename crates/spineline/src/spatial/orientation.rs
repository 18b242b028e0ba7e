use super::{Angle, Mat3, Vec3, rotation_x, rotation_y, rotation_z};

/// How a vertebra stands in space: lateral tilt, pitch and axial rotation, in the order of a joint's hinges.
///
/// # Definition
/// Its axes in the upright frame of the films are `Rx(tilt) Ry(pitch) Rz(axial)`; columns are anterior, left and cranial of
/// the vertebra. Its cranial axis is therefore `(sin pitch, -sin tilt cos pitch, cos tilt cos pitch)`. A frontal film
/// shows that axis at the angle `tilt` from its vertical. A lateral film shows it at the angle `β` with
/// `tan β = tan pitch / cos tilt`. Neither depends on the axial rotation.
///
/// # Assumption
/// Rays are parallel: along the anterior axis for the frontal film, along the left axis for the lateral one.
///
/// ```
/// use spineline::spatial::{Angle, Orientation};
/// let vertebra = Orientation::of_axis(Angle::from_deg(25.0), Angle::from_deg(20.0));
/// // The lateral film overstates the pitch of a tilted vertebra.
/// assert!(vertebra.pitch.deg() < 18.3);
/// assert!((vertebra.lateral_pitch().deg() - 20.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Orientation {
    /// About the anterior axis of the film; positive to the patient's right.
    pub tilt: Angle,
    /// About the left axis after the tilt; flexion positive.
    pub pitch: Angle,
    /// About the vertebra's own cranial axis; positive where its front turns to the patient's left.
    pub axial: Angle,
}

impl Orientation {
    /// Of a vertebra whose axis is seen at these angles on the frontal and on the lateral film; no axial rotation.
    #[must_use]
    pub fn of_axis(tilt: Angle, lateral_pitch: Angle) -> Self {
        let (sin, cos) = lateral_pitch.rad().sin_cos();
        let pitch = Angle::from_sin_cos(tilt.rad().cos() * sin, cos);
        Self { tilt, pitch, axial: Angle::ZERO }
    }

    /// The angle of its axis from the vertical on a lateral film; the inverse of [`Orientation::of_axis`].
    #[must_use]
    pub fn lateral_pitch(&self) -> Angle {
        let (sin, cos) = self.pitch.rad().sin_cos();
        Angle::from_sin_cos(sin, self.tilt.rad().cos() * cos)
    }

    /// The angle of an endplate square to its axis on a lateral film, where the endplate is read by its middle line from front to
    /// back: `tan = cos tilt tan pitch` without axial rotation. Read by the outline of its rim, a round endplate shows
    /// [`Orientation::lateral_pitch`].
    #[must_use]
    pub fn middle_line_pitch(&self) -> Angle {
        let ahead = self.axes().column(0).into_owned();
        Angle::from_sin_cos(-ahead.z, ahead.x)
    }

    /// Rates of the pitch in space with the tilt and with the angle on the lateral film.
    #[must_use]
    pub fn pitch_rates(&self) -> [f64; 2] {
        let (sin_tilt, cos_tilt) = self.tilt.rad().sin_cos();
        let (sin, cos) = self.lateral_pitch().rad().sin_cos();
        let size = (cos_tilt * sin).powi(2) + cos.powi(2);
        [-sin_tilt * sin * cos / size, cos_tilt / size]
    }

    /// Its cranial axis.
    #[must_use]
    pub fn cranial(&self) -> Vec3 {
        let (sin, cos) = self.pitch.rad().sin_cos();
        let (sin_tilt, cos_tilt) = self.tilt.rad().sin_cos();
        Vec3::new(sin, -sin_tilt * cos, cos_tilt * cos)
    }

    /// Its axes: columns are anterior, left and cranial of the vertebra.
    #[must_use]
    pub fn axes(&self) -> Mat3 {
        rotation_x(self.tilt) * rotation_y(self.pitch) * rotation_z(self.axial)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_is_the_third_column_whatever_the_axial_rotation() {
        for (tilt, pitch) in [(0.0, 10.0), (35.0, -25.0), (-40.0, 50.0)] {
            let [tilt, pitch] = [tilt, pitch].map(Angle::from_deg);
            for axial in [-30.0, 0.0, 30.0].map(Angle::from_deg) {
                let stands = Orientation { tilt, pitch, axial };
                let seen = stands.axes().column(2).into_owned();
                assert!((seen - stands.cranial()).norm() < 1e-15);
                assert!((Angle::from_sin_cos(-seen.y, seen.z) - tilt).rad().abs() < 1e-15);
                let lateral = Angle::from_sin_cos(seen.x, seen.z);
                assert!((lateral - stands.lateral_pitch()).rad().abs() < 1e-15);
                let back = Orientation::of_axis(tilt, lateral);
                assert!((back.pitch - pitch).rad().abs() < 1e-14);
            }
        }
    }

    #[test]
    fn rates_agree_with_differences() {
        const STEP: f64 = 1e-6;
        for (tilt, lateral) in [(0.0, 0.3), (0.5, -0.4), (-0.7, 0.9)] {
            let pitch = |tilt: f64, lateral: f64| {
                Orientation::of_axis(Angle::from_rad(tilt), Angle::from_rad(lateral)).pitch.rad()
            };
            let stands = Orientation::of_axis(Angle::from_rad(tilt), Angle::from_rad(lateral));
            let numeric = [
                (pitch(tilt + STEP, lateral) - pitch(tilt - STEP, lateral)) / (2.0 * STEP),
                (pitch(tilt, lateral + STEP) - pitch(tilt, lateral - STEP)) / (2.0 * STEP),
            ];
            for (rate, numeric) in stands.pitch_rates().into_iter().zip(numeric) {
                assert!((rate - numeric).abs() < 1e-9, "{rate} {numeric}");
            }
        }
    }
}
