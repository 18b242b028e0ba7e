use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Normal};
use spineline::measure::{Corners, ImageGeometry, VertebraLandmarks};
use spineline::spatial::{Angle, Frontal, Pixel};

/// The virtual readers of a film.
///
/// Every observer has a bias per film and vertebra, every repeat a random error; corners are rounded to pixels and axes
/// to 0.1°. By default, means over two observers and three repeats have the noise of the paper's residuals (0.19 mm and
/// 0.17° about curves of high order). The paper's Pearson coefficients (0.90 to 0.95) would need ten times this noise,
/// so both cannot be met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Readers {
    /// Number of observers.
    pub observers: u32,
    /// Number of readings per observer.
    pub repeats: u32,
    /// Standard deviation of a corner coordinate between repeats.
    pub corner_sd_mm: f64,
    /// Standard deviation of an observer's bias of corners, the same in all repeats.
    pub corner_bias_sd_mm: f64,
    /// Standard deviation of an axis between repeats.
    pub axis_sd: Angle,
    /// Standard deviation of an observer's bias of axes.
    pub axis_bias_sd: Angle,
    /// Standard deviation of a coordinate of an iliac crest, which is marked once.
    pub crest_sd_mm: f64,
    /// Whether corners are rounded to pixels, and axes are set by hand, to 0.1°; else tilts come from corners alone.
    pub rounded: bool,
}

impl Readers {
    /// One reader without error.
    #[must_use]
    pub const fn exact() -> Self {
        Self {
            observers: 1,
            repeats: 1,
            corner_sd_mm: 0.0,
            corner_bias_sd_mm: 0.0,
            axis_sd: Angle::ZERO,
            axis_bias_sd: Angle::ZERO,
            crest_sd_mm: 0.0,
            rounded: false,
        }
    }

    /// The default readers with every deviation multiplied.
    #[must_use]
    pub fn scaled(factor: f64) -> Self {
        let usual = Self::default();
        Self {
            corner_sd_mm: factor * usual.corner_sd_mm,
            corner_bias_sd_mm: factor * usual.corner_bias_sd_mm,
            axis_sd: usual.axis_sd * factor,
            axis_bias_sd: usual.axis_bias_sd * factor,
            ..usual
        }
    }

    /// One observer's bias at one vertebra: four corners and an axis.
    pub(crate) fn bias(&self, rng: &mut ChaCha12Rng) -> Deviation {
        Deviation::draw(self.corner_bias_sd_mm, self.axis_bias_sd, rng)
    }

    /// Marks one iliac crest. Readers who mark them exactly draw no random numbers for it.
    pub(crate) fn crest(&self, place: Frontal, rng: &mut ChaCha12Rng) -> Frontal {
        if self.crest_sd_mm == 0.0 {
            return place;
        }
        let error = Normal::new(0.0, self.crest_sd_mm).expect("a deviation");
        place + Frontal::new(error.sample(rng), error.sample(rng))
    }

    /// Marks one vertebra.
    pub(crate) fn landmark(
        &self,
        image: &ImageGeometry,
        corners: &Corners<Frontal>,
        tilt: Angle,
        bias: &Deviation,
        rng: &mut ChaCha12Rng,
    ) -> VertebraLandmarks {
        let scatter = Deviation::draw(self.corner_sd_mm, self.axis_sd, rng);
        let names = corners.points();
        let moved: [Pixel; 4] = std::array::from_fn(|i| {
            let place = image.pixel(names[i] + bias.corners[i] + scatter.corners[i]);
            if self.rounded {
                Pixel::new(place.column_px.round(), place.row_px.round())
            } else {
                place
            }
        });
        let axis_clockwise = self.rounded.then(|| {
            let seen = image.tilt_from_clockwise(tilt + bias.axis + scatter.axis);
            Angle::from_deg((seen.deg() * 10.0).round() / 10.0)
        });
        VertebraLandmarks { axis_clockwise, ..VertebraLandmarks::clicked(Corners::from(moved)) }
    }
}

impl Default for Readers {
    fn default() -> Self {
        Self {
            observers: 2,
            repeats: 3,
            corner_sd_mm: 0.4,
            corner_bias_sd_mm: 0.15,
            axis_sd: Angle::from_deg(0.3),
            axis_bias_sd: Angle::from_deg(0.1),
            crest_sd_mm: 0.0,
            rounded: true,
        }
    }
}

/// Error of a reader at one vertebra.
#[derive(Debug, Clone)]
pub(crate) struct Deviation {
    corners: [Frontal; 4],
    axis: Angle,
}

impl Deviation {
    fn draw(corner_sd_mm: f64, axis_sd: Angle, rng: &mut ChaCha12Rng) -> Self {
        let unit = Normal::new(0.0, 1.0).expect("a positive deviation");
        let mut draw = |sd: f64| sd * unit.sample(rng);
        let corners = std::array::from_fn(|_| Frontal::new(draw(corner_sd_mm), draw(corner_sd_mm)));
        Self { corners, axis: Angle::from_rad(draw(axis_sd.rad())) }
    }
}
