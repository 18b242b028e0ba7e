use nalgebra::DMatrix;

use crate::anatomy::{Level, Morphometry, SagittalProfile};
use crate::measure::{MeasuredVertebra, Noise, Outline, SpatialOutline, SpatialVertebra};
use crate::spatial::{Angle, Frontal, Mat3, Vec3, rotation_x, rotation_y, rotation_z};

/// One joint, fixed in its inferior vertebra.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Centre, from the inferior vertebra's midpoint, in that vertebra's axes.
    pub centre_in_inferior_mm: Vec3,
    /// The superior vertebra's midpoint in the erect posture, from the centre, in the inferior vertebra's axes.
    pub rise_in_inferior_mm: Vec3,
    /// The superior vertebra's axes in the erect posture, in the inferior vertebra's axes.
    pub inferior_from_superior: Mat3,
    /// Moments of its springs about x, y and z in the erect posture; zero where they are unstressed.
    pub erect_moment_nmm: Vec3,
}

/// The unloaded spine of one patient: vertebrae in the erect posture, and the joints between them.
///
/// ```
/// use spineline::anatomy::SagittalProfile;
/// use spineline::measure::{TiltRule, measure_film};
/// use spineline::multibody::SpineModel;
/// use spineline::warning::Warnings;
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
/// let erect = measure_film(&case.films[0], TiltRule::default(), &mut Warnings::default())?;
/// let model = SpineModel::from_outline(&erect, &SagittalProfile::default());
/// assert_eq!((model.midpoints_mm.len(), model.joints.len()), (15, 14));
/// // The film gives the frontal location of every vertebra.
/// let top = erect.vertebrae[14].location;
/// assert!((model.midpoints_mm[14].y - top.y_mm).abs() < 1e-9);
/// assert!((model.midpoints_mm[14].z - top.z_mm).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SpineModel {
    /// Midpoints in `G`, from the fixed base (L4) upwards.
    pub midpoints_mm: Vec<Vec3>,
    /// Axes in `G`: columns are anterior, left and cranial of the vertebra.
    pub axes: Vec<Mat3>,
    /// Joints, one fewer than vertebrae.
    pub joints: Vec<Joint>,
    /// Standard deviations of vertebrae that the erect film does not show, or whose corners a program found there, beyond landmark
    /// noise.
    pub uncertain: Vec<Option<Noise>>,
    /// Covariance of the same errors over all vertebrae, with the errors of the frame: left, cranial and tilt of each, in
    /// mm and rad. `None` where they are independent.
    pub shared_errors: Option<DMatrix<f64>>,
}

impl SpineModel {
    /// Builds the three-dimensional spine from the erect film and a sagittal profile.
    ///
    /// The film gives `y`, `z` and tilt of every vertebra. The profile gives pitch differences; L4's own pitch is the
    /// one that puts T2 above L4, and `x` follows from the pitches. Depths and body heights are typical ones, scaled to
    /// the distances that the film shows.
    ///
    /// # Assumption
    /// The sagittal profile is a population's, not the patient's, unless a lateral film replaces it.
    #[must_use]
    pub fn from_outline(erect: &Outline, profile: &SagittalProfile) -> Self {
        let levels = erect.levels();
        let locations: Vec<Frontal> = erect.locations().collect();
        let first = levels.first_joint();
        let pitches = pitches(&locations, &profile.turns_deg[first..first + levels.joints()]);
        let x_mm: Vec<f64> = depths_mm(&locations, |i| pitches[i]).collect();
        Self::standing(erect, profile, &pitches, &x_mm)
    }

    /// Builds the spine as the erect and the lateral film show it.
    ///
    /// The frontal film gives `y`, `z` and tilt of every vertebra, the lateral film pitch and `x` of those that it shows. The others have
    /// the turns of `profile` from their neighbours; between two that are shown, what is left over is spread evenly over the joints.
    /// Axial rotations come from `profile`. Joints are placed as by [`SpineModel::from_outline`].
    ///
    /// # Frames
    /// `G` is the frame of the films, turned about x by the tilt of the base. `x`, pitch and axial rotation are the same in both.
    ///
    /// # Assumption
    /// As for [`SpatialOutline`]: the erect film hangs upright. An error of the turn of the lateral film turns the whole spine about y.
    #[must_use]
    pub fn in_space(erect: &Outline, profile: &SagittalProfile, space: &SpatialOutline) -> Self {
        let levels = erect.levels();
        let seen: Vec<_> = levels.iter().map(|level| space.vertebra(level)).collect();
        let profile = space.profile(profile);
        let locations: Vec<Frontal> = erect.locations().collect();
        let first = levels.first_joint();
        let mut pitches = pitches(&locations, &profile.turns_deg[first..first + levels.joints()]);
        let off = |(seen, pitch): (&Option<&SpatialVertebra>, &Angle)| {
            seen.map(|vertebra| (vertebra.orientation.pitch - *pitch).wrapped().rad())
        };
        let missing: Vec<Option<f64>> = seen.iter().zip(&pitches).map(off).collect();
        for (pitch, more_rad) in pitches.iter_mut().zip(spread(&missing)) {
            *pitch = *pitch + Angle::from_rad(more_rad);
        }
        let mut x_mm: Vec<f64> = depths_mm(&locations, |i| pitches[i]).collect();
        let off = |(seen, x_mm): (&Option<&SpatialVertebra>, &f64)| {
            seen.map(|vertebra| vertebra.place_mm.x - x_mm)
        };
        let missing: Vec<Option<f64>> = seen.iter().zip(&x_mm).map(off).collect();
        let more_mm = spread(&missing);
        // The origin is the base.
        for (x_mm, more) in x_mm.iter_mut().zip(&more_mm) {
            *x_mm += more - more_mm[0];
        }
        Self::standing(erect, &profile, &pitches, &x_mm)
    }

