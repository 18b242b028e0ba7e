use super::{SpatialMeasures, WithSd};
use crate::anatomy::{Region, named};
use crate::measure::LengthScale;
use crate::number::{NORMAL_975, with_sd};
use crate::spatial::Angle;

named! {
    /// Whether a number is measured on one film, or in space.
    pub enum Dimension {
        /// On one film.
        TwoD = "2-D",
        /// In space.
        ThreeD = "3-D",
    }
}

/// One number of the spine in space, as reports, tables and files show it.
#[derive(Debug, Clone, PartialEq)]
pub struct SpatialNumber {
    /// Its name in files.
    pub key: &'static str,
    /// In words.
    pub label: &'static str,
    /// The vertebrae between which it is measured, the upper one first.
    pub between: String,
    /// The region, for a number of a curve.
    pub region: Option<Region>,
    /// On a film or in space.
    pub dimension: Dimension,
    /// `deg`, `mm`, or `px` where the erect film has no spacing.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard deviation by the landmarks and the alignment of the lateral film.
    pub sd: f64,
}

impl SpatialNumber {
    /// 95 % interval by its standard deviation, as for a normal error.
    #[must_use]
    pub fn interval_95(&self) -> [f64; 2] {
        let half = NORMAL_975 * self.sd;
        [self.value - half, self.value + half]
    }

    /// Number and unit with the standard deviation: `32.1 ± 1.4°`.
    #[must_use]
    pub fn text(&self) -> String {
        let number = with_sd(self.value, self.sd, 1);
        match self.unit {
            "deg" => format!("{number}°"),
            unit => format!("{number} {unit}"),
        }
    }
}

impl SpatialMeasures {
    /// All of them, each named 2-D or 3-D; `scale` belongs to the erect film.
    #[must_use]
    pub fn numbers(&self, scale: &LengthScale) -> Vec<SpatialNumber> {
        use Dimension::{ThreeD, TwoD};
        let mut all = Vec::new();
        for angle in &self.sagittal {
            let [low, high] = angle.part.ends();
            let [endplates, axes] = angle.part.names();
            let mut add = |(key, label), dimension, found| {
                let between = format!("{high}–{low}");
                all.push(degrees(key, label, between, None, dimension, found));
            };
            add(endplates, TwoD, angle.endplates_2d);
            add(axes, TwoD, angle.axes_2d);
            add(axes, ThreeD, angle.axes_3d);
        }
        for curve in &self.curves {
            let mut add = |key, label, dimension, found| {
                let between = format!("{}–{}", curve.ends.superior, curve.ends.inferior);
                all.push(degrees(key, label, between, Some(curve.region), dimension, found));
            };
            add("curve_frontal", "curve on the erect film, axes", TwoD, curve.frontal_2d);
            add("curve_lateral", "curve on the lateral film, axes", TwoD, curve.lateral_2d);
            let label = "curve in its plane of maximum curvature";
            add("curve_largest", label, ThreeD, curve.angle_3d);
            let label = "direction of its convexity (0 front, 90 left, 180 back, -90 right)";
            add("curve_convexity", label, ThreeD, curve.convexity_3d);
        }
        for (region, found) in &self.apices {
            all.push(degrees(
                "apical_rotation",
                "axial rotation of the apex, its front to the left positive",
                found.level.to_string(),
                Some(*region),
                ThreeD,
                WithSd { value: found.stokes, sd: found.sd },
            ));
        }
        let [low, high] = self.length.ends;
        let factor = scale.units_per_mm;
        let length = |dimension, WithSd { value, sd }: WithSd<f64>| SpatialNumber {
            key: "spinal_length",
            label: "length of the spine through its midpoints",
            between: format!("{high}–{low}"),
            region: None,
            dimension,
            unit: if scale.has_millimetres() { "mm" } else { "px" },
            value: value * factor,
            sd: sd * factor,
        };
        all.push(length(TwoD, self.length.length_2d_mm));
        all.push(length(ThreeD, self.length.length_3d_mm));
        all
    }
}

fn degrees(
    key: &'static str,
    label: &'static str,
    between: String,
    region: Option<Region>,
    dimension: Dimension,
    found: WithSd<Angle>,
) -> SpatialNumber {
    let (value, sd) = (found.value.deg(), found.sd.deg());
    SpatialNumber { key, label, between, region, dimension, unit: "deg", value, sd }
}
