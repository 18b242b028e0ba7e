//! Drawn films agree with the phantom's geometry, which is the oracle.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use spineline::anatomy::{ImageSide, Level, Posture, Side};
use spineline::measure::{Corners, IliacCrests};
use spineline::spatial::Pixel;
use spineline_phantom::{Phantom, Polarity, Radiograph, Readers, Scenario, TrueFilm, generate};

fn phantom(number: usize) -> Phantom {
    generate(number - 1, Scenario::Bend, &Readers::exact(), 1).unwrap()
}

/// Brightness of a film at a place, between pixels.
fn bright(film: &Radiograph, column: f64, row: f64) -> f64 {
    let (c, r) = (column.floor(), row.floor());
    let at = |c: f64, r: f64| {
        let value = film.pixels[r as usize * film.image.columns as usize + c as usize];
        match film.polarity {
            Polarity::Monochrome1 => 4095.0 - f64::from(value),
            Polarity::Monochrome2 => f64::from(value),
        }
    };
    let (x, y) = (column - c, row - r);
    (1.0 - y) * ((1.0 - x) * at(c, r) + x * at(c + 1.0, r))
        + y * ((1.0 - x) * at(c, r + 1.0) + x * at(c + 1.0, r + 1.0))
}

/// Mean brightness of all blocks of this number of columns and rows.
fn blocks(film: &Radiograph, columns: usize, rows: usize) -> Vec<Vec<f64>> {
    let width = film.image.columns as usize;
    let lines: Vec<&[u16]> = film.pixels.chunks_exact(width).collect();
    let mean = |band: &[&[u16]], from: usize| {
        let sum: f64 =
            band.iter().flat_map(|l| &l[from..from + columns]).map(|&v| f64::from(v)).sum();
        sum / (columns * rows) as f64
    };
    lines
        .chunks_exact(rows)
        .map(|band| (0..width / columns).map(|k| mean(band, k * columns)).collect())
        .collect()
}

/// Mean difference of the blocks of both.
fn apart(one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    let pairs = one.iter().zip(other).flat_map(|(a, b)| a.iter().zip(b));
    let differences: Vec<f64> = pairs.map(|(a, b)| (a - b).abs()).collect();
    differences.iter().sum::<f64>() / differences.len() as f64
}

/// Distance of the steepest rise of brightness towards the body from an endplate's true centre, in mm along the axis.
fn edge_error_mm(drawn: &Radiograph, corners: &Corners<Pixel>, superior: bool) -> f64 {
    let image = &drawn.image;
    let c = corners.map(|p| image.frontal(p));
    let (left, right, far) = if superior {
        (c.superior_left, c.superior_right, (c.inferior_left + c.inferior_right) * 0.5)
    } else {
        (c.inferior_left, c.inferior_right, (c.superior_left + c.superior_right) * 0.5)
    };
    let centre = (left + right) * 0.5;
    let along = (left - right) * (1.0 / left.distance_mm(right));
    let inwards = (far - centre) * (1.0 / far.distance_mm(centre));
    // The middle of the endplate, where it runs through its centre.
    let mean = |depth_mm: f64| {
        let across = (-30..=30).map(|k| f64::from(k) * 0.05);
        let values = across.map(|mm| {
            let p = image.pixel(centre + along * mm + inwards * depth_mm);
            bright(drawn, p.column_px, p.row_px)
        });
        values.sum::<f64>() / 61.0
    };
    const STEP_MM: f64 = 0.02;
    let rise = |k: i32| {
        let depth_mm = f64::from(k) * STEP_MM;
        mean(depth_mm + 0.1) - mean(depth_mm - 0.1)
    };
    let best = (-60..=60).max_by(|&a, &b| rise(a).total_cmp(&rise(b))).unwrap();
    f64::from(best) * STEP_MM
}

#[test]
fn endplates_are_drawn_at_their_true_places() {
    // Square pixels; pixels that are not square, stored with dark bone, too.
    for (number, posture) in
        [(1, Posture::Erect), (12, Posture::LeftBending), (5, Posture::Traction)]
    {
        let phantom = phantom(number);
        let film = phantom.film(posture).unwrap();
        let drawn = phantom.radiograph(posture).unwrap();
        for level in [Level::L4, Level::L2, Level::T12, Level::T9, Level::T6, Level::T2, Level::T1]
        {
            for superior in [true, false] {
                let error_mm = edge_error_mm(&drawn, &film.vertebrae[&level], superior);
                // One pixel.
                assert!(
                    error_mm.abs() <= 0.1,
                    "subject {number} {posture} {level}, superior {superior}: {error_mm} mm"
                );
            }
        }
    }
}

#[test]
fn true_films_equal_a_reading_without_error() {
    let phantom = phantom(3);
    for (film, marked) in phantom.films.iter().zip(&phantom.case.films) {
        let spineline::measure::FilmLandmarks::Corners { image, readings, iliac_crests } =
            &marked.landmarks
        else {
            panic!("phantoms are marked with corners");
        };
        assert_eq!(film.image, *image);
        assert_eq!(Some(film.iliac_crests), *iliac_crests);
        for (level, landmark) in &readings[0].vertebrae {
            assert_eq!(film.vertebrae[level], landmark.corners);
        }
        assert_eq!(film.vertebrae.len(), 17);
    }
}

