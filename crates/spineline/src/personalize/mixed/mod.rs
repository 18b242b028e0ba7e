//! The loads of best fit to the joint rotations of all films, by a mixed model, with their uncertainty.
//!
//! # Model
//! Joint `j` has the springs of the groups `g` in parts `p_jg` of its length, which act in series. With the load `w` of film `f`:
//!
//! ```text
//! y_fj = sum_g p_jg / alpha_g  exp(delta_j)  (a_fj + (c + c_j) h_fj + q m_fj) · w_f + e_fj
//!
//! a, h, m   nominal response to the load; its change for a centre one disc higher; from a hinge to a uniformly bent joint
//! b         fixed effects: loads w, multipliers ln alpha (their mean is zero), shift c of all centres, evenness q of bending
//! u         random effects of the joints, alike on all films: ln compliance delta and shift c_j of the centre
//! u ~ N(0, D),   D = diag(s_1 I + s_3 W, s_2 I),   W = covariance of a random walk over the joints, mean variance 1
//! e ~ N(0, S),   S = B (T_film + T_erect) B'       B: differences of neighbouring tilts; all films share the erect film
//! ```
//!
//! The walk lets stiffness vary where no region ends. A hinge lies where tangents meet; a joint that bends uniformly turns about a
//! place nearer to its chord.
//!
//! # Priors
//! `ln alpha ~ N(0, 1.33²)` has the variance of a uniform distribution over the bounds of multipliers, `c ~ N(0, 1²)` discs,
//! `q ~ N(0.5, 0.289²)` the variance of a uniform one between hinge and rod. Standard deviations `sqrt(s_i)` are uniform below a
//! bound, which excludes zero from the maximum [chung-2013].
//!
//! # Estimation
//! Linearised about `b` and `u` [lindstrom-bates-1990], with `X = dy/db`, `Z = dy/du`, `r = y - f(b, u)`, the prior's precision `L`
//! and mean `b_0`, one step of `b` and `u` solves the mixed model equations [henderson-1975]
//!
//! ```text
//! C (db, du) = (X' S^-1 r - L (b - b_0),  Z' S^-1 r - D^-1 u)      C = ( X' S^-1 X + L    X' S^-1 Z        )
//!                                                                      ( Z' S^-1 X        Z' S^-1 Z + D^-1 )
//! ```
//!
//! `C^-1` is the covariance of `b` and of `u` about its prediction. Variances maximise the restricted likelihood and its prior
//! `1/2 sum_i ln s_i` by Fisher scoring on `ln s_i` [harville-1977]. With `D = sum_i s_i D_i` and the covariance `P` of `u` about its
//! prediction:
//!
//! ```text
//! v = D^-1 u,   M = D^-1 - D^-1 P D^-1,   dl/ds_i = 1/2 (v' D_i v - tr(M D_i)),   I_ij = 1/2 tr(M D_i M D_j)
//! ```
//!
//! All unknowns take their steps together, extrapolated [anderson-1965]. A step that is longer than the one before is shortened, and the
//! extrapolation begins again.

mod bases;
mod covariance;
mod equations;
mod extrapolation;
mod line_test;
mod loads;
mod proposed_line;
mod stiffness;

pub use equations::NoLoads;
pub(crate) use line_test::CHI_SQUARED_95;
pub use line_test::{Crossing, LineTest, SIGNIFICANCE};
pub use loads::BestFitLoads;
pub use proposed_line::ProposedLine;
pub use stiffness::GroupStiffness;
pub(crate) use stiffness::predict_stiffness;
