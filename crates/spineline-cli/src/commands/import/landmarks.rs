//! Landmarks of other programs for the films of a case.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

use spineline::analysis::check_repeated;
use spineline::anatomy::Posture;
use spineline::error::Error;
use spineline::measure::{
    Corners, Film, FilmLandmarks, LateralFilm, PlacementSource, Reading, ReadingId, alike_names,
    alike_words, judge_landmarks,
};
use spineline::spatial::Pixel;
use spineline::warning::Warnings;
use spineline_files::{PROVENANCE_FORMAT, file_format, read_text};
use spineline_landmarks::{
    LandmarkError, LandmarkHint, parse_lateral_csv, read_file, read_landmarks,
};

use super::args::ImportArgs;
use super::assignment::Assignment;
use super::pictures::Pictures;
use super::resolve::ResolvedFilm;
use crate::run::failure::Failure;
use crate::run::messages::say;

pub type LandmarksByPosture = BTreeMap<Posture, FilmLandmarks>;

impl ResolvedFilm {
    pub const fn lateral(&self, readings: Vec<Reading<Corners<Pixel>>>) -> LateralFilm {
        LateralFilm { image: self.image, simultaneous: self.simultaneous, readings }
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
    if let Some(found) = other {
        match *iliac_crests {
            None => *iliac_crests = Some(found),
            Some(first) if first == found => {}
            Some(_) => {
                return Err(format!(
                    "its iliac crests of the {posture} film differ from an earlier file"
                ));
            }
        }
    }
    readings.extend(more);
    Ok(())
}

/// Reads every file of landmarks and lays it on its film; a reading that is given twice is refused.
pub fn read_onto(
    args: &ImportArgs,
    films: &[ResolvedFilm],
    pictures: &Pictures,
) -> Result<LandmarksByPosture, Failure> {
    let mut landmarks = LandmarksByPosture::new();
    let mut named: BTreeMap<String, Posture> = BTreeMap::new();
    let frontal: Vec<Posture> = films.iter().filter_map(|film| film.view.posture()).collect();
    let only = if let [one] = frontal[..] { Some(one) } else { None };
    for of in &args.landmarks {
        let fail = |error: &LandmarkError| Failure::landmarks(&of.value, error);
        if is_provenance(&of.value) {
            say(format!(
                "note: {} is passed over: it is an output (`{PROVENANCE_FORMAT}`), not a file of landmarks",
                of.value.display()
            ));
            continue;
        }
        let given = args.reading_of(&of.value);
        let hint = hint_for(of.posture.or(only), films, given);
        let file = read_landmarks(&of.value, &hint).map_err(|error| fail(&error))?;
        for remark in &file.remarks {
            say(format!("note: {}: {remark}", of.value.display()));
        }
        let assignment = Assignment { args, of, pictures, only };
        for (posture, marked) in assignment.films(file.films)? {
            let picture = marked.picture.clone();
            let film = films.iter().find(|film| film.view.posture() == Some(posture));
            let Some(film) = film else { return Err(not_chosen(&of.value, posture)) };
            let film = marked
                .into_film(of.posture.or(Some(posture)), Some(film.image))
                .map_err(|error| fail(&error))?;
            refuse_placements(&of.value, &film)?;
            if let Some(given) = given {
                refuse_other_readings(&of.value, given, &film)?;
            }
            note_warnings(&of.value, &film);
            let other = picture.and_then(|name| {
                let other = named.insert(name.clone(), film.posture)?;
                (other != film.posture).then_some((name, other))
            });
            if let Some((name, other)) = other {
                say(format!(
                    "note: {}: the landmarks of the {} film and of the {other} film name one picture, {name}: check that they are of two films",
                    of.value.display(),
                    film.posture
                ));
            }
            add(&mut landmarks, film).map_err(|what| {
                let help = "give every reading of a film once, with the same iliac crests; where two files state no observer, name it with --reading FILE=OBSERVER:REPEAT";
                Failure::input(of.value.display(), what, help)
            })?;
        }
    }
    Ok(landmarks)
}

/// Whether it is the list of files that `export` writes beside several files of landmarks. Only files of its name are read.
fn is_provenance(path: &Path) -> bool {
    let format = || read_text(path).ok().and_then(|text| file_format(&text));
    path.to_string_lossy().ends_with("provenance.json")
        && format().as_deref() == Some(PROVENANCE_FORMAT)
}

fn not_chosen(file: &Path, posture: Posture) -> Failure {
    Failure::usage(format!(
        "{}: the landmarks are of the {posture} film, which was not chosen: add --film {}=…",
        file.display(),
        posture.key().replace('_', "-")
    ))
}

fn note_warnings(file: &Path, film: &Film) {
    for warning in judge_landmarks(film).all() {
        let level = warning.level.map_or_else(String::new, |level| format!(", {level}"));
        let (posture, text) = (film.posture, warning.text());
        say(format!("note: {}: {posture} film{level}: {text}", file.display()));
    }
}

/// Refuses a file whose reading differs from the given one.
fn refuse_other_readings(file: &Path, given: &ReadingId, film: &Film) -> Result<(), Failure> {
    match film.landmarks.reading_ids().into_iter().find(|id| *id != given) {
        None => Ok(()),
        Some(other) => {
            let what = format!("it states observer {other}, and --reading says {given}");
            let help = "leave --reading out: it is for files that state no observer";
            Err(Failure::input(file.display(), what, help))
        }
    }
}

/// Notes names of observers that differ by capitals and marks alone.
pub fn note_alike_observers(landmarks: &LandmarksByPosture, lateral: Option<&LateralFilm>) {
    let frontal = landmarks.values().flat_map(FilmLandmarks::reading_ids);
    let lateral = lateral.iter().flat_map(|film| &film.readings).map(|reading| &reading.id);
    for alike in alike_names(frontal.chain(lateral).map(|id| id.observer.as_str())) {
        say(format!("note: {}", alike_words(&alike)));
    }
}

/// Reads every table of landmarks on the lateral film, and checks them there.
pub fn read_lateral(
    args: &ImportArgs,
    film: &ResolvedFilm,
) -> Result<Vec<Reading<Corners<Pixel>>>, Failure> {
    let mut readings: Vec<Reading<Corners<Pixel>>> = Vec::new();
    for path in &args.lateral_landmarks {
        let reading = args.reading_of(path).cloned();
        let default = LandmarkHint::default();
        let hint = LandmarkHint { reading: reading.unwrap_or(default.reading), ..default };
        let found = read_file(path)
            .and_then(|bytes| parse_lateral_csv(&bytes, &hint))
            .map_err(|error| Failure::landmarks(path, &error))?;
        readings.extend(found);
        let mut warnings = Warnings::default();
        let marked = film.lateral(readings.clone());
        marked.measure(&mut warnings).map_err(|error| Failure::of(path.display(), &error))?;
        for warning in warnings.all() {
            say(format!("note: {}: lateral film: {}", path.display(), warning.text()));
        }
    }
    Ok(readings)
}

/// Facts that a reader of landmarks may need and that the file may lack: side, size and picture of the film. The posture is left out, since
/// the posture in the file goes first.
fn hint_for(
    posture: Option<Posture>,
    films: &[ResolvedFilm],
    reading: Option<&ReadingId>,
) -> LandmarkHint {
    let film = films.iter().find(|film| posture.is_some() && film.view.posture() == posture);
    let default = LandmarkHint::default();
    LandmarkHint {
        patient_left: film.map(|film| film.image.patient_left),
        image: film.map(|film| film.image),
        reading: reading.cloned().unwrap_or(default.reading),
        ..default
    }
}

/// Refuses landmarks without corners in a picture.
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
            "such a case needs no picture: read the file with `spineline.Film` in Python, or write the locations into a case file"
        }
        PlacementSource::SurfaceMidline => {
            "a midline needs no picture: make a case of it with `spineline import --midlines`"
        }
    };
    Err(Failure::input(file.display(), what, help))
}

/// Refuses landmarks of one film for two postures or views, in whatever formats they came.
pub fn check_all(
    landmarks: &LandmarksByPosture,
    lateral: Option<&LateralFilm>,
) -> Result<(), Failure> {
    let film =
        |(&posture, landmarks): (&Posture, &FilmLandmarks)| Film::new(posture, landmarks.clone());
    let films: Vec<Film> = landmarks.iter().map(film).collect();
    check_repeated(&films, lateral)
        .map_err(|error| Failure::of("the landmarks", &Error::from(error)))
}
