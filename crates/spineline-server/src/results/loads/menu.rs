//! Loads that are possible on a model, with an example of each kind.

use spineline::analysis::PersonalisedModel;
use spineline::anatomy::Side;
use spineline::clinical::convex_side;
use spineline::multibody::{Rod, Support, Timing};
use spineline::response::{CurveChange, erect_shape, measure_angles};
use spineline_files::{AppliedLoad, DIRECTIONS, SimulationWarning};

use crate::api::{FileLoad, FilmForce, LoadKind, LoadMenu, NamedDirection, Wire};

/// Purpose of the numbers, and parts that the model lacks.
const LIMITS: [&str; 3] = [
    "Research only: do not base a treatment on these numbers",
    "The model has no rib cage, no muscles, no skin and no contact: the numbers lack their effects",
    "The base is fixed and the top is free: an unopposed load also tilts the whole spine",
];

/// Symbol of a force where no force was measured.
pub const RELATIVE_SYMBOL: &str = "rel. units";

/// Effect of a support in the frontal plane on loads.
const FRONTAL: &str = "The model bends sideways only: loads to the front, to the back and about the spine have no effect, and a rod prescribes only tilt and lateral place";

/// Sizes of the examples: small compared with the strength of a spine, so that each has a result on most spines.
const FORCE: f64 = 20.0;
const MOMENT: f64 = 2000.0;
const SPRING_PER_MM: f64 = 2.0;
const ADVANCE_MM: f64 = 10.0;
/// Turn of a rod's upper vertebra.
const TURN_DEG: f64 = 5.0;
/// Distance of a strap's end from the spine.
const STRAP_MM: f64 = 150.0;

pub fn menu(model: &PersonalisedModel) -> LoadMenu {
    let films = model.loads.iter().map(|film| FilmForce {
        posture: Wire(film.posture),
        load: FileLoad(AppliedLoad::of_film(film, model.top())),
        doubt: SimulationWarning::not_found(film).map(|doubt| doubt.message),
    });
    let frontal = (model.support == Support::Frontal).then_some(FRONTAL);
    LoadMenu {
        force_unit: model.force_unit().to_owned(),
        force_symbol: if model.absolute { "N" } else { RELATIVE_SYMBOL }.to_owned(),
        levels: model.levels.iter().skip(1).map(ToString::to_string).collect(),
        kinds: kinds(model),
        films: films.collect(),
        directions: DIRECTIONS
            .map(|(name, vector)| NamedDirection { name: name.to_owned(), vector })
            .to_vec(),
        limits: LIMITS.into_iter().chain(frontal).map(str::to_owned).collect(),
    }
}

/// One example of each kind that the page offers.
fn kinds(model: &PersonalisedModel) -> Vec<LoadKind> {
    let (vertebra, towards) = against_the_curve(model);
    let (level, top) = (model.levels[vertebra], model.top());
    let sideways = match towards {
        Side::Left => 1.0,
        Side::Right => -1.0,
    };
    let timing = Timing::Proportional;
    let point_in_vertebra_mm = [0.0; 3];
    let at = model.spine.midpoints_mm[vertebra];
    let force =
        |level, force_n| AppliedLoad::ForceAtPoint { level, force_n, point_in_vertebra_mm, timing };
    let kind = |label: &str, text: &str, example| LoadKind {
        label: label.to_owned(),
        text: text.to_owned(),
        example: FileLoad(example),
    };
    vec![
        kind(
            "Pad",
            "a frictionless pad: a spring that touches the erect spine and is then pushed in along one direction",
            AppliedLoad::Pad {
                level,
                point_in_vertebra_mm,
                direction: [0.0, sideways, 0.0],
                n_per_mm: SPRING_PER_MM,
                advance_mm: ADVANCE_MM,
                timing,
            },
        ),
        kind(
            "Strap",
            "a spring to a point of the ground, slack on the erect spine and then shortened",
            AppliedLoad::Strap {
                level,
                point_in_vertebra_mm,
                anchor_mm: [at.x, at.y + sideways * STRAP_MM, at.z],
                n_per_mm: SPRING_PER_MM,
                shortening_mm: ADVANCE_MM,
                timing,
            },
        ),
        kind(
            "Rod",
            "a stiff rod between two vertebrae: it changes their pose relative to each other, or keeps it where all its numbers are 0",
            rod(model, vertebra, sideways, timing),
        ),
        kind(
            "Traction",
            "a force upwards on the uppermost vertebra",
            force(top, [0.0, 0.0, FORCE]),
        ),
        kind(
            "Weight",
            "the weight of trunk, head and arms in addition to that on the erect film",
            AppliedLoad::Gravity {
                body_weight_n: FORCE,
                down: [0.0, 0.0, -1.0],
                timing: Timing::Constant,
            },
        ),
        kind(
            "Force",
            "a force of fixed direction at the midpoint of a vertebra",
            force(level, [0.0, sideways * FORCE, 0.0]),
        ),
        kind(
            "Moment",
            "a moment of fixed direction on a vertebra",
            AppliedLoad::Moment { level, moment_nmm: [-sideways * MOMENT, 0.0, 0.0], timing },
        ),
    ]
}

