//! The march and its derivatives against automatic differentiation of an independent march.

use crate::common::independent::{self, Rates, add, cross, march, rates, vector};
use crate::common::{Draw, assert_near, spine, usual_regions};
use num_dual::Dual64;
use spineline::action::{Application, LineOfAction};
use spineline::anatomy::Levels;
use spineline::multibody::{
    JointGroups, Load, Parameter, Solution, SpineModel, Statics, StiffnessLibrary, Support, Wrench,
};
use spineline::spatial::{Angle, Frontal, Vec3};

/// Coordinates of some 400 mm through 14 products of rotations: a few hundred eps each.
const VALUE_MM: f64 = 1e-10;
/// Derivatives against the largest one of the same parameter: rounding through as many products.
const RATE: f64 = 1e-9;
/// Central differences of a step that costs about the cube root of eps.
const DIFFERENCE: f64 = 1e-6;

/// Springs, groups and a load on one subject's spine.
struct Bench {
    model: SpineModel,
    library: StiffnessLibrary,
    groups: JointGroups,
    logs: Vec<f64>,
    support: Support,
}

impl Bench {
    fn draw(subject: usize, groups: JointGroups, support: Support, draw: &mut Draw) -> Self {
        let logs = (0..groups.len()).map(|_| draw.between(-0.8, 0.8)).collect();
        let library = StiffnessLibrary::default();
        Self { model: spine(subject).1, library, groups, logs, support }
    }

    fn statics(&self) -> Statics<'_> {
        Statics::new(&self.model, &self.library, &self.groups, &self.logs, self.support)
    }

    fn solve(&self, load: &Load, magnitude: &[f64], parameters: &[Parameter]) -> Solution {
        let mut solution = Solution::default();
        self.statics().solve(load, magnitude, parameters, &mut solution);
        assert!(solution.converged);
        solution
    }

    /// Compliance in dual numbers, for given `ln α`.
    fn compliance(&self, joint: usize, logs: &[Dual64]) -> [Dual64; 3] {
        use num_dual::DualNum;
        let [x, y, z] = self.library.rows()[joint].nmm_per_rad;
        let group = self.groups.of_joint()[joint];
        let lateral = (-logs[group]).exp() / x;
        match self.support {
            Support::Free => [lateral, Dual64::from(1.0 / y), Dual64::from(1.0 / z)],
            Support::Frontal => [lateral, Dual64::from(0.0), Dual64::from(0.0)],
        }
    }

    /// The independent march with one parameter marked for differentiation.
    fn oracle(
        &self,
        units: &[Wrench],
        magnitude: &[f64],
        by: Parameter,
    ) -> Vec<independent::Body<Dual64>> {
        let marked = |value: f64, this: bool| Dual64::new(value, if this { 1.0 } else { 0.0 });
        let logs: Vec<Dual64> = (0..self.logs.len())
            .map(|g| marked(self.logs[g], by == Parameter::LogStiffness(g)))
            .collect();
        let zero: [Dual64; 3] = vector([0.0; 3]);
        let (mut force, mut moment) = (zero, zero);
        for (i, unit) in units.iter().enumerate().take(magnitude.len()) {
            let size = marked(magnitude[i], by == Parameter::Load(i));
            let scaled = |v: Vec3| [v.x, v.y, v.z].map(|x| size * x);
            force = add(force, scaled(unit.force_n));
            moment = add(moment, scaled(unit.moment_nmm));
        }
        march(&self.model, |j| self.compliance(j, &logs), force, moment)
    }

    /// Compares values and derivatives by every parameter.
    fn compare(&self, load: &Load, magnitude: &[f64]) {
        let loads = (0..load.components()).map(Parameter::Load);
        let parameters: Vec<Parameter> =
            (0..self.groups.len()).map(Parameter::LogStiffness).chain(loads).collect();
        let solution = self.solve(load, magnitude, &parameters);
        for (p, &parameter) in parameters.iter().enumerate() {
            let bodies = self.oracle(&load.units_on_film(), magnitude, parameter);
            let expected: Vec<_> = bodies.iter().map(rates).collect();
            let most = |pick: fn(&Rates) -> [f64; 3]| {
                expected.iter().flat_map(pick).fold(0.0, |most: f64, x| most.max(x.abs()))
            };
            let (most_mm, most_rad) = (most(|r| r.0), most(|r| r.1));
            assert!(most_mm > 0.0 && most_rad > 0.0, "{parameter:?} moves nothing");
            for (i, (body, (velocity, spin))) in bodies.iter().zip(&expected).enumerate() {
                let what = |name: &str| format!("{name} of vertebra {i} by {parameter:?}");
                for k in 0..3 {
                    let place = solution.deformed.midpoints_mm[i][k];
                    assert_near(place, body.midpoint[k].re, VALUE_MM, &what("midpoint"));
                    let rate = solution.midpoint_rates[p][i][k];
                    assert_near(rate, velocity[k], RATE * most_mm, &what("velocity"));
                    let turn = solution.turn_rates[p][i][k];
                    assert_near(turn, spin[k], RATE * most_rad, &what("rotation"));
                }
                let cranial = [0, 1, 2].map(|row| body.axes[row][2]);
                let tilt = independent_tilt(cranial);
                assert_near(solution.deformed.tilt(i).rad(), tilt.re, VALUE_MM, &what("tilt"));
                let rate = solution.tilt_rate(p, i);
                assert_near(rate, tilt.eps, RATE * most_rad, &what("rate of the tilt"));
            }
            let top = bodies[bodies.len() - 1].midpoint;
            let tilt = independent_tilt(top);
            assert_near(solution.deformed.lateral_tilt().rad(), tilt.re, VALUE_MM, "lean");
            assert_near(
                solution.lateral_tilt_rate(p),
                tilt.eps,
                RATE * most_rad,
                "rate of the lean",
            );
        }
    }
}

