//! Phantoms: the same for the same seed, with the angles of the paper's Table 1.

use spineline::analysis::analyze;
use spineline::anatomy::Posture;
use spineline::clinical::ClinicalCurve;
use spineline::spatial::Angle;
use spineline_phantom::{
    Build, Construction, Phantom, PhantomError, Readers, SUBJECTS, Scenario, TableRow, generate,
    generate_built,
};

/// The angle is set on the curve itself; between vertebrae its largest tilts are interpolated.
const COBB_DEG: f64 = 0.1;
/// Stokes 1993 and the design: about 1.35 on films, 1.57 for a half-sine, 2 for an arc.
const COBB_BY_FERGUSON: std::ops::Range<f64> = 1.2..1.7;

fn phantom(index: usize, scenario: Scenario, readers: &Readers, seed: u64) -> Phantom {
    generate(index, scenario, readers, seed).expect("all 18 subjects have phantoms")
}

/// Index of the main curve's region, caudal first.
fn main_region(row: &TableRow) -> usize {
    let cobb = row.cobb_deg();
    (0..3).max_by(|&a, &b| cobb[a].total_cmp(&cobb[b])).expect("three regions")
}

/// Largest value of a sampled function near its largest sample: the vertex of the parabola through three samples.
fn peak(values: &[f64]) -> f64 {
    let at = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).expect("values");
    if at == 0 || at + 1 == values.len() {
        return values[at];
    }
    let (a, b, c) = (values[at - 1], values[at], values[at + 1]);
    b + (c - a).powi(2) / (8.0 * (2.0 * b - a - c))
}

#[test]
fn a_phantom_depends_on_its_seed_only() {
    // Oracle: equality of every number, printed in full.
    for scenario in Scenario::PAPER {
        for readers in [Readers::exact(), Readers::default()] {
            let [first, again, other] = [7, 7, 8].map(|seed| phantom(4, scenario, &readers, seed));
            assert_eq!(first, again);
            assert_eq!(format!("{first:?}"), format!("{again:?}"));
            assert_ne!(first.postures, other.postures);
            assert_ne!(first.case.films, other.case.films);
        }
    }
}

#[test]
fn all_scenarios_of_a_subject_share_one_erect_spine() {
    // Oracle: anatomy has a separate random stream, so only the movement differs.
    for index in 0..SUBJECTS.len() {
        let erect = Scenario::PAPER.map(|scenario| {
            let phantom = phantom(index, scenario, &Readers::exact(), 3);
            phantom.posture(Posture::Erect).expect("an erect posture").clone()
        });
        assert_eq!(erect[0], erect[1]);
        assert_eq!(erect[0], erect[2]);
    }
}

#[test]
fn the_main_curve_has_the_cobb_angle_of_table_one() {
    // Oracle: the angles printed in Table 1 of the paper.
    let printed =
        [49, 53, 46, 48, 53, 53, 48, 55, 59, 86, 62, 59, 59, 48, 61, 46, 53, 70].map(f64::from);
    for (index, row) in SUBJECTS.iter().enumerate() {
        let phantom = phantom(index, Scenario::Bend, &Readers::exact(), 1);
        let erect = phantom.posture(Posture::Erect).expect("an erect posture");
        let tilts: Vec<f64> = erect.tilts.iter().map(|tilt| tilt.deg()).collect();
        // The lumbar curve turns right from L4's zero; the main thoracic one turns left from there.
        let rightmost = peak(&tilts);
        let leftmost = -peak(&tilts.iter().map(|tilt| -tilt).collect::<Vec<f64>>());
        let cobb = if main_region(row) == 0 { rightmost } else { rightmost - leftmost };
        let off = cobb - printed[index];
        assert!(off.abs() <= COBB_DEG, "subject {}: {cobb:.3}°, off {off:.3}°", row.number);
    }
}

fn check_by_ferguson(
    of: impl Fn(&TableRow) -> bool,
    size: impl Fn(&ClinicalCurve) -> Angle,
    range: std::ops::Range<f64>,
) {
    for (index, row) in SUBJECTS.iter().enumerate().filter(|(_, row)| of(row)) {
        let phantom = phantom(index, Scenario::Bend, &Readers::exact(), 1);
        let analysis = analyze(&phantom.case, &Default::default()).expect("a sound case");
        let curve = &analysis.movement.clinical[main_region(row)];
        let ratio = (size(curve).rad() / curve.ferguson[0].1.rad()).abs();
        assert!(range.contains(&ratio), "subject {}: ratio {ratio:.3}", row.number);
    }
}

#[test]
fn cobb_angles_of_main_thoracic_curves_exceed_ferguson_angles_as_on_films() {
    // Oracle: the ratio on films of scoliosis.
    check_by_ferguson(|row| main_region(row) == 1, ClinicalCurve::erect_size, COBB_BY_FERGUSON);
}

