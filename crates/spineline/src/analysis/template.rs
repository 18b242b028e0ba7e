//! The sagittal profile of the patient beside a population's: the error of a model without the lateral film.

use super::{Analysis, Movement};
use crate::anatomy::{Level, SagittalProfile};
use crate::measure::LengthScale;
use crate::multibody::SpineModel;
use crate::number::fixed;
use crate::spatial::{Angle, Mat3};

/// A vertebra of the model that the lateral film shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileVertebra {
    /// Which one.
    pub level: Level,
    /// Its pitch in space, from both films.
    pub measured: Angle,
    /// Standard deviation of that.
    pub sd: Angle,
    /// Its pitch in the model of the erect film alone.
    pub template: Angle,
    /// Measured midpoint to the front of the base, and above it.
    pub place_mm: [f64; 2],
    /// Depth in the model of the erect film alone, likewise.
    pub template_depth_mm: f64,
}

/// The profile of a patient with a lateral film beside another one, such as a population's.
///
/// # Definition
/// The model of the erect film alone ([`SpineModel::from_outline`]) against the measured vertebrae ([`SpatialOutline`](crate::measure::SpatialOutline)): differences
/// of pitch at every vertebra, of the turn between neighbours at every joint whose two vertebrae the lateral film shows, and of
/// depth with the base in one place. Root mean squares hold the errors of the measurement too.
#[derive(Debug, Clone, PartialEq)]
pub struct TemplateError {
    /// The vertebrae, caudal first; at least two.
    pub vertebrae: Vec<ProfileVertebra>,
    /// Joints between two of them.
    pub joints: usize,
    /// Root mean square of the differences of turn at these joints.
    pub joint_rms: Angle,
    /// Root mean square of the differences of pitch.
    pub vertebra_rms: Angle,
    /// Root mean square of the differences of depth.
    pub depth_rms_mm: f64,
}

impl ProfileVertebra {
    /// Excess flexion in the other profile.
    #[must_use]
    pub fn error(&self) -> Angle {
        (self.template - self.measured).wrapped()
    }
}

impl TemplateError {
    /// Errors of a profile in this patient; `None` without a lateral film.
    #[must_use]
    pub fn of(movement: &Movement, profile: &SagittalProfile) -> Option<Self> {
        let space = movement.space.as_ref()?;
        let alone = SpineModel::from_outline(&movement.erect().outline, profile);
        let places = movement.spine.midpoints_mm.iter().zip(&alone.midpoints_mm).zip(&alone.axes);
        let vertebrae: Vec<ProfileVertebra> = movement
            .levels()
            .iter()
            .zip(places)
            .filter_map(|(level, ((place, template_place), axes))| {
                let seen = space.vertebra(level)?;
                Some(ProfileVertebra {
                    level,
                    measured: seen.orientation.pitch,
                    sd: space.pitch_sd(seen),
                    template: pitch_of(axes),
                    place_mm: [place.x, place.z],
                    template_depth_mm: template_place.x,
                })
            })
            .collect();
        let joints: Vec<f64> = vertebrae
            .windows(2)
            .filter(|pair| pair[0].level.next_above() == Some(pair[1].level))
            .map(|pair| (pair[1].error() - pair[0].error()).wrapped().rad())
            .collect();
        if joints.is_empty() {
            return None;
        }
        Some(Self {
            joints: joints.len(),
            joint_rms: Angle::from_rad(rms(joints)),
            vertebra_rms: Angle::from_rad(rms(vertebrae.iter().map(|v| v.error().rad()))),
            depth_rms_mm: rms(vertebrae.iter().map(|v| v.template_depth_mm - v.place_mm[0])),
            vertebrae,
        })
    }

    /// The vertebra whose pitch is most wrong, and by how much.
    #[must_use]
    pub fn worst(&self) -> (Level, Angle) {
        let off = |vertebra: &ProfileVertebra| (vertebra.level, vertebra.error().abs());
        let first = off(&self.vertebrae[0]);
        self.vertebrae.iter().map(off).fold(
            first,
            |most, one| {
                if one.1 > most.1 { one } else { most }
            },
        )
    }

    /// In words; `scale` belongs to the erect film.
    #[must_use]
    pub fn words(&self, scale: &LengthScale) -> String {
        let (level, worst) = self.worst();
        let depth = scale.mm(self.depth_rms_mm).map_or_else(String::new, |mm| {
            format!(", and by {} mm in its depth (root mean square)", fixed(mm, 1))
        });
        format!(
            "Without the lateral film the model would have the profile of a population, with the top above the base. It is wrong by {} at a joint (root mean square, {} joints), by {} in the pitch of a vertebra (root mean square; {worst} at {level}){depth}.",
            self.joint_rms, self.joints, self.vertebra_rms
        )
    }
}

impl Analysis {
    /// Errors of the population's profile in this patient; `None` without a lateral film.
    ///
    /// Computed on request, because no other result depends on it.
    #[must_use]
    pub fn template_error(&self) -> Option<TemplateError> {
        TemplateError::of(&self.movement, &SagittalProfile::default())
    }
}

/// Angle of the cranial axis from the frontal plane, flexion positive ([`Orientation`](crate::spatial::Orientation)).
fn pitch_of(axes: &Mat3) -> Angle {
    let cranial = axes.column(2);
    Angle::from_sin_cos(cranial.x, cranial.y.hypot(cranial.z))
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for value in values {
        squares += value * value;
        count += 1.0;
    }
    (squares / count).sqrt()
}
