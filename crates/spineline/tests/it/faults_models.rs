//! Invalid springs, amplitudes out of reach, and endings without results.

use crate::common::{assert_near, exact_case, outline, spine, usual_regions, warned};
use spineline::action::{LineError, LineOfAction};
use spineline::analysis::{AnalysisOptions, Reference, analyze_movement};
use spineline::anatomy::{Level, Levels, Posture};
use spineline::error::Error;
use spineline::evaluate::{FilmUnderLine, ForceChoice, Target, simulate};
use spineline::multibody::{
    FittedSprings, ForceSign, JointGroups, JointStiffness, Load, PathEnding, Residual, Statics,
    StiffnessError, StiffnessLibrary, StiffnessTable, Support, amplitude_matches, match_amplitude,
};
use spineline::personalize::{FitSettings, FitStatus, Gauge, personalize};
use spineline::spatial::{Angle, Frontal};
use spineline::warning::{Step, WarningCode};

fn left_of(residual: Residual) -> Angle {
    let Residual::Amplitude(left) = residual else { panic!("an amplitude was sought") };
    left
}

fn rows() -> Vec<JointStiffness> {
    StiffnessLibrary::default().rows().to_vec()
}

#[track_caller]
fn refused(rows: Vec<JointStiffness>, named: &[&str]) -> StiffnessError {
    let error = StiffnessLibrary::from_rows(rows).expect_err("a table that cannot be used");
    let text = error.to_string();
    for part in named {
        assert!(text.contains(part), "`{text}` does not name {part}");
    }
    let wrapped = Error::from(error.clone());
    assert!(!wrapped.help().is_empty());
    assert_eq!((wrapped.step(), wrapped.to_string()), (Step::Multibody, text));
    error
}

#[test]
fn the_order_of_rows_does_not_change_the_library() {
    // Oracle: a joint is known by its vertebrae.
    let mut shuffled = rows();
    shuffled.reverse();
    shuffled.swap(2, 9);
    assert_eq!(StiffnessLibrary::from_rows(shuffled), Ok(StiffnessLibrary::default()));
}

#[test]
fn a_joint_without_stiffness_is_named() {
    // Oracle: 14 joints need 14 rows.
    let mut rows = rows();
    let gone = rows.remove(4);
    let (inferior, superior) = (gone.inferior, gone.superior);
    let error = refused(rows, &[inferior.name(), superior.name()]);
    assert_eq!(error, StiffnessError::Missing { inferior, superior });
}

#[test]
fn a_joint_with_two_rows_is_named() {
    // Oracle: which of the two would count?
    let mut rows = rows();
    rows.push(JointStiffness { source: "another".into(), ..rows[6].clone() });
    let (inferior, superior) = (rows[6].inferior, rows[6].superior);
    let error = refused(rows, &[inferior.name(), superior.name()]);
    assert_eq!(error, StiffnessError::Twice { inferior, superior });
}

#[test]
fn a_coupling_that_no_joint_has_is_named_with_its_value() {
    for value in [-2.1, f64::NAN, f64::INFINITY] {
        let mut rows = rows();
        rows[0].axial_per_lateral = value;
        let error = refused(rows, &["L4", "L3", "axial rotation", &value.to_string()]);
        assert!(matches!(error, StiffnessError::Coupling { inferior: Level::L4, .. }));
    }
}

#[test]
fn a_stiffness_that_is_not_positive_is_named_with_axis_and_value() {
    // Oracle: a spring pushes back.
    for (axis, name) in ["lateral", "flexion", "axial"].into_iter().enumerate() {
        for value in [-132.0, 0.0, f64::NAN, f64::INFINITY] {
            let mut rows = rows();
            rows[0].nmm_per_rad[axis] = value;
            let nm_per_rad = (value / 1000.0).to_string();
            let error = refused(rows, &["L4", "L3", name, "N·m/rad", &nm_per_rad]);
            assert!(matches!(error, StiffnessError::Value { inferior: Level::L4, .. }));
        }
    }
}

