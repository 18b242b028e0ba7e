//! Axial rotation of vertebrae from their pedicles on a frontal film.

use std::ops::RangeInclusive;

use super::{Corners, VertebraLandmarks};
use crate::anatomy::{Level, Morphometry, PediclePlace, Side, named};
use crate::fault::faults;
use crate::spatial::{Angle, Frontal, Pixel};

named! {
    /// How far the pedicle of the convex side has moved to the midline of the body.
    ///
    /// # Definition
    /// By the distance of the pedicle that is nearer to the midline, as a part of half of the distance between both: 0.9 and more is
    /// grade 0, from 2/3 on grade I, from 1/3 on grade II, from 0 on grade III; beyond the midline it is grade IV. The limits follow the thirds of
    /// the half body (assumption).
    ///
    /// # References
    /// [nash-moe-1969].
    pub enum NashMoe {
        /// No rotation.
        Zero = "0",
        /// The pedicle has left its place.
        One = "I",
        /// It is in the middle third.
        Two = "II",
        /// It is at the midline.
        Three = "III",
        /// It is beyond the midline.
        Four = "IV",
    }
}

impl NashMoe {
    fn of(nearer_share: f64) -> Self {
        match nearer_share {
            share if share >= 0.9 => Self::Zero,
            share if share >= 2.0 / 3.0 => Self::One,
            share if share >= 1.0 / 3.0 => Self::Two,
            share if share >= 0.0 => Self::Three,
            _ => Self::Four,
        }
    }
}

/// The axial rotation of one vertebra, about its own axis; positive where its front turns to the patient's left.
///
/// # Definition
/// A pedicle lies `beside` the sagittal plane of the vertebra and `behind` the centre of the body ([`PediclePlace`]). Across the
/// axis of the body, which the frontal film shows without error of the pitch, the pedicles lie at
/// `±beside cos ψ - behind sin ψ` to the left of the centre. With the sum and the difference of both places
/// `tan ψ = -(beside / behind) sum / difference` (Stokes), which needs the ratio of a typical vertebra alone and no scale. The sum over the
/// width of the body, `sin ψ = -sum / (2 behind)` with `behind` as a part of the width, is the other method (after Drerup).
///
/// # References
/// [stokes-1986], [drerup-1984].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialRotation {
    /// Which vertebra.
    pub level: Level,
    /// By the distance between the pedicles.
    pub stokes: Angle,
    /// By the width of the body; `None` where the pedicles lie farther out than it lets them.
    pub drerup: Option<Angle>,
    /// Standard deviation of the first one, by landmarks and by the variation of the ratio between people.
    pub sd: Angle,
    /// Grade.
    pub grade: NashMoe,
    /// Readings that marked both pedicles.
    pub readings: usize,
}

impl AxialRotation {
    /// The side to which the front of the vertebra turns.
    #[must_use]
    pub fn side(&self) -> Option<Side> {
        // Positive about a vertical axis is to the left.
        self.stokes.side().map(Side::opposite)
    }

    /// In words, such as `12.3° to the left`.
    #[must_use]
    pub fn words(&self) -> String {
        match self.side().filter(|_| self.stokes.shown_side().is_some()) {
            Some(side) => format!("{} to the {side}", self.stokes.abs()),
            None => self.stokes.abs().to_string(),
        }
    }
}

faults! {
    /// Why two pedicles give no rotation.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
    pub enum PedicleFault {
        /// A coordinate is not a number, or a pedicle lies outside of the picture.
        #[error("a pedicle does not lie on the picture")]
        #[help("mark both pedicles of this vertebra again, or remove them")]
        OffImage,
        /// The left one lies on the right of the other, across the axis of the body.
        #[error("its left and right pedicles are exchanged")]
        #[help("left and right are the patient's: exchange the two pedicles of this vertebra")]
        SidesExchanged,
        /// One lies more than the width of the body from its centre.
        #[error("a pedicle lies beside its body")]
        #[help(WITHIN_BODY)]
        FarFromBody,
        /// Both lie far above or below the body, along its axis, and fit another vertebra.
        #[error("its pedicles lie at the height of {fits}")]
        #[help(WITHIN_BODY)]
        OtherLevel {
            /// The marked vertebra that they fit best.
            fits: Level,
        },
    }
}

const WITHIN_BODY: &str =
    "mark the pedicles of this vertebra again: they lie within the outline of its body";

