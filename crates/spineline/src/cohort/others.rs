//! A patient as a cohort sees it: its predicted films with what other patients say of them.

use super::patient::{CohortPatient, PatientFilmUnderLines};
use crate::analysis::FilmRole;
use crate::anatomy::Levels;
use crate::evaluate::{Baseline, BaselinePrediction, RotationPrior};
use crate::spatial::Angle;

/// Groups of patients that are left out in turn: every patient alone in small cohorts.
const MAX_GROUPS: usize = 20;

/// The roles of films that are predicted.
pub(super) const PREDICTED: [FilmRole; 2] = [FilmRole::LeftOutBend, FilmRole::HeldOut];

/// A patient, with what other patients say of its films.
pub(super) struct Seen<'a> {
    pub patient: &'a CohortPatient,
    predicted: Vec<PredictedFilm<'a>>,
}

/// A predicted film, with every baseline that it has.
pub(super) struct PredictedFilm<'a> {
    pub film: &'a PatientFilmUnderLines,
    /// Location errors; `None` where there is no result.
    baselines_mm: Vec<(Baseline, Option<Vec<f64>>)>,
}

impl PredictedFilm<'_> {
    pub fn errors_mm(&self, baseline: Baseline) -> Option<&[f64]> {
        let found = self.baselines_mm.iter().find(|one| one.0 == baseline);
        found.and_then(|one| one.1.as_deref())
    }
}

impl<'a> Seen<'a> {
    /// Predicted films of a role.
    pub fn films(&self, role: FilmRole) -> impl Iterator<Item = &PredictedFilm<'a>> {
        self.predicted.iter().filter(move |one| one.film.role == role)
    }

    /// `mean` are the mean rotations of other patients, `prior` the distribution of their rotations.
    fn new(
        patient: &'a CohortPatient,
        mean: Option<&[Angle]>,
        prior: Option<&RotationPrior>,
    ) -> Self {
        let errors = |one: BaselinePrediction| {
            let is_usable = one.is_usable();
            (one.baseline, is_usable.then_some(one.location_errors_mm))
        };
        let films = patient.compared.iter().filter(|film| PREDICTED.contains(&film.role));
        let with_others = |film: &'a PatientFilmUnderLines| {
            let (erect, from_top) = (&patient.links, patient.film_from_top(film.posture));
            let from_mean = from_top.zip(mean).map(|(film, pattern)| {
                errors(film.by_pattern(Baseline::OtherPatients, pattern, erect))
            });
            // One that was given was learned elsewhere and is kept; a published one gives way.
            let learned = prior.filter(|_| !patient.has_rotation_prior);
            let learned = learned.filter(|_| film.posture.bend().is_some());
            let from_prior = from_top.zip(learned).map_or_else(Vec::new, |(film, prior)| {
                let both = [Baseline::RotationPrior, Baseline::RotationPriorWithTilt];
                both.map(|one| errors(film.by_prior(one, prior, erect))).into()
            });
            let is_kept = |one: &&(Baseline, Option<Vec<f64>>)| {
                from_prior.iter().all(|(baseline, _)| *baseline != one.0)
            };
            let own = film.baselines_mm.iter().filter(is_kept).cloned();
            let baselines_mm = own.chain(from_mean).chain(from_prior.iter().cloned()).collect();
            PredictedFilm { film, baselines_mm }
        };
        Self { patient, predicted: films.map(with_others).collect() }
    }
}

/// What a cohort knows of the rotations of all patients but one.
pub(super) struct Others {
    sums: BendSums,
    priors: PriorsOfOthers,
}

impl Others {
    /// From the vertebrae and the bends of every patient, as if to the right.
    pub fn of(levels: &[Levels], bends: &[Vec<Vec<Angle>>]) -> Self {
        Self { sums: BendSums::of(levels, bends), priors: PriorsOfOthers::of(levels, bends) }
    }

    /// The patient at a place of the cohort.
    pub fn see<'a>(&self, patient: &'a CohortPatient, place: usize) -> Seen<'a> {
        let mean = self.sums.mean_of_others(patient.levels, &patient.bends);
        Seen::new(patient, mean.as_deref(), self.priors.of_patient(place, patient.levels))
    }
}

/// Sums of the rotations over the bends of all patients with the same vertebrae, as if all bent to the right.
struct BendSums {
    by_levels: Vec<(Levels, Vec<Angle>, usize)>,
}

impl BendSums {
    fn of(levels: &[Levels], bends: &[Vec<Vec<Angle>>]) -> Self {
        let mut by_levels: Vec<(Levels, Vec<Angle>, usize)> = Vec::new();
        for (&levels, bends) in levels.iter().zip(bends) {
            let place = by_levels.iter().position(|one| one.0 == levels).unwrap_or_else(|| {
                by_levels.push((levels, vec![Angle::ZERO; levels.joints()], 0));
                by_levels.len() - 1
            });
            let (_, sums, count) = &mut by_levels[place];
            *count += bends.len();
            for bend in bends {
                for (sum, rotation) in sums.iter_mut().zip(bend) {
                    *sum = *sum + *rotation;
                }
            }
        }
        Self { by_levels }
    }

    /// The mean over the bends of all other patients than one with these bends; `None` where there is none.
    fn mean_of_others(&self, levels: Levels, own: &[Vec<Angle>]) -> Option<Vec<Angle>> {
        let (_, sums, count) = self.by_levels.iter().find(|one| one.0 == levels)?;
        let others = count - own.len();
        let mean = |(joint, sum): (usize, &Angle)| {
            let of_own: f64 = own.iter().map(|bend| bend[joint].rad()).sum();
            Angle::from_rad((sum.rad() - of_own) / others as f64)
        };
        (others > 0).then(|| sums.iter().enumerate().map(mean).collect())
    }
}

/// For every group of patients and their vertebrae a prior from patients of other groups with the same vertebrae.
pub(super) struct PriorsOfOthers {
    groups: usize,
    /// `None` where the others are too few.
    known: Vec<(usize, Levels, Option<RotationPrior>)>,
}

impl PriorsOfOthers {
    /// From the vertebrae and the bends of every patient, as if to the right.
    pub fn of(levels: &[Levels], bends: &[Vec<Vec<Angle>>]) -> Self {
        let groups = levels.len().min(MAX_GROUPS);
        let mut known: Vec<(usize, Levels, Option<RotationPrior>)> = Vec::new();
        for (place, &own) in levels.iter().enumerate() {
            let group = place % groups;
            if known.iter().any(|one| one.0 == group && one.1 == own) {
                continue;
            }
            let others = levels.iter().zip(bends).enumerate();
            let others = others.filter(|(i, (levels, _))| i % groups != group && **levels == own);
            let others: Vec<&Vec<Vec<Angle>>> = others.map(|(_, (_, bends))| bends).collect();
            known.push((group, own, RotationPrior::learned(own, &others).ok()));
        }
        Self { groups, known }
    }

    /// That of the patient at a place of the cohort.
    pub fn of_patient(&self, place: usize, levels: Levels) -> Option<&RotationPrior> {
        let group = place % self.groups;
        self.known.iter().find(|one| one.0 == group && one.1 == levels)?.2.as_ref()
    }
}
