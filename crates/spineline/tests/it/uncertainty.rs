//! Noise of landmarks through the whole pipeline.

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::{Level, Posture, Region};
use spineline::measure::{Corners, FilmLandmarks, Placement, Reading, ReadingId, SpacingPlane};
use spineline::personalize::{MULTIPLIER_BOUNDS, StiffnessBound};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline::uncertainty::{
    Absent, LandmarkNoise, MonteCarlo, NoiseSource, QuantityKind, QuantitySpread, Replicate,
    Spread, Uncertainty, UncertaintyError, VertebraNoise,
};
use spineline_phantom::{Readers, Scenario, generate};

use crate::common::{phantom, replicated};

fn case(subject: usize, scenario: Scenario, readers: &Readers) -> Case {
    phantom(subject, scenario, readers).case
}

/// The erect film alone: fast, and enough for what is measured on it.
fn erect(mut case: Case) -> Case {
    case.films.retain(|film| film.posture == Posture::Erect);
    case
}

fn analyzed(case: &Case) -> Analysis {
    analyze(case, &AnalysisOptions::default()).expect("a sound case")
}

fn run(case: &Case, noise: LandmarkNoise, seed: u64, count: u64) -> Uncertainty {
    let nominal = analyzed(case);
    replicated(&MonteCarlo::new(case, &nominal, noise, seed).expect("sound noise"), count)
}

fn run_anew(case: &Case, noise: LandmarkNoise, seed: u64, count: u64) -> Uncertainty {
    let nominal = analyzed(case);
    let monte_carlo = MonteCarlo::new(case, &nominal, noise, seed).expect("sound noise");
    replicated(&monte_carlo.searching_anew(), count)
}

#[test]
fn replicates_may_be_computed_in_any_order_and_from_any_order_of_readings() {
    // Oracle: one after the other.
    let case = case(0, Scenario::Bend, &Readers::default());
    let nominal = analyzed(&case);
    let monte_carlo =
        MonteCarlo::new(&case, &nominal, LandmarkNoise::Measured, 7).expect("sound noise");
    let one_by_one: Vec<Replicate> = (0..6).map(|i| monte_carlo.replicate(i)).collect();
    let threads: Vec<Replicate> = std::thread::scope(|scope| {
        let halves = [[1, 3, 5], [4, 2, 0]].map(|part| {
            let monte_carlo = &monte_carlo;
            scope.spawn(move || part.map(|index| (index, monte_carlo.replicate(index))))
        });
        let mut all: Vec<_> = halves.into_iter().flat_map(|t| t.join().expect("ends")).collect();
        all.sort_by_key(|(index, _)| *index);
        all.into_iter().map(|(_, replicate)| replicate).collect()
    });
    assert_eq!(one_by_one, threads);

    let mut turned = case.clone();
    turned.films.reverse();
    for film in &mut turned.films {
        film.landmarks.corner_readings_mut().reverse();
    }
    let other = MonteCarlo::new(&turned, &nominal, LandmarkNoise::Measured, 7).expect("as before");
    assert_eq!(other.replicate(2), one_by_one[2]);
    assert_ne!(one_by_one[1], one_by_one[2], "every replicate has its own noise");
}

#[test]
fn cases_of_two_patients_have_independent_noise() {
    // Oracle: the same films under another identifier.
    let one = erect(case(0, Scenario::Bend, &Readers::default()));
    let other = Case { id: "another".to_owned(), ..one.clone() };
    let nominal = analyzed(&one);
    let replicates = |case: &Case| {
        let monte_carlo =
            MonteCarlo::new(case, &nominal, LandmarkNoise::Measured, 7).expect("sound noise");
        [2, 0, 1].map(|index| monte_carlo.replicate(index))
    };
    let (ours, theirs) = (replicates(&one), replicates(&other));
    assert_eq!(ours, replicates(&one));
    for (a, b) in ours.iter().zip(&theirs) {
        assert_ne!(a, b);
    }
}

