//! Numbers of the paper that more than one output shows.

use std::fmt;

use spineline::action::LineKind;

/// A mean of the paper with its standard deviation over the pooled values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperMean {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
    /// Decimal places that the paper prints.
    places: usize,
}

impl PaperMean {
    pub(crate) const fn new(mean: f64, sd: f64, places: usize) -> Self {
        Self { mean, sd, places }
    }
}

impl fmt::Display for PaperMean {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&spineline::number::with_sd(self.mean, self.sd, self.places))
    }
}

/// Shares of the least-rotating segments at 0, 1 and 2 segments from an inflection segment, in percent (figure 6a).
pub const NEAR_SHARES_PERCENT: [f64; 3] = [20.0, 62.0, 18.0];

/// Rotation of the inflection segments, in degrees (figure 6b).
pub const INFLECTION_ROTATION_DEG: PaperMean = PaperMean::new(0.0028, 0.0021, 4);

/// Location error over the fitted bends, in millimetres (figure 8). Model-1 has the inflection line, Model-2 the iliac line.
#[must_use]
pub const fn fitted_location_error_mm(kind: LineKind) -> Option<PaperMean> {
    match kind {
        LineKind::Inflection => Some(PaperMean::new(0.51, 0.41, 2)),
        LineKind::Iliac => Some(PaperMean::new(1.41, 1.09, 2)),
        LineKind::Estimated | LineKind::Given => None,
    }
}

/// Location error over the neutral and traction films, in millimetres. The paper gives it for Model-1 alone.
#[must_use]
pub const fn held_out_location_error_mm(kind: LineKind) -> Option<PaperMean> {
    match kind {
        LineKind::Inflection => Some(PaperMean::new(0.78, 0.65, 2)),
        LineKind::Iliac | LineKind::Estimated | LineKind::Given => None,
    }
}
