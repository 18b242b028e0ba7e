//! The evidence of one film on every joint, before any model is fitted.

use nalgebra::DMatrix;

use crate::anatomy::{Level, Levels};
use crate::measure::Outline;
use crate::multibody::{Load, SpineModel, StiffnessLibrary, disc_mm};
use crate::spatial::{Angle, Frontal, Vec3};

/// One joint on one film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointEvidence {
    /// Change of the angle between the two vertebrae from the erect film; positive turns the upper one to the right.
    pub rotation: Angle,
    /// The part of it by which the nominal springs relax without the weight that they carry in the erect posture.
    pub unloading: Angle,
    /// Centre of the joint on the film.
    pub centre_mm: Vec3,
    /// Across the disc: along the line between the midpoints, as long as the disc is thick.
    pub disc_mm: Frontal,
    /// From the centre of a hinge to the centre of a joint that bends uniformly between the two midpoints.
    pub to_evener_mm: Frontal,
    /// Lateral hinge axis on the film.
    pub hinge: Vec3,
    /// Nominal lateral compliance, as it shows on the film.
    pub compliance_rad_per_nmm: f64,
}

impl JointEvidence {
    /// The rotation by the load of the film.
    #[must_use]
    pub fn rotation_by_load(&self) -> Angle {
        self.rotation - self.unloading
    }
}

/// A film's joints.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmEvidence {
    /// Joints, caudal first.
    pub joints: Vec<JointEvidence>,
    /// The vertebrae that the joints connect.
    pub levels: Levels,
    /// Their midpoints on the film.
    pub midpoints_mm: Vec<Vec3>,
    /// Errors of the tilts on the film.
    pub tilts: TiltErrors,
    /// The same on the erect film.
    pub erect_tilts: TiltErrors,
    /// Variance of the rotation of every joint by the noise of readings, alike at all levels: the weights of starts, in rad².
    pub repeated_variances: Vec<f64>,
}

/// Errors of the tilts of all vertebrae of a film.
#[derive(Debug, Clone, PartialEq)]
pub struct TiltErrors {
    /// Their covariance, in rad².
    pub covariance: DMatrix<f64>,
    /// Degrees of freedom of the variance, where readings show it.
    pub degrees_of_freedom: Option<usize>,
}

impl TiltErrors {
    fn of(film: &Outline) -> Self {
        Self {
            covariance: film.tilt_error_covariance(),
            degrees_of_freedom: film.noise.tilt_degrees_of_freedom,
        }
    }

    /// Independent errors of one standard deviation.
    #[cfg(test)]
    pub fn alike(vertebrae: usize, sd: Angle, degrees_of_freedom: Option<usize>) -> Self {
        let covariance = DMatrix::from_diagonal_element(vertebrae, vertebrae, sd.rad().powi(2));
        Self { covariance, degrees_of_freedom }
    }
}

/// Variance of the difference of two neighbours' tilts.
fn of_joint(covariance: &DMatrix<f64>, joint: usize) -> f64 {
    let at = |i, j| covariance[(joint + i, joint + j)];
    at(0, 0) + at(1, 1) - 2.0 * at(0, 1)
}

/// A joint that turns against the moment of the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContradictedJoint {
    /// Lower vertebra.
    pub inferior: Level,
    /// Upper vertebra.
    pub superior: Level,
    /// Measured rotation by the load.
    pub rotation: Angle,
    /// Lever arm of the force about the joint, signed so that a positive one would turn it the measured way.
    pub lever_arm_mm: f64,
    /// Its part in the work `Σ |rotation × lever arm|` of all joints.
    pub weight: f64,
    /// Whether the rotation is beyond two standard deviations of its measurement.
    pub beyond_noise: bool,
    /// That standard deviation.
    pub rotation_sd: Angle,
}

