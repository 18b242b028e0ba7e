//! `spineline phantom --films`: drawn films as DICOM files beside their cases.

use std::collections::BTreeMap;

use serde::Serialize;
use spineline::anatomy::{Level, Posture};
use spineline_files::{CaseFile, FilmSource, sha256_hex};
use spineline_films::Encoding;
use spineline_phantom::{Phantom, TrueFilm};
use spineline_server::synthetic::{DrawnFilm, draw_film};

use super::args::{EncodingName, PhantomArgs};
use crate::run::failure::Failure;
use crate::run::outputs::Outputs;
use crate::run::threads::map_all;

/// The films of one case by posture.
pub(super) type Listing = BTreeMap<&'static str, FilmRecord>;

/// The true values of one written film.
#[derive(Debug, Clone, Serialize)]
pub(super) struct FilmRecord {
    /// Beside the case.
    file: String,
    /// SHA-256 of the file.
    sha256: String,
    transfer_syntax: &'static str,
    photometric_interpretation: &'static str,
    columns: u32,
    rows: u32,
    column_spacing_mm: Option<f64>,
    row_spacing_mm: Option<f64>,
    patient_left: &'static str,
    lead_marker: &'static str,
    /// Of the stored values as 16-bit little-endian words, row by row.
    pixels_sha256: String,
    iliac_crests_px: BTreeMap<&'static str, [f64; 2]>,
    /// True corners of L5 to T1, `[column, row]`.
    vertebrae_px: BTreeMap<String, BTreeMap<&'static str, [f64; 2]>>,
    #[serde(skip)]
    pub(super) bytes: usize,
}

/// Draws and writes every film, several at once. The result is by case. Until all of them are drawn they lie in a folder that is
/// removed when something stops the work.
pub(super) fn write(
    phantoms: &[Phantom],
    args: &PhantomArgs,
    outputs: &Outputs,
) -> Result<BTreeMap<String, Listing>, Failure> {
    let films: Vec<(&Phantom, &TrueFilm)> = phantoms
        .iter()
        .flat_map(|phantom| phantom.films.iter().map(move |f| (phantom, f)))
        .collect();
    let written = map_all("drawing films", &films, args.threads, |&(phantom, film)| {
        write_film(phantom, film, args, outputs)
    })?;
    let written = written.into_iter().collect::<Result<Vec<FilmRecord>, Failure>>()?;
    let mut listings: BTreeMap<String, Listing> = BTreeMap::new();
    for (record, (phantom, film)) in written.into_iter().zip(films) {
        let listing = listings.entry(phantom.case.id.clone()).or_default();
        listing.insert(film.posture.key(), record);
    }
    Ok(listings)
}

fn write_film(
    phantom: &Phantom,
    film: &TrueFilm,
    args: &PhantomArgs,
    outputs: &Outputs,
) -> Result<FilmRecord, Failure> {
    let encoding = match args.film_encoding {
        EncodingName::Mixed if film.posture == Posture::Neutral => Encoding::Rle,
        EncodingName::Mixed | EncodingName::JpegLs => Encoding::JpegLs,
        EncodingName::Rle => Encoding::Rle,
        EncodingName::Plain => Encoding::Plain,
    };
    let drawn =
        draw_film(phantom, film, encoding).map_err(|error| Failure::internal(error.to_string()))?;
    let DrawnFilm { file, bytes, photometric_interpretation, pixels_sha256 } = drawn;
    outputs.write(&args.out.join(&file), &bytes[..])?;
    let image = film.image;
    Ok(FilmRecord {
        file,
        sha256: sha256_hex(&bytes),
        transfer_syntax: encoding.transfer_syntax(),
        photometric_interpretation,
        columns: image.columns,
        rows: image.rows,
        column_spacing_mm: image.spacing.map(|spacing| spacing.column_mm),
        row_spacing_mm: image.spacing.map(|spacing| spacing.row_mm),
        patient_left: image.patient_left.key(),
        lead_marker: film.marker.key(),
        pixels_sha256,
        iliac_crests_px: [("left", film.iliac_crests.left), ("right", film.iliac_crests.right)]
            .map(|(side, p)| (side, [p.column_px, p.row_px]))
            .into(),
        vertebrae_px: film.vertebrae.iter().map(|(level, c)| corners(*level, c.points())).collect(),
        bytes: bytes.len(),
    })
}

fn corners(
    level: Level,
    points: [spineline::spatial::Pixel; 4],
) -> (String, BTreeMap<&'static str, [f64; 2]>) {
    let names = ["superior_left", "superior_right", "inferior_left", "inferior_right"];
    let places = points.map(|p| [p.column_px, p.row_px]);
    (level.to_string(), names.into_iter().zip(places).collect())
}

/// A case with the file of each film named.
pub(super) fn with_files(case: CaseFile, films: &Listing) -> CaseFile {
    Posture::ALL.into_iter().fold(case, |case, posture| match films.get(posture.key()) {
        Some(film) => case.with_source(
            posture,
            FilmSource {
                file: Some(film.file.clone()),
                sha256: Some(film.sha256.clone()),
                inverted: false,
            },
        ),
        None => case,
    })
}
