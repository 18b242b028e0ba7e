use std::collections::BTreeMap;

use csv::ByteRecord;
use spineline_files::nearest;

use super::{
    AXIS, CONFIDENCES, CORNERS, LATERAL_CORNERS, OBSERVER, ORIGINS, PEDICLES, PLACED, POSTURE,
    REPEAT, SD_SHARE, VERTEBRA, WALLS,
};
use crate::LandmarkError;
use crate::names::shown;

/// What a table is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum View {
    Frontal,
    Lateral,
}

impl View {
    /// Column and row of each corner.
    pub const fn corners(self) -> [&'static str; 8] {
        match self {
            Self::Frontal => CORNERS,
            Self::Lateral => LATERAL_CORNERS,
        }
    }

    /// Every column that such a table may have.
    fn columns(self) -> Vec<&'static str> {
        let mut all = vec![OBSERVER, REPEAT, VERTEBRA];
        all.extend(self.corners());
        if self == Self::Frontal {
            all.extend([POSTURE, AXIS, SD_SHARE]);
            all.extend(PLACED);
            for four in [CONFIDENCES, ORIGINS, WALLS, PEDICLES] {
                all.extend(four);
            }
        }
        all
    }
}

/// Where the columns stand.
pub(super) struct Columns {
    pub view: View,
    pub count: usize,
    pub vertebra: usize,
    pub posture: Option<usize>,
    pub observer: Option<usize>,
    pub repeat: Option<usize>,
    pub axis: Option<usize>,
    pub confidences: Option<[usize; 4]>,
    pub origins: Option<[usize; 4]>,
    pub walls: Option<[usize; 4]>,
    pub pedicles: Option<[usize; 4]>,
    pub sd_share: Option<usize>,
    pub values: Values,
}

pub(super) enum Values {
    Corners([usize; 8]),
    Placements([usize; 3]),
}

impl Columns {
    pub fn of(heading: &ByteRecord, view: View) -> Result<Self, LandmarkError> {
        let places = places(heading, view)?;
        let get = |name: &str| places.get(name).copied();
        let need = |name: &'static str| {
            get(name).ok_or_else(|| LandmarkError::Missing {
                at: "line 1".to_owned(),
                what: format!("the column `{name}`"),
            })
        };
        let placed = PLACED.iter().any(|name| get(name).is_some());
        let of_corners = || {
            let more = CONFIDENCES.iter().chain(&ORIGINS).chain(&WALLS).chain(&PEDICLES);
            CORNERS.iter().chain(more).chain([&AXIS, &SD_SHARE])
        };
        if placed && of_corners().any(|name| get(name).is_some()) {
            return Err(LandmarkError::Ambiguous {
                at: "line 1".to_owned(),
                reason:
                    "the table has columns of corners and of locations; only one kind is allowed"
                        .to_owned(),
            });
        }
        let values = if placed {
            let [left, cranial, tilt] = PLACED;
            Values::Placements([need(left)?, need(cranial)?, need(tilt)?])
        } else {
            let mut corners = [0; 8];
            for (place, name) in corners.iter_mut().zip(view.corners()) {
                *place = need(name)?;
            }
            Values::Corners(corners)
        };
        let all_or_none = |names: [&'static str; 4]| -> Result<Option<[usize; 4]>, LandmarkError> {
            if names.iter().all(|name| get(name).is_none()) {
                return Ok(None);
            }
            let mut columns = [0; 4];
            for (place, name) in columns.iter_mut().zip(names) {
                *place = need(name)?;
            }
            Ok(Some(columns))
        };
        Ok(Self {
            view,
            count: heading.len(),
            vertebra: need(VERTEBRA)?,
            posture: get(POSTURE),
            observer: get(OBSERVER),
            repeat: get(REPEAT),
            axis: get(AXIS),
            confidences: all_or_none(CONFIDENCES)?,
            origins: all_or_none(ORIGINS)?,
            walls: all_or_none(WALLS)?,
            pedicles: all_or_none(PEDICLES)?,
            sd_share: get(SD_SHARE),
            values,
        })
    }
}

/// Where every column of a heading is.
fn places(
    heading: &ByteRecord,
    view: View,
) -> Result<BTreeMap<&'static str, usize>, LandmarkError> {
    let known = view.columns();
    let mut places = BTreeMap::new();
    for (place, cell) in heading.iter().enumerate() {
        let at = || format!("line 1, column {}", place + 1);
        let name = String::from_utf8_lossy(cell);
        let Some(&column) = known.iter().find(|known| **known == name) else {
            let nearest = nearest(&shown(&name), &known);
            let name = shown(&name);
            return Err(LandmarkError::Unknown { at: at(), what: "column", name, nearest });
        };
        if places.insert(column, place).is_some() {
            let what = format!("the column `{column}`");
            return Err(LandmarkError::Duplicate { at: at(), what, first: None });
        }
    }
    Ok(places)
}