impl FilmEvidence {
    /// Measures rotations, centres and hinge axes.
    #[must_use]
    pub fn measure(
        model: &SpineModel,
        library: &StiffnessLibrary,
        erect: &Outline,
        film: &Outline,
    ) -> Self {
        let (midpoints, axes) = model.posed_on_film(film, erect);
        let levels = film.levels();
        let moved = |i: usize| film.vertebrae[i].tilt - erect.vertebrae[i].tilt;
        let joints = model
            .joints
            .iter()
            .zip(library.rows())
            .enumerate()
            .map(|(j, (joint, row))| {
                let mut hinge: Vec3 = axes[j].column(0).into();
                if row.axial_per_lateral != 0.0 {
                    // For small turns a coupled joint is a hinge about this vector.
                    hinge += axes[j].column(2) * row.axial_per_lateral;
                }
                let centre_mm = midpoints[j] + axes[j] * joint.centre_in_inferior_mm;
                let [inferior, superior] = [j, j + 1].map(|i| film.vertebrae[i].location);
                let spacing_mm = (superior - inferior).norm_mm();
                let along = (superior - inferior) * (1.0 / spacing_mm);
                let centre = Frontal::new(centre_mm.y, centre_mm.z);
                let on_chord = inferior + along * (centre - inferior).dot(along);
                // A hinge that is pitched out of the film shows only a part of its turn.
                let compliance_rad_per_nmm = hinge.x / row.nmm_per_rad[0];
                let erect_nmm = &joint.erect_moment_nmm;
                let carried_nmm = erect_nmm.x + row.axial_per_lateral * erect_nmm.z;
                JointEvidence {
                    rotation: moved(j + 1) - moved(j),
                    unloading: Angle::from_rad(-compliance_rad_per_nmm * carried_nmm),
                    centre_mm,
                    disc_mm: along * disc_mm(film.vertebrae[j].level, spacing_mm),
                    // Tangents at the ends of an arc meet three times as far from its chord as the arc is on the mean.
                    to_evener_mm: (on_chord - centre) * (2.0 / 3.0),
                    hinge,
                    compliance_rad_per_nmm,
                }
            })
            .collect();
        let repeated = [film, erect].map(Outline::tilt_covariance);
        let repeated_variance =
            |joint| repeated.iter().map(|tilts| of_joint(tilts, joint)).sum::<f64>();
        Self {
            repeated_variances: (0..model.joints.len()).map(repeated_variance).collect(),
            joints,
            levels,
            midpoints_mm: midpoints,
            tilts: TiltErrors::of(film),
            erect_tilts: TiltErrors::of(erect),
        }
    }

    /// Standard deviation of the rotation of one joint.
    #[must_use]
    pub fn joint_rotation_sd(&self, joint: usize) -> Angle {
        let tilts = [&self.tilts, &self.erect_tilts];
        let variances = tilts.map(|tilts| of_joint(&tilts.covariance, joint));
        Angle::from_rad(variances.iter().sum::<f64>().sqrt())
    }

    /// Weight of one joint's rotation: 1, or less next to an interpolated vertebra.
    #[must_use]
    pub(crate) fn joint_weight(&self, joint: usize) -> f64 {
        self.rotation_sd().rad().powi(2) / self.repeated_variances[joint]
    }

    /// Standard deviation of the best known rotation, by the noise of readings.
    #[must_use]
    pub fn rotation_sd(&self) -> Angle {
        let least = self.repeated_variances.iter().copied().fold(f64::INFINITY, f64::min);
        Angle::from_rad(least.sqrt())
    }

    /// Nominal rotation of every joint per unit of each component of a load.
    #[must_use]
    pub fn responses(&self, load: &Load) -> Vec<[f64; 3]> {
        let units = load.units_on_film();
        self.joints
            .iter()
            .map(|joint| {
                units.map(|unit| {
                    let moment = unit.moment_nmm - joint.centre_mm.cross(&unit.force_n);
                    joint.compliance_rad_per_nmm * moment.dot(&joint.hinge)
                })
            })
            .collect()
    }

