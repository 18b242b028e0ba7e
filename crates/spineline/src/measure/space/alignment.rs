//! The lateral film against the frontal one: scale and turn in its plane, from the heights of vertebrae that both show.

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector3};

use crate::anatomy::Level;
use crate::measure::bodies::crossing_sd;
use crate::measure::lateral::{LateralOutline, LateralVertebra};
use crate::spatial::{Angle, Frontal};

/// How a lateral film lies to the frontal film of the same posture.
///
/// # Definition
/// A point of the lateral film at `x` to the front and `z` up the film has the height
/// `c + scale (z cos turn + x sin turn)` on the frontal film. The three numbers come from least squares over the midpoints of the
/// vertebrae on both films, weighted by their noise, with a normal prior on the turn. If the heights differ by more than their noise,
/// the covariance grows with the residual.
///
/// # Assumptions
/// The frontal film hangs upright. The patient keeps the shape between the exposures and turns by a right angle. Rays are parallel. Two films
/// that were exposed together have one vertical, and one scale where both have a spacing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmAlignment {
    /// Whether both films were exposed together, so that nothing but a missing scale was estimated.
    pub simultaneous: bool,
    /// Millimetres of the frontal film for one unit of the lateral film.
    pub scale: f64,
    /// By how much the lateral film shows the spine turned; positive where it looks more flexed than it is.
    pub turn: Angle,
    /// Covariance of the logarithm of the scale and of the turn in rad; zero for what was not estimated.
    pub covariance: Matrix2<f64>,
    /// Root mean square of the remaining differences of height.
    pub residual_mm: f64,
    /// Its expected value by the noise of the landmarks.
    pub expected_mm: f64,
    /// Vertebrae that both films show.
    pub vertebrae: usize,
    heights: HeightPlane,
}

/// Heights on the frontal film over places of the lateral film.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HeightPlane {
    /// Mean place of the vertebrae on the lateral film, and their mean height on the frontal one.
    middle: Frontal,
    middle_mm: f64,
    /// Height at the middle from the mean one, and its rates up the lateral film and to the front.
    coefficients: Vector3<f64>,
    covariance: Matrix3<f64>,
}

impl HeightPlane {
    fn rates(&self, place: Frontal) -> Vector3<f64> {
        let from = place - self.middle;
        Vector3::new(1.0, from.z_mm, from.y_mm)
    }

    fn variance(&self, place: Frontal) -> f64 {
        let rates = self.rates(place);
        rates.dot(&(self.covariance * rates)).max(0.0)
    }
}

/// The height of a vertebra on the frontal film, and its standard deviation, in the unit of its film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FrontalHeight {
    pub height: f64,
    pub sd: f64,
}

/// A vertebra on both films.
struct HeightPair {
    frontal: FrontalHeight,
    lateral: Frontal,
    /// Of the height on the lateral film.
    lateral_sd: LateralSd,
}

/// Deviation of a coordinate on the lateral film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LateralSd {
    /// In the unit of the lateral film.
    Lateral(f64),
    /// In the unit of the frontal film.
    Frontal(f64),
}

impl LateralSd {
    /// Of a corner as readings show it; where nothing was read twice, it is `assumed`, in the unit of the frontal film.
    pub fn of(lateral: &LateralOutline, assumed: f64) -> Self {
        lateral.corner_sd.map_or(Self::Frontal(assumed), Self::Lateral)
    }

    /// Of the height of the crossing of a body's diagonals, from its corners.
    pub fn upwards(self, body: &LateralVertebra) -> Self {
        let upwards = |corner_sd: f64| crossing_sd(corner_sd, body.depth, body.height)[1];
        match self {
            Self::Lateral(sd) => Self::Lateral(upwards(sd)),
            Self::Frontal(sd) => Self::Frontal(upwards(sd)),
        }
    }

    /// In the unit of the frontal film.
    pub fn on_frontal(self, scale: f64) -> f64 {
        match self {
            Self::Lateral(sd) => sd * scale,
            Self::Frontal(sd) => sd,
        }
    }
}

