//! A film that was not fitted, under the most probable load for T2 on it and a distribution of joint rotations.
//!
//! # Definition
//! The components of the load, the angle of the base and the film's scale are the most probable ones: the minimum of the squared
//! distances, each over its variance, of T2 from where it was marked, of the scale from one, of the model's joint rotations from the
//! mean of their distribution ([`RotationPrior`]), of a noisy base from zero and, where it is known, of T2's tilt. The input is the same
//! as of [`predict_from_prior`](super::predict_from_prior), whose rotations follow no load; here they follow from a load on springs.

use nalgebra::{DMatrix, DVector};

use super::baseline::TurnOfTop;
use super::bend_rotations::joint_angles;
use super::film_shape::FilmShape;
use super::rotation_prior::RotationPrior;
use crate::action::LineOfAction;
use crate::least_squares::{FitStatus, System, minimize};
use crate::measure::{FilmScale, Outline};
use crate::multibody::{
    FilmUnderLoad, FittedSprings, Load, MAX_FORCE_PER_STIFFNESS, MarchedFilm, PathEnding, Statics,
    Support, Wanted, size_factor, starts_of_sizes,
};
use crate::personalize::{Base, ShapeWeights};
use crate::spatial::{Angle, Frontal};

/// Lines that a film shows move with its scale, so that the scale is found in rounds.
const MAX_SCALE_ROUNDS: u32 = 20;
/// Change of the logarithm of the scale at which the rounds end: less than a micrometre of a spine.
const SCALE_CONVERGED: f64 = 1e-6;
/// Rows of T2's location and of the scale.
const ROWS_OF_PLACE: usize = 3;

/// What is known before the load on a film is found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BeforeTheFilm<'a> {
    pub springs: FittedSprings<'a>,
    /// Stiffness from other films.
    pub log_multipliers: &'a [f64],
    pub support: Support,
    /// Of the joints, from the erect film.
    pub rotations: &'a RotationPrior,
    pub base: Base,
    /// Whether T2's tilt is taken from the film beside its location.
    pub knows_tilt: bool,
}

/// A film under a load of any amount.
pub(crate) struct UnknownLoad<F> {
    pub film: F,
    /// The largest amount of a load of one component, in its unit.
    pub largest: f64,
}

/// The most probable load on a film.
pub(crate) struct MostProbable<F> {
    /// The film under it.
    pub film: F,
    /// What was measured, at the scale at which the load was found.
    pub outline: Outline,
    pub components: Vec<f64>,
    pub base: Angle,
    pub scale: FilmScale,
}

impl BeforeTheFilm<'_> {
    /// The most probable load on a film; `under` gives the film at a scale. The search starts from these components, or without any from
    /// loads of several sizes.
    pub fn most_probable<F: FilmUnderLoad>(
        &self,
        film: &Outline,
        starts: &[DVector<f64>],
        under: impl Fn(&Outline, &F::Springs<'_>) -> Option<UnknownLoad<F>>,
    ) -> Result<MostProbable<F>, PathEnding> {
        let springs = F::springs(self.springs, self.log_multipliers, self.support);
        let mut scale = film.length.scale;
        let mut starts = starts.to_vec();
        for _ in 0..MAX_SCALE_ROUNDS {
            let outline = film.at_scale(scale);
            let load = under(&outline, &springs).ok_or(PathEnding::NotConverged)?;
            let mut fit =
                Fit::new(self, &springs, &outline, load).ok_or(PathEnding::NotConverged)?;
            let x = fit.minimum(&starts).ok_or(PathEnding::NotConverged)?;
            let next = fit.scale(&x);
            let change = (next.factor / scale.factor).ln().abs();
            scale = next;
            if change <= SCALE_CONVERGED {
                let (components, base) = fit.split(&x);
                let components = components.to_vec();
                let Fit { loaded: film, .. } = fit;
                return Ok(MostProbable { film, outline, components, base, scale });
            }
            starts = vec![x];
        }
        Err(PathEnding::NotConverged)
    }

    /// A film under the most probable force along a line, or under a free load at T2 without one. The search starts without a load and from
    /// these components.
    ///
    /// # Errors
    /// How the search ended without a result: not converged, or a shape beyond the human range of motion.
    pub fn predict(
        &self,
        film: &Outline,
        line: Option<LineOfAction>,
        depth_mm: f64,
        starts: Vec<Vec<f64>>,
    ) -> Result<FilmShape, PathEnding> {
        let under = |outline: &Outline, springs: &Statics<'_>| {
            let factor = film.length.scale.factor / outline.length.scale.factor;
            let load = match line {
                Some(line) => Load::along(line.scaled(factor), depth_mm),
                None => Load::Frontal { depth_mm },
            };
            let largest = MAX_FORCE_PER_STIFFNESS * springs.mean_lateral_nmm_per_rad();
            Some(UnknownLoad { film: MarchedFilm::new(load, 0), largest })
        };
        let none = DVector::zeros(if line.is_some() { 1 } else { 3 });
        let starts: Vec<_> =
            std::iter::once(none).chain(starts.into_iter().map(DVector::from)).collect();
        let found = self.most_probable(film, &starts, under)?;
        let deformed = &found.film.solution().deformed;
        if deformed.beyond_human_range(self.springs.model).is_some() {
            return Err(PathEnding::BeyondHumanRange);
        }
        let locations = (0..film.vertebrae.len()).map(|i| deformed.location(i)).collect();
        Ok(FilmShape::new(locations, &found.outline).in_lengths_of(&film.length, found.scale))
    }
}

