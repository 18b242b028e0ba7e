//! Checks the pictures beside a case: each film has its own picture, the one with its landmarks, of the same patient and part of the body.

use std::path::{Path, PathBuf};

use spineline::analysis::Case;
use spineline::anatomy::{FilmView, Posture};
use spineline::measure::FilmLandmarks;
use spineline::warning::{WarningCode, Warnings};
use spineline_files::{CaseFile, FilmSource};
use spineline_films::{FilmError, Stated, film_doubts};
use spineline_landmarks::{parse_source, read_source};

use crate::run::failure::Failure;
use crate::run::film_decoder::{Decoder, case_film_bytes};

/// A film of a case whose picture lies beside the case.
struct Beside {
    /// `None` for the lateral film.
    posture: Option<Posture>,
    size: (u32, u32),
    place: PathBuf,
    /// As the case states it.
    source: FilmSource,
}

impl Beside {
    fn name(&self) -> String {
        self.posture.map_or_else(|| "lateral film".to_owned(), |posture| format!("{posture} film"))
    }

    fn warn(&self, code: WarningCode, text: String, warnings: &mut Warnings) {
        match self.posture {
            Some(posture) => warnings.film(code, posture, text),
            None => warnings.push(code, text),
        }
    }

    /// Warns that the film may not belong to the case.
    fn doubt(&self, code: WarningCode, why: &str, warnings: &mut Warnings) {
        // A warning without a posture names the lateral film itself.
        let place = self.posture.map_or_else(|| format!("{}: ", self.name()), |_| String::new());
        self.warn(code, format!("{place}{why}: check that it belongs to this case"), warnings);
    }

    /// Why these bytes are not the film with the landmarks: by their SHA-256, by their size, or because they are not a film.
    fn other_file(&self, decoder: &Decoder, bytes: &[u8]) -> Option<String> {
        if let Some(why) = self.source.other_bytes(bytes) {
            return Some(why);
        }
        // The size that a DICOM file states needs no decoder.
        if let Ok(source) = parse_source(bytes, "") {
            return other_size(source.size, self.size);
        }
        match decoder.decode(bytes.to_vec()) {
            Ok(film) => other_size((film.columns, film.rows), self.size),
            // The file with the landmarks, by its SHA-256.
            Err(_) if self.source.sha256.is_some() => None,
            // The decoder says nothing about the file.
            Err(
                FilmError::DecoderStart { .. }
                | FilmError::DecoderTimeout { .. }
                | FilmError::DecoderMemory { .. }
                | FilmError::DecoderAnswer
                | FilmError::TooLarge { .. },
            ) => None,
            Err(error) => Some(format!("its file cannot be read as a film ({error})")),
        }
    }
}

/// Why a picture of this size, columns first, is not the film with the landmarks, if the case states another size.
pub fn other_size(found: (u32, u32), stated: (u32, u32)) -> Option<String> {
    (found != stated).then(|| {
        format!(
            "it has {} × {} pixels, but the film with the landmarks {} × {}",
            found.0, found.1, stated.0, stated.1
        )
    })
}

/// Compares the pictures that lie beside a case; missing pictures are skipped.
///
/// # Errors
/// If two films have the same pixels, in whatever files.
pub fn check_films(path: &Path, file: &CaseFile, case: &Case) -> Result<Warnings, Failure> {
    let (films, decoder) = (beside(path, file, case), Decoder::new()?);
    if films.len() > 1 {
        check_pixels(path, &films, &decoder)?;
    }
    let mut found = Warnings::default();
    warn_of_same_identifiers(&films, &mut found);
    warn_of_wrong_films(&films, &decoder, &mut found);
    Ok(found)
}

fn beside(path: &Path, file: &CaseFile, case: &Case) -> Vec<Beside> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let frontal = case.films.iter().filter_map(|film| {
        let FilmLandmarks::Corners { image, .. } = &film.landmarks else { return None };
        let size = (image.columns, image.rows);
        Some((Some(film.posture), size, file.source(film.posture)?))
    });
    let lateral = case.lateral.as_ref().and_then(|film| {
        Some((None, (film.image.columns, film.image.rows), file.source(FilmView::Lateral)?))
    });
    let placed = frontal.chain(lateral).filter_map(|(posture, size, source)| {
        // `CaseFile::into_case` refuses a name in another folder.
        let place = folder.join(source.file.as_ref()?);
        Some(Beside { posture, size, place, source })
    });
    placed.filter(|film| film.place.exists()).collect()
}

/// Decodes the films of equal size: only these can be the same picture.
fn check_pixels(path: &Path, films: &[Beside], decoder: &Decoder) -> Result<(), Failure> {
    let mut known: Vec<(&Beside, String)> = Vec::new();
    for film in films {
        let alike = films.iter().filter(|other| other.size == film.size).count();
        let Some(picture) = (alike > 1).then(|| picture(decoder, &film.place)).flatten() else {
            continue;
        };
        if let Some((other, _)) = known.iter().find(|(_, of)| *of == picture) {
            let what = format!("the {} and the {} are the same picture", other.name(), film.name());
            let help = "give each film its own picture, or leave the repeated one out of the case";
            return Err(Failure::input(path.display(), what, help));
        }
        known.push((film, picture));
    }
    Ok(())
}

fn picture(decoder: &Decoder, place: &Path) -> Option<String> {
    decoder.decode(case_film_bytes(place).ok()?).ok().map(|film| film.picture_sha256())
}

/// Warns of files other than those with the landmarks, and of films of another part of the body or another patient, if their files
/// are DICOM.
fn warn_of_wrong_films(films: &[Beside], decoder: &Decoder, warnings: &mut Warnings) {
    let mut all_stated = Vec::new();
    for film in films {
        let bytes = case_film_bytes(&film.place).ok();
        let unread = || Some("its file cannot be read".to_owned());
        if let Some(why) = bytes.as_ref().map_or_else(unread, |all| film.other_file(decoder, all)) {
            film.doubt(WarningCode::PictureDiffers, &why, warnings);
        }
        let stated = bytes.and_then(|bytes| Stated::read(&bytes).ok()).unwrap_or_default();
        all_stated.push((film.name(), stated));
    }
    for (film, doubts) in films.iter().zip(film_doubts(&all_stated)) {
        for doubt in doubts {
            film.doubt(doubt.code, &doubt.text, warnings);
        }
    }
}

fn warn_of_same_identifiers(films: &[Beside], warnings: &mut Warnings) {
    let mut known: Vec<(&Beside, String)> = Vec::new();
    for film in films {
        let Ok(source) = read_source(&film.place) else { continue };
        let uid = source.sop_instance_uid;
        if let Some((other, _)) = known.iter().find(|(_, of)| *of == uid) {
            let text = format!(
                "the {} and the {} have the same SOP Instance UID but different pixels: one was changed without a new identifier; check that they are two films",
                other.name(),
                film.name()
            );
            film.warn(WarningCode::IdentifierRepeated, text, warnings);
        }
        known.push((film, uid));
    }
}
