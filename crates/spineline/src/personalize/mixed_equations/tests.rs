use super::super::evidence::JointEvidence;
use super::*;
use crate::anatomy::Levels;
use crate::spatial::{Angle, Frontal, Vec3};

#[test]
fn rotations_that_a_load_adds_are_all_its_own() {
    // Oracle: generalised least squares are unbiased, so rotations by one load component change that component alone, by one.
    let joint = |k: usize| JointEvidence {
        rotation: Angle::from_deg(2.0 - (k as f64 * 1.7).cos()),
        centre_mm: Vec3::new(3.0, 5.0 * (k as f64).sin(), 30.0 * k as f64),
        disc_mm: Frontal::new(0.3, 6.0),
        to_evener_mm: Frontal::new(1.0, 0.2),
        hinge: Vec3::new(1.0, 0.0, 0.0),
        compliance_rad_per_nmm: 1e-5,
    };
    let film = |sign: f64| FilmEvidence {
        joints: (0..14)
            .map(joint)
            .map(|joint| JointEvidence { rotation: joint.rotation * sign, ..joint })
            .collect(),
        tilt_sd: Angle::from_deg(0.5),
        erect_tilt_sd: Angle::from_deg(0.3),
        tilt_degrees_of_freedom: [Some(15); 2],
        levels: Levels::COMPLETE,
        tilt_covariances: None,
    };
    let films = [film(1.0), film(-0.6)];
    let films: Vec<&FilmEvidence> = films.iter().collect();
    let shares = JointShares(DMatrix::from_fn(14, 3, |joint, group| {
        f64::from(u8::from(joint / 5 == group))
    }));
    let waves = Waves::new(14);
    let mut fit = Fit::new(&films, 0.0, &shares, &waves).expect("films");
    fit.solve_loads(None).expect("loads");
    let at = fit.linearize(MAX_VARIANCES * 1e-2).expect("equations");
    let columns = &fit.by_loads.columns;
    let mut own = fit.loads_by_errors(&at) * columns;
    for (mut column, scale) in own.column_iter_mut().zip(&fit.by_loads.scales) {
        column *= *scale;
    }
    assert!((own - DMatrix::identity(6, 6)).amax() < 1e-6);
}
