//! How probable a film is, given another film of the patient: as one picture read twice, as another posture, and as its mirror image.
//!
//! # Definition
//! Tilts and lateral coordinates of two films differ by landmark noise, by where the patient lies on the film, and by movement:
//! the differences are normal with the covariance `f² N + s² M K Mᵀ` and free shift, scale and rotation of the film. `N` is the
//! noise of both films, `M` takes joint rotations to tilts and coordinates, and `K` correlates neighbouring joints. The unknown
//! sizes `f` of the noise and `s` of the joint rotations have log-normal priors, over which densities are summed.
//! Two explanations are compared by the ratio of their densities.

use nalgebra::{DMatrix, DVector};

use crate::anatomy::Side;
use crate::measure::{MeasuredVertebra, Noise, Outline};
use crate::spatial::Angle;

/// Another explanation of a film is reported where it makes the film 60 times as probable. If 3 of 100 films are wrong (assumption), the
/// other explanation is then twice as probable as the stated one.
const CLEARLY: f64 = 60.0;

/// Size of joint rotations between two postures, and the standard deviation of its logarithm (assumptions).
#[derive(Clone, Copy)]
struct JointRotations {
    size: Angle,
    log_sd: f64,
}

/// The smallest occur in a mild curve between standing and lying: half a degree.
const MOVEMENT: JointRotations = JointRotations { size: Angle::from_deg(0.8), log_sd: 1.1 };
/// The same of a bend.
const BENDING: JointRotations = JointRotations { size: Angle::from_deg(2.0), log_sd: 0.9 };
const MOVEMENTS_DEG: [f64; 7] = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4];
/// Joints over which the correlation of two rotations falls to 1/e; half of the variance is common to all joints.
const CORRELATED_JOINTS: f64 = 2.0;

/// True noise over stated noise, and the standard deviation of its logarithm, where readings showed it.
const MEASURED_NOISE: ([f64; 5], f64) = ([0.8, 0.9, 1.0, 1.12, 1.25], 0.15);
/// The same where it is an assumption for one careful reading.
const ASSUMED_NOISE: ([f64; 10], f64) =
    ([0.12, 0.18, 0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8], 0.8);
/// Tilts that differ by more standard deviations are not a second reading.
const MAX_NOISE: f64 = 8.0;

/// Rotation of a patient from one film to another.
const FILM_ROTATION: Angle = Angle::from_deg(2.0);
/// Rotation of a picture that is digitised again.
const PICTURE_ROTATION: Angle = Angle::from_deg(0.05);
/// The pelvis turns with a bend.
const FREE_ROTATION: Angle = Angle::from_deg(30.0);
const SHIFT_MM: f64 = 30.0;
const LOG_SCALE: f64 = 0.05;

/// Movement that the model of the joints lacks, where a film is compared with its mirror image: bodies that rotate about
/// their axis, and joints that move otherwise than their neighbours (assumptions).
const UNDESCRIBED: Noise =
    Noise { location_mm: 3.0, tilt: Angle::from_deg(2.0), tilt_degrees_of_freedom: None };
/// Part of the erect curve by which another posture flattens it, and its standard deviation.
const FLATTENED: (f64, f64) = (0.2, 0.3);
/// Rotation of every joint towards the side of a bend, and its standard deviation.
const BEND_PER_JOINT: (Angle, Angle) = (Angle::from_deg(1.2), Angle::from_deg(1.0));

/// How the second of two films is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Taken {
    AsStated,
    /// As the mirror image of what it shows.
    Mirrored,
}

/// Whether a film is clearly more probable with another explanation.
pub(super) fn is_clear(log_odds: f64) -> bool {
    log_odds > CLEARLY.ln()
}

/// Differences of two films of one patient, tilts first and then lateral coordinates, in rad and mm.
pub(super) struct FilmDifference {
    values: DVector<f64>,
    /// Of every value: variance of landmark noise.
    noise: DVector<f64>,
    noise_is_measured: bool,
    /// Rotations of joints → values.
    movement: DMatrix<f64>,
    /// Effects of a rotation of the whole film by 1 rad, of a shift by 1 mm, and of a scale.
    rotation: DVector<f64>,
    shift: DVector<f64>,
    scale: DVector<f64>,
    /// Joint angles of the first film, in rad.
    curve: DVector<f64>,
}

