//! Spines in space, and their frontal and lateral films: vertebral bodies as elliptic prisms on a space curve, with the
//! same projection in both views.

mod bends;

pub use bends::{BentPhantom, SpaceBending, generate_bends_in_space};

use std::collections::BTreeMap;
use std::f64::consts::PI;

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use spineline::analysis::Case;
use spineline::anatomy::{ImageSide, Level, Morphometry, Posture};
use spineline::measure::{
    Corners, Film, FilmLandmarks, IliacCrests, ImageGeometry, LateralFilm, Reading, ReadingId,
    Spacing, SpacingPlane, VertebraLandmarks,
};
use spineline::spatial::{Angle, Pixel, Vec3};

use crate::proportions;

/// Sagittal shapes: four types of the healthy spine and the flat back of scoliosis.
///
/// # References
/// [roussouly-2005] for the types; sizes within their usual ranges (assumption).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SagittalShape {
    /// Type 1: a short lordosis and a long thoracolumbar kyphosis.
    LongKyphosis,
    /// Type 2: flat.
    Flat,
    /// Type 3: balanced.
    Balanced,
    /// Type 4: a long and large lordosis.
    LongLordosis,
    /// Thoracic hypokyphosis, as in adolescent idiopathic scoliosis.
    Hypokyphotic,
}

impl SagittalShape {
    /// Every shape.
    pub const ALL: [Self; 5] =
        [Self::LongKyphosis, Self::Flat, Self::Balanced, Self::LongLordosis, Self::Hypokyphotic];

    /// Kyphosis and lordosis on the lateral film in degrees, and the part of the spine below the inflection between
    /// them.
    const fn sizes(self) -> (f64, f64, f64) {
        match self {
            Self::LongKyphosis => (55.0, 38.0, 0.20),
            Self::Flat => (32.0, 38.0, 0.32),
            Self::Balanced => (45.0, 52.0, 0.32),
            Self::LongLordosis => (50.0, 68.0, 0.42),
            Self::Hypokyphotic => (10.0, 45.0, 0.34),
        }
    }
}

/// How a reader finds the ends of an endplate that is seen obliquely.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndplateHabit {
    /// The two ends of the outline of its rim, along the long axis of that ellipse.
    Rim,
    /// The ends of the line through its middle, from front to back or from left to right.
    MiddleLine,
}

/// Properties of a phantom in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceSetup {
    /// Shape from the side.
    pub shape: SagittalShape,
    /// Largest tilt of a vertebra on the frontal film.
    pub largest_tilt: Angle,
    /// Axial rotation at the apex.
    pub apical_rotation: Angle,
    /// How endplates are read.
    pub habit: EndplateHabit,
    /// Whether the pedicles are read too.
    pub pedicles: bool,
    /// Standard deviation of a coordinate of a corner, on the film.
    pub corner_sd_mm: f64,
    /// A length on the lateral film over the same length on the frontal film.
    pub lateral_scale: f64,
    /// Rotation of the lateral film; positive if the spine looks more flexed than it is.
    pub lateral_turn: Angle,
    /// Number of the phantom: seed of the noise, and sides of the pictures.
    pub seed: u64,
}

impl Default for SpaceSetup {
    fn default() -> Self {
        Self {
            shape: SagittalShape::Balanced,
            largest_tilt: Angle::from_deg(25.0),
            apical_rotation: Angle::ZERO,
            habit: EndplateHabit::MiddleLine,
            pedicles: false,
            corner_sd_mm: 0.0,
            lateral_scale: 1.0,
            lateral_turn: Angle::ZERO,
            seed: 0,
        }
    }
}

/// One vertebral body in the upright frame of the films: anterior, left, cranial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueBody {
    /// Which one.
    pub level: Level,
    /// Its middle.
    pub midpoint_mm: Vec3,
    /// Unit vectors to its front, to its left and along its axis.
    pub anterior: Vec3,
    /// To its left.
    pub left: Vec3,
    /// Along its axis.
    pub cranial: Vec3,
    /// Axial rotation about its axis, zero where its left lies in the frontal plane.
    pub axial: Angle,
    /// Half of its width, depth and height.
    half_mm: [f64; 3],
}

impl TrueBody {
    /// Places of the centres of its pedicles: beside its sagittal plane, and behind its middle.
    ///
    /// # Assumption
    /// The widths of canals and pedicles are from [panjabi-1991] and [panjabi-1992], the depth is half the body's depth
    /// plus 4 mm. The library reads axial rotation with ratios from CT, so its reading of these bodies has a known
    /// bias.
    #[must_use]
    pub fn pedicle_mm(&self) -> [f64; 2] {
        proportions::pedicle_mm(self.level)
    }
}

/// A synthetic patient in space with an erect film from the front and one from the side.
#[derive(Debug, Clone, PartialEq)]
pub struct SpacePhantom {
    /// The films as they were read.
    pub case: Case,
    /// True bodies, L5 to T1.
    pub bodies: Vec<TrueBody>,
}

