//! The state of a reading, computed from its events.

use std::collections::BTreeMap;

use spineline::anatomy::{FilmView, Level, Side};
use spineline::measure::{Corners, Origin};

use crate::event::{AcceptedVertebra, Corner, Event};

/// Landmarks of a vertebra.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VertebraReading {
    /// Corners placed so far, `[column, row]` in pixels.
    pub corners: BTreeMap<Corner, [f64; 2]>,
    /// Corners that a program proposed: accepted unchanged, or moved since.
    pub origins: BTreeMap<Corner, Origin>,
    /// Standard deviation of a corner as a part of the height of the body, where a program found them in the picture.
    pub sd_share: Option<f64>,
    /// Midpoints of its walls by the patient's side, where it was marked by them.
    pub walls: BTreeMap<Side, [f64; 2]>,
    /// Centres of its pedicles by the patient's side, as far as they are marked.
    pub pedicles: BTreeMap<Side, [f64; 2]>,
    /// Axis turned by hand, against the image's vertical, positive clockwise as seen with square pixels, that is in millimetres
    /// and not in columns and rows.
    pub axis_deg: Option<f64>,
}

impl VertebraReading {
    /// Its placed corners in a view, `[column, row]` in pixels; on the lateral film the front is in place of the left.
    #[must_use]
    pub fn placed(&self, view: FilmView) -> Corners<Option<[f64; 2]>> {
        Corner::of_view(view).map(|corner| self.corners.get(&corner).copied())
    }

    /// How each of its corners in a view came about.
    #[must_use]
    pub fn corner_origins(&self, view: FilmView) -> Corners<Origin> {
        Corner::of_view(view).map(|corner| self.origins.get(&corner).copied().unwrap_or_default())
    }

    /// Whether all four corners are placed.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.corners.len() == Corner::COUNT
    }
}

/// A reading after all its events.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadingState {
    /// Number of events, which is the revision for the next one.
    pub revision: u64,
    /// Vertebrae with at least a corner or an axis.
    pub vertebrae: BTreeMap<Level, VertebraReading>,
    /// Superior tips of the iliac crests by the patient's side, `[column, row]`.
    pub iliac_crests_px: BTreeMap<Side, [f64; 2]>,
    /// The length of the scale tool's line, where it was used.
    pub scale_mm: Option<f64>,
    /// Inversion of grey levels in this reading, if other than in the film's record.
    pub inverted: Option<bool>,
    /// Notes, oldest first; undo does not touch them.
    pub notes: Vec<String>,
    /// Number of changes that can be undone.
    pub undoable: usize,
    /// Number of changes that can be redone.
    pub redoable: usize,
    /// Whether the reading is finished.
    pub finished: bool,
}

impl ReadingState {
    /// Vertebrae of the model with four corners.
    pub fn complete_levels(&self) -> impl Iterator<Item = Level> {
        let complete = self.vertebrae.iter().filter(|(_, landmarks)| landmarks.is_complete());
        complete.map(|(&level, _)| level).filter(|level| level.model_index().is_some())
    }

    pub(crate) fn replay(events: &[Event], finished: bool) -> Self {
        let (mut done, mut undone, mut notes) = (Vec::new(), Vec::new(), Vec::new());
        for event in events {
            match event {
                Event::Undo => undone.extend(done.pop()),
                Event::Redo => done.extend(undone.pop()),
                Event::Note { text } => notes.push(text.clone()),
                edit => {
                    done.push(edit);
                    undone.clear();
                }
            }
        }
        let mut state = Self {
            revision: events.len() as u64,
            notes,
            undoable: done.len(),
            redoable: undone.len(),
            finished,
            ..Self::default()
        };
        for edit in done {
            state.apply(edit);
        }
        state
    }