/// Coefficients of the heights that the films leave free; each with those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Free {
    /// The height as such.
    Offset = 1,
    /// The rate up the lateral film.
    Scale = 2,
    /// The rate to the front.
    Turn = 3,
}

/// Least squares over the heights.
struct Fit {
    scale: f64,
    turn: f64,
    covariance: Matrix2<f64>,
    residuals_mm: Vec<f64>,
    sds_mm: Vec<f64>,
    heights: HeightPlane,
}

impl FilmAlignment {
    /// Standard deviation of the turn before the films are compared (assumption): films hang upright to within a few degrees.
    pub const TURN_SD: Angle = Angle::from_deg(2.0);

    /// Of a lateral film whose corners have this deviation, to a frontal film on which vertebrae have these heights; `frontal_has_scale`
    /// says whether they are millimetres. `None` where fewer than two vertebrae are on both films, or they do not give a positive scale.
    pub(super) fn of(
        lateral: &LateralOutline,
        corner: LateralSd,
        frontal_has_scale: bool,
        height: impl Fn(Level) -> Option<FrontalHeight>,
    ) -> Option<Self> {
        let pair = |side: &LateralVertebra| {
            let frontal = height(side.level)?;
            Some(HeightPair { frontal, lateral: side.location, lateral_sd: corner.upwards(side) })
        };
        let pairs: Vec<HeightPair> = lateral.vertebrae.iter().filter_map(pair).collect();
        let start = first_scale(&pairs)?;
        let simultaneous = lateral.simultaneous;
        let free = match (simultaneous, frontal_has_scale && lateral.has_spacing) {
            (true, true) => Free::Offset,
            (true, false) => Free::Scale,
            (false, _) => Free::Turn,
        };
        let scale = if free == Free::Offset { 1.0 } else { start };
        let first = fit(&pairs, free, scale, 1.0)?;
        // Differences beyond the noise are taken as further noise.
        let freedom = pairs.len().saturating_sub(free as usize).max(1) as f64;
        let squares = first.residuals_mm.iter().zip(&first.sds_mm);
        let excess = (squares.map(|(r, sd)| (r / sd).powi(2)).sum::<f64>() / freedom).max(1.0);
        let found = fit(&pairs, free, first.scale, excess.sqrt())?;
        let mean_square = |all: &[f64]| all.iter().map(|mm| mm * mm).sum::<f64>();
        Some(Self {
            simultaneous,
            scale: found.scale,
            turn: Angle::from_rad(found.turn),
            covariance: found.covariance,
            residual_mm: (mean_square(&found.residuals_mm) / freedom).sqrt(),
            expected_mm: (mean_square(&first.sds_mm) / pairs.len() as f64).sqrt(),
            vertebrae: pairs.len(),
            heights: found.heights,
        })
    }

    /// A place of the lateral film, from another one: to the front and up, in millimetres, corrected for the turn.
    #[must_use]
    pub fn from_film_mm(&self, place: Frontal, origin: Frontal) -> Frontal {
        (place - origin).rotated(self.turn) * self.scale
    }

    /// The height on the frontal film of a place of the lateral one, and its standard deviation by the alignment alone.
    pub(super) fn height_mm(&self, place: Frontal) -> [f64; 2] {
        let plane = &self.heights;
        let height_mm = plane.middle_mm + plane.coefficients.dot(&plane.rates(place));
        [height_mm, plane.variance(place).sqrt()]
    }

    /// The place of the lateral film, `front` to the front, that has a height on the frontal film, and the standard deviation of its
    /// second coordinate by the alignment alone, in the unit of the lateral film.
    pub(super) fn place_at(&self, height_mm: f64, front: f64) -> (Frontal, f64) {
        let HeightPlane { middle, middle_mm, coefficients, .. } = &self.heights;
        let [offset, up, ahead] = [coefficients[0], coefficients[1], coefficients[2]];
        let rest_mm = height_mm - middle_mm - offset - ahead * (front - middle.y_mm);
        let place = Frontal::new(front, middle.z_mm + rest_mm / up);
        (place, self.heights.variance(place).sqrt() / up)
    }

