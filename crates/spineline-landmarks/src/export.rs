//! Landmarks of a case for other programs.

use std::collections::BTreeMap;
use std::path::Path;

use spineline::analysis::Case;
use spineline::anatomy::{Posture, Region};
use spineline::clinical::CobbEnds;
use spineline::measure::{
    Film, FilmLandmarks, IliacCrests, ImageGeometry, PlacementSource, Reading, VertebraLandmarks,
};
use spineline_files::CaseFile;

use super::identity::Identity;
use super::{LandmarkExportError, ReportOf, SourceImage, coco, csv, labelme, slicer, write_sr};

/// Formats for writing landmarks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LandmarkTarget<'a> {
    /// One table of all films.
    Csv,
    /// Point lists of 3D Slicer, one file per film.
    Slicer,
    /// Named points of labelme, one file per reading.
    Labelme {
        /// Names of the pictures, beside the files; a film without one has `POSTURE.png`.
        pictures: &'a BTreeMap<Posture, String>,
    },
    /// Keypoints of COCO, one dataset of all films.
    Coco {
        /// Names of the pictures; a film without one has `POSTURE.png`.
        pictures: &'a BTreeMap<Posture, String>,
    },
    /// DICOM reports, one per reading: a report is by one observer.
    DicomSr {
        /// The radiographs on which the landmarks were placed.
        sources: &'a BTreeMap<Posture, SourceImage>,
        /// The end vertebrae of the Cobb angles.
        curves: &'a [(Region, CobbEnds)],
        /// Date and time of the reports in UTC, as DICOM writes them: `20260131` and `235959`.
        written: [&'a str; 2],
    },
}

/// One file of an export.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportedFile {
    /// A name for it among the files of the export, without data of the patient or an observer.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

impl LandmarkTarget<'_> {
    /// The parts of a case that this format leaves out.
    #[must_use]
    pub fn left_out(self, case: &Case) -> Vec<&'static str> {
        let landmarks = || {
            let readings = case.films.iter().flat_map(|film| film.landmarks.corner_readings());
            readings.flat_map(|reading| reading.vertebrae.values())
        };
        let (axes, confidences) = match self {
            Self::Csv => (false, false),
            Self::Slicer => (true, true),
            Self::Labelme { .. } | Self::Coco { .. } => (true, false),
            Self::DicomSr { .. } => (false, true),
        };
        let mut left_out = Vec::new();
        if axes && landmarks().any(|landmark| landmark.axis_clockwise.is_some()) {
            left_out.push("axes that were set by hand");
        }
        if confidences && landmarks().any(|landmark| landmark.confidence.is_some()) {
            left_out.push("confidences");
        }
        // All formats have the origins of corners; these show the full uncertainty only if all corners were placed.
        let states_uncertainty = |landmark: &VertebraLandmarks| {
            landmark.walls != [None; 2] || landmark.sd_share.is_some()
        };
        if self != Self::Csv && landmarks().any(states_uncertainty) {
            left_out.push(
                "walls that corners were completed from and deviations of detected ones, and so their uncertainty",
            );
        }
        if self != Self::Csv && landmarks().any(|landmark| landmark.pedicles != [None; 2]) {
            left_out.push("pedicles");
        }
        if case.lateral.as_ref().is_some_and(|film| !film.readings.is_empty()) {
            left_out.push("landmarks of the lateral film (`--to lateral-csv` has them)");
        }
        left_out
    }
}

/// The landmarks of a case, of one posture or of all. The same case gives the same bytes.
///
/// # Errors
/// [`LandmarkExportError`] for what the format cannot hold.
pub fn export_landmarks(
    case: &Case,
    posture: Option<Posture>,
    target: LandmarkTarget<'_>,
) -> Result<Vec<ExportedFile>, LandmarkExportError> {
    let films = films(case, posture)?;
    match target {
        LandmarkTarget::Csv => {
            let bytes = csv::text(&csv::rows(&films)?)?.into_bytes();
            Ok(vec![ExportedFile { name: "landmarks.csv".to_owned(), bytes }])
        }
        LandmarkTarget::Slicer => films
            .into_iter()
            .map(|film| {
                let name = format!("{}.mrk.json", film.posture.key());
                Ok(ExportedFile { name, bytes: slicer::write(film)?.into_bytes() })
            })
            .collect(),
        LandmarkTarget::Labelme { pictures } => {
            let mut files = Vec::new();
            for film in films {
                files.extend(annotations(film, &picture(pictures, film.posture))?);
            }
            Ok(files)
        }
        LandmarkTarget::Coco { pictures } => {
            let films = films.into_iter().map(|film| {
                let (image, iliac_crests, readings) = corners(film)?;
                let (posture, picture) = (film.posture, picture(pictures, film.posture));
                Ok(coco::CocoFilm { posture, image, picture, iliac_crests, readings })
            });
            let bytes = coco::write(films.collect::<Result<_, _>>()?).into_bytes();
            Ok(vec![ExportedFile { name: "landmarks.coco.json".to_owned(), bytes }])
        }
        LandmarkTarget::DicomSr { sources, curves, written } => {
            let mut files = Vec::new();
            for film in films {
                let source = sources.get(&film.posture).ok_or_else(|| {
                    LandmarkExportError::Source(format!(
                        "{} film: the case names no DICOM file for it",
                        film.posture
                    ))
                })?;
                files.extend(reports(film, source, curves, written)?);
            }
            Ok(files)
        }
    }
}

