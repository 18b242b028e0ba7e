//! The loads that fit the measured rotations best, with their uncertainty.
//!
//! # Model
//! The rotation of joint `j` on a film is `(a_j · w) / α e^(δ_j)` and noise: `w` is the planar load, `a_j` its nominal
//! response about the joint's centre and `α` the multiplier of the joint's group. The random effects of a joint are the same on every
//! film: `δ_j` of its stiffness, the sum of an independent part and a random walk along the spine, since stiffness need not step where
//! regions end; and a shift of its centre up the disc, the sum of a part that all joints share and an independent part. A joint in
//! which a region ends has springs of both. A hinge's centre lies where tangents meet; the more evenly joints turn over their length,
//! the nearer it is to the chord. Noise comes from the tilts: neighbouring joints share a vertebra and all films share the erect one,
//! so that the rotations of all films have one covariance.
//!
//! Loads, multipliers, the shared part of the centres and the evenness are fitted by generalised least squares; the standard
//! deviations of the random effects by restricted maximum likelihood (scoring), with priors that exclude zero. So the films show how
//! far joints of one group differ, and the uncertainty of a load follows from it.
//!
//! # Equations
//! With the rotations of all films in one vector `y`, the fitted numbers `b` (loads `w`, multipliers `ln alpha`, shared shift
//! of the centres, evenness), the random effects `u = (delta, centres)` and the noise `e`:
//!
//! ```text
//! y = f(b, u) + e,    u ~ N(0, D),  D = diag(s_1 I + s_3 W, s_2 I),    e ~ N(0, S),  S = S_films (x) S_joints
//! W             = covariance of a random walk over the joints with a mean of zero
//! S_films[a,b]  = delta_ab sd_a^2 + sd_erect^2            tilts of a film, and of the erect film that all share
//! S_joints[i,j] = 2 on the diagonal, -1 beside it         neighbouring joints share a vertebra
//! ```
//!
//! With `X = df/db`, `Z = df/du`, `r = y - f(b, u_0) + Z u_0` and `V = S + Z D Z'`, generalised least squares solve
//! `X' V^-1 X db = X' V^-1 r`, and the covariance of `b` is `(X' V^-1 X)^-1`; `V^-1` is applied by Woodbury's identity. All are
//! linearised about the predicted `u`, `u_0` [lindstrom-bates-1990]: the rotations are not linear in `b` and `u` together, and about
//! zero, a film that moves little would get its load from responses that other films contradict. The variances `s_1` (of `ln`
//! stiffness), `s_2` (of centres, in discs) and `s_3` (of `ln` stiffness along the spine, mean over the joints) maximise the
//! restricted likelihood
//!
//! ```text
//! l_R(s) = -1/2 (ln|V| + ln|X' V^-1 X| + r' V^-1 r) + p sum_i ln s_i
//! ```
//!
//! where the last term is the prior. Fisher scoring on `ln s_i` uses its slope and expected curvature, in which `delta` is written in
//! a cosine basis along the spine that makes `D` diagonal (`RandomEffects::scoring`).
//!
//! One scoring step of the variances, one Gauss-Newton step of `b` and one of `u_0` alternate to convergence. Evenness and the
//! shared shift of the centres have normal priors.
//!
//! # References
//! [harville-1977] for the restricted likelihood, [chung-2013] for the priors, [lindstrom-bates-1990] for the linearisation.

use nalgebra::Vector3;

use super::acceleration::{CONVERGED_STEP, IterationStep, anderson_step};
use super::evidence::FilmEvidence;
use super::mixed_equations::{Fit, Linearized, MAX_VARIANCES};
use super::nearby_loads::NearbyLoads;
use super::preferred_loads::PreferredLoads;
use super::random_effects::Waves;
use crate::clinical::JointShares;

const ROUNDS: usize = 150;
/// From this round on steps are shortened and not extrapolated: some fits oscillate.
const DAMPED_FROM: usize = 30;
const DAMPING: f64 = 0.35;
/// No random effect moves by more than this at convergence, which the equations include to first order anyway.
const CONVERGED_OWN_STEP: f64 = 1e-3;

impl PreferredLoads {
    /// Fits them; `None` without films, where the films' joints do not determine the loads, or where the fit does not converge.
    ///
    /// `depth_mm` is the sagittal place of the forces. `near` is a warm start from other readings of the same films.
    #[must_use]
    pub(crate) fn estimate(
        films: &[&FilmEvidence],
        depth_mm: f64,
        shares: &JointShares,
        near: Option<&NearbyLoads>,
    ) -> Option<Self> {
        let waves = Waves::new(shares.0.nrows());
        let begin = || Fit::new(films, depth_mm, shares, &waves);
        let mut fit = begin()?;
        let near = near.filter(|near| near.has_groups(shares.0.ncols()));
        let (variances, at) = match near.and_then(|near| near.settle(&mut fit)) {
            Some(found) => found,
            None => {
                fit = begin()?;
                settle(&mut fit, MAX_VARIANCES * 1e-2)?
            }
        };
        Some(fit.finish(films, variances, &at))
    }
}

/// Iterates from some variances to convergence; the variances there, and the equations at them.
fn settle<'a>(
    fit: &mut Fit<'a>,
    mut variances: Vector3<f64>,
) -> Option<(Vector3<f64>, Linearized<'a>)> {
    fit.solve_loads(None)?;
    let mut state = fit.linearize(variances)?;
    let mut steps: Vec<IterationStep> = Vec::new();
    for round in 0..ROUNDS {
        let mut step = fit.iterate(&state, variances);
        let damping = if round < DAMPED_FROM { 1.0 } else { DAMPING };
        let own_step = fit.take_own(&state.expected, damping);
        let converged = step.step().amax() < CONVERGED_STEP && own_step < CONVERGED_OWN_STEP;
        if !converged {
            step.to = &step.from + step.step() * damping;
        }
        steps.insert(0, step);
        steps.truncate(3);
        // At the end, and where the extrapolation would put a multiplier on its bound, the last step counts alone.
        let extrapolated = anderson_step(&steps);
        let is_alone = converged || round >= DAMPED_FROM || fit.is_bounded(&extrapolated);
        let place = if is_alone { steps[0].to.clone() } else { fit.within(extrapolated) };
        variances = fit.set_unknowns(&place);
        let before = fit.loads.clone();
        fit.solve_loads(Some(&state))?;
        if !converged {
            fit.loads = &before + (&fit.loads - &before) * damping;
        }
        state = fit.linearize(variances)?;
        if converged {
            return Some((variances, state));
        }
    }
    None
}