    fn apply(&mut self, edit: &Event) {
        match *edit {
            Event::PlaceCorner { level, corner, column_px, row_px }
            | Event::MoveCorner { level, corner, column_px, row_px } => {
                let vertebra = self.vertebrae.entry(level).or_default();
                vertebra.corners.insert(corner, [column_px, row_px]);
                if let Some(origin) = vertebra.origins.get_mut(&corner) {
                    *origin = Origin::Adjusted;
                }
            }
            Event::PlaceWall { level, side, column_px, row_px } => {
                self.vertebrae.entry(level).or_default().walls.insert(side, [column_px, row_px]);
            }
            Event::PlacePedicle { level, side, column_px, row_px } => {
                let vertebra = self.vertebrae.entry(level).or_default();
                vertebra.pedicles.insert(side, [column_px, row_px]);
            }
            Event::AcceptCorners { ref vertebrae } => {
                for AcceptedVertebra { level, corners, sd_share } in vertebrae {
                    let vertebra = self.vertebrae.entry(*level).or_default();
                    vertebra.corners.clone_from(corners);
                    vertebra.origins =
                        corners.keys().map(|&corner| (corner, Origin::Accepted)).collect();
                    vertebra.sd_share = *sd_share;
                }
            }
            Event::TakeVertebra { level, ref corners, ref origins, sd_share } => {
                let vertebra = self.vertebrae.entry(level).or_default();
                vertebra.corners.clone_from(corners);
                vertebra.origins.clone_from(origins);
                vertebra.sd_share = sd_share;
            }
            Event::SetAxis { level, axis_deg } => {
                let vertebra = self.vertebrae.entry(level).or_default();
                vertebra.axis_deg = axis_deg;
                if *vertebra == VertebraReading::default() {
                    self.vertebrae.remove(&level);
                }
            }
            Event::RemoveVertebra { level } => drop(self.vertebrae.remove(&level)),
            Event::ShiftLevels { up } => {
                let vertebrae = std::mem::take(&mut self.vertebrae).into_iter();
                let shifted = |(level, vertebra)| Some((beside(level, up)?, vertebra));
                self.vertebrae = vertebrae.filter_map(shifted).collect();
            }
            Event::PlaceIliacCrest { side, column_px, row_px } => {
                self.iliac_crests_px.insert(side, [column_px, row_px]);
            }
            Event::Scale { length_mm, .. } => self.scale_mm = Some(length_mm),
            Event::Invert { inverted } => self.inverted = Some(inverted),
            // These have been handled above.
            Event::Undo | Event::Redo | Event::Note { .. } => {}
        }
    }

    /// Why an event is invalid in this state of a reading of such a film, if it is.
    pub(crate) fn objection(&self, event: &Event, view: FilmView) -> Option<&'static str> {
        if !event.fits(view) {
            return Some("a film of this view does not show this landmark");
        }
        let (sound, reason) = match event {
            Event::PlaceCorner { column_px, row_px, .. }
            | Event::PlaceWall { column_px, row_px, .. }
            | Event::PlacePedicle { column_px, row_px, .. }
            | Event::PlaceIliacCrest { column_px, row_px, .. } => {
                (on_film(&[*column_px, *row_px]), "coordinates must be within a million pixels")
            }
            Event::MoveCorner { level, corner, column_px, row_px } => {
                let known = self.vertebrae.get(level);
                let placed = known.is_some_and(|vertebra| vertebra.corners.contains_key(corner));
                (placed && on_film(&[*column_px, *row_px]), "only a placed corner can be moved")
            }
            Event::AcceptCorners { vertebrae } => {
                let whole = |one: &AcceptedVertebra| is_whole(&one.corners, one.sd_share);
                (
                    !vertebrae.is_empty() && vertebrae.iter().all(whole),
                    "accepted vertebrae need four corners each, within a million pixels, and no negative deviation",
                )
            }
            Event::TakeVertebra { corners, sd_share, .. } => (
                is_whole(corners, *sd_share),
                "a vertebra needs four corners, within a million pixels, and no negative deviation",
            ),
            Event::SetAxis { axis_deg, .. } => {
                let turned = axis_deg.is_none_or(|deg| deg.is_finite() && deg.abs() <= 90.0);
                (turned, "an axis must be within 90° of the vertical")
            }
            Event::RemoveVertebra { level } => (
                self.vertebrae.contains_key(level),
                "only a vertebra with landmarks can be removed",
            ),
            Event::ShiftLevels { up } => {
                let has_level = |&level: &Level| beside(level, *up).is_some();
                (
                    !self.vertebrae.is_empty() && self.vertebrae.keys().all(has_level),
                    "levels are L5 to T1: a vertebra would have no level",
                )
            }
            Event::Scale { from_px, to_px, length_mm } => {
                #[expect(
                    clippy::float_cmp,
                    reason = "only equal points make a scale of length zero"
                )]
                let long = length_mm.is_finite() && *length_mm > 0.0 && from_px != to_px;
                (
                    long && on_film(from_px) && on_film(to_px),
                    "a scale needs a length in pixels and in mm",
                )
            }
            Event::Undo => (self.undoable > 0, "nothing to undo"),
            Event::Redo => (self.redoable > 0, "nothing to redo"),
            Event::Invert { .. } | Event::Note { .. } => (true, ""),
        };
        (!sound).then_some(reason)
    }
}

fn beside(level: Level, up: bool) -> Option<Level> {
    if up { level.next_above() } else { level.next_below() }
}

/// Whether all four corners lie within the limits, and the deviation is not negative.
fn is_whole(corners: &BTreeMap<Corner, [f64; 2]>, sd_share: Option<f64>) -> bool {
    corners.len() == Corner::COUNT
        && corners.values().all(|place| on_film(place))
        && sd_share.is_none_or(|sd| sd.is_finite() && sd >= 0.0)
}

/// Larger than any film; catches errors of units.
const MAX_COORDINATE_PX: f64 = 1e6;

fn on_film(place: &[f64]) -> bool {
    place.iter().all(|x| x.is_finite() && x.abs() <= MAX_COORDINATE_PX)
}
