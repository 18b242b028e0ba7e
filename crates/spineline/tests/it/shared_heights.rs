//! Heights that the erect and the lateral film share, on films of phantoms of which the other film was read without error.

use spineline::analysis::Case;
use spineline::anatomy::Level;
use spineline::measure::{Corners, FilmLandmarks, HeightLine, ImageGeometry, SharedHeights};
use spineline::spatial::{Angle, Pixel};
use spineline_phantom::{SpaceSetup, generate_in_space};

/// Which film is looked at.
#[derive(Clone, Copy, PartialEq)]
enum On {
    Erect,
    Lateral,
}

/// The true midpoint of a vertebra on a film of a case that was read without error.
fn midpoint(case: &Case, on: On, level: Level) -> Pixel {
    let FilmLandmarks::Corners { image, readings, .. } = &case.films[0].landmarks else {
        panic!("corners")
    };
    let lateral = case.lateral.as_ref().expect("a lateral film");
    let (image, corners): (ImageGeometry, Corners<Pixel>) = match on {
        On::Erect => (*image, readings[0].vertebrae[&level].corners),
        On::Lateral => (lateral.image, lateral.readings[0].vertebrae[&level]),
    };
    let crossing = corners.map(|corner| image.frontal(corner)).measure_location();
    image.pixel(crossing.expect("a body"))
}

/// How far a place lies below a line, in pixels.
fn below(line: &HeightLine, place: Pixel) -> f64 {
    let [from, to] = line.ends;
    let share = (place.column_px - from.column_px) / (to.column_px - from.column_px);
    place.row_px - (from.row_px + share * (to.row_px - from.row_px))
}

/// Takes a vertebra from a film.
fn remove(case: &mut Case, on: On, level: Level) {
    let readings = case.films[0].landmarks.corner_readings_mut();
    let lateral = case.lateral.as_mut().expect("a lateral film");
    let taken = match on {
        On::Erect => readings[0].vertebrae.remove(&level).is_some(),
        On::Lateral => lateral.readings[0].vertebrae.remove(&level).is_some(),
    };
    assert!(taken);
}

fn heights(case: &Case) -> Option<SharedHeights> {
    let lateral = case.lateral.as_ref().expect("a lateral film");
    SharedHeights::of(&case.films[0], lateral).expect("sound films")
}

#[test]
fn a_vertebra_of_one_film_lies_at_its_height_on_the_other_within_the_stated_deviation() {
    let (mut sums, mut n) = ([0.0; 2], 0.0);
    for seed in 0..150 {
        let exact = SpaceSetup {
            lateral_scale: 0.9 + 0.05 * (seed % 5) as f64,
            lateral_turn: Angle::from_deg([-2.0, 0.0, 2.0][seed as usize % 3]),
            seed,
            ..SpaceSetup::default()
        };
        let truth = generate_in_space(&exact).case;
        let read = generate_in_space(&SpaceSetup { corner_sd_mm: 0.5, ..exact }).case;
        let level = Level::MODEL[2 + seed as usize % 11];
        for (sum, on) in sums.iter_mut().zip([On::Erect, On::Lateral]) {
            let mut case = read.clone();
            remove(&mut case, on, level);
            let found = heights(&case).expect("many vertebrae on both");
            let lines = if on == On::Erect { &found.on_erect } else { &found.on_lateral };
            let line = lines.iter().find(|line| line.level == level).expect("its height");
            *sum += (below(line, midpoint(&truth, on, level)) / line.sd_px).powi(2);
        }
        n += 1.0;
    }
    for sum in sums {
        let share = f64::sqrt(sum / n);
        assert!((0.8..1.2).contains(&share), "{share} of the stated deviation");
    }
}

#[test]
fn exact_films_share_their_heights_exactly_and_one_vertebra_is_too_few() {
    let setup = SpaceSetup {
        lateral_scale: 1.1,
        lateral_turn: Angle::from_deg(2.0),
        ..SpaceSetup::default()
    };
    let case = generate_in_space(&setup).case;
    let found = heights(&case).expect("many vertebrae on both");
    // The prior holds the turn back a little.
    for (on, lines) in [(On::Erect, &found.on_erect), (On::Lateral, &found.on_lateral)] {
        for line in lines {
            let off = below(line, midpoint(&case, on, line.level)).abs();
            assert!(off < 0.5 * line.sd_px, "{}: {off} px of {}", line.level, line.sd_px);
        }
    }
    let mut few = case;
    for &level in Level::ALL.iter().filter(|level| **level != Level::T8) {
        remove(&mut few, On::Lateral, level);
    }
    assert_eq!(heights(&few), None);
}