#[test]
fn without_noise_all_replicates_equal_the_case() {
    let case = case(3, Scenario::Rod, &Readers::default());
    let found = run(&case, LandmarkNoise::Pixels(0.0), 1, Spread::MIN_COUNT);
    let usual = run(&case, LandmarkNoise::Measured, 1, 20);
    assert_eq!((found.done, found.failed), (Spread::MIN_COUNT, 0));
    assert_eq!(found.few_words(), None);
    assert!(usual.few_words().is_some_and(|words| words.contains("needs 40 replicates; with a")));
    let mut rare = found.clone();
    let reported = rare.quantities.iter_mut().find(|one| one.quantity.is_reported());
    reported.expect("a number").count = 1;
    assert!(rare.few_words().is_some_and(|words| words.ends_with("that have the number.")));
    for quantity in &found.quantities {
        let Ok(nominal) = quantity.nominal else { continue };
        let spread = quantity.spread.expect("the case has it");
        assert_eq!(quantity.count, Spread::MIN_COUNT, "{:?}", quantity.quantity);
        assert_eq!(spread.sd, Some(0.0), "{:?}", quantity.quantity);
        let interval = quantity.interval_95();
        let has_none = quantity.at_bound || quantity.quantity.kind.grows_with_noise();
        let expected = (!has_none).then_some([spread.mean; 2]);
        assert_eq!(interval, expected, "{:?}", quantity.quantity);
        // A fit starts from the end of the case's fit, and differs by a small part of the noise.
        let sd = usual.spread(quantity.quantity).and_then(|spread| spread.sd).unwrap_or_default();
        let off = (spread.mean - nominal).abs();
        let left = 0.01 * sd + 1e-6 * nominal.abs();
        assert!(off <= left, "{:?}: {nominal} and {}, sd {sd}", quantity.quantity, spread.mean);
    }
    let searched = run_anew(&case, LandmarkNoise::Pixels(0.0), 1, 2);
    for quantity in &searched.quantities {
        let Ok(nominal) = quantity.nominal else { continue };
        let spread = quantity.spread.expect("the case has it");
        assert_eq!((spread.sd, spread.mean), (Some(0.0), nominal), "{:?}", quantity.quantity);
    }
}

#[test]
fn a_multiplier_at_its_bound_has_no_interval() {
    // Oracle: the bounds of the fit of the case itself.
    let mut at_bound = 0;
    for subject in 0..6 {
        let case = case(subject, Scenario::Bend, &Readers::default());
        let nominal = analyzed(&case);
        let found = run(&case, LandmarkNoise::Measured, 1, 2 * Spread::MIN_COUNT);
        for one in &found.quantities {
            if one.quantity.kind != QuantityKind::LogMultiplier {
                assert!(!one.at_bound && one.replicates_at_bound == 0, "{:?}", one.quantity);
                continue;
            }
            let of_line = one.quantity.line.zip(one.quantity.multiplier);
            let (kind, group) = of_line.expect("a line's multiplier");
            let model = nominal.model(kind).expect("its line has a model");
            let is_inside = model.fit.bounds[group] == StiffnessBound::Inside;
            assert!(is_inside || one.at_bound || one.nominal.is_err(), "{:?}", one.quantity);
            let multiplier = one.multiplier().expect("it is one");
            let is_known = !one.at_bound && one.count >= Spread::MIN_COUNT;
            assert_eq!(one.interval_95().is_some(), is_known);
            assert_eq!(multiplier.quantiles.is_some(), is_known);
            // An end at a bound is an end of the search, and not of what the films allow.
            for end in multiplier.quantiles.into_iter().flat_map(|[low, .., high]| [low, high]) {
                let is_away = |bound: f64| (end / bound).ln().abs() > 1e-6;
                assert!(MULTIPLIER_BOUNDS.into_iter().all(is_away), "{end}: {:?}", one.quantity);
            }
            at_bound += usize::from(!is_inside);
        }
    }
    assert!(at_bound > 0, "the test means something");
}

