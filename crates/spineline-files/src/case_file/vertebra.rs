//! A vertebra of a frontal film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::measure::{Corners, Origin, Placement, VertebraLandmarks};
use spineline::spatial::{Angle, Frontal, Pixel};

use crate::FileError;
use crate::text::written_deg;

/// Either four corners, named by the patient's sides, or a location and a tilt.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct VertebraRecord {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    superior_left: Option<Pixel>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    superior_right: Option<Pixel>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    inferior_left: Option<Pixel>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    inferior_right: Option<Pixel>,
    /// Axis set by hand: angle to the image's vertical, positive clockwise as seen with square pixels, that is in millimetres and not
    /// in columns and rows; from -180 to 180.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    axis_deg: Option<f64>,
    /// Confidences of the corners from 0 to 1, where a program found them: superior left, superior right, inferior left,
    /// inferior right.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    confidence: Option<[f64; 4]>,
    /// How each corner came about: superior left, superior right, inferior left, inferior right. Absent where all were clicked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origins: Option<[Origin; 4]>,
    /// Midpoint of the wall on the patient's left, where the vertebra was marked by its walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    left_wall: Option<Pixel>,
    /// Midpoint of the wall on the patient's right.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    right_wall: Option<Pixel>,
    /// Centre of the pedicle on the patient's left, as the film shows it; with the right one it gives the axial rotation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    left_pedicle: Option<Pixel>,
    /// Centre of the pedicle on the patient's right.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    right_pedicle: Option<Pixel>,
    /// Standard deviation of a corner's coordinate as a part of the height of the body, where a program found the corners.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sd_share: Option<f64>,
    /// Midpoint in any frontal frame of the film: `[y to the patient's left, z cranial]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    location_mm: Option<[f64; 2]>,
    /// Tilt in that frame, positive to the patient's right, from -180 to 180.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tilt_deg: Option<f64>,
}

/// Landmarks, or a location and a tilt.
pub(super) enum Kind {
    Marked(VertebraLandmarks),
    Measured(Placement),
}

impl VertebraRecord {
    /// Returns its landmarks or its placement. Refuses an angle of more than half a turn, and a vertebra without both.
    pub fn check(&self, place: impl Fn() -> String) -> Result<Kind, FileError> {
        for (key, deg) in [("axis_deg", self.axis_deg), ("tilt_deg", self.tilt_deg)] {
            if let Some(deg) = deg.filter(|deg| Angle::within_half_turn(*deg).is_none()) {
                return Err(FileError::Angle { place: place(), key, deg });
            }
        }
        self.kind().ok_or_else(|| FileError::Vertebra { place: place() })
    }

    fn kind(&self) -> Option<Kind> {
        let corners =
            [self.superior_left, self.superior_right, self.inferior_left, self.inferior_right];
        let placed = (self.location_mm, self.tilt_deg);
        match (corners, placed) {
            ([Some(sl), Some(sr), Some(il), Some(ir)], (None, None)) => {
                let corners = Corners::from([sl, sr, il, ir]);
                Some(Kind::Marked(VertebraLandmarks {
                    origins: self.origins.map_or_else(Corners::default, Corners::from),
                    walls: [self.left_wall, self.right_wall],
                    pedicles: [self.left_pedicle, self.right_pedicle],
                    axis_clockwise: self.axis_deg.map(Angle::from_deg),
                    confidence: self.confidence.map(Corners::from),
                    sd_share: self.sd_share,
                    ..VertebraLandmarks::clicked(corners)
                }))
            }
            ([None, None, None, None], (Some([y, z]), Some(tilt))) if !self.has_marks() => {
                let location = Frontal::new(y, z);
                Some(Kind::Measured(Placement::new(location, Angle::from_deg(tilt))))
            }
            _ => None,
        }
    }

    /// Whether it holds something that only a vertebra with corners has.
    fn has_marks(&self) -> bool {
        self.axis_deg.is_some()
            || self.confidence.is_some()
            || self.origins.is_some()
            || self.left_wall.is_some()
            || self.right_wall.is_some()
            || self.left_pedicle.is_some()
            || self.right_pedicle.is_some()
            || self.sd_share.is_some()
    }

    pub fn marked(landmark: &VertebraLandmarks) -> Self {
        let [left_wall, right_wall] = landmark.walls;
        let [left_pedicle, right_pedicle] = landmark.pedicles;
        let is_clicked = landmark.origins == Corners::all(Origin::Clicked);
        Self {
            origins: (!is_clicked).then(|| landmark.origins.points()),
            left_wall,
            right_wall,
            left_pedicle,
            right_pedicle,
            sd_share: landmark.sd_share,
            superior_left: Some(landmark.corners.superior_left),
            superior_right: Some(landmark.corners.superior_right),
            inferior_left: Some(landmark.corners.inferior_left),
            inferior_right: Some(landmark.corners.inferior_right),
            axis_deg: landmark.axis_clockwise.map(written_axis_deg),
            confidence: landmark.confidence.map(|corners| corners.points()),
            ..Self::default()
        }
    }

    pub fn measured(placement: &Placement) -> Self {
        Self {
            location_mm: Some([placement.location.y_mm, placement.location.z_mm]),
            tilt_deg: Some(placement.tilt.deg()),
            ..Self::default()
        }
    }
}

/// A hand-set axis in degrees as files have it: axes come in steps of 0.1°, and nine decimals keep them and drop the
/// rounding of radians.
#[must_use]
pub fn written_axis_deg(axis: Angle) -> f64 {
    written_deg(axis)
}
