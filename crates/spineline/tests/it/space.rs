//! The erect spine in space, from two films of phantoms that one projection made.

#![expect(clippy::disallowed_methods, reason = "the oracle has its own formulas")]

use spineline::analysis::{
    Analysis, AnalysisOptions, AxialSource, PitchSource, TemplateError, analyze, analyze_movement,
};
use spineline::anatomy::{Level, Posture, SagittalProfile};
use spineline::clinical::{SagittalPart, SpatialMeasures};
use spineline::measure::{SpatialOutline, TiltRule, measure_film};
use spineline::spatial::{Angle, Mat3, Orientation, Vec3};
use spineline::uncertainty::{LandmarkNoise, MonteCarlo, QuantityKind, Uncertainty};
use spineline::warning::{WarningCode, Warnings};
use spineline_phantom::{
    EndplateHabit, SagittalShape, SpacePhantom, SpaceSetup, generate_in_space,
};

use crate::common::{self, Draw, assert_near, read_axial};

const HABITS: [EndplateHabit; 2] = [EndplateHabit::Rim, EndplateHabit::MiddleLine];

fn measured(phantom: &SpacePhantom) -> (SpatialOutline, Warnings) {
    let mut warnings = Warnings::default();
    let erect = &phantom.case.films[0];
    let outline = measure_film(erect, TiltRule::default(), &mut warnings).expect("a good film");
    let lateral = phantom.case.lateral.as_ref().expect("both films");
    let found = SpatialOutline::measure(erect, &outline, lateral, &mut warnings);
    (found.expect("a good film").expect("all vertebrae on both films"), warnings)
}

/// The pitch of a body from its axis alone: its elevation from the frontal plane.
fn true_pitch(phantom: &SpacePhantom, level: Level) -> Angle {
    let axis = phantom.body(level).expect("every level").cranial;
    Angle::from_sin_cos(axis.x, axis.y.hypot(axis.z))
}

#[test]
fn exact_landmarks_give_the_pitch_in_space_whatever_the_rotation_and_the_reader() {
    for shape in SagittalShape::ALL {
        for rotation in [0.0, 10.0, 20.0, 30.0] {
            for (seed, habit) in (0..).zip(HABITS) {
                let setup = SpaceSetup {
                    shape,
                    habit,
                    apical_rotation: Angle::from_deg(rotation),
                    largest_tilt: Angle::from_deg(35.0),
                    lateral_scale: 1.13,
                    seed,
                    ..SpaceSetup::default()
                };
                let phantom = generate_in_space(&setup);
                let (found, warnings) = measured(&phantom);
                assert!(
                    !warnings.has(WarningCode::LateralHeightsDiffer)
                        && !warnings.has(WarningCode::LateralTurned)
                );
                assert_eq!(found.vertebrae.len(), Level::ALL.len());
                assert_near(found.alignment.scale, 1.0 / 1.13, 1e-9, "scale");
                for vertebra in &found.vertebrae {
                    let body = phantom.body(vertebra.level).expect("every level");
                    let pitch = vertebra.orientation.pitch.deg();
                    assert_near(pitch, true_pitch(&phantom, vertebra.level).deg(), 1e-6, "pitch");
                    let off = vertebra.orientation.cranial().cross(&body.cranial).norm();
                    assert!(off < 1e-8, "{}: normal off by {off:e}", vertebra.level);
                    let place = body.midpoint_mm - phantom.bodies[0].midpoint_mm;
                    assert!((vertebra.place_mm - place).norm() < 1e-6);
                }
            }
        }
    }
}