/// A rod over the curve that lessens it, from two vertebrae below to two above, as far as they exist; with too few
/// joints, a rod that keeps the pose.
fn rod(model: &PersonalisedModel, apex: usize, towards_left: f64, timing: Timing) -> AppliedLoad {
    let superior = (apex + 2).min(model.levels.len() - 1);
    let inferior = superior.saturating_sub(4);
    let level = |vertebra: usize| model.levels[vertebra];
    let moves = superior - inferior >= Rod::least_joints(model.support);
    AppliedLoad::Rod {
        inferior: level(inferior),
        superior: level(superior),
        shift_mm: [0.0; 3],
        turn_deg: [if moves { towards_left * TURN_DEG } else { 0.0 }, 0.0, 0.0],
        timing,
    }
}

/// The apex of the largest curve, and the side of its concavity; the uppermost vertebra where no curve is measured.
fn against_the_curve(model: &PersonalisedModel) -> (usize, Side) {
    let places = model.curves.as_deref().unwrap_or_default();
    let angles = measure_angles(&erect_shape(&model.spine), places);
    let largest = CurveChange::between(&angles, &angles).map(|curve| curve.region);
    let mut curves = places.iter().zip(&angles.curves);
    match curves.find(|(_, curve)| Some(curve.region) == largest) {
        Some((place, curve)) => {
            let convex = convex_side(curve.ends.size());
            let towards = if convex == Some(Side::Left) { Side::Right } else { Side::Left };
            (place.bounds.apex.max(1), towards)
        }
        None => (model.levels.len() - 1, Side::Left),
    }
}

#[cfg(test)]
mod tests {
    use spineline::analysis::{AnalysisOptions, analyze};
    use spineline_files::{LoadFile, Simulated};
    use spineline_phantom::{Readers, Scenario, generate};

    use spineline::anatomy::{Level, Posture};

    use super::*;

    fn model() -> PersonalisedModel {
        let phantom = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists");
        let analysis = analyze(&phantom.case, &AnalysisOptions::default()).expect("a phantom");
        analysis.personalised_model(&analysis.models[0])
    }

    #[test]
    fn every_example_can_be_applied_and_all_of_them_together() {
        let model = model();
        let menu = menu(&model);
        let loads: Vec<AppliedLoad> = menu.kinds.into_iter().map(|kind| kind.example.0).collect();
        assert_eq!(loads.len(), 7);
        assert_eq!(LoadFile::new(loads).faults(&model), []);
        assert_eq!(menu.levels.first().map(String::as_str), Some("L3"));
        assert!(menu.films.iter().any(|film| film.posture == Wire(Posture::Traction)));
        let says = |words: &str| menu.limits.iter().any(|text| text.contains(words));
        assert!(says("Research only") && says("no rib cage, no muscles"));
        assert_eq!(says("bends sideways only"), model.support == Support::Frontal);
    }

    #[test]
    fn every_example_has_a_result_on_the_models_of_phantoms() {
        for (subject, scenario) in [(0, Scenario::Rod), (3, Scenario::Bend), (7, Scenario::Pull)] {
            let phantom = generate(subject, scenario, &Readers::default(), 1).expect("a phantom");
            for support in [Support::Frontal, Support::Free] {
                let options = AnalysisOptions { support, ..AnalysisOptions::default() };
                let analysis = analyze(&phantom.case, &options).expect("a phantom");
                for line in &analysis.models {
                    let model = analysis.personalised_model(line);
                    for kind in menu(&model).kinds {
                        let loads = LoadFile::new(vec![kind.example.0]);
                        let found = Simulated::at_full_load(model.clone(), loads);
                        let ending = found.expect("a load that fits").response.ending;
                        let of = (subject, support, line.kind, &kind.label);
                        assert!(ending.is_usable(), "{of:?}: {}", ending.key());
                    }
                }
            }
        }
    }

    #[test]
    fn the_first_pad_pushes_the_apex_of_the_largest_curve_towards_its_concavity() {
        let model = model();
        let (vertebra, towards) = against_the_curve(&model);
        let (base, top) = (model.spine.midpoints_mm[0], model.spine.midpoints_mm[14]);
        let at = model.spine.midpoints_mm[vertebra];
        let straight = base.y + (top.y - base.y) * (at.z - base.z) / (top.z - base.z);
        let bulges_left = at.y > straight;
        assert_eq!(towards, if bulges_left { Side::Right } else { Side::Left });
        assert!(model.levels[vertebra] > Level::L4);
    }
}
