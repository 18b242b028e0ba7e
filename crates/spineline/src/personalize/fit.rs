use super::problem::Problem;
use super::search::{Best, FitProblem};
use super::start::Start;
use super::{FitFilm, FitSettings, FitTarget, FittedSprings, MULTIPLIER_BOUNDS};
use crate::least_squares::FitStatus;
use crate::multibody::JointGroups;

/// Where a multiplier ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StiffnessBound {
    /// Between its bounds.
    Inside,
    /// At the lower bound: the data favour a softer value.
    Lower,
    /// At the upper bound: the data favour a stiffer value.
    Upper,
}

/// The fitted stiffness of one patient for one choice of line.
#[derive(Debug, Clone, PartialEq)]
pub struct Personalization {
    /// `ln α` of the lateral springs per group.
    pub log_multipliers: Vec<f64>,
    /// Where every multiplier ended.
    pub bounds: Vec<StiffnessBound>,
    /// Factor on the springs of all axes; 1 unless a force is known.
    pub absolute_scale: f64,
    /// Per film, in the order given: the load's components.
    pub loads: Vec<Vec<f64>>,
    /// How the minimisation ended.
    pub status: FitStatus,
    /// Iterations of the winning start.
    pub iterations: u32,
    /// Starts that were refined.
    pub starts: u32,
    /// Root mean square of the data's residuals: degrees for Ferguson angles, standard deviations for a shape.
    pub residual_rms: f64,
    /// Variance of the films about the model without a prior: sum of squares over the degrees of freedom, and at least
    /// 1, which is noise alone.
    pub variance_factor: f64,
    /// Singular values of the derivative of the data by the unknowns `(ln α, ln F)`: small ones are not identified.
    pub singular_values: Vec<f64>,
    /// The minima in which starts ended, the best first, without those far worse: warm starts for other readings of these films. Their
    /// loads are not yet scaled by a known force.
    pub(crate) minima: Vec<Start>,
}

impl Personalization {
    /// Its end as a start.
    pub(super) fn as_start(&self) -> Start {
        let unscaled =
            |load: &Vec<f64>| load.iter().map(|part| part / self.absolute_scale).collect();
        Start {
            log_multipliers: self.log_multipliers.clone(),
            loads: self.loads.iter().map(unscaled).collect(),
        }
    }

    /// Its minima as starts of a fit to other readings of its films, where that has the same unknowns.
    fn starts_for(&self, groups: &JointGroups, films: &[FitFilm<'_>]) -> Option<&[Start]> {
        let fits = |start: &Start| {
            let sizes = start.loads.iter().map(Vec::len);
            start.log_multipliers.len() == groups.len()
                && sizes.eq(films.iter().map(|film| film.load.components()))
        };
        (!self.minima.is_empty() && self.minima.iter().all(fits)).then_some(&self.minima)
    }
}

/// Residuals at which no other start is tried: half a degree is the effect of a careful reading of 0.25 mm on a Ferguson angle, and
/// one is the standard deviation of a location or tilt.
const fn satisfied_rms(target: FitTarget) -> f64 {
    match target {
        FitTarget::Ferguson => 0.5,
        FitTarget::Shape => 1.0,
    }
}

/// Fits multipliers and loads to bending films.
///
/// The returned loads are in N and N·mm in `G`, up to the level that the gauge fixes. `start` is the fit to other readings of these
/// films: its minima are followed first, and where they fit these readings much worse, all starts are tried as without it.
///
/// # Errors
/// None: an ending without result is a status. With no film, the nominal stiffness is returned as not evaluable.
///
/// ```
/// use spineline::action::LineOfAction;
/// use spineline::analysis::{AnalysisOptions, analyze_movement};
/// use spineline::multibody::{JointGroups, Load, StiffnessLibrary, Support};
/// use spineline::personalize::{
///     FitFilm, FitSettings, FitTarget, FittedSprings, Gauge, personalize,
/// };
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Rod, &Readers::exact(), 1)?.case;
/// let movement = analyze_movement(&case, &AnalysisOptions::default())?.movement;
/// let mut films = Vec::new();
/// for posture in movement.films.iter().filter(|p| p.outline.posture.bend().is_some()) {
///     let [caudal, cranial] = posture.inflection_points.ok_or("no two inflections")?;
///     let line = LineOfAction::through(caudal, cranial)?;
///     let evidence = posture.evidence.as_ref().ok_or("no joint rotations")?;
///     films.push(FitFilm { outline: &posture.outline, evidence, load: Load::along(line, 0.0) });
/// }
/// let settings = FitSettings {
///     regions: &movement.regions,
///     target: FitTarget::Shape,
///     gauge: Gauge::GeometricMean,
///     support: Support::Free,
///     prior: None,
///     hints: &[],
/// };
/// let (library, groups) =
///     (StiffnessLibrary::default(), JointGroups::regional(&movement.regions));
/// let springs = FittedSprings { model: &movement.spine, library: &library, groups: &groups };
/// let fit = personalize(springs, &films, &settings, None);
/// // Only ratios are identified: the mean of ln α is held at zero.
/// assert!(fit.log_multipliers.iter().sum::<f64>().abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn personalize(
    springs: FittedSprings<'_>,
    films: &[FitFilm<'_>],
    settings: &FitSettings<'_>,
    start: Option<&Personalization>,
) -> Personalization {
    // The prior becomes stronger with the variance of the films about the model, which a fit without the prior estimates.
    let free = settings
        .prior
        .map(|_| personalize(springs, films, &FitSettings { prior: None, ..*settings }, start));
    let weighed = free.as_ref().map(|free| settings.weighed(free.variance_factor));
    let settings = weighed.as_ref().unwrap_or(settings);
    let mut problem = Problem::new(springs, films, settings);
    let mut best = Best::default();
    if !best.follows(&mut problem, springs.groups, films, start) {
        best.search_all(&mut problem, springs, films, settings, free.as_ref());
    }
    let minima = best.minima(PROMISING);
    let Some((minimum, Start { log_multipliers, loads })) = best.minimum else {
        return nominal(springs.groups, films, best.starts);
    };
    Personalization {
        bounds: log_multipliers.iter().map(|&value| bound_of(value)).collect(),
        log_multipliers,
        absolute_scale: 1.0,
        loads,
        status: minimum.status,
        iterations: minimum.iterations,
        starts: best.starts,
        residual_rms: problem.data_rms(&minimum.system),
        variance_factor: match free {
            Some(free) => free.variance_factor,
            None => problem.variance_factor(&minimum),
        },
        singular_values: problem.singular_values(&minimum),
        minima,
    }
}