    /// Vertebrae of the erect film with these pitches and depths.
    fn standing(
        erect: &Outline,
        profile: &SagittalProfile,
        pitches: &[Angle],
        x_mm: &[f64],
    ) -> Self {
        let levels = erect.levels();
        let midpoints_mm: Vec<Vec3> =
            erect.locations().zip(x_mm).map(|(p, &x)| Vec3::new(x, p.y_mm, p.z_mm)).collect();
        let axes: Vec<Mat3> = erect
            .vertebrae
            .iter()
            .zip(pitches)
            .zip(&profile.axial_deg[levels.first_joint()..])
            .map(|((v, &pitch), &axial)| {
                rotation_x(v.tilt) * rotation_y(pitch) * rotation_z(Angle::from_deg(axial))
            })
            .collect();
        let offsets: Vec<Vec3> = levels
            .iter()
            .zip(midpoints_mm.windows(2))
            .map(|(inferior, pair)| centre_offset_mm(inferior, (pair[1] - pair[0]).norm()))
            .collect();
        let uncertain = erect.vertebrae.iter().map(MeasuredVertebra::own_noise).collect();
        let shared_errors = erect.model_covariance();
        Self { uncertain, shared_errors, ..Self::from_poses(midpoints_mm, axes, &offsets) }
    }

    /// Joins vertebrae by joints whose centres are given in the axes of the inferior vertebra.
    ///
    /// # Panics
    /// If the number of centres is not one less than the number of vertebrae.
    #[must_use]
    pub fn from_poses(
        midpoints_mm: Vec<Vec3>,
        axes: Vec<Mat3>,
        centres_in_inferior_mm: &[Vec3],
    ) -> Self {
        assert!(
            midpoints_mm.len() == axes.len() && centres_in_inferior_mm.len() + 1 == axes.len(),
            "one joint between each two vertebrae"
        );
        let joints = centres_in_inferior_mm
            .iter()
            .enumerate()
            .map(|(i, &centre_in_inferior_mm)| {
                let inferior_from_global = axes[i].transpose();
                Joint {
                    centre_in_inferior_mm,
                    rise_in_inferior_mm: inferior_from_global
                        * (midpoints_mm[i + 1] - midpoints_mm[i])
                        - centre_in_inferior_mm,
                    inferior_from_superior: inferior_from_global * axes[i + 1],
                    erect_moment_nmm: Vec3::zeros(),
                }
            })
            .collect();
        let uncertain = vec![None; midpoints_mm.len()];
        Self { uncertain, shared_errors: None, midpoints_mm, axes, joints }
    }

    /// The same spine with springs that balance forces on the midpoints above the base in the erect posture.
    ///
    /// # Definition
    /// With the forces `F_v` at the midpoints `p_v`, the joint with centre `c` has the moments `Σ (p_v - c) × F_v` over all vertebrae
    /// above it, in the axes of its inferior vertebra.
    ///
    /// # Assumption
    /// The muscles of the back balance the moment about the flexion hinge, whose spring is unstressed.
    #[must_use]
    pub fn carrying(mut self, forces_n: &[Vec3]) -> Self {
        let centres = self.joint_centres_mm(&self.midpoints_mm, &self.axes);
        for (j, (joint, centre)) in self.joints.iter_mut().zip(centres).enumerate() {
            let above = self.midpoints_mm[j + 1..].iter().zip(&forces_n[j..]);
            let moment: Vec3 = above.map(|(place, force)| (place - centre).cross(force)).sum();
            let moment = self.axes[j].transpose() * moment;
            joint.erect_moment_nmm = Vec3::new(moment.x, 0.0, moment.z);
        }
        self
    }

    /// Whether its springs carry anything in the erect posture.
    #[must_use]
    pub fn is_stressed(&self) -> bool {
        self.joints.iter().any(|joint| joint.erect_moment_nmm != Vec3::zeros())
    }

