use super::{CurveChange, OnSignedPoint, erect_shape, measure_angles, respond};
use crate::anatomy::Side;
use crate::clinical::CurvePlaces;
use crate::multibody::{
    BodyLoad, Deformed, GeneralStatics, Goal, LoadItem, Loading, LoadingError, PathEnding,
};
use crate::spatial::{Angle, Vec3};

/// A pad that is tried at a vertebra's midpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PadTrial {
    /// Which vertebra, from the fixed one upwards.
    pub vertebra: usize,
    /// Side to which it pushes.
    pub towards: Side,
    /// Force with which it pushes in the end.
    pub force_n: f64,
}

impl PadTrial {
    /// Every vertebra above the fixed one, caudal first, towards both sides, with equal steps of the force up to the largest one.
    #[must_use]
    pub fn all(vertebrae: usize, largest_force_n: f64, steps: u32) -> Vec<Self> {
        let of_vertebra = |vertebra| {
            [Side::Right, Side::Left].into_iter().flat_map(move |towards| {
                (1..=steps).map(move |step| {
                    let force_n = largest_force_n * f64::from(step) / f64::from(steps);
                    Self { vertebra, towards, force_n }
                })
            })
        };
        (1..vertebrae).flat_map(of_vertebra).collect()
    }

    /// Direction of the push in `G`.
    #[must_use]
    pub fn direction(&self) -> Vec3 {
        let left = match self.towards {
            Side::Left => 1.0,
            Side::Right => -1.0,
        };
        Vec3::new(0.0, left, 0.0)
    }
}

/// The loads beside which pads are tried, and the spine under them alone.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherLoads {
    loading: Loading,
    shape: Deformed,
}

impl OtherLoads {
    /// Loads the spine with them; without any it is the erect one. `on_point` is called for every point of the path and may break
    /// off.
    ///
    /// # Errors
    /// [`OtherLoadsError`]: a load that cannot be applied, or loads under which the spine has no equilibrium.
    pub fn new(
        statics: &GeneralStatics<'_>,
        loading: Loading,
        on_point: OnSignedPoint<'_>,
    ) -> Result<Self, OtherLoadsError> {
        if loading.items.is_empty() && loading.rods.is_empty() {
            return Ok(Self { loading, shape: erect_shape(statics.model()) });
        }
        let response = respond(statics, &loading, Goal::FullLoad, 1.0, on_point)?;
        match response.result() {
            Some(result) => Ok(Self { shape: result.deformed.clone(), loading }),
            None => Err(OtherLoadsError::NoResult { ending: response.ending }),
        }
    }
}

/// Why pads cannot be tried beside other loads.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OtherLoadsError {
    /// One of them cannot be applied to this spine.
    #[error(transparent)]
    Loading(#[from] LoadingError),
    /// The spine has no equilibrium under them.
    #[error("the other loads have no result: {}", ending.meaning())]
    NoResult {
        /// How the search ended.
        ending: PathEnding,
    },
}

/// The effect of a pad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PadEffect {
    /// The pad.
    pub trial: PadTrial,
    /// How the search ended.
    pub ending: PathEnding,
    /// The shape, where there is a result.
    pub reached: Option<PadReached>,
}

/// A spine beside a pad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PadReached {
    /// How far the vertebra's midpoint moved along the push, from the erect spine.
    pub travel_mm: f64,
    /// The largest erect curve without the pad, and with it; `None` where no curve is measured.
    pub curve: Option<CurveChange>,
    /// Lateral tilt of the line from the lowest to the uppermost vertebra.
    pub lateral_tilt: Angle,
}

impl PadEffect {
    /// Displacement of a pad of this stiffness that ends with the force of the trial; `None` without a result.
    ///
    /// A frictionless pad is a spring along its push: it follows the vertebra, and is compressed by its force.
    #[must_use]
    pub fn advance_mm(&self, n_per_mm: f64) -> Option<f64> {
        Some(self.reached?.travel_mm + self.trial.force_n / n_per_mm)
    }
}

/// Pushes one pad against the spine until it has its force; other loads grow with it, or are there before it.
///
/// In the end a frictionless pad is a force of fixed direction at the point that it touches, whatever its stiffness: so the force
/// is given, and the displacement of the pad is found ([`PadEffect::advance_mm`]). `on_point` is called for every point of the
/// path and may break off.
///
/// # Errors
/// [`LoadingError`] where the pad cannot be applied to this spine.
///
/// # Panics
/// If a place is not a vertebra of the spine.
pub fn try_pad(
    statics: &GeneralStatics<'_>,
    others: &OtherLoads,
    places: &[CurvePlaces],
    trial: PadTrial,
    on_point: OnSignedPoint<'_>,
) -> Result<PadEffect, LoadingError> {
    let force_n = trial.direction() * trial.force_n;
    let mut loading = others.loading.clone();
    loading.items.push(LoadItem::proportional(trial.vertebra, BodyLoad::at_midpoint(force_n)));
    let response = respond(statics, &loading, Goal::FullLoad, 1.0, on_point)?;
    let erect = erect_shape(statics.model());
    let reached = response.result().map(|result| {
        let shape = &result.deformed;
        let moved = shape.midpoints_mm[trial.vertebra] - erect.midpoints_mm[trial.vertebra];
        let [unloaded, before, after] =
            [&erect, &others.shape, shape].map(|shape| measure_angles(shape, places));
        PadReached {
            travel_mm: moved.dot(&trial.direction()),
            curve: CurveChange::of_largest(&unloaded, [&before, &after]),
            lateral_tilt: after.lateral_tilt,
        }
    });
    Ok(PadEffect { trial, ending: response.ending, reached })
}