fn bound_of(log_multiplier: f64) -> StiffnessBound {
    let near = |bound: f64| (log_multiplier - bound.ln()).abs() < 1e-6;
    match MULTIPLIER_BOUNDS {
        [lower, _] if near(lower) => StiffnessBound::Lower,
        [_, upper] if near(upper) => StiffnessBound::Upper,
        _ => StiffnessBound::Inside,
    }
}

/// The result if no start could be evaluated.
fn nominal(groups: &JointGroups, films: &[FitFilm<'_>], starts: u32) -> Personalization {
    Personalization {
        log_multipliers: vec![0.0; groups.len()],
        bounds: vec![StiffnessBound::Inside; groups.len()],
        absolute_scale: 1.0,
        loads: films.iter().map(|film| vec![0.0; film.load.components()]).collect(),
        status: FitStatus::NotEvaluable,
        iterations: 0,
        starts,
        residual_rms: f64::NAN,
        variance_factor: f64::NAN,
        singular_values: Vec::new(),
        minima: Vec::new(),
    }
}

/// A start is refined when its sum of squares is within this factor of the best start's: a force of the wrong sign bends
/// the spine the wrong way, and is further off by far.
const PROMISING: f64 = 10.0;
/// Residuals larger than these, in millimetres of a shape or degrees of a Ferguson angle, call for more starts: a fit with
/// a wrong line leaves less.
const POOR_MM: f64 = 12.0;
const POOR_DEG: f64 = 12.0;

/// The search of a fit of forces along lines, or of free loads.
impl Best {
    /// Follows the minima of the fit to other readings, the one that fits these readings best first; whether the end fits about as
    /// well as there.
    fn follows(
        &mut self,
        problem: &mut Problem<'_>,
        groups: &JointGroups,
        films: &[FitFilm<'_>],
        start: Option<&Personalization>,
    ) -> bool {
        /// A fit whose error is larger by this factor than for the other readings has ended in another minimum.
        const WORSE: f64 = 1.5;
        let Some(start) = start else { return false };
        let Some(minima) = start.starts_for(groups, films) else { return false };
        let enough = satisfied_rms(problem.target());
        let mut priced = problem.priced(minima);
        priced.sort_by(|a, b| a.1.total_cmp(&b.1));
        self.improve_from(problem, &priced, enough);
        self.satisfies(problem, enough.max(WORSE * start.residual_rms))
    }

    /// Refines starts of all kinds; `free` is the fit without a prior.
    fn search_all(
        &mut self,
        problem: &mut Problem<'_>,
        springs: FittedSprings<'_>,
        films: &[FitFilm<'_>],
        settings: &FitSettings<'_>,
        free: Option<&Personalization>,
    ) {
        let enough = satisfied_rms(problem.target());
        let mut starts = problem.starts(films);
        if let Some(free) = free {
            starts.insert(0, free.as_start());
        }
        self.search(problem, &starts, films, enough);
        // Three angles per bend have more wrong minima than the whole shape: that fit is one more start.
        if problem.target() == FitTarget::Ferguson && !self.satisfies(problem, enough) {
            let settings = FitSettings { target: FitTarget::Shape, ..*settings };
            let shape = personalize(springs, films, &settings, None);
            self.improve(problem, &shape.as_start());
        }
    }

    /// The likeliest start first, which alone satisfies most films, and then the others.
    fn search(
        &mut self,
        problem: &mut Problem<'_>,
        starts: &[Start],
        films: &[FitFilm<'_>],
        enough: f64,
    ) {
        if let Some(first) = starts.first() {
            self.improve(problem, first);
        }
        if !self.satisfies(problem, enough) {
            self.improve_further(problem, starts, films, enough);
        }
    }

    /// Refines the promising ones of the starts beside the first, and every start where the residuals are large.
    fn improve_further(
        &mut self,
        problem: &mut Problem<'_>,
        starts: &[Start],
        films: &[FitFilm<'_>],
        enough: f64,
    ) {
        let mut priced = problem.priced(starts);
        priced.sort_by(|a, b| a.1.total_cmp(&b.1));
        let promising = PROMISING * priced.first().map_or(0.0, |(_, cost)| *cost);
        priced.retain(|(start, _)| starts.first() != Some(start));
        let (likely, rest): (Vec<_>, Vec<_>) =
            priced.into_iter().partition(|(_, cost)| *cost <= promising);
        self.improve_from(problem, &likely, enough);
        // A fit with large residuals may be a local minimum.
        let poor = match problem.target() {
            FitTarget::Ferguson => POOR_DEG,
            FitTarget::Shape => POOR_MM / problem.location_sd_mm(),
        };
        self.improve_from(problem, &rest, poor);
        if !self.satisfies(problem, poor) {
            let others = problem.starts_at_amplitude(films);
            let others = problem.priced(&others);
            self.improve_from(problem, &others, poor);
        }
    }
}
