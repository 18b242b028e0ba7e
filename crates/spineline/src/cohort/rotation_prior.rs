//! The distribution of joint rotations over the bends of patients, and what it predicts of patients that it was not learned
//! from.

use super::Clustered;
use crate::analysis::Analysis;
use crate::anatomy::{Levels, Side};
use crate::evaluate::{
    Baseline, RotationPrior, RotationPriorError, joint_rotations, predict_from_prior,
};
use crate::spatial::Angle;

/// Groups that are left out in turn: every patient alone in small cohorts.
const MAX_GROUPS: usize = 20;

/// A prior of joint rotations, and how well such priors predict.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedRotations {
    /// Learned from all patients.
    pub prior: RotationPrior,
    /// Location errors, in mm, of bends of patients who were left out, from T2's location.
    pub from_location_mm: Clustered,
    /// The same from the location and tilt of T2.
    pub with_tilt_mm: Clustered,
    /// The same with published mobilities in the place of other patients ([`RotationPrior::published`]).
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
    analyses: &[&Analysis],
    seed: u64,
) -> Result<LearnedRotations, RotationPriorError> {
    let (patients, needed) = (analyses.len(), RotationPrior::MIN_PATIENTS);
    if patients < needed {
        return Err(RotationPriorError::TooFewPatients { patients, needed });
    }
    let bends: Vec<Vec<Vec<Angle>>> = analyses.iter().map(|one| bend_rotations(one)).collect();
    let levels = common_levels(analyses).ok_or(RotationPriorError::NoCommonJoints)?;
    let common: Vec<Vec<Vec<Angle>>> = analyses
        .iter()
        .zip(&bends)
        .map(|(analysis, bends)| {
            let first = analysis.levels().index_of(levels.base()).unwrap_or_default();
            let joints = first..first + levels.joints();
            bends.iter().map(|bend| bend[joints.clone()].to_vec()).collect()
        })
        .collect();
    let prior = RotationPrior::learned(levels, &common)?;
    let others = priors_of_others(analyses, &bends);
    let errors = |baseline: Baseline, of: &dyn Fn(usize) -> Option<RotationPrior>| {
        let patient = |(place, analysis): (usize, &&Analysis)| {
            of(place).map_or_else(Vec::new, |prior| errors_mm(analysis, baseline, &prior))
        };
        Clustered::new(analyses.iter().enumerate().map(patient).collect(), seed)
    };
    let published = |place: usize| Some(RotationPrior::published(analyses[place].levels()));
    Ok(LearnedRotations {
        from_location_mm: errors(Baseline::RotationPrior, &|place| others[place].clone()),
        with_tilt_mm: errors(Baseline::RotationPriorWithTilt, &|place| others[place].clone()),
        published_with_tilt_mm: errors(Baseline::RotationPriorWithTilt, &published),
        prior,
    })
}

/// Rotations of every bend of a patient, as if it were to the right.
pub(super) fn bend_rotations(analysis: &Analysis) -> Vec<Vec<Angle>> {
    let erect = &analysis.erect().outline;
    let bends = analysis.postures.iter().filter_map(|posture| {
        let sign = match posture.outline.posture.bend()? {
            Side::Right => 1.0,
            Side::Left => -1.0,
        };
        let rotations = joint_rotations(erect, &posture.outline);
        Some(rotations.into_iter().map(|rotation| rotation * sign).collect())
    });
    bends.collect()
}

/// For every patient a prior from patients of other groups with the same vertebrae; `None` where they are too few.
pub(super) fn priors_of_others(
    analyses: &[&Analysis],
    bends: &[Vec<Vec<Angle>>],
) -> Vec<Option<RotationPrior>> {
    let groups = analyses.len().min(MAX_GROUPS);
    let mut known: Vec<(usize, Levels, Option<RotationPrior>)> = Vec::new();
    let mut priors = Vec::with_capacity(analyses.len());
    for (place, analysis) in analyses.iter().enumerate() {
        let (group, levels) = (place % groups, analysis.levels());
        if let Some(found) = known.iter().find(|one| one.0 == group && one.1 == levels) {
            priors.push(found.2.clone());
            continue;
        }
        let others = analyses.iter().zip(bends).enumerate();
        let others = others.filter(|(i, (one, _))| i % groups != group && one.levels() == levels);
        let others: Vec<Vec<Vec<Angle>>> = others.map(|(_, (_, bends))| bends.clone()).collect();
        let prior = RotationPrior::learned(levels, &others).ok();
        known.push((group, levels, prior.clone()));
        priors.push(prior);
    }
    priors
}

/// The vertebrae that all patients show.
fn common_levels(analyses: &[&Analysis]) -> Option<Levels> {
    let base = analyses.iter().map(|one| one.levels().base()).max()?;
    let top = analyses.iter().map(|one| one.levels().top()).min()?;
    Levels::between(base, top)
}

fn errors_mm(analysis: &Analysis, baseline: Baseline, prior: &RotationPrior) -> Vec<f64> {
    let films = analysis.postures.iter().map(|posture| &posture.outline);
    let bends = films.filter(|film| film.posture.bend().is_some());
    let predicted =
        bends.map(|film| predict_from_prior(baseline, prior, &analysis.erect().outline, film));
    let usable = predicted.filter(crate::evaluate::BaselinePrediction::is_usable);
    usable.flat_map(|found| found.location_errors_mm).collect()
}
