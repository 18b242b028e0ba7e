use crate::anatomy::{ImageSide, named};
use crate::fault::faults;
use crate::spatial::{Angle, Frontal};

/// The four corners of a vertebral body, named by the **patient's** sides; on a lateral film the anterior corners stand for the left
/// ones, and the posterior for the right ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Corners<P> {
    /// Superior endplate, patient's left; on a lateral film anterior.
    pub superior_left: P,
    /// Superior endplate, patient's right; on a lateral film posterior.
    pub superior_right: P,
    /// Inferior endplate, patient's left; on a lateral film anterior.
    pub inferior_left: P,
    /// Inferior endplate, patient's right; on a lateral film posterior.
    pub inferior_right: P,
}

named! {
    /// A corner by endplate and by the patient's side; on a lateral film the anterior side stands for the left one.
    pub enum CornerName {
        /// Superior endplate, patient's left.
        SuperiorLeft = "superior_left",
        /// Superior endplate, patient's right.
        SuperiorRight = "superior_right",
        /// Inferior endplate, patient's left.
        InferiorLeft = "inferior_left",
        /// Inferior endplate, patient's right.
        InferiorRight = "inferior_right",
    }
}

impl CornerName {
    /// The order of marking: once around the body from the patient's superior left, so that every click is next to the
    /// one before it.
    pub const ORDER: [Self; 4] =
        [Self::SuperiorLeft, Self::SuperiorRight, Self::InferiorRight, Self::InferiorLeft];

    /// This one of four corners, to be changed.
    pub const fn of_mut<P>(self, corners: &mut Corners<P>) -> &mut P {
        match self {
            Self::SuperiorLeft => &mut corners.superior_left,
            Self::SuperiorRight => &mut corners.superior_right,
            Self::InferiorRight => &mut corners.inferior_right,
            Self::InferiorLeft => &mut corners.inferior_left,
        }
    }

    /// This one of four corners.
    #[must_use]
    pub const fn of<P: Copy>(self, corners: &Corners<P>) -> P {
        match self {
            Self::SuperiorLeft => corners.superior_left,
            Self::SuperiorRight => corners.superior_right,
            Self::InferiorRight => corners.inferior_right,
            Self::InferiorLeft => corners.inferior_left,
        }
    }
}

faults! {
    /// Why four corners are not a vertebral body.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
    pub enum CornerFault {
        /// The diagonals do not meet inside: two neighbouring corners are exchanged, or one is far off.
        #[error("the diagonals of its corners do not meet inside the body")]
        #[help("two corners are exchanged or one is far off: mark them as superior left, superior right, inferior left, inferior right")]
        Crossed,
        /// The left corners lie on the right.
        #[error("its left and right corners are exchanged")]
        #[help("left and right are the patient's: exchange the left and right corners of this vertebra")]
        SidesExchanged,
        /// The inferior corners lie above the superior ones.
        #[error("its superior and inferior corners are exchanged")]
        #[help("exchange the superior and inferior corners of this vertebra")]
        UpsideDown,
        /// Corners coincide or lie on one line.
        #[error("its corners coincide or lie on one line")]
        #[help("mark the four corners of this vertebra again")]
        Flat,
    }
}

impl Corners<Frontal> {
    /// The mean of the four corners.
    #[must_use]
    pub fn centre(&self) -> Frontal {
        let [a, b, c, d] = self.points();
        (a + b + c + d) * 0.25
    }

    /// Intersection of the two diagonals: the paper's LOC.
    ///
    /// # Errors
    /// [`CornerFault::Flat`] and [`CornerFault::Crossed`].
    ///
    /// ```
    /// use spineline::{measure::Corners, spatial::Frontal};
    /// let body = Corners {
    ///     superior_left: Frontal::new(20.0, 10.0),
    ///     superior_right: Frontal::new(-20.0, 10.0),
    ///     inferior_left: Frontal::new(20.0, -10.0),
    ///     inferior_right: Frontal::new(-20.0, -10.0),
    /// };
    /// assert_eq!(body.measure_location()?, Frontal::new(0.0, 0.0));
    /// # Ok::<(), spineline::measure::CornerFault>(())
    /// ```
    pub fn measure_location(&self) -> Result<Frontal, CornerFault> {
        let falling = self.inferior_right - self.superior_left;
        let rising = self.superior_right - self.inferior_left;
        let gap = self.inferior_left - self.superior_left;
        let area = falling.cross(rising);
        if !area.is_finite() {
            return Err(CornerFault::Flat);
        }
        if area.abs() <= 1e-9 * falling.norm_mm() * rising.norm_mm() {
            // Diagonals side by side: two corners of a body are exchanged, unless all four lie on one line.
            let apart = gap.cross(falling).abs() > 1e-9 * gap.norm_mm() * falling.norm_mm();
            let is_crossed = apart && falling.norm_mm() > 0.0 && rising.norm_mm() > 0.0;
            return Err(if is_crossed { CornerFault::Crossed } else { CornerFault::Flat });
        }
        let along_falling = gap.cross(rising) / area;
        let along_rising = gap.cross(falling) / area;
        // Diagonals that meet in a corner: two neighbouring corners are one.
        if [along_falling, along_rising].iter().any(|part| part.min(1.0 - part).abs() < 1e-6) {
            return Err(CornerFault::Flat);
        }
        let inside = 0.0..=1.0;
        if inside.contains(&along_falling) && inside.contains(&along_rising) {
            Ok(self.superior_left + falling * along_falling)
        } else {
            Err(CornerFault::Crossed)
        }
    }