impl SpacePhantom {
    /// The body of a level.
    #[must_use]
    pub fn body(&self, level: Level) -> Option<&TrueBody> {
        self.bodies.iter().find(|body| body.level == level)
    }
}

/// Makes one phantom in space.
#[must_use]
pub fn generate_in_space(setup: &SpaceSetup) -> SpacePhantom {
    let bodies = bodies(setup);
    let mut marker = Marker::new(setup, 0);
    let frontal = View::frontal(setup);
    let lateral = View {
        across: Vec3::x(),
        scale: setup.lateral_scale,
        turn: setup.lateral_turn,
        side: if setup.seed.is_multiple_of(3) { ImageSide::Right } else { ImageSide::Left },
    };
    let [from_front, from_side] =
        [&frontal, &lateral].map(|view| marker.read(view, &bodies, setup.habit));
    let crests = marker.crests(&frontal, &bodies[0]);
    let mut film = frontal_film(&frontal, Posture::Erect, from_front, crests);
    if setup.pedicles {
        let readings = film.landmarks.corner_readings_mut();
        for (body, landmark) in bodies.iter().zip(readings[0].vertebrae.values_mut()) {
            let places = frontal.pedicles(body);
            landmark.pedicles = places.map(|place| Some(frontal.pixel(marker.noise(place))));
        }
    }
    let case = Case {
        synthetic: true,
        lateral: Some(lateral_film(&lateral, from_side)),
        ..Case::of_films(format!("phantom-space-{}", setup.seed), vec![film])
    };
    SpacePhantom { case, bodies }
}

/// Reads places on films, each coordinate with an error.
struct Marker {
    rng: ChaCha12Rng,
    sd_mm: f64,
}

impl Marker {
    /// `stream` differs between the films of a phantom.
    fn new(setup: &SpaceSetup, stream: u64) -> Self {
        let mut rng = ChaCha12Rng::seed_from_u64(setup.seed);
        rng.set_stream(stream);
        Self { rng, sd_mm: setup.corner_sd_mm }
    }

    fn noise(&mut self, place: [f64; 2]) -> [f64; 2] {
        place.map(|mm| {
            let deviate: f64 = StandardNormal.sample(&mut self.rng);
            mm + self.sd_mm * deviate
        })
    }

    fn read(
        &mut self,
        view: &View,
        bodies: &[TrueBody],
        habit: EndplateHabit,
    ) -> BTreeMap<Level, Corners<Pixel>> {
        let mut corners = |body: &TrueBody| {
            Corners::from(view.corners(body, habit).map(|place| view.pixel(self.noise(place))))
        };
        bodies.iter().map(|body| (body.level, corners(body))).collect()
    }

    /// Level crests beside L5, read without error.
    fn crests(&self, view: &View, l5: &TrueBody) -> IliacCrests {
        let at = |left_mm: f64| view.pixel(view.seen(l5.midpoint_mm + Vec3::y() * left_mm));
        IliacCrests { left: at(CREST_MM), right: at(-CREST_MM) }
    }
}

/// Half of the distance of the crests of an adolescent (assumption).
const CREST_MM: f64 = 120.0;

/// Bodies on a space curve of given slopes `dx/dz` and `dy/dz`.
fn bodies(setup: &SpaceSetup) -> Vec<TrueBody> {
    let (kyphosis, lordosis, share) = setup.shape.sizes();
    let last = (Level::ALL.len() - 1) as f64;
    // As on the films: flexion and tilt to the left.
    let forward = |t: f64| {
        let lowest = -0.5 * kyphosis;
        let flexion = if t < share {
            lowest + 0.5 * lordosis * (1.0 + (PI * t / share).cos())
        } else {
            lowest + 0.5 * kyphosis * (1.0 - (PI * (t - share) / (1.0 - share)).cos())
        };
        Angle::from_deg(flexion).rad().tan()
    };
    let phase = |t: f64| 2.2 * PI * t;
    let sideways = |t: f64| (setup.largest_tilt * phase(t).sin()).rad().tan();
    let mut bodies: Vec<TrueBody> = Vec::new();
    for (i, level) in Level::ALL.into_iter().enumerate() {
        let t = i as f64 / last;
        let cranial = Vec3::new(forward(t), sideways(t), 1.0).normalize();
        let midpoint_mm = bodies.last().map_or_else(Vec3::zeros, |below| {
            let way = (below.cranial + cranial).normalize();
            below.midpoint_mm + way * proportions::spacing_mm(below.level, level)
        });
        let axial = setup.apical_rotation * phase(t).cos();
        let left = cranial.cross(&Vec3::x()).normalize();
        let anterior = left.cross(&cranial);
        let (sin, cos) = axial.rad().sin_cos();
        let size = Morphometry::of(level);
        bodies.push(TrueBody {
            level,
            midpoint_mm,
            anterior: anterior * cos + left * sin,
            left: left * cos - anterior * sin,
            cranial,
            axial,
            half_mm: [size.superior_width_mm, size.superior_depth_mm, size.body_height_mm]
                .map(|mm| 0.5 * mm),
        });
    }
    bodies
}

