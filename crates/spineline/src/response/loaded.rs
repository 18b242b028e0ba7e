use serde::{Deserialize, Serialize};

use super::{Response, SpineAngles, erect_shape, measure_angles};
use crate::anatomy::Region;
use crate::anatomy::named;
use crate::clinical::{CurvePlaces, sacral_line_offset_mm};
use crate::measure::Outline;
use crate::multibody::{Deformed, Goal, SpineModel};
use crate::spatial::Angle;

/// A measure of a spine before and under loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LoadedQuantity {
    /// Cobb angle of a curve, in degrees; positive where convex to the left.
    Cobb(Region),
    /// Tilt range of a curve whose endplates are not known, in degrees; positive where convex to the left.
    TiltRange(Region),
    /// Ferguson angle of a curve, in degrees; positive where convex to the left.
    Ferguson(Region),
    /// Lateral tilt of the line from the lowest to the uppermost vertebra, in degrees; positive to the right.
    LateralTilt,
    /// Tilt of the uppermost vertebra against the lowest one, in degrees; positive to the right.
    TopTilt,
    /// Distance of the uppermost vertebra from the cranial axis of the lowest one, in mm; positive to the left.
    TopOffset,
    /// Distance of the uppermost vertebra from the central sacral vertical line, in mm; positive to the left.
    CoronalBalance,
    /// Factor of the proportional loads that gives the wanted lateral tilt; only under loads.
    Factor,
}

impl LoadedQuantity {
    /// The name used in files; the region is separate.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Cobb(_) => "cobb",
            Self::TiltRange(_) => "tilt_range",
            Self::Ferguson(_) => "ferguson",
            Self::LateralTilt => "lateral_tilt",
            Self::TopTilt => "top_tilt",
            Self::TopOffset => "top_offset",
            Self::CoronalBalance => "coronal_balance",
            Self::Factor => "factor",
        }
    }

    /// The region of a curve.
    #[must_use]
    pub const fn region(self) -> Option<Region> {
        match self {
            Self::Cobb(region) | Self::TiltRange(region) | Self::Ferguson(region) => Some(region),
            _ => None,
        }
    }

    /// The unit as files have it: `deg`, `mm` or `1`.
    #[must_use]
    pub const fn unit_key(self) -> &'static str {
        match self {
            Self::TopOffset | Self::CoronalBalance => "mm",
            Self::Factor => "1",
            _ => "deg",
        }
    }

    /// Whether it is an angle.
    #[must_use]
    pub const fn is_angle(self) -> bool {
        !matches!(self, Self::TopOffset | Self::CoronalBalance | Self::Factor)
    }
}

named! {
    /// Which value of a quantity.
    pub enum LoadedState {
        /// On the erect, unloaded spine.
        Erect = "erect",
        /// Under the loads.
        Loaded = "loaded",
        /// Under the loads minus erect.
        Change = "change",
    }
}

/// A quantity before and under loads, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadedMeasure {
    /// What is measured.
    pub quantity: LoadedQuantity,
    /// On the erect spine; `None` for the factor.
    pub erect: Option<f64>,
    /// Under the loads; `None` without a result.
    pub loaded: Option<f64>,
}

impl LoadedMeasure {
    /// One of its values; angles change the short way round.
    #[must_use]
    pub fn value(&self, state: LoadedState) -> Option<f64> {
        match state {
            LoadedState::Erect => self.erect,
            LoadedState::Loaded => self.loaded,
            LoadedState::Change => {
                let change = self.loaded? - self.erect?;
                let wrapped = |deg: f64| Angle::from_deg(deg).wrapped().deg();
                Some(if self.quantity.is_angle() { wrapped(change) } else { change })
            }
        }
    }
}

/// Measures of a spine before and under loads: angles of the curves between given vertebrae, tilts, the place of the
/// uppermost vertebra, its distance from the vertical of the erect film where that is given and has one, and the factor of a search.
///
/// # Panics
/// If a place is not a vertebra of the model, or the response belongs to another one.
#[must_use]
pub fn loaded_measures(
    erect: &SpineModel,
    places: &[CurvePlaces],
    film: Option<&Outline>,
    response: &Response,
) -> Vec<LoadedMeasure> {
    let before = values(&erect_shape(erect), places, film);
    let result = response.result();
    let after = result.map(|found| values(&found.deformed, places, film));
    let measure = |(number, (quantity, erect)): (usize, (LoadedQuantity, f64))| LoadedMeasure {
        quantity,
        erect: Some(erect),
        loaded: after.as_ref().map(|after| after[number].1),
    };
    let mut measures: Vec<LoadedMeasure> = before.into_iter().enumerate().map(measure).collect();
    if matches!(response.goal, Goal::LateralTilt(_)) {
        let loaded = result.map(|found| found.factor);
        measures.push(LoadedMeasure { quantity: LoadedQuantity::Factor, erect: None, loaded });
    }
    measures
}

/// The same quantities for every shape of a model.
fn values(
    shape: &Deformed,
    places: &[CurvePlaces],
    film: Option<&Outline>,
) -> Vec<(LoadedQuantity, f64)> {
    use LoadedQuantity as Q;
    let SpineAngles { lateral_tilt, top_offset_mm, curves } = measure_angles(shape, places);
    let sizes = curves.iter().map(|curve| {
        let is_cobb = curve.ends.cobb.is_some();
        let quantity = if is_cobb { Q::Cobb } else { Q::TiltRange };
        (quantity(curve.region), curve.ends.size().deg())
    });
    let fergusons = curves.iter().map(|curve| (Q::Ferguson(curve.region), curve.ferguson.deg()));
    let mut all: Vec<(Q, f64)> = sizes.chain(fergusons).collect();
    let top = shape.midpoints_mm.len() - 1;
    all.extend([
        (Q::LateralTilt, lateral_tilt.deg()),
        (Q::TopTilt, shape.tilt(top).deg()),
        (Q::TopOffset, top_offset_mm),
    ]);
    let balance_mm = film.and_then(|film| sacral_line_offset_mm(film, shape.location(top)));
    all.extend(balance_mm.map(|mm| (Q::CoronalBalance, mm)));
    all
}