/// The fit of a load, the base and the scale to T2 on a film and to the distribution of joint rotations.
struct Fit<'s, 'a, F: FilmUnderLoad> {
    before: &'s BeforeTheFilm<'a>,
    outline: &'s Outline,
    springs: &'s F::Springs<'a>,
    loaded: F,
    /// T2 as it was marked.
    top: Frontal,
    top_sd_mm: f64,
    /// Standard deviation of T2's turn from the erect film, by the noise of base and top; by the noise of the top where the angle of the
    /// base is unknown, which takes up the noise of the base.
    turn_sd_rad: f64,
    /// Joint angles of the erect film plus the mean rotations of a bend, in rad.
    mean: DVector<f64>,
    base_sd_rad: f64,
    /// The limit of a load of one component, as where T2's place alone is known.
    largest: Option<f64>,
    /// The size of a load, in rad, is the norm of this times its components.
    size: DMatrix<f64>,
}

impl<'s, 'a, F: FilmUnderLoad> Fit<'s, 'a, F> {
    /// `None` without an equilibrium of the unloaded spine, or where components of the load do not differ.
    fn new(
        before: &'s BeforeTheFilm<'a>,
        springs: &'s F::Springs<'a>,
        outline: &'s Outline,
        load: UnknownLoad<F>,
    ) -> Option<Self> {
        let BeforeTheFilm { springs: FittedSprings { erect, .. }, rotations, base, .. } = *before;
        let UnknownLoad { film: mut loaded, largest } = load;
        let components = loaded.components();
        if !loaded.solve(springs, &vec![0.0; components], Angle::ZERO, Wanted::AllRates) {
            return None;
        }
        let size = size_factor(&loaded, base.angles())?;
        let angles = joint_angles(erect);
        let turned = rotations.mean_of(outline.posture, &angles);
        let mean = turned.into_iter().zip(&angles).map(|(turn, angle)| angle.rad() + turn.rad());
        let weights = ShapeWeights::of_difference(&outline.noise, &erect.noise);
        let top = outline.vertebrae.last()?;
        let turn_sd_rad = match base {
            Base::Fixed => TurnOfTop::of(erect, outline).sd.rad(),
            Base::Noisy | Base::Free => {
                let of_erect = erect.noise_of(erect.vertebrae.last()?);
                ShapeWeights::of_difference(&outline.noise_of(top), &of_erect).tilt_sd_rad
            }
        };
        Some(Self {
            before,
            outline,
            springs,
            top: top.location * outline.length.scale.factor,
            top_sd_mm: outline.top_sd_mm(),
            turn_sd_rad,
            mean: DVector::from_iterator(angles.len(), mean),
            base_sd_rad: weights.tilt_sd_rad,
            largest: (components == 1).then_some(largest),
            loaded,
            size,
        })
    }

