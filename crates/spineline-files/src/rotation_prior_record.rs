//! A distribution of joint rotations in files.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::anatomy::{Level, Levels};
use spineline::evaluate::{PriorSource, RotationPrior};
use spineline::spatial::Angle;

use crate::FileError;
use crate::stiffness_file::border;

/// A normal distribution of the joint rotations of a bend to the right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RotationPriorRecord {
    /// The lowest vertebra.
    base: Level,
    /// The highest vertebra.
    top: Level,
    /// Patients.
    patients: usize,
    /// Their bending films.
    bends: usize,
    /// By which part correlations between joints were reduced.
    shrinkage: f64,
    /// Change of a rotation per angle of its joint on the erect film.
    erect_coefficient: f64,
    /// Mean rotation in degrees of every joint that stands at zero on the erect film, caudal first; positive to the right.
    mean_deg: Vec<f64>,
    /// Covariance of the rotations in deg².
    covariance_deg2: Vec<Vec<f64>>,
}

impl RotationPriorRecord {
    /// `None` for the published prior, which needs no record.
    pub fn new(prior: &RotationPrior) -> Option<Self> {
        let PriorSource::Learned { patients, bends, shrinkage } = prior.source() else {
            return None;
        };
        let covariance = prior.covariance_rad2();
        let value = |rad2: f64| border(rad2, rad2 / rad2_of(1.0), rad2_of);
        Some(Self {
            base: prior.levels().base(),
            top: prior.levels().top(),
            patients,
            bends,
            shrinkage,
            erect_coefficient: prior.erect_coefficient(),
            mean_deg: prior
                .mean()
                .iter()
                .map(|joint| border(joint.rad(), joint.deg(), |deg| Angle::from_deg(deg).rad()))
                .collect(),
            covariance_deg2: covariance
                .row_iter()
                .map(|row| row.iter().map(|&rad2| value(rad2)).collect())
                .collect(),
        })
    }

    /// The prior that this record holds.
    pub fn prior(&self) -> Result<RotationPrior, FileError> {
        let (base, top) = (self.base, self.top);
        let levels = Levels::between(base, top).ok_or(FileError::PriorLevels { base, top })?;
        let rows = &self.covariance_deg2;
        let columns = rows.first().map_or(0, Vec::len);
        if rows.iter().any(|row| row.len() != columns) {
            return Err(FileError::PriorRows);
        }
        let covariance =
            DMatrix::from_fn(rows.len(), columns, |row, column| rad2_of(rows[row][column]));
        let mean = self.mean_deg.iter().map(|&deg| Angle::from_deg(deg)).collect();
        let Self { patients, bends, shrinkage, .. } = *self;
        let source = PriorSource::Learned { patients, bends, shrinkage };
        let prior = RotationPrior::new(levels, mean, covariance, source)?;
        Ok(prior.with_erect_coefficient(self.erect_coefficient))
    }
}

fn rad2_of(deg2: f64) -> f64 {
    let degree = Angle::from_deg(1.0).rad();
    deg2 * (degree * degree)
}