    /// Lateral tilt of the line from the inferior to the superior endplate's centre: the paper's θ of a vertebra.
    #[must_use]
    pub fn measure_tilt(&self) -> Angle {
        self.axis().lateral_tilt()
    }

    /// Lateral tilt of the body by its two endplates: the tilt of the normal of the line through the midpoints of its left and
    /// right wall, which runs along the mean of the endplates.
    ///
    /// It differs from [`Corners::measure_tilt`] for a body whose walls do not stand square on its endplates.
    ///
    /// # References
    /// [wu-boostnet-2017]: the angles that come with those landmarks are differences of this tilt.
    ///
    /// ```
    /// use spineline::{measure::Corners, spatial::Frontal};
    /// let sheared = Corners {
    ///     superior_left: Frontal::new(25.0, 10.0),
    ///     superior_right: Frontal::new(-15.0, 10.0),
    ///     inferior_left: Frontal::new(20.0, -10.0),
    ///     inferior_right: Frontal::new(-20.0, -10.0),
    /// };
    /// assert_eq!(sheared.measure_endplate_tilt().deg(), 0.0);
    /// assert!(sheared.measure_tilt().deg() < -10.0);
    /// ```
    #[must_use]
    pub fn measure_endplate_tilt(&self) -> Angle {
        let to_left =
            (self.superior_left + self.inferior_left) - (self.superior_right + self.inferior_right);
        normal_tilt(to_left)
    }

    /// Lateral tilts of the normals of the two endplates.
    ///
    /// ```
    /// use spineline::{measure::Corners, spatial::Frontal};
    /// let wedged = Corners {
    ///     superior_left: Frontal::new(20.0, 13.5),
    ///     superior_right: Frontal::new(-20.0, 10.0),
    ///     inferior_left: Frontal::new(20.0, -13.5),
    ///     inferior_right: Frontal::new(-20.0, -10.0),
    /// };
    /// let endplates = wedged.measure_endplates();
    /// assert!((endplates.superior.deg() - 5.0).abs() < 0.01);
    /// assert!((endplates.inferior.deg() + 5.0).abs() < 0.01);
    /// assert!(wedged.measure_endplate_tilt().deg().abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn measure_endplates(&self) -> EndplateTilts {
        EndplateTilts {
            superior: normal_tilt(self.superior_left - self.superior_right),
            inferior: normal_tilt(self.inferior_left - self.inferior_right),
        }
    }

    /// Whether the corners run the way in which a patient's left and right lie on this film.
    #[must_use]
    pub fn sides_agree(&self) -> bool {
        let to_left =
            (self.superior_left + self.inferior_left) - (self.superior_right + self.inferior_right);
        to_left.cross(self.axis()) > 0.0
    }

    /// Whether the superior endplate lies on the side of `cranial`.
    #[must_use]
    pub fn points_along(&self, cranial: Frontal) -> bool {
        self.axis().dot(cranial) > 0.0
    }

    /// Distance between the centres of the endplates.
    #[must_use]
    pub fn height_mm(&self) -> f64 {
        self.axis().norm_mm()
    }

    /// Mean length of both endplates.
    #[must_use]
    pub fn mean_width_mm(&self) -> f64 {
        0.5 * (self.superior_left.distance_mm(self.superior_right)
            + self.inferior_left.distance_mm(self.inferior_right))
    }

    /// The longer over the shorter of opposite sides: left and right, superior and inferior.
    pub(super) fn side_ratios(&self) -> [f64; 2] {
        let ratio = |a: f64, b: f64| a.max(b) / a.min(b);
        let left = self.superior_left.distance_mm(self.inferior_left);
        let right = self.superior_right.distance_mm(self.inferior_right);
        let superior = self.superior_left.distance_mm(self.superior_right);
        let inferior = self.inferior_left.distance_mm(self.inferior_right);
        [ratio(left, right), ratio(superior, inferior)]
    }

    /// The longer of the two diagonals.
    pub(super) fn longer_diagonal_mm(&self) -> f64 {
        let falling = self.superior_left.distance_mm(self.inferior_right);
        falling.max(self.superior_right.distance_mm(self.inferior_left))
    }

    fn axis(&self) -> Frontal {
        ((self.superior_left + self.superior_right) - (self.inferior_left + self.inferior_right))
            * 0.5
    }
}

