//! Pictures of a case's films for its report.

use std::path::Path;

use spineline::analysis::Case;
use spineline::anatomy::Posture;
use spineline::measure::{FilmLandmarks, ImageGeometry};
use spineline_files::{CaseFile, FilmSource};
use spineline_report::figures::FilmPicture;

use crate::analysis::films::other_size;
use crate::run::failure::Failure;
use crate::run::film_decoder::{Decoder, case_film_bytes};
use crate::run::threads::map_all;

/// Rows of a picture in a report.
const ROWS: u32 = 800;

/// A film whose case names a picture file.
struct Named {
    posture: Posture,
    image: ImageGeometry,
    source: FilmSource,
}

/// The pictures that can be shown, and in words why others cannot.
pub fn pictures(
    path: &Path,
    file: &CaseFile,
    case: &Case,
    threads: usize,
) -> Result<(Vec<FilmPicture>, Vec<String>), Failure> {
    let named: Vec<Named> = case
        .films
        .iter()
        .filter_map(|film| {
            let FilmLandmarks::Corners { image, .. } = &film.landmarks else { return None };
            let source = file.source(film.posture).filter(|source| source.file.is_some())?;
            Some(Named { posture: film.posture, image: *image, source })
        })
        .collect();
    if named.is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let decoder = Decoder::new()?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let read = map_all("films", &named, threads, |film| picture(&decoder, folder, film))?;
    let (mut pictures, mut reasons) = (Vec::new(), Vec::new());
    for (film, read) in named.iter().zip(read) {
        match read {
            Ok(png) => pictures.push(FilmPicture { posture: film.posture, png }),
            Err(why) => reasons
                .push(format!("the picture of the {} film is not shown: {why}", film.posture)),
        }
    }
    Ok((pictures, reasons))
}

fn picture(decoder: &Decoder, folder: &Path, film: &Named) -> Result<Vec<u8>, String> {
    let name = film.source.file.as_deref().unwrap_or_default();
    // `CaseFile::into_case` refuses a name in another folder.
    let bytes = case_film_bytes(&folder.join(name)).map_err(|error| error.to_string())?;
    if let Some(why) = film.source.other_bytes(&bytes) {
        return Err(why);
    }
    let picture = decoder.decode(bytes).map_err(|error| error.to_string())?;
    let ImageGeometry { columns, rows, spacing, .. } = film.image;
    if let Some(why) = other_size((picture.columns, picture.rows), (columns, rows)) {
        return Err(why);
    }
    let aspect = spacing.map_or(1.0, |spacing| spacing.aspect());
    Ok(picture.display(None, film.source.inverted).thumbnail(ROWS.min(rows), aspect).to_png())
}
