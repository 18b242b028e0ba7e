//! Loads and bases on synthetic films of known truth, read by the virtual readers: the true load wins.
//!
//! Oracle: the statics of the phantoms, 998 planar segments. `validation/lines.md` has the table over more subjects.

use spineline::analysis::{Analysis, AnalysisOptions, analyze};
use spineline::hypothesis::{
    Hypothesis, HypothesisComparison, HypothesisScores, HypothesisSummary, LoadShape, Role, compare,
};
use spineline::multibody::Support;
use spineline::personalize::Base;
use spineline_phantom::{Readers, Scenario, generate};

/// Subjects whose largest curve is the main thoracic one, at whose apex the second force acts.
const SUBJECTS: [usize; 2] = [0, 4];

const LOADS: [LoadShape; 6] = [
    LoadShape::InflectionLine,
    LoadShape::IliacLine,
    LoadShape::TwoForces,
    LoadShape::Weight,
    LoadShape::Lateral,
    LoadShape::Couple,
];

fn comparison(scenario: Scenario, hypotheses: &[Hypothesis]) -> HypothesisComparison {
    let options = AnalysisOptions {
        support: Support::Frontal,
        hypotheses: hypotheses.to_vec(),
        ..Default::default()
    };
    let analyses: Vec<Analysis> = SUBJECTS
        .iter()
        .map(|&index| {
            let phantom = generate(index, scenario, &Readers::default(), 1).expect("a phantom");
            analyze(&phantom.case, &options).expect("a sound case")
        })
        .collect();
    let scores = |analysis: &Analysis| HypothesisScores::all(&analysis.hypotheses);
    let scores: Vec<Vec<HypothesisScores>> = analyses.iter().map(scores).collect();
    compare(&scores.iter().map(Vec::as_slice).collect::<Vec<_>>()).swap_remove(0)
}

fn location_mm(summary: &HypothesisSummary, role: Role) -> f64 {
    predicted_mm(summary, role).expect("every film is predicted")
}

fn predicted_mm(summary: &HypothesisSummary, role: Role) -> Option<f64> {
    let place = Role::ALL.iter().position(|one| *one == role).expect("one of all");
    summary.location_mm[place]
}

/// Among all loads with at most as many components, the true load predicts a bend from the other one best, and has the
/// lowest AICc. A load with more components may come near any other.
fn wins(scenario: Scenario, load: LoadShape) {
    let compared = comparison(scenario, &LOADS.map(Hypothesis::of));
    let of = |load: LoadShape| {
        let found = compared.hypotheses.iter().find(|s| s.hypothesis == Hypothesis::of(load));
        found.expect("every load was fitted")
    };
    let own = of(load);
    let rivals = LOADS.into_iter().filter(|other| other.components() <= load.components());
    for other in rivals.filter(|other| *other != load) {
        // A load whose fits do not converge, as weight's may not, predicts no film.
        let Some(b) = predicted_mm(of(other), Role::LeftOut) else { continue };
        let a = location_mm(own, Role::LeftOut);
        assert!(a < b, "{scenario:?} left out: {load:?} {a:.2} mm, {other:?} {b:.2} mm");
        let (a, b) = (own.aicc_difference, of(other).aicc_difference);
        assert!(a < b, "{scenario:?}: AICc of {load:?} {a:.1}, of {other:?} {b:.1}");
    }
}

#[test]
fn the_inflection_line_predicts_best_on_rods() {
    wins(Scenario::Rod, LoadShape::InflectionLine);
}

#[test]
fn the_iliac_line_predicts_best_on_pulls() {
    wins(Scenario::Pull, LoadShape::IliacLine);
}

#[test]
fn weight_predicts_best_where_weight_bent_the_spine() {
    wins(Scenario::Weight, LoadShape::Weight);
}

#[test]
fn the_distributed_force_predicts_best_where_it_bent_the_spine() {
    wins(Scenario::Lateral, LoadShape::Lateral);
}

#[test]
fn the_couple_predicts_best_where_it_bent_the_spine() {
    wins(Scenario::Couple, LoadShape::Couple);
}

#[test]
fn two_forces_predict_best_where_two_bent_the_spine() {
    wins(Scenario::TwoForces, LoadShape::TwoForces);
}

#[test]
fn one_component_needs_no_more_than_the_place_of_t2() {
    // Oracle: the search along the path of equilibria, which uses neither joint rotations nor the tilt. Two numbers
    // determine a load of one component and the scale of the film, so a wide prior hardly changes them.
    let compared = comparison(Scenario::Pull, &[LoadShape::IliacLine].map(Hypothesis::of));
    let [iliac] = &compared.hypotheses[..] else { panic!("one load") };
    let by_place = location_mm(iliac, Role::LeftOut);
    for role in [Role::LeftOutWithPrior, Role::LeftOutWithTilt] {
        let mm = location_mm(iliac, role);
        assert!((mm - by_place).abs() < 0.1, "{role:?}: {mm:.3} mm, by place {by_place:.3} mm");
    }
}

#[test]
fn the_tilt_of_t2_determines_a_free_line() {
    // Oracle: scenario. Three components; the films were bent by one of them, by a force spread over the spine, or by
    // rotations without a load.
    let free = [Hypothesis::of(LoadShape::FreeLine)];
    for scenario in [Scenario::Rod, Scenario::Lateral, Scenario::Bend] {
        let compared = comparison(scenario, &free);
        let of = |role| location_mm(&compared.hypotheses[0], role);
        let [place, tilt] = [Role::LeftOut, Role::LeftOutWithTilt].map(of);
        assert!(tilt < place, "{scenario:?}: {tilt:.2} mm with tilt, {place:.2} mm by place");
        assert!(tilt < 1.5, "{scenario:?}: {tilt:.2} mm with tilt");
    }
}

#[test]
fn a_free_base_predicts_best_where_the_base_was_rotated() {
    let bases = Base::ALL.map(|base| Hypothesis { load: LoadShape::InflectionLine, base });
    let compared = comparison(Scenario::TurnedBase, &bases);
    let [fixed, noisy, free] = &compared.hypotheses[..] else { panic!("three bases") };
    assert!(free.aicc_difference < noisy.aicc_difference);
    assert!(noisy.aicc_difference < fixed.aicc_difference);
    // Turns of 4° to 8° are ten times the reading errors.
    for role in [Role::Fitted, Role::LeftOutLoadFitted] {
        assert!(location_mm(free, role) < 0.5 * location_mm(fixed, role));
    }
}

#[test]
fn a_free_base_recovers_the_rotation_of_the_base() {
    // Oracle: the turn between the true tilts of L4 and L3, less the same rod's.
    let (index, seed) = (0, 1);
    let turned = generate(index, Scenario::TurnedBase, &Readers::exact(), seed).expect("a phantom");
    let hypothesis = Hypothesis { load: LoadShape::InflectionLine, base: Base::Free };
    let options = AnalysisOptions {
        support: Support::Frontal,
        hypotheses: vec![hypothesis],
        ..Default::default()
    };
    let analysis = analyze(&turned.case, &options).expect("a sound case");
    for prediction in analysis.hypotheses[0].of_role(Role::Fitted) {
        let truth = turned.posture(prediction.shape.posture).expect("it was filmed");
        let turn = truth.base_turn;
        // Readers are exact; the rest is from 14 joints instead of 998 segments.
        assert!((prediction.base - turn).abs().deg() < 1.0, "{} {}", prediction.base, turn);
        assert!(turn.abs().deg() >= 4.0);
    }
}
