use super::CurveFit;
use crate::anatomy::Level;
use crate::measure::Outline;
use crate::spatial::{Angle, Frontal};

/// A vertebra beyond this number of standard deviations is an outlier.
const OUTLIER_SD: f64 = 3.0;

/// How far a measured vertebra is from the fitted curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveResidual {
    /// Which vertebra.
    pub level: Level,
    /// Measured midpoint.
    pub measured: Frontal,
    /// Where the curve passes.
    pub on_curve: Frontal,
    /// Measured tilt minus the curve's.
    pub tilt: Angle,
    /// Whether place or tilt is an outlier on this film.
    pub is_outlier: bool,
}

impl CurveResidual {
    /// Distance between the two places.
    #[must_use]
    pub fn distance_mm(&self) -> f64 {
        self.measured.distance_mm(self.on_curve)
    }
}

impl CurveFit {
    /// Residuals of every marked vertebra above L4 (the base), which the curve meets by construction. Their root mean squares are
    /// [`CurveFit::rmse_mm`] and [`CurveFit::rmse_tilt`].
    ///
    /// # Definition
    /// An outlier is beyond three standard deviations in place or tilt. The deviation is the root mean square of the film's
    /// *other* residuals, so that an outlier does not inflate its own threshold, and at least the measurement's.
    #[must_use]
    pub fn residuals(&self, outline: &Outline) -> Vec<CurveResidual> {
        let mut all: Vec<CurveResidual> = outline
            .measured()
            .skip(1)
            .map(|(i, vertebra)| (vertebra, self.vertebra_t_mm[i]))
            .map(|(vertebra, t)| CurveResidual {
                level: vertebra.level,
                measured: vertebra.location,
                on_curve: self.curve.point(t),
                tilt: (vertebra.tilt - self.curve.tilt(t)).wrapped(),
                is_outlier: false,
            })
            .collect();
        let noise = || outline.measured().skip(1).map(|(_, vertebra)| outline.noise_of(vertebra));
        let distances = all.iter().map(CurveResidual::distance_mm);
        let places = outliers(distances.zip(noise().map(|noise| noise.location_mm)));
        let turns = all.iter().map(|r| r.tilt.rad());
        let tilts = outliers(turns.zip(noise().map(|noise| noise.tilt.rad())));
        for ((residual, place), tilt) in all.iter_mut().zip(places).zip(tilts) {
            residual.is_outlier = place || tilt;
        }
        all
    }
}

/// Of residuals, each with the standard deviation of its measurement.
fn outliers(values: impl Iterator<Item = (f64, f64)>) -> Vec<bool> {
    let squares: Vec<[f64; 2]> =
        values.map(|(value, noise)| [value * value, noise * noise]).collect();
    let total: f64 = squares.iter().map(|[square, _]| square).sum();
    let others = (squares.len().max(2) - 1) as f64;
    let is_beyond = |&[square, noise]: &[f64; 2]| {
        let variance = ((total - square) / others).max(noise);
        square > OUTLIER_SD * OUTLIER_SD * variance
    };
    squares.iter().map(is_beyond).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outlier_does_not_inflate_its_own_threshold() {
        // Fourteen residuals of 1, one of them 5: its own square would widen three deviations to 4.9.
        let mut values = [1.0; 14];
        values[6] = -5.0;
        let found = outliers(values.iter().map(|value| (*value, 0.1)));
        assert_eq!(found.iter().filter(|is| **is).count(), 1);
        assert!(found[6]);
    }

    #[test]
    fn measurement_noise_is_not_an_outlier() {
        let mut values = [1e-6; 14];
        values[0] = 0.5;
        assert!(outliers(values.iter().map(|value| (*value, 0.25))).iter().all(|is| !is));
        assert!(outliers([(0.8, 0.25), (0.0, 0.25)].into_iter())[0]);
    }
}