/// The frontal films of a case, of one posture or of all, checked for every format.
fn films(case: &Case, posture: Option<Posture>) -> Result<Vec<&Film>, LandmarkExportError> {
    let mut films: Vec<&Film> =
        case.films.iter().filter(|film| posture.is_none_or(|p| p == film.posture)).collect();
    films.sort_by_key(|film| film.posture);
    if films.is_empty() {
        return Err(LandmarkExportError::NoFilm(posture.unwrap_or(Posture::Erect)));
    }
    for film in &films {
        check(film)?;
    }
    Ok(films)
}

/// The cells of the table of all frontal films, row by row, the heading first.
///
/// # Errors
/// [`LandmarkExportError`], as [`export_landmarks`] with [`LandmarkTarget::Csv`].
pub fn landmark_rows(case: &Case) -> Result<Vec<Vec<String>>, LandmarkExportError> {
    csv::rows(&films(case, None)?)
}

/// The cells of the table of a case's lateral film, row by row, the heading first.
///
/// # Errors
/// [`LandmarkExportError`] for a case without such landmarks, and for what a table cannot hold.
pub fn lateral_rows(case: &Case) -> Result<Vec<Vec<String>>, LandmarkExportError> {
    let nothing = || LandmarkExportError::Nothing { what: "lateral film".to_owned() };
    csv::lateral_rows(case.lateral.as_ref().ok_or_else(nothing)?)
}

/// The landmarks of a case's lateral film as a table, which [`parse_lateral_csv`](super::parse_lateral_csv) reads.
///
/// # Errors
/// [`LandmarkExportError`], as [`lateral_rows`].
pub fn export_lateral(case: &Case) -> Result<ExportedFile, LandmarkExportError> {
    let bytes = csv::text(&lateral_rows(case)?)?.into_bytes();
    Ok(ExportedFile { name: "lateral.csv".to_owned(), bytes })
}

/// The names of the pictures that a case names and other programs can open, which leaves out DICOM files.
#[must_use]
pub fn openable_pictures(file: &CaseFile, case: &Case) -> BTreeMap<Posture, String> {
    let named = case.films.iter().filter_map(|film| {
        let name = file.source(film.posture)?.file?;
        let is_dicom =
            Path::new(&name).extension().is_none_or(|end| end.eq_ignore_ascii_case("dcm"));
        (!is_dicom).then_some((film.posture, name))
    });
    named.collect()
}

/// The picture of a film by name.
fn picture(pictures: &BTreeMap<Posture, String>, posture: Posture) -> String {
    pictures.get(&posture).cloned().unwrap_or_else(|| format!("{}.png", posture.key()))
}

/// A film's corners: picture, crests and readings.
fn corners(film: &Film) -> Result<CornersOfFilm<'_>, LandmarkExportError> {
    match &film.landmarks {
        FilmLandmarks::Corners { image, iliac_crests, readings } => {
            Ok((image, *iliac_crests, readings))
        }
        FilmLandmarks::Placements { .. } => Err(LandmarkExportError::NoCorners(film.posture)),
    }
}

type CornersOfFilm<'a> = (&'a ImageGeometry, Option<IliacCrests>, &'a [Reading<VertebraLandmarks>]);

/// The labelme files of a film; each has the crests.
fn annotations(film: &Film, picture: &str) -> Result<Vec<ExportedFile>, LandmarkExportError> {
    let (image, iliac_crests, readings) = corners(film)?;
    let files = readings.iter().enumerate().map(|(place, reading)| {
        let identity = Identity::of_film(film.posture).with_reading(&reading.id);
        let text = labelme::write(identity, image, picture, iliac_crests, reading);
        let name = format!("{}-{}.json", film.posture.key(), place + 1);
        ExportedFile { name, bytes: text.into_bytes() }
    });
    Ok(files.collect())
}

fn reports(
    film: &Film,
    source: &SourceImage,
    curves: &[(Region, CobbEnds)],
    written: [&str; 2],
) -> Result<Vec<ExportedFile>, LandmarkExportError> {
    let posture = film.posture;
    let (image, iliac_crests, readings) = corners(film)?;
    let mut files = Vec::new();
    for (place, reading) in readings.iter().enumerate() {
        let report = ReportOf { posture, image, iliac_crests, reading, curves, source, written };
        let name = format!("{}-{}.dcm", posture.key(), place + 1);
        files.push(ExportedFile { name, bytes: write_sr(&report)? });
    }
    Ok(files)
}

/// Checks for every format: readings, vertebrae, and numbers.
fn check(film: &Film) -> Result<(), LandmarkExportError> {
    match &film.landmarks {
        FilmLandmarks::Corners { readings, .. } => check_readings(film, readings, |landmark| {
            landmark.corners.points().iter().all(|point| point.is_finite())
        }),
        FilmLandmarks::Placements { source: PlacementSource::SurfaceMidline, .. } => {
            Err(LandmarkExportError::Estimated(film.posture))
        }
        FilmLandmarks::Placements { readings, .. } => check_readings(film, readings, |placed| {
            placed.location.is_finite() && placed.tilt.rad().is_finite()
        }),
    }
}

fn check_readings<V>(
    film: &Film,
    readings: &[Reading<V>],
    is_finite: impl Fn(&V) -> bool,
) -> Result<(), LandmarkExportError> {
    if readings.is_empty() {
        return Err(LandmarkExportError::Nothing { what: format!("{} film", film.posture) });
    }
    for reading in readings {
        let what = format!("{} film, observer {}", film.posture, reading.id);
        if reading.vertebrae.is_empty() {
            return Err(LandmarkExportError::Nothing { what });
        }
        if let Some((&level, _)) =
            reading.vertebrae.iter().find(|(_, vertebra)| !is_finite(vertebra))
        {
            return Err(LandmarkExportError::Corner { what, level });
        }
    }
    Ok(())
}
