//! A bend that was left out, predicted from T2 on its film and the prior of joint rotations.
//!
//! # Definition
//! The components of the load, the angle of the base and the film's scale are the most probable ones: the minimum of the squared
//! distances, each over its variance, of T2 from where it was marked, of the scale from one, of the model's joint rotations from the
//! mean of their distribution ([`RotationPrior`](crate::evaluate::RotationPrior)), of a noisy base from zero and, where it is known,
//! of T2's tilt. The input is the same as of [`predict_from_prior`](crate::evaluate::predict_from_prior), whose rotations follow no
//! load; here they follow from a load on the springs of the other bend.

use nalgebra::{DMatrix, DVector};

use super::near_t2::{largest, size_factor};
use super::prediction::{FoundLoad, Predicted, Predictor, Role, ShapePrediction};
use super::{Base, HypothesisFilm};
use crate::evaluate::{TurnOfTop, joint_angles};
use crate::least_squares::{FitStatus, System, minimize};
use crate::measure::FilmScale;
use crate::multibody::{
    FilmUnderLoad, GeneralStatics, LoadedFilm, PathEnding, Wanted, starts_of_sizes,
};
use crate::personalize::ShapeWeights;
use crate::spatial::{Angle, Frontal};

/// Lines that a film shows move with its scale, so that the scale is found in rounds.
const MAX_SCALE_ROUNDS: u32 = 20;
/// Change of the logarithm of the scale at which the rounds end: less than a micrometre of a spine.
const SCALE_CONVERGED: f64 = 1e-6;
/// Rows of T2's location and of the scale.
const ROWS_OF_PLACE: usize = 3;

impl Predictor<'_, '_> {
    /// The film under the most probable load; T2's tilt is known in [`Role::LeftOutWithTilt`].
    pub(super) fn by_prior(self, film: &HypothesisFilm<'_>) -> Predicted {
        let mut scale = film.outline.length.scale;
        for _ in 0..MAX_SCALE_ROUNDS {
            let outline = film.outline.at_scale(scale);
            let (found, next) = self.at_scale(&film.at_scale_of(&outline, self.spine))?;
            let change = (next.factor / scale.factor).ln().abs();
            scale = next;
            if change <= SCALE_CONVERGED {
                return Ok(found.in_lengths_of(film, scale));
            }
        }
        Err(PathEnding::NotConverged)
    }

    /// The prediction with lines at the present scale of the film, and the scale found with it.
    fn at_scale(
        self,
        film: &HypothesisFilm<'_>,
    ) -> Result<(ShapePrediction, FilmScale), PathEnding> {
        let mut fit = PriorFit::new(self, film).ok_or(PathEnding::NotConverged)?;
        let x = fit.minimum().ok_or(PathEnding::NotConverged)?;
        let (components, base) = fit.split(&x);
        let found = FoundLoad { components: components.to_vec(), base };
        Ok((found.shape(&fit.loaded, film, self.role, self.spine)?, fit.scale(&x)))
    }
}

/// The fit of a load, the base and the scale to T2 on a film and to the distribution of joint rotations.
struct PriorFit<'s, 'a> {
    by: Predictor<'s, 'a>,
    film: &'s HypothesisFilm<'s>,
    loaded: LoadedFilm,
    statics: GeneralStatics<'a>,
    /// T2 as it was marked.
    top: Frontal,
    top_sd_mm: f64,
    /// Standard deviation of T2's turn from the erect film, where its tilt is known.
    turn_sd: Option<Angle>,
    /// Joint angles of the erect film plus the mean rotations of a bend, in rad.
    mean: DVector<f64>,
    /// Lower triangle of the rotations' covariance.
    root: DMatrix<f64>,
    base_sd_rad: f64,
    /// The limit of a load of one component, as where T2's place alone is known.
    largest: Option<f64>,
    /// The size of a load, in rad, is the norm of this times its components.
    size: DMatrix<f64>,
}

impl<'s, 'a> PriorFit<'s, 'a> {
    /// `None` if the film lacks the line, or if its posture or vertebrae lack a distribution of rotations.
    fn new(by: Predictor<'s, 'a>, film: &'s HypothesisFilm<'s>) -> Option<Self> {
        let Predictor { hypothesis, spine, log_multipliers, role } = by;
        let mut loaded = film.under(hypothesis.load, spine)?;
        let statics = spine.with_multipliers(log_multipliers);
        let components = hypothesis.load.components();
        if !loaded.solve(&statics, &vec![0.0; components], Angle::ZERO, Wanted::AllRates) {
            return None;
        }
        let joints = spine.springs.model.joints.len();
        let size = size_factor(&loaded, joints, components, hypothesis.base.angles())?;
        let angles = joint_angles(spine.springs.erect);
        let rotations = spine.rotations.mean_of(film.outline.posture, &angles);
        let mean = rotations
            .into_iter()
            .zip(&angles)
            .map(|(rotation, angle)| angle.rad() + rotation.rad());
        let factor = film.outline.length.scale.factor;
        let weights = ShapeWeights::of_difference(&film.outline.noise, &spine.springs.erect.noise);
        Some(Self {
            by,
            film,
            statics,
            top: film.outline.vertebrae.last()?.location * factor,
            top_sd_mm: film.outline.top_sd_mm(),
            turn_sd: (role == Role::LeftOutWithTilt)
                .then(|| TurnOfTop::of(spine.springs.erect, film.outline).sd),
            mean: DVector::from_iterator(joints, mean),
            root: spine.rotations.root().clone(),
            base_sd_rad: weights.tilt_sd_rad,
            largest: (components == 1).then(|| largest(&loaded, log_multipliers, spine)),
            loaded,
            size,
        })
    }

