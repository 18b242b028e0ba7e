//! Step 2: locations and tilts → a smooth curve through them, its inflections and the curves between them.
//!
//! # Model
//! In the global frame the curve leaves L4 along +Z, so `p(0) = p'(0) = 0` holds exactly and is built into the basis
//! `y(z) = S u² Σ c_k T_k(2u - 1)`, `u = z / S`, with Chebyshev polynomials `T_k`: a well-conditioned way to write a
//! polynomial of the stated order. Locations and tilts are fitted together by linear least squares, each row divided by
//! its standard deviation, through a QR factorisation.
//!
//! A spine with a tilt beyond 70° has no useful slope `dy/dz`; then `y` and `z` are both polynomials of the chord
//! length, and [`CurveForm::Parametric`] says so.
//!
//! # Departures from the paper
//! The paper takes the order with the least residual ([`OrderRule::Paper`]). On films marked by hand a high order invents inflections,
//! so the default takes the order that best predicts a vertebra left out of the fit ([`OrderRule::LeaveOneOut`]).
//!
//! # References
//! [jalalian-loa], section 2.3.

mod fit;
mod free_form;
mod inflection;
mod residual;
mod series;
mod spread;

pub use fit::{CurveError, OrderRule, fit_curve};
pub use free_form::{InflectionInterval, InflectionIntervals};
pub(crate) use inflection::MIN_TURN;
pub use inflection::{
    CurveBetween, Inflection, InflectionChoice, Inflections, Site, find_inflections,
};
pub use residual::CurveResidual;
pub use spread::CurveSpread;

use crate::anatomy::{Levels, named};
use crate::spatial::{Angle, Frontal};
use series::Series;

named! {
    /// How a curve is written.
    pub enum CurveForm {
        /// `y` as a polynomial of `z`.
        Graph = "graph",
        /// `y` and `z` as polynomials of the chord length.
        Parametric = "parametric",
    }
}

/// A smooth planar curve from L4 (`t = 0`) to T2 (`t = end`), in the global frontal plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    form: CurveForm,
    y: Series,
    z: Series,
    end_mm: f64,
}

impl Curve {
    /// How it is written.
    #[must_use]
    pub const fn form(&self) -> CurveForm {
        self.form
    }

    /// The parameter at T2; at L4 it is zero. For [`CurveForm::Graph`] the parameter is `z`.
    #[must_use]
    pub const fn end_mm(&self) -> f64 {
        self.end_mm
    }

    /// Point at a parameter.
    #[must_use]
    pub fn point(&self, t_mm: f64) -> Frontal {
        Frontal::new(self.y.value(t_mm), t_mm + self.z.value(t_mm))
    }

    /// Derivative of the point by the parameter.
    #[must_use]
    pub fn tangent(&self, t_mm: f64) -> Frontal {
        self.point_and_tangent(t_mm).1
    }

    /// Point and tangent together, cheaper than the two separately.
    #[must_use]
    pub fn point_and_tangent(&self, t_mm: f64) -> (Frontal, Frontal) {
        let [both] = self.points_and_tangents([t_mm]);
        both
    }

    /// The same at several places, cheaper than one by one.
    #[must_use]
    pub fn points_and_tangents<const N: usize>(&self, t_mm: [f64; N]) -> [(Frontal, Frontal); N] {
        let (y, dy) = self.y.values_and_slopes(t_mm);
        let (z, dz) = self.z.values_and_slopes(t_mm);
        std::array::from_fn(|i| {
            (Frontal::new(y[i], t_mm[i] + z[i]), Frontal::new(dy[i], 1.0 + dz[i]))
        })
    }

    /// Lateral tilt of the tangent.
    #[must_use]
    pub fn tilt(&self, t_mm: f64) -> Angle {
        self.tangent(t_mm).lateral_tilt()
    }

    /// Rate at which the tilt grows with the parameter, in rad/mm; zero where the curve inflects.
    #[must_use]
    pub fn turning(&self, t_mm: f64) -> f64 {
        let (tangent, bend) = self.tangent_and_bend(t_mm);
        tangent.cross(bend) / tangent.dot(tangent)
    }

    /// First and second derivative of the point by the parameter.
    fn tangent_and_bend(&self, t_mm: f64) -> (Frontal, Frontal) {
        let [_, dy, ddy] = self.y.jet(t_mm);
        let [_, dz, ddz] = self.z.jet(t_mm);
        (Frontal::new(dy, 1.0 + dz), Frontal::new(ddy, ddz))
    }

    /// A value that vanishes where the curve inflects.
    fn bending(&self, t_mm: f64) -> f64 {
        let (tangent, bend) = self.tangent_and_bend(t_mm);
        tangent.cross(bend)
    }

    /// Arc length from L4 to a parameter.
    #[must_use]
    pub fn length_mm(&self, to_mm: f64) -> f64 {
        // Three-point Gauss-Legendre on pieces of about 4 mm: the rest is far below a nanometre.
        const NODES: [(f64, f64); 3] = [
            (-0.774_596_669_241_483_4, 5.0 / 9.0),
            (0.0, 8.0 / 9.0),
            (0.774_596_669_241_483_4, 5.0 / 9.0),
        ];
        let pieces = 96;
        let half = 0.5 * to_mm / f64::from(pieces);
        (0..pieces)
            .map(|piece| {
                let middle = half * f64::from(2 * piece + 1);
                let nodes = self.points_and_tangents(NODES.map(|(x, _)| middle + half * x));
                let tangents = nodes.iter().zip(NODES);
                tangents.map(|((_, tangent), (_, w))| w * tangent.norm_mm()).sum::<f64>()
            })
            .sum::<f64>()
            * half
    }
}

/// A fitted curve and how well it fits.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveFit {
    /// The curve.
    pub curve: Curve,
    /// Order of the polynomial.
    pub order: usize,
    /// Root mean square distance of the locations.
    pub rmse_mm: f64,
    /// Root mean square difference of the tilts.
    pub rmse_tilt: Angle,
    /// Root mean square error on vertebrae left out of the fit, in standard deviations of a measurement.
    pub left_out: f64,
    /// Parameter of every vertebra, the base (L4) first.
    pub vertebra_t_mm: Vec<f64>,
    /// The vertebrae.
    pub levels: Levels,
}
