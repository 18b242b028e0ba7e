//! Landmarks of other programs for the films of a case.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use spineline::anatomy::Posture;
use spineline::measure::{Film, FilmLandmarks, ImageGeometry};
use spineline_landmarks::{LandmarkError, LandmarkHint, read_landmarks};

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
    for of in &args.landmarks {
        let fail = |error: &LandmarkError| Failure::landmarks(&of.value, error);
        // A file that is for one film may need that film's picture to be read.
        let only = match (of.posture, films) {
            (Some(posture), films) => films.iter().find(|f| f.role.posture() == Some(posture)),
            (None, [film]) => Some(film),
            (None, _) => None,
        };
        let hint = LandmarkHint {
            posture: of.posture.or(only.and_then(|film| film.role.posture())),
            patient_left: only.map(|film| film.side),
            image: only.map(ResolvedFilm::image),
            ..LandmarkHint::default()
        };
        let file = read_landmarks(&of.value, &hint).map_err(|error| fail(&error))?;
        for remark in &file.remarks {
            say(&format!("note: {}: {remark}\n", of.value.display()));
        }
        for marked in file.films {
            let posture = marked.posture.or(hint.posture);
            let film = films.iter().find(|f| posture.is_some() && f.role.posture() == posture);
            let image = film.map(ResolvedFilm::image);
            let film = marked.into_film(hint.posture, image).map_err(|error| fail(&error))?;
            if matches!(film.landmarks, FilmLandmarks::Placements { .. }) {
                let what = format!(
                    "it has locations and tilts of the {} film, but no corners in its picture",
                    film.posture
                );
                let help = "such a case needs no picture: write the locations into a case file";
                return Err(Failure::input(&of.value.display().to_string(), &what, help));
            }
            add(&mut landmarks, film).map_err(|what| {
                let help = "give every reading of a film once, with the same iliac crests; one file of landmarks per film \
                            unless each holds another reading";
                Failure::input(&of.value.display().to_string(), &what, help)
            })?;
        }
    }
    let unmatched = landmarks.keys().find(|&&p| !films.iter().any(|f| f.role.posture() == Some(p)));
    match unmatched {
        Some(posture) => Err(Failure::usage(format!(
            "the landmarks are of the {posture} film, but no such film was chosen: add --film {}=…",
            posture.key().replace('_', "-")
        ))),
        None => Ok(landmarks),
    }
}
