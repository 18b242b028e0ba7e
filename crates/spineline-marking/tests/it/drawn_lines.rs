//! Lengths and angles of lines drawn on a film, against closed forms, mirrored and with pixels that are not square.

use spineline::anatomy::ImageSide;
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane, SpacingSource};
use spineline::spatial::Pixel;
use spineline_marking::{Calibration, DrawnFault, DrawnLine};

/// Rounding of a few operations on lengths of some hundred millimetres.
const ROUNDING: f64 = 1e-10;
const COLUMNS: u32 = 1000;

fn image(spacing: Option<Spacing>, patient_left: ImageSide) -> ImageGeometry {
    ImageGeometry { columns: COLUMNS, rows: 2000, spacing, patient_left }
}

fn line(from: [f64; 2], to: [f64; 2]) -> DrawnLine {
    let [from, to] = [from, to].map(|[column, row]| Pixel::new(column, row));
    DrawnLine { from, to }
}

fn oblong() -> Spacing {
    Spacing::stated(0.3, 0.1, SpacingPlane::Patient)
}

#[test]
fn lengths_and_angles_are_those_of_millimetres_and_not_of_pixels() {
    let film = image(Some(oblong()), ImageSide::Left);
    // 100 columns are 30 mm and 400 rows are 40 mm.
    let slope = line([50.0, 60.0], [150.0, 460.0]);
    let length = slope.length(&film).expect("a length");
    assert!((length.length_mm - 50.0).abs() < ROUNDING);
    let across = line([10.0, 10.0], [510.0, 10.0]);
    let angle = across.angle_to(&slope, &film).expect("an angle").angle;
    assert!((angle.rad() - (4.0_f64 / 3.0).atan()).abs() < ROUNDING);
}

#[test]
fn a_mirrored_film_and_exchanged_ends_change_nothing() {
    let [straight, mirrored] =
        [ImageSide::Left, ImageSide::Right].map(|side| image(Some(oblong()), side));
    let turned = |line: DrawnLine| {
        let column =
            |place: Pixel| Pixel::new(f64::from(COLUMNS) - 1.0 - place.column_px, place.row_px);
        DrawnLine { from: column(line.to), to: column(line.from) }
    };
    let lines = [line([100.0, 200.0], [600.5, 350.25]), line([90.0, 900.0], [700.0, 1420.0])];
    for one in &lines {
        let [a, b] = [one.length(&straight), turned(*one).length(&mirrored)]
            .map(|length| length.expect("a length"));
        assert!((a.length_mm - b.length_mm).abs() < ROUNDING);
        assert!((a.click_sd_mm - b.click_sd_mm).abs() < ROUNDING);
    }
    let [a, b] = [
        lines[0].angle_to(&lines[1], &straight),
        turned(lines[0]).angle_to(&turned(lines[1]), &mirrored),
    ]
    .map(|angle| angle.expect("an angle"));
    assert!((a.angle.rad() - b.angle.rad()).abs() < ROUNDING);
    assert!((a.click_sd.rad() - b.click_sd.rad()).abs() < ROUNDING);
}

#[test]
fn deviations_are_those_of_the_derivatives() {
    let film = image(Some(oblong()), ImageSide::Right);
    let lines = [line([100.0, 200.0], [600.0, 350.0]), line([90.0, 900.0], [300.0, 1420.0])];
    let step = 1e-4;
    // The variance is the sum of the squared derivatives over all coordinates of clicks.
    let moved = |lines: &[DrawnLine; 2], which: usize| {
        let mut lines = *lines;
        let end =
            if which & 2 == 0 { &mut lines[which / 4].from } else { &mut lines[which / 4].to };
        if which & 1 == 0 {
            end.column_px += step
        } else {
            end.row_px += step
        }
        lines
    };
    let sum = |of: &dyn Fn(&[DrawnLine; 2]) -> f64| {
        let squares = (0..8).map(|which| ((of(&moved(&lines, which)) - of(&lines)) / step).powi(2));
        Calibration::CLICK_SD_PX * squares.sum::<f64>().sqrt()
    };
    let by_lengths = sum(&|lines| lines[0].length(&film).expect("a length").length_mm);
    let by_angles =
        sum(&|lines| lines[0].angle_to(&lines[1], &film).expect("an angle").angle.rad());
    let length = lines[0].length(&film).expect("a length");
    let angle = lines[0].angle_to(&lines[1], &film).expect("an angle");
    // A forward difference over 0.0001 px has about this relative error.
    assert!((length.click_sd_mm / by_lengths - 1.0).abs() < 1e-4);
    assert!((angle.click_sd.rad() / by_angles - 1.0).abs() < 1e-4);
}

#[test]
fn the_unit_and_the_error_of_the_scale_are_in_the_text() {
    let down = line([100.0, 100.0], [100.0, 1100.0]);
    let text = |spacing: Option<Spacing>| {
        let length = down.length(&image(spacing, ImageSide::Left)).expect("a length");
        format!("{}; {}", length.text(), length.scale)
    };
    assert_eq!(text(None), "1000 px; pixels (taken as square)");
    assert_eq!(text(Some(oblong())), "100.0 ± 0.1 mm; mm (patient)");
    let detector =
        Spacing { plane: SpacingPlane::Detector, source: SpacingSource::Imager, ..oblong() };
    assert_eq!(text(Some(detector)), "100.0 ± 0.1 mm; mm (detector), Imager Pixel Spacing");
    let ball = Spacing { source: SpacingSource::Ball, relative_sd: Some(0.01), ..oblong() };
    assert_eq!(
        text(Some(ball)),
        "100.0 ± 1.0 mm; mm (patient), a ball in the picture, scale ± 1.0 %"
    );
}

#[test]
fn lines_that_measure_nothing_are_refused() {
    let film = image(None, ImageSide::Left);
    let good = line([10.0, 10.0], [20.0, 10.0]);
    let short = line([10.0, 10.0], [13.0, 14.0 - 1e-9]);
    let fault = short.length(&film).expect_err("a fault");
    assert!(matches!(fault, DrawnFault::TooNear { .. }), "{fault}");
    assert_eq!(good.angle_to(&short, &film).expect_err("a fault"), fault);
    for beside in [[-0.6, 5.0], [1000.0, 5.0], [5.0, 2000.0], [f64::NAN, 5.0]] {
        let fault = line([10.0, 10.0], beside).length(&film).expect_err("a fault");
        assert!(matches!(fault, DrawnFault::OffPicture { .. }), "{fault}");
    }
}
