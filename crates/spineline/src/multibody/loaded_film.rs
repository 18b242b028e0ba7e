//! One film under components of unit loads, by the general solver.

use super::{
    FilmUnderLoad, FittedSprings, ForceSign, GeneralStatics, JointGroups, LoadItem, Loading,
    MAX_HINGE_RAD, NewtonWork, ShapeParameter, Solution, SpineModel, Support, TurnedBase, UnitLoad,
    Wanted, coupled_matrix,
};
use crate::spatial::{Angle, Vec3};

/// Steps in which loads grow from zero if Newton does not converge at once.
const GROWTH_STEPS: u32 = 12;

pub(crate) struct LoadedFilm {
    /// Unit loads of every component.
    pub units: Vec<Vec<UnitLoad>>,
    work: NewtonWork,
    solution: Solution,
    base: Angle,
    /// Joints of every group.
    joints: Vec<Vec<bool>>,
}

impl LoadedFilm {
    /// The unloaded spine. Only the model of `nominal` counts, not its springs.
    pub fn new(
        units: Vec<Vec<UnitLoad>>,
        nominal: &GeneralStatics<'_>,
        groups: &JointGroups,
    ) -> Self {
        let of_joint = groups.of_joint();
        Self {
            units,
            work: nominal.work(&Loading::default()).expect("no load can be wrong"),
            solution: Solution::default(),
            base: Angle::ZERO,
            joints: (0..groups.len())
                .map(|group| of_joint.iter().map(|of| *of == group).collect())
                .collect(),
        }
    }

    /// Equilibrium under one component on a base that does not turn, with its derivative by that component, from the shape in
    /// `solution` or else from the unloaded spine. Hinges may turn without limit.
    pub fn solve_one(
        &mut self,
        statics: &GeneralStatics<'_>,
        component: f64,
        solution: &mut Solution,
    ) {
        self.base = Angle::ZERO;
        self.start_from(solution);
        let loading = Loading { items: self.items(&[component]), rods: Vec::new() };
        solution.converged = self.solves(statics, &loading, 1.0, f64::INFINITY)
            || self.grows(statics, &loading, f64::INFINITY);
        if solution.converged {
            let unit = self.items(&[1.0]);
            let parameters = [ShapeParameter::Loads(&unit)];
            statics.differentiate(&loading, &mut self.work, &parameters, solution);
        }
    }

    /// Starts the next search from a shape, or else from the unloaded spine.
    pub fn start_from(&mut self, solution: &Solution) {
        self.reset();
        for (hinge, turns) in self.work.hinges_mut().iter_mut().zip(&solution.deformed.hinges_rad) {
            *hinge = Vec3::from(*turns);
        }
    }

    fn items(&self, components: &[f64]) -> Vec<LoadItem> {
        let base = self.base;
        let all = self.units.iter().zip(components);
        all.flat_map(|(units, &times)| units.iter().map(move |unit| unit.item(times, base)))
            .collect()
    }

    fn solves(
        &mut self,
        statics: &GeneralStatics<'_>,
        loading: &Loading,
        part: f64,
        limit_rad: f64,
    ) -> bool {
        let converged = statics.solve_near(loading, part, &mut self.work);
        let hinges = self.work.hinges_mut().iter();
        converged && hinges.fold(0.0, |most: f64, turns| most.max(turns.amax())) <= limit_rad
    }

    /// Lets the loads grow from zero.
    fn grows(&mut self, statics: &GeneralStatics<'_>, loading: &Loading, limit_rad: f64) -> bool {
        self.reset();
        let parts = (1..=GROWTH_STEPS).map(|step| f64::from(step) / f64::from(GROWTH_STEPS));
        let grown = parts.into_iter().all(|part| self.solves(statics, loading, part, limit_rad));
        if !grown {
            self.reset();
        }
        grown
    }

    /// Whether the shape is beyond the human range of motion; the base's own turn does not count.
    pub fn is_beyond_human_range(&self, erect: &SpineModel) -> bool {
        self.solution.deformed.beyond_human_range(erect).is_some()
    }
}

impl FilmUnderLoad for LoadedFilm {
    type Springs<'a> = GeneralStatics<'a>;

    fn springs<'a>(
        spine: FittedSprings<'a>,
        log_multipliers: &[f64],
        support: Support,
    ) -> GeneralStatics<'a> {
        let joints = spine.library.rows().iter().zip(spine.groups.of_joint());
        let springs = joints.map(|(row, &group)| {
            let [lateral, flexion, axial] = row.nmm_per_rad;
            let springs = [lateral * log_multipliers[group].exp(), flexion, axial];
            coupled_matrix(springs, row.axial_per_lateral)
        });
        GeneralStatics::new(spine.model, springs, support).expect(
            "a library has one positive spring per joint and axis, and multipliers are positive",
        )
    }

    fn components(&self) -> usize {
        self.units.len()
    }

    fn first_component(&self) -> usize {
        self.joints.len()
    }

    fn reset(&mut self) {
        self.work.hinges_mut().fill(Vec3::zeros());
    }

    fn solve(
        &mut self,
        springs: &GeneralStatics<'_>,
        components: &[f64],
        base: Angle,
        wanted: Wanted,
    ) -> bool {
        self.base = base;
        let loading = Loading { items: self.items(components), rods: Vec::new() };
        let found = self.solves(springs, &loading, 1.0, MAX_HINGE_RAD)
            || self.grows(springs, &loading, MAX_HINGE_RAD);
        if !found {
            return false;
        }
        let by_component: Vec<Vec<LoadItem>> = self
            .units
            .iter()
            .map(|units| units.iter().map(|unit| unit.item(1.0, base)).collect())
            .collect();
        let by_base: Vec<LoadItem> = self
            .units
            .iter()
            .zip(components)
            .flat_map(|(units, &times)| units.iter().flat_map(move |u| u.turned_items(times, base)))
            .collect();
        let by_stiffness = self.joints.iter().map(|joints| ShapeParameter::LogLateral(joints));
        let by_component = by_component.iter().map(|items| ShapeParameter::Loads(items));
        let parameters: Vec<ShapeParameter<'_>> = match wanted {
            Wanted::Shape => Vec::new(),
            Wanted::LoadRates => by_component.collect(),
            Wanted::AllRates => {
                by_stiffness.chain(by_component).chain([ShapeParameter::Loads(&by_base)]).collect()
            }
        };
        springs.differentiate(&loading, &mut self.work, &parameters, &mut self.solution);
        self.solution.converged
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn base(&self) -> Option<TurnedBase> {
        Some(TurnedBase { angle: self.base, parameter: self.joints.len() + self.units.len() })
    }

    fn force_at_amplitude(&self, _: &GeneralStatics<'_>, _: ForceSign, _: Angle) -> Option<f64> {
        None
    }
}
