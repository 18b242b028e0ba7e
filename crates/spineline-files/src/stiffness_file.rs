use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::anatomy::Level;
use spineline::multibody::{JointStiffness, StiffnessLibrary};
use spineline::spatial::Angle;

use crate::FileError;
use crate::json::parse;

const FORMAT: &str = "spineline-stiffness";
const VERSION: u32 = 1;

/// The springs of the 14 joints before personalisation, each with its source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Spineline stiffness table, version 1")]
pub struct StiffnessFile {
    /// `spineline-stiffness`.
    format: String,
    /// 1.
    version: u32,
    /// One row per joint, in any order.
    joints: Vec<JointRow>,
}

/// Rotational stiffness about the inferior vertebra's axes, in N·m per radian.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct JointRow {
    inferior: Level,
    superior: Level,
    lateral_nm_per_rad: f64,
    flexion_nm_per_rad: f64,
    axial_nm_per_rad: f64,
    /// Axial rotation (front to the left) per lateral rotation (to the right) under a pure lateral moment, with free support; absent without
    /// coupling.
    #[serde(default, skip_serializing_if = "is_zero")]
    axial_per_lateral: f64,
    /// Publication or measurement that the values come from.
    source: String,
}

/// Reads a stiffness table from the text of its file.
pub fn parse_stiffness(text: &str) -> Result<StiffnessLibrary, FileError> {
    parse::<StiffnessFile>(text, FORMAT, VERSION)?.library()
}

impl StiffnessFile {
    /// The springs that this file holds.
    pub(crate) fn library(self) -> Result<StiffnessLibrary, FileError> {
        let rows = self.joints.into_iter().map(|row| JointStiffness {
            inferior: row.inferior,
            superior: row.superior,
            nmm_per_rad: [row.lateral_nm_per_rad, row.flexion_nm_per_rad, row.axial_nm_per_rad]
                .map(newton_millimetres),
            axial_per_lateral: row.axial_per_lateral,
            source: row.source,
        });
        Ok(StiffnessLibrary::from_rows(rows.collect())?)
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn newton_millimetres(newton_metres: f64) -> f64 {
    1000.0 * newton_metres
}

/// A number in a file's unit that is read back to the same bits, if a neighbour of the rounded one is; so an analysis is
/// repeated from its file to the last bit.
#[expect(clippy::float_cmp, reason = "the point is to read back the same bits")]
pub(crate) fn border(inside: f64, rounded: f64, read: impl Fn(f64) -> f64) -> f64 {
    let neighbours = [rounded, rounded.next_up(), rounded.next_down()];
    neighbours.into_iter().find(|&written| read(written) == inside).unwrap_or(rounded)
}

/// An angle in degrees, by [`border`].
pub(crate) fn degrees(angle: Angle) -> f64 {
    border(angle.rad(), angle.deg(), |deg| Angle::from_deg(deg).rad())
}

impl From<&StiffnessLibrary> for StiffnessFile {
    fn from(library: &StiffnessLibrary) -> Self {
        let row = |row: &JointStiffness| {
            let [lateral, flexion, axial] =
                row.nmm_per_rad.map(|nmm| border(nmm, nmm / 1000.0, newton_millimetres));
            JointRow {
                inferior: row.inferior,
                superior: row.superior,
                lateral_nm_per_rad: lateral,
                flexion_nm_per_rad: flexion,
                axial_nm_per_rad: axial,
                axial_per_lateral: row.axial_per_lateral,
                source: row.source.clone(),
            }
        };
        let joints = library.rows().iter().map(row).collect();
        Self { format: FORMAT.to_owned(), version: VERSION, joints }
    }
}
