//! Lines of action, personalisation and evaluation of one patient.

use super::endings::warn_of_endings;
use super::{AnalysisOptions, FilmMovement, LineModel, Movement};
use crate::action::{Application, LineKind, LineOfAction};
use crate::anatomy::Posture;
use crate::evaluate::{FilmUnderLine, NearbyMatch, Simulation, Target, predict, simulate};
use crate::multibody::{ForceSign, JointGroups, Load, PathEnding, Statics};
use crate::number::fixed;
use crate::personalize::estimate::{JointResponses, components_of, line_of};
use crate::personalize::evidence::ContradictedJoint;
use crate::personalize::{
    FitFilm, FitSettings, FitStatus, FitTarget, Gauge, Personalization, Start, personalize,
};
use crate::warning::{WarningCode, Warnings};

/// Fits one model per line of action and evaluates it on every film.
///
/// `starts` are models of other readings of the same films.
pub(super) fn fit_models(
    movement: &Movement,
    options: &AnalysisOptions,
    starts: &[LineModel],
    warnings: &mut Warnings,
) -> Vec<LineModel> {
    let mut models = Vec::new();
    if let Some(film) = movement.film_without_scale() {
        let text =
            "a film without a spacing has no lengths for a model: only its angles are measured";
        warnings.film(WarningCode::NoScale, film, text);
        return models;
    }
    if movement.bends().next().is_none() {
        let text = "no bending film: stiffness cannot be personalised";
        warnings.push(WarningCode::NoBendingFilm, text);
        return models;
    }
    for kind in options.line_kinds() {
        let bends = bending_loads(movement, options, kind, warnings);
        let task = FitTask {
            bends: &bends,
            films: &Posture::MOVED,
            models: &models,
            start: starts.iter().find(|model| model.kind == kind),
        };
        let model = fit_model(movement, options, kind, task, warnings);
        models.extend(model);
    }
    models
}

/// The line of a posture where geometry alone gives it; `None` for a line that must be estimated.
pub(super) fn geometric_line(
    options: &AnalysisOptions,
    kind: LineKind,
    posture: &FilmMovement,
    warnings: &mut Warnings,
) -> Option<LineOfAction> {
    let name = posture.outline.posture;
    match kind {
        LineKind::Iliac => {
            if posture.outline.iliac_normal.is_none() {
                let text = format!(
                    "the iliac crests are not marked: a line perpendicular to {}'s axis replaces the iliac line",
                    posture.outline.levels().base()
                );
                warnings.film(WarningCode::IliacCrestsMissing, name, text);
            }
            Some(LineOfAction::along_iliac(posture.outline.top(), posture.outline.iliac_normal))
        }
        LineKind::Inflection => {
            let [caudal, cranial] = posture.inflection_points?;
            match LineOfAction::through(caudal, cranial) {
                Ok(line) => Some(line),
                Err(error) => {
                    warnings.film(WarningCode::NoLine, name, error.to_string());
                    None
                }
            }
        }
        LineKind::Given => {
            let line = options.given_line(&posture.outline)?;
            warn_of_distance(&line, posture, warnings);
            Some(line)
        }
        LineKind::Estimated => None,
    }
}

/// A line that passes the whole spine further away than a trunk reaches was perhaps given in another unit or frame.
fn warn_of_distance(line: &LineOfAction, posture: &FilmMovement, warnings: &mut Warnings) {
    /// More than half of the breadth of any trunk.
    const FAR_MM: f64 = 300.0;
    let arms = posture.outline.locations().map(|location| line.lever_arm_mm(location).abs());
    let nearest_mm = arms.fold(f64::INFINITY, f64::min);
    if nearest_mm > FAR_MM {
        let text = format!(
            "the given line passes {} mm from the nearest vertebra, and a trunk reaches less than {} mm: \
             check that it is in mm from the base's (L4's) midpoint, to the patient's left and cranial",
            fixed(nearest_mm, 0),
            fixed(FAR_MM, 0)
        );
        warnings.film(WarningCode::GivenLineFar, posture.outline.posture, text);
    }
}

/// The bending films that have such a line, with the load along it.
pub(super) fn bending_loads<'a>(
    movement: &'a Movement,
    options: &AnalysisOptions,
    kind: LineKind,
    warnings: &mut Warnings,
) -> Vec<(&'a FilmMovement, Load)> {
    let depth_mm = movement.depth_mm();
    movement
        .bends()
        .filter_map(|p| {
            let load = match kind {
                LineKind::Estimated => Load::Frontal { depth_mm },
                _ => Load::along(geometric_line(options, kind, p, warnings)?, depth_mm),
            };
            Some((p, load))
        })
        .collect()
}

