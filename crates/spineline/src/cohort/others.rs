//! A patient in a cohort, with predictions of its films from other patients.

use super::numbers::Numbers;
use super::patient::CohortPatient;
use crate::analysis::FilmRole;
use crate::anatomy::Levels;
use crate::evaluate::{Baseline, BaselinePrediction, BendRotations, RotationPrior};
use crate::spatial::Angle;

/// Groups of patients that are left out in turn: every patient alone in small cohorts.
const MAX_GROUPS: usize = 20;

/// Baselines by the distribution of rotations over other patients.
const LEARNED: [Baseline; 2] = [Baseline::RotationPrior, Baseline::LearnedWithTilt];

/// A patient, with predictions of its films from other patients.
pub(super) struct Seen<'a> {
    pub patient: &'a CohortPatient,
    /// Location errors of baselines from other patients, in mm, by place of the film.
    of_others_mm: Numbers<(u8, Baseline)>,
}

impl<'a> Seen<'a> {
    /// `mean` are the mean rotations of other patients, `prior` the distribution of their rotations.
    fn new(
        patient: &'a CohortPatient,
        mean: Option<&[Angle]>,
        prior: Option<&RotationPrior>,
    ) -> Self {
        // A given prior was learned elsewhere, and a cohort learns no other.
        let prior = prior.filter(|_| !patient.has_rotation_prior);
        let mut found: Vec<(u8, BaselinePrediction)> = Vec::new();
        for place in FilmRole::PREDICTED.into_iter().flat_map(|role| patient.places(role)) {
            let posture = patient.compared[usize::from(place)].0;
            let film = patient.from_top.iter().find(|film| film.posture == posture);
            let Some(film) = film.filter(|_| patient.has_lengths(posture)) else { continue };
            let from_mean =
                mean.map(|mean| film.by_pattern(Baseline::OtherPatients, mean, &patient.links));
            found.extend(from_mean.map(|one| (place, one)));
            if let Some(prior) = prior.filter(|_| posture.bend().is_some()) {
                let learned = LEARNED.map(|one| film.by_prior(one, prior, &patient.links));
                found.extend(learned.map(|one| (place, one)));
            }
        }
        let usable = found.iter().filter(|(_, one)| one.is_usable());
        let of_others_mm = Numbers::of(
            usable.map(|(place, one)| ((*place, one.baseline), &one.shape.location_errors_mm[..])),
        );
        Self { patient, of_others_mm }
    }

    /// Location errors of a baseline on a film by its place, in mm; `None` without a result.
    pub fn baseline_mm(&self, film: u8, baseline: Baseline) -> Option<&[f64]> {
        let own = || self.patient.baseline_mm(film, baseline);
        self.of_others_mm.get(&(film, baseline)).or_else(own)
    }
}

/// The rotations of all patients but one, as if all bent to the right.
pub(super) struct Others {
    by_levels: Vec<Bends>,
}

/// The bends of all patients with the same vertebrae.
struct Bends {
    levels: Levels,
    count: usize,
    /// By joint, in rad.
    sums: Vec<f64>,
    /// By group a prior from the other groups; `None` where the others are too few.
    priors: Vec<Option<RotationPrior>>,
}

impl Others {
    /// Of the patients that count.
    pub fn of(patients: &[CohortPatient], counts: fn(&CohortPatient) -> bool) -> Self {
        let bends = |one: &CohortPatient| if counts(one) { one.bends() } else { Vec::new() };
        let bends: Vec<_> = patients.iter().map(bends).collect();
        let levels = patients.iter().map(|one| one.levels);
        let with_levels = levels.zip(&bends).map(|(levels, bends)| (levels, &bends[..]));
        Self::of_bends(&with_levels.collect::<Vec<_>>())
    }

    /// `patients` have their vertebrae and bends.
    fn of_bends(patients: &[(Levels, &[BendRotations])]) -> Self {
        let mut known: Vec<Levels> = Vec::new();
        for (levels, _) in patients.iter().filter(|(_, bends)| !bends.is_empty()) {
            if !known.contains(levels) {
                known.push(*levels);
            }
        }
        Self { by_levels: known.into_iter().map(|levels| Bends::of(levels, patients)).collect() }
    }

    /// In a cohort of fewer patients than groups every patient is a group.
    const fn group(place: usize) -> usize {
        place % MAX_GROUPS
    }

    /// A prior for the patient at a place of the cohort, from the patients of other groups.
    pub fn prior_of_others(&self, place: usize, levels: Levels) -> Option<&RotationPrior> {
        let same = self.by_levels.iter().find(|one| one.levels == levels)?;
        same.priors.get(Self::group(place))?.as_ref()
    }

