//! Prior of the joint rotations of a bend: their mean, and their covariance between patients.

use nalgebra::DMatrix;

use super::bend_rotations::{BendRotations, BendStatistics};
use super::mobility::published_lateral_bending;
use crate::anatomy::{Levels, Posture, Side};
use crate::spatial::Angle;
use crate::warning::counted;

/// Normal distribution of the joint rotations of a bend to the right; a bend to the left has its mirror image.
///
/// The mean rotation of a joint depends on its angle on the erect film, by one coefficient for all joints.
///
/// It has no mechanics. Learned from a cohort ([`RotationPrior::learned`]) or taken from published mobilities
/// ([`RotationPrior::published`]).
#[derive(Debug, Clone, PartialEq)]
pub struct RotationPrior {
    levels: Levels,
    mean: Vec<Angle>,
    erect_coefficient: f64,
    covariance_rad2: DMatrix<f64>,
    /// Lower triangle whose product with its transpose is the covariance.
    root: DMatrix<f64>,
    source: PriorSource,
}

/// Where a prior of joint rotations comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PriorSource {
    /// Published mobility of healthy joints; the size and side of the bend are free.
    Published,
    /// The bends of a cohort.
    Learned {
        /// Patients.
        patients: usize,
        /// Their bending films.
        bends: usize,
        /// By which part the correlations between joints were reduced, since so few films determine them badly.
        shrinkage: f64,
    },
}

/// Why no prior of joint rotations can be learned or used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RotationPriorError {
    /// Too few patients.
    #[error(
        "{} with a bending film, but a prior of joint rotations needs at least {needed}: add patients",
        counted(*patients, "patient")
    )]
    TooFewPatients {
        /// Those with a bend.
        patients: usize,
        /// The fewest.
        needed: usize,
    },
    /// The patients do not share a joint.
    #[error(
        "the patients do not share two vertebrae: learn from patients with the same vertebrae on their films"
    )]
    NoCommonJoints,
    /// The numbers are not a normal distribution.
    #[error("the covariance of the joint rotations is not symmetric and positive definite")]
    NoCovariance,
    /// Mean or covariance do not fit the vertebrae.
    #[error(
        "the levels have {joints} joints, but the mean has {mean} values and the covariance {rows} rows and {columns} columns"
    )]
    Shape {
        /// Joints of the levels.
        joints: usize,
        /// Values of the mean.
        mean: usize,
        /// Rows of the covariance.
        rows: usize,
        /// Its columns.
        columns: usize,
    },
}

impl RotationPrior {
    /// Fewest patients that a prior is learned from.
    pub const MIN_PATIENTS: usize = 5;
    /// Standard deviation of a rotation that films do not share: the noise of two tilts.
    const NOISE: Angle = Angle::from_deg(0.5);
    /// Standard deviation of a published mobility between joints of different people, as a part of it (assumed).
    const PUBLISHED_RELATIVE_SD: f64 = 0.25;
    /// Standard deviation of the size of a bend, as a multiple of the published mobility: nearly free.
    const FREE_SIZE_SD: f64 = 3.0;

    /// A prior from its numbers: a mean per joint, caudal first and positive to the right, and their covariance in rad².
    ///
    /// # Errors
    /// If the shapes do not fit the levels, or the covariance is not symmetric and positive definite.
    pub fn new(
        levels: Levels,
        mean: Vec<Angle>,
        covariance_rad2: DMatrix<f64>,
        source: PriorSource,
    ) -> Result<Self, RotationPriorError> {
        let joints = levels.joints();
        let (rows, columns) = covariance_rad2.shape();
        if [mean.len(), rows, columns] != [joints; 3] {
            return Err(RotationPriorError::Shape { joints, mean: mean.len(), rows, columns });
        }
        let symmetric = covariance_rad2 == covariance_rad2.transpose();
        let root = covariance_rad2.clone().cholesky().filter(|_| symmetric);
        let root = root.ok_or(RotationPriorError::NoCovariance)?.l();
        Ok(Self { levels, mean, erect_coefficient: 0.0, covariance_rad2, root, source })
    }

    /// The same with another change of a rotation per angle of its joint on the erect film; it is zero without this.
    #[must_use]
    pub fn with_erect_coefficient(self, erect_coefficient: f64) -> Self {
        Self { erect_coefficient, ..self }
    }

    /// The published prior.
    ///
    /// # Definition
    /// Rotations are `a w_j + e_j`, with the published mobility `w_j` ([`published_lateral_bending`]), a free size `a` of either
    /// sign, and independent deviations `e_j` of a quarter of `w_j`.
    ///
    /// ```
    /// use spineline::anatomy::Levels;
    /// use spineline::evaluate::RotationPrior;
    /// let prior = RotationPrior::published(Levels::COMPLETE);
    /// assert_eq!(prior.mean().len(), 14);
    /// ```
    #[must_use]
    pub fn published(levels: Levels) -> Self {
        let mobility: Vec<f64> =
            published_lateral_bending(levels).iter().map(|a| a.rad()).collect();
        let joints = levels.joints();
        let covariance_rad2 = DMatrix::from_fn(joints, joints, |i, j| {
            let own = if i == j { Self::PUBLISHED_RELATIVE_SD.powi(2) } else { 0.0 };
            (Self::FREE_SIZE_SD.powi(2) + own) * (mobility[i] * mobility[j])
        });
        Self::new(levels, vec![Angle::ZERO; joints], covariance_rad2, PriorSource::Published)
            .expect("a positive diagonal and a product of a vector with itself")
    }

