//! Other loads and bases than the lines, where requested.

use super::endings::human_range_words;
use super::models::settings_of;
use super::{Analysis, AnalysisOptions, FilmMovement, Movement};
use crate::clinical::RegionBounds;
use crate::evaluate::RotationPrior;
use crate::hypothesis::{Hypothesis, HypothesisFilm, HypothesisFit, Role, Spine, fit_hypothesis};
use crate::multibody::PathEnding;
use crate::personalize::{FitSettings, FitStatus, FitTarget, Gauge};
use crate::warning::{WarningCode, Warnings};

/// Fits every hypothesis of the options.
pub(super) fn fit_hypotheses(
    movement: &Movement,
    options: &AnalysisOptions,
    warnings: &mut Warnings,
) -> Vec<HypothesisFit> {
    // The lines have warned of both.
    if movement.film_without_scale().is_some() || movement.bends().next().is_none() {
        return Vec::new();
    }
    let groups = movement.joint_groups(options.grouping);
    let erect = &movement.erect().outline;
    let given = options.rotation_prior.as_ref();
    let rotations = given
        .and_then(|prior| prior.of(erect.levels()))
        .unwrap_or_else(|| RotationPrior::published(erect.levels()));
    let springs = movement.springs(&groups);
    let settings = settings_of(movement, options, &[]);
    let spine = Spine {
        springs,
        settings: FitSettings { target: FitTarget::Shape, gauge: Gauge::GeometricMean, ..settings },
        rotations: &rotations,
        depth_mm: movement.depth_mm(),
        apex: largest_apex(movement),
    };
    let moved = movement.films.iter().filter_map(|film| Some((film, film.evidence.clone()?)));
    let films: Vec<HypothesisFilm<'_>> = moved
        .map(|(FilmMovement { outline, inflection_points, .. }, evidence)| HypothesisFilm {
            outline,
            evidence,
            inflections: *inflection_points,
        })
        .collect();
    let mut fits: Vec<HypothesisFit> = Vec::new();
    for &hypothesis in &options.hypotheses {
        match fit_hypothesis(hypothesis, &spine, &films) {
            Some(fit) => {
                warn_of_endings(&fit, warnings);
                fits.push(fit);
            }
            None => warn_of_no_line(hypothesis, warnings),
        }
    }
    fits
}

impl Analysis {
    /// The same analysis with these loads and bases, as [`analyze`](super::analyze) gives it where its options ask for them: for fits
    /// that were made one by one, or read from a file. Their warnings follow its own.
    ///
    /// The fits have to be those to the same films and options; an analysis without bends or without a scale has none.
    #[must_use]
    pub fn with_hypotheses(&self, asked: Vec<Hypothesis>, fits: Vec<HypothesisFit>) -> Self {
        let mut warnings = Warnings::default();
        for &hypothesis in &asked {
            match fits.iter().find(|fit| fit.hypothesis == hypothesis) {
                Some(fit) => warn_of_endings(fit, &mut warnings),
                None => warn_of_no_line(hypothesis, &mut warnings),
            }
        }
        let mut all = self.clone();
        all.options.hypotheses = asked;
        all.hypotheses = fits;
        all.warnings.merge(&warnings);
        all
    }
}

/// The apex of the erect curve with the largest Ferguson angle.
fn largest_apex(movement: &Movement) -> usize {
    let erect = &movement.erect().outline.vertebrae;
    let size = |bounds: &&RegionBounds| bounds.ferguson_angle(|i| erect[i].location).abs();
    let bounds = movement.regions.bounds.iter();
    let largest = bounds.max_by(|a, b| size(a).rad().total_cmp(&size(b).rad()));
    largest.expect("there are three regions").apex
}

fn warn_of_no_line(hypothesis: Hypothesis, warnings: &mut Warnings) {
    let text = format!("{hypothesis}: no bending film has this line");
    warnings.push(WarningCode::NoLine, text);
}

fn warn_of_endings(fit: &HypothesisFit, warnings: &mut Warnings) {
    let name = fit.hypothesis;
    if fit.status != FitStatus::Converged {
        let text = format!("{name}: the fit did not converge (`{}`)", fit.status.key());
        warnings.push(WarningCode::FitNotConverged, text);
    }
    for lost in &fit.lost {
        let role = lost.role.key().replace('_', " ");
        let (code, text) = match lost.reason {
            PathEnding::BeyondHumanRange => (
                WarningCode::BeyondHumanRange,
                format!(
                    "{name}: the shape found for this film ({role}) {}: check the landmarks of this film, and do not trust this load",
                    human_range_words()
                ),
            ),
            // The fit to all bends has its warning.
            PathEnding::FitNotConverged if matches!(lost.role, Role::Fitted | Role::HeldOut) => {
                continue;
            }
            PathEnding::FitNotConverged => (
                WarningCode::FitNotConverged,
                format!(
                    "{name}: a fit that predicts this bend, left out, did not converge, so it is not predicted"
                ),
            ),
            _ => (
                WarningCode::ForceNotFound,
                format!(
                    "{name}: no equilibrium was found for this film ({role}), so it is not predicted"
                ),
            ),
        };
        warnings.film(code, lost.posture, text);
    }
}