    /// Components of the load, and the angle of the base.
    fn free(&self) -> usize {
        self.size.ncols()
    }

    /// Groups of joints: the load's rates follow their rates.
    fn groups(&self) -> usize {
        self.by.log_multipliers.len()
    }

    fn is_scaled(&self) -> bool {
        self.film.outline.length.is_free()
    }

    fn rows(&self) -> usize {
        let base = usize::from(self.by.hypothesis.base == Base::Noisy);
        ROWS_OF_PLACE + self.mean.len() + usize::from(self.turn_sd.is_some()) + base
    }

    fn split<'x>(&self, x: &'x DVector<f64>) -> (&'x [f64], Angle) {
        self.loaded.split(&x.as_slice()[..self.free()])
    }

    /// The most probable unknowns; the shape stays at them. `None` without an equilibrium, or if a single component exceeds
    /// its limit.
    fn minimum(&mut self) -> Option<DVector<f64>> {
        let free = self.free();
        let unknowns = free + usize::from(self.is_scaled());
        let wide = DVector::from_element(unknowns, f64::INFINITY);
        let rows = self.rows();
        let mut best: Option<(f64, DVector<f64>)> = None;
        for start in starts_of_sizes(&self.size, self.loaded.components()) {
            self.loaded.reset();
            let start = start.resize_vertically(unknowns, 0.0);
            let end = minimize(start, &-&wide, &wide, rows, |x, system| self.evaluate(x, system));
            let cost = end.system.cost();
            let is_better = best.as_ref().is_none_or(|(least, _)| cost < *least);
            if end.status == FitStatus::Converged && is_better {
                best = Some((cost, end.x));
            }
        }
        let (_, found) = best?;
        if self.largest.is_some_and(|largest| found[0].abs() > largest) {
            return None;
        }
        self.loaded.reset();
        let (components, base) = self.split(&found);
        self.loaded.solve(&self.statics, components, base, Wanted::AllRates).then_some(found)
    }

    /// Residuals and derivatives; whether an equilibrium exists.
    fn evaluate(&mut self, x: &DVector<f64>, system: &mut System) -> bool {
        let (components, base) = self.split(x);
        if !self.loaded.solve(&self.statics, components, base, Wanted::AllRates) {
            return false;
        }
        system.jacobian.fill(0.0);
        self.place_rows(x, system);
        self.rotation_rows(system);
        let mut row = ROWS_OF_PLACE + self.mean.len();
        let free = self.free();
        if let Some(sd) = self.turn_sd {
            let top = self.mean.len();
            let off = self.loaded.tilt(top) - self.film.outline.vertebrae[top].tilt;
            system.residuals[row] = off.wrapped().rad() / sd.rad();
            for i in 0..free {
                system.jacobian[(row, i)] =
                    self.loaded.tilt_rate(self.groups() + i, top) / sd.rad();
            }
            row += 1;
        }
        if self.by.hypothesis.base == Base::Noisy {
            system.residuals[row] = base.rad() / self.base_sd_rad;
            system.jacobian[(row, free - 1)] = 1.0 / self.base_sd_rad;
        }
        system.residuals.iter().all(|residual| residual.is_finite())
    }

    /// T2's location at the scale of the film, and the scale.
    fn place_rows(&self, x: &DVector<f64>, system: &mut System) {
        let (free, top) = (self.free(), self.mean.len());
        let factor = if self.is_scaled() { x[free].exp() } else { 1.0 };
        let weight = 1.0 / self.top_sd_mm;
        let simulated = self.loaded.location(top) * factor;
        let off = (simulated - self.top) * weight;
        system.residuals[0] = off.y_mm;
        system.residuals[1] = off.z_mm;
        for i in 0..free {
            let rate = self.loaded.location_rate(self.groups() + i, top) * (factor * weight);
            system.jacobian[(0, i)] = rate.y_mm;
            system.jacobian[(1, i)] = rate.z_mm;
        }
        system.residuals[2] = 0.0;
        if self.is_scaled() {
            let prior = 1.0 / self.film.outline.length.prior_log_sd;
            system.jacobian[(0, free)] = simulated.y_mm * weight;
            system.jacobian[(1, free)] = simulated.z_mm * weight;
            system.residuals[2] = prior * x[free];
            system.jacobian[(2, free)] = prior;
        }
    }

    /// Deviations of the joint rotations from their mean, in independent standard deviations.
    fn rotation_rows(&self, system: &mut System) {
        let (joints, free) = (self.mean.len(), self.free());
        let angle = |j: usize| (self.loaded.tilt(j + 1) - self.loaded.tilt(j)).wrapped().rad();
        let mut deviations = DMatrix::zeros(joints, 1 + free);
        for joint in 0..joints {
            deviations[(joint, 0)] = angle(joint) - self.mean[joint];
            for i in 0..free {
                let rate = |vertebra| self.loaded.tilt_rate(self.groups() + i, vertebra);
                deviations[(joint, 1 + i)] = rate(joint + 1) - rate(joint);
            }
        }
        self.root.solve_lower_triangular_unchecked_mut(&mut deviations);
        system.residuals.rows_mut(ROWS_OF_PLACE, joints).copy_from(&deviations.column(0));
        let rates = deviations.columns(1, free);
        system.jacobian.view_mut((ROWS_OF_PLACE, 0), (joints, free)).copy_from(&rates);
    }

    /// The film's scale with its interval, for the shape as it was found.
    fn scale(&self, x: &DVector<f64>) -> FilmScale {
        let length = &self.film.outline.length;
        if !self.is_scaled() {
            return length.scale;
        }
        let simulated = self.loaded.location(self.mean.len());
        let factor = x[self.free()].exp();
        FilmScale { factor, ..length.from_top(simulated, self.top, self.top_sd_mm) }
    }
}
