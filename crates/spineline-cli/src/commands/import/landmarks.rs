//! Landmarks of other programs for the films of a case.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

use spineline::analysis::check_repeated;
use spineline::anatomy::Posture;
use spineline::error::Error;
use spineline::measure::{
    Film, FilmLandmarks, ImageGeometry, LateralCorners, LateralFilm, PlacementSource, Reading,
    judge_landmarks,
};
use spineline::warning::Warnings;
use spineline_landmarks::{
    LandmarkError, LandmarkHint, parse_lateral_csv, read_file, read_landmarks,
};

use super::args::ImportArgs;
use super::resolve::ResolvedFilm;
use crate::run::failure::Failure;
use crate::run::messages::say;

/// What was marked, by posture.
pub type LandmarksByPosture = BTreeMap<Posture, FilmLandmarks>;

impl ResolvedFilm {
    /// How the picture of a frontal film lies.
    pub const fn image(&self) -> ImageGeometry {
        ImageGeometry {
            columns: self.columns,
            rows: self.rows,
            spacing: self.spacing,
            patient_left: self.side,
        }
    }

    /// The lateral film with these readings.
    pub const fn lateral(&self, readings: Vec<Reading<LateralCorners>>) -> LateralFilm {
        LateralFilm {
            columns: self.columns,
            rows: self.rows,
            spacing: self.spacing,
            patient_anterior: self.side,
            simultaneous: self.simultaneous,
            readings,
        }
    }
}

/// Adds the landmarks of a film. Where the film has landmarks from another file, such as one of several DICOM reports, the
/// readings of both are joined; the same reading twice, or other iliac crests, are refused.
fn add(landmarks: &mut LandmarksByPosture, film: Film) -> Result<(), String> {
    let posture = film.posture;
    let first = match landmarks.entry(posture) {
        Entry::Vacant(place) => {
            place.insert(film.landmarks);
            return Ok(());
        }
        Entry::Occupied(first) => first.into_mut(),
    };
    let (
        FilmLandmarks::Corners { readings, iliac_crests, .. },
        FilmLandmarks::Corners { readings: more, iliac_crests: other, .. },
    ) = (first, film.landmarks)
    else {
        return Err(format!("it has landmarks of the {posture} film, which has landmarks already"));
    };
    if let Some(twice) = more.iter().find(|new| readings.iter().any(|old| old.id == new.id)) {
        return Err(format!(
            "it has landmarks of the {posture} film, observer {}, which has landmarks already",
            twice.id
        ));
    }
    if *iliac_crests != other {
        return Err(format!(
            "its iliac crests of the {posture} film differ from those of an earlier file"
        ));
    }
    readings.extend(more);
    Ok(())
}

/// Reads every file of landmarks and lays it on its film; a reading that is given twice is refused.
pub fn read_onto(args: &ImportArgs, films: &[ResolvedFilm]) -> Result<LandmarksByPosture, Failure> {
    let mut landmarks = LandmarksByPosture::new();
    let mut pictures: BTreeMap<String, Posture> = BTreeMap::new();
    for of in &args.landmarks {
        let fail = |error: &LandmarkError| Failure::landmarks(&of.value, error);
        let hint = hint_for(of.posture, films);
        let file = read_landmarks(&of.value, &hint).map_err(|error| fail(&error))?;
        for remark in &file.remarks {
            say(&format!("note: {}: {remark}\n", of.value.display()));
        }
        for marked in file.films {
            let picture = marked.picture.clone();
            let posture = marked.posture.or(hint.posture);
            let film = films.iter().find(|f| posture.is_some() && f.role.posture() == posture);
            let image = film.map(ResolvedFilm::image);
            let film = marked.into_film(hint.posture, image).map_err(|error| fail(&error))?;
            refuse_placements(&of.value, &film)?;
            for warning in judge_landmarks(&film).all() {
                let level = warning.level.map_or_else(String::new, |level| format!(", {level}"));
                let (posture, text) = (film.posture, warning.text());
                say(&format!("note: {}: {posture} film{level}: {text}\n", of.value.display()));
            }
            let other = picture.and_then(|name| {
                let other = pictures.insert(name.clone(), film.posture)?;
                (other != film.posture).then_some((name, other))
            });
            if let Some((name, other)) = other {
                say(&format!(
                    "note: {}: the landmarks of the {} film and of the {other} film name one picture, {name}: check that they are of two films\n",
                    of.value.display(),
                    film.posture
                ));
            }
            add(&mut landmarks, film).map_err(|what| {
                let help = "give every reading of a film once, with the same iliac crests; one file of landmarks per film \
                            unless each holds another reading";
                Failure::input(&of.value.display().to_string(), &what, help)
            })?;
        }
    }
    check_all(&landmarks)?;
    let unmatched = landmarks.keys().find(|&&p| !films.iter().any(|f| f.role.posture() == Some(p)));
    match unmatched {
        Some(posture) => Err(Failure::usage(format!(
            "the landmarks are of the {posture} film, but no such film was chosen: add --film {}=…",
            posture.key().replace('_', "-")
        ))),
        None => Ok(landmarks),
    }
}

