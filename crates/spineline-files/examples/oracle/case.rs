//! A spine that other programs have solved, from its file.

use serde_json::Value;
use spineline::action::{Application, LineOfAction};
use spineline::multibody::{BodyLoad, Load, SpineModel};
use spineline::spatial::{Angle, Frontal, Mat3, Vec3};

/// One spine, one load, one amplitude.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) model: SpineModel,
    pub(crate) stiffness_nmm_per_rad: Vec<[f64; 3]>,
    /// A force of one newton on the uppermost vertebra.
    pub(crate) direction: Vec3,
    pub(crate) application: Application,
    /// A point of a line fixed in space.
    pub(crate) point_mm: Vec3,
    /// Lateral tilt of the line from the lowest to the uppermost vertebra; right positive, while the file counts left.
    pub(crate) target: Angle,
    /// The whole file.
    pub(crate) json: Value,
}

impl Case {
    /// Reads a case from the text of its file.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let json: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let at = |path: &str| json.pointer(path).ok_or(format!("{path} is missing"));
        let vertebrae = list(at("/vertebrae")?)?;
        let joints = list(at("/joints")?)?;
        if vertebrae.len() != joints.len() + 1 || joints.is_empty() {
            return Err(format!("{} vertebrae and {} joints", vertebrae.len(), joints.len()));
        }
        let midpoints: Vec<Vec3> = collect(vertebrae, |v| vector(&v["midpoint_mm"]))?;
        let axes: Vec<Mat3> = collect(vertebrae, |v| matrix(&v["rotation"]))?;
        let centres: Vec<Vec3> = collect(joints, |joint| vector(&joint["position_mm"]))?
            .iter()
            .enumerate()
            .map(|(i, centre): (usize, &Vec3)| axes[i].transpose() * (centre - midpoints[i]))
            .collect();
        let stiffness_nmm_per_rad =
            collect(joints, |joint| vector(&joint["stiffness_Nmm_per_rad"]).map(Into::into))?;
        let top = midpoints[midpoints.len() - 1];
        let (application, point_mm) = match at("/load/type")?.as_str() {
            Some("A") => (Application::Fixed, vector(at("/load/point_mm")?)?),
            Some("B") => (Application::AtT2, top),
            other => return Err(format!("/load/type is {other:?}, and A and B are known")),
        };
        let direction = vector(at("/load/direction")?)?;
        let target = Angle::from_rad(-number(at("/target_amplitude_rad")?)?);
        let name = at("/name")?.as_str().unwrap_or("unnamed").to_owned();
        let model = SpineModel::from_poses(midpoints, axes, &centres);
        Ok(Self {
            name,
            model,
            stiffness_nmm_per_rad,
            direction,
            application,
            point_mm,
            target,
            json,
        })
    }

    /// The load for the march; `None` where it does not act in a frontal plane.
    pub(crate) fn frontal_load(&self) -> Option<Load> {
        if self.direction.x != 0.0 {
            return None;
        }
        let point = Frontal::new(self.point_mm.y, self.point_mm.z);
        let direction = Frontal::new(self.direction.y, self.direction.z);
        let line = LineOfAction { point, direction, application: self.application };
        Some(Load::along(line, self.point_mm.x))
    }

    /// The load for the general solver, of `force_n` newtons.
    pub(crate) fn body_load(&self, force_n: f64) -> BodyLoad {
        let force_n = self.direction * force_n;
        match self.application {
            Application::Fixed => BodyLoad::ForceOnLine { force_n, point_mm: self.point_mm },
            Application::AtT2 => BodyLoad::at_midpoint(force_n),
        }
    }
}

fn list(value: &Value) -> Result<&[Value], String> {
    value.as_array().map(Vec::as_slice).ok_or_else(|| format!("{value} is not a list"))
}

pub(crate) fn number(value: &Value) -> Result<f64, String> {
    value.as_f64().ok_or_else(|| format!("{value} is not a number"))
}

pub(crate) fn vector(value: &Value) -> Result<Vec3, String> {
    let numbers = collect(list(value)?, number)?;
    let [x, y, z] = numbers[..] else { return Err(format!("{value} has not three components")) };
    Ok(Vec3::new(x, y, z))
}

/// A matrix by rows.
fn matrix(value: &Value) -> Result<Mat3, String> {
    let rows = collect(list(value)?, vector)?;
    let [a, b, c] = &rows[..] else { return Err(format!("{value} has not three rows")) };
    Ok(Mat3::from_columns(&[*a, *b, *c]).transpose())
}

fn collect<T>(
    values: &[Value],
    read: impl Fn(&Value) -> Result<T, String>,
) -> Result<Vec<T>, String> {
    values.iter().map(read).collect()
}
