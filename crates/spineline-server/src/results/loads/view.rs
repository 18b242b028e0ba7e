//! A model under loads as the browser shows it.

use spineline::analysis::{Analysis, PersonalisedModel};
use spineline::evaluate::FilmShape;
use spineline::multibody::{Deformed, Equilibrium, PathPoint, Timing};
use spineline::number::fixed;
use spineline::response::{ActingKind, CurveChange, acting_loads, erect_shape, measure_angles};
use spineline::spatial::Frontal;
use spineline::uncertainty::LoadedUncertainty;
use spineline_files::{LoadFault, LoadFile, Simulated};
use spineline_report::document::Table;
use spineline_report::loaded_tables::LoadedTables;

use super::super::simulated::{deformed_shape, errors_by_level};
use crate::api::{
    FilmComparison, LoadArrow, LoadFaultView, LoadStep, LoadedModel, LoadedView, Notice, Severity,
    Wire,
};

/// Maximum number of shapes that are sent; longer paths are thinned.
const MAX_STEPS: usize = 40;

/// Loads that cannot be applied.
pub fn faulty(model: &PersonalisedModel, loads: &LoadFile, faults: Vec<LoadFault>) -> LoadedModel {
    let fault = |fault: LoadFault| LoadFaultView {
        load: fault.load,
        text: format!("{}: {}", fault.reason, fault.help),
    };
    LoadedModel {
        loads: words(model, loads),
        faults: faults.into_iter().map(fault).collect(),
        simulation: None,
    }
}

fn words(model: &PersonalisedModel, loads: &LoadFile) -> Vec<String> {
    loads.loads.iter().map(|load| load.words(model.force_unit())).collect()
}

/// A simulation.
pub fn view(analysis: &Analysis, simulated: &Simulated) -> LoadedModel {
    let tables = tables(analysis, simulated, None);
    let result = simulated.response.result();
    let of_result = |table: &dyn Fn(&Equilibrium) -> Table| result.map(table).unwrap_or_default();
    let loaded = LoadedView {
        converged: result.is_some(),
        texts: tables.ending().into_iter().chain(tables.events()).collect(),
        angles: of_result(&|_| tables.angles()),
        forces: of_result(&|found| tables.forces(found)),
        numbers: of_result(&|found| tables.numbers(found)),
        solutions: tables.solutions(),
        notices: warnings(simulated),
        steps: steps(simulated),
        films: result.map(|found| films(analysis, &found.deformed)).unwrap_or_default(),
    };
    let loads = words(&simulated.model, &simulated.loads);
    LoadedModel { loads, faults: Vec::new(), simulation: Some(loaded) }
}

/// The texts and tables of a simulation, with intervals if they are computed.
pub fn tables<'a>(
    analysis: &'a Analysis,
    simulated: &'a Simulated,
    uncertainty: Option<&'a LoadedUncertainty>,
) -> LoadedTables<'a> {
    let film = Some(&analysis.movement.erect().outline);
    LoadedTables { simulated, film, uncertainty }
}

fn warnings(simulated: &Simulated) -> Vec<Notice> {
    let warning = |warning: &spineline_files::SimulationWarning| {
        Notice::new(Severity::Warning, warning.code.key(), warning.message.clone())
    };
    simulated.warnings.iter().map(warning).collect()
}

/// The shapes on the path, and the result.
fn steps(simulated: &Simulated) -> Vec<LoadStep> {
    let response = &simulated.response;
    let points: Vec<&PathPoint> = response.reached_points(&simulated.model.spine).collect();
    let last = points.len().saturating_sub(1);
    let every = points.len().div_ceil(MAX_STEPS).max(1);
    // Without a result, the last shape is where the loads stopped; it is always kept.
    let kept = points.iter().enumerate().filter(|(i, _)| i % every == 0 || *i == last);
    let mut steps: Vec<LoadStep> = kept
        .map(|(_, point)| {
            let factor = if point.timing == Timing::Proportional { point.factor } else { 0.0 };
            let percent = fixed(100.0 * point.factor, 0);
            let label = format!("{percent} % of the {} loads", point.timing);
            step(simulated, label, &point.deformed, factor, &[])
        })
        .collect();
    if let Some(result) = response.result() {
        let label = "All loads: the result".to_owned();
        let forces = &result.spring_forces_n;
        steps.push(step(simulated, label, &result.deformed, result.factor, forces));
    }
    steps
}

fn step(
    simulated: &Simulated,
    label: String,
    shape: &Deformed,
    factor: f64,
    spring_forces_n: &[(usize, f64)],
) -> LoadStep {
    let places = &simulated.places;
    let [before, after] =
        [&erect_shape(&simulated.model.spine), shape].map(|shape| measure_angles(shape, places));
    let base = simulated.model.levels[0];
    let tilt = format!("lateral tilt {} against {base}'s axis", after.lateral_tilt.leaning());
    let text = match CurveChange::between(&before, &after) {
        Some(change) => {
            let CurveChange { region, after, .. } = change;
            format!("{region} {} {after}; {tilt}", change.size_name())
        }
        None => tilt,
    };
    LoadStep {
        label,
        text,
        shape: deformed_shape(&simulated.model.spine, shape),
        arrows: arrows(simulated, shape, factor, spring_forces_n),
    }
}

/// Forces and moments of loads; slices of gravity are left out.
fn arrows(
    simulated: &Simulated,
    shape: &Deformed,
    factor: f64,
    spring_forces_n: &[(usize, f64)],
) -> Vec<LoadArrow> {
    let placed = &simulated.placed;
    let acting = acting_loads(&placed.loading, shape, factor, spring_forces_n);
    let alone = |item: usize| {
        let load = placed.load_of_item[item];
        placed.load_of_item.iter().filter(|other| **other == load).count() == 1
    };
    let size = |kind: &ActingKind| match kind {
        ActingKind::Force(force) => force.norm(),
        ActingKind::Moment(_) => 0.0,
    };
    let acting: Vec<_> = acting.into_iter().filter(|load| alone(load.item)).collect();
    let strongest = acting.iter().map(|load| size(&load.kind)).fold(f64::MIN_POSITIVE, f64::max);
    let arrow = |load: &spineline::response::ActingLoad| {
        let (vector, is_moment) = match load.kind {
            ActingKind::Force(force) => (force, false),
            ActingKind::Moment(moment) => (moment, true),
        };
        LoadArrow {
            load: placed.load_of_item[load.item],
            point_mm: load.point_mm.into(),
            vector: vector.into(),
            is_moment,
            part: size(&load.kind) / strongest,
        }
    };
    acting.iter().map(arrow).collect()
}

/// The result beside every other film.
fn films(analysis: &Analysis, shape: &Deformed) -> Vec<FilmComparison> {
    let locations: Vec<Frontal> =
        (0..shape.midpoints_mm.len()).map(|vertebra| shape.location(vertebra)).collect();
    let compared = analysis.movement.films.iter().skip(1).filter_map(|posture| {
        let found = FilmShape::new(locations.clone(), &posture.outline);
        (!found.compared.is_empty()).then(|| FilmComparison {
            posture: Wire(found.posture),
            mean_mm: found.mean_location_error_mm(),
            errors: errors_by_level(&found),
        })
    });
    compared.collect()
}