/// Lateral tilt of a direction in the frontal plane: positive to the patient's right, which is -y.
fn independent_tilt(v: [Dual64; 3]) -> Dual64 {
    use num_dual::DualNum;
    (-v[1]).atan2(v[2])
}

fn random_line(draw: &mut Draw) -> (Load, f64) {
    let point = Frontal::new(draw.between(-40.0, 40.0), draw.between(50.0, 150.0));
    let tilt = Angle::from_deg(draw.between(-60.0, 60.0));
    let load = Load::along(LineOfAction::leaning(point, tilt), draw.between(-30.0, 30.0));
    (load, draw.between(-150.0, 150.0))
}

fn benches(draw: &mut Draw) -> Vec<Bench> {
    let mut all = Vec::new();
    for support in [Support::Free, Support::Frontal] {
        for (subject, groups) in [
            (0, JointGroups::regional(&usual_regions())),
            (9, JointGroups::regional(&usual_regions())),
            (10, JointGroups::per_joint(Levels::COMPLETE)),
        ] {
            all.push(Bench::draw(subject, groups, support, draw));
        }
    }
    all
}

#[test]
fn the_march_under_a_line_agrees_with_automatic_differentiation() {
    // Oracle: dual numbers through an independent march.
    let mut draw = Draw::new(1);
    for bench in benches(&mut draw) {
        for _ in 0..4 {
            let (load, force_n) = random_line(&mut draw);
            bench.compare(&load, &[force_n]);
        }
    }
}

#[test]
fn the_march_under_a_frontal_load_agrees_with_automatic_differentiation() {
    // Oracle: dual numbers through an independent march.
    let mut draw = Draw::new(2);
    for bench in benches(&mut draw) {
        for _ in 0..4 {
            let load = Load::Frontal { depth_mm: draw.between(-30.0, 30.0) };
            let components = [
                draw.between(-40.0, 40.0),
                draw.between(-150.0, 150.0),
                draw.between(-6000.0, 6000.0),
            ];
            bench.compare(&load, &components);
        }
    }
}

