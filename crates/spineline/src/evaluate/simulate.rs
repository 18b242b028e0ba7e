//! A fitted film under a force along a line.

use super::FilmShape;
use crate::action::LineOfAction;
use crate::anatomy::named;
use crate::clinical::Regions;
use crate::measure::Outline;
use crate::multibody::{
    ForceMatch, ForceSign, Load, PathEnding, Residual, Statics, amplitude_matches, match_t2,
    match_t2_near,
};
use crate::personalize::evidence::ContradictedJoint;
use crate::spatial::{Angle, Frontal};

/// A film and a line of action on it.
#[derive(Debug, Clone, Copy)]
pub struct FilmUnderLine<'a> {
    /// The measured film.
    pub outline: &'a Outline,
    /// Line of action, in `G`.
    pub line: LineOfAction,
    /// Sagittal place of the line.
    pub depth_mm: f64,
}

/// What determines the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// The force was fitted together with the stiffness, in N.
    Fitted(f64),
    /// The measured amplitude of a bend.
    Amplitude,
    /// The measured location of T2, as near as it gets.
    NearestT2 {
        /// The sign of the force, where it is known.
        sign: Option<ForceSign>,
        /// Where the force is sought first.
        start: Option<NearbyMatch>,
    },
}

/// The force that brings T2 nearest for other readings of the same film, where no other force comes near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearbyMatch {
    force_n: f64,
    residual_mm: f64,
}

impl NearbyMatch {
    /// Every other minimum of T2's distance is larger by at least this: far more than readings differ.
    const CLEAR_MM: f64 = 20.0;

    /// From a simulation with forces that were multiplied by a scale; `None` where another force might be the result for other readings.
    pub(crate) fn of(found: &Simulation, absolute_scale: f64) -> Option<Self> {
        let residual_mm = found.residual.distance_mm()?;
        let is_clear = found.is_usable()
            && found.choice == ForceChoice::SmallestNearT2
            && found.other_mm > residual_mm + Self::CLEAR_MM;
        is_clear.then(|| Self { force_n: found.force_n / absolute_scale, residual_mm })
    }

    /// The same minimum for these readings; `None` where it is not clearly the same.
    fn follow(
        &self,
        statics: &Statics<'_>,
        load: &Load,
        sign: Option<ForceSign>,
        place: Frontal,
    ) -> Option<ForceMatch> {
        let found = match_t2_near(statics, load, self.force_n, place)?;
        let is_same = found.residual.distance_mm()? < self.residual_mm + 0.5 * Self::CLEAR_MM
            && sign.is_none_or(|sign| sign == ForceSign::of(found.force_n));
        is_same.then_some(found)
    }
}

named! {
    /// Why a force is the one that is shown.
    pub enum ForceChoice {
        /// It was fitted together with the stiffness.
        Fitted = "fitted",
        /// No other force of either sign, up to the cap, was found to meet the amplitude.
        OnlyOne = "only_one",
        /// Of all that meet the amplitude, its shape has the lowest sum of squared Ferguson errors.
        LeastFergusonError = "least_ferguson_error",
        /// The smallest that brings T2 within a millimetre of the nearest that it gets.
        SmallestNearT2 = "smallest_near_t2",
        /// The shape misses the target and does not count as a result; it is the nearest one.
        NearestMiss = "nearest_miss",
    }
}

impl ForceChoice {
    const fn of(target: Target, usable: bool, others: usize) -> Self {
        match target {
            Target::Fitted(_) => Self::Fitted,
            _ if !usable => Self::NearestMiss,
            Target::NearestT2 { .. } => Self::SmallestNearT2,
            Target::Amplitude if others == 0 => Self::OnlyOne,
            Target::Amplitude => Self::LeastFergusonError,
        }
    }
}

/// Another force that meets the same target, and was not chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alternative {
    /// Signed force.
    pub force_n: f64,
    /// Root mean square of its Ferguson errors.
    pub ferguson_rms: Angle,
}

/// One posture as the model predicts it, beside what was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// The shape, beside the film.
    pub shape: FilmShape,
    /// Whether it was simulated as a fitted film ([`simulate`]), or predicted ([`super::predict`]).
    pub fitted: bool,
    /// Line of action, on the outline that was simulated.
    pub line: LineOfAction,
    /// Sagittal place of the line.
    pub depth_mm: f64,
    /// How the search for the force ended.
    pub status: PathEnding,
    /// Signed force along the line.
    pub force_n: f64,
    /// Residual of the target.
    pub residual: Residual,
    /// Why this force and no other.
    pub choice: ForceChoice,
    /// How often the search for forces did not converge: a better force may not have been found.
    pub lost_forces: usize,
    /// Every other force up to the limit that reaches the amplitude, with the reasons against it.
    pub alternatives: Vec<Alternative>,
    /// Simulated tilts, L4 first.
    pub tilts: Vec<Angle>,
    /// Simulated minus measured Ferguson angle per region.
    pub ferguson_difference: [Angle; 3],
    /// Joints that turn against the moment of this force.
    pub contradicted: Vec<ContradictedJoint>,
    /// At every other minimum along the path of forces, T2 is at least this far from its place.
    pub(crate) other_mm: f64,
}

impl Simulation {
    /// Number of joints that can turn.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.shape.locations.len() - 1
    }

    /// Whether the shape may be shown as a result.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        self.status.is_usable()
    }

    /// Whether a force was found, also by a fit that did not converge. Its sign is known then; the shape may not be a result.
    #[must_use]
    pub fn has_force(&self) -> bool {
        self.is_usable() || self.status == PathEnding::FitNotConverged
    }

    /// Part of the joints' work that no positive stiffness explains.
    #[must_use]
    pub fn contradicted_weight(&self) -> f64 {
        self.contradicted.iter().map(|joint| joint.weight).sum()
    }
}