#[test]
fn replicates_from_the_minima_of_the_case_equal_those_of_a_new_search() {
    // Oracle: every replicate analysed as a separate case.
    for (subject, scenario) in [(1, Scenario::Rod), (2, Scenario::Bend), (6, Scenario::Pull)] {
        let case = case(subject, scenario, &Readers::default());
        let found = run(&case, LandmarkNoise::Measured, 5, 40);
        let oracle = run_anew(&case, LandmarkNoise::Measured, 5, 40);
        assert_eq!(found.done, oracle.done);
        let (mut compared, mut apart) = (0, Vec::new());
        for (one, other) in found.quantities.iter().zip(&oracle.quantities) {
            assert_eq!(one.quantity, other.quantity);
            let (Some(a), Some(b)) = (one.spread, other.spread) else { continue };
            compared += 1;
            let [own, right] = [a, b].map(|spread| spread.sd.unwrap_or_default());
            let off = (a.mean - b.mean).abs().max((own - right).abs());
            if off > 0.1 * right {
                apart.push((one.quantity, a, b));
            }
        }
        assert!(compared > 300, "{compared}");
        // The free line of a pulled spine, in the frontal plane, has minima of nearly one depth: some replicates end in another one.
        let parts = if scenario == Scenario::Pull { 15 } else { 50 };
        assert!(apart.len() * parts <= compared, "{scenario:?}: {apart:#?}");
    }
}

/// Deviations of a body's place and tilt in the frame of another body, for a deviation of every corner's coordinate: linear
/// propagation, with derivatives by differences.
fn propagated(base: &Corners<Frontal>, body: &Corners<Frontal>, sd_mm: Frontal) -> [f64; 3] {
    const STEP_MM: f64 = 1e-4;
    let measure = |points: &[Frontal; 8]| {
        let corners = |p: &[Frontal]| Corners {
            superior_left: p[0],
            superior_right: p[1],
            inferior_left: p[2],
            inferior_right: p[3],
        };
        let [base, body] = [corners(&points[..4]), corners(&points[4..])];
        let place = |body: &Corners<Frontal>| body.measure_location().expect("a plain body");
        let location = (place(&body) - place(&base)).rotated(-base.measure_endplate_tilt());
        [
            location.y_mm,
            location.z_mm,
            (body.measure_endplate_tilt() - base.measure_endplate_tilt()).deg(),
        ]
    };
    let [a, b] = [base.points(), body.points()];
    let points: [Frontal; 8] = std::array::from_fn(|i| if i < 4 { a[i] } else { b[i - 4] });
    let mut variance = [0.0; 3];
    for corner in 0..8 {
        let axes =
            [(Frontal::new(STEP_MM, 0.0), sd_mm.y_mm), (Frontal::new(0.0, STEP_MM), sd_mm.z_mm)];
        for (off, sd_mm) in axes {
            let moved = |sign: f64| {
                let mut points = points;
                points[corner] = points[corner] + off * sign;
                measure(&points)
            };
            let (up, down) = (moved(1.0), moved(-1.0));
            for (sum, (up, down)) in variance.iter_mut().zip(up.iter().zip(down)) {
                *sum += ((up - down) / (2.0 * STEP_MM) * sd_mm).powi(2);
            }
        }
    }
    variance.map(f64::sqrt)
}

