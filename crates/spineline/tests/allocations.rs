//! The march and Newton's inner loop do not allocate, and a cohort keeps little of a patient.
//!
//! A separate executable: `allocation_counter` replaces the allocator of the whole program with one that counts, which
//! would slow all other tests.

#[path = "it/common/mod.rs"]
mod common;

use allocation_counter::measure;
use common::spine;
use spineline::analysis::{AnalysisOptions, analyze};
use spineline::anatomy::Levels;
use spineline::cohort::{Cohort, CohortPatient};
use spineline::multibody::{
    BodyLoad, GeneralStatics, Loading, Parameter, Rod, Solution, Statics, Support, Timing, Wrench,
};
use spineline::spatial::{Mat3, Vec3};
use spineline_phantom::{Readers, Scenario, generate};

const SPRING: [f64; 3] = [140e3, 140e3, 250e3];

#[test]
fn the_march_does_not_allocate_into_a_sized_solution() {
    let (_, model) = spine(0);
    let statics = Statics::from_stiffness(&model, [SPRING; 14], &[0; 14], Support::Free);
    let wrench = Wrench::at(Vec3::new(0.0, 5.0, 300.0), Vec3::new(0.0, 30.0, -10.0));
    let parameters = [Parameter::Load(0), Parameter::LogStiffness(0)];
    let mut solution = Solution::default();
    let mut march = || statics.march(&wrench, &[wrench], &parameters, &mut solution);
    march();
    assert_eq!(measure(march).count_total, 0);
}

#[test]
fn newton_does_not_allocate_under_any_load() {
    let (_, model) = spine(0);
    let springs = (0..14).map(|_| Mat3::from_diagonal(&Vec3::from(SPRING)));
    let statics = GeneralStatics::new(&model, springs, Support::Free).expect("sound springs");
    let pad = BodyLoad::Pad {
        point_in_vertebra_mm: Vec3::new(0.0, -40.0, 0.0),
        direction: Vec3::y(),
        n_per_mm: 5.0,
        advance_mm: 10.0,
    };
    let mut loading = Loading::single(7, pad);
    loading.items.extend(Loading::gravity(Levels::COMPLETE, 300.0, -Vec3::z(), Timing::Constant));
    loading.rods.push(Rod::locking(4, 10, Timing::Constant));
    let mut work = statics.work(&loading).expect("sound loads");
    let mut converged = false;
    let counted = measure(|| converged = statics.solve_near(&loading, 1.0, &mut work));
    assert!(converged);
    assert_eq!(counted.count_total, 0);
}

#[test]
fn a_patient_of_a_cohort_takes_few_bytes_in_few_pieces() {
    let case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("a phantom").case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("an analysis");
    let patient = CohortPatient::of(&analysis);
    let mut copy = None;
    let counted = measure(|| copy = Some(patient.clone()));
    assert_eq!(copy.as_ref(), Some(&patient));
    let bytes = counted.bytes_max + size_of::<CohortPatient>() as u64;
    assert!(bytes < 9_500, "{bytes} bytes");
    assert!(counted.count_total < 40, "{} pieces", counted.count_total);
    let most = |times: usize| {
        let patients = vec![patient.clone(); times];
        measure(|| assert_eq!(Cohort::of(&patients, 1).patients, times)).bytes_max
    };
    let [few, many] = [most(100), most(400)];
    let per_patient = many.saturating_sub(few) / 300;
    assert!(per_patient < 7_000, "{per_patient} bytes per patient for statistics");
}
