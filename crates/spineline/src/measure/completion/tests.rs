//! Derivatives against differences, and rules for any completion.

use super::fit::centres;
use super::shape::{FIRST_LENGTH, LENGTHS, PARAMETERS, Shape};
use super::*;
use crate::anatomy::{ImageSide, Side};
use crate::measure::CornerName;

const IMAGE: ImageGeometry =
    ImageGeometry { columns: 1200, rows: 3000, patient_left: ImageSide::Right, spacing: None };

/// A shape of one of the spines of the model, curved and scaled.
fn curved(seed: u32) -> Shape {
    provide_shape(spineline_weights::ERECT_SPINES);
    let mut parameters = model_of(Some(Posture::Erect)).expect("a table").mean.clone();
    let phase = f64::from(seed);
    for (index, value) in parameters.iter_mut().enumerate().skip(2) {
        *value += 0.08 * (phase + 0.7 * index as f64).sin();
    }
    parameters.rows_mut(FIRST_LENGTH, LENGTHS).add_scalar_mut(100.0_f64.ln());
    (parameters[0], parameters[1]) = (600.0, -2800.0);
    Shape { parameters }
}

/// Marks on every vertebra of a shape, without error.
fn clicks_on(image: &ImageGeometry, shape: &Shape, marks: &[Mark]) -> Clicks {
    let corners = shape.corners();
    let vertebrae = Level::ALL.iter().zip(&corners).flat_map(|(&level, body)| {
        marks.iter().map(move |&mark| {
            let names = mark.corners();
            let sum = names.iter().fold(Frontal::default(), |sum, name| sum + name.of(body));
            Click { level, mark, place: image.pixel(sum * (1.0 / names.len() as f64)) }
        })
    });
    Clicks { vertebrae: vertebrae.collect(), midline: Vec::new() }
}

const WALLS: [Mark; 2] = [Mark::Wall(Side::Left), Mark::Wall(Side::Right)];

#[test]
fn derivatives_equal_differences() {
    let shape = curved(1);
    let jacobian = shape.jacobian();
    for parameter in 0..PARAMETERS {
        let step = if parameter < 2 { 1e-3 } else { 1e-6 };
        let moved = |by: f64| {
            let mut other = shape.clone();
            other.parameters[parameter] += by;
            other.coordinates()
        };
        let by_difference = (moved(step) - moved(-step)) / (2.0 * step);
        let off = (by_difference - jacobian.column(parameter)).amax();
        assert!(off < 1e-4, "parameter {parameter}: {off}");
    }
}

#[test]
fn four_corners_of_every_vertebra_stay_where_they_are() {
    let shape = curved(2);
    let clicks = clicks_on(&IMAGE, &shape, &CornerName::ALL.map(Mark::Corner));
    let found = complete(&IMAGE, Some(Posture::Erect), &clicks).expect("a completion");
    for (&level, body) in Level::ALL.iter().zip(&shape.corners()) {
        for corner in CornerName::ALL {
            let off = corner.of(&found.corners(level)).distance_mm(corner.of(body));
            // A click has a standard deviation of 2.7.
            assert!(off < 3.0, "{level}: {off}");
        }
    }
}

#[test]
fn walls_of_every_vertebra_leave_less_than_a_tenth_of_a_step() {
    for posture in [Some(Posture::Erect), Some(Posture::LeftBending), None] {
        let shape = curved(3);
        let found = complete(&IMAGE, posture, &clicks_on(&IMAGE, &shape, &WALLS)).expect("one");
        for (&level, body) in Level::ALL.iter().zip(&shape.corners()) {
            let off = found.corners(level).superior_left.distance_mm(body.superior_left);
            assert!(off < 12.0, "{level}: {off} of a step of 100");
        }
    }
}