    /// Learns from the bends of patients, each as if it were to the right.
    ///
    /// # Definition
    /// Rotations are `m_j + b e_j` with the angle `e_j` of the joint on the erect film; `b`, one for all joints, is the least-squares slope
    /// about the joints' means. Mean and covariance are over all bends; every correlation between two joints is multiplied by `1 - λ`, where `λ` is the
    /// sum of the variances of the correlations over the sum of their squares [schafer-strimmer-2005]; these variances are over patients, because
    /// the bends of a patient share spine and erect film. (0.5°)² of noise are added to every variance.
    ///
    /// # Errors
    /// With fewer than five patients.
    ///
    /// # Panics
    /// If a bend has not one rotation per joint.
    pub fn learned(
        levels: Levels,
        patients: &[impl AsRef<[BendRotations]>],
    ) -> Result<Self, RotationPriorError> {
        let bends: Vec<&BendRotations> = patients.iter().flat_map(AsRef::as_ref).collect();
        let of_patients = patients.iter().map(|bends| bends.as_ref().len());
        let of_patients: Vec<usize> = of_patients.filter(|&bends| bends > 0).collect();
        let (patients, needed) = (of_patients.len(), Self::MIN_PATIENTS);
        if patients < needed {
            return Err(RotationPriorError::TooFewPatients { patients, needed });
        }
        let joints = levels.joints();
        let found = BendStatistics::of(joints, &bends);
        let sample = found.covariance();
        let shrinkage = correlation_shrinkage(&found, &sample, &of_patients);
        let covariance_rad2 = DMatrix::from_fn(joints, joints, |i, j| {
            if i == j {
                sample[(i, i)] + Self::NOISE.rad().powi(2)
            } else {
                // Of one of both, so that rounding leaves it symmetric.
                (1.0 - shrinkage) * sample[(i.max(j), i.min(j))]
            }
        });
        let source = PriorSource::Learned { patients, bends: bends.len(), shrinkage };
        let mean = found.mean.iter().map(|&rad| Angle::from_rad(rad)).collect();
        let prior = Self::new(levels, mean, covariance_rad2, source)?;
        Ok(prior.with_erect_coefficient(found.erect_coefficient))
    }

    /// Vertebrae whose joints it describes.
    #[must_use]
    pub const fn levels(&self) -> Levels {
        self.levels
    }

    /// Mean rotation of every joint that stands at zero on the erect film, caudal first; positive to the right.
    #[must_use]
    pub fn mean(&self) -> &[Angle] {
        &self.mean
    }

    /// Change of a rotation per angle of its joint on the erect film.
    #[must_use]
    pub const fn erect_coefficient(&self) -> f64 {
        self.erect_coefficient
    }

    /// Mean rotation of every joint in a posture, by its angle on the erect film: mirrored for a bend to the left.
    #[must_use]
    pub fn mean_of(&self, posture: Posture, erect: &[Angle]) -> Vec<Angle> {
        let sign = if posture.bend() == Some(Side::Left) { -1.0 } else { 1.0 };
        let joint =
            |(&mean, &erect): (&Angle, &Angle)| mean * sign + erect * self.erect_coefficient;
        self.mean.iter().zip(erect).map(joint).collect()
    }

    /// Covariance of the rotations, in rad².
    #[must_use]
    pub const fn covariance_rad2(&self) -> &DMatrix<f64> {
        &self.covariance_rad2
    }

    /// Where it comes from.
    #[must_use]
    pub const fn source(&self) -> PriorSource {
        self.source
    }

    /// Lower triangle whose product with its transpose is the covariance.
    pub(crate) const fn root(&self) -> &DMatrix<f64> {
        &self.root
    }

    /// The prior of the joints of fewer vertebrae; `None` where it does not describe all of them.
    #[must_use]
    pub fn of(&self, levels: Levels) -> Option<Self> {
        let first = self.levels.index_of(levels.base())?;
        self.levels.index_of(levels.top())?;
        let joints = levels.joints();
        let mean = self.mean[first..first + joints].to_vec();
        let covariance = self.covariance_rad2.view((first, first), (joints, joints)).into_owned();
        let part = Self::new(levels, mean, covariance, self.source).ok()?;
        Some(part.with_erect_coefficient(self.erect_coefficient))
    }
}

/// The part by which correlations are reduced: the sum of their variances over the sum of their squares.
///
/// `sample` is the covariance of the bends, and `of_patients` are the numbers of bends of the patients.
fn correlation_shrinkage(
    found: &BendStatistics,
    sample: &DMatrix<f64>,
    of_patients: &[usize],
) -> f64 {
    let (bends, patients) = (found.deviations.nrows() as f64, of_patients.len() as f64);
    let share = patients / (patients - 1.0) / (bends - 1.0).powi(2);
    let (mut variances, mut squares) = (0.0, 0.0);
    for i in 0..sample.nrows() {
        for j in 0..i {
            let sizes = sample[(i, i)] * sample[(j, j)];
            // Joints that never move lack a correlation.
            if sizes == 0.0 {
                continue;
            }
            variances += share * found.spread_of_products(i, j, of_patients) / sizes;
            squares += sample[(i, j)].powi(2) / sizes;
        }
    }
    if squares == 0.0 { 1.0 } else { (variances / squares).clamp(0.0, 1.0) }
}