impl FilmDifference {
    /// Of outlines with the same vertebrae.
    pub fn between(first: &Outline, second: &Outline, taken: Taken) -> Self {
        let sign = match taken {
            Taken::AsStated => 1.0,
            Taken::Mirrored => -1.0,
        };
        // The first film lies in its frame G; the second one is turned by the difference of the tilts of their bases.
        let turned = (second.l4_on_film * sign - first.l4_on_film).wrapped();
        let count = first.vertebrae.len();
        let (mut values, mut noise) = (DVector::zeros(2 * count), DVector::zeros(2 * count));
        let (mut heights_mm, mut scale) = (Vec::with_capacity(count), DVector::zeros(2 * count));
        for (i, (a, b)) in first.vertebrae.iter().zip(&second.vertebrae).enumerate() {
            let mut place = b.location;
            place.y_mm *= sign;
            let place = place.rotated(turned);
            values[i] = (b.tilt * sign + turned - a.tilt).wrapped().rad();
            values[count + i] = place.y_mm - a.location.y_mm;
            let [own, other] = [noise_of(first, a), noise_of(second, b)];
            noise[i] = own.tilt.rad().powi(2) + other.tilt.rad().powi(2);
            noise[count + i] = own.location_mm.powi(2) + other.location_mm.powi(2);
            heights_mm.push(f64::midpoint(a.location.z_mm, place.z_mm));
            scale[count + i] = f64::midpoint(a.location.y_mm, place.y_mm);
        }
        let part = |of_tilts: f64, of_heights: f64, one: f64| {
            DVector::from_fn(2 * count, |row, _| {
                if row < count { of_tilts } else { of_heights * heights_mm[row - count] + one }
            })
        };
        let movement = DMatrix::from_fn(2 * count, count - 1, |row, joint| {
            let vertebra = row % count;
            let middle_mm = f64::midpoint(heights_mm[joint], heights_mm[joint + 1]);
            match (vertebra > joint, row < count) {
                (false, _) => 0.0,
                (true, true) => 1.0,
                (true, false) => middle_mm - heights_mm[vertebra],
            }
        });
        let turns = first.vertebrae.windows(2).map(|pair| (pair[1].tilt - pair[0].tilt).rad());
        Self {
            values,
            noise,
            noise_is_measured: first.noise.is_measured() && second.noise.is_measured(),
            movement,
            rotation: part(1.0, -1.0, 0.0),
            shift: part(0.0, 0.0, 1.0),
            scale,
            curve: DVector::from_vec(turns.collect()),
        }
    }

    /// Logarithm of the odds that the films are one picture, read twice, against two postures.
    pub fn log_odds_of_one_picture(&self) -> f64 {
        self.log_odds_of_rest(PICTURE_ROTATION, MOVEMENT)
    }

    /// Logarithm of the odds that no joint moved between an erect and a bending film, against a bend. The patient may be turned as
    /// a whole.
    pub fn log_odds_of_no_bend(&self) -> f64 {
        let turned = self.log_odds_of_rest(FILM_ROTATION, BENDING);
        turned.max(self.log_odds_of_rest(PICTURE_ROTATION, BENDING))
    }

    fn log_odds_of_rest(&self, rotation: Angle, joints: JointRotations) -> f64 {
        if self.exceeds_noise() {
            return f64::NEG_INFINITY;
        }
        let noises = if self.noise_is_measured {
            weighted(&MEASURED_NOISE.0, 1.0, MEASURED_NOISE.1)
        } else {
            weighted(&ASSUMED_NOISE.0, 1.0, ASSUMED_NOISE.1)
        };
        let movements = weighted(&MOVEMENTS_DEG, joints.size.deg(), joints.log_sd);
        let joints = self.of_joints(&correlations(self.curve.len()));
        let [still, moved] = [rotation, FILM_ROTATION].map(|rotation| self.of_film(rotation));
        let (mut one, mut two) = (Vec::new(), Vec::new());
        for &(factor, log_weight) in &noises {
            let noise = DMatrix::from_diagonal(&(&self.noise * factor.powi(2)));
            one.push(log_weight + log_density(&self.values, &still + &noise));
            for &(deg, log_prior) in &movements {
                let covariance = &moved + &noise + &joints * Angle::from_deg(deg).rad().powi(2);
                two.push(log_weight + log_prior + log_density(&self.values, covariance));
            }
        }
        log_sum(&one) - log_sum(&two)
    }