    /// Standard deviation of the scale, as a part of it.
    #[must_use]
    pub fn relative_scale_sd(&self) -> f64 {
        self.covariance[(0, 0)].sqrt()
    }

    /// Standard deviation of the turn.
    #[must_use]
    pub fn turn_sd(&self) -> Angle {
        Angle::from_rad(self.covariance[(1, 1)].sqrt())
    }
}

/// From the highest and the lowest vertebra.
fn first_scale(pairs: &[HeightPair]) -> Option<f64> {
    let (first, last) = (pairs.first()?, pairs.last()?);
    let scale =
        (last.frontal.height - first.frontal.height) / (last.lateral.z_mm - first.lateral.z_mm);
    (pairs.len() > 1 && scale.is_finite() && scale > 0.0).then_some(scale)
}

/// Weighted by the noise times the factor `excess`. `scale` is the known one, or an estimate where it is free.
fn fit(pairs: &[HeightPair], free: Free, scale: f64, excess: f64) -> Option<Fit> {
    let n = pairs.len();
    let columns = free as usize;
    let sds_mm: Vec<f64> =
        pairs.iter().map(|pair| pair.frontal.sd.hypot(pair.lateral_sd.on_frontal(scale))).collect();
    let mean = |of: &dyn Fn(&HeightPair) -> f64| pairs.iter().map(of).sum::<f64>() / n as f64;
    let middle = Frontal::new(mean(&|p| p.lateral.y_mm), mean(&|p| p.lateral.z_mm));
    let middle_mm = mean(&|p| p.frontal.height);
    let mut rows = DMatrix::zeros(n + 1, columns);
    let mut right = DVector::zeros(n + 1);
    for (i, (pair, sd_mm)) in pairs.iter().zip(&sds_mm).enumerate() {
        let lateral = pair.lateral - middle;
        let all = [1.0, lateral.z_mm, lateral.y_mm];
        let known_mm = if free == Free::Offset { scale * lateral.z_mm } else { 0.0 };
        right[i] = (pair.frontal.height - middle_mm - known_mm) / (sd_mm * excess);
        for (column, value) in all.into_iter().take(columns).enumerate() {
            rows[(i, column)] = value / (sd_mm * excess);
        }
    }
    if free == Free::Turn {
        rows[(n, 2)] = 1.0 / (scale * FilmAlignment::TURN_SD.rad());
    }
    let inverse = (rows.transpose() * &rows).try_inverse()?;
    let solution = &inverse * rows.transpose() * &right;
    let residuals = &right - &rows * &solution;
    let residuals_mm =
        residuals.iter().zip(&sds_mm).map(|(residual, sd_mm)| residual * sd_mm * excess).collect();
    let padded = |i: usize, j: usize| if i.max(j) < columns { inverse[(i, j)] } else { 0.0 };
    let heights = |up: f64, front: f64| HeightPlane {
        middle,
        middle_mm,
        coefficients: Vector3::new(solution[0], up, front),
        covariance: Matrix3::from_fn(padded),
    };
    if free == Free::Offset {
        let (covariance, heights) = (Matrix2::zeros(), heights(scale, 0.0));
        return Some(Fit { scale, turn: 0.0, covariance, residuals_mm, sds_mm, heights });
    }
    let (up, front) = (solution[1], if free == Free::Turn { solution[2] } else { 0.0 });
    let scale = up.hypot(front);
    let mut covariance = Matrix2::zeros();
    // Rates of the logarithm of the scale and of the turn with both slopes.
    let rates = Matrix2::new(up, front, -front, up) / (scale * scale);
    let slopes = Matrix2::from_fn(|i, j| padded(i + 1, j + 1));
    covariance += rates * slopes * rates.transpose();
    let is_usable = scale.is_finite() && up > 0.0;
    let turn = Angle::from_sin_cos(front, up).rad();
    let heights = heights(up, front);
    is_usable.then_some(Fit { scale, turn, covariance, residuals_mm, sds_mm, heights })
}
