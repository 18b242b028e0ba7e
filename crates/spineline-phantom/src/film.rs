//! True postures → films with landmarks.

use std::collections::BTreeMap;

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Uniform};
use spineline::analysis::{Case, Subject};
use spineline::anatomy::{ImageSide, Level, Morphometry};
use spineline::measure::{
    Corners, Film, FilmMarks, IliacCrests, ImageGeometry, Mark, Reading, ReadingId, Spacing,
    SpacingPlane,
};
use spineline::spatial::{Angle, Frontal};

use crate::erect::ErectSpine;
use crate::readers::{Deviation, Readers};
use crate::{TableRow, TruePosture, Truth};

/// Takes a film of every posture and has it read.
pub(crate) fn photograph(
    row: &TableRow,
    truth: Truth,
    spine: &ErectSpine,
    postures: &[TruePosture],
    readers: &Readers,
    rng: &mut ChaCha12Rng,
) -> Case {
    let films = postures.iter().map(|posture| film(row, spine, posture, readers, rng)).collect();
    Case {
        id: format!("phantom-{}-{:02}", truth.key(), row.number),
        synthetic: true,
        subject: Subject {
            sex: Some(row.sex),
            age_years: Some(f64::from(row.age_years)),
            lenke: Some(row.lenke.to_owned()),
        },
        films,
        lateral: None,
    }
}

fn film(
    row: &TableRow,
    spine: &ErectSpine,
    posture: &TruePosture,
    readers: &Readers,
    rng: &mut ChaCha12Rng,
) -> Film {
    // Patients never stand quite straight before the detector.
    let pose = Angle::from_deg(Uniform::new(-3.0, 3.0).expect("a range").sample(rng));
    let on_film = |point: Frontal| point.rotated(pose);
    let bodies: Vec<(Level, Corners<Frontal>, Angle)> = Level::MODEL
        .into_iter()
        .zip(posture.locations.iter().zip(&posture.tilts))
        .map(|(level, (&location, &tilt))| {
            let tilt = tilt + pose;
            (level, body(level, on_film(location), tilt, spine), tilt)
        })
        .collect();
    let scale = body_scale(spine);
    let crests = [1.0, -1.0].map(|left| on_film(Frontal::new(left * 110.0 * scale, -5.0 * scale)));
    // The picture holds spine and crests with a margin.
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
        spacing: Some(Spacing::stated(0.1, row_spacing_mm, SpacingPlane::Patient)),
        patient_left,
    };
    // Pixel (0, 0) lies at the upper corner of the picture.
    let corner_y = match patient_left {
        ImageSide::Left => high.y_mm + MARGIN_MM,
        ImageSide::Right => low.y_mm - MARGIN_MM,
    };
    let origin = Frontal::new(corner_y, high.z_mm + MARGIN_MM);
    let placed: Vec<_> =
        bodies.iter().map(|(level, c, tilt)| (*level, c.map(|p| p - origin), *tilt)).collect();
    let [left, right] = crests.map(|crest| image.pixel(crest - origin));
    let marks = FilmMarks::Landmarks {
        image,
        iliac_crests: Some(IliacCrests { left, right }),
        readings: read(&placed, &image, readers, rng),
    };
    Film { posture: posture.posture, marks }
}

fn read(
    bodies: &[(Level, Corners<Frontal>, Angle)],
    image: &ImageGeometry,
    readers: &Readers,
    rng: &mut ChaCha12Rng,
) -> Vec<Reading<Mark>> {
    let mut readings = Vec::new();
    for observer in 0..readers.observers {
        let name = char::from(b'A' + (observer % 26) as u8).to_string();
        let biases: Vec<Deviation> = bodies.iter().map(|_| readers.bias(rng)).collect();
        for repeat in 1..=readers.repeats {
            let vertebrae: BTreeMap<Level, Mark> = bodies
                .iter()
                .zip(&biases)
                .map(|((level, corners, tilt), bias)| {
                    (*level, readers.mark(image, corners, *tilt, bias, rng))
                })
                .collect();
            readings.push(Reading { id: ReadingId::new(name.clone(), repeat), vertebrae });
        }
    }
    readings
}

/// How much larger this spine is than the typical one.
fn body_scale(spine: &ErectSpine) -> f64 {
    let typical: f64 = Level::MODEL.windows(2).map(|p| Morphometry::spacing_mm(p[0], p[1])).sum();
    spine.length_mm / typical
}

/// Corners of a body whose diagonals cross at its location.
fn body(level: Level, location: Frontal, tilt: Angle, spine: &ErectSpine) -> Corners<Frontal> {
    let scale = body_scale(spine);
    let size = Morphometry::of(level);
    let [upper, lower, height] =
        [size.superior_width_mm, size.inferior_width_mm, size.body_height_mm].map(|mm| mm * scale);
    // The diagonals of a trapezium divide its height as its sides.
    let above = height * upper / (upper + lower);
    let below = height - above;
    let corner = |left: f64, up: f64| location + Frontal::new(left, up).rotated(tilt);
    Corners {
        superior_left: corner(0.5 * upper, above),
        superior_right: corner(-0.5 * upper, above),
        inferior_left: corner(0.5 * lower, -below),
        inferior_right: corner(-0.5 * lower, -below),
    }
}
