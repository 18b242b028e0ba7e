//! One film under its load, by the march or by the general solver.

use super::{
    ForceSign, JointGroups, Load, Parameter, Solution, SpineModel, Statics, StiffnessLibrary,
    Support, match_amplitude,
};
use crate::measure::Outline;
use crate::spatial::{Angle, Frontal};

/// What an equilibrium comes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// The shape.
    Shape,
    /// The shape and its derivatives by the components of the load.
    LoadRates,
    /// The shape and all its derivatives.
    AllRates,
}

/// The base of a film, which turns the whole spine about L4 as the film shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TurnedBase {
    pub angle: Angle,
    /// Place of the angle among the parameters of derivatives.
    pub parameter: usize,
}

/// A spine with its springs, in groups.
#[derive(Debug, Clone, Copy)]
pub struct FittedSprings<'a> {
    /// The unloaded spine.
    pub model: &'a SpineModel,
    /// The erect film, from which it is made.
    pub erect: &'a Outline,
    /// Nominal springs.
    pub library: &'a StiffnessLibrary,
    /// Which joints share a multiplier.
    pub groups: &'a JointGroups,
}

/// The equilibrium of one film. Parameters of derivatives are `ln α` of every group, the components of the load, and the
/// base's angle.
pub(crate) trait FilmUnderLoad {
    /// The spine with its springs.
    type Springs<'a>;

    /// Springs of a library with one multiplier per group of joints.
    fn springs<'a>(
        spine: FittedSprings<'a>,
        log_multipliers: &[f64],
        support: Support,
    ) -> Self::Springs<'a>;

    /// Free components of the load.
    fn components(&self) -> usize;

    /// Place of the first component among the parameters of derivatives.
    fn first_component(&self) -> usize;

    /// Forgets the last shape, from which the search for the next one starts.
    fn reset(&mut self);

    /// The equilibrium; whether there is one.
    fn solve(
        &mut self,
        springs: &Self::Springs<'_>,
        components: &[f64],
        base: Angle,
        wanted: Wanted,
    ) -> bool;

    /// The last shape, as it is on a base that does not turn.
    fn solution(&self) -> &Solution;

    /// Where it may turn.
    fn base(&self) -> Option<TurnedBase>;

    /// The first force of a sign that gives the spine a lateral tilt; `None` for other loads than a force along a line.
    fn force_at_amplitude(
        &self,
        springs: &Self::Springs<'_>,
        sign: ForceSign,
        lateral_tilt: Angle,
    ) -> Option<f64>;

    /// Components of the load, and the base's angle, which follows them where the base may turn.
    fn split<'x>(&self, unknowns: &'x [f64]) -> (&'x [f64], Angle) {
        let (components, base) = unknowns.split_at(self.components());
        (components, Angle::from_rad(base.first().copied().unwrap_or(0.0)))
    }

    /// A location as the film shows it.
    fn location(&self, vertebra: usize) -> Frontal {
        let still = self.solution().deformed.location(vertebra);
        self.base().map_or(still, |base| still.rotated(base.angle))
    }

    /// A tilt as the film shows it.
    fn tilt(&self, vertebra: usize) -> Angle {
        let still = self.solution().deformed.tilt(vertebra);
        self.base().map_or(still, |base| (still + base.angle).wrapped())
    }

    fn location_rate(&self, parameter: usize, vertebra: usize) -> Frontal {
        let still = self.solution().location_rate(parameter, vertebra);
        let Some(base) = self.base() else { return still };
        let rate = still.rotated(base.angle);
        if parameter < base.parameter {
            return rate;
        }
        let place = self.location(vertebra);
        rate + Frontal::new(-place.z_mm, place.y_mm)
    }

    fn tilt_rate(&self, parameter: usize, vertebra: usize) -> f64 {
        let turns = self.base().is_some_and(|base| parameter == base.parameter);
        self.solution().tilt_rate(parameter, vertebra) + if turns { 1.0 } else { 0.0 }
    }
}

/// A film under a load on T2, by the march. Its base does not turn.
pub(crate) struct MarchedFilm {
    load: Load,
    parameters: Vec<Parameter>,
    solution: Solution,
}

impl MarchedFilm {
    /// Derivatives are by the stiffness of this number of groups, and by the load.
    pub fn new(load: Load, groups: usize) -> Self {
        let components = (0..load.components()).map(Parameter::Load);
        let parameters = (0..groups).map(Parameter::LogStiffness).chain(components).collect();
        Self { load, parameters, solution: Solution::default() }
    }
}

impl FilmUnderLoad for MarchedFilm {
    type Springs<'a> = Statics<'a>;

    fn springs<'a>(
        spine: FittedSprings<'a>,
        log_multipliers: &[f64],
        support: Support,
    ) -> Statics<'a> {
        Statics::new(spine.model, spine.library, spine.groups, log_multipliers, support)
    }

    fn components(&self) -> usize {
        self.load.components()
    }

    fn first_component(&self) -> usize {
        self.parameters.len() - self.load.components()
    }

    /// The march searches nothing.
    fn reset(&mut self) {}

    fn solve(
        &mut self,
        springs: &Statics<'_>,
        components: &[f64],
        _: Angle,
        wanted: Wanted,
    ) -> bool {
        let parameters = match wanted {
            Wanted::Shape => &[],
            Wanted::LoadRates => &self.parameters[self.first_component()..],
            Wanted::AllRates => &self.parameters[..],
        };
        springs.solve(&self.load, components, parameters, &mut self.solution);
        self.solution.converged
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn base(&self) -> Option<TurnedBase> {
        None
    }

    fn force_at_amplitude(
        &self,
        springs: &Statics<'_>,
        sign: ForceSign,
        lateral_tilt: Angle,
    ) -> Option<f64> {
        let is_line = matches!(self.load, Load::Line { .. });
        is_line.then(|| match_amplitude(springs, &self.load, sign, lateral_tilt).force_n)
    }
}
