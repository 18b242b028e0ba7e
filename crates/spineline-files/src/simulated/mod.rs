//! A personalised model under loads: from both files to the outputs.

mod film_force;
mod warnings;

pub use warnings::SimulationWarning;

use spineline::action::LineKind;
use spineline::analysis::{PersonalisedModel, SimulationError as CoreError};
use spineline::clinical::CurvePlaces;
use spineline::multibody::{Goal, LoadingError, SpringError, Timing};
use spineline::response::{OnSignedPoint, Response, erect_shape, go_on};
use spineline::uncertainty::AppliedLoads;
use spineline::warning::WarningCode;

use crate::{FileError, LoadFile, PlacedLoads};

/// A model, its loads, and its response.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// The model.
    pub model: PersonalisedModel,
    /// The loads as they were given.
    pub loads: LoadFile,
    /// The same on the vertebrae of the model.
    pub placed: PlacedLoads,
    /// Between which vertebrae angles of curves are measured.
    pub places: Vec<CurvePlaces>,
    /// The response of the spine.
    pub response: Response,
    /// The warnings about it.
    pub warnings: Vec<SimulationWarning>,
}

spineline::faults! {
    /// A model or loads that cannot be simulated.
    #[derive(Debug, thiserror::Error)]
    #[non_exhaustive]
    pub enum SimulationError {
        /// A load does not fit the model.
        #[error(transparent)]
        #[help(error.help())]
        Loads(#[from] FileError as error),
        /// A load cannot be applied.
        #[error(transparent)]
        #[help(error.help())]
        Loading(#[from] LoadingError as error),
        /// The springs of the model are invalid.
        #[error("{0}")]
        #[help("correct the stiffness, or write the model again with `analyze`")]
        Springs(String),
        /// A lateral tilt is wanted, and no load is varied.
        #[error("a wanted lateral tilt needs proportional loads, and all loads are constant")]
        #[help("let at least one load have the timing `growing`")]
        NothingGrows,
        /// A largest factor that loads cannot have.
        #[error("{0}")]
        #[help("leave it out for the usual one")]
        LargestFactor(String),
    }
}

impl SimulationError {
    /// The error with the names of the vertebrae of its model.
    fn of(error: CoreError, model: &PersonalisedModel) -> Self {
        match error {
            CoreError::Springs(SpringError::NotPositive { joint }) => Self::Springs(format!(
                "the stiffness of joint {}/{} is not symmetric and positive definite",
                model.levels[joint],
                model.levels[joint + 1]
            )),
            CoreError::Loading(error) => error.into(),
            CoreError::LargestFactor { .. } => Self::LargestFactor(error.to_string()),
            other => Self::Springs(other.to_string()),
        }
    }
}

impl Simulated {
    /// Loads a model; the callback gets every shape and may interrupt the search.
    ///
    /// `notes` are warnings that the loads brought with them. Without a largest factor, the usual one is taken.
    pub fn of(
        model: PersonalisedModel,
        loads: LoadFile,
        goal: Goal,
        limit: Option<f64>,
        notes: Vec<SimulationWarning>,
        on_point: OnSignedPoint<'_>,
    ) -> Result<Self, SimulationError> {
        let placed = loads.place(&model)?;
        if matches!(goal, Goal::LateralTilt(_)) && !is_proportional(&placed) {
            return Err(SimulationError::NothingGrows);
        }
        let mut warnings = notes;
        let places = places(&model, &mut warnings);
        let response = model
            .simulate_within(&placed.loading, goal, limit, on_point)
            .map_err(|error| SimulationError::of(error, &model))?;
        warnings.extend(warnings::warnings(&model, &loads, &placed, &response));
        Ok(Self { model, loads, placed, places, response, warnings })
    }

    /// As [`Simulated::of`], with the full loads and without an interruption.
    pub fn at_full_load(
        model: PersonalisedModel,
        loads: LoadFile,
    ) -> Result<Self, SimulationError> {
        Self::of(model, loads, Goal::FullLoad, None, Vec::new(), &mut go_on)
    }

    /// The same loads and target on the models of replicates, which are fitted with this line of action.
    #[must_use]
    pub fn on_replicates(&self, kind: LineKind, largest_factor: Option<f64>) -> AppliedLoads<'_> {
        AppliedLoads {
            kind,
            support: self.model.support,
            loading: &self.placed.loading,
            goal: self.response.goal,
            largest_factor,
        }
    }
}

/// Whether a load is varied.
fn is_proportional(placed: &PlacedLoads) -> bool {
    let timings = placed.loading.items.iter().map(|item| item.timing);
    let mut timings = timings.chain(placed.loading.rods.iter().map(|rod| rod.timing));
    timings.any(|timing| timing == Timing::Proportional)
}

/// Where Cobb and Ferguson angles are measured.
fn places(model: &PersonalisedModel, notes: &mut Vec<SimulationWarning>) -> Vec<CurvePlaces> {
    if let Some(curves) = &model.curves {
        return curves.clone();
    }
    let erect = erect_shape(&model.spine);
    let count = model.levels.len();
    let locations: Vec<_> = (0..count).map(|i| erect.location(i)).collect();
    let tilts: Vec<_> = (0..count).map(|i| erect.tilt(i)).collect();
    let usual =
        model.known_levels().and_then(|levels| CurvePlaces::usual(levels, &locations, &tilts));
    let text = if usual.is_some() {
        "the model file has no regions; tilt ranges and Ferguson angles are measured with regions that end at T12 and T6, \
         which may differ from its analysis; write the model again with `spineline analyze CASE --model FILE`"
    } else {
        "the model file has no regions and does not go from L4 to T2 or a part of it: angles of curves are not measured"
    };
    notes.push(SimulationWarning::new(WarningCode::UsualRegions, text));
    usual.map_or_else(Vec::new, Vec::from)
}
