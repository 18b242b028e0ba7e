//! The march and Newton's inner loop do not allocate, and a cohort keeps little of a patient.
//!
//! An executable of its own: `allocation_counter` replaces the allocator of the whole program with one that counts, which
//! would slow all other tests.

#[path = "it/common/mod.rs"]
mod common;

use std::num::NonZeroUsize;

use allocation_counter::measure;
use common::spine;
use spineline::analysis::{AnalysisOptions, analyze};
use spineline::anatomy::Levels;
use spineline::cohort::{
    Cohort, CohortPatient, CohortRows, CohortSource, Listed, OneThread, TakePart,
};
use spineline::multibody::{
    BodyLoad, GeneralStatics, Loading, Parameter, Rod, Solution, Statics, Support, Timing, Wrench,
};
use spineline::spatial::{Mat3, Vec3};
use spineline_phantom::{Readers, Truth, generate};

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
    let counted = measure(|| converged = statics.solve_near(&loading, 1.0, &mut work).converged);
    assert!(converged);
    assert_eq!(counted.count_total, 0);
}

/// A patient again and again, as if read from a file every time.
struct Repeated {
    patient: Vec<u8>,
    times: usize,
}

impl CohortSource for Repeated {
    type Error = ();

    fn each_part(&mut self, most: NonZeroUsize, take: &mut TakePart<'_, ()>) -> Result<(), ()> {
        let read = || CohortPatient::from_bytes(&self.patient).ok_or(());
        for first in (0..self.times).step_by(most.get()) {
            let size = most.get().min(self.times - first);
            let part: Vec<_> = (0..size).map(|_| read()).collect::<Result<_, _>>()?;
            take(&part)?;
        }
        Ok(())
    }
}

/// Rows of patients that are all the same.
#[derive(Default)]
struct SameRows {
    row: Vec<f64>,
    times: usize,
}

impl CohortRows<()> for SameRows {
    fn add(&mut self, row: &[f64]) -> Result<(), ()> {
        self.row.clear();
        self.row.extend_from_slice(row);
        self.times += 1;
        Ok(())
    }

    fn each(&mut self, numbers: usize, take: &mut dyn FnMut(&[f64])) -> Result<(), ()> {
        assert_eq!(numbers, self.row.len());
        (0..self.times).for_each(|_| take(&self.row));
        Ok(())
    }
}

#[test]
fn the_memory_of_a_cohort_grows_by_a_few_numbers_per_patient() {
    let case = generate(0, Truth::Rod, &Readers::exact(), 1).expect("a phantom").case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("an analysis");
    let patient = CohortPatient::of(&analysis).to_bytes();
    let most = |times: usize| {
        let mut source = Repeated { patient: patient.clone(), times };
        let counted = measure(|| {
            let rows = &mut SameRows::default();
            let cohort = Cohort::of_source(&mut source, rows, Listed::First, 1, &OneThread);
            let cohort = cohort.expect("bytes of a patient");
            assert_eq!(cohort.patients, times);
        });
        counted.bytes_max
    };
    let [few, many] = [most(100), most(400)];
    let per_patient = many.saturating_sub(few) / 300;
    assert!(per_patient < 400, "{per_patient} bytes per patient");
}
