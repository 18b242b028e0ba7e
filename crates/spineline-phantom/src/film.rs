//! Films of true postures: orientation and scale, and the landmarks that readers mark.

use std::collections::BTreeMap;
use std::mem::swap;

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::Rng;
use rand_distr::{Distribution, Uniform};
use spineline::analysis::{Case, Subject};
use spineline::anatomy::{ImageSide, Level, Morphometry, Posture, Side};
use spineline::measure::{
    Corners, Film, FilmLandmarks, IliacCrests, ImageGeometry, Reading, ReadingId, Spacing,
    SpacingPlane, VertebraLandmarks,
};
use spineline::spatial::{Angle, Frontal, Pixel};

use crate::proportions;
use crate::readers::{Deviation, Readers};
use crate::{Scenario, TableRow, TruePosture};

/// Meaning of large stored values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polarity {
    /// DICOM's MONOCHROME1: large values are shown dark, so bone has small ones.
    Monochrome1,
    /// DICOM's MONOCHROME2: large values are shown bright.
    Monochrome2,
}

/// One film with true places: the landmarks of a reader without error, and the content of its radiograph.
///
/// Vertebrae of the model have the places of their posture; L5 and T1, which are not read, are extrapolated from their
/// neighbours.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueFilm {
    /// The posture.
    pub posture: Posture,
    /// How the picture lies.
    pub image: ImageGeometry,
    /// A length on this film over the true one.
    pub scale: f64,
    /// Superior tips of the iliac crests.
    pub iliac_crests: IliacCrests,
    /// Corners of the bodies of L5…T1.
    pub vertebrae: BTreeMap<Level, Corners<Pixel>>,
    /// Meaning of large stored values.
    pub polarity: Polarity,
    /// The patient's side of the lead marker.
    pub marker: Side,
    /// Seed of everything random in the radiograph.
    pub seed: u64,
}

impl TrueFilm {
    pub(crate) fn coarser(&self, factor: u32) -> Self {
        let coarse = |p: Pixel| coarse(p, factor);
        Self {
            image: coarse_image(&self.image, factor),
            iliac_crests: coarse_crests(self.iliac_crests, factor),
            vertebrae: self.vertebrae.iter().map(|(&level, c)| (level, c.map(coarse))).collect(),
            ..self.clone()
        }
    }
}

/// Landmarks of a film with larger pixels.
pub(crate) fn coarsen_landmarks(landmarks: &mut FilmLandmarks, factor: u32) {
    let FilmLandmarks::Corners { image, iliac_crests, readings } = landmarks else { return };
    *image = coarse_image(image, factor);
    *iliac_crests = iliac_crests.map(|crests| coarse_crests(crests, factor));
    for landmark in readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut()) {
        landmark.corners = landmark.corners.map(|p| coarse(p, factor));
    }
}

/// Pixels are counted from the centre of the first one.
fn coarse(place: Pixel, factor: u32) -> Pixel {
    let factor = f64::from(factor);
    let coarse = |px: f64| (px - 0.5 * (factor - 1.0)) / factor;
    Pixel::new(coarse(place.column_px), coarse(place.row_px))
}

fn coarse_crests(crests: IliacCrests, factor: u32) -> IliacCrests {
    IliacCrests { left: coarse(crests.left, factor), right: coarse(crests.right, factor) }
}

fn coarse_image(image: &ImageGeometry, factor: u32) -> ImageGeometry {
    let by = f64::from(factor);
    let spacing = image.spacing.map(|spacing| Spacing {
        column_mm: by * spacing.column_mm,
        row_mm: by * spacing.row_mm,
        ..spacing
    });
    ImageGeometry { columns: image.columns / factor, rows: image.rows / factor, spacing, ..*image }
}