#[test]
fn the_lead_marker_lies_on_the_side_that_it_names() {
    // Seen from behind; seen from the front; a marker R.
    for (number, side) in [(1, Side::Left), (5, Side::Left), (7, Side::Right)] {
        let film = &phantom(number).films[0];
        assert_eq!(film.marker, side);
        let drawn = Radiograph::of(film);
        let width = film.image.columns as usize;
        let upper = &drawn.pixels[..drawn.pixels.len() / 2];
        let saturated: Vec<usize> =
            (0..upper.len()).filter(|&k| upper[k] == 4095).map(|k| k % width).collect();
        assert!(saturated.len() > 1000, "a marker is there");
        let on_left = (side == Side::Left) == (film.image.patient_left == ImageSide::Left);
        for column in saturated {
            assert_eq!(column < width / 2, on_left);
        }
    }
}

#[test]
fn every_film_is_labelled_synthetic_in_its_lower_corner() {
    let film = &phantom(1).films[0];
    let drawn = Radiograph::of(film);
    let width = film.image.columns as usize;
    let lower = film.image.rows as usize - 160;
    let corner = drawn.pixels.chunks_exact(width).skip(lower).flat_map(|line| &line[100..440]);
    // Counted by hand, the nine letters have 15 + 10 + 17 + 11 + 17 + 18 + 11 + 11 + 13 dots of 6 × 6 pixels.
    let lit = corner.filter(|&&value| value == 4095).count();
    assert_eq!(lit, 123 * 36);
}

fn moved(
    film: &TrueFilm,
    to: impl Fn(Pixel) -> Pixel,
) -> (IliacCrests, BTreeMap<Level, Corners<Pixel>>) {
    let crests =
        IliacCrests { left: to(film.iliac_crests.left), right: to(film.iliac_crests.right) };
    (crests, film.vertebrae.iter().map(|(&level, c)| (level, c.map(&to))).collect())
}

#[test]
fn a_mirrored_film_is_drawn_mirrored() {
    let film = phantom(1).films[1].clone();
    let last = f64::from(film.image.columns) - 1.0;
    let (iliac_crests, vertebrae) = moved(&film, |p| Pixel::new(last - p.column_px, p.row_px));
    let mut mirrored = TrueFilm { iliac_crests, vertebrae, ..film.clone() };
    mirrored.image.patient_left = ImageSide::Right;
    let (one, other) = (Radiograph::of(&film), Radiograph::of(&mirrored));
    let mut turned = other.clone();
    let width = film.image.columns as usize;
    turned.pixels.chunks_exact_mut(width).for_each(<[u16]>::reverse);
    // Quanta, clutter and the upright word differ; the rest is a mirror image.
    let right = apart(&blocks(&one, 20, 20), &blocks(&turned, 20, 20));
    let wrong = apart(&blocks(&one, 20, 20), &blocks(&other, 20, 20));
    assert!(right < 25.0 && wrong > 10.0 * right, "{right} and {wrong} of 4095");
}

#[test]
fn a_film_with_other_rows_shows_the_same_at_the_same_millimetre() {
    let film = phantom(1).films[0].clone();
    let (iliac_crests, vertebrae) = moved(&film, |p| Pixel::new(p.column_px, 0.5 * p.row_px));
    let mut coarse = TrueFilm { iliac_crests, vertebrae, ..film.clone() };
    coarse.image.spacing.as_mut().expect("a spacing").row_mm *= 2.0;
    coarse.image.rows /= 2;
    let (fine, coarse) = (Radiograph::of(&film), Radiograph::of(&coarse));
    // Blocks of 2 mm. They are at most half a row of 0.2 mm apart.
    let difference = apart(&blocks(&fine, 20, 20), &blocks(&coarse, 20, 10));
    assert!(difference < 8.0, "{difference} of 4095");
}

#[test]
fn pixels_do_not_depend_on_the_number_of_threads() {
    let film = phantom(5).films[2].clone();
    let drawn = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Radiograph::of(&film))
    };
    assert!(drawn(1) == drawn(3));
}

#[test]
fn relative_noise_is_larger_where_fewer_quanta_arrive() {
    let film = &phantom(1).films[0];
    let drawn = Radiograph::of(film);
    // Differences of neighbours two columns apart: the contribution of tissue is small against the quanta.
    let noise = |level: Level, left_mm: f64| {
        let c = film.vertebrae[&level].map(|p| film.image.frontal(p));
        let centre = (c.superior_left + c.inferior_right) * 0.5;
        let p = film.image.pixel(centre + spineline::spatial::Frontal::new(left_mm, 0.0));
        let mut sum = 0.0;
        for k in 0..4000 {
            let (column, row) = (p.column_px + f64::from(k % 80), p.row_px + f64::from(k / 80));
            let at = |c: f64| bright(&drawn, c.round(), row.round());
            sum += (at(column) - at(column + 2.0)).powi(2);
        }
        (sum / 8000.0).sqrt()
    };
    let (lung, abdomen) = (noise(Level::T6, 55.0), noise(Level::L3, 50.0));
    assert!(abdomen > 1.5 * lung, "{abdomen} and {lung}");
}