#[test]
fn main_lumbar_curves_rotate_most_above_l4_and_exceed_an_arc() {
    // Oracle: an arc of a circle has a ratio of 2. Films have less; a curve that starts at full bend above L4, as in
    // these two phantoms, has more. This known difference from films is documented.
    let tilt_range = |curve: &ClinicalCurve| curve.angles[0].1.tilt_range;
    check_by_ferguson(|row| main_region(row) == 0, tilt_range, 2.0..2.3);
}

#[test]
fn a_subject_beyond_the_table_is_refused_by_its_number() {
    // Oracle: Table 1 has 18 rows.
    let error = generate(18, Scenario::Rod, &Readers::exact(), 1).expect_err("there are 18");
    assert_eq!(error, PhantomError::NoSubject { number: 19 });
    assert!(error.to_string().contains("19"));
}

/// Oracle: the left bend leans further left than the right bend.
fn check_bends(index: usize, scenario: Scenario) {
    let phantom = phantom(index, scenario, &Readers::exact(), 1);
    let tilt = |posture| {
        let top = phantom.posture(posture).expect("all five postures").locations[14];
        top.lateral_tilt()
    };
    assert!(tilt(Posture::LeftBending) < tilt(Posture::RightBending));
    let postures: Vec<Posture> = phantom.case.films.iter().map(|f| f.posture).collect();
    assert_eq!(postures, Posture::ALL);
}

#[test]
fn bends_of_phantoms_tilt_to_their_sides_and_films_are_complete() {
    for scenario in Scenario::PAPER {
        for index in 0..SUBJECTS.len() {
            check_bends(index, scenario);
        }
    }
}

#[test]
fn spines_that_nearly_buckle_have_bends() {
    // The change of shape by a load changes the moments by nearly as much again.
    for (index, scenario) in
        [(9, Scenario::Lateral), (10, Scenario::Lateral), (10, Scenario::TwoForces)]
    {
        check_bends(index, scenario);
    }
}

#[test]
fn a_repeated_analysis_is_equal_to_the_last_digit() {
    // Oracle: Debug prints every f64 so that it reads back to the same bits.
    for scenario in Scenario::PAPER {
        let case = phantom(2, scenario, &Readers::default(), 1).case;
        let [first, again] =
            [0, 1].map(|_| analyze(&case, &Default::default()).expect("a sound case"));
        assert_eq!(format!("{first:?}"), format!("{again:?}"));
    }
}

#[test]
fn every_construction_has_the_curve_of_its_row_and_moves() {
    // Oracle: Table 1. Readers without error see the true places.
    for construction in Construction::ALL {
        let build = Build { construction, joint_log_sd: 0.12 };
        let phantom =
            generate_built(4, Scenario::Rod, &Readers::exact(), 3, build).expect("a phantom");
        let erect = phantom.posture(Posture::Erect).expect("a film");
        let tilts = || erect.tilts.iter().map(|tilt| tilt.deg());
        let most = tilts().fold(f64::MIN, f64::max) - tilts().fold(f64::MAX, f64::min);
        // The largest difference between two vertebrae is a little less than the curve's at its inflections.
        assert!((50.0..=53.1).contains(&most), "{construction:?}: {most}");
        let bend = phantom.posture(Posture::LeftBending).expect("a film");
        assert!((bend.tilts[14] - erect.tilts[14]).abs().deg() > 5.0, "{construction:?}");
    }
}

#[test]
fn a_force_at_the_top_turns_all_joints_of_every_construction_to_its_side() {
    // Oracle: the moment of a horizontal force at T2 has one sign below it.
    let rotations = |construction| {
        let build = Build { construction, joint_log_sd: 0.0 };
        let phantom =
            generate_built(4, Scenario::Pull, &Readers::exact(), 3, build).expect("a phantom");
        let turns = |posture| {
            let film = phantom.posture(posture).expect("a film");
            film.tilts.windows(2).map(|pair| (pair[1] - pair[0]).rad()).collect::<Vec<f64>>()
        };
        let (erect, bent) = (turns(Posture::Erect), turns(Posture::RightBending));
        erect.iter().zip(&bent).map(|(a, b)| b - a).collect::<Vec<f64>>()
    };
    for construction in Construction::ALL {
        let rotations = rotations(construction);
        assert!(rotations.iter().all(|turn| *turn > 0.0), "{construction:?}: {rotations:?}");
    }
}

#[test]
fn scenarios_without_forces_need_a_rod() {
    let build = Build { construction: Construction::Discs, joint_log_sd: 0.0 };
    let error =
        generate_built(0, Scenario::Bend, &Readers::exact(), 1, build).expect_err("no forces");
    assert!(error.to_string().contains("discs"), "{error}");
}