/// Mirrors the picture of a film. All landmarks and the patient's left move to the other side of the picture, so that
/// the film shows the same patient.
///
/// # Panics
/// If the film has locations of another program instead of landmarks.
pub fn mirror(film: &mut Film) {
    let FilmLandmarks::Corners { image, iliac_crests, readings } = &mut film.landmarks else {
        panic!("a film without a picture")
    };
    let last = f64::from(image.columns) - 1.0;
    let to = |place: Pixel| Pixel::new(last - place.column_px, place.row_px);
    image.patient_left = image.patient_left.opposite();
    *iliac_crests =
        iliac_crests.map(|one| IliacCrests { left: to(one.left), right: to(one.right) });
    for landmark in readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut()) {
        landmark.corners = landmark.corners.map(to);
        landmark.walls = landmark.walls.map(|wall| wall.map(to));
        landmark.pedicles = landmark.pedicles.map(|pedicle| pedicle.map(to));
        landmark.axis_clockwise = landmark.axis_clockwise.map(|axis| -axis);
    }
}

/// Exchanges left and right on a film: in its landmarks, which stay at their places, and in the side of the patient's
/// left. The film is as marked by someone who takes the picture for its mirror image.
///
/// # Panics
/// If the film has locations of another program instead of landmarks.
pub fn exchange_sides(film: &mut Film) {
    let FilmLandmarks::Corners { image, iliac_crests, readings } = &mut film.landmarks else {
        panic!("a film without a picture")
    };
    image.patient_left = image.patient_left.opposite();
    *iliac_crests = iliac_crests.map(|one| IliacCrests { left: one.right, right: one.left });
    for landmark in readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut()) {
        swap(&mut landmark.corners.superior_left, &mut landmark.corners.superior_right);
        swap(&mut landmark.corners.inferior_left, &mut landmark.corners.inferior_right);
        landmark.walls.reverse();
        landmark.pedicles.reverse();
    }
}

/// Makes a film of every posture and its readings.
///
/// The readers draw from `rng`, and the radiographs' seeds from `look`.
pub(crate) fn read_films(
    row: &TableRow,
    scenario: Scenario,
    length_mm: f64,
    postures: &[TruePosture],
    readers: &Readers,
    rng: &mut ChaCha12Rng,
    look: &mut ChaCha12Rng,
) -> (Case, Vec<TrueFilm>) {
    let wedges = erect_wedges(postures);
    let scale = proportions::body_scale(length_mm);
    let (films, true_films) = postures
        .iter()
        .map(|posture| {
            let placed = Placed::new(row, scale, &wedges, posture, rng);
            (placed.read(readers, rng), placed.true_film(row, look.next_u64()))
        })
        .unzip();
    let case = Case {
        id: format!("phantom-{}-{:02}", scenario.key(), row.number),
        synthetic: true,
        subject: Subject {
            sex: Some(row.sex),
            age_years: Some(f64::from(row.age_years)),
            lenke: Some(row.lenke.to_owned()),
        },
        films,
        lateral: None,
    };
    (case, true_films)
}

/// A vertebral body: corners and tilt.
type Body = (Level, Corners<Frontal>, Angle);

/// A posture on its film, in millimetres from the centre of the film's first pixel.
struct Placed {
    posture: Posture,
    image: ImageGeometry,
    /// L4…T2.
    bodies: Vec<Body>,
    /// L5 and T1.
    neighbours: [Body; 2],
    /// The left and the right iliac crest.
    crests: [Frontal; 2],
}

impl Placed {
    fn new(
        row: &TableRow,
        scale: f64,
        wedges: &[Angle],
        posture: &TruePosture,
        rng: &mut ChaCha12Rng,
    ) -> Self {
        // Patients do not stand exactly upright in front of the detector.
        let chance = Angle::from_deg(Uniform::new(-3.0, 3.0).expect("a range").sample(rng));
        let pose = posture.l4_on_film.unwrap_or(chance);
        let on_film = |point: Frontal| point.rotated(pose);
        let stands: Vec<(Frontal, Angle)> = posture
            .locations
            .iter()
            .zip(&posture.tilts)
            .map(|(&location, &tilt)| (on_film(location), tilt + pose))
            .collect();
        let bodies: Vec<Body> = Level::MODEL
            .into_iter()
            .zip(stands.iter().zip(wedges))
            .map(|(level, (&(location, tilt), &wedge))| {
                (level, body(level, location, tilt, wedge, scale), tilt)
            })
            .collect();
        let crests = [1.0, -1.0].map(|left| {
            let beside = Frontal::new(left * 110.0 * scale, 0.0).rotated(posture.crest_tilt);
            on_film(beside + Frontal::new(0.0, -5.0 * scale))
        });
        let (image, origin) = picture(row, &bodies, crests);
        let moved = |(level, corners, tilt): Body| (level, corners.map(|p| p - origin), tilt);
        Self {
            posture: posture.posture,
            image,
            bodies: bodies.into_iter().map(moved).collect(),
            neighbours: neighbours(&stands, scale).map(moved),
            crests: crests.map(|crest| crest - origin),
        }
    }

