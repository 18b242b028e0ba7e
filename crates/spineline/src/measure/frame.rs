use super::{Film, FilmLandmarks, ImageGeometry, Outline, VertebraLandmarks};
use crate::anatomy::{Level, Levels};
use crate::number::mean;
use crate::spatial::{Angle, Frontal, Pixel};

/// Where the global frame of an outline lies on its film: points of `G` as sub-pixel places of the picture, and back.
///
/// The picture's pixels need not be square and the patient's left may be on either side of it; a film without a spacing is
/// taken in the internal millimetres of its outline.
///
/// # Accuracy
/// There and back is exact to rounding: below 1e-9 pixels on any film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmFrame {
    image: ImageGeometry,
    /// L4's midpoint and tilt on the film.
    origin: Frontal,
    tilt: Angle,
    /// The film's scale against the erect one, to whose length the outline is brought.
    scale: f64,
    /// Units of the film, millimetres or pixels, per internal millimetre.
    units_per_mm: f64,
}

impl FilmFrame {
    /// The frame of an outline on the film that it was measured on; `None` for a film without a picture.
    #[must_use]
    pub fn of(film: &Film, outline: &Outline) -> Option<Self> {
        let FilmLandmarks::Corners { image, .. } = &film.landmarks else { return None };
        Some(Self {
            image: *image,
            origin: outline.l4_midpoint_on_film,
            tilt: outline.l4_on_film,
            scale: outline.length.scale.factor,
            units_per_mm: outline.scale.units_per_mm,
        })
    }

    /// The picture.
    #[must_use]
    pub const fn image(&self) -> &ImageGeometry {
        &self.image
    }

    /// Where a point of `G` is seen on the film.
    #[must_use]
    pub fn pixel(&self, point: Frontal) -> Pixel {
        let on_film = (self.origin + point.rotated(self.tilt) * self.scale) * self.units_per_mm;
        self.image.pixel(on_film)
    }

    /// The point of `G` that is seen at a place of the film; the inverse of [`FilmFrame::pixel`].
    #[must_use]
    pub fn point(&self, place: Pixel) -> Frontal {
        let on_film = self.image.frontal(place) * (1.0 / self.units_per_mm);
        (on_film - self.origin).rotated(-self.tilt) * (1.0 / self.scale)
    }

    /// The part of a line of `G` that is seen on the film, in the line's direction; `None` where it misses the film.
    #[must_use]
    pub fn line(&self, point: Frontal, direction: Frontal) -> Option<[Pixel; 2]> {
        self.clipped(point, point + direction, [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// The part of a stretch of `G` that is seen on the film.
    #[must_use]
    pub fn stretch(&self, [from, to]: [Frontal; 2]) -> Option<[Pixel; 2]> {
        self.clipped(from, to, [0.0, 1.0])
    }

    /// The place of the film that is nearest to where a point would be seen.
    #[must_use]
    pub fn nearest_pixel(&self, point: Frontal) -> Pixel {
        let place = self.pixel(point);
        let [columns, rows] = self.last_px();
        Pixel::new(place.column_px.clamp(0.0, columns), place.row_px.clamp(0.0, rows))
    }

    /// Centre of the last pixel.
    fn last_px(&self) -> [f64; 2] {
        [self.image.columns, self.image.rows].map(|count| f64::from(count.max(1) - 1))
    }

    /// Liang and Barsky's clipping between the centres of the outermost pixels.
    fn clipped(&self, from: Frontal, to: Frontal, [low, high]: [f64; 2]) -> Option<[Pixel; 2]> {
        let [a, b] = [from, to].map(|point| {
            let place = self.pixel(point);
            [place.column_px, place.row_px]
        });
        let (mut low, mut high) = (low, high);
        for (axis, last) in self.last_px().into_iter().enumerate() {
            let along = b[axis] - a[axis];
            if along == 0.0 {
                if !(0.0..=last).contains(&a[axis]) {
                    return None;
                }
                continue;
            }
            let [enter, leave] = [-a[axis] / along, (last - a[axis]) / along];
            low = low.max(enter.min(leave));
            high = high.min(enter.max(leave));
        }
        let at = |part: f64| Pixel::new(a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]));
        (low < high && low.is_finite() && high.is_finite()).then(|| [at(low), at(high)])
    }
}

/// Centres of the superior and the inferior endplate of a vertebra in `G`, mean over the readings that marked it.
#[must_use]
pub fn endplate_centres(film: &Film, frame: &FilmFrame, level: Level) -> Option<[Frontal; 2]> {
    let bodies: Vec<_> = film
        .landmarks
        .corner_readings()
        .iter()
        .filter_map(|reading| reading.vertebrae.get(&level))
        .map(|landmark| landmark.corners.map(|corner| frame.point(corner)))
        .collect();
    let share = 0.5 / bodies.len() as f64;
    let sum = |points: &dyn Fn(usize) -> Frontal| {
        (0..bodies.len()).fold(Frontal::default(), |sum, i| sum + points(i)) * share
    };
    (!bodies.is_empty()).then(|| {
        [
            sum(&|i| bodies[i].superior_left + bodies[i].superior_right),
            sum(&|i| bodies[i].inferior_left + bodies[i].inferior_right),
        ]
    })
}

/// Mean widths of some bodies over endplates and readings, in the film's millimetres, or in pixels where it has no
/// spacing; `None` for a vertebra without corners.
#[must_use]
pub fn body_widths(film: &Film, levels: Levels) -> Vec<Option<f64>> {
    let width = |shape: Option<[f64; 2]>| shape.map(|[_, width]| width);
    body_shapes(film, levels).into_iter().map(width).collect()
}

/// Mean height of the two sides and mean width of the endplates of one body, in the film's millimetres or in pixels.
pub(super) fn body_shape(image: &ImageGeometry, landmark: &VertebraLandmarks) -> [f64; 2] {
    let corners = landmark.corners.map(|corner| image.frontal(corner));
    let left = corners.superior_left.distance_mm(corners.inferior_left);
    let right = corners.superior_right.distance_mm(corners.inferior_right);
    [0.5 * (left + right), corners.mean_width_mm()]
}

/// Mean height of the two sides and mean width of the endplates of some bodies, as [`body_widths`].
pub(crate) fn body_shapes(film: &Film, levels: Levels) -> Vec<Option<[f64; 2]>> {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else {
        return vec![None; levels.len()];
    };
    let shape = |level: Level| {
        let landmarks = readings.iter().filter_map(|reading| reading.vertebrae.get(&level));
        let shapes: Vec<[f64; 2]> = landmarks.map(|landmark| body_shape(image, landmark)).collect();
        let mean_of = |side: usize| {
            let mut sizes: Vec<f64> = shapes.iter().map(|shape| shape[side]).collect();
            // The order of the readings must not change a bit.
            sizes.sort_by(f64::total_cmp);
            mean(sizes)
        };
        Some([mean_of(0)?, mean_of(1)?])
    };
    levels.iter().map(shape).collect()
}