/// Height of two pedicles over the middle of a body along its axis, as a part of the height of the body: mean of both.
pub(super) fn height_over(body: &Corners<Frontal>, pedicles: [Frontal; 2]) -> f64 {
    let up = (pedicles[0] + pedicles[1]) * 0.5 - body.centre();
    up.rotated(-body.measure_tilt()).z_mm / body.height_mm()
}

/// Heights of [`height_over`] at which pedicles may be a vertebra's own.
///
/// A pedicle lies behind the upper half of its body, so a film shows it higher the more the vertebra is tilted forward: L5 and L4 by the
/// lordosis, T8 and above by a kyphosis.
/// On phantoms of the five shapes from the side, a vertebra's own pedicles, at the height of its body or a quarter above it
/// (assumption), lie from -0.45 to 0.76, of L5 and L4 to 1.12. In a severe kyphosis that tilts a vertebra forward by 40°, [`PediclePlace`]
/// and [`Morphometry`] put them at T8 and above up to 1.18. Pedicles of the next vertebra above lie from 0.98 on, at L5 and L4 from
/// 1.46 on, and pedicles of the next one below from -0.9 down at most levels. So at T8 and above, pedicles of the next vertebra between
/// 0.98 and 1.25 are not found.
pub(super) fn own_heights(level: Level) -> RangeInclusive<f64> {
    let most = if (Level::L3..=Level::T9).contains(&level) { 1.0 } else { 1.25 };
    -0.75..=most
}

/// The pedicles of one body across its axis, from its centre to the left, and its width, in the unit of the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PediclePair {
    left: f64,
    right: f64,
    width: f64,
}

impl PediclePair {
    pub fn of(
        landmark: &VertebraLandmarks,
        frontal: impl Fn(Pixel) -> Frontal,
    ) -> Result<Self, PedicleFault> {
        let body = landmark.corners.map(&frontal);
        // Across the axis the mean of the corners is twice as sure as the crossing of the diagonals.
        let centre = body.centre();
        let across = |place: Option<Pixel>| {
            place.map(|place| (frontal(place) - centre).rotated(-body.measure_tilt()).y_mm)
        };
        let [left, right] = landmark.pedicles.map(across);
        let (left, right) = left.zip(right).ok_or(PedicleFault::OffImage)?;
        let width = body.mean_width_mm();
        if left <= right {
            return Err(PedicleFault::SidesExchanged);
        }
        if left.abs().max(right.abs()) > width {
            return Err(PedicleFault::FarFromBody);
        }
        Ok(Self { left, right, width })
    }

    /// Distance of the pedicle nearer to the midline, as a part of half of the distance between both; negative beyond the midline.
    pub fn nearer_share(&self) -> f64 {
        2.0 * self.left.min(-self.right) / (self.left - self.right)
    }

    pub fn mean(mut all: Vec<Self>) -> Option<Self> {
        // The order of the readings must not reach the last bit.
        all.sort_by(|a, b| a.left.total_cmp(&b.left).then(a.right.total_cmp(&b.right)));
        let share = 1.0 / all.len() as f64;
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() * share;
        let pair =
            Self { left: mean(|p| p.left), right: mean(|p| p.right), width: mean(|p| p.width) };
        (!all.is_empty()).then_some(pair)
    }

    pub fn rotation(self, level: Level, corner_sd: f64, readings: usize) -> AxialRotation {
        let place = PediclePlace::of(level);
        let (sum, difference) = (self.left + self.right, self.left - self.right);
        let ratio = place.beside_mm / place.behind_mm;
        let tangent = -ratio * sum / difference;
        let stokes = Angle::from_sin_cos(tangent, 1.0);
        // The centre of the body has a quarter of a corner's variance, and enters the sum twice.
        let of_sum = 3.0_f64.sqrt() * corner_sd / difference;
        let of_difference = 2.0_f64.sqrt() * corner_sd * sum / difference.powi(2);
        let landmarks = ratio * of_sum.hypot(of_difference);
        let people = tangent * PediclePlace::RATIO_SD;
        let sd = landmarks.hypot(people) / (1.0 + tangent * tangent);
        let typical = Morphometry::of(level);
        let width_mm = 0.5 * (typical.superior_width_mm + typical.inferior_width_mm);
        let sine = -sum / (2.0 * self.width * place.behind_mm / width_mm);
        AxialRotation {
            level,
            stokes,
            drerup: (sine.abs() <= 1.0)
                .then(|| Angle::from_sin_cos(sine, (1.0 - sine * sine).sqrt())),
            sd: Angle::from_rad(sd),
            grade: NashMoe::of(self.nearer_share()),
            readings,
        }
    }
}
