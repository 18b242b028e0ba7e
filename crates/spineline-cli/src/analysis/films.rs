//! Checks the pictures beside a case: each film has its own picture, of the same patient and part of the body.

use std::path::{Path, PathBuf};

use spineline::analysis::Case;
use spineline::anatomy::Posture;
use spineline::measure::FilmLandmarks;
use spineline::warning::{WarningCode, Warnings};
use spineline_files::CaseFile;
use spineline_films::{Stated, film_doubts};
use spineline_landmarks::read_source;

use crate::run::failure::Failure;
use crate::run::film_decoder::{Decoder, film_bytes};

/// A film of a case whose picture lies beside the case.
struct Beside {
    /// `None` for the lateral film.
    posture: Option<Posture>,
    size: (u32, u32),
    place: PathBuf,
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
}

/// Compares the pictures that lie beside a case; missing and unreadable pictures are skipped.
///
/// # Errors
/// If two films have the same pixels, in whatever files.
pub fn check_films(path: &Path, file: &CaseFile, case: &Case) -> Result<Warnings, Failure> {
    let films = beside(path, file, case);
    if films.len() > 1 {
        check_pixels(path, &films)?;
    }
    let mut found = Warnings::default();
    warn_of_same_identifiers(&films, &mut found);
    warn_of_wrong_films(&films, &mut found);
    Ok(found)
}

fn beside(path: &Path, file: &CaseFile, case: &Case) -> Vec<Beside> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let frontal = case.films.iter().filter_map(|film| {
        let FilmLandmarks::Corners { image, .. } = &film.landmarks else { return None };
        let size = (image.columns, image.rows);
        Some((Some(film.posture), size, file.source(film.posture)?.file?))
    });
    let lateral = case.lateral.as_ref().and_then(|film| {
        Some((None, (film.image.columns, film.image.rows), file.lateral_source()?.file?))
    });
    let named = frontal.chain(lateral);
    // `CaseFile::into_case` refuses a name in another folder.
    let placed =
        named.map(|(posture, size, name)| Beside { posture, size, place: folder.join(name) });
    placed.filter(|film| film.place.is_file()).collect()
}

/// Decodes the films of equal size: only these can be the same picture.
fn check_pixels(path: &Path, films: &[Beside]) -> Result<(), Failure> {
    let decoder = Decoder::new()?;
    let mut known: Vec<(&Beside, String)> = Vec::new();
    for film in films {
        let alike = films.iter().filter(|other| other.size == film.size).count();
        let Some(picture) = (alike > 1).then(|| picture(&decoder, &film.place)).flatten() else {
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
    decoder.decode(film_bytes(place).ok()?).ok().map(|film| film.picture_sha256())
}

/// Warns of films of another part of the body or another patient, if their files are DICOM.
fn warn_of_wrong_films(films: &[Beside], warnings: &mut Warnings) {
    let stated = |film: &Beside| {
        let bytes = film_bytes(&film.place).ok();
        let stated = bytes.and_then(|bytes| Stated::read(&bytes).ok()).unwrap_or_default();
        (film.name(), stated)
    };
    let doubts = film_doubts(&films.iter().map(stated).collect::<Vec<_>>());
    for (film, doubts) in films.iter().zip(doubts) {
        for doubt in doubts {
            // A warning without a posture names the lateral film itself.
            let place =
                film.posture.map_or_else(|| format!("{}: ", film.name()), |_| String::new());
            let text = format!("{place}{}: check that it belongs to this case", doubt.text);
            film.warn(doubt.code, text, warnings);
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