#[test]
fn the_standard_deviation_of_a_single_reading_follows_from_corner_noise() {
    // Oracle: linear propagation. In `G` a place holds the noise of L4's place and tilt too.
    let (sd_px, count) = (3.0, 8000);
    let case = erect(case(2, Scenario::Rod, &Readers::exact()));
    let found = run(&case, LandmarkNoise::Pixels(sd_px), 5, count);
    let FilmLandmarks::Corners { image, readings, .. } = &case.films[0].landmarks else {
        panic!("phantoms have landmarks")
    };
    // This film has pixels that are higher than wide.
    let spacing = image.spacing.expect("phantoms have a spacing");
    let sd_mm = Frontal::new(sd_px * spacing.column_mm, sd_px * spacing.row_mm);
    assert!(sd_mm.z_mm > 1.1 * sd_mm.y_mm);
    let body =
        |level: Level| readings[0].vertebrae[&level].corners.map(|corner| image.frontal(corner));
    // Monte Carlo's own error of a deviation is one part in √(2n); four of these.
    let limit = 4.0 / (2.0 * count as f64).sqrt();
    for level in [Level::L3, Level::T12, Level::T7, Level::T2] {
        let kinds = [QuantityKind::LocationY, QuantityKind::LocationZ, QuantityKind::Tilt];
        let right = propagated(&body(Level::L4), &body(level), sd_mm);
        for (kind, right) in kinds.into_iter().zip(right) {
            let spread = found.spread(kind.on(Posture::Erect).at(level)).expect("measured");
            let sd = spread.sd.expect("many replicates");
            assert!((sd / right - 1.0).abs() < limit, "{level}: {sd} {right}");
        }
    }
}

#[test]
fn the_standard_deviation_of_a_mean_decreases_with_the_root_of_n() {
    // Oracle: s/√n for tilts, which are linear in small noise.
    let one = erect(case(2, Scenario::Rod, &Readers::exact()));
    let mut four = one.clone();
    if let FilmLandmarks::Corners { readings, .. } = &mut four.films[0].landmarks {
        for repeat in 2..=4 {
            let mut again = readings[0].clone();
            again.id.repeat = repeat;
            // Equal readings would count as one; this moves the whole spine.
            let moved = |p: Pixel| Pixel::new(p.column_px + f64::from(repeat), p.row_px);
            again.vertebrae.values_mut().for_each(|mark| mark.corners = mark.corners.map(moved));
            readings.push(again);
        }
    }
    let sd = |case: &Case| {
        let found = run(case, LandmarkNoise::Pixels(2.0), 11, 1000);
        let tilt = QuantityKind::Tilt.on(Posture::Erect).at(Level::T8);
        found.spread(tilt).and_then(|spread| spread.sd).expect("measured")
    };
    let ratio = sd(&one) / sd(&four);
    assert!((ratio / 2.0 - 1.0).abs() < 0.12, "{ratio}");
}

#[test]
fn copied_readings_do_not_lower_the_noise() {
    // Oracle: the same case without the copies.
    let alone = erect(case(2, Scenario::Rod, &Readers::exact()));
    let mut copied = alone.clone();
    if let FilmLandmarks::Corners { readings, .. } = &mut copied.films[0].landmarks {
        for repeat in 2..=4 {
            readings.push(Reading { id: ReadingId::new("A", repeat), ..readings[0].clone() });
        }
    }
    for noise in [LandmarkNoise::Measured, LandmarkNoise::Pixels(2.0)] {
        let [one, four] = [&alone, &copied].map(|case| {
            let nominal = analyzed(case);
            let found = MonteCarlo::new(case, &nominal, noise, 7).expect("sound noise");
            [0, 1, 2].map(|index| found.replicate(index))
        });
        assert_eq!(one, four);
        let [one, four] = [&alone, &copied].map(|case| run(case, noise, 7, 1).noise);
        assert_eq!(one, four);
    }
}

