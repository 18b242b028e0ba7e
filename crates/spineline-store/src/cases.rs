//! Import of a case file with its films as a study, completely or not at all.

use std::fmt::Display;

use serde_json::Value;
use spineline::analysis::{Subject, check_repeated};
use spineline::anatomy::{FilmView, Level, Posture, Side};
use spineline::fault::Remedy;
use spineline::measure::{
    Corners, Film, FilmLandmarks, IliacCrests, LateralFilm, Origin, Reading, VertebraLandmarks,
};
use spineline::spatial::Pixel;
use spineline_files::FileError;

use crate::accounts::{self, Role};
use crate::audit::Ledger;
use crate::connection::Store;
use crate::error::StoreError;
use crate::event::{Corner, Event};
use crate::films::{self, NewFilm, Stated, Study};
use crate::journal;
use crate::names::{FilmId, Name, Signature};
use crate::readings;
use crate::state::ReadingState;

/// A case to be imported as a study.
#[derive(Debug, Clone, PartialEq)]
pub struct NewCase {
    /// Its study.
    pub study: Study,
    films: Vec<CaseFilm>,
    remarks: Vec<CaseRemark>,
}

#[derive(Debug, Clone, PartialEq)]
struct CaseFilm {
    view: FilmView,
    stated: Stated,
    bytes: Vec<u8>,
    image: Value,
    readings: Vec<CaseReading>,
}

/// A reading as events.
#[derive(Debug, Clone, PartialEq)]
struct CaseReading {
    observer: Name,
    repeat: u32,
    events: Vec<Event>,
}

/// Parts of a case that a store does not hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CaseRemark {
    /// The lateral film and its landmarks, where the case names no picture of it.
    #[error(
        "the case names no picture of the lateral film, so the study store does not hold its landmarks: keep the case file"
    )]
    Lateral,
    /// Sex, age and Lenke class.
    #[error("the study store does not hold sex, age and Lenke class: keep the case file")]
    Subject,
    /// Confidences of landmarks that a program found.
    #[error("the study store does not hold the confidences of landmarks: keep the case file")]
    Confidences,
}

/// Why a case cannot be imported. `E` is the error of reading a film's file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError<E> {
    /// The text is not a case file.
    #[error("{0}")]
    File(FileError),
    /// The case or an observer has a name that a store does not take.
    #[error("{0}")]
    Name(StoreError),
    /// Two postures have the landmarks of one film.
    #[error("{0}")]
    Repeated(spineline::error::Error),
    /// A film has locations from another program.
    #[error("{posture} film: it has locations from another program, but no picture")]
    NoPicture {
        /// Film.
        posture: Posture,
    },
    /// The case does not name a film's picture file.
    #[error("{posture} film: no picture is named")]
    NotNamed {
        /// Film.
        posture: Posture,
    },
    /// A picture differs from the one of the case.
    #[error("{view} film: the picture differs from the one of the case (SHA-256 differs)")]
    OtherPicture {
        /// Film.
        view: FilmView,
    },
    /// A picture cannot be read.
    #[error("{0}")]
    Picture(E),
}

impl<E: Display> Remedy for CaseError<E> {
    fn help(&self) -> &'static str {
        match self {
            Self::File(error) => error.help(),
            Self::Name(error) => error.help(),
            Self::Repeated(error) => error.help(),
            Self::NoPicture { .. } => "a study store holds pictures and their landmarks",
            Self::NotNamed { .. } => "give `image.file`; `import` and `phantom --films` write it",
            Self::OtherPicture { .. } => "use the original film, or create the case again",
            Self::Picture(_) => "put the film into the folder of the case",
        }
    }
}

/// Result of an import.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AddedCase {
    /// Its study.
    pub study: Name,
    /// Its films, in the order of the case.
    pub films: Vec<FilmId>,
    /// Number of readings, all finished.
    pub readings: usize,
    /// Parts that are not stored.
    pub remarks: Vec<CaseRemark>,
}

