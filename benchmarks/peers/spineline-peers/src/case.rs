//! What all engines are given, as it stands in the file, and the core's types made from it.

use serde::{Deserialize, Serialize};
use spineline::action::{Application, LineOfAction};
use spineline::anatomy::{Level, Posture, Region};
use spineline::clinical::{RegionBounds, Regions};
use spineline::measure::{
    AmplitudeEnds, FilmLength, LengthScale, MeasuredVertebra, Noise, Outline, Placement,
    SpacingPlane,
};
use spineline::multibody::{
    Deformed, JointGroups, JointStiffness, Load, SpineModel, StiffnessLibrary,
};
use spineline::spatial::{Angle, Frontal, Mat3, Vec3};

/// The file.
#[derive(Debug, Serialize, Deserialize)]
pub struct Cases {
    /// What the numbers are, for whoever opens the file.
    pub about: String,
    /// One spine each.
    pub cases: Vec<Case>,
}

/// One spine with two bends. mm, N, N·mm/rad, rad; global axes X anterior, Y left, Z cranial, origin at L4.
#[derive(Debug, Serialize, Deserialize)]
pub struct Case {
    /// Name.
    pub name: String,
    /// L4…T2, erect and unloaded.
    pub vertebrae: Vec<Vertebra>,
    /// Joints between them, caudal first.
    pub joints: Vec<Joint>,
    /// Vertebrae at which every region starts, has its apex and ends.
    pub regions: [[usize; 3]; 3],
    /// The lateral stiffness of a region's joints over the nominal one: what the fit should find.
    pub multipliers: [f64; 3],
    /// Standard deviations by which a fit weighs its data.
    pub noise: CaseNoise,
    /// Left and right.
    pub bends: [Bend; 2],
    /// Where a fit may start.
    pub starts: Starts,
}

/// One vertebra.
#[derive(Debug, Serialize, Deserialize)]
pub struct Vertebra {
    /// Level.
    pub level: String,
    /// Midpoint.
    pub midpoint_mm: [f64; 3],
    /// Rows of the rotation matrix whose columns are the anterior, left and cranial axis.
    pub axes: [[f64; 3]; 3],
}

/// One joint: hinges x, y, z in series, along the axes of the inferior vertebra.
#[derive(Debug, Serialize, Deserialize)]
pub struct Joint {
    /// Centre in the erect spine.
    pub centre_mm: [f64; 3],
    /// Nominal stiffness about x, y and z.
    pub stiffness_nmm_per_rad: [f64; 3],
    /// Its region, 0 to 2.
    pub region: usize,
}

/// Standard deviations of data.
#[derive(Debug, Serialize, Deserialize)]
pub struct CaseNoise {
    /// Of a coordinate.
    pub location_mm: f64,
    /// Of a tilt.
    pub tilt_rad: f64,
}

/// One bend: a force on T2 along a line fixed in space, and the shape that it makes with the true springs.
#[derive(Debug, Serialize, Deserialize)]
pub struct Bend {
    /// A point of the line.
    pub point_mm: [f64; 3],
    /// Unit vector along which the force is positive.
    pub direction: [f64; 3],
    /// The force.
    pub force_n: f64,
    /// LateralTilt of the line L4→T2, right positive: `atan2(-y, z)`.
    pub lean_rad: f64,
    /// `y, z` of all midpoints.
    pub locations_mm: Vec<[f64; 2]>,
    /// `atan2(-c_y, c_z)` of every vertebra's cranial axis `c`.
    pub tilts_rad: Vec<f64>,
}

/// Starts of a fit.
#[derive(Debug, Serialize, Deserialize)]
pub struct Starts {
    /// Nominal springs, and the forces with which they reach both leans.
    pub nominal: Start,
    /// From measured rotations and lever arms.
    pub closed_form: Start,
}

/// One start.
#[derive(Debug, Serialize, Deserialize)]
pub struct Start {
    /// Logarithm of each region's multiplier.
    pub log_multipliers: [f64; 3],
    /// Force of each bend.
    pub forces_n: [f64; 2],
}

