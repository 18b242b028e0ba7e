//! Places of the parts of the trunk on a film, from the true corners and crests.

use std::collections::BTreeMap;

use spineline::anatomy::Level;
use spineline::measure::Corners;
use spineline::spatial::{Angle, Frontal, Pixel};

use super::layer::{Layer, Point, spacing};
use crate::TrueFilm;

/// A body on its film.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    pub level: Level,
    /// Halfway between the endplates' centres.
    pub centre: Frontal,
    pub tilt: Angle,
    pub superior_width_mm: f64,
    pub inferior_width_mm: f64,
    pub height_mm: f64,
}

impl Body {
    fn of(level: Level, corners: &Corners<Frontal>) -> Self {
        let superior = (corners.superior_left + corners.superior_right) * 0.5;
        let inferior = (corners.inferior_left + corners.inferior_right) * 0.5;
        Self {
            level,
            centre: (superior + inferior) * 0.5,
            tilt: corners.measure_tilt(),
            superior_width_mm: corners.superior_left.distance_mm(corners.superior_right),
            inferior_width_mm: corners.inferior_left.distance_mm(corners.inferior_right),
            height_mm: superior.distance_mm(inferior),
        }
    }

    /// A point given along the body's own axes, from its centre.
    pub fn point(&self, left_mm: f64, up_mm: f64) -> Point {
        let p = self.centre + Frontal::new(left_mm, up_mm).rotated(self.tilt);
        [p.y_mm as f32, p.z_mm as f32]
    }
}

/// The bones and a frame for the soft tissue around them.
pub(super) struct Anatomy {
    /// L5…T1.
    pub bodies: Vec<Body>,
    /// The left and the right crest.
    pub crests: [Frontal; 2],
    /// Size of this patient over the typical one.
    pub scale: f32,
    width_mm: f32,
    height_mm: f32,
    sense: f32,
    /// The trunk's middle: at the crests and at T1, and its bow between them.
    middle: [Point; 2],
    bow_mm: f32,
}

impl Anatomy {
    pub fn of(film: &TrueFilm) -> Self {
        let image = &film.image;
        let bodies: Vec<Body> = film
            .vertebrae
            .iter()
            .map(|(&level, corners)| Body::of(level, &corners.map(|p| image.frontal(p))))
            .collect();
        let crests = [film.iliac_crests.left, film.iliac_crests.right].map(|p| image.frontal(p));
        let pelvis = film.iliac_crests.middle(image);
        let top = bodies.last().map_or(pelvis, |body| body.centre);
        let middle = [pelvis, top].map(|p| [p.y_mm as f32, p.z_mm as f32]);
        let mut anatomy = Self {
            bodies,
            crests,
            // The typical crests are 220 mm apart.
            scale: (crests[0].distance_mm(crests[1]) / 220.0) as f32,
            width_mm: (f64::from(image.columns) * spacing(image).column_mm) as f32,
            height_mm: (f64::from(image.rows) * spacing(image).row_mm) as f32,
            sense: image.frontal(Pixel::new(1.0, 0.0)).y_mm.signum() as f32,
            middle,
            bow_mm: 0.0,
        };
        // The trunk follows its spine's bow, but not the spine's curves.
        let aside =
            |body: &Body| body.centre.y_mm as f32 - anatomy.middle_at(body.centre.z_mm as f32);
        let mean =
            anatomy.bodies.iter().map(aside).sum::<f32>() / anatomy.bodies.len().max(1) as f32;
        anatomy.bow_mm = mean;
        anatomy
    }

    /// An empty grid over the film.
    pub fn layer(&self) -> Layer {
        Layer::covering(self.width_mm, self.height_mm, self.sense)
    }

    /// Height of a level's body on the film.
    pub fn height_of(&self, level: Level) -> f32 {
        self.body(level).map_or(0.0, |body| body.centre.z_mm as f32)
    }

    pub fn body(&self, level: Level) -> Option<&Body> {
        self.bodies.iter().find(|body| body.level == level)
    }

    /// The trunk's middle at a height, to the left.
    pub fn middle_at(&self, z_mm: f32) -> f32 {
        let [low, high] = self.middle;
        let part = (z_mm - low[1]) / (high[1] - low[1]).max(1.0);
        let inside = part.clamp(0.0, 1.0);
        low[0]
            + (high[0] - low[0]) * part.clamp(-0.3, 1.3)
            + 5.0 * self.bow_mm * inside * (1.0 - inside)
    }

    /// A table over levels as a function of height, with one more size at a distance above T1; sizes are for a typical
    /// patient.
    pub fn profile(&self, table: &[(Level, f32)], above_t1_mm: f32, size_mm: f32) -> Profile {
        let rows: BTreeMap<Level, f32> = table.iter().copied().collect();
        let knots = rows.into_iter().map(|(level, mm)| (self.height_of(level), mm * self.scale));
        let last = (self.height_of(Level::T1) + above_t1_mm * self.scale, size_mm * self.scale);
        Profile { knots: knots.chain([last]).collect() }
    }
}

/// A smooth function of height through given knots, constant beyond them.
pub(super) struct Profile {
    knots: Vec<(f32, f32)>,
}

impl Profile {
    pub fn at(&self, z_mm: f32) -> f32 {
        let above = self.knots.partition_point(|knot| knot.0 <= z_mm);
        match (above.checked_sub(1).map(|k| self.knots[k]), self.knots.get(above)) {
            (Some(low), Some(high)) => {
                let t = (z_mm - low.0) / (high.0 - low.0);
                low.1 + (high.1 - low.1) * t * t * (3.0 - 2.0 * t)
            }
            (Some(end), None) => end.1,
            (None, Some(&end)) => end.1,
            (None, None) => 0.0,
        }
    }
}
