//! Conversion of a study to the core's types: the only way from readings to a [`Case`].

use std::collections::BTreeMap;

use rusqlite::Connection;
use spineline::analysis::{Case, Subject};
use spineline::anatomy::{Posture, Side};
use spineline::measure::{
    Corners, Film, FilmLandmarks, IliacCrests, Reading, ReadingId as Reader, VertebraLandmarks,
};
use spineline::spatial::{Angle, Pixel};

use crate::error::StoreError;
use crate::films::{self, FilmRecord};
use crate::names::Name;
use crate::readings::ReadingRecord;
use crate::state::{ReadingState, VertebraReading};

/// The films of a study, of which a case has one per posture.
pub(crate) fn by_posture(
    connection: &Connection,
    study: &Name,
) -> Result<BTreeMap<Posture, FilmRecord>, StoreError> {
    let mut by_posture: BTreeMap<Posture, FilmRecord> = BTreeMap::new();
    for film in films::films(connection, study)? {
        if let Some(other) = by_posture.insert(film.posture, film) {
            let (study, posture) = (study.clone(), other.posture);
            return Err(StoreError::PostureTwice { study, posture });
        }
    }
    Ok(by_posture)
}

/// The case of a study with these films.
pub(crate) fn case(study: &Name, synthetic: bool, films: Vec<Film>) -> Case {
    let (id, subject) = (study.to_string(), Subject::default());
    Case { id, synthetic, subject, films, lateral: None }
}

/// A film with its readings: the vertebrae with four corners, and the mean of the pairs of crests.
///
/// # Errors
/// [`StoreError::Case`] where the image's description is not that of a case file.
pub(crate) fn film(
    record: &FilmRecord,
    readings: &[(&ReadingRecord, ReadingState)],
) -> Result<Film, StoreError> {
    let image = spineline_files::parse_image(&record.image, record.posture)?;
    let iliac_crests = mean_crests(readings);
    let readings = readings.iter().map(|(reading, state)| marked(reading, state)).collect();
    let landmarks = FilmLandmarks::Corners { image, iliac_crests, readings };
    Ok(Film { posture: record.posture, landmarks })
}

fn marked(reading: &ReadingRecord, state: &ReadingState) -> Reading<VertebraLandmarks> {
    let vertebrae = state.vertebrae.iter().filter_map(|(&level, v)| Some((level, landmark(v)?)));
    Reading {
        id: Reader::new(reading.observer.to_string(), reading.repeat),
        vertebrae: vertebrae.collect(),
    }
}

/// The landmarks of a vertebra, if all four corners are placed.
fn landmark(landmarks: &VertebraReading) -> Option<VertebraLandmarks> {
    let corners = landmarks.placed().map(|corner| corner.map(pixel));
    let corners = Corners {
        superior_left: corners.superior_left?,
        superior_right: corners.superior_right?,
        inferior_left: corners.inferior_left?,
        inferior_right: corners.inferior_right?,
    };
    Some(VertebraLandmarks {
        origins: landmarks.corner_origins(),
        walls: [Side::Left, Side::Right].map(|side| landmarks.walls.get(&side).copied().map(pixel)),
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
    let place = |side| pixel([mean(side, 0), mean(side, 1)]);
    (!pairs.is_empty()).then(|| IliacCrests { left: place(0), right: place(1) })
}

fn pixel([column, row]: [f64; 2]) -> Pixel {
    Pixel::new(column, row)
}