#[test]
fn stiffness_in_another_unit_is_doubted_and_with_newtons_refused_with_the_unit() {
    // Oracle: 1 N·m is 1000 N·mm, and 1 rad is 57.3°. A common factor of all springs changes no shape and no ratio.
    let case = exact_case(0);
    let analysis = |options: AnalysisOptions| analyze_movement(&case, &options);
    for table in StiffnessTable::ALL {
        let scaled = |factor: f64| -> Vec<JointStiffness> {
            let rows = table.library().rows().to_vec();
            let scaled = |row: JointStiffness| JointStiffness {
                nmm_per_rad: row.nmm_per_rad.map(|value| factor * value),
                ..row
            };
            rows.into_iter().map(scaled).collect()
        };
        for (factor, unit) in [
            (1000.0, "like N·mm/rad,"),
            (1000.0 / 57.3, "N·mm per degree"),
            (1.0 / 57.3, "N·m per degree"),
            (0.001, "kN·m/rad"),
        ] {
            let library = StiffnessLibrary::from_rows(scaled(factor)).expect("relative springs");
            let relative = AnalysisOptions { library, ..AnalysisOptions::default() };
            let gauge = Gauge::KnownForce { posture: Posture::LeftBending, force_n: 50.0 };
            let error = analysis(AnalysisOptions { gauge, ..relative.clone() }).expect_err(unit);
            assert!(error.to_string().contains(unit), "{error}");
            assert!(matches!(error, Error::Stiffness(StiffnessError::Unit { .. })), "{error}");
            let reference = Reference::Loaded { body_mass_kg: 45.0 };
            assert!(analysis(AnalysisOptions { reference, ..relative.clone() }).is_err(), "{unit}");
            let doubted = analysis(relative).expect("ratios of springs");
            let text = &warned(&doubted, WarningCode::StiffnessUnusual, None).message;
            assert!(text.contains(unit), "{text}");
        }
        for factor in [0.3, 0.5, 2.0, 3.0] {
            let library = StiffnessLibrary::from_rows(scaled(factor)).expect("springs");
            assert_eq!(library.check_unit(), Ok(()), "{factor}");
        }
    }
}

#[test]
fn one_joint_far_beyond_all_joints_is_named() {
    for nm_per_rad in [0.9, 11_000.0] {
        let mut rows = rows();
        rows[0].nmm_per_rad[0] = 1000.0 * nm_per_rad;
        let error = refused(rows, &["L4", "L3", "lateral", &nm_per_rad.to_string()]);
        assert!(matches!(error, StiffnessError::Lateral { inferior: Level::L4, .. }));
    }
    // Springs that lock flexion and axial rotation.
    let mut rows = rows();
    rows.iter_mut().for_each(|row| row.nmm_per_rad[1] *= 1e4);
    assert!(StiffnessLibrary::from_rows(rows).is_ok());
}

#[test]
fn two_points_too_near_for_a_line_are_refused_with_their_distance() {
    // Oracle: 19 mm is below the stated least gap of 20 mm.
    let error = LineOfAction::through(Frontal::new(0.0, 100.0), Frontal::new(0.0, 119.0));
    let error = error.expect_err("too near");
    assert_eq!(error, LineError::TooShort { gap_mm: 19.0, limit_mm: 20.0 });
    assert!(error.to_string().contains("19.0 mm") && error.to_string().contains("20 mm"));
    let nowhere = LineOfAction::through(Frontal::new(f64::NAN, 100.0), Frontal::new(0.0, 300.0));
    assert!(nowhere.is_err());
}

fn load() -> Load {
    Load::along(LineOfAction::leaning(Frontal::new(-15.0, 150.0), Angle::ZERO), 0.0)
}

/// Springs of which only the lateral one above L4 gives way, so that the spine leans by what that hinge turns.
fn one_soft_joint() -> Vec<[f64; 3]> {
    (0..14).map(|joint| [if joint == 0 { 1e5 } else { 1e9 }, 1e9, 1e9]).collect()
}

/// A hinge is followed to 0.8 rad and at most one step of 0.15 rad beyond: 54°.
const OUT_OF_REACH: Angle = Angle::from_deg(100.0);

#[test]
fn an_unreachable_amplitude_reports_the_remaining_difference() {
    // Oracle: one hinge that turns by less than a radian does not lateral tilt the spine by 100°.
    let (_, model) = spine(0);
    for support in [Support::Free, Support::Frontal] {
        let statics = Statics::from_stiffness(&model, one_soft_joint(), &[0; 14], support);
        for sign in ForceSign::ALL {
            let end = match_amplitude(&statics, &load(), sign, OUT_OF_REACH);
            assert_eq!(end.status, PathEnding::Unreachable);
            assert!(!end.is_usable() && end.evaluations > 1);
            // The residual belongs to the shape that is returned.
            let left = (end.solution.deformed.lateral_tilt() - OUT_OF_REACH).wrapped();
            assert_near(left_of(end.residual).rad(), left.rad(), 1e-12, "residual");
            assert!(left.abs() > Angle::from_deg(30.0));
        }
        let all = amplitude_matches(&statics, &load(), OUT_OF_REACH);
        assert_eq!((all.len(), all[0].is_usable()), (1, false));
        assert_eq!(all[0].status, PathEnding::Unreachable);
    }
}

#[test]
fn a_pull_along_the_spine_gives_small_amplitudes_only() {
    // Oracle: tension turns a chain towards its line, and no further.
    let (_, model) = spine(0);
    let (library, groups) = (StiffnessLibrary::default(), JointGroups::per_joint(Levels::COMPLETE));
    let statics = Statics::new(&model, &library, &groups, &[0.0; 14], Support::Frontal);
    let target = Angle::from_deg(60.0);
    let end = match_amplitude(&statics, &load(), ForceSign::Positive, target);
    assert_eq!(end.status, PathEnding::Unreachable);
    assert!(left_of(end.residual).abs() > Angle::from_deg(20.0));
}