impl NewCase {
    /// Reads a case; `bytes_of` gives the bytes of a film by its file name.
    pub fn read<E>(
        text: &str,
        mut bytes_of: impl FnMut(&str) -> Result<Vec<u8>, E>,
    ) -> Result<Self, CaseError<E>> {
        let case = spineline_files::parse_case(text).map_err(CaseError::File)?;
        let written = spineline_files::parse_json(text).map_err(CaseError::File)?;
        let id = Name::new(&case.id).map_err(CaseError::Name)?;
        check_repeated(&case.films, case.lateral.as_ref())
            .map_err(|error| CaseError::Repeated(error.into()))?;
        let mut films = Vec::new();
        let records = written["films"].as_array().into_iter().flatten();
        for (film, record) in case.films.iter().zip(records) {
            let posture = film.posture;
            let FilmLandmarks::Corners { readings, iliac_crests, .. } = &film.landmarks else {
                return Err(CaseError::NoPicture { posture });
            };
            let readings = readings.iter().map(|reading| CaseReading::of(reading, *iliac_crests));
            let readings = readings.collect::<Result<_, _>>().map_err(CaseError::Name)?;
            let image = record["image"].clone();
            let file = image["file"].as_str().ok_or(CaseError::NotNamed { posture })?;
            let view = FilmView::Frontal(posture);
            let bytes = picture(view, file, &image, &mut bytes_of)?;
            let stated = Stated { checked: film.checked, ..Stated::default() };
            films.push(CaseFilm { view, stated, bytes, image, readings });
        }
        let mut remarks = Vec::new();
        if let Some(lateral) = &case.lateral {
            let image = written["lateral"]["image"].clone();
            match image["file"].as_str() {
                Some(file) => {
                    let bytes = picture(FilmView::Lateral, file, &image, &mut bytes_of)?;
                    films.push(CaseFilm::lateral(lateral, bytes, image).map_err(CaseError::Name)?);
                }
                None => remarks.push(CaseRemark::Lateral),
            }
        }
        if case.subject != Subject::default() {
            remarks.push(CaseRemark::Subject);
        }
        if case.films.iter().any(has_confidences) {
            remarks.push(CaseRemark::Confidences);
        }
        let study = Study::new(id, None, case.synthetic);
        Ok(Self { study, films, remarks })
    }

    /// A study without films yet.
    #[must_use]
    pub fn of(study: Study) -> Self {
        Self { study, films: Vec::new(), remarks: Vec::new() }
    }

    /// With one more film, without readings.
    #[must_use]
    pub fn film(mut self, view: impl Into<FilmView>, bytes: Vec<u8>, image: Value) -> Self {
        let (view, readings) = (view.into(), Vec::new());
        self.films.push(CaseFilm { view, stated: Stated::default(), bytes, image, readings });
        self
    }

    /// With a lateral film, if it has one, that was exposed together with the erect film, or not.
    #[must_use]
    pub fn simultaneous(mut self, simultaneous: bool) -> Self {
        for film in self.films.iter_mut().filter(|film| film.view == FilmView::Lateral) {
            film.stated.simultaneous = simultaneous;
        }
        self
    }

    /// Its films: what they show, file name, columns and rows.
    pub fn pictures(&self) -> impl Iterator<Item = (FilmView, &str, [u64; 2])> {
        self.films.iter().map(|film| {
            let size = ["columns", "rows"].map(|key| film.image[key].as_u64().unwrap_or_default());
            (film.view, film.image["file"].as_str().unwrap_or_default(), size)
        })
    }

    /// With other files for the same pictures, named after the study.
    ///
    /// # Errors
    /// What `rewrite` refuses.
    pub fn rewritten<E>(
        mut self,
        rewrite: impl Fn(&[u8]) -> Result<Vec<u8>, E>,
    ) -> Result<Self, E> {
        for film in &mut self.films {
            film.bytes = rewrite(&film.bytes)?;
            // The old name may be a patient's.
            let end = if film.bytes.get(128..132) == Some(b"DICM") { "dcm" } else { "png" };
            film.image["file"] = format!("{}-{}.{end}", self.study.id, film.view.key()).into();
            film.image["sha256"] = spineline_files::sha256_hex(&film.bytes).into();
        }
        Ok(self)
    }
}

