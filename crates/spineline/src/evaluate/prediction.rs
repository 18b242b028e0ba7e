//! Predictions of films that were not fitted, whose scale is not known either.

use super::{FilmUnderLine, Simulation, Target, simulate};
use crate::clinical::Regions;
use crate::measure::{FilmScale, Outline};
use crate::multibody::{PathEnding, Statics};
use crate::spatial::Frontal;

/// As [`simulate`], for a film that was not fitted: its scale follows from T2 and the prior, never from other vertebrae.
///
/// Force and scale are found together: the force brings T2 nearest on the film at that scale, and the scale is what T2's
/// location gives for that shape ([`crate::measure::FilmLength::from_top`]). The result is in the frame and at the scale of the
/// outline that was given. Where the scale of films is fixed, the shape is the same as by [`simulate`].
#[must_use]
pub fn predict(
    statics: &Statics<'_>,
    film: FilmUnderLine<'_>,
    regions: &Regions,
    target: Target,
) -> Simulation {
    let found = at_scale_of_top(film.outline, |outline| {
        let factor = film.outline.length.scale.factor / outline.length.scale.factor;
        let film = FilmUnderLine { outline, line: film.line.scaled(factor), ..film };
        let found = simulate(statics, film, regions, target);
        Some((found.shape.locations[found.joints()], found))
    });
    let ScaledPrediction { scale, prediction, converged } =
        found.expect("a simulation never comes back empty");
    let factor = scale.factor / film.outline.length.scale.factor;
    Simulation {
        fitted: false,
        status: if converged { prediction.status } else { PathEnding::NotConverged },
        line: prediction.line.scaled(factor),
        shape: prediction.shape.in_lengths_of(&film.outline.length, scale),
        ..prediction
    }
}

/// A prediction with the scale of its film.
pub(crate) struct ScaledPrediction<T> {
    pub scale: FilmScale,
    pub prediction: T,
    /// Whether the scale is the one that T2 gives for this very prediction.
    pub converged: bool,
}

/// Finds the scale of a film that is predicted from T2 alone.
///
/// `predict` gives T2 in the model and its other results, for the film at a scale; `None` without a prediction.
pub(crate) fn at_scale_of_top<T>(
    film: &Outline,
    mut predict: impl FnMut(&Outline) -> Option<(Frontal, T)>,
) -> Option<ScaledPrediction<T>> {
    /// Difference of logarithms at convergence: 4 µm of a spine.
    const ENOUGH: f64 = 1e-5;
    const MAX_ROUNDS: u32 = 25;
    if !film.length.is_free() {
        let (_, prediction) = predict(film)?;
        return Some(ScaledPrediction { scale: film.length.scale, prediction, converged: true });
    }
    let top = film.top() * film.length.scale.factor;
    let sd_mm = film.top_sd_mm();
    let mut log: f64 = 0.0;
    let mut before: Option<[f64; 2]> = None;
    let mut round = 0;
    loop {
        let scale = FilmScale { factor: log.exp(), log_sd: film.length.prior_log_sd };
        let (simulated, prediction) = predict(&film.at_scale(scale))?;
        let found = film.length.from_top(simulated, top, sd_mm);
        let gap = found.factor.ln() - log;
        round += 1;
        let converged = gap.abs() < ENOUGH;
        if converged || round == MAX_ROUNDS || !gap.is_finite() {
            let scale = FilmScale { log_sd: found.log_sd, ..scale };
            return Some(ScaledPrediction { scale, prediction, converged });
        }
        // The secant through the last two rounds, where it is not far away.
        let secant =
            before.map(|[log_before, gap_before]| -gap * (log - log_before) / (gap - gap_before));
        let step = secant.filter(|step| step.abs() <= 3.0 * gap.abs()).unwrap_or(gap);
        before = Some([log, gap]);
        log += step;
    }
}