#[test]
fn every_force_that_is_found_meets_the_amplitude() {
    // Oracle: solving at the found force gives the target lateral tilt.
    let (erect, model) = spine(0);
    let (library, groups) = (StiffnessLibrary::default(), JointGroups::per_joint(Levels::COMPLETE));
    let statics = Statics::new(&model, &library, &groups, &[0.0; 14], Support::Frontal);
    let tilt = erect.vertebrae[14].location.lateral_tilt();
    for change_deg in [-12.0, -4.0, 4.0, 12.0] {
        let target = tilt + Angle::from_deg(change_deg);
        for found in amplitude_matches(&statics, &load(), target) {
            if found.is_usable() {
                // An amplitude counts as met at 1e-9 rad.
                assert_near(
                    found.solution.deformed.lateral_tilt().rad(),
                    target.rad(),
                    1e-9,
                    "lean",
                );
            }
        }
    }
}

#[test]
fn a_simulation_of_an_unreachable_amplitude_is_not_a_result() {
    // Oracle: one hinge that turns by less than a radian does not lateral tilt the spine by 100°.
    let (erect, model) = spine(0);
    let statics = Statics::from_stiffness(&model, one_soft_joint(), &[0; 14], Support::Frontal);
    let mut vertebrae: Vec<(Frontal, Angle)> =
        erect.vertebrae.iter().map(|v| (v.location, v.tilt)).collect();
    vertebrae[14].0 = Frontal::leaning(OUT_OF_REACH) * 200.0;
    let film = outline(Posture::RightBending, &vertebrae);
    let Load::Line { line, depth_mm } = load() else { unreachable!("a line") };
    let regions = usual_regions();
    let film = FilmUnderLine { outline: &film, line, depth_mm };
    let end = simulate(&statics, film, &regions, Target::Amplitude);
    assert_eq!(end.status, PathEnding::Unreachable);
    assert!(
        !end.is_usable() && end.alternatives.is_empty() && left_of(end.residual).abs().rad() > 0.01
    );
    assert_eq!(end.choice, ForceChoice::NearestMiss);
}

#[test]
fn of_several_forces_the_one_with_the_smallest_ferguson_error_is_chosen_and_reported() {
    // Oracle: a film made with one of the forces that meet a lateral tilt has no Ferguson error under that force.
    let (erect, model) = spine(0);
    let (library, groups) = (StiffnessLibrary::default(), JointGroups::per_joint(Levels::COMPLETE));
    let statics = Statics::new(&model, &library, &groups, &[0.0; 14], Support::Frontal);
    let Load::Line { line, depth_mm } = load() else { unreachable!("a line") };
    let tilt = erect.vertebrae[14].location.lateral_tilt();
    let mut several = 0;
    for change_deg in [-12.0, -4.0, 4.0, 12.0] {
        let all = amplitude_matches(&statics, &load(), tilt + Angle::from_deg(change_deg));
        // A shape beyond the human range is not an alternative.
        let within: Vec<_> = all
            .iter()
            .filter(|made| made.is_usable())
            .filter(|made| made.solution.deformed.beyond_human_range(&model).is_none())
            .collect();
        for made in &within {
            let shape = &made.solution.deformed;
            let vertebrae: Vec<_> = (0..15).map(|i| (shape.location(i), shape.tilt(i))).collect();
            let film = outline(Posture::LeftBending, &vertebrae);
            let regions = usual_regions();
            let film = FilmUnderLine { outline: &film, line, depth_mm };
            let end = simulate(&statics, film, &regions, Target::Amplitude);
            assert_near(end.force_n, made.force_n, 1e-6 * made.force_n.abs().max(1.0), "force");
            assert_eq!((end.alternatives.len(), end.lost_forces), (within.len() - 1, 0));
            let alone = within.len() == 1;
            let choice = if alone { ForceChoice::OnlyOne } else { ForceChoice::LeastFergusonError };
            assert_eq!(end.choice, choice);
            several += usize::from(!alone);
        }
    }
    assert!(several > 0, "no lean is met by several forces");
}

#[test]
fn without_films_there_is_no_fit_and_no_panic() {
    // Oracle: no data, no minimum.
    let (erect, model) = spine(0);
    let library = StiffnessLibrary::default();
    let regions = usual_regions();
    let groups = JointGroups::regional(&regions);
    let settings = FitSettings::of_shapes(&regions, Support::Frontal);
    let springs =
        FittedSprings { model: &model, erect: &erect, library: &library, groups: &groups };
    let fit = personalize(springs, &[], &settings, None);
    assert_eq!(fit.status, FitStatus::NotEvaluable);
    assert_eq!((fit.log_multipliers, fit.loads.len()), (vec![0.0; 3], 0));
    assert!(fit.residual_rms.is_nan());
}