/// The bytes of a picture that a case names.
fn picture<E>(
    view: FilmView,
    file: &str,
    image: &Value,
    bytes_of: &mut impl FnMut(&str) -> Result<Vec<u8>, E>,
) -> Result<Vec<u8>, CaseError<E>> {
    let bytes = bytes_of(file).map_err(CaseError::Picture)?;
    let found = spineline_files::sha256_hex(&bytes);
    if image["sha256"].as_str().is_some_and(|hash| !hash.eq_ignore_ascii_case(&found)) {
        return Err(CaseError::OtherPicture { view });
    }
    Ok(bytes)
}

impl CaseFilm {
    fn lateral(film: &LateralFilm, bytes: Vec<u8>, image: Value) -> Result<Self, StoreError> {
        let readings = film.readings.iter().map(CaseReading::of_lateral);
        Ok(Self {
            view: FilmView::Lateral,
            stated: Stated { simultaneous: film.simultaneous, ..Stated::default() },
            bytes,
            image,
            readings: readings.collect::<Result<_, _>>()?,
        })
    }
}

fn has_confidences(film: &Film) -> bool {
    let readings = film.landmarks.corner_readings();
    let mut landmarks = readings.iter().flat_map(|reading| reading.vertebrae.values());
    landmarks.any(|landmark| landmark.confidence.is_some())
}

impl CaseReading {
    fn of(
        reading: &Reading<VertebraLandmarks>,
        crests: Option<IliacCrests>,
    ) -> Result<Self, StoreError> {
        let mut events = Vec::new();
        for (&level, landmark) in &reading.vertebrae {
            for (side, wall) in [Side::Left, Side::Right].into_iter().zip(landmark.walls) {
                let Some(Pixel { column_px, row_px }) = wall else { continue };
                events.push(Event::PlaceWall { level, side, column_px, row_px });
            }
            for (side, pedicle) in [Side::Left, Side::Right].into_iter().zip(landmark.pedicles) {
                let Some(Pixel { column_px, row_px }) = pedicle else { continue };
                events.push(Event::PlacePedicle { level, side, column_px, row_px });
            }
            let named = Corner::FRONTAL.points();
            let corners = named.into_iter().zip(landmark.corners.points());
            if landmark.origins == Corners::all(Origin::Clicked) {
                for (corner, Pixel { column_px, row_px }) in corners {
                    events.push(Event::PlaceCorner { level, corner, column_px, row_px });
                }
            } else {
                let corners =
                    corners.map(|(corner, place)| (corner, [place.column_px, place.row_px]));
                let origins = named.into_iter().zip(landmark.origins.points());
                let origins = origins.filter(|(_, origin)| *origin != Origin::Clicked).collect();
                events.push(Event::TakeVertebra {
                    level,
                    corners: corners.collect(),
                    origins,
                    sd_share: landmark.sd_share,
                });
            }
            if let Some(axis) = landmark.axis_clockwise {
                let axis_deg = Some(spineline_files::written_axis_deg(axis));
                events.push(Event::SetAxis { level, axis_deg });
            }
        }
        if let Some(IliacCrests { left, right }) = crests {
            for (side, place) in [(Side::Left, left), (Side::Right, right)] {
                let (column_px, row_px) = (place.column_px, place.row_px);
                events.push(Event::PlaceIliacCrest { side, column_px, row_px });
            }
        }
        let (observer, repeat) = (Name::new(&reading.id.observer)?, reading.id.repeat);
        Ok(Self { observer, repeat, events })
    }

    fn of_lateral(reading: &Reading<Corners<Pixel>>) -> Result<Self, StoreError> {
        let placed = |(&level, corners): (&Level, &Corners<Pixel>)| {
            let named = Corner::LATERAL.points().into_iter().zip(corners.points());
            named.map(move |(corner, Pixel { column_px, row_px })| Event::PlaceCorner {
                level,
                corner,
                column_px,
                row_px,
            })
        };
        let events = reading.vertebrae.iter().flat_map(placed).collect();
        let (observer, repeat) = (Name::new(&reading.id.observer)?, reading.id.repeat);
        Ok(Self { observer, repeat, events })
    }
}

