//! A case into a store: its films by their bytes, its readings click by click.

use std::fs;
use std::path::Path;

use serde_json::Value;
use spineline::analysis::{Case, Subject};
use spineline::anatomy::Posture;
use spineline::measure::{FilmMarks, IliacCrests, Mark, Reading};
use spineline_io::LevelKey;
use spineline_server::store::{
    Corner, CrestSide, Event, FilmEdit, FilmId, Name, Signature, Store, StoreError, Study,
};

use crate::failure::Failure;

/// Adds one case; tells what was added.
pub fn add(store: &mut Store, at: &Path, path: &Path, by: &Signature) -> Result<String, Failure> {
    let fail = |error: StoreError| Failure::store(at, &error);
    let text = spineline_io::read_text(path).map_err(|error| Failure::file(path, &error))?;
    let case = spineline_io::parse_case(&text).map_err(|error| Failure::file(path, &error))?;
    let written: Value = serde_json::from_str(&text)
        .map_err(|error| Failure::internal(format!("a case that was just read: {error}")))?;
    let id = super::name(&case.id)?;
    let study = Study { id: id.clone(), label: None, synthetic: case.synthetic };
    let films = films(path, &case, &written)?;
    // Before anything is written: a name that a store does not take would leave half a study.
    for film in &films {
        for reading in film.readings {
            super::name(&reading.id.observer)?;
        }
    }
    store.add_study(&study, by).map_err(fail)?;
    let mut readings = 0;
    for film in &films {
        let added =
            store.add_film(&id, film.posture, &film.bytes, &film.image, by).map_err(fail)?;
        if film.image["inverted"] == true {
            store.edit_film(added.film, FilmEdit::Inverted(true), 0, by).map_err(fail)?;
        }
        for reading in film.readings {
            record(store, added.film, reading, film.crests, by).map_err(fail)?;
            readings += 1;
        }
    }
    let mut text = format!("{id}: {} films and {readings} readings were added.\n", films.len());
    if case.lateral.is_some() {
        text.push_str(
            "  ! the lateral film and its marks are not kept by a store: keep the case file\n",
        );
    }
    if case.subject != Subject::default() {
        text.push_str("  ! sex, age and Lenke class are not kept by a store: keep the case file\n");
    }
    Ok(text)
}

/// A film of a case with everything that a store wants of it.
struct CaseFilm<'a> {
    posture: Posture,
    bytes: Vec<u8>,
    image: Value,
    readings: &'a [Reading<Mark>],
    crests: Option<IliacCrests>,
}

/// Every film, read before anything is written.
fn films<'a>(path: &Path, case: &'a Case, written: &Value) -> Result<Vec<CaseFilm<'a>>, Failure> {
    let mut films = Vec::new();
    for (film, record) in case.films.iter().zip(written["films"].as_array().into_iter().flatten()) {
        let place = format!("{}, {} film", path.display(), film.posture);
        let FilmMarks::Landmarks { readings, iliac_crests, .. } = &film.marks else {
            return Err(Failure::input(
                &place,
                &"it has locations from another program, and no picture",
                "a store holds pictures and what was marked on them",
            ));
        };
        let image = record["image"].clone();
        let Some(file) = image["file"].as_str() else {
            return Err(Failure::input(
                &place,
                &"no picture is named",
                "give `image.file`; `import` and `phantom --films` write it",
            ));
        };
        let file = path.with_file_name(file);
        let bytes = fs::read(&file).map_err(|error| {
            Failure::input(&file.display().to_string(), &error, "put the film beside its case")
        })?;
        check_hash(&place, image["sha256"].as_str(), &bytes)?;
        let crests = *iliac_crests;
        films.push(CaseFilm { posture: film.posture, bytes, image, readings, crests });
    }
    Ok(films)
}

fn check_hash(place: &str, stated: Option<&str>, bytes: &[u8]) -> Result<(), Failure> {
    let found = spineline_io::sha256_hex(bytes);
    match stated {
        Some(stated) if !stated.eq_ignore_ascii_case(&found) => Err(Failure::input(
            place,
            &"its picture is not the one that the case was made with (SHA-256 differs)",
            "find the original film, or make the case again",
        )),
        _ => Ok(()),
    }
}

/// Writes one reading as if it had been clicked, and finishes it.
fn record(
    store: &mut Store,
    film: FilmId,
    reading: &Reading<Mark>,
    crests: Option<IliacCrests>,
    by: &Signature,
) -> Result<(), StoreError> {
    let by = Signature::new(Name::new(&reading.id.observer)?, by.at);
    let id = store.begin_reading(film, reading.id.repeat, &by)?;
    let mut revision = 0;
    let mut click = |event: &Event| -> Result<(), StoreError> {
        revision = store.record(id, event, revision, &by)?.revision;
        Ok(())
    };
    for (&level, mark) in &reading.vertebrae {
        let level = LevelKey(level);
        for (corner, place) in Corner::ALL.into_iter().zip(mark.corners.points()) {
            let (column_px, row_px) = (place.column_px, place.row_px);
            click(&Event::PlaceCorner { level, corner, column_px, row_px })?;
        }
        if let Some(axis) = mark.axis_clockwise {
            let axis_deg = Some(spineline_io::written_axis_deg(axis));
            click(&Event::SetAxis { level, axis_deg })?;
        }
    }
    if let Some(IliacCrests { left, right }) = crests {
        for (side, place) in [(CrestSide::Left, left), (CrestSide::Right, right)] {
            let (column_px, row_px) = (place.column_px, place.row_px);
            click(&Event::PlaceIliacCrest { side, column_px, row_px })?;
        }
    }
    store.finish_reading(id, revision, &by)?;
    Ok(())
}