    /// The patient at a place of the cohort.
    pub fn see<'a>(&self, patient: &'a CohortPatient, place: usize) -> Seen<'a> {
        let with_same = self.by_levels.iter().find(|one| one.levels == patient.levels);
        let mean = with_same.and_then(|bends| bends.mean_of_others(&patient.bends()));
        Seen::new(patient, mean.as_deref(), self.prior_of_others(place, patient.levels))
    }
}

impl Bends {
    /// The bends of the patients who have these vertebrae.
    fn of(levels: Levels, patients: &[(Levels, &[BendRotations])]) -> Self {
        let same: Vec<(usize, &[BendRotations])> = patients
            .iter()
            .enumerate()
            .filter(|(_, (own, _))| *own == levels)
            .map(|(place, (_, bends))| (Others::group(place), *bends))
            .collect();
        let all = || same.iter().flat_map(|(_, bends)| bends.iter());
        let sum = |joint: usize| all().map(|bend| bend.rotations[joint].rad()).sum();
        let without = |group: usize| {
            let others = same.iter().filter(|(other, _)| *other != group);
            let others: Vec<&[BendRotations]> = others.map(|(_, bends)| *bends).collect();
            RotationPrior::learned(levels, &others).ok()
        };
        let groups = patients.len().min(MAX_GROUPS);
        Self {
            levels,
            count: all().count(),
            sums: (0..levels.joints()).map(sum).collect(),
            priors: (0..groups).map(without).collect(),
        }
    }

    /// The mean over the bends of all other patients than one with these bends; `None` without any.
    fn mean_of_others(&self, own: &[BendRotations]) -> Option<Vec<Angle>> {
        let others = self.count - own.len();
        let of_others = |(joint, sum): (usize, &f64)| {
            let of_own: f64 = own.iter().map(|bend| bend.rotations[joint].rad()).sum();
            Angle::from_rad((sum - of_own) / others as f64)
        };
        (others > 0).then(|| self.sums.iter().enumerate().map(of_others).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy::Level;
    use crate::evaluate::PriorSource;

    fn bends(patient: usize, joints: usize) -> Vec<BendRotations> {
        let bend = |bend: usize| {
            let of = |joint: usize| ((5 * patient + 3 * bend + joint) as f64 * 1.3).sin();
            let angles = |factor: f64| -> Vec<Angle> {
                (0..joints).map(|joint| Angle::from_deg(3.0 + factor * of(joint))).collect()
            };
            BendRotations { rotations: angles(2.0), erect: angles(5.0 - 3.0 * bend as f64) }
        };
        (0..patient % 3).map(bend).collect()
    }

    #[test]
    fn a_prior_for_a_patient_is_learned_from_patients_of_other_groups_with_the_same_vertebrae() {
        // Every fourth patient has fewer vertebrae; the first of each has no bend.
        let fewer = Levels::between(Level::L3, Level::T2).expect("a chain");
        let levels = |patient: usize| if patient % 4 == 3 { fewer } else { Levels::COMPLETE };
        for patients in [1, 7, 43] {
            let own: Vec<_> = (0..patients).map(|one| bends(one, levels(one).joints())).collect();
            let of_patients: Vec<_> =
                (0..patients).map(|one| (levels(one), &own[one][..])).collect();
            let others = Others::of_bends(&of_patients);
            for place in (0..patients).filter(|&place| !own[place].is_empty()) {
                let is_other = |&one: &usize| {
                    one % MAX_GROUPS != place % MAX_GROUPS && levels(one) == levels(place)
                };
                let of_others: Vec<_> = (0..patients).filter(is_other).map(|i| &own[i]).collect();
                let expected = RotationPrior::learned(levels(place), &of_others).ok();
                let found = others.prior_of_others(place, levels(place));
                assert_eq!(found.is_some(), expected.is_some(), "{place} of {patients}");
                let Some((found, expected)) = found.zip(expected) else { continue };
                let counts = |prior: &RotationPrior| match prior.source() {
                    PriorSource::Learned { patients, bends, .. } => (patients, bends),
                    PriorSource::Published => panic!("learned"),
                };
                assert_eq!(counts(found), counts(&expected));
                assert_eq!(found.erect_coefficient(), expected.erect_coefficient());
                let off = found.covariance_rad2() - expected.covariance_rad2();
                assert!(off.amax() < 1e-15, "{off}");
                let off = found.mean().iter().zip(expected.mean()).map(|(a, b)| (*a - *b).deg());
                assert!(off.into_iter().all(|deg| deg.abs() < 1e-12));
            }
        }
    }
}