#[test]
fn the_turns_of_the_model_equal_the_turns_in_space() {
    let phantom = generate_in_space(&SpaceSetup::default());
    let (found, _) = measured(&phantom);
    let profile = found.profile(&SagittalProfile::default());
    for (pair, turn_deg) in Level::MODEL.windows(2).zip(profile.turns_deg) {
        let turn = true_pitch(&phantom, pair[1]) - true_pitch(&phantom, pair[0]);
        assert_near(turn_deg, turn.deg(), 1e-6, "turn");
    }
    let analysis = analyze(&phantom.case, &AnalysisOptions::default()).expect("a good case");
    assert_eq!(analysis.movement.space, Some(found));
    let joint = &analysis.movement.spine.joints[8].inferior_from_superior;
    let cranial = [8, 9].map(|i| phantom.body(Level::MODEL[i]).expect("every level").cranial);
    assert_near(joint[(2, 2)], cranial[0].dot(&cranial[1]), 1e-3, "cosine between two axes");
}

/// Axes of a body, anterior, left and cranial, turned about its own axis as far as its pedicles say.
fn axes_as_read(phantom: &SpacePhantom, level: Level) -> Mat3 {
    let body = phantom.body(level).expect("every level");
    let (sin, cos) = (read_axial(body) - body.axial).rad().sin_cos();
    let (anterior, left) = (body.anterior, body.left);
    Mat3::from_columns(&[anterior * cos + left * sin, left * cos - anterior * sin, body.cranial])
}

/// The model stands as the true bodies do, with the axial rotation read from their pedicles, seen from its base; where the
/// lateral film shows nothing, as its neighbours say.
#[test]
fn the_model_stands_in_space_as_the_bodies_do() {
    let setup = SpaceSetup {
        apical_rotation: Angle::from_deg(20.0),
        pedicles: true,
        lateral_scale: 1.1,
        ..SpaceSetup::default()
    };
    let mut phantom = generate_in_space(&setup);
    let options = AnalysisOptions { tilt: TiltRule::Axis, ..AnalysisOptions::default() };
    for hidden in [&[][..], &[Level::L4, Level::L3, Level::T7, Level::T2]] {
        let lateral = phantom.case.lateral.as_mut().expect("both films");
        lateral.readings[0].vertebrae.retain(|level, _| !hidden.contains(level));
        let model = analyze_movement(&phantom.case, &options).expect("a good case").movement.spine;
        assert_eq!(model.midpoints_mm[0], Vec3::zeros());
        let seen: Vec<usize> = (0..15).filter(|&i| !hidden.contains(&Level::MODEL[i])).collect();
        let first = seen[0];
        for &i in &seen {
            let level = Level::MODEL[i];
            let pose = |level| {
                let body = phantom.body(level).expect("every level");
                (body.midpoint_mm, axes_as_read(&phantom, level))
            };
            let (low, high) = (pose(Level::MODEL[first]), pose(level));
            let off = model.axes[first].tr_mul(&model.axes[i]) - low.1.tr_mul(&high.1);
            assert!(off.amax() < 1e-6, "{level}: axes off by {:e}", off.amax());
            let place = model.midpoints_mm[i] - model.midpoints_mm[first];
            let off = model.axes[first].tr_mul(&place) - low.1.tr_mul(&(high.0 - low.0));
            assert!(off.norm() < 1e-5, "{level}: place off by {:e} mm", off.norm());
        }
        // What is not seen lies where the turns of a population put it.
        for (i, place) in model.midpoints_mm.iter().enumerate() {
            let [own, base] = [i, 0].map(|i| phantom.body(Level::MODEL[i]).expect("every level"));
            let off = (place.x - (own.midpoint_mm - base.midpoint_mm).x).abs();
            assert!(off < 8.0, "{}: {off} mm", Level::MODEL[i]);
        }
    }
}

