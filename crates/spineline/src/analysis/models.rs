//! Lines of action, personalisation and evaluation of one patient.

use super::endings::warn_of_endings;
use super::{Analysis, Grouping, PostureAnalysis};
use crate::action::{Application, LineKind, LineOfAction};
use crate::anatomy::{Level, Posture};
use crate::evaluate::{Simulation, Target, simulate};
use crate::multibody::{
    Deformed, ForceSign, JointGroups, Load, MatchStatus, Solution, Statics, StiffnessLibrary,
};
use crate::personalize::estimate::{
    EstimatedLoads, components_of, estimate_load, estimate_loads, line_of,
};
use crate::personalize::evidence::FilmEvidence;
use crate::personalize::{
    FitFilm, FitSettings, FitStatus, FitTarget, Gauge, Known, Personalization, Start,
    personalize_with,
};
use crate::spatial::Frontal;
use crate::warning::{Step, Warnings};

/// A personalised model for one choice of line, and what it predicts.
#[derive(Debug, Clone, PartialEq)]
pub struct LineModel {
    /// The choice of line.
    pub kind: LineKind,
    /// Which joints share a multiplier.
    pub groups: JointGroups,
    /// The fit.
    pub fit: Personalization,
    /// Predictions of every posture that has a line, fitted ones and held-out ones.
    pub postures: Vec<Simulation>,
}

impl LineModel {
    /// One posture's prediction.
    #[must_use]
    pub fn posture(&self, posture: Posture) -> Option<&Simulation> {
        self.postures.iter().find(|simulation| simulation.posture == posture)
    }

    /// Multipliers of the lateral springs, in the order of the groups.
    pub fn multipliers(&self) -> impl Iterator<Item = f64> {
        self.fit.log_multipliers.iter().map(|log| log.exp())
    }

    /// Personalised springs of every joint about x, y and z, caudal first.
    #[must_use]
    pub fn stiffness_nmm_per_rad(&self, library: &StiffnessLibrary) -> Vec<[f64; 3]> {
        let multipliers: Vec<f64> = self.multipliers().collect();
        library
            .rows()
            .iter()
            .zip(self.groups.of_joint())
            .map(|(row, &group)| {
                let [lateral, flexion, axial] =
                    row.nmm_per_rad.map(|k| k * self.fit.absolute_scale);
                [lateral * multipliers[group], flexion, axial]
            })
            .collect()
    }

    /// Whether springs and forces are absolute: only where a force is known and was found in the model.
    #[must_use]
    pub fn is_absolute(&self, gauge: Gauge) -> bool {
        let Gauge::KnownForce { posture, .. } = gauge else { return false };
        self.posture(posture).is_some_and(|s| s.is_usable() && s.force_n != 0.0)
    }

    /// Mean location error over fitted or over held-out postures; `None` where there is none.
    #[must_use]
    pub fn mean_location_error_mm(&self, fitted: bool) -> Option<f64> {
        let errors: Vec<f64> = self
            .postures
            .iter()
            .filter(|s| s.fitted == fitted && s.is_usable())
            .flat_map(|s| s.location_errors_mm.iter().copied())
            .collect();
        (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
    }
}

impl Analysis {
    /// The spine of a simulated posture under parts of its force, such as 0, 0.5 and 1: the paper's figure 11.
    ///
    /// `None` where the model has no such posture.
    #[must_use]
    pub fn force_path(
        &self,
        model: &LineModel,
        posture: Posture,
        parts: &[f64],
    ) -> Option<Vec<(f64, Vec<Frontal>)>> {
        let shapes = self.force_shapes(model, posture, parts)?;
        let locations = |shape: &Deformed| {
            (0..shape.midpoints_mm.len()).map(|i| shape.location(i)).collect::<Vec<Frontal>>()
        };
        Some(parts.iter().copied().zip(shapes.iter().map(locations)).collect())
    }

    /// As [`Analysis::force_path`], with the whole shape of the spine under each part.
    #[must_use]
    pub fn force_shapes(
        &self,
        model: &LineModel,
        posture: Posture,
        parts: &[f64],
    ) -> Option<Vec<Deformed>> {
        let simulation = model.posture(posture)?;
        let options = &self.options;
        let logs = &model.fit.log_multipliers;
        let statics =
            Statics::new(&self.spine, &options.library, &model.groups, logs, options.support);
        let load = Load::along(simulation.line, simulation.depth_mm);
        // Springs and forces are scaled alike, so the unscaled ones give the same shapes.
        let force_n = simulation.force_n / model.fit.absolute_scale;
        let mut solution = Solution::default();
        let shapes = parts.iter().map(|&part| {
            statics.solve(&load, &[part * force_n], &[], &mut solution);
            solution.deformed.clone()
        });
        Some(shapes.collect())
    }