    fn iliac_crests(&self) -> IliacCrests {
        let [left, right] = self.crests.map(|crest| self.image.pixel(crest));
        IliacCrests { left, right }
    }

    fn read(&self, readers: &Readers, rng: &mut ChaCha12Rng) -> Film {
        let readings = read(&self.bodies, &self.image, readers, rng);
        let [left, right] = self.crests.map(|crest| self.image.pixel(readers.crest(crest, rng)));
        let landmarks = FilmLandmarks::Corners {
            image: self.image,
            iliac_crests: Some(IliacCrests { left, right }),
            readings,
        };
        Film::new(self.posture, landmarks)
    }

    fn true_film(&self, row: &TableRow, seed: u64) -> TrueFilm {
        let vertebrae = self
            .bodies
            .iter()
            .chain(&self.neighbours)
            .map(|(level, corners, _)| (*level, corners.map(|p| self.image.pixel(p))))
            .collect();
        // Every fourth patient's films are stored with bone dark, every seventh's carry an R.
        let inverted = row.number.is_multiple_of(4);
        TrueFilm {
            posture: self.posture,
            image: self.image,
            scale: 1.0,
            iliac_crests: self.iliac_crests(),
            vertebrae,
            polarity: if inverted { Polarity::Monochrome1 } else { Polarity::Monochrome2 },
            marker: if row.number.is_multiple_of(7) { Side::Right } else { Side::Left },
            seed,
        }
    }
}

/// The picture that contains spine and crests with a margin, and the place of its first pixel.
fn picture(row: &TableRow, bodies: &[Body], crests: [Frontal; 2]) -> (ImageGeometry, Frontal) {
    let points = bodies.iter().flat_map(|(_, corners, _)| corners.points()).chain(crests);
    let (mut low, mut high) = (crests[0], crests[0]);
    for p in points {
        low = Frontal::new(low.y_mm.min(p.y_mm), low.z_mm.min(p.z_mm));
        high = Frontal::new(high.y_mm.max(p.y_mm), high.z_mm.max(p.z_mm));
    }
    const MARGIN_MM: f64 = 40.0;
    // Every third patient's films have pixels that are not square, every fifth's are seen from the front.
    let row_spacing_mm = if row.number.is_multiple_of(3) { 0.125 } else { 0.1 };
    let patient_left =
        if row.number.is_multiple_of(5) { ImageSide::Right } else { ImageSide::Left };
    let count = |mm: f64, spacing: f64| ((mm + 2.0 * MARGIN_MM) / spacing).ceil() as u32;
    let image = ImageGeometry {
        columns: count(high.y_mm - low.y_mm, 0.1),
        rows: count(high.z_mm - low.z_mm, row_spacing_mm),
        // All films of a phantom have one scale, which is known.
        spacing: Some(Spacing {
            relative_sd: Some(0.0),
            ..Spacing::stated(0.1, row_spacing_mm, SpacingPlane::Patient)
        }),
        patient_left,
    };
    // Pixel (0, 0) lies at the upper corner of the picture.
    let corner_y = match patient_left {
        ImageSide::Left => high.y_mm + MARGIN_MM,
        ImageSide::Right => low.y_mm - MARGIN_MM,
    };
    (image, Frontal::new(corner_y, high.z_mm + MARGIN_MM))
}