/// Angles that a reader sees on the lateral film, over the pitch in space, at 25° of tilt.
#[test]
fn without_correction_the_habits_of_readers_differ_by_a_fifth() {
    let stands = Orientation {
        tilt: Angle::from_deg(25.0),
        pitch: Angle::from_deg(10.0),
        axial: Angle::ZERO,
    };
    let [over, under] = [stands.lateral_pitch(), stands.middle_line_pitch()];
    assert_near(over.rad().tan(), stands.pitch.rad().tan() / stands.tilt.rad().cos(), 1e-12, "rim");
    assert_near(
        under.rad().tan(),
        stands.pitch.rad().tan() * stands.tilt.rad().cos(),
        1e-12,
        "middle",
    );
    let difference = (over.rad() - under.rad()) / stands.pitch.rad();
    assert!((0.18..0.22).contains(&difference), "{difference}");
    // The same on the films of a phantom, whose prisms do not use these formulas.
    for habit in HABITS {
        let setup = SpaceSetup { habit, ..SpaceSetup::default() };
        let phantom = generate_in_space(&setup);
        let (found, _) = measured(&phantom);
        for vertebra in &found.vertebrae {
            let stands = vertebra.orientation;
            let expected = match habit {
                EndplateHabit::MiddleLine => stands.middle_line_pitch(),
                // Wider than deep, so the long axis differs from a round endplate's.
                EndplateHabit::Rim => continue,
            };
            for endplate in vertebra.endplates {
                assert_near(endplate.deg(), expected.deg(), 1e-6, "endplate");
            }
        }
    }
}

/// Errors over their deviations, with all landmarks perturbed as the assumption for one careful reading says, and with turned films.
#[test]
fn errors_are_as_large_as_their_deviations_say() {
    let mut squares = [[0.0; 2]; 4];
    let mut draw = Draw::new(23);
    let mut add = |kind: usize, share: f64| {
        squares[kind][0] += share * share;
        squares[kind][1] += 1.0;
    };
    for seed in 0..200 {
        // The sum of twelve uniform numbers is nearly normal.
        let deviate = (0..12).map(|_| draw.between(-0.5, 0.5)).sum::<f64>();
        let turn = Angle::from_deg(2.0) * deviate;
        let setup = SpaceSetup {
            shape: SagittalShape::ALL[seed as usize % 5],
            habit: HABITS[seed as usize % 2],
            apical_rotation: Angle::from_deg(draw.between(0.0, 30.0)),
            largest_tilt: Angle::from_deg(draw.between(5.0, 35.0)),
            pedicles: false,
            corner_sd_mm: 0.5,
            lateral_scale: draw.between(0.9, 1.15),
            lateral_turn: turn,
            seed,
        };
        let phantom = generate_in_space(&setup);
        let (found, _) = measured(&phantom);
        let error = |level: Level| {
            let pitch = found.vertebra(level).expect("both films").orientation.pitch;
            (pitch - true_pitch(&phantom, level)).rad()
        };
        for vertebra in &found.vertebrae {
            add(0, error(vertebra.level) / found.pitch_sd(vertebra).rad());
            let true_axis = phantom.body(vertebra.level).expect("every level").cranial;
            let off = vertebra.orientation.cranial().cross(&true_axis).norm();
            add(1, off / found.axis_sd(vertebra).rad());
        }
        let place =
            |level: Level| found.vertebrae.iter().position(|v| v.level == level).expect("both");
        let [t5, t12] = [Level::T5, Level::T12].map(place);
        let covariance = found.pitch_covariance();
        let variance = covariance[(t5, t5)] + covariance[(t12, t12)] - 2.0 * covariance[(t5, t12)];
        add(2, (error(Level::T5) - error(Level::T12)) / variance.sqrt());
        add(3, (found.alignment.turn - turn).rad() / found.alignment.turn_sd().rad());
    }
    for ([sum, n], what) in squares.into_iter().zip(["pitch", "axis", "kyphosis", "turn"]) {
        let share = (sum / n).sqrt();
        assert!((0.8..1.15).contains(&share), "{what}: {share} of the stated deviation");
    }
}

