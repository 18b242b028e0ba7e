//! Multipliers that were put into the model itself are recovered from its shapes.
//!
//! The model is exact here, unlike on films of a phantom, so everything must be found to the minimiser's precision.

use spineline::action::LineOfAction;
use spineline::analysis::analyze;
use spineline::anatomy::{Levels, Posture};
use spineline::clinical::Regions;
use spineline::measure::Outline;
use spineline::multibody::{
    FittedSprings, JointGroups, Load, Solution, SpineModel, Statics, StiffnessLibrary, Support,
};
use spineline::personalize::evidence::FilmEvidence;
use spineline::personalize::{
    FitFilm, FitSettings, FitStatus, FitTarget, Gauge, StiffnessBound, personalize,
};
use spineline::spatial::{Angle, Frontal};
use spineline_phantom::{Readers, Scenario, generate};

/// Relative: at a residual of zero the minimiser converges quadratically, far below this.
const MULTIPLIER: f64 = 1e-6;

struct Patient {
    erect: Outline,
    model: SpineModel,
    regions: Regions,
    library: StiffnessLibrary,
    depth_mm: f64,
}

fn patient(index: usize) -> Patient {
    let phantom = generate(index, Scenario::Bend, &Readers::exact(), 1).expect("18 subjects");
    let analysis = analyze(&phantom.case, &Default::default()).expect("a sound case");
    Patient {
        erect: analysis.movement.erect().outline.clone(),
        model: analysis.movement.spine,
        regions: analysis.movement.regions,
        library: StiffnessLibrary::default(),
        depth_mm: 8.0,
    }
}

impl Patient {
    /// A line away from most joints, so that the force turns nearly all of them.
    fn line(&self) -> LineOfAction {
        let apex = self.erect.vertebrae[self.regions.bounds[1].apex].location;
        LineOfAction::leaning(Frontal::new(-0.8 * apex.y_mm, apex.z_mm), Angle::from_deg(7.0))
    }

    /// The film of a perfect reader of the model under a force.
    fn film(&self, posture: Posture, statics: &Statics<'_>, load: &Load, force_n: f64) -> Outline {
        let mut solution = Solution::default();
        statics.solve(load, &[force_n], &[], &mut solution);
        assert!(solution.converged);
        let mut film = self.erect.clone();
        film.posture = posture;
        for (i, vertebra) in film.vertebrae.iter_mut().enumerate() {
            vertebra.location = solution.deformed.location(i);
            vertebra.tilt = solution.deformed.tilt(i);
        }
        film
    }

    fn check(&self, groups: &JointGroups, logs: &[f64], support: Support, target: FitTarget) {
        let mean: f64 = logs.iter().sum::<f64>() / logs.len() as f64;
        let logs: Vec<f64> = logs.iter().map(|log| log - mean).collect();
        let statics = Statics::new(&self.model, &self.library, groups, &logs, support);
        let load = Load::along(self.line(), self.depth_mm);
        let forces_n = [55.0, -40.0];
        let films = [
            self.film(Posture::LeftBending, &statics, &load, forces_n[0]),
            self.film(Posture::RightBending, &statics, &load, forces_n[1]),
        ];
        let evidence = films
            .each_ref()
            .map(|outline| FilmEvidence::measure(&self.model, &self.library, &self.erect, outline));
        let film = |(outline, evidence)| FitFilm { outline, evidence, load };
        let films: Vec<FitFilm<'_>> = films.iter().zip(&evidence).map(film).collect();
        let settings = FitSettings {
            regions: &self.regions,
            target,
            gauge: Gauge::GeometricMean,
            support,
            prior: None,
            hints: &[],
        };
        let (model, erect) = (&self.model, &self.erect);
        let springs = FittedSprings { model, erect, library: &self.library, groups };
        let fit = personalize(springs, &films, &settings, None);
        let what = format!("{support:?}, {target:?}, {} groups", groups.len());
        assert_eq!(fit.status, FitStatus::Converged, "{what}");
        assert!(fit.bounds.iter().all(|&bound| bound == StiffnessBound::Inside), "{what}");
        for (g, (found, truth)) in fit.log_multipliers.iter().zip(&logs).enumerate() {
            let off = (found - truth).exp_m1().abs();
            assert!(
                off <= MULTIPLIER,
                "{what}: multiplier {g} is off by {off:e}, residual {:e}, singular values {:?}",
                fit.residual_rms,
                fit.singular_values
            );
        }
        for (found, truth) in fit.loads.iter().zip(forces_n) {
            let off = (found[0] / truth - 1.0).abs();
            assert!(off <= MULTIPLIER, "{what}: force {} instead of {truth}", found[0]);
        }
    }
}

const REGIONAL: [[f64; 3]; 2] = [[-0.1, 0.9, -0.4], [0.5, -0.7, 0.3]];

fn per_joint_logs() -> Vec<f64> {
    (0..14).map(|joint| 0.7 * f64::sin(1.3 * f64::from(joint))).collect()
}

fn check_regional(support: Support, target: FitTarget) {
    for subject in [0, 6, 10] {
        let patient = patient(subject);
        for logs in REGIONAL {
            patient.check(&JointGroups::regional(&patient.regions), &logs, support, target);
        }
    }
}

#[test]
fn regional_multipliers_are_recovered_from_whole_shapes_with_frontal_support() {
    // Oracle: the multipliers that made the shapes.
    check_regional(Support::Frontal, FitTarget::Shape);
}

#[test]
fn regional_multipliers_are_recovered_from_whole_shapes_of_a_free_spine() {
    // Oracle: the multipliers that made the shapes.
    check_regional(Support::Free, FitTarget::Shape);
}

#[test]
fn regional_multipliers_are_recovered_from_ferguson_angles_with_frontal_support() {
    // Oracle: the multipliers that made the shapes.
    check_regional(Support::Frontal, FitTarget::Ferguson);
}

#[test]
fn regional_multipliers_are_recovered_from_ferguson_angles_of_a_free_spine() {
    // Oracle: the multipliers that made the shapes.
    check_regional(Support::Free, FitTarget::Ferguson);
}

#[test]
fn multipliers_of_every_joint_are_recovered_from_whole_shapes() {
    // Oracle: the multipliers that made the shapes.
    for support in [Support::Frontal, Support::Free] {
        for subject in [0, 6, 10] {
            let groups = JointGroups::per_joint(Levels::COMPLETE);
            patient(subject).check(&groups, &per_joint_logs(), support, FitTarget::Shape);
        }
    }
}