    /// Centres of the joints of vertebrae that stand like this, such as a shape under load.
    #[must_use]
    pub fn joint_centres_mm(&self, midpoints_mm: &[Vec3], axes: &[Mat3]) -> Vec<Vec3> {
        let vertebrae = midpoints_mm.iter().zip(axes);
        let centre = |(joint, (midpoint, axes)): (&Joint, (&Vec3, &Mat3))| {
            midpoint + axes * joint.centre_in_inferior_mm
        };
        self.joints.iter().zip(vertebrae).map(centre).collect()
    }

    /// The same vertebrae put where another film shows them: its locations and tilts, and the erect depths and pitches.
    ///
    /// Rotations and lever arms measured on that film are taken from this pose.
    #[must_use]
    pub fn posed_on_film(&self, film: &Outline, erect: &Outline) -> (Vec<Vec3>, Vec<Mat3>) {
        let vertebrae = film
            .vertebrae
            .iter()
            .zip(&erect.vertebrae)
            .zip(self.midpoints_mm.iter().zip(&self.axes));
        vertebrae
            .map(|((moved, still), (midpoint, axes))| {
                let place = Vec3::new(midpoint.x, moved.location.y_mm, moved.location.z_mm);
                (place, rotation_x(moved.tilt - still.tilt) * axes)
            })
            .unzip()
    }
}

/// Pitch of every vertebra: the profile's turns summed from L4, turned as a whole so that T2 stands above L4.
fn pitches(locations: &[Frontal], turns_deg: &[f64]) -> Vec<Angle> {
    let mut relative = vec![Angle::ZERO];
    for &turn in turns_deg {
        relative.push(relative[relative.len() - 1] + Angle::from_deg(turn));
    }
    let pitch = |i: usize, base_rad: f64| relative[i] + Angle::from_rad(base_rad);
    // T2's depth grows with L4's pitch: bisection between ±60°.
    let (mut low, mut high) = (Angle::from_deg(-60.0).rad(), Angle::from_deg(60.0).rad());
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if depths_mm(locations, |i| pitch(i, middle)).last().is_some_and(|depth| depth > 0.0) {
            high = middle;
        } else {
            low = middle;
        }
    }
    (0..relative.len()).map(|i| pitch(i, f64::midpoint(low, high))).collect()
}

/// Values where they are known; linear between these, constant beyond, zero where none is known.
fn spread(known: &[Option<f64>]) -> Vec<f64> {
    let at: Vec<(usize, f64)> =
        known.iter().enumerate().filter_map(|(i, value)| Some((i, (*value)?))).collect();
    let value = |i: usize| {
        let next = at.partition_point(|(place, _)| *place < i);
        match (next.checked_sub(1).map(|before| at[before]), at.get(next)) {
            (None, None) => 0.0,
            (None, Some((_, value))) => *value,
            (Some((_, value)), None) => value,
            (Some((low, from)), Some((high, to))) => {
                from + (to - from) * (i - low) as f64 / (high - low) as f64
            }
        }
    };
    (0..known.len()).map(value).collect()
}

/// Depth of every midpoint: the line between two midpoints has the mean pitch of its vertebrae.
fn depths_mm(locations: &[Frontal], pitch: impl Fn(usize) -> Angle) -> impl Iterator<Item = f64> {
    (0..locations.len()).scan(0.0, move |depth_mm, i| {
        if i > 0 {
            let mean = (pitch(i - 1) + pitch(i)) * 0.5;
            // Steeper than 75° only while searching for L4's pitch.
            let slope = mean.rad().clamp(-1.3, 1.3).tan();
            *depth_mm += locations[i].distance_mm(locations[i - 1]) * slope;
        }
        Some(*depth_mm)
    })
}

/// Centre of the joint above a vertebra: the posterior edge of its superior endplate, mid-width.
fn centre_offset_mm(inferior: Level, spacing_mm: f64) -> Vec3 {
    let lower = Morphometry::of(inferior);
    let scale = size_scale(inferior, spacing_mm);
    let half_lower = 0.5 * lower.body_height_mm;
    Vec3::new(-0.5 * lower.superior_depth_mm * scale, 0.0, half_lower * scale)
}

/// Thickness of the disc of a joint whose vertebrae have these midpoints.
pub(crate) fn disc_mm(inferior: Level, spacing_mm: f64) -> f64 {
    Morphometry::of(inferior).disc_above_mm * size_scale(inferior, spacing_mm)
}

/// Size of the vertebra below a joint and of the disc and half of the vertebra above it, against typical ones.
pub(super) fn size_scale(inferior: Level, spacing_mm: f64) -> f64 {
    let lower = Morphometry::of(inferior);
    let upper = Morphometry::of(inferior.next_above().unwrap_or(inferior));
    spacing_mm / (0.5 * lower.body_height_mm + lower.disc_above_mm + 0.5 * upper.body_height_mm)
}