/// Reads every table of landmarks on the lateral film, and checks them there.
pub fn read_lateral(
    args: &ImportArgs,
    film: &ResolvedFilm,
) -> Result<Vec<Reading<LateralCorners>>, Failure> {
    let mut readings: Vec<Reading<LateralCorners>> = Vec::new();
    for path in &args.lateral_landmarks {
        let found = read_file(path)
            .and_then(|bytes| parse_lateral_csv(&bytes, &LandmarkHint::default()))
            .map_err(|error| Failure::landmarks(path, &error))?;
        readings.extend(found);
        let mut warnings = Warnings::default();
        let marked = film.lateral(readings.clone());
        marked
            .measure(&mut warnings)
            .map_err(|error| Failure::input(&path.display().to_string(), &error, error.help()))?;
        for warning in warnings.all() {
            say(&format!("note: {}: lateral film: {}\n", path.display(), warning.text()));
        }
    }
    Ok(readings)
}

/// What is known before a file is read: one that is for one film may need that film's picture.
fn hint_for(posture: Option<Posture>, films: &[ResolvedFilm]) -> LandmarkHint {
    let only = match (posture, films) {
        (Some(posture), films) => films.iter().find(|f| f.role.posture() == Some(posture)),
        (None, [film]) => Some(film),
        (None, _) => None,
    };
    LandmarkHint {
        posture: posture.or(only.and_then(|film| film.role.posture())),
        patient_left: only.map(|film| film.side),
        image: only.map(ResolvedFilm::image),
        ..LandmarkHint::default()
    }
}

/// Refuses landmarks that have no corners in a picture.
fn refuse_placements(file: &Path, film: &Film) -> Result<(), Failure> {
    let FilmLandmarks::Placements { source, .. } = &film.landmarks else {
        return Ok(());
    };
    let what = format!(
        "it has locations and tilts of the {} film, but no corners in its picture",
        film.posture
    );
    let help = match source {
        PlacementSource::Vertebrae => {
            "such a case needs no picture: write the locations into a case file"
        }
        PlacementSource::SurfaceMidline => {
            "a midline needs no picture: make a case of it with `spineline import --midlines`"
        }
    };
    Err(Failure::input(&file.display().to_string(), &what, help))
}

/// Refuses landmarks of one film for two postures, in whatever formats they came.
fn check_all(landmarks: &LandmarksByPosture) -> Result<(), Failure> {
    let film = |(&posture, landmarks): (&Posture, &FilmLandmarks)| Film {
        posture,
        landmarks: landmarks.clone(),
    };
    let films: Vec<Film> = landmarks.iter().map(film).collect();
    check_repeated(&films).map_err(|error| {
        let error = Error::from(error);
        Failure::input("the landmarks", &error, error.help())
    })
}