/// A direction of view, and the orientation of its film.
struct View {
    /// Horizontal direction of the film: the patient's left, or the front.
    across: Vec3,
    scale: f64,
    turn: Angle,
    /// Side of the picture to which `across` points.
    side: ImageSide,
}

const COLUMNS: u32 = 5000;
const ROWS: u32 = 7000;
const PIXEL_MM: f64 = 0.1;

impl View {
    fn frontal(setup: &SpaceSetup) -> Self {
        Self {
            across: Vec3::y(),
            scale: 1.0,
            turn: Angle::ZERO,
            side: if setup.seed.is_multiple_of(2) { ImageSide::Left } else { ImageSide::Right },
        }
    }

    /// Projection of a vector to the film: across and up. Both views use only this projection.
    fn seen(&self, vector: Vec3) -> [f64; 2] {
        let (across, up) = (vector.dot(&self.across), vector.z);
        let (sin, cos) = self.turn.rad().sin_cos();
        [across * cos + up * sin, up * cos - across * sin].map(|mm| mm * self.scale)
    }

    /// Both ends of the superior and of the inferior endplate; the end towards `across` comes first.
    fn corners(&self, body: &TrueBody, habit: EndplateHabit) -> [[f64; 2]; 4] {
        let [half_width, half_depth, half_height] = body.half_mm;
        let (across, along) = (body.left * half_width, body.anterior * half_depth);
        let end = match habit {
            EndplateHabit::Rim => long_axis(self.seen(across), self.seen(along)),
            EndplateHabit::MiddleLine => {
                let is_frontal = self.across.y > 0.5;
                self.seen(if is_frontal { across } else { along })
            }
        };
        let end = if end[0] < 0.0 { end.map(|mm| -mm) } else { end };
        let centre =
            |sense: f64| self.seen(body.midpoint_mm + body.cranial * (sense * half_height));
        let [above, below] = [centre(1.0), centre(-1.0)];
        let add =
            |centre: [f64; 2], sense: f64| [centre[0] + sense * end[0], centre[1] + sense * end[1]];
        [add(above, 1.0), add(above, -1.0), add(below, 1.0), add(below, -1.0)]
    }

    /// The left and the right pedicle.
    fn pedicles(&self, body: &TrueBody) -> [[f64; 2]; 2] {
        let [beside_mm, behind_mm] = body.pedicle_mm();
        [beside_mm, -beside_mm].map(|left_mm| {
            self.seen(body.midpoint_mm + body.left * left_mm - body.anterior * behind_mm)
        })
    }

    /// The picture; a film from the side has the front in place of the left.
    fn image(&self) -> ImageGeometry {
        ImageGeometry {
            columns: COLUMNS,
            rows: ROWS,
            spacing: Some(spacing()),
            patient_left: self.side,
        }
    }

    /// The lowest midpoint lies in the lower middle of the picture.
    fn pixel(&self, [across, up]: [f64; 2]) -> Pixel {
        let sense = if self.side == ImageSide::Right { 1.0 } else { -1.0 };
        let (middle, low) = (f64::from(COLUMNS) / 2.0, f64::from(ROWS) - 700.0);
        Pixel::new(middle + sense * across / PIXEL_MM, low - up / PIXEL_MM)
    }
}

/// Half of the long axis of the ellipse with these conjugate half-diameters.
fn long_axis(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let dot = |p: [f64; 2], q: [f64; 2]| p[0] * q[0] + p[1] * q[1];
    // The maximum of the distance of a cos t + b sin t from the centre.
    let twice = Angle::from_sin_cos(2.0 * dot(a, b), dot(a, a) - dot(b, b));
    let (sin, cos) = (0.5 * twice.rad()).sin_cos();
    [a[0] * cos + b[0] * sin, a[1] * cos + b[1] * sin]
}

fn spacing() -> Spacing {
    Spacing { relative_sd: Some(0.0), ..Spacing::stated(PIXEL_MM, PIXEL_MM, SpacingPlane::Patient) }
}

fn frontal_film(
    view: &View,
    posture: Posture,
    read: BTreeMap<Level, Corners<Pixel>>,
    crests: IliacCrests,
) -> Film {
    let clicked = |(level, corners)| (level, VertebraLandmarks::clicked(corners));
    let (image, vertebrae) = (view.image(), read.into_iter().map(clicked));
    let readings = vec![Reading { id: ReadingId::new("A", 1), vertebrae: vertebrae.collect() }];
    let landmarks = FilmLandmarks::Corners { image, iliac_crests: Some(crests), readings };
    Film::new(posture, landmarks)
}

fn lateral_film(view: &View, vertebrae: BTreeMap<Level, Corners<Pixel>>) -> LateralFilm {
    LateralFilm {
        image: view.image(),
        simultaneous: false,
        readings: vec![Reading { id: ReadingId::new("A", 1), vertebrae }],
    }
}