    /// Logarithm of the density of the differences from an erect film to a bend or, without a side, to a posture at rest.
    pub fn log_density_of_posture(&self, bend: Option<Side>) -> f64 {
        let joints = self.curve.len();
        let sense = match bend {
            Some(Side::Left) => -1.0,
            Some(Side::Right) => 1.0,
            None => 0.0,
        };
        let (mean, sd) = BEND_PER_JOINT;
        let expected =
            DVector::from_element(joints, sense * mean.rad()) - &self.curve * FLATTENED.0;
        let common = DMatrix::from_element(joints, joints, (sense * sd.rad()).powi(2));
        let flattened = &self.curve * self.curve.transpose() * FLATTENED.1.powi(2);
        let known = self.of_film(FREE_ROTATION) + self.of_joints(&(common + flattened));
        let count = self.values.len() / 2;
        let undescribed = DVector::from_fn(2 * count, |row, _| {
            let sd = if row < count { UNDESCRIBED.tilt.rad() } else { UNDESCRIBED.location_mm };
            self.noise[row] + sd.powi(2)
        });
        let known = known + DMatrix::from_diagonal(&undescribed);
        let residual = &self.values - &self.movement * expected;
        let own = self.of_joints(&correlations(joints));
        let JointRotations { size, log_sd } = MOVEMENT;
        let densities =
            weighted(&MOVEMENTS_DEG, size.deg(), log_sd).into_iter().map(|(deg, log_prior)| {
                log_prior
                    + log_density(&residual, &known + &own * Angle::from_deg(deg).rad().powi(2))
            });
        log_sum(&densities.collect::<Vec<_>>())
    }

    /// Whether the differences are too large for any noise, so that no density is computed.
    fn exceeds_noise(&self) -> bool {
        let count = self.values.len() / 2;
        let mean = self.values.rows(0, count).mean();
        let of = |i: usize| (self.values[i] - mean).powi(2) / self.noise[i];
        (0..count).map(of).sum::<f64>() / count as f64 > MAX_NOISE.powi(2)
    }

    fn of_joints(&self, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        &self.movement * covariance * self.movement.transpose()
    }

    /// Covariance by how the patient lies on the film.
    fn of_film(&self, rotation: Angle) -> DMatrix<f64> {
        let parts =
            [(&self.rotation, rotation.rad()), (&self.shift, SHIFT_MM), (&self.scale, LOG_SCALE)];
        let zero = DMatrix::zeros(self.values.len(), self.values.len());
        parts.into_iter().fold(zero, |sum, (of, sd)| sum + of * of.transpose() * sd.powi(2))
    }
}

/// The noise of a vertebra, marked or interpolated.
fn noise_of(outline: &Outline, vertebra: &MeasuredVertebra) -> Noise {
    match vertebra.own_noise() {
        Some(own) if !vertebra.is_measured() => own,
        _ => outline.noise_of(vertebra),
    }
}

fn correlations(joints: usize) -> DMatrix<f64> {
    DMatrix::from_fn(joints, joints, |i, j| {
        0.5 + 0.5 * (-(i.abs_diff(j) as f64) / CORRELATED_JOINTS).exp()
    })
}

/// Values with the logarithms of their weights under a log-normal distribution; the weights have a sum of one.
fn weighted(values: &[f64], median: f64, log_sd: f64) -> Vec<(f64, f64)> {
    let log = |value: &f64| -0.5 * ((value / median).ln() / log_sd).powi(2);
    let sum = log_sum(&values.iter().map(log).collect::<Vec<_>>());
    values.iter().map(|value| (*value, log(value) - sum)).collect()
}

/// Logarithm of the sum of numbers of which the logarithms are given.
fn log_sum(logs: &[f64]) -> f64 {
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest + logs.iter().map(|log| (log - largest).exp()).sum::<f64>().ln()
}

/// Of a normal distribution with mean zero, without the factor of π; NaN if the covariance is singular by rounding: callers
/// then judge nothing.
fn log_density(values: &DVector<f64>, covariance: DMatrix<f64>) -> f64 {
    let Some(root) = covariance.cholesky().map(|found| found.unpack()) else { return f64::NAN };
    let Some(whitened) = root.solve_lower_triangular(values) else { return f64::NAN };
    let log_determinant: f64 = root.diagonal().iter().map(|one| one.ln()).sum();
    -0.5 * whitened.norm_squared() - log_determinant
}