#[test]
fn the_measured_noise_equals_that_of_the_readers() {
    // Oracle: the virtual readers' own deviation; two observers add their bias, which all three repeats of a mean share, and
    // pixels their rounding.
    let readers = Readers::default();
    let found = run(&case(0, Scenario::Rod, &readers), LandmarkNoise::Measured, 1, 1);
    let shared = f64::from(readers.repeats).sqrt();
    let expected = readers.corner_sd_mm.hypot(shared * readers.corner_bias_sd_mm);
    let of_axes = readers.axis_sd.deg().hypot(shared * readers.axis_bias_sd.deg());
    for film in &found.noise {
        assert_eq!(film.source, NoiseSource::Readings);
        let VertebraNoise::Corners { sd_mm: Some([y, z]), axis_sd: Some(axis), .. } =
            film.landmarks
        else {
            panic!("corners with a spacing")
        };
        assert!((y / expected - 1.0).abs() < 0.1 && (z - y).abs() < 1e-12, "{y} {expected}");
        assert!((axis.deg() / of_axes - 1.0).abs() < 0.15, "{axis}");
    }
    let once =
        run(&erect(case(0, Scenario::Rod, &Readers::exact())), LandmarkNoise::Measured, 1, 1);
    assert_eq!(once.noise[0].source, NoiseSource::Assumed);
    assert!(once.noise_words()[0].contains("no film was read twice"), "{:?}", once.noise_words());
}

/// A case as another program would give it.
fn placed(case: &Case) -> Case {
    let nominal = analyzed(case);
    let mut placed = case.clone();
    for (film, posture) in placed.films.iter_mut().zip(&nominal.movement.films) {
        let vertebrae = posture.outline.vertebrae.iter();
        let vertebrae = vertebrae.map(|v| (v.level, Placement::new(v.location, v.tilt))).collect();
        let id = spineline::measure::ReadingId::new("program", 1);
        let readings = vec![Reading { id, vertebrae }];
        film.landmarks = FilmLandmarks::placed(SpacingPlane::Patient, readings);
    }
    placed
}

#[test]
fn locations_of_other_programs_are_perturbed_by_their_stated_noise_without_pixels() {
    // Oracle: 0.25 mm and 0.7° of one careful reading; in `G` the tilts of two vertebrae differ by √2 of that.
    let case = placed(&erect(case(4, Scenario::Rod, &Readers::exact())));
    let found = run(&case, LandmarkNoise::Measured, 2, 1500);
    assert_eq!(found.noise[0].source, NoiseSource::Assumed);
    let tilt = QuantityKind::Tilt.on(Posture::Erect).at(Level::T5);
    let sd = found.spread(tilt).and_then(|spread| spread.sd).expect("measured");
    assert!((sd / (0.7 * 2.0_f64.sqrt()) - 1.0).abs() < 0.08, "{sd}");
    let nominal = analyzed(&case);
    let refused = MonteCarlo::new(&case, &nominal, LandmarkNoise::Pixels(2.0), 1).err();
    assert_eq!(refused, Some(UncertaintyError::NoPicture { posture: Posture::Erect }));
}

#[test]
fn a_deviation_below_zero_is_refused() {
    let case = erect(case(0, Scenario::Rod, &Readers::exact()));
    let nominal = analyzed(&case);
    for sd_px in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = MonteCarlo::new(&case, &nominal, LandmarkNoise::Pixels(sd_px), 1).err();
        assert!(matches!(refused, Some(UncertaintyError::Deviation { .. })), "{sd_px}");
    }
}

#[test]
fn a_film_that_often_cannot_be_measured_is_counted() {
    // Noise of a third of a body crosses corners now and then.
    let case = erect(case(0, Scenario::Rod, &Readers::exact()));
    let found = run(&case, LandmarkNoise::Pixels(60.0), 3, 60);
    assert!(found.failed > 0 && found.failed <= found.done, "{found:?}");
    let counted: u64 = found.failures.iter().filter(|f| f.line.is_none()).map(|f| f.count).sum();
    assert_eq!(counted, found.failed);
    for quantity in &found.quantities {
        let absent: u64 = quantity.absent.iter().map(|(_, count)| count).sum();
        assert_eq!(quantity.count + absent + found.failed, found.done, "{:?}", quantity.quantity);
    }
    assert!(found.failure_words().iter().any(|words| words.contains("whole analysis")));
}