    /// Whether every fit and every simulation came to an end that may be shown as a result.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.models.iter().all(|model| {
            model.fit.status == FitStatus::Converged
                && model.postures.iter().all(Simulation::is_usable)
        }) && self.hypotheses.iter().all(|fit| fit.is_converged() && fit.lost.is_empty())
    }
}

/// Fits one model per line of action and evaluates it on every film.
///
/// `others` are models of other readings of the same films.
pub(super) fn fit_models(analysis: &mut Analysis, others: &[LineModel]) {
    let mut warnings = std::mem::take(&mut analysis.warnings);
    if let Some(film) = analysis.film_without_scale() {
        let text =
            "a film without a spacing has no lengths to put a model on: angles are all it gives";
        warnings.film(Step::Multibody, "no_scale", film, text);
        analysis.warnings = warnings;
        return;
    }
    let bends = analysis.postures.iter().filter(|p| p.outline.posture.bend().is_some()).count();
    if bends == 0 {
        let text = "no bending film: stiffness cannot be personalised";
        warnings.push(Step::Personalize, "no_bending_film", text);
    } else {
        // What was found for other readings is nearer.
        let estimate = if others.is_empty() { estimate_bends(analysis) } else { None };
        for kind in analysis.options.line_kinds() {
            let bends = bending_loads(analysis, kind, depth_mm(analysis), &mut warnings);
            let task = FitTask {
                bends: &bends,
                films: &Posture::MOVED,
                models: &analysis.models,
                estimate: estimate.as_ref(),
                other: others.iter().find(|model| model.kind == kind).map(|model| &model.fit),
            };
            let model = fit_model(analysis, kind, task, &mut warnings);
            analysis.models.extend(model);
        }
    }
    analysis.warnings = warnings;
}

/// Sagittal place of the lines: the mean depth of the vertebrae at the inflections; without inflections that of L4 and
/// T2, which is zero.
pub(super) fn depth_mm(analysis: &Analysis) -> f64 {
    let Some(pair) = analysis.inflections.pair else { return 0.0 };
    let at = |level: Level| level.model_index().map_or(0.0, |i| analysis.spine.midpoints_mm[i].x);
    pair.iter()
        .map(|inflection| 0.5 * (at(inflection.between.0) + at(inflection.between.1)))
        .sum::<f64>()
        / 2.0
}

/// The loads of the bends that fits of the estimated line start from.
fn estimate_bends(analysis: &Analysis) -> Option<EstimatedLoads> {
    let bends: Vec<&FilmEvidence> = analysis
        .postures
        .iter()
        .filter(|p| p.outline.posture.bend().is_some())
        .filter_map(|p| p.evidence.as_ref())
        .collect();
    let groups = JointGroups::regional(&analysis.regions);
    (!bends.is_empty()).then(|| estimate_loads(&bends, depth_mm(analysis), &groups))
}

/// The line of a posture where geometry alone gives it; `None` for a line that must be estimated.
fn geometric_line(
    analysis: &Analysis,
    kind: LineKind,
    posture: &PostureAnalysis,
    warnings: &mut Warnings,
) -> Option<LineOfAction> {
    let name = posture.outline.posture;
    match kind {
        LineKind::Iliac => {
            if posture.outline.iliac_normal.is_none() {
                let text = "no iliac crests marked: the iliac line is taken across L4's axis";
                warnings.film(Step::Measure, "iliac_crests_missing", name, text);
            }
            let t2 = posture.outline.vertebrae[Level::MODEL.len() - 1].location;
            Some(LineOfAction::along_iliac(t2, posture.outline.iliac_normal))
        }
        LineKind::Inflection => {
            let [caudal, cranial] = posture.inflection_points?;
            match LineOfAction::through(caudal, cranial) {
                Ok(line) => Some(line),
                Err(error) => {
                    warnings.film(Step::Action, "no_line", name, error.to_string());
                    None
                }
            }
        }
        LineKind::Given => {
            analysis.options.given_lines.iter().find(|(p, _)| *p == name).map(|(_, line)| *line)
        }
        LineKind::Estimated => None,
    }
}

