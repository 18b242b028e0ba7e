//! A stored model as bodies, joint frames and hinges in SI units, for all formats.

use spineline::analysis::{AxialSource, PersonalisedModel, PitchSource};
use spineline::anatomy::Morphometry;
use spineline::multibody::Support;
use spineline::spatial::{Angle, Mat3, Vec3};

use super::films::{Film, films};
use super::format::{ExportError, ExportFormat};
use super::nominal::Nominal;
use super::rotation::body_xyz;

/// The three hinges of a joint, in the order in which they follow one another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axis {
    /// About the anterior axis.
    Lateral,
    /// About the left axis.
    Flexion,
    /// About the cranial axis.
    Axial,
}

impl Axis {
    const ALL: [Self; 3] = [Self::Lateral, Self::Flexion, Self::Axial];

    /// Its word in names.
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Lateral => "lateral",
            Self::Flexion => "flexion",
            Self::Axial => "axial",
        }
    }

    /// The axis in the inferior vertebra.
    pub(super) fn unit(self) -> Vec3 {
        match self {
            Self::Lateral => Vec3::x(),
            Self::Flexion => Vec3::y(),
            Self::Axial => Vec3::z(),
        }
    }
}

/// Whether a support lets a hinge turn.
const fn turns(support: Support, axis: Axis) -> bool {
    match support {
        Support::Free => true,
        Support::Frontal => matches!(axis, Axis::Lateral),
    }
}

/// One hinge with its spring.
#[derive(Debug)]
pub(super) struct Hinge {
    /// Unique, such as `L4_L3_lateral`.
    pub(super) name: String,
    pub(super) axis: Axis,
    pub(super) nm_per_rad: f64,
    /// Whether the support locks it.
    pub(super) locked: bool,
}

/// A joint: three hinges at one centre.
#[derive(Debug)]
pub(super) struct Joint {
    /// Inferior and superior vertebra, such as `L4_L3`.
    pub(super) name: String,
    /// Centre in the inferior vertebra.
    pub(super) centre_in_inferior_m: Vec3,
    /// Centre in the superior vertebra.
    pub(super) centre_in_superior_m: Vec3,
    /// From the centre to the superior midpoint in the inferior vertebra's axes, erect.
    pub(super) rise_m: Vec3,
    /// The superior vertebra's axes in the inferior vertebra's, erect.
    pub(super) inferior_from_superior: Mat3,
    /// In series: lateral, flexion, axial.
    pub(super) hinges: Vec<Hinge>,
}

impl Joint {
    /// The hinges that are not locked.
    pub(super) fn free(&self) -> impl Iterator<Item = &Hinge> {
        self.hinges.iter().filter(|hinge| !hinge.locked)
    }

    /// Of every hinge in rad/(N·m); zero where it is locked.
    fn compliances(&self) -> Vec<f64> {
        let of = |hinge: &Hinge| if hinge.locked { 0.0 } else { 1.0 / hinge.nm_per_rad };
        self.hinges.iter().map(of).collect()
    }

    /// The inferior vertebra's axes in the superior vertebra's, erect.
    pub(super) fn superior_from_inferior(&self) -> Mat3 {
        self.inferior_from_superior.transpose()
    }
}

/// A vertebra.
#[derive(Debug)]
pub(super) struct Vertebra {
    pub(super) name: &'static str,
    /// Midpoint in `G`, erect.
    pub(super) midpoint_m: Vec3,
    /// Axes in `G`, erect.
    pub(super) axes: Mat3,
    /// Drawn size: depth, width and height.
    pub(super) size_m: Vec3,
    /// Drawn height of the disc above.
    pub(super) disc_m: f64,
    /// Where pitch and depth come from.
    pub(super) pitch_from: Option<PitchSource>,
    /// Where the axial rotation comes from.
    pub(super) axial_from: Option<AxialSource>,
    /// Whether the drawn width is the patient's.
    pub(super) width_is_measured: bool,
}

impl Vertebra {
    /// Lateral tilt, pitch and axial rotation in degrees, erect: turns about the anterior axis (positive to the patient's right),
    /// then the left one (flexion positive), then the cranial one (front to the patient's left positive), as in
    /// [`Orientation`](spineline::spatial::Orientation).
    pub(super) fn angles_deg(&self) -> [f64; 3] {
        let rad = body_xyz(&self.axes);
        [rad.x, rad.y, rad.z].map(|rad| Angle::from_rad(rad).deg())
    }
}