#[test]
fn a_mirrored_picture_of_the_same_patient_has_the_mirrored_corners() {
    let mirrored = ImageGeometry { patient_left: ImageSide::Left, ..IMAGE };
    let flip =
        |place: Pixel| Pixel::new(f64::from(IMAGE.columns - 1) - place.column_px, place.row_px);
    let clicks = clicks_on(&IMAGE, &curved(4), &WALLS);
    let mut flipped = clicks.clone();
    for click in &mut flipped.vertebrae {
        click.place = flip(click.place);
    }
    let here = complete(&IMAGE, None, &clicks).expect("a completion");
    let there = complete(&mirrored, None, &flipped).expect("a completion");
    for level in Level::ALL {
        let (a, b) = (here.corners_px(&IMAGE, level), there.corners_px(&mirrored, level));
        for (p, q) in a.map(flip).points().into_iter().zip(b.points()) {
            assert!((p.column_px - q.column_px).hypot(p.row_px - q.row_px) < 1e-6);
        }
    }
}

#[test]
fn a_larger_turned_film_has_larger_turned_corners() {
    let clicks = clicks_on(&IMAGE, &curved(5), &[Mark::Centre]);
    let turn = |p: Pixel| Pixel::new(200.0 - 3.0 * p.row_px, 100.0 + 3.0 * p.column_px);
    let mut turned = clicks.clone();
    for click in &mut turned.vertebrae {
        click.place = turn(click.place);
    }
    let here = complete(&IMAGE, None, &clicks).expect("a completion");
    let there = complete(&IMAGE, None, &turned).expect("a completion");
    for level in Level::ALL {
        let (a, b) = (here.corners_px(&IMAGE, level), there.corners_px(&IMAGE, level));
        for (p, q) in a.map(turn).points().into_iter().zip(b.points()) {
            assert!((p.column_px - q.column_px).hypot(p.row_px - q.row_px) < 1e-4);
        }
        assert!((there.sd_mm(level) / here.sd_mm(level) - 3.0).abs() < 1e-6);
    }
}

#[test]
fn marked_corners_are_known_better_than_others() {
    let shape = curved(6);
    let mut clicks = clicks_on(&IMAGE, &shape, &CornerName::ALL.map(Mark::Corner));
    clicks.vertebrae.retain(|click| click.level < Level::L1);
    let found = complete(&IMAGE, None, &clicks).expect("a completion");
    let sd = |level| found.sd_mm(level);
    assert!(sd(Level::L2) < sd(Level::L1) && sd(Level::L1) < sd(Level::T12));
    assert!(sd(Level::T12) < sd(Level::T6));
}

#[test]
fn points_of_the_midline_draw_the_centres_to_it() {
    let shape = curved(7);
    let mut clicks = clicks_on(&IMAGE, &shape, &WALLS);
    clicks.vertebrae.retain(|click| [Level::L4, Level::T2].contains(&click.level));
    let without = complete(&IMAGE, None, &clicks).expect("a completion");
    clicks.midline = centres(&shape).map(|centre| IMAGE.pixel(centre)).to_vec();
    let with = complete(&IMAGE, None, &clicks).expect("a completion");
    let error = |found: &Completion| {
        let of_level = |(level, body): (&Level, &Corners<Frontal>)| {
            found.corners(*level).superior_left.distance_mm(body.superior_left)
        };
        Level::ALL.iter().zip(&shape.corners()).map(of_level).sum::<f64>() / 17.0
    };
    assert!(error(&with) < 0.6 * error(&without), "{} {}", error(&with), error(&without));
}

#[test]
fn too_few_clicks_and_no_numbers_are_errors() {
    provide_shape(spineline_weights::ERECT_SPINES);
    let click =
        |column| Click { level: Level::L3, mark: Mark::Centre, place: Pixel::new(column, 9.0) };
    let of = |vertebrae: Vec<Click>| {
        complete(&IMAGE, None, &Clicks { vertebrae, midline: Vec::new() }).map(|_| ())
    };
    assert_eq!(of(vec![]), Err(CompletionError::TooFew { clicks: 0 }));
    assert_eq!(of(vec![click(5.0)]), Err(CompletionError::TooFew { clicks: 1 }));
    assert_eq!(of(vec![click(5.0), click(5.0)]), Err(CompletionError::TooFew { clicks: 2 }));
    let level = Level::L3;
    assert_eq!(of(vec![click(5.0), click(f64::NAN)]), Err(CompletionError::NotFinite { level }));
}
