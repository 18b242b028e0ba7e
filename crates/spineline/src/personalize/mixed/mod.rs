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
//! All unknowns take their steps together, extrapolated [anderson-1965]; later steps are damped.

mod equations;
mod line_test;

use std::fmt;

use nalgebra::{DMatrix, DVector};

use super::evidence::FilmEvidence;
use crate::clinical::JointShares;
use equations::Model;
use line_test::TiltErrors;
pub use line_test::{Crossing, LineTest, ProposedLine, SIGNIFICANCE};

/// Loads of several films that share springs.
#[derive(Debug, Clone, PartialEq)]
pub struct PreferredLoads {
    /// `(fy, fz, mx)` about the origin of `G` per film, in N and N·mm, up to the level of stiffness.
    pub components: Vec<[f64; 3]>,
    /// Standard deviation of `ln` stiffness among the joints of a group, without the random walk along the spine.
    pub joint_log_sd: f64,
    /// All unknowns, where a fit to other readings starts.
    unknowns: DVector<f64>,
    /// Covariance of all components, film by film, with the other unknowns free.
    covariance: DMatrix<f64>,
    /// Its part from tilts whose variance is estimated.
    from_tilts: TiltErrors,
}

/// Why films give no loads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoLoads {
    /// No film has joint rotations in millimetres.
    NoFilms,
    /// The rotations do not determine the loads.
    Undetermined,
    /// The iteration reached its limit with a step of this size, in `ln` of stiffness, discs or parts of a load.
    NotConverged {
        /// Largest change of an unknown.
        last_step: f64,
    },
}

impl fmt::Display for NoLoads {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFilms => f.write_str("no film has joint rotations in millimetres"),
            Self::Undetermined => f.write_str("the joint rotations do not determine the loads"),
            Self::NotConverged { last_step } => {
                write!(
                    f,
                    "the fit of loads to the joint rotations did not converge (last step {last_step:.1e})"
                )
            }
        }
    }
}

impl PreferredLoads {
    /// Fits the loads of all films to their joint rotations. `depth_mm` is the sagittal place of the forces; the fit starts from
    /// the one to other readings of the same films, if that is given.
    ///
    /// # Errors
    /// [`NoLoads`].
    pub(crate) fn estimate(
        films: &[&FilmEvidence],
        depth_mm: f64,
        shares: &JointShares,
        start: Option<&Self>,
    ) -> Result<Self, NoLoads> {
        let model = Model::new(films, depth_mm, shares)?;
        let start = start.filter(|start| start.unknowns.len() == model.unknowns());
        let warm = start.map(|start| model.converge(start.unknowns.clone()));
        let (unknowns, at) = match warm {
            Some(Ok(found)) => found,
            _ => model.converge(model.start())?,
        };
        let loads = 3 * films.len();
        let components = unknowns.as_slice()[..loads].chunks_exact(3);
        Ok(Self {
            components: components.map(|load| [load[0], load[1], load[2]]).collect(),
            joint_log_sd: (0.5 * unknowns[unknowns.len() - 3]).exp(),
            covariance: at.inverse.view((0, 0), (loads, loads)).into_owned(),
            from_tilts: TiltErrors::of_films(films, &at.loads_by_errors(loads)),
            unknowns,
        })
    }
}
