//! The next landmark, and its expected place.

use spineline::anatomy::{Level, Posture, Side};
use spineline::measure::completion::{Click, Clicks, ShapeModel, complete, complete_by};
use spineline::measure::{CornerName, Corners, ImageGeometry};
use spineline::spatial::Pixel;

use super::{ErectFilm, PartialLandmarks, PartialReading};

/// What is marked next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NextLandmark {
    /// A corner of a vertebra.
    Corner(Level, CornerName),
    /// The midpoint of the wall on a side of the patient.
    Wall(Level, Side),
    /// The tip of an iliac crest.
    Crest(Side),
}

/// Largest standard deviation of a proposed corner, as a part of the height of its body: two larger deviations exceed a body,
/// so the proposal may lie on the neighbour (assumption).
const MAX_SD_SHARE: f64 = 0.5;
/// Largest standard deviation of a corner, as a part of the height of its body, that is accepted without clicks on this body.
const SURE_SD_SHARE: f64 = 0.15;
/// A body in the picture differs from a proposal beyond this number of standard deviations of both.
const FIT_SDS: f64 = 2.0;

/// A vertebra at its expected place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProposedVertebra {
    /// Which one.
    pub level: Level,
    /// Its corners, all on the picture.
    pub corners: Corners<Pixel>,
    /// Standard deviation of a corner as a part of its height.
    pub sd_share: f64,
    /// Whether it is a vertebra of the model without clicks that the erect film and the clicks on others determine.
    pub is_sure: bool,
}

impl ProposedVertebra {
    /// The mean of its corners.
    #[must_use]
    pub fn centre(&self, image: &ImageGeometry) -> Pixel {
        image.pixel(self.corners.map(|corner| image.frontal(corner)).centre())
    }

    /// Whether a body in the picture with this standard deviation agrees with it, by the mean square distance of the corners.
    #[must_use]
    pub fn fits(&self, image: &ImageGeometry, body: &Corners<Pixel>, sd_share: f64) -> bool {
        let own = self.corners.map(|corner| image.frontal(corner));
        let pairs = CornerName::ALL.map(|name| (name.of(&own), image.frontal(name.of(body))));
        let square: f64 = pairs.iter().map(|(a, b)| a.distance_mm(*b).powi(2)).sum();
        let variance = (self.sd_share.powi(2) + sd_share.powi(2)) * own.height_mm().powi(2);
        square / 8.0 <= FIT_SDS.powi(2) * variance
    }
}

impl PartialReading {
    /// The vertebrae in the order of marking: L4 to T2, which the model needs, then T1 and L5. With an erect film, the vertebrae that
    /// determine the others come first.
    #[must_use]
    pub fn order(erect: Option<&ErectFilm>) -> Vec<Level> {
        let mut order = [&Level::MODEL[..], &[Level::T1, Level::L5]].concat();
        if erect.is_some() {
            order.sort_by_key(|level| !ErectFilm::ASKED.contains(level));
        }
        order
    }

    /// The next landmark: the first missing corner in this order and [`CornerName::ORDER`], then the
    /// left and the right crest. After a crest, T1 and L5 are skipped unless they were begun.
    #[must_use]
    pub fn next(&self, order: &[Level]) -> Option<NextLandmark> {
        for &level in order {
            let landmark = self.vertebrae.get(&level);
            if landmark.is_none() && self.is_skipped(level) {
                continue;
            }
            let missing =
                |name: &CornerName| landmark.is_none_or(|m| name.of(&m.corners).is_none());
            if let Some(corner) = CornerName::ORDER.into_iter().find(missing) {
                return Some(NextLandmark::Corner(level, corner));
            }
        }
        self.next_crest()
    }