impl Store {
    /// Adds a case with its films and its finished readings in one transaction.
    ///
    /// # Errors
    /// As [`Store::add_study`], [`Store::add_film`], [`Store::record_all`] and [`Store::finish_reading`].
    pub fn add_case(&mut self, case: &NewCase, by: &Signature) -> Result<AddedCase, StoreError> {
        self.write(by, |ledger| insert_case(ledger, case))
    }

    /// Adds the films of a case to its study, which exists, in one transaction.
    ///
    /// # Errors
    /// As [`Store::add_film`].
    pub fn add_films(&mut self, case: &NewCase, by: &Signature) -> Result<AddedCase, StoreError> {
        self.write(by, |ledger| insert_films(ledger, case))
    }

    /// As [`Store::add_case`], and grants the creator to edit the study, in the same transaction.
    ///
    /// # Errors
    /// As [`Store::add_case`].
    pub fn add_own_case(
        &mut self,
        case: &NewCase,
        by: &Signature,
    ) -> Result<AddedCase, StoreError> {
        self.write(by, |ledger| {
            let added = insert_case(ledger, case)?;
            accounts::set_grant(ledger, &added.study, &by.who, Some(Role::Editor))?;
            Ok(added)
        })
    }
}

fn insert_case(ledger: &Ledger<'_>, case: &NewCase) -> Result<AddedCase, StoreError> {
    films::insert_study(ledger, &case.study)?;
    insert_films(ledger, case)
}

fn insert_films(ledger: &Ledger<'_>, case: &NewCase) -> Result<AddedCase, StoreError> {
    let study = case.study.id.clone();
    let (mut films, mut readings) = (Vec::new(), 0);
    for film in &case.films {
        let new = NewFilm {
            view: film.view,
            stated: film.stated,
            bytes: &film.bytes,
            image: &film.image,
            inverted: film.image["inverted"] == true,
        };
        let added = films::add_film(ledger, &study, &new)?;
        for reading in &film.readings {
            add_reading(ledger, added, reading)?;
            readings += 1;
        }
        films.push(added);
    }
    Ok(AddedCase { study, films, readings, remarks: case.remarks.clone() })
}

/// A complete finished reading, signed by its observer at the time of the import.
fn add_reading(ledger: &Ledger<'_>, film: FilmId, reading: &CaseReading) -> Result<(), StoreError> {
    let by = Signature::new(reading.observer.clone(), ledger.by.at);
    let ledger = Ledger { transaction: ledger.transaction, by: &by };
    let id = readings::begin(&ledger, film, reading.repeat)?;
    if !reading.events.is_empty() {
        journal::append(&ledger, id, Vec::new(), &reading.events)?;
    }
    readings::finish(&ledger, id, &ReadingState::replay(&reading.events, false)).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_with_confidences_says_that_they_stay_in_its_file() {
        let case = |confidence: &str| {
            format!(
                r#"{{"format":"spineline-case","version":1,"case_id":"P1","films":[{{"posture":"erect",
                "image":{{"columns":200,"rows":300,"patient_left":"image_left","file":"a.png"}},
                "readings":[{{"observer":"net","repeat":1,"vertebrae":{{"T5":{{"superior_left":[50,100],
                "superior_right":[90,100],"inferior_left":[50,130],"inferior_right":[90,130]{confidence}}}}}}}]}}]}}"#
            )
        };
        let remarks = |confidence: &str| {
            let bytes_of = |_: &str| Ok::<_, StoreError>(vec![1]);
            NewCase::read(&case(confidence), bytes_of).expect("a case").remarks
        };
        assert_eq!(remarks(""), []);
        assert_eq!(remarks(r#","confidence":[0.9,0.8,0.7,0.6]"#), [CaseRemark::Confidences]);
    }
}
