use std::collections::BTreeMap;

use csv::ByteRecord;
use spineline_files::{column_name, nearest};

use super::{
    AXIS, CONFIDENCES, CORNERS, LATERAL_CORNERS, OBSERVER, ORIGINS, PEDICLES, PLACED, POSTURE,
    REPEAT, SD_SHARE, VERTEBRA, WALLS,
};
use crate::names::shown;
use crate::{ColumnHint, LandmarkError};

/// Columns that only a table of corners has, beside the corners.
const BESIDE_CORNERS: [&[&str]; 6] =
    [&CONFIDENCES, &ORIGINS, &WALLS, &PEDICLES, &[AXIS], &[SD_SHARE]];

/// The view of the films in a table.
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
            all.push(POSTURE);
            all.extend(PLACED);
            all.extend(BESIDE_CORNERS.concat());
        }
        all
    }
}

/// Where the columns stand.
pub(super) struct Columns {
    pub view: View,
    pub count: usize,
    /// Columns without a known name, which may be empty.
    pub unknown: Vec<UnknownColumn>,
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

/// A column of another name.
pub(super) struct UnknownColumn {
    pub place: usize,
    at: String,
    name: String,
    view: View,
}

impl UnknownColumn {
    /// The error where it has a value.
    pub fn refused(&self) -> LandmarkError {
        let nearest = nearest(&self.name, &self.view.columns());
        LandmarkError::Column { at: self.at.clone(), name: self.name.clone(), nearest }
    }
}

pub(super) enum Values {
    Corners([usize; 8]),
    Placements([usize; 3]),
}

impl Columns {
    /// From the heading on this line.
    pub fn of(
        heading: &ByteRecord,
        line: u64,
        view: View,
        hint: &ColumnHint,
    ) -> Result<Self, LandmarkError> {
        let (places, unknown) = places(heading, line, view, hint)?;
        let get = |name: &str| places.get(name).copied();
        let need = |name: &'static str| {
            get(name).ok_or_else(|| {
                // A mistyped column is reported before a missing one.
                let mistyped = unknown
                    .iter()
                    .find(|column| nearest(&column.name, &view.columns()).as_deref() == Some(name));
                let at = hint.line_place(line);
                let missing = || LandmarkError::missing(at, format!("the column `{name}`"));
                mistyped.map_or_else(missing, UnknownColumn::refused)
            })
        };
        let placed = PLACED.iter().any(|name| get(name).is_some());
        let mut of_corners = CORNERS.into_iter().chain(BESIDE_CORNERS.concat());
        if placed && of_corners.any(|name| get(name).is_some()) {
            return Err(LandmarkError::Ambiguous {
                at: hint.line_place(line),
                reason:
                    "the table has columns of corners and of locations; only one kind is allowed"
                        .to_owned(),
                help: "write corners and locations into two tables",
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
            unknown,
        })
    }
}

/// The position of every known column of a heading, and the other columns.
fn places(
    heading: &ByteRecord,
    line: u64,
    view: View,
    hint: &ColumnHint,
) -> Result<(BTreeMap<&'static str, usize>, Vec<UnknownColumn>), LandmarkError> {
    let known = view.columns();
    let names: Vec<String> =
        heading.iter().map(|cell| column_name(&String::from_utf8_lossy(cell))).collect();
    if let Some(missing) = hint.renamed.keys().find(|renamed| !names.contains(renamed)) {
        let what = format!("the column `{}`", shown(missing));
        return Err(LandmarkError::missing(hint.line_place(line), what));
    }
    let (mut places, mut unknown) = (BTreeMap::new(), Vec::new());
    for (place, cell) in heading.iter().enumerate() {
        let at = format!("{}, column {}", hint.line_place(line), place + 1);
        let name = String::from_utf8_lossy(cell);
        let Some(wanted) = hint.column(&name) else { continue };
        let Some(&column) = known.iter().find(|known| **known == wanted) else {
            let name = if wanted == column_name(&name) { &*name } else { &wanted };
            let name = if wanted.is_empty() { "(without a name)".to_owned() } else { shown(name) };
            unknown.push(UnknownColumn { place, at, name, view });
            continue;
        };
        if let Some(first) = places.insert(column, place) {
            let what = format!("the column `{column}`");
            let first = Some(format!("column {}", first + 1));
            return Err(LandmarkError::Duplicate { at, what, first });
        }
    }
    Ok((places, unknown))
}