/// Simulates a fitted film: the shape of a personalised spine under a force along a line, against the film.
///
/// [`super::predict`] simulates films that were not fitted, because their scale is not known. A fitted force is kept, and its residual
/// amplitude is reported. Several forces, of either sign, may meet a bend's amplitude; the one whose shape has the lowest sum of squared
/// Ferguson errors is chosen, and the others are reported. For [`Target::NearestT2`] the smallest force counts that brings T2 to within
/// 1 mm of the nearest it gets (decision 0008). A search without result is a [`PathEnding`], not an error; a shape beyond the human range
/// of motion is not a result either, and comes last in the choice.
///
/// ```
/// use spineline::action::LineOfAction;
/// use spineline::analysis::{AnalysisOptions, analyze_movement};
/// use spineline::anatomy::Posture;
/// use spineline::evaluate::{FilmUnderLine, Target, simulate};
/// use spineline::multibody::{JointGroups, Statics, StiffnessLibrary, Support};
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
/// let movement = analyze_movement(&case, &AnalysisOptions::default())?.movement;
/// let bend = movement.film(Posture::LeftBending).ok_or("no left bend")?;
/// let [caudal, cranial] = bend.inflection_points.ok_or("no two inflections")?;
/// let line = LineOfAction::through(caudal, cranial)?;
/// let (library, groups) = (StiffnessLibrary::default(), JointGroups::per_joint(movement.levels()));
/// let statics = Statics::new(&movement.spine, &library, &groups, &[0.0; 14], Support::Free);
/// let film = FilmUnderLine { outline: &bend.outline, line, depth_mm: 0.0 };
/// let found = simulate(&statics, film, &movement.regions, Target::Amplitude);
/// // L3 to T2; L4 is fixed.
/// assert_eq!(found.shape.location_errors_mm.len(), 14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn simulate(
    statics: &Statics<'_>,
    film: FilmUnderLine<'_>,
    regions: &Regions,
    target: Target,
) -> Simulation {
    let FilmUnderLine { outline, line, depth_mm } = film;
    let load = Load::along(line, depth_mm);
    let measured: Vec<Frontal> = outline.locations().collect();
    let top = measured[measured.len() - 1];
    let tries = ranked(matches(statics, &load, target, top), &measured, regions);
    let lost = |other: &(ForceMatch, _)| other.0.status == PathEnding::NotConverged;
    let lost_forces = tries.iter().skip(1).filter(|other| lost(other)).count();
    let mut tries = tries.into_iter();
    let (found, ferguson_difference) = tries.next().expect("a search never comes back empty");
    let alternatives: Vec<Alternative> = tries
        .filter(|(other, _)| other.is_usable())
        .map(|(other, difference)| Alternative {
            force_n: other.force_n,
            ferguson_rms: rms(&difference),
        })
        .collect();
    let deformed = &found.solution.deformed;
    let locations = (0..measured.len()).map(|i| deformed.location(i)).collect();
    Simulation {
        shape: FilmShape::new(locations, outline),
        fitted: true,
        line,
        depth_mm,
        status: found.status,
        force_n: found.force_n,
        residual: found.residual,
        choice: ForceChoice::of(target, found.is_usable(), alternatives.len()),
        lost_forces,
        alternatives,
        tilts: (0..measured.len()).map(|i| deformed.tilt(i)).collect(),
        ferguson_difference,
        contradicted: Vec::new(),
        other_mm: found.other_mm,
    }
}

/// Every force that meets the target at the place of the top, with shapes beyond the human range marked.
fn matches(statics: &Statics<'_>, load: &Load, target: Target, top: Frontal) -> Vec<ForceMatch> {
    let mut found = match target {
        Target::Fitted(force_n) => {
            vec![ForceMatch::at(statics, load, force_n, top.lateral_tilt())]
        }
        Target::Amplitude => amplitude_matches(statics, load, top.lateral_tilt()),
        Target::NearestT2 { sign, start } => {
            let followed = start.and_then(|start| start.follow(statics, load, sign, top));
            let signs = sign.as_ref().map_or(&ForceSign::ALL[..], std::slice::from_ref);
            vec![followed.unwrap_or_else(|| match_t2(statics, load, signs, top))]
        }
    };
    for found in &mut found {
        let shape = &found.solution.deformed;
        if found.is_usable() && shape.beyond_human_range(statics.model()).is_some() {
            found.status = PathEnding::BeyondHumanRange;
        }
    }
    found
}

/// Forces that were found with the errors of their Ferguson angles, the best first: a shape that met its target always comes
/// before one that did not.
fn ranked(
    found: Vec<ForceMatch>,
    measured: &[Frontal],
    regions: &Regions,
) -> Vec<(ForceMatch, [Angle; 3])> {
    let mut tries: Vec<(ForceMatch, [Angle; 3])> = found
        .into_iter()
        .map(|found| {
            let difference = regions.bounds.each_ref().map(|bounds| {
                let simulated = bounds.ferguson_angle(|i| found.solution.deformed.location(i));
                (simulated - bounds.ferguson_angle(|i| measured[i])).wrapped()
            });
            (found, difference)
        })
        .collect();
    tries.sort_by(|(a, da), (b, db)| {
        b.is_usable().cmp(&a.is_usable()).then(rms(da).rad().total_cmp(&rms(db).rad()))
    });
    tries
}

fn rms(angles: &[Angle; 3]) -> Angle {
    let squares: f64 = angles.iter().map(|angle| angle.rad().powi(2)).sum();
    Angle::from_rad((squares / angles.len() as f64).sqrt())
}
