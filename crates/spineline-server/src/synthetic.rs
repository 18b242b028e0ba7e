//! Synthetic patients as files: the films of a phantom as DICOM, and the case that names them.

use std::collections::BTreeMap;

use spineline::anatomy::Posture;
use spineline_files::{CaseFile, FilmSource, sha256_hex};
use spineline_films::{
    DicomFilm, Encoding, FilmPolarity, WriteFilmError, pixels_sha256, write_dicom,
};
use spineline_phantom::{Phantom, Polarity, Radiograph, TrueFilm};

/// Magnification in the films' files.
const MAGNIFICATION: f64 = 1.1;

/// A rendered and written film.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnFilm {
    /// Name of its file, beside the case.
    pub file: String,
    /// The DICOM file.
    pub bytes: Vec<u8>,
    /// Polarity in DICOM's terms.
    pub photometric_interpretation: &'static str,
    /// Hash of the stored values as 16-bit little-endian words, row by row.
    pub pixels_sha256: String,
}

/// Draws a film of a phantom and writes it as DICOM.
pub fn draw_film(
    phantom: &Phantom,
    film: &TrueFilm,
    encoding: Encoding,
) -> Result<DrawnFilm, WriteFilmError> {
    let radiograph = Radiograph::of(film);
    let (polarity, photometric_interpretation) = match radiograph.polarity {
        Polarity::Monochrome1 => (FilmPolarity::Monochrome1, "MONOCHROME1"),
        Polarity::Monochrome2 => (FilmPolarity::Monochrome2, "MONOCHROME2"),
    };
    let bytes = write_dicom(&DicomFilm {
        case_id: &phantom.case.id,
        subject: &phantom.case.subject,
        posture: film.posture,
        image: radiograph.image,
        magnification: MAGNIFICATION,
        polarity,
        bits_stored: radiograph.bits_stored,
        pixels: &radiograph.pixels,
        encoding,
    })?;
    Ok(DrawnFilm {
        file: format!("{}-{}.dcm", phantom.case.id, film.posture.key()),
        pixels_sha256: pixels_sha256(&radiograph.pixels),
        bytes,
        photometric_interpretation,
    })
}

/// The case of a phantom with the file of each film named.
#[must_use]
pub fn case_file(phantom: &Phantom, films: &BTreeMap<Posture, DrawnFilm>) -> CaseFile {
    films.iter().fold(CaseFile::from_case(&phantom.case), |case, (&posture, film)| {
        let (file, sha256) = (Some(film.file.clone()), Some(sha256_hex(&film.bytes)));
        case.with_source(posture, FilmSource { file, sha256, inverted: false })
    })
}
