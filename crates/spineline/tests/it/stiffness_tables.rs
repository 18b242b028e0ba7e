//! Named springs against measured spines: ranges of motion under the moments of the experiments.

use spineline::anatomy::Level;
use spineline::multibody::StiffnessTable;
use spineline::spatial::Angle;

/// Range of motion in both directions together about lateral, flexion and axial axes, in degrees, of the joint below a vertebra.
fn range_deg(table: StiffnessTable, superior: Level, moment_nm: f64) -> [f64; 3] {
    let library = table.library();
    let joint = library.rows().iter().find(|row| row.superior == superior).expect("a joint");
    joint.nmm_per_rad.map(|k| 2.0 * Angle::from_rad(1000.0 * moment_nm / k).deg())
}

#[test]
fn thoracic_joints_in_vitro_have_the_published_range() {
    for superior in [Level::T2, Level::T3, Level::T4, Level::T5, Level::T6] {
        let [lateral, flexion, axial] = range_deg(StiffnessTable::InVitro, superior, 7.5);
        assert!((10.0..=12.0).contains(&lateral), "{superior}: {lateral}");
        assert!((6.0..=8.0).contains(&flexion) && (10.0..=12.0).contains(&axial), "{superior}");
    }
    for superior in [Level::T7, Level::T8, Level::T9, Level::T10, Level::T11] {
        let [lateral, ..] = range_deg(StiffnessTable::InVitro, superior, 7.5);
        assert!((8.0..=9.0).contains(&lateral), "{superior}: {lateral}");
    }
    for superior in [Level::T10, Level::T11] {
        let [.., axial] = range_deg(StiffnessTable::InVitro, superior, 7.5);
        assert!((7.0..=8.0).contains(&axial), "{superior}: {axial}");
    }
    // The table of motion segments is stiffer than measured thoracic segments, and less stiff than with ribs in scoliosis.
    let [segments, ..] = range_deg(StiffnessTable::MotionSegments, Level::T5, 7.5);
    assert!((5.7..5.9).contains(&segments), "{segments}");
}

#[test]
fn the_joint_between_thorax_and_loins_has_the_mean_of_its_neighbours_springs() {
    // The table of scoliotic spines has the proportions of motion segments, joint by joint.
    for table in StiffnessTable::ALL.into_iter().filter(|t| *t != StiffnessTable::ScolioticInVivo) {
        // A range is proportional to one over the stiffness.
        let [below, own, above] = [Level::L1, Level::T12, Level::T11]
            .map(|superior| range_deg(table, superior, 7.5).map(|range| 1.0 / range));
        for axis in 0..3 {
            let mean = 0.5 * (below[axis] + above[axis]);
            assert!((own[axis] / mean - 1.0).abs() < 1e-9, "{table:?}, axis {axis}");
        }
    }
}

#[test]
fn ribs_stiffen_the_thoracic_spine_alone() {
    let ratio = |superior| {
        let [with, without] = [StiffnessTable::IntactChest, StiffnessTable::InVitro]
            .map(|table| range_deg(table, superior, 7.5));
        [0, 1, 2].map(|axis| without[axis] / with[axis] - 1.0)
    };
    for (axis, published) in ratio(Level::T6).into_iter().zip([0.635, 0.63, 0.588]) {
        assert!((axis - published).abs() < 1e-9, "{axis}");
    }
    assert_eq!(ratio(Level::L2), [0.0; 3]);
}

#[test]
fn scoliotic_segments_bend_as_measured_in_surgery() {
    let table = StiffnessTable::ScolioticInVivo.library();
    for joint in table.rows() {
        let deg_per_nm = Angle::from_rad(1000.0 / joint.nmm_per_rad[0]).deg();
        assert!((deg_per_nm - 0.18).abs() < 1e-9, "{}: {deg_per_nm}", joint.superior);
    }
}