#[test]
fn a_turned_lateral_film_and_one_of_another_patient_are_reported() {
    let setup = SpaceSetup { lateral_turn: Angle::from_deg(6.0), ..SpaceSetup::default() };
    let phantom = generate_in_space(&setup);
    let (found, warnings) = measured(&phantom);
    assert!(
        warnings.has(WarningCode::LateralTurned)
            && !warnings.has(WarningCode::LateralHeightsDiffer)
    );
    assert_near(found.alignment.turn.deg(), 6.0, 3.0 * found.alignment.turn_sd().deg(), "turn");
    // Taken as exposed together, the films contradict each other.
    let mut together = phantom.clone();
    if let Some(lateral) = &mut together.case.lateral {
        lateral.simultaneous = true;
    }
    let (found, warnings) = measured(&together);
    assert_eq!((found.alignment.scale, found.alignment.turn), (1.0, Angle::ZERO));
    assert!(warnings.has(WarningCode::LateralHeightsDiffer));
}

#[test]
fn a_film_exposed_together_gives_the_pitch_without_an_estimate() {
    let setup = SpaceSetup { corner_sd_mm: 0.3, ..SpaceSetup::default() };
    let mut phantom = generate_in_space(&setup);
    let free = measured(&phantom).0;
    if let Some(lateral) = &mut phantom.case.lateral {
        lateral.simultaneous = true;
    }
    let (found, warnings) = measured(&phantom);
    assert!(!warnings.has(WarningCode::LateralHeightsDiffer));
    assert_eq!(found.alignment.turn_sd(), Angle::ZERO);
    assert!(found.pitch_sd(&found.vertebrae[9]) < free.pitch_sd(&free.vertebrae[9]));
    // Without a spacing its scale is found all the same.
    if let Some(lateral) = &mut phantom.case.lateral {
        lateral.image.spacing = None;
    }
    let found = measured(&phantom).0;
    assert_near(found.alignment.scale, 0.1, 1e-3, "mm per pixel");
    assert_eq!(found.alignment.turn, Angle::ZERO);
}

#[test]
fn heights_of_few_vertebrae_differ_by_their_noise() {
    // Oracle: squares over their degrees of freedom are unbiased, here of five heights less an offset and a scale.
    let phantoms = 200;
    let squares = (0..phantoms).map(|seed| {
        let setup = SpaceSetup { corner_sd_mm: 0.5, seed, ..SpaceSetup::default() };
        let mut phantom = generate_in_space(&setup);
        let lateral = phantom.case.lateral.as_mut().expect("both films");
        lateral.simultaneous = true;
        lateral.image.spacing = None;
        for reading in &mut lateral.readings {
            reading.vertebrae.retain(|level, _| (Level::T12..=Level::T8).contains(level));
        }
        let found = measured(&phantom).0.alignment;
        assert_eq!(found.vertebrae, 5);
        (found.residual_mm / found.expected_mm).powi(2)
    });
    let mean = squares.sum::<f64>() / phantoms as f64;
    assert!((0.85..1.15).contains(&mean), "{mean} of the expected square");
}

/// The analysis of a phantom with noise, and 150 replicates of it.
fn replicated() -> (Analysis, Uncertainty) {
    let setup = SpaceSetup { corner_sd_mm: 0.5, ..SpaceSetup::default() };
    let phantom = generate_in_space(&setup);
    let nominal = analyze_movement(&phantom.case, &AnalysisOptions::default()).expect("good");
    let monte_carlo = MonteCarlo::new(&phantom.case, &nominal, LandmarkNoise::Measured, 1);
    let monte_carlo = monte_carlo.expect("sound noise");
    let found = common::replicated(&monte_carlo, 150);
    (nominal, found)
}

#[test]
fn replicates_vary_a_pitch_by_its_deviation() {
    let (nominal, found) = replicated();
    let space = nominal.movement.space.as_ref().expect("both films");
    for level in [Level::L3, Level::T12, Level::T8, Level::T4] {
        let quantity = QuantityKind::Pitch.on(Posture::Erect).at(level);
        let spread = found.of(quantity).expect("measured");
        let stated = space.pitch_sd(space.vertebra(level).expect("both films")).deg();
        let share = spread.spread.and_then(|found| found.sd).expect("values") / stated;
        assert!((0.8..1.2).contains(&share), "{level}: {share} of the stated deviation");
    }
}

