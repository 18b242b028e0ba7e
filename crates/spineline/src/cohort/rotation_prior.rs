//! The distribution of joint rotations over the bends of patients, and its predictions for other patients.

use super::others::Others;
use super::{Clustered, CohortPatient, RESAMPLES};
use crate::anatomy::Levels;
use crate::evaluate::statistics::{Resampling, Summary};
use crate::evaluate::{Baseline, BendRotations, FilmFromTop, RotationPrior, RotationPriorError};

/// A prior of joint rotations, and how well such priors predict.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedRotations {
    /// Learned from all patients.
    pub prior: RotationPrior,
    /// Location errors, in mm, of bends of patients who were left out, from T2's location.
    pub from_location_mm: Clustered,
    /// The same from the location and tilt of T2.
    pub with_tilt_mm: Clustered,
    /// The same with published mobilities instead of other patients ([`RotationPrior::published`]).
    pub published_with_tilt_mm: Clustered,
}

/// Learns a prior from the bending films of patients, over the vertebrae that all of them show.
///
/// Each patient is predicted with a prior from patients of other groups, of which there are as many as patients and at most
/// 20. Intervals of the errors are by resampling patients from the seed.
///
/// # Errors
/// With fewer than five patients who have a bending film, or if they have too few vertebrae in common.
pub fn learn_rotation_prior(
    all: &[CohortPatient],
    seed: u64,
) -> Result<LearnedRotations, RotationPriorError> {
    let (patients, needed) = (all.len(), RotationPrior::MIN_PATIENTS);
    if patients < needed {
        return Err(RotationPriorError::TooFewPatients { patients, needed });
    }
    let levels = common_levels(all).ok_or(RotationPriorError::NoCommonJoints)?;
    let common = |patient: &CohortPatient| -> Vec<BendRotations> {
        let first = patient.levels.index_of(levels.base()).unwrap_or_default();
        let joints = first..first + levels.joints();
        patient.bends().iter().map(|bend| bend.of_joints(joints.clone())).collect()
    };
    let prior = RotationPrior::learned(levels, &all.iter().map(common).collect::<Vec<_>>())?;
    let others = Others::of(all, |_| true);
    let of_others = |place: usize| others.prior_of_others(place, all[place].levels).cloned();
    let resampling = Resampling::new(RESAMPLES, seed);
    let errors = |baseline: Baseline, of: &dyn Fn(usize) -> Option<RotationPrior>| {
        let patient = |(place, patient): (usize, &CohortPatient)| {
            let errors = of(place).map(|prior| errors_mm(patient, baseline, &prior));
            Summary::of(&errors.unwrap_or_default())
        };
        Clustered::of(&all.iter().enumerate().map(patient).collect::<Vec<_>>(), &resampling)
    };
    let published = |place: usize| Some(RotationPrior::published(all[place].levels));
    Ok(LearnedRotations {
        from_location_mm: errors(Baseline::RotationPrior, &of_others),
        with_tilt_mm: errors(Baseline::LearnedWithTilt, &of_others),
        published_with_tilt_mm: errors(Baseline::RotationPriorWithTilt, &published),
        prior,
    })
}

/// The vertebrae that all patients show.
fn common_levels(patients: &[CohortPatient]) -> Option<Levels> {
    let base = patients.iter().map(|one| one.levels.base()).max()?;
    let top = patients.iter().map(|one| one.levels.top()).min()?;
    Levels::between(base, top)
}

fn errors_mm(patient: &CohortPatient, baseline: Baseline, prior: &RotationPrior) -> Vec<f64> {
    let is_bend =
        |film: &&FilmFromTop| film.posture.bend().is_some() && patient.has_lengths(film.posture);
    let bends = patient.from_top.iter().filter(is_bend);
    let predicted = bends.map(|film| film.by_prior(baseline, prior, &patient.links));
    let usable = predicted.filter(crate::evaluate::BaselinePrediction::is_usable);
    usable.flat_map(|found| found.shape.location_errors_mm).collect()
}