    /// The next landmark with two clicks per vertebra: the first missing wall in this order, left before
    /// right, of the vertebrae without a corner; then the result of [`PartialReading::next`].
    #[must_use]
    pub fn next_by_walls(&self, order: &[Level]) -> Option<NextLandmark> {
        for &level in order {
            let landmark = self.vertebrae.get(&level);
            if landmark.map_or(self.is_skipped(level), PartialLandmarks::has_corner) {
                continue;
            }
            let walls = landmark.map_or([None; 2], |m| m.walls);
            let sides = [Side::Left, Side::Right].into_iter().zip(walls);
            if let Some((side, _)) = sides.into_iter().find(|(_, wall)| wall.is_none()) {
                return Some(NextLandmark::Wall(level, side));
            }
        }
        self.next_crest()
    }

    /// Whether a vertebra that was not begun is left out: T1 and L5 after a crest.
    fn is_skipped(&self, level: Level) -> bool {
        level.model_index().is_none() && self.crests.iter().any(Option::is_some)
    }

    /// The first missing crest, left before right.
    fn next_crest(&self) -> Option<NextLandmark> {
        let mut crests = [Side::Left, Side::Right].into_iter().zip(self.crests);
        let (side, _) = crests.find(|(_, place)| place.is_none())?;
        Some(NextLandmark::Crest(side))
    }

    /// The landmarks of a person on all vertebrae without a fault: corners, or else walls. Accepted corners do not
    /// count: they would confirm the model that proposed them.
    #[must_use]
    pub fn clicks(&self, image: &ImageGeometry) -> Clicks {
        let faulty = self.faulty_levels(image);
        let sound = self.vertebrae.iter().filter(|(level, _)| !faulty.contains(level));
        let vertebrae = sound.flat_map(|(&level, landmark)| {
            let placed = CornerName::ALL.map(|name| {
                let is_placed = name.of(&landmark.origins).is_placed();
                name.of(&landmark.corners).filter(|_| is_placed).map(|place| (name, place))
            });
            Click::on(level, placed, landmark.walls)
        });
        Clicks { vertebrae: vertebrae.collect(), midline: Vec::new() }
    }

    /// The vertebrae without a corner, from L4 to T2 and then T1 and L5, as [`complete`] expects them from all
    /// landmarks and the erect film of the patient; empty for fewer than two clicks.
    ///
    /// A vertebra with a corner beyond the edge is not proposed, nor one so uncertain that it may be its neighbour:
    /// with a standard deviation above half the height of its body. `posture` is `None` if it is unknown, as in blinded
    /// readings.
    #[must_use]
    pub fn propose(
        &self,
        image: &ImageGeometry,
        posture: Option<Posture>,
        erect: Option<&ErectFilm>,
    ) -> Vec<ProposedVertebra> {
        let open =
            |level: &Level| !self.vertebrae.get(level).is_some_and(PartialLandmarks::has_corner);
        let levels: Vec<Level> = Self::order(None).into_iter().filter(open).collect();
        if levels.is_empty() {
            return Vec::new();
        }
        let clicks = self.clicks(image);
        let of_patient = |erect: &ErectFilm| {
            let model =
                ShapeModel::of_patient(&erect.image, &erect.reading.clicks(&erect.image), image);
            complete_by(&model.ok()?, image, &clicks).ok()
        };
        let completion = match erect {
            Some(erect) => of_patient(erect),
            None => complete(image, posture, &clicks).ok(),
        };
        let Some(completion) = completion else { return Vec::new() };
        let proposed = levels.into_iter().filter_map(|level| {
            let sd_share = completion.sd_mm(level) / completion.corners(level).height_mm();
            let corners = completion.corners_px(image, level);
            let is_on_film = corners.points().into_iter().all(|corner| image.contains(corner));
            let is_known = is_on_film && sd_share <= MAX_SD_SHARE;
            let is_sure = erect.is_some()
                && level.model_index().is_some()
                && !self.vertebrae.contains_key(&level)
                && sd_share <= SURE_SD_SHARE;
            is_known.then_some(ProposedVertebra { level, corners, sd_share, is_sure })
        });
        proposed.collect()
    }
}