/// Kyphosis and lordosis by the true axes.
#[test]
fn kyphosis_and_lordosis_in_space_match_the_true_axes() {
    for shape in SagittalShape::ALL {
        let phantom = generate_in_space(&SpaceSetup { shape, ..SpaceSetup::default() });
        let (found, _) = measured(&phantom);
        let measures = SpatialMeasures::of(&found, &[], &[]);
        assert_eq!(measures.sagittal.len(), SagittalPart::ALL.len());
        for angle in &measures.sagittal {
            let [low, high] = angle.part.ends().map(|level| true_pitch(&phantom, level));
            let turn = match angle.part {
                SagittalPart::LordosisL1L5 => low - high,
                _ => high - low,
            };
            assert_near(angle.axes_3d.value.deg(), turn.deg(), 1e-6, angle.part.key());
            assert!(turn.deg() > 0.0, "{shape:?}: {}", angle.part.key());
        }
        let polygon: f64 = phantom
            .bodies
            .windows(2)
            .map(|pair| (pair[1].midpoint_mm - pair[0].midpoint_mm).norm())
            .sum();
        assert_near(measures.length.length_3d_mm.value, polygon, 1e-6, "length");
        assert!(measures.length.length_2d_mm.value < polygon);
        assert_eq!(measures.length.ends, [Level::L5, Level::T1]);
    }
}

/// As the guide says.
#[test]
fn a_lateral_film_shows_two_degrees_of_kyphosis_too_many() {
    let (found, _) = measured(&generate_in_space(&SpaceSetup::default()));
    let measures = SpatialMeasures::of(&found, &[], &[]);
    let angle = measures.sagittal(SagittalPart::KyphosisT5T12).expect("both films");
    assert_near(angle.axes_2d.value.deg(), 31.5, 0.05, "2-D");
    assert_near(angle.axes_3d.value.deg(), 29.5, 0.05, "3-D");
}

/// On no vertical plane is the angle between the true axes of a curve's ends larger.
#[test]
fn no_plane_shows_a_larger_curve_than_the_plane_of_maximum_curvature() {
    let phantom = generate_in_space(&SpaceSetup::default());
    let analysis = analyze_movement(&phantom.case, &AnalysisOptions::default()).expect("good");
    let measures = analysis.movement.spatial_measures().expect("both films");
    assert_eq!(measures.curves.len(), analysis.movement.clinical.len());
    for curve in &measures.curves {
        let axis = |level| phantom.body(level).expect("every level").cranial;
        let [low, high] = [curve.ends.inferior, curve.ends.superior].map(axis);
        let angle = |axis: Vec3, azimuth: f64| {
            let (sin, cos) = azimuth.to_radians().sin_cos();
            Angle::from_sin_cos(axis.x * cos + axis.y * sin, axis.z)
        };
        let shown = |azimuth: f64| (angle(high, azimuth) - angle(low, azimuth)).deg();
        let largest = (0..3600).map(|i| shown(0.1 * f64::from(i))).fold(0.0, f64::max);
        assert_near(curve.angle_3d.value.deg(), largest, 1e-3, "angle");
        let in_space = curve.angle_3d.value;
        assert!(in_space >= curve.frontal_2d.value && in_space >= curve.lateral_2d.value);
        // The convexity lies opposite to where the upper axis leans.
        assert_near(shown(curve.convexity_3d.value.deg() + 180.0), largest, 1e-3, "convexity");
    }
}