    /// Their change by a shift of every joint's centre.
    pub(super) fn shifted_responses(
        &self,
        shift_mm: impl Fn(&JointEvidence) -> Frontal,
    ) -> Vec<[f64; 3]> {
        let of_joint = |joint: &JointEvidence| {
            // The moment about a point falls with fz to the left and grows with fy upwards.
            let shift = shift_mm(joint);
            let turn_rad_per_nmm = joint.compliance_rad_per_nmm * joint.hinge.x;
            [shift.z_mm, -shift.y_mm, 0.0].map(|part| part * turn_rad_per_nmm)
        };
        self.joints.iter().map(of_joint).collect()
    }

    /// Joints that turn against the moment of a load: no positive stiffness explains them. Lever arms are of a planar load.
    ///
    /// `responses` are per unit of each component, as from [`FilmEvidence::responses`].
    #[must_use]
    pub fn contradicted(
        &self,
        responses: &[[f64; 3]],
        components: [f64; 3],
    ) -> Vec<ContradictedJoint> {
        let force = components[0]
            .hypot(components[1])
            .max(components[2].abs() * 1e-9)
            .max(f64::MIN_POSITIVE);
        // Moment per unit of force that would turn each joint to the right.
        let arms: Vec<f64> = responses
            .iter()
            .zip(&self.joints)
            .map(|(r, joint)| {
                let turn: f64 = r.iter().zip(components).map(|(r, c)| r * c).sum();
                turn / joint.compliance_rad_per_nmm / force
            })
            .collect();
        let turn = |j: usize| self.joints[j].rotation_by_load();
        let work = |j: usize| (arms[j] * turn(j).rad()).abs();
        let total: f64 = (0..arms.len()).map(work).sum();
        (0..arms.len())
            // A joint that turns only by rounding does not contradict the load.
            .filter(|&j| arms[j] * turn(j).rad() < -1e-9 * total)
            .map(|j| {
                let rotation = turn(j);
                ContradictedJoint {
                    inferior: self.levels.as_slice()[j],
                    superior: self.levels.as_slice()[j + 1],
                    rotation,
                    lever_arm_mm: arms[j] * rotation.rad().signum(),
                    weight: work(j) / total,
                    beyond_noise: rotation.abs() > self.joint_rotation_sd(j) * 2.0,
                    rotation_sd: self.joint_rotation_sd(j),
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_centre_changes_responses_as_a_shifted_centre_does() {
        // Oracle: the responses with the centre moved; a hinge that is pitched out of the film.
        let shift = Frontal::new(0.7, -1.3);
        let joint = JointEvidence {
            rotation: Angle::ZERO,
            unloading: Angle::ZERO,
            centre_mm: Vec3::new(5.0, 20.0, 150.0),
            disc_mm: shift,
            to_evener_mm: Frontal::default(),
            hinge: Vec3::new(0.8, 0.0, 0.6),
            compliance_rad_per_nmm: 1e-5,
        };
        let film = |joint| FilmEvidence {
            joints: vec![joint],
            levels: Levels::between(Level::L4, Level::L3).expect("neighbours"),
            midpoints_mm: Vec::new(),
            tilts: TiltErrors::alike(2, Angle::from_deg(0.5), None),
            erect_tilts: TiltErrors::alike(2, Angle::from_deg(0.5), None),
            repeated_variances: Vec::new(),
        };
        let load = Load::Frontal { depth_mm: 0.0 };
        let before = film(joint).responses(&load)[0];
        let centre_mm = joint.centre_mm + Vec3::new(0.0, shift.y_mm, shift.z_mm);
        let after = film(JointEvidence { centre_mm, ..joint }).responses(&load)[0];
        let predicted = film(joint).shifted_responses(|joint| joint.disc_mm)[0];
        for part in 0..3 {
            assert!((after[part] - before[part] - predicted[part]).abs() < 1e-15, "{part}");
        }
    }
}