/// The settings of every fit of an analysis.
pub(super) fn settings_of<'a>(
    movement: &'a Movement,
    options: &AnalysisOptions,
    hints: &'a [Start],
) -> FitSettings<'a> {
    FitSettings {
        regions: &movement.regions,
        target: options.target,
        gauge: options.gauge,
        support: options.support,
        prior: options.prior,
        hints,
    }
}

/// The data of a fit, and its warm start.
#[derive(Clone, Copy)]
pub(super) struct FitTask<'a> {
    /// Bends that are fitted.
    pub bends: &'a [(&'a FilmMovement, Load)],
    /// Films that are simulated; those that are not among the bends are held out.
    pub films: &'a [Posture],
    /// Models with other lines, fitted to these bends and no other.
    pub models: &'a [LineModel],
    /// The model of other readings of these films.
    pub start: Option<&'a LineModel>,
}

/// The bends of a fit, as it takes them.
pub(super) fn fit_films<'a>(bends: &[(&'a FilmMovement, Load)]) -> Vec<FitFilm<'a>> {
    let film = |(p, load): &(&'a FilmMovement, Load)| {
        Some(FitFilm { outline: &p.outline, evidence: p.evidence.as_ref()?, load: *load })
    };
    bends.iter().filter_map(film).collect()
}

/// Fits one line's model to some bends, and predicts films with it.
pub(super) fn fit_model(
    movement: &Movement,
    options: &AnalysisOptions,
    kind: LineKind,
    task: FitTask<'_>,
    warnings: &mut Warnings,
) -> Option<LineModel> {
    let FitTask { bends, .. } = task;
    let groups = movement.joint_groups(options.grouping);
    if bends.is_empty() {
        warnings.line(WarningCode::NoLine, kind, None, "no bending film has this line");
        return None;
    }
    let films = fit_films(bends);
    let hints = match kind {
        LineKind::Estimated => hints(task.models, bends),
        _ => Vec::new(),
    };
    let settings = settings_of(movement, options, &hints);
    let fit = personalize(
        movement.springs(&groups),
        &films,
        &settings,
        task.start.map(|model| &model.fit),
    );
    let logs = &fit.log_multipliers;
    let evaluation = Evaluation {
        movement,
        options,
        kind,
        groups: &groups,
        fit: &fit,
        statics: Statics::new(
            movement.spine_of_films(),
            &movement.library,
            &groups,
            logs,
            options.support,
        ),
        target: settings.target,
        depth_mm: movement.depth_mm(),
        start: task.start,
    };
    let simulations = evaluation.simulate_all(task, warnings);
    let model = LineModel { kind, groups, fit, simulations };
    let model = scaled_to_known_force(model, options.gauge, warnings);
    warn_of_endings(&model, warnings);
    Some(model)
}

/// A fit that is to predict films.
struct Evaluation<'a> {
    movement: &'a Movement,
    options: &'a AnalysisOptions,
    kind: LineKind,
    groups: &'a JointGroups,
    fit: &'a Personalization,
    statics: Statics<'a>,
    target: FitTarget,
    depth_mm: f64,
    start: Option<&'a LineModel>,
}