#[test]
fn replicates_vary_the_numbers_in_space_by_their_deviations() {
    let (nominal, found) = replicated();
    let measures = nominal.movement.spatial_measures().expect("both films");
    let sd = |kind: QuantityKind| {
        found.spread(kind.on(Posture::Erect)).and_then(|spread| spread.sd).expect("measured")
    };
    for angle in &measures.sagittal {
        let share = sd(QuantityKind::sagittal(angle.part)) / angle.axes_3d.sd.deg();
        assert!((0.8..1.2).contains(&share), "{}: {share}", angle.part.key());
    }
    let share = sd(QuantityKind::SpinalLength) / measures.length.length_3d_mm.sd;
    assert!((0.8..1.2).contains(&share), "length: {share}");
}

/// The error of a profile that is the patient's own, but for this much more at the joint above L1.
fn error_of_turns_off_by(phantom: &SpacePhantom, off_deg: f64) -> TemplateError {
    let (found, _) = measured(phantom);
    let mut profile = found.profile(&SagittalProfile::default());
    profile.turns_deg[3] += off_deg;
    let analysis = analyze(&phantom.case, &AnalysisOptions::default()).expect("a good case");
    TemplateError::of(&analysis.movement, &profile).expect("a lateral film")
}

#[test]
fn the_error_of_a_template_is_the_difference_of_turns_that_it_was_given() {
    let phantom = generate_in_space(&SpaceSetup { corner_sd_mm: 0.4, ..SpaceSetup::default() });
    let own = error_of_turns_off_by(&phantom, 0.0);
    assert_eq!((own.vertebrae.len(), own.joints), (15, 14));
    assert_near(own.joint_rms.deg(), 0.0, 1e-9, "the patient's own turns");
    // The base of a model of the erect film alone is pitched so that the top stands above it: all vertebrae are off alike.
    let first = own.vertebrae[0].error();
    assert!(own.vertebrae.iter().all(|v| (v.error() - first).deg().abs() < 1e-9));
    let off = error_of_turns_off_by(&phantom, 10.0);
    assert_near(off.joint_rms.deg(), 10.0 / 14.0_f64.sqrt(), 1e-9, "one joint of 14");
    let step = |i: usize| (off.vertebrae[i + 1].error() - off.vertebrae[i].error()).deg();
    assert_near(step(3), 10.0, 1e-9, "L1/T12");
    assert_near(step(4), 0.0, 1e-9, "T12/T11");
    let squares = off.vertebrae.iter().map(|v| v.error().deg().powi(2)).sum::<f64>();
    assert_near(off.vertebra_rms.deg(), (squares / 15.0).sqrt(), 1e-9, "all vertebrae");
    let (worst, most) = off.worst();
    assert!(off.vertebrae.iter().all(|v| v.error().abs().deg() <= most.deg() + 1e-12));
    assert_near(
        off.vertebrae.iter().find(|v| v.level == worst).expect("named").error().abs().deg(),
        most.deg(),
        1e-12,
        "the worst one",
    );
}

#[test]
fn only_vertebrae_on_the_lateral_film_are_compared_with_the_template() {
    let mut phantom = generate_in_space(&SpaceSetup::default());
    for reading in &mut phantom.case.lateral.as_mut().expect("both films").readings {
        reading.vertebrae.retain(|level, _| ![Level::L2, Level::T7, Level::T2].contains(level));
    }
    let analysis = analyze(&phantom.case, &AnalysisOptions::default()).expect("a good case");
    let found = analysis.template_error().expect("a lateral film");
    assert_eq!((found.vertebrae.len(), found.joints), (12, 9));
    assert_eq!(analysis.pitch_source(Level::T7), PitchSource::Population);
    assert_eq!(analysis.pitch_source(Level::T8), PitchSource::LateralFilm);
    assert_eq!(analysis.axial_source(Level::T8), AxialSource::Unknown);
    phantom.case.lateral = None;
    let alone = analyze(&phantom.case, &AnalysisOptions::default()).expect("a good case");
    assert_eq!(alone.template_error(), None);
    assert_eq!(alone.pitch_source(Level::T8), PitchSource::Population);
}