/// L5 and T1, which the model lacks: one typical distance away, L5 with the tilt of L4, T1 with the rotation of T2.
fn neighbours(stands: &[(Frontal, Angle)], scale: f64) -> [Body; 2] {
    let last = stands.len() - 1;
    let next = |level: Level, from: Level, (location, tilt): (Frontal, Angle), turn: Angle| {
        let (sense, low, high) =
            if level < from { (-1.0, level, from) } else { (1.0, from, level) };
        let way = sense * scale * proportions::spacing_mm(low, high);
        let location = location + Frontal::leaning(tilt + turn * 0.5) * way;
        (level, body(level, location, tilt + turn, Angle::ZERO, scale), tilt + turn)
    };
    let turn = (stands[last].1 - stands[last - 1].1) * 0.5;
    [
        next(Level::L5, Level::L4, stands[0], Angle::ZERO),
        next(Level::T1, Level::T2, stands[last], turn),
    ]
}

fn read(
    bodies: &[Body],
    image: &ImageGeometry,
    readers: &Readers,
    rng: &mut ChaCha12Rng,
) -> Vec<Reading<VertebraLandmarks>> {
    let mut readings = Vec::new();
    for observer in 0..readers.observers {
        let name = char::from(b'A' + (observer % 26) as u8).to_string();
        let biases: Vec<Deviation> = bodies.iter().map(|_| readers.bias(rng)).collect();
        for repeat in 1..=readers.repeats {
            let vertebrae: BTreeMap<Level, VertebraLandmarks> = bodies
                .iter()
                .zip(&biases)
                .map(|((level, corners, tilt), bias)| {
                    (*level, readers.landmark(image, corners, *tilt, bias, rng))
                })
                .collect();
            readings.push(Reading { id: ReadingId::new(name.clone(), repeat), vertebrae });
        }
    }
    readings
}

/// Angle between the two endplates of every vertebra: growth of the erect spine, the same in all postures.
///
/// # Assumption
/// Half of the turn per level, as on 433 erect radiographs of adolescents (slope 0.52, decision record 0030).
fn erect_wedges(postures: &[TruePosture]) -> Vec<Angle> {
    const SHARE: f64 = 0.5;
    let erect = postures.iter().find(|posture| posture.posture == Posture::Erect);
    let tilts = erect.map_or(&[][..], |posture| &posture.tilts);
    let last = tilts.len().saturating_sub(1);
    (0..tilts.len())
        .map(|i| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(last));
            (tilts[high] - tilts[low]) * (SHARE / (high - low) as f64)
        })
        .collect()
}

/// Corners of a wedged and tapered body: its diagonals cross at its location, and both the line through the centres of its
/// endplates and the mean direction of its endplates have its tilt.
fn body(
    level: Level,
    location: Frontal,
    tilt: Angle,
    wedge: Angle,
    scale: f64,
) -> Corners<Frontal> {
    let size = Morphometry::of(level);
    let [upper, lower, height] =
        [size.superior_width_mm, size.inferior_width_mm, size.body_height_mm].map(|mm| mm * scale);
    // The longer endplate is turned less, so that the mid-points of both walls are level.
    let superior = wedge * (lower / (upper + lower));
    let sine = -superior.rad().sin() * upper / lower;
    let inferior = Angle::from_sin_cos(sine, (1.0 - sine * sine).sqrt());
    let corner = |centre_mm: f64, left_mm: f64, turn: Angle| {
        Frontal::new(0.0, centre_mm) + Frontal::new(left_mm, 0.0).rotated(turn)
    };
    let [above, below] = [0.5 * height, -0.5 * height];
    let corners = Corners {
        superior_left: corner(above, 0.5 * upper, superior),
        superior_right: corner(above, -0.5 * upper, superior),
        inferior_left: corner(below, 0.5 * lower, inferior),
        inferior_right: corner(below, -0.5 * lower, inferior),
    };
    let crossing = corners.measure_location().unwrap_or_default();
    corners.map(|p| location + (p - crossing).rotated(tilt))
}