impl Evaluation<'_> {
    /// Predicts every film of a task that has such a line.
    fn simulate_all(&self, task: FitTask<'_>, warnings: &mut Warnings) -> Vec<Simulation> {
        let mut simulations = Vec::new();
        let films = self.movement.films.iter();
        for posture in films.filter(|p| task.films.contains(&p.outline.posture)) {
            let name = posture.outline.posture;
            let fitted = task.bends.iter().position(|(p, _)| p.outline.posture == name);
            match self.simulate(posture, fitted, warnings) {
                Some(simulation) => simulations.push(simulation),
                None => {
                    let text = "this film lacks this line, so it is not simulated";
                    warnings.line(WarningCode::NoLine, self.kind, Some(name), text);
                }
            }
        }
        simulations
    }

    /// Predicts one film; `fitted` is its place among the fitted ones. `None` where the film lacks the line.
    fn simulate(
        &self,
        posture: &FilmMovement,
        fitted: Option<usize>,
        warnings: &mut Warnings,
    ) -> Option<Simulation> {
        let options = self.options;
        let estimated = self.kind == LineKind::Estimated;
        let (line, estimated_n) = if estimated {
            self.estimated_line(posture, fitted)?
        } else {
            (geometric_line(options, self.kind, posture, warnings)?, 0.0)
        };
        // With the whole shape as data the force was fitted, or frozen; with Ferguson angles the amplitude determines it.
        let known = self.target == FitTarget::Shape || options.gauge == Gauge::FrozenForce;
        let target = match (posture.outline.posture.bend(), fitted) {
            (_, Some(_)) if estimated => Target::Fitted(estimated_n),
            (_, Some(film)) if known => Target::Fitted(self.fit.loads[film][0]),
            (Some(_), Some(_)) => Target::Amplitude,
            // A bend that was left out is predicted as any other film that was not fitted.
            _ => {
                // T2's place alone may fit either sign; the rotations that gave the line gave the sign too.
                let sign = estimated.then(|| ForceSign::of(estimated_n));
                Target::NearestT2 { sign, start: self.nearby(posture.outline.posture) }
            }
        };
        let film = FilmUnderLine { outline: &posture.outline, line, depth_mm: self.depth_mm };
        let shape_of = if fitted.is_some() { simulate } else { predict };
        let simulation = shape_of(&self.statics, film, &self.movement.regions, target);
        let status = match self.fit.status {
            // Nominal springs do not predict this patient.
            FitStatus::NotEvaluable => PathEnding::NotConverged,
            FitStatus::IterationLimit | FitStatus::Stalled if simulation.is_usable() => {
                PathEnding::FitNotConverged
            }
            FitStatus::IterationLimit | FitStatus::Stalled | FitStatus::Converged => {
                simulation.status
            }
        };
        let contradicted = contradicted(posture, &simulation);
        Some(Simulation { status, contradicted, ..simulation })
    }

    /// The result of other readings of a film.
    fn nearby(&self, posture: Posture) -> Option<NearbyMatch> {
        let start = self.start?;
        NearbyMatch::of(start.simulation(posture)?, start.fit.absolute_scale)
    }

    /// The fitted load's line and force on a fitted film; elsewhere the line of best fit to the film's rotations at the fitted
    /// stiffness.
    fn estimated_line(
        &self,
        posture: &FilmMovement,
        fitted: Option<usize>,
    ) -> Option<(LineOfAction, f64)> {
        let components: [f64; 3] = match fitted {
            Some(film) => self.fit.loads[film].as_slice().try_into().ok()?,
            None => {
                let evidence = posture.evidence.as_ref()?;
                let load = Load::Frontal { depth_mm: self.depth_mm };
                let logs = &self.fit.log_multipliers;
                JointResponses::to(&load, evidence).load(self.groups, logs).into()
            }
        };
        line_of(&components, posture.middle()).map(|estimated| (estimated.line, estimated.force_n))
    }
}

/// The results of the fits with other lines, as free loads: the estimated line then never does much worse.
fn hints(models: &[LineModel], bends: &[(&FilmMovement, Load)]) -> Vec<Start> {
    let load = |model: &LineModel, posture| Some(free_load(model, posture)?.to_vec());
    models
        .iter()
        .filter_map(|model| {
            let loads =
                bends.iter().map(|(p, _)| load(model, p.outline.posture)).collect::<Option<_>>()?;
            Some(Start { log_multipliers: model.fit.log_multipliers.clone(), loads })
        })
        .collect()
}

/// A model's force on a film as a free load to start from, before any known force scales it.
pub(super) fn free_load(model: &LineModel, posture: Posture) -> Option<[f64; 3]> {
    let simulation = model.simulation(posture).filter(|s| s.has_force())?;
    let mut line = simulation.line;
    if line.application == Application::AtT2 {
        // In equilibrium a force at T2 is one along a line through where T2 is.
        line.point = simulation.shape.locations[simulation.joints()];
    }
    Some(components_of(&line, simulation.force_n / model.fit.absolute_scale))
}

fn contradicted(posture: &FilmMovement, simulation: &Simulation) -> Vec<ContradictedJoint> {
    let Some(evidence) = &posture.evidence else { return Vec::new() };
    let mut line = simulation.line;
    // On the film the force that follows T2 is where T2 was seen.
    line.application = Application::Fixed;
    let load = Load::Frontal { depth_mm: simulation.depth_mm };
    evidence.contradicted(&evidence.responses(&load), components_of(&line, simulation.force_n))
}

/// A known force scales springs about all axes and all forces alike, which changes no shape. Only its size counts: its
/// sign is the fit's.
fn scaled_to_known_force(mut model: LineModel, gauge: Gauge, warnings: &mut Warnings) -> LineModel {
    let Gauge::KnownForce { posture, force_n } = gauge else { return model };
    let simulated =
        model.simulation(posture).filter(|s| s.is_usable() && s.force_n != 0.0).map(|s| s.force_n);
    let Some(simulated) = simulated else {
        let text = "no usable force in this posture, so the known force cannot scale the stiffness";
        let code = WarningCode::KnownForceUnused;
        warnings.line(code, model.kind, Some(posture), text);
        return model;
    };
    let scale = force_n.abs() / simulated.abs();
    model.fit.absolute_scale = scale;
    for load in model.fit.loads.iter_mut().flatten() {
        *load *= scale;
    }
    for simulation in &mut model.simulations {
        simulation.force_n *= scale;
        for other in &mut simulation.alternatives {
            other.force_n *= scale;
        }
    }
    model
}
