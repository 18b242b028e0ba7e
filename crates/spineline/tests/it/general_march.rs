//! The general solver against the march, where both apply.

use crate::common::chain::{loads, proportional};
use crate::common::everything::draw_vector;
use crate::common::{Draw, spine};
use spineline::multibody::{
    BodyLoad, GeneralStatics, Goal, PathEnding, PathOptions, Solution, SpineModel, Statics,
    Support, Wrench,
};
use spineline::spatial::{Mat3, Vec3};

/// Newton's last step is below 1e-9 rad, and the error is its square; the lever is half a metre.
const AGREE_MM: f64 = 1e-9;

/// One of the 18 erect spines, bent further at every joint.
fn draw_spine(draw: &mut Draw) -> SpineModel {
    let model = spine(draw.below(18)).1;
    let centres: Vec<Vec3> = model
        .joints
        .iter()
        .map(|joint| joint.centre_in_inferior_mm + draw_vector(draw, 3.0))
        .collect();
    let midpoints = model.midpoints_mm.iter().map(|place| place + draw_vector(draw, 4.0)).collect();
    let turn = |draw: &mut Draw| nalgebra::Rotation3::new(draw_vector(draw, 0.1)).into_inner();
    let axes = model.axes.iter().map(|axes| turn(draw) * axes).collect();
    let model = SpineModel::from_poses(midpoints, axes, &centres);
    // Half of the spines carry something in the erect posture.
    if draw.below(2) == 0 {
        return model;
    }
    model.carrying(&[(); 14].map(|()| draw_vector(draw, 20.0)))
}

#[test]
fn newton_and_march_agree() {
    // Oracle: the march, explicit, verified against other programs elsewhere.
    let mut draw = Draw::new(11);
    for trial in 0..1000 {
        let model = draw_spine(&mut draw);
        let springs: Vec<[f64; 3]> =
            model.joints.iter().map(|_| [(); 3].map(|()| draw.between(4e4, 6e5))).collect();
        let support = if trial % 4 == 0 { Support::Frontal } else { Support::Free };
        let (force_n, point_mm) = (
            draw_vector(&mut draw, 60.0),
            draw_vector(&mut draw, 200.0) + Vec3::new(0.0, 0.0, 200.0),
        );
        let moment_nmm = draw_vector(&mut draw, 5000.0);
        let mut solution = Solution::default();
        let wrench = Wrench::at(point_mm, force_n);
        let wrench = Wrench { moment_nmm: wrench.moment_nmm + moment_nmm, ..wrench };
        let statics = Statics::from_stiffness(&model, springs.clone(), &[0; 14], support);
        statics.march(&wrench, &[], &[], &mut solution);
        if solution.deformed.largest_hinge_rad() > 0.7 {
            continue;
        }
        let diagonal = springs.iter().map(|k| Mat3::from_diagonal(&Vec3::from(*k)));
        let general = GeneralStatics::new(&model, diagonal, support).expect("sound springs");
        let both = [BodyLoad::ForceOnLine { force_n, point_mm }, BodyLoad::Moment { moment_nmm }];
        let loading = loads(both.map(|load| proportional(14, load)));
        let path =
            general.follow(&loading, Goal::FullLoad, &PathOptions::default()).expect("sound");
        assert_eq!(path.ending, PathEnding::Converged, "trial {trial}");
        let found = path.result().expect("converged");
        for (ours, theirs) in
            found.deformed.midpoints_mm.iter().zip(&solution.deformed.midpoints_mm)
        {
            let off = (ours - theirs).norm();
            assert!(off <= AGREE_MM, "trial {trial}: {off:e} mm, {} points", path.points.len());
        }
    }
}