/// The whole spine; joint `i` lies between vertebrae `i` and `i + 1`.
#[derive(Debug)]
pub(super) struct Assembly {
    pub(super) vertebrae: Vec<Vertebra>,
    pub(super) joints: Vec<Joint>,
    pub(super) films: Vec<Film>,
    pub(super) nominal: Nominal,
}

impl Assembly {
    /// Joins the vertebrae of a model, and refuses springs that no engine can represent.
    pub(super) fn of(
        model: &PersonalisedModel,
        vertebrae: Vec<Vertebra>,
        format: ExportFormat,
    ) -> Result<Self, ExportError> {
        let joints = (0..model.spine.joints.len()).map(|j| joint(model, j, format));
        let joints: Vec<Joint> = joints.collect::<Result<_, _>>()?;
        let compliances: Vec<Vec<f64>> = joints.iter().map(Joint::compliances).collect();
        Ok(Self { vertebrae, films: films(model)?, nominal: Nominal::of(&compliances), joints })
    }
}

/// The vertebrae of a model, from the lowest.
pub(super) fn vertebrae(model: &PersonalisedModel) -> Result<Vec<Vertebra>, ExportError> {
    let spine = &model.spine;
    assert_eq!(model.levels.len(), spine.midpoints_mm.len(), "every vertebra has its level");
    let mut vertebrae = Vec::new();
    for (i, &level) in model.levels.iter().enumerate() {
        if model.levels[..i].contains(&level) {
            return Err(ExportError::LevelTwice { level });
        }
        let scale = drawn_scale(model, i);
        let typical = Morphometry::of(level);
        vertebrae.push(Vertebra {
            name: level.name(),
            midpoint_m: spine.midpoints_mm[i] / 1000.0,
            axes: spine.axes[i],
            size_m: Vec3::new(
                scale * typical.superior_depth_mm,
                model.widths_mm[i].unwrap_or(scale * typical.superior_width_mm),
                scale * typical.body_height_mm,
            ) / 1000.0,
            disc_m: typical.disc_above_mm * scale / 1000.0,
            pitch_from: model.pitch_from[i],
            axial_from: model.axial_from[i],
            width_is_measured: model.widths_mm[i].is_some(),
        });
    }
    Ok(vertebrae)
}

fn joint(model: &PersonalisedModel, j: usize, format: ExportFormat) -> Result<Joint, ExportError> {
    let stored = &model.spine.joints[j];
    let name = format!("{}_{}", model.levels[j], model.levels[j + 1]);
    let from_inferior = stored.inferior_from_superior.transpose();
    Ok(Joint {
        hinges: hinges(model, j, &name, format)?,
        name,
        centre_in_inferior_m: stored.centre_in_inferior_mm / 1000.0,
        centre_in_superior_m: from_inferior * -stored.rise_in_inferior_mm / 1000.0,
        rise_m: stored.rise_in_inferior_mm / 1000.0,
        inferior_from_superior: stored.inferior_from_superior,
    })
}

/// Three uncoupled springs: the formats have no others.
fn hinges(
    model: &PersonalisedModel,
    j: usize,
    joint: &str,
    format: ExportFormat,
) -> Result<Vec<Hinge>, ExportError> {
    let (inferior, superior) = (model.levels[j], model.levels[j + 1]);
    let matrix = &model.stiffness[j];
    if Mat3::from_diagonal(&matrix.diagonal()) != *matrix {
        return Err(ExportError::Coupled { format, inferior, superior });
    }
    let springs = Axis::ALL.into_iter().zip([matrix[(0, 0)], matrix[(1, 1)], matrix[(2, 2)]]);
    springs
        .map(|(axis, nmm_per_rad)| {
            if !(nmm_per_rad > 0.0 && nmm_per_rad.is_finite()) {
                return Err(ExportError::Spring {
                    inferior,
                    superior,
                    axis: axis.word(),
                    value: nmm_per_rad,
                });
            }
            Ok(Hinge {
                name: format!("{joint}_{}", axis.word()),
                axis,
                nm_per_rad: nmm_per_rad / 1000.0,
                locked: !turns(model.support, axis),
            })
        })
        .collect()
}

/// The patient's size over a typical one, from the distance to the neighbouring vertebra. For drawing only.
fn drawn_scale(model: &PersonalisedModel, vertebra: usize) -> f64 {
    let joints = model.spine.joints.len();
    if joints == 0 {
        return 1.0;
    }
    let below = vertebra.min(joints - 1);
    let places = &model.spine.midpoints_mm;
    let spacing_mm = (places[below + 1] - places[below]).norm();
    spacing_mm / Morphometry::spacing_mm(model.levels[below], model.levels[below + 1])
}