/// The bending films that have such a line, with the load along it.
pub(super) fn bending_loads<'a>(
    analysis: &'a Analysis,
    kind: LineKind,
    depth_mm: f64,
    warnings: &mut Warnings,
) -> Vec<(&'a PostureAnalysis, Load)> {
    let bends = analysis.postures.iter().filter(|p| p.outline.posture.bend().is_some());
    bends
        .filter_map(|p| {
            let load = match kind {
                LineKind::Estimated => Load::Frontal { depth_mm },
                _ => Load::along(geometric_line(analysis, kind, p, warnings)?, depth_mm),
            };
            Some((p, load))
        })
        .collect()
}

/// What every fit of an analysis needs beside its films.
pub(super) fn settings_of<'a>(analysis: &'a Analysis, hints: &'a [Start]) -> FitSettings<'a> {
    let options = &analysis.options;
    FitSettings {
        regions: &analysis.regions,
        target: match options.grouping {
            Grouping::Regional => options.target,
            Grouping::PerJoint => FitTarget::Shape,
        },
        gauge: options.gauge,
        support: options.support,
        prior: options.prior,
        hints,
    }
}

/// What a fit is to, and what is known before it.
#[derive(Clone, Copy)]
pub(super) struct FitTask<'a> {
    /// Bends that are fitted.
    pub bends: &'a [(&'a PostureAnalysis, Load)],
    /// Films that are simulated; those that are not among the bends are held out.
    pub films: &'a [Posture],
    /// Models with other lines, fitted to these bends and no other.
    pub models: &'a [LineModel],
    /// The free loads of these bends.
    pub estimate: Option<&'a EstimatedLoads>,
    /// The fit to other readings of these bends.
    pub other: Option<&'a Personalization>,
}

/// Fits one line's model to some bends, and predicts films with it.
pub(super) fn fit_model(
    analysis: &Analysis,
    kind: LineKind,
    task: FitTask<'_>,
    warnings: &mut Warnings,
) -> Option<LineModel> {
    let FitTask { bends, .. } = task;
    let options = &analysis.options;
    let depth_mm = depth_mm(analysis);
    let groups = analysis.joint_groups();
    if bends.is_empty() {
        warnings.line(Step::Action, "no_line", kind, None, "no bending film has such a line");
        return None;
    }
    let films: Vec<FitFilm<'_>> =
        bends.iter().map(|(p, load)| FitFilm { outline: &p.outline, load: *load }).collect();
    let hints = match kind {
        LineKind::Estimated => hints(task.models, bends),
        _ => Vec::new(),
    };
    let settings = settings_of(analysis, &hints);
    let evidence: Vec<(&FilmEvidence, Load)> =
        bends.iter().filter_map(|(p, load)| Some((p.evidence.as_ref()?, *load))).collect();
    // It was made for regional groups.
    let estimate = task.estimate.filter(|_| options.grouping == Grouping::Regional);
    let known = Known { evidence: &evidence, settings: &settings, estimate, other: task.other };
    let fit = personalize_with(&analysis.spine, &options.library, &groups, &films, &known);
    let mut model = LineModel { kind, groups, fit, postures: Vec::new() };
    let logs = &model.fit.log_multipliers;
    let statics =
        Statics::new(&analysis.spine, &options.library, &model.groups, logs, options.support);
    let evaluation =
        Evaluation { analysis, model: &model, statics, target: settings.target, depth_mm };
    let mut simulations = Vec::new();
    for posture in analysis.postures.iter().filter(|p| task.films.contains(&p.outline.posture)) {
        let name = posture.outline.posture;
        let fitted = bends.iter().position(|(p, _)| p.outline.posture == name);
        match evaluation.simulate(posture, fitted, warnings) {
            Some(simulation) => simulations.push(simulation),
            None => {
                let text = "this film has no such line, so it is not simulated";
                warnings.line(Step::Action, "no_line", kind, Some(name), text);
            }
        }
    }
    model.postures = simulations;
    scale_to_known_force(&mut model, options.gauge, warnings);
    warn_of_endings(&model, warnings);
    Some(model)
}

/// A fitted model that is to predict films.
struct Evaluation<'a> {
    analysis: &'a Analysis,
    model: &'a LineModel,
    statics: Statics<'a>,
    target: FitTarget,
    depth_mm: f64,
}