#[test]
fn inflections_absent_in_some_replicates_are_counted() {
    // A curve counts from a minimum angle on: at the size of the smallest one, noise decides.
    let case = erect(case(0, Scenario::Rod, &Readers::exact()));
    let smallest = analyzed(&case)
        .movement
        .inflections
        .curves
        .iter()
        .map(|part| part.turn.abs().deg())
        .fold(f64::INFINITY, f64::min);
    let options =
        AnalysisOptions { min_curve: Angle::from_deg(smallest), ..AnalysisOptions::default() };
    let nominal = analyze(&case, &options).expect("a sound case");
    let monte_carlo =
        MonteCarlo::new(&case, &nominal, LandmarkNoise::Pixels(3.0), 1).expect("sound noise");
    let found = replicated(&monte_carlo, 200);
    let share = found.spread(QuantityKind::InflectionPair.of_case()).expect("always told").mean;
    assert!((0.1..0.9).contains(&share), "{share}");
    let caudal = QuantityKind::InflectionY.of_case().at_end(0);
    let caudal = found.of(caudal).expect("asked for");
    assert_eq!(caudal.absent, [(Absent::NoInflections, 200 - caudal.count)]);
    assert!((caudal.count as f64 / 200.0 - share).abs() < 1e-12);
}

#[test]
fn intervals_cover_true_values_where_there_is_no_selection() {
    // Oracle: the phantoms' true places. 16 phantoms with readers of known noise; binomial 95 % of 16 × 14 values.
    let readers = Readers {
        observers: 1,
        repeats: 2,
        corner_bias_sd_mm: 0.0,
        rounded: false,
        ..Readers::default()
    };
    let (mut covered, mut asked, mut cobb) = (0.0, 0.0, 0.0);
    for subject in 0..16 {
        let phantom = generate(subject, Scenario::Rod, &readers, 9).expect("a subject");
        let case = erect(phantom.case.clone());
        let found = run(&case, LandmarkNoise::Pixels(4.0), 1, 300);
        let truth = phantom.posture(Posture::Erect).expect("every phantom stands");
        for (i, &level) in Level::MODEL.iter().enumerate().skip(1) {
            let tilt = QuantityKind::Tilt.on(Posture::Erect).at(level);
            let spread = found.of(tilt).expect("measured");
            let [low, high] = spread.interval_95().expect("a tilt");
            let right = (truth.tilts[i] - truth.tilts[0]).deg();
            covered += f64::from(u8::from((low..=high).contains(&right)));
            asked += 1.0;
        }
        // The ends of a Cobb angle are a choice of the noisy tilts: it is never far from the true one.
        let main = QuantityKind::Cobb.on(Posture::Erect).in_region(Region::MainThoracic);
        cobb += found.spread(main).and_then(|spread| spread.sd).expect("measured") / 16.0;
    }
    let rate = covered / asked;
    assert!((0.90..=0.99).contains(&rate), "{rate}");
    // Two tilts of 0.4 mm at bodies of 20 to 30 mm, mean of two readings.
    assert!((0.4..1.6).contains(&cobb), "{cobb}");
}

#[test]
fn a_fit_whose_variances_drift_slowly_ends() {
    // Oracle: every replicate of a spine that a force bends has a line of best fit. Steps that were shortened from round 30 on lost one.
    let found = run(&case(3, Scenario::Pull, &Readers::default()), LandmarkNoise::Measured, 1, 100);
    let is_angle = |one: &&QuantitySpread| one.quantity.kind == QuantityKind::ComparisonAngle;
    let angles: Vec<&QuantitySpread> = found.quantities.iter().filter(is_angle).collect();
    assert!(!angles.is_empty());
    for one in angles {
        assert_eq!(one.count, 100, "{:?}: {:?}", one.quantity, one.absent);
    }
}