#[test]
fn a_frontal_load_with_the_components_of_a_line_gives_the_shape_of_that_line() {
    // Oracle: the wrench of a line is (F u, p × F u).
    let mut draw = Draw::new(3);
    for bench in benches(&mut draw) {
        let (load, force_n) = random_line(&mut draw);
        let Load::Line { line, depth_mm } = load else { unreachable!("a line was drawn") };
        let components = spineline::personalize::estimate::components_of(&line, force_n);
        let along = bench.solve(&load, &[force_n], &[]);
        let free = bench.solve(&Load::Frontal { depth_mm }, &components, &[]);
        for (a, b) in along.deformed.midpoints_mm.iter().zip(&free.deformed.midpoints_mm) {
            assert_near((a - b).norm(), 0.0, VALUE_MM, "midpoint");
        }
    }
}

fn pull_at_t2(bench: &Bench) -> (Load, LineOfAction) {
    let top = bench.model.midpoints_mm[14];
    let line = LineOfAction::along_iliac(Frontal::new(top.y, top.z), Some(Angle::from_deg(4.0)));
    (Load::along(line, 0.0), line)
}

#[test]
fn a_force_at_t2_has_no_moment_about_the_place_where_t2_ends() {
    // Oracle: the independent march under the force at the final place ends at that same place.
    let mut draw = Draw::new(4);
    for bench in benches(&mut draw) {
        let (load, line) = pull_at_t2(&bench);
        assert_eq!(line.application, Application::AtT2);
        for force_n in [-35.0, -5.0, 0.0, 20.0, 40.0] {
            let solution = bench.solve(&load, &[force_n], &[]);
            let place = solution.deformed.midpoints_mm[14];
            let direction = [0.0, line.direction.y_mm, line.direction.z_mm];
            let force: [Dual64; 3] = vector(direction.map(|x| x * force_n));
            let moment = cross(vector([place.x, place.y, place.z]), force);
            let logs: Vec<Dual64> = bench.logs.iter().map(|&log| Dual64::from(log)).collect();
            let bodies = march(&bench.model, |j| bench.compliance(j, &logs), force, moment);
            let end = bodies[14].midpoint.map(|x| x.re);
            // 1e-9 mm is what the closure promises across the force.
            let gap = [0, 1, 2].map(|k| end[k] - place[k]);
            let along: f64 = (0..3).map(|k| gap[k] * direction[k]).sum();
            for k in 0..3 {
                assert_near(gap[k] - along * direction[k], 0.0, 5e-9, "lever arm about T2");
            }
        }
    }
}

#[test]
fn the_derivatives_of_a_force_at_t2_are_those_of_central_differences() {
    // Oracle: differences of whole solutions, each closed at its own place of T2.
    let mut draw = Draw::new(5);
    for mut bench in benches(&mut draw) {
        let (load, _) = pull_at_t2(&bench);
        let force_n = draw.between(-35.0, 35.0);
        let parameters: Vec<Parameter> = (0..bench.groups.len())
            .map(Parameter::LogStiffness)
            .chain([Parameter::Load(0)])
            .collect();
        let solution = bench.solve(&load, &[force_n], &parameters);
        for (p, &parameter) in parameters.iter().enumerate() {
            let step = if parameter == Parameter::Load(0) { 1e-2 } else { 1e-4 };
            let mut at = |sign: f64| match parameter {
                Parameter::Load(_) => bench.solve(&load, &[force_n + sign * step], &[]),
                Parameter::LogStiffness(group) => {
                    bench.logs[group] += sign * step;
                    let solution = bench.solve(&load, &[force_n], &[]);
                    bench.logs[group] -= sign * step;
                    solution
                }
            };
            let (after, before) = (at(1.0), at(-1.0));
            let most = solution.midpoint_rates[p].iter().map(|v| v.norm()).fold(0.0, f64::max);
            for i in 1..15 {
                let difference = (after.deformed.midpoints_mm[i] - before.deformed.midpoints_mm[i])
                    / (2.0 * step);
                let off = (solution.midpoint_rates[p][i] - difference).norm();
                assert_near(off, 0.0, DIFFERENCE * most, "velocity");
                let tilt = (after.deformed.tilt(i) - before.deformed.tilt(i)).rad() / (2.0 * step);
                let turn = solution.tilt_rate(p, i);
                assert_near(turn, tilt, DIFFERENCE * most / 100.0, "rate of the tilt");
            }
        }
    }
}
