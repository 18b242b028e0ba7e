//! Comparison of this port with the reference of the training (`training/landmarks/reference.py`): the same drawn spine
//! in both.

use serde_json::Value;
use spineline::anatomy::ImageSide;
use spineline::measure::Corners;

use crate::Picture;
use crate::chain::chain_of;
use crate::grid::{Grid, coarse_input};
use crate::kernel::Map;
use crate::peaks::{Peak, peaks_of};
use crate::{FINE, patches, weights};

const SIZE: [usize; 2] = [700, 1900];
/// The reference is rounded to 1e-6, and sums of f32 have another order.
const TOLERANCE: f64 = 2e-3;
/// Places depend on those values.
const TOLERANCE_CELLS: f64 = 0.02;

fn reference() -> Value {
    serde_json::from_str(include_str!("reference.json")).expect("the reference is JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

/// A drawn trunk: darker lungs with ribs, and 17 blocks with pedicles along a curve.
fn drawn() -> Vec<f32> {
    let [width, height] = SIZE.map(|size| size as f64);
    let pixel = |index: usize| {
        let (x, y) = ((index % SIZE[0]) as f64 + 0.5, (index / SIZE[0]) as f64 + 0.5);
        let aside = (x - width / 2.0).abs();
        let lung = (-((y / height - 0.33) / 0.16).powi(4)).exp();
        let mut grey =
            90.0 + 60.0 * y / height - 80.0 * lung * (1.0 - (-(aside / 150.0).powi(4)).exp());
        if aside > 70.0 {
            let ribs = ((y - 0.25 * aside) * std::f64::consts::TAU / 90.0).cos();
            grey += 25.0 * lung * ribs.clamp(0.0, 1.0);
        }
        let grey = (0..17).fold(grey, |grey, block| grey + bright(block, x, y));
        (grey.clamp(0.0, 255.0) + 0.5).floor() as f32
    };
    (0..SIZE[0] * SIZE[1]).map(pixel).collect()
}

fn bright(block: i32, x: f64, y: f64) -> f64 {
    let t = f64::from(block) / 16.0;
    let step = 1640.0 * (0.72 + 0.56 * t) / 16.0;
    let cx = SIZE[0] as f64 / 2.0 + 70.0 * (4.2 * t).sin();
    let cy = 110.0 + 1640.0 * (0.72 * t + 0.28 * t * t);
    // The angle's tangent is its slope.
    let slope = 70.0 * 4.2 * (4.2 * t).cos() / (16.0 * step);
    let (cos, sin) = (1.0 / slope.hypot(1.0), slope / slope.hypot(1.0));
    let (high, wide) = (0.73 * step / 2.0, 1.7 * 0.73 * step / 2.0);
    let (u, v) = ((x - cx) * cos - (y - cy) * sin, (x - cx) * sin + (y - cy) * cos);
    let out = (u.abs() / wide).max(v.abs() / high);
    let body = ((1.1 - out) / 0.2).clamp(0.0, 1.0);
    let pedicle = |side: f64| {
        let (across, along) =
            ((u - side * 0.72 * wide) / (0.16 * wide), (v + 0.1 * high) / (0.34 * high));
        30.0 * (-((across.hypot(along) - 1.0) / 0.35).powi(2)).exp()
    };
    body * (35.0 + 20.0 * ((out - 0.75) * 4.0).clamp(0.0, 1.0)) + pedicle(-1.0) + pedicle(1.0)
}

fn picture(values: &[f32]) -> Picture<'_> {
    let [columns, rows] = SIZE;
    Picture { columns, rows, pixel_aspect: 1.0, patient_left: ImageSide::Left, values }
}

/// Compares a flattened array with its samples.
fn assert_samples(name: &str, values: &[f32], samples: &Value) {
    for (at, expected) in list(&samples["indices"]).iter().zip(list(&samples["values"])) {
        let at = at.as_u64().expect("an index") as usize;
        let off = (f64::from(values[at]) - number(expected)).abs();
        let limit = TOLERANCE * (1.0 + number(expected).abs());
        assert!(off < limit, "{name}[{at}]: {} and {expected}", values[at]);
    }
}

/// Channel by channel, in the order of the reference.
fn by_channel(map: &Map) -> Vec<f32> {
    let channel = |channel: usize| map.values.iter().skip(channel).step_by(map.channels).copied();
    (0..map.channels).flat_map(channel).collect()
}

#[test]
fn grids_maps_peaks_and_chain_are_those_of_the_reference() {
    let (reference, values) = (reference(), drawn());
    let sum: f64 = values.iter().map(|&value| f64::from(value)).sum();
    let expected = number(&reference["film"]["sum"]);
    assert!((sum - expected).abs() < 1e-5 * expected, "the same film but for roundings of half");
    let coarse = coarse_input(&picture(&values));
    assert_samples("coarse", &coarse.grid.values, &reference["coarse"]);
    let map = weights::film(coarse.grid.clone());
    assert_samples("film_out", &by_channel(&map), &reference["film_out"]);
    let peaks = peaks_of(&map);
    assert_eq!(peaks.len(), list(&reference["peaks"]).len());
    for (peak, expected) in peaks.iter().zip(list(&reference["peaks"])) {
        assert!((peak.probability - number(&expected[2])).abs() < TOLERANCE);
        for axis in [0, 1] {
            assert!((peak.centre[axis] - number(&expected[axis])).abs() < TOLERANCE_CELLS);
        }
    }
    assert_chain(&peaks, &reference);
}

/// Compares the chain of some centres with the reference's.
fn assert_chain(peaks: &[Peak], expected: &Value) {
    let chain = chain_of(peaks, None).expect("a chain");
    assert_eq!(chain.peaks.len(), list(&expected["chain"]).len());
    assert_eq!(Some(chain.first_level as u64), expected["first_level"].as_u64());
    let [probability, other] = [0, 2].map(|i| number(&expected["count"][i]));
    assert!((chain.count.probability - probability).abs() < TOLERANCE, "{}", chain.count);
    assert_eq!(Some(chain.count.other_shift as i64), expected["count"][1].as_i64());
    assert!((chain.count.other_probability - other).abs() < TOLERANCE, "{}", chain.count);
    for (peak, expected) in chain.peaks.iter().zip(list(&expected["chain"])) {
        assert!((peak.centre[1] - number(&expected[1])).abs() < TOLERANCE_CELLS);
        assert_eq!(Some(peak.is_seen), expected[2].as_bool());
    }
}

#[test]
fn a_made_chain_with_a_gap_and_false_centres_is_that_of_the_reference() {
    let made = &reference()["made"];
    let peak = |stated: &Value| {
        let corner = |k: usize| [0, 1].map(|axis| number(&stated["corners"][k][axis]));
        let corners = [0, 1, 2, 3].map(corner);
        Peak {
            centre: [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0),
            corners,
            probability: number(&stated["probability"]),
            levels: std::array::from_fn(|level| number(&stated["levels"][level])),
            is_seen: true,
        }
    };
    let peaks: Vec<Peak> = list(&made["peaks"]).iter().map(peak).collect();
    assert_chain(&peaks, made);
}

#[test]
fn corners_in_patches_are_those_of_the_reference() {
    let (reference, values) = (reference(), drawn());
    let fine = Grid::reduced(&picture(&values), FINE);
    assert_samples("fine", &fine.values, &reference["fine"]);
    let place = |value: &Value| [number(&value[0]), number(&value[1])];
    let centres: Vec<[f64; 2]> = list(&reference["patch_centres"]).iter().map(place).collect();
    let bodies = patches::corners(&fine, &centres);
    let expected = list(&reference["patch_corners"]).iter().zip(list(&reference["patch_spreads"]));
    for (body, (corners, spreads)) in bodies.iter().zip(expected) {
        for (corner, expected) in body.corners.iter().zip(list(corners)) {
            let [x, y] = place(expected);
            assert!((corner[0] - x).hypot(corner[1] - y) < TOLERANCE_CELLS);
        }
        let squares = list(spreads).iter().map(|spread| number(spread).powi(2));
        let sd = (squares.sum::<f64>() / 4.0).sqrt() * number(&reference["sd_factor"]);
        assert!((body.sd - sd).abs() < TOLERANCE * (1.0 + sd), "{} and {sd}", body.sd);
    }
}

#[test]
fn a_film_of_oblong_pixels_has_the_grid_of_square_ones() {
    let values = drawn();
    let square = coarse_input(&picture(&values));
    // Means of two rows: pixels twice as high as wide.
    let half: Vec<f32> = values
        .chunks_exact(2 * SIZE[0])
        .flat_map(|rows| (0..SIZE[0]).map(|column| 0.5 * (rows[column] + rows[SIZE[0] + column])))
        .collect();
    let oblong =
        Picture { rows: SIZE[1] / 2, pixel_aspect: 2.0, values: &half, ..picture(&values) };
    let oblong = coarse_input(&oblong);
    assert_eq!(square.corner, oblong.corner);
    assert!((2.0 * square.scale[1] - oblong.scale[1]).abs() < 1e-12);
    for (a, b) in square.grid.values.iter().zip(&oblong.grid.values) {
        assert!((a - b).abs() < 0.05, "{a} and {b}");
    }
}

#[test]
fn sides_are_the_patients() {
    let seen = [1.0, 2.0, 3.0, 4.0].map(|x| spineline::spatial::Pixel::new(x, 0.0));
    let left = Corners::from_image_sides(seen, ImageSide::Left);
    let right = Corners::from_image_sides(seen, ImageSide::Right);
    assert_eq!(left.superior_left, seen[0]);
    assert_eq!(right.superior_left, seen[1]);
    assert_eq!(right.inferior_right, seen[2]);
}
