//! Conversion of a study to the core's types: the only way from readings to a [`Case`].

use std::collections::BTreeMap;

use rusqlite::Connection;
use spineline::analysis::Case;
use spineline::anatomy::{FilmView, Posture, Side};
use spineline::measure::{
    Corners, Film, FilmLandmarks, IliacCrests, LateralFilm, Reading, ReadingId as Reader,
    VertebraLandmarks,
};
use spineline::spatial::{Angle, Pixel};

use crate::error::StoreError;
use crate::films::{self, FilmRecord};
use crate::names::Name;
use crate::readings::ReadingRecord;
use crate::state::{ReadingState, VertebraReading};

/// The films of a study, of which a case has one per posture and one lateral one; the lateral one comes last.
pub(crate) fn by_view(
    connection: &Connection,
    study: &Name,
) -> Result<BTreeMap<FilmView, FilmRecord>, StoreError> {
    let mut by_view: BTreeMap<FilmView, FilmRecord> = BTreeMap::new();
    for film in films::films(connection, study)? {
        if let Some(other) = by_view.insert(film.view, film) {
            return Err(StoreError::ViewTwice { study: study.clone(), view: other.view });
        }
    }
    Ok(by_view)
}

/// A film with its readings, as its view has it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum AssembledFilm {
    Frontal(Film),
    Lateral(LateralFilm),
}

pub(crate) fn case(study: &Name, synthetic: bool, films: Vec<AssembledFilm>) -> Case {
    let mut case = Case { synthetic, ..Case::of_films(study.to_string(), Vec::new()) };
    for film in films {
        match film {
            AssembledFilm::Frontal(film) => case.films.push(film),
            AssembledFilm::Lateral(film) => case.lateral = Some(film),
        }
    }
    case
}

/// A film of a study with its readings.
///
/// # Errors
/// [`StoreError::Case`] where a case file cannot have the image's description.
pub(crate) fn film(
    record: &FilmRecord,
    readings: &[(&ReadingRecord, ReadingState)],
) -> Result<AssembledFilm, StoreError> {
    Ok(match record.view {
        FilmView::Frontal(posture) => {
            AssembledFilm::Frontal(frontal_film(record, posture, readings)?)
        }
        FilmView::Lateral => AssembledFilm::Lateral(lateral_film(record, readings)?),
    })
}

/// The lateral film with its readings: the vertebrae with four corners.
fn lateral_film(
    record: &FilmRecord,
    readings: &[(&ReadingRecord, ReadingState)],
) -> Result<LateralFilm, StoreError> {
    let readings = readings.iter().map(|(reading, state)| Reading {
        id: reader(reading),
        vertebrae: state
            .vertebrae
            .iter()
            .filter_map(|(&level, v)| Some((level, placed(v, record.view)?)))
            .collect(),
    });
    Ok(LateralFilm {
        image: record.geometry()?,
        simultaneous: record.stated.simultaneous,
        readings: readings.collect(),
    })
}

/// A frontal film with its readings: the vertebrae with four corners, and the mean of the pairs of crests.
fn frontal_film(
    record: &FilmRecord,
    posture: Posture,
    readings: &[(&ReadingRecord, ReadingState)],
) -> Result<Film, StoreError> {
    let image = record.geometry()?;
    let iliac_crests = mean_crests(readings);
    let readings =
        readings.iter().map(|(reading, state)| marked(reading, state, posture)).collect();
    let landmarks = FilmLandmarks::Corners { image, iliac_crests, readings };
    Ok(Film { checked: record.stated.checked, ..Film::new(posture, landmarks) })
}

fn marked(
    reading: &ReadingRecord,
    state: &ReadingState,
    posture: Posture,
) -> Reading<VertebraLandmarks> {
    let vertebrae =
        state.vertebrae.iter().filter_map(|(&level, v)| Some((level, landmark(v, posture)?)));
    Reading { id: reader(reading), vertebrae: vertebrae.collect() }
}

pub(crate) fn reader(reading: &ReadingRecord) -> Reader {
    Reader::new(reading.observer.to_string(), reading.repeat)
}

/// The corners of a vertebra in a view, if all four are placed.
fn placed(landmarks: &VertebraReading, view: FilmView) -> Option<Corners<Pixel>> {
    landmarks.placed(view).map(|corner| corner.map(Pixel::from)).complete()
}

/// The landmarks of a vertebra on a frontal film, if all four corners are placed.
fn landmark(landmarks: &VertebraReading, posture: Posture) -> Option<VertebraLandmarks> {
    let view = FilmView::Frontal(posture);
    let corners = placed(landmarks, view)?;
    let sides = |places: &BTreeMap<Side, [f64; 2]>| {
        Side::ALL.map(|side| places.get(&side).copied().map(Pixel::from))
    };
    Some(VertebraLandmarks {
        origins: landmarks.corner_origins(view),
        walls: sides(&landmarks.walls),
        pedicles: sides(&landmarks.pedicles),
        axis_clockwise: landmarks.axis_deg.map(Angle::from_deg),
        sd_share: landmarks.sd_share,
        ..VertebraLandmarks::clicked(corners)
    })
}

/// The mean of the readings that have both crests, summed in their order.
fn mean_crests(readings: &[(&ReadingRecord, ReadingState)]) -> Option<IliacCrests> {
    let pairs: Vec<[[f64; 2]; 2]> = readings
        .iter()
        .filter_map(|(_, state)| {
            let crest = |side| state.iliac_crests_px.get(&side).copied();
            Some([crest(Side::Left)?, crest(Side::Right)?])
        })
        .collect();
    let mean = |side: usize, axis: usize| {
        pairs.iter().map(|pair| pair[side][axis]).sum::<f64>() / pairs.len() as f64
    };
    let place = |side| Pixel::from([mean(side, 0), mean(side, 1)]);
    (!pairs.is_empty()).then(|| IliacCrests { left: place(0), right: place(1) })
}