/// Lateral tilt of the cranial normal of a line that runs to the patient's left.
pub(super) fn normal_tilt(to_left: Frontal) -> Angle {
    // A quarter turn about +X carries the patient's left (+Y) to cranial (+Z).
    Frontal::new(-to_left.z_mm, to_left.y_mm).lateral_tilt()
}

impl<P: Copy> Corners<Option<P>> {
    /// All four corners, if all are placed.
    #[must_use]
    pub fn complete(&self) -> Option<Corners<P>> {
        let [superior_left, superior_right, inferior_left, inferior_right] = self.points();
        Some([superior_left?, superior_right?, inferior_left?, inferior_right?].into())
    }
}

impl<P: Copy> Corners<P> {
    /// The corners of a body that is named by the sides of the picture: upper left and right, lower left and right.
    #[must_use]
    pub fn from_image_sides(places: [P; 4], patient_left: ImageSide) -> Self {
        let [upper_left, upper_right, lower_left, lower_right] = places;
        Self::from(match patient_left {
            ImageSide::Left => places,
            ImageSide::Right => [upper_right, upper_left, lower_right, lower_left],
        })
    }

    /// The corners in reading order: superior left and right, inferior left and right.
    #[must_use]
    pub fn points(&self) -> [P; 4] {
        [self.superior_left, self.superior_right, self.inferior_left, self.inferior_right]
    }

    /// The same corners in another space.
    #[must_use]
    pub fn map<Q>(&self, f: impl Fn(P) -> Q) -> Corners<Q> {
        Corners {
            superior_left: f(self.superior_left),
            superior_right: f(self.superior_right),
            inferior_left: f(self.inferior_left),
            inferior_right: f(self.inferior_right),
        }
    }
}

impl<P> From<[P; 4]> for Corners<P> {
    /// The inverse of [`Corners::points`].
    fn from([superior_left, superior_right, inferior_left, inferior_right]: [P; 4]) -> Self {
        Self { superior_left, superior_right, inferior_left, inferior_right }
    }
}

/// Lateral tilts of the normals of a vertebra's two endplates; positive to the patient's right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndplateTilts {
    /// Of the superior endplate.
    pub superior: Angle,
    /// Of the inferior endplate.
    pub inferior: Angle,
}

impl EndplateTilts {
    /// The same tilts against a base of another tilt.
    pub(super) fn against(self, base: Angle) -> Self {
        let [superior, inferior] =
            [self.superior, self.inferior].map(|tilt| (tilt - base).wrapped());
        Self { superior, inferior }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> Corners<Frontal> {
        Corners {
            superior_left: Frontal::new(21.0, 12.0),
            superior_right: Frontal::new(-19.0, 10.0),
            inferior_left: Frontal::new(20.0, -11.0),
            inferior_right: Frontal::new(-22.0, -12.0),
        }
    }

    #[test]
    fn the_location_lies_on_both_diagonals() {
        let body = body();
        let location = body.measure_location().expect("a plain body");
        let on = |a: Frontal, b: Frontal| (location - a).cross(b - a).abs() < 1e-10;
        assert!(on(body.superior_left, body.inferior_right));
        assert!(on(body.superior_right, body.inferior_left));
    }

    #[test]
    fn a_body_that_leans_to_the_right_has_a_positive_tilt() {
        let tilt = Angle::from_deg(17.0);
        let turned = Corners {
            superior_left: Frontal::new(20.0, 10.0),
            superior_right: Frontal::new(-20.0, 10.0),
            inferior_left: Frontal::new(20.0, -10.0),
            inferior_right: Frontal::new(-20.0, -10.0),
        }
        .map(|p| p.rotated(tilt));
        assert!((turned.measure_tilt() - tilt).rad().abs() < 1e-14);
        assert!(turned.axis().y_mm < 0.0, "right is -y");
    }

    #[test]
    fn exchanged_neighbours_cross_and_exchanged_pairs_are_seen_by_side() {
        let good = body();
        let crossed = Corners {
            superior_left: good.superior_right,
            superior_right: good.superior_left,
            ..good
        };
        assert_eq!(crossed.measure_location(), Err(CornerFault::Crossed));
        let mirrored = good.map(|p| Frontal::new(-p.y_mm, p.z_mm));
        assert!(good.sides_agree() && !mirrored.sides_agree());
        let point = good.map(|_| Frontal::new(1.0, 1.0));
        assert_eq!(point.measure_location(), Err(CornerFault::Flat));
    }
}