    /// Components of the load, and the angle of the base.
    fn free(&self) -> usize {
        self.size.ncols()
    }

    /// The place of an unknown among the parameters of derivatives.
    fn parameter(&self, unknown: usize) -> usize {
        self.loaded.first_component() + unknown
    }

    fn is_scaled(&self) -> bool {
        self.outline.length.is_free()
    }

    fn has_noisy_base(&self) -> bool {
        self.before.base == Base::Noisy
    }

    fn rows(&self) -> usize {
        let more = usize::from(self.before.knows_tilt) + usize::from(self.has_noisy_base());
        ROWS_OF_PLACE + self.mean.len() + more
    }

    fn split<'x>(&self, x: &'x DVector<f64>) -> (&'x [f64], Angle) {
        self.loaded.split(&x.as_slice()[..self.free()])
    }

    /// The most probable unknowns; the shape stays at them. `None` without an equilibrium, or if a single component exceeds its limit.
    fn minimum(&mut self, starts: &[DVector<f64>]) -> Option<DVector<f64>> {
        let free = self.free();
        let unknowns = free + usize::from(self.is_scaled());
        let wide = DVector::from_element(unknowns, f64::INFINITY);
        let rows = self.rows();
        let starts = if starts.is_empty() {
            starts_of_sizes(&self.size, self.loaded.components())
        } else {
            starts.to_vec()
        };
        let mut best: Option<(f64, DVector<f64>)> = None;
        for start in starts {
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
        self.loaded.solve(self.springs, components, base, Wanted::AllRates).then_some(found)
    }

    /// Residuals and derivatives; whether an equilibrium exists.
    fn evaluate(&mut self, x: &DVector<f64>, system: &mut System) -> bool {
        let (components, base) = self.split(x);
        if !self.loaded.solve(self.springs, components, base, Wanted::AllRates) {
            return false;
        }
        system.jacobian.fill(0.0);
        self.place_rows(x, system);
        self.rotation_rows(system);
        let mut row = ROWS_OF_PLACE + self.mean.len();
        let free = self.free();
        if self.before.knows_tilt {
            let (top, sd) = (self.mean.len(), self.turn_sd_rad);
            let off = self.loaded.tilt(top) - self.outline.vertebrae[top].tilt;
            system.residuals[row] = off.wrapped().rad() / sd;
            for i in 0..free {
                let rate = self.loaded.tilt_rate(self.parameter(i), top);
                system.jacobian[(row, i)] = rate / sd;
            }
            row += 1;
        }
        if self.has_noisy_base() {
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
            let rate = self.loaded.location_rate(self.parameter(i), top) * (factor * weight);
            system.jacobian[(0, i)] = rate.y_mm;
            system.jacobian[(1, i)] = rate.z_mm;
        }
        system.residuals[2] = 0.0;
        if self.is_scaled() {
            let prior = 1.0 / self.outline.length.prior_log_sd;
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
                let rate = |vertebra| self.loaded.tilt_rate(self.parameter(i), vertebra);
                deviations[(joint, 1 + i)] = rate(joint + 1) - rate(joint);
            }
        }
        self.before.rotations.root().solve_lower_triangular_unchecked_mut(&mut deviations);
        system.residuals.rows_mut(ROWS_OF_PLACE, joints).copy_from(&deviations.column(0));
        let rates = deviations.columns(1, free);
        system.jacobian.view_mut((ROWS_OF_PLACE, 0), (joints, free)).copy_from(&rates);
    }

    /// The film's scale with its interval, for the shape as it was found.
    fn scale(&self, x: &DVector<f64>) -> FilmScale {
        let length = &self.outline.length;
        if !self.is_scaled() {
            return length.scale;
        }
        let simulated = self.loaded.location(self.mean.len());
        let factor = x[self.free()].exp();
        FilmScale { factor, ..length.from_top(simulated, self.top, self.top_sd_mm) }
    }
}
