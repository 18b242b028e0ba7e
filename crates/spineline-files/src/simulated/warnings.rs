//! Warnings about a simulation.

use schemars::JsonSchema;
use serde::Serialize;
use spineline::analysis::PersonalisedModel;
use spineline::multibody::{BodyLoad, PathEnding};
use spineline::number::fixed;
use spineline::response::{Response, UNUSUAL_HINGE, largest_hinge};
use spineline::warning::WarningCode;

use crate::{AppliedLoad, LoadFile, PlacedLoads};

/// A warning of a simulation.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SimulationWarning {
    /// Which warning it is.
    pub code: WarningCode,
    /// What happened and what to do, as text.
    pub message: String,
}

impl SimulationWarning {
    /// A warning with its stable code.
    #[must_use]
    pub fn new(code: WarningCode, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }
}

/// All warnings about a simulation.
pub(super) fn warnings(
    model: &PersonalisedModel,
    loads: &LoadFile,
    placed: &PlacedLoads,
    response: &Response,
) -> Vec<SimulationWarning> {
    let doubts = model.doubts.iter();
    let mut all: Vec<SimulationWarning> = doubts
        .map(|doubt| {
            SimulationWarning::new(WarningCode::ModelDoubted, format!("the model: {doubt}"))
        })
        .collect();
    all.extend(about_loads(model, loads));
    if response.ending == PathEnding::Interrupted {
        let text = "interrupted; the path so far is kept, but it is not a result";
        all.push(SimulationWarning::new(WarningCode::Interrupted, text));
    }
    if response.ending != PathEnding::Interrupted && !response.is_complete() {
        let text = "a path of equilibria was lost: there may be more shapes that meet the target";
        all.push(SimulationWarning::new(WarningCode::PathLost, text));
    }
    if response.ending == PathEnding::SeveralEquilibria {
        let text = format!(
            "{} shapes meet the target; the result is the least loaded one that the erect spine reaches without snapping or buckling",
            response.equilibria.len()
        );
        all.push(SimulationWarning::new(WarningCode::SeveralEquilibria, text));
    }
    all.extend(about_range(model, response));
    all.extend(about_springs(model, placed, response));
    if let Some(result) = response.result() {
        let (joint, axis, turn) = largest_hinge(&result.deformed);
        if turn.abs() > UNUSUAL_HINGE {
            let axis = ["lateral", "flexion", "axial"][axis];
            let (below, above) = (model.levels[joint], model.levels[joint + 1]);
            let text = format!(
                "the {axis} rotation of joint {below}/{above} is {}, more than a spine allows (limit of this warning: {}); \
                 linear springs do not limit it as ligaments and facets do",
                turn.abs().text(0),
                UNUSUAL_HINGE.text(0)
            );
            all.push(SimulationWarning::new(WarningCode::LargeHinge, text));
        }
    }
    all
}

/// The joint or part of the spine beyond the human range, if the result is missing because of it.
fn about_range(model: &PersonalisedModel, response: &Response) -> Option<SimulationWarning> {
    if response.ending != PathEnding::BeyondHumanRange {
        return None;
    }
    let beyond = response.shape()?.beyond_human_range(&model.spine)?;
    let [below, above] = beyond.vertebrae.map(|vertebra| model.levels[vertebra]);
    let text = format!(
        "{above} rotates by {} relative to {below}, and no human spine by more than {}: reduce the loads or the amplitude",
        beyond.rotation.text(0),
        beyond.limit.text(0)
    );
    Some(SimulationWarning::new(WarningCode::BeyondHumanRange, text))
}

fn about_loads(model: &PersonalisedModel, loads: &LoadFile) -> Vec<SimulationWarning> {
    let mut all = Vec::new();
    let weighs = loads.loads.iter().any(|load| matches!(load, AppliedLoad::Gravity { .. }));
    let springs =
        |load: &AppliedLoad| matches!(load, AppliedLoad::Pad { .. } | AppliedLoad::Strap { .. });
    if !model.absolute {
        let text = "only ratios of this model's stiffness are known: forces, weights and springs of loads are in its relative units, not newtons; \
                    `analyze --gauge known-force:POSTURE=NEWTON` makes them absolute";
        all.push(SimulationWarning::new(WarningCode::RelativeForces, text));
    }
    if weighs {
        let erect = match model.carried_body_mass_kg {
            None => "the erect shape is taken as unloaded, although the patient's weight already acted on the erect film".to_owned(),
            Some(kg) => format!("the stiffness already counts the weight of the trunk of a body of {kg} kg in the erect shape"),
        };
        let text = format!(
            "{erect}: this weight is added to it, and no muscles carry it; a spine without muscles bears only a small part of the body"
        );
        all.push(SimulationWarning::new(WarningCode::WeightOnTop, text));
    }
    if loads.loads.iter().any(springs) {
        let text = "pads and straps are springs without loss of contact: they touch the erect spine with zero force";
        all.push(SimulationWarning::new(WarningCode::SpringsStick, text));
    }
    all
}

fn about_springs(
    model: &PersonalisedModel,
    placed: &PlacedLoads,
    response: &Response,
) -> Vec<SimulationWarning> {
    let Some(result) = response.result() else { return Vec::new() };
    let wrong = result.spring_forces_n.iter().filter(|(_, force)| *force < 0.0);
    let warn = wrong.filter_map(|&(number, force_n)| {
        let item = &placed.loading.items[number];
        let (load, level) = (placed.load_of_item[number] + 1, model.levels[item.vertebra]);
        let force = format!("{} ({})", fixed(force_n.abs(), 1), model.force_unit());
        let (code, fault) = match item.load {
            BodyLoad::Pad { .. } => (
                WarningCode::PadPulls,
                format!("pad on {level} pulls with {force}; a real pad would lose contact"),
            ),
            BodyLoad::Strap { .. } => (
                WarningCode::StrapPushes,
                format!("strap on {level} pushes with {force}; a real strap would be slack"),
            ),
            BodyLoad::ForceOnLine { .. }
            | BodyLoad::ForceAtPoint { .. }
            | BodyLoad::FollowerForce { .. }
            | BodyLoad::Moment { .. }
            | BodyLoad::FollowerMoment { .. } => return None,
        };
        Some(SimulationWarning::new(code, format!("load {load}: the {fault}: remove it")))
    });
    warn.collect()
}