impl Case {
    /// The unloaded spine.
    pub fn model(&self) -> SpineModel {
        let midpoints: Vec<Vec3> =
            self.vertebrae.iter().map(|v| Vec3::from(v.midpoint_mm)).collect();
        let axes: Vec<Mat3> = self
            .vertebrae
            .iter()
            .map(|v| Mat3::from_fn(|row, column| v.axes[row][column]))
            .collect();
        let centres: Vec<Vec3> = (0..self.joints.len())
            .map(|j| axes[j].transpose() * (Vec3::from(self.joints[j].centre_mm) - midpoints[j]))
            .collect();
        SpineModel::from_poses(midpoints, axes, &centres)
    }

    /// The nominal springs.
    pub fn library(&self) -> StiffnessLibrary {
        let rows = Level::MODEL.windows(2).zip(&self.joints).map(|(pair, joint)| JointStiffness {
            inferior: pair[0],
            superior: pair[1],
            nmm_per_rad: joint.stiffness_nmm_per_rad,
            axial_per_lateral: 0.0,
            source: self.name.clone(),
        });
        StiffnessLibrary::from_rows(rows.collect()).expect("springs of a case are positive")
    }

    /// Its regions.
    pub fn regions(&self) -> Regions {
        Regions {
            bounds: std::array::from_fn(|i| {
                let [inferior, apex, superior] = self.regions[i];
                RegionBounds { region: Region::ALL[i], inferior, apex, superior }
            }),
            are_curves: true,
        }
    }

    /// Logarithms of the true multipliers.
    pub fn log_multipliers(&self) -> [f64; 3] {
        self.multipliers.map(f64::ln)
    }

    /// The true springs of every joint.
    pub fn stiffness(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.joints.iter().map(|joint| {
            let [x, y, z] = joint.stiffness_nmm_per_rad;
            [x * self.multipliers[joint.region], y, z]
        })
    }

    /// One multiplier per region.
    pub fn groups(&self) -> JointGroups {
        JointGroups::regional(&self.regions())
    }

    /// The erect spine as a film would show it.
    pub fn erect(&self) -> Outline {
        let model = self.model();
        let shape =
            Deformed { midpoints_mm: model.midpoints_mm, axes: model.axes, hinges_rad: Vec::new() };
        let all = 0..self.vertebrae.len();
        let places: Vec<Frontal> = all.clone().map(|i| shape.location(i)).collect();
        let tilts: Vec<f64> = all.map(|i| shape.tilt(i).rad()).collect();
        self.outline(Posture::Erect, &places, &tilts)
    }

    /// A bend as a film would show it.
    pub fn bend(&self, index: usize) -> Outline {
        let bend = &self.bends[index];
        let places: Vec<Frontal> =
            bend.locations_mm.iter().map(|&[y, z]| Frontal::new(y, z)).collect();
        let posture = [Posture::LeftBending, Posture::RightBending][index];
        self.outline(posture, &places, &bend.tilts_rad)
    }

    fn outline(&self, posture: Posture, places: &[Frontal], tilts_rad: &[f64]) -> Outline {
        let vertebrae = Level::MODEL
            .into_iter()
            .zip(places.iter().zip(tilts_rad))
            .map(|(level, (&location, &tilt))| {
                let placement = Placement::new(location, Angle::from_rad(tilt));
                MeasuredVertebra::of_mean(level, placement, 1)
            })
            .collect();
        Outline {
            posture,
            vertebrae,
            others: Vec::new(),
            iliac_normal: None,
            iliac_middle: None,
            vertical: None,
            l4_on_film: Angle::ZERO,
            l4_midpoint_on_film: Frontal::default(),
            amplitude_ends: AmplitudeEnds::default(),
            noise: Noise {
                location_mm: self.noise.location_mm,
                tilt: Angle::from_rad(self.noise.tilt_rad),
                tilt_degrees_of_freedom: None,
            },
            scale: LengthScale::stated(SpacingPlane::Patient, None),
            length: FilmLength::ERECT,
            readings: 1,
            shared_errors: None,
        }
    }
}

impl Bend {
    /// The load of a unit force.
    pub fn load(&self) -> Load {
        let [depth_mm, y, z] = self.point_mm;
        let [_, along_y, along_z] = self.direction;
        let line = LineOfAction {
            point: Frontal::new(y, z),
            direction: Frontal::new(along_y, along_z),
            application: Application::Fixed,
        };
        Load::along(line, depth_mm)
    }

    /// Its amplitude.
    pub fn lateral_tilt(&self) -> Angle {
        Angle::from_rad(self.lean_rad)
    }
}