impl Evaluation<'_> {
    /// Predicts one film; `fitted` is its place among the fitted ones. `None` where the film has no such line.
    fn simulate(
        &self,
        posture: &PostureAnalysis,
        fitted: Option<usize>,
        warnings: &mut Warnings,
    ) -> Option<Simulation> {
        let kind = self.model.kind;
        let estimated = kind == LineKind::Estimated;
        let (line, estimated_n) = if estimated {
            estimated_line(self.model, posture, fitted, self.depth_mm)?
        } else {
            (geometric_line(self.analysis, kind, posture, warnings)?, 0.0)
        };
        // With the whole shape as data the force was fitted, or frozen; with Ferguson angles the amplitude determines it.
        let options = &self.analysis.options;
        let known = self.target == FitTarget::Shape || options.gauge == Gauge::FrozenForce;
        let target = match (posture.outline.posture.bend(), fitted) {
            (_, Some(_)) if estimated => Target::Fitted(estimated_n),
            (_, Some(film)) if known => Target::Fitted(self.model.fit.loads[film][0]),
            (Some(_), Some(_)) => Target::Amplitude,
            // T2's place alone may fit either sign; the rotations that gave the line gave the sign too. A bend that was left
            // out is predicted as any other film that was not fitted.
            _ if estimated => Target::NearestT2(Some(ForceSign::of(estimated_n))),
            _ => Target::NearestT2(None),
        };
        let mut simulation = simulate(
            &self.statics,
            (line, self.depth_mm),
            &posture.outline,
            &self.analysis.regions,
            target,
            fitted.is_some(),
        );
        if self.model.fit.status == FitStatus::NotEvaluable {
            // Nominal springs predict nothing of this patient.
            simulation.status = MatchStatus::NotConverged;
        }
        simulation.contradicted = contradicted(posture, &simulation);
        Some(simulation)
    }
}

/// What the fits with other lines have found, as free loads: the estimated line then never does much worse.
fn hints(models: &[LineModel], bends: &[(&PostureAnalysis, Load)]) -> Vec<Start> {
    let load = |model: &LineModel, posture: Posture| {
        let simulation = model.posture(posture).filter(|s| s.is_usable())?;
        let mut line = simulation.line;
        if line.application == Application::AtT2 {
            // In equilibrium a force at T2 is one along a line through where T2 is.
            line.point = simulation.locations[simulation.locations.len() - 1];
        }
        let force_n = simulation.force_n / model.fit.absolute_scale;
        Some(components_of(&line, force_n).to_vec())
    };
    models
        .iter()
        .filter_map(|model| {
            let loads =
                bends.iter().map(|(p, _)| load(model, p.outline.posture)).collect::<Option<_>>()?;
            Some(Start { log_multipliers: model.fit.log_multipliers.clone(), loads })
        })
        .collect()
}

/// The fitted load's line and force on a fitted film; elsewhere the line that the film's rotations prefer at the fitted stiffness.
fn estimated_line(
    model: &LineModel,
    posture: &PostureAnalysis,
    fitted: Option<usize>,
    depth_mm: f64,
) -> Option<(LineOfAction, f64)> {
    let components: [f64; 3] = match fitted {
        Some(film) => model.fit.loads[film].as_slice().try_into().ok()?,
        None => {
            let evidence = posture.evidence.as_ref()?;
            let responses = evidence.responses(&Load::Frontal { depth_mm });
            let load =
                estimate_load(evidence, &responses, &model.groups, &model.fit.log_multipliers);
            load.components.into()
        }
    };
    line_of(&components, posture.middle()).map(|estimated| (estimated.line, estimated.force_n))
}

fn contradicted(
    posture: &PostureAnalysis,
    simulation: &Simulation,
) -> Vec<crate::personalize::evidence::ContradictedJoint> {
    let Some(evidence) = &posture.evidence else { return Vec::new() };
    let mut line = simulation.line;
    // On the film the force that follows T2 is where T2 was seen.
    line.application = Application::Fixed;
    let load = Load::Frontal { depth_mm: simulation.depth_mm };
    evidence.contradicted(&load, components_of(&line, simulation.force_n))
}

/// A known force scales springs about all axes and all forces alike, which changes no shape. Only its size counts: its
/// sign is the fit's.
fn scale_to_known_force(model: &mut LineModel, gauge: Gauge, warnings: &mut Warnings) {
    let Gauge::KnownForce { posture, force_n } = gauge else { return };
    let simulated =
        model.posture(posture).filter(|s| s.is_usable() && s.force_n != 0.0).map(|s| s.force_n);
    let Some(simulated) = simulated else {
        let text = "no usable force in this posture, so the known force fixes nothing";
        let code = "known_force_unused";
        warnings.line(Step::Personalize, code, model.kind, Some(posture), text);
        return;
    };
    let scale = force_n.abs() / simulated.abs();
    model.fit.absolute_scale = scale;
    for load in model.fit.loads.iter_mut().flatten() {
        *load *= scale;
    }
    for simulation in &mut model.postures {
        simulation.force_n *= scale;
        for other in &mut simulation.alternatives {
            other.force_n *= scale;
        }
    }
}
