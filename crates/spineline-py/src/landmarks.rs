//! Films from the landmarks of files and tables.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use spineline::anatomy::{FilmView, ImageSide, Posture};
use spineline::error::Error;
use spineline::measure::{Film, FilmLandmarks, ImageGeometry, LateralFilm, Spacing, SpacingPlane};
use spineline::spatial::Pixel;
use spineline::warning::Warnings;
use spineline_files::method_text::named;
use spineline_files::{FilmSource, column_name, read_bytes, sha256_hex};
use spineline_films::FilmLimits;
use spineline_landmarks::{
    ColumnHint, LandmarkError, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings,
    MarkedFilm, parse_landmarks, parse_lateral_csv, read_file, read_landmarks,
};

use crate::case::Case;
use crate::fault::Fault;
use crate::films::{one_film, view};

/// A file: its bytes, or its path.
#[derive(FromPyObject)]
pub enum Source {
    /// Bytes of a file or of a table as CSV.
    #[pyo3(transparent)]
    Bytes(PyBackedBytes),
    /// Path.
    #[pyo3(transparent)]
    Path(PathBuf),
}

impl Source {
    /// What its faults name.
    fn in_fault(&self, fault: Fault) -> Fault {
        match self {
            Self::Bytes(_) => fault,
            Self::Path(path) => fault.in_file(path),
        }
    }

    fn bytes(&self) -> Result<Cow<'_, [u8]>, LandmarkError> {
        match self {
            Self::Bytes(bytes) => Ok(Cow::Borrowed(bytes)),
            Self::Path(path) => read_file(path).map(Cow::Owned),
        }
    }

    fn landmarks(&self, hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
        match self {
            Self::Bytes(bytes) => parse_landmarks(bytes, hint),
            Self::Path(path) => read_landmarks(path, hint),
        }
    }
}

/// Distances of columns and rows in mm.
#[derive(FromPyObject)]
enum PerPixel {
    #[pyo3(transparent)]
    Square(f64),
    #[pyo3(transparent)]
    ColumnAndRow((f64, f64)),
}

/// The options of `spineline.Film`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct FilmOptions {
    film: Option<String>,
    #[pyo3(default)]
    mm_per_px: Option<PerPixel>,
    #[pyo3(default)]
    plane: Option<String>,
    #[pyo3(default)]
    patient_left: Option<String>,
    #[pyo3(default)]
    patient_anterior: Option<String>,
    #[pyo3(default)]
    simultaneous: bool,
    #[pyo3(default)]
    size_px: Option<(u32, u32)>,
    #[pyo3(default)]
    picture: Option<PathBuf>,
    #[pyo3(default)]
    inverted: bool,
    #[pyo3(default)]
    columns: BTreeMap<String, String>,
    #[pyo3(default)]
    ignore: Vec<String>,
    /// Whether the source is a table that was made into a file.
    is_table: bool,
}

/// Reads films, each as a case of one film. Also returns remarks on rows that were skipped.
#[pyfunction]
pub fn films_of_landmarks(
    source: Source,
    given: FilmOptions,
) -> Result<(Vec<Case>, Vec<String>), Fault> {
    let read = || match given.view()? {
        Some(FilmView::Lateral) => Ok((vec![lateral(&source, &given)?], Vec::new())),
        view => frontal(&source, view.and_then(FilmView::posture), &given),
    };
    let view = given.view().ok().flatten();
    let (mut films, remarks) = read().map_err(|fault| source.in_fault(fault.on_film(view)))?;
    let sha256 = source.bytes().ok().map(|bytes| sha256_hex(&bytes));
    for film in &mut films {
        film.origin.made_from.extend(sha256.clone());
    }
    Ok((films, remarks))
}

impl FilmOptions {
    fn view(&self) -> Result<Option<FilmView>, Fault> {
        self.film.as_deref().map(view).transpose()
    }

    fn plane(&self) -> Result<SpacingPlane, Fault> {
        let Some(text) = &self.plane else { return Ok(SpacingPlane::Unknown) };
        named(text).ok().filter(|plane| *plane != SpacingPlane::Pixels).ok_or_else(|| {
            let text = format!("`plane` is `{text}`");
            Fault::new(text, "give \"patient\", \"detector\" or \"unknown\"")
        })
    }

    fn spacing(&self) -> Result<Option<Spacing>, Fault> {
        let plane = self.plane()?;
        if self.mm_per_px.is_none() && plane != SpacingPlane::Unknown {
            let help = "give the distance of pixel centres too, or leave the plane out";
            return Err(Fault::new("`plane` needs `mm_per_px`", help));
        }
        Ok(self.mm_per_px.as_ref().map(|per_pixel| match *per_pixel {
            PerPixel::Square(mm) => Spacing::stated(mm, mm, plane),
            PerPixel::ColumnAndRow((column, row)) => Spacing::stated(column, row, plane),
        }))
    }

    fn hint(&self, posture: Option<Posture>, patient_left: Option<ImageSide>) -> LandmarkHint {
        let renamed = self.columns.iter().map(|(own, known)| (column_name(own), known.clone()));
        let ignored = self.ignore.iter().map(|name| column_name(name)).collect();
        let columns =
            ColumnHint { renamed: renamed.collect(), ignored, counts_rows: self.is_table };
        LandmarkHint { posture, patient_left, columns, ..LandmarkHint::default() }
    }

    /// The picture of a film with these points.
    fn image(
        &self,
        stated: Option<(u32, u32)>,
        patient_left: ImageSide,
        points: impl Iterator<Item = Pixel>,
    ) -> Result<ImageGeometry, Fault> {
        let size = self.size_px.or(stated);
        if self.picture.is_some() && size.is_none() {
            let help = "give columns and rows of the picture, such as `size_px=(3000, 4000)`";
            return Err(Fault::new("`picture` needs `size_px`", help));
        }
        let (columns, rows) = size.unwrap_or_else(|| smallest_size(points));
        Ok(ImageGeometry { columns, rows, spacing: self.spacing()?, patient_left })
    }

    /// Name and SHA-256 of the picture.
    fn picture(&self) -> Result<FilmSource, Fault> {
        let Some(path) = &self.picture else {
            self.refuse(&[("inverted", self.inverted)], "a film without `picture`")?;
            return Ok(FilmSource::default());
        };
        let bytes = read_bytes(path, FilmLimits::default().file_bytes)
            .map_err(|error| Fault::from(error).in_file(path))?;
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let (file, sha256) = (Some(name), Some(sha256_hex(&bytes)));
        Ok(FilmSource { file, sha256, inverted: self.inverted })
    }

    /// Refuses options that a film of another kind has.
    fn refuse(&self, given: &[(&str, bool)], kind: &str) -> Result<(), Fault> {
        match given.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => {
                Err(Fault::new(format!("`{name}` is not for {kind}"), "leave it out"))
            }
            None => Ok(()),
        }
    }
}

fn frontal(
    source: &Source,
    posture: Option<Posture>,
    given: &FilmOptions,
) -> Result<(Vec<Case>, Vec<String>), Fault> {
    let lateral = [
        ("patient_anterior", given.patient_anterior.is_some()),
        ("simultaneous", given.simultaneous),
    ];
    given.refuse(&lateral, "a frontal film")?;
    let patient_left = match &given.patient_left {
        Some(text) => side("patient_left", text)?,
        None => ImageSide::Left,
    };
    let file = source.landmarks(&given.hint(posture, Some(patient_left)))?;
    if file.format != LandmarkFormat::Csv {
        let columns =
            [("columns", !given.columns.is_empty()), ("ignore", !given.ignore.is_empty())];
        given.refuse(&columns, "a file without columns")?;
    }
    let films = chosen(file.films, posture)?;
    if films.len() > 1 {
        given.refuse(&[("picture", given.picture.is_some())], "several films")?;
    }
    let film = |marked| {
        let film = frontal_film(marked, posture, patient_left, given)?;
        one_film(vec![film], None, given.picture()?)
    };
    Ok((films.into_iter().map(film).collect::<Result<_, _>>()?, file.remarks))
}

/// The films of this posture from a file of several films.
fn chosen(mut films: Vec<MarkedFilm>, posture: Option<Posture>) -> Result<Vec<MarkedFilm>, Fault> {
    if let (Some(posture), 2..) = (posture, films.len()) {
        let named = |film: &MarkedFilm| film.posture.map_or("no posture", Posture::key);
        let all: Vec<&str> = films.iter().map(named).collect();
        let text =
            format!("the landmarks have no {posture} film, but films with {}", all.join(", "));
        films.retain(|film| film.posture.is_none_or(|own| own == posture));
        if films.is_empty() {
            return Err(Fault::new(text, "give one of them as `film`"));
        }
    }
    one_film_per_posture(&films)?;
    Ok(films)
}

/// Refuses several pictures for one posture.
fn one_film_per_posture(films: &[MarkedFilm]) -> Result<(), Fault> {
    let is_twice = |(i, film): &(usize, &MarkedFilm)| {
        films[..*i].iter().any(|other| other.posture == film.posture)
    };
    let Some((_, twice)) = films.iter().enumerate().find(is_twice) else { return Ok(()) };
    let names: Vec<&str> = films.iter().filter_map(|film| film.picture.as_deref()).collect();
    let posture = twice.posture.map_or_else(|| "no posture".to_owned(), |p| p.to_string());
    let text = format!(
        "the file has several pictures with {posture}: {}",
        if names.is_empty() { "they have no names".to_owned() } else { names.join(", ") }
    );
    Err(Fault::new(text, "give a file per film, or a table with a column `posture`"))
}

fn frontal_film(
    marked: MarkedFilm,
    posture: Option<Posture>,
    patient_left: ImageSide,
    given: &FilmOptions,
) -> Result<Film, Fault> {
    let LandmarkReadings::Corners(readings) = &marked.landmarks else {
        let pixels = [
            ("mm_per_px", given.mm_per_px.is_some()),
            ("size_px", given.size_px.is_some()),
            ("picture", given.picture.is_some()),
            ("patient_left", given.patient_left.is_some()),
        ];
        given.refuse(&pixels, "a film of locations in mm")?;
        let mut film = marked.into_film(posture, None)?;
        if let FilmLandmarks::Placements { spacing_plane, .. } = &mut film.landmarks
            && given.plane.is_some()
        {
            *spacing_plane = given.plane()?;
        }
        return Ok(film);
    };
    let corners = readings.iter().flat_map(|reading| reading.vertebrae.values());
    let corners = corners.flat_map(|vertebra| vertebra.corners.points());
    let crests = marked.iliac_crests.iter().flat_map(|crests| [crests.left, crests.right]);
    let image = given.image(marked.size, patient_left, corners.chain(crests))?;
    Ok(marked.into_film(posture, Some(image))?)
}

fn lateral(source: &Source, given: &FilmOptions) -> Result<Case, Fault> {
    let frontal =
        [("patient_left", given.patient_left.is_some()), ("plane", given.plane.is_some())];
    given.refuse(&frontal, "the lateral film")?;
    let Some(side_text) = &given.patient_anterior else {
        let help = "give the side of the picture with the patient's front, \"image-left\" or \"image-right\"";
        return Err(Fault::new("the lateral film needs `patient_anterior`", help));
    };
    let patient_anterior = side("patient_anterior", side_text)?;
    let hint = given.hint(None, None);
    let readings = parse_lateral_csv(&source.bytes()?, &hint)?;
    let corners = readings.iter().flat_map(|reading| reading.vertebrae.values());
    let points = corners.flat_map(|corners| corners.points());
    let image = given.image(None, patient_anterior, points)?;
    let film = LateralFilm { image, simultaneous: given.simultaneous, readings };
    film.measure(&mut Warnings::default()).map_err(Error::from)?;
    one_film(Vec::new(), Some(film), given.picture()?)
}

/// A side of the picture from the option of this name.
fn side(name: &str, text: &str) -> Result<ImageSide, Fault> {
    named(text).map_err(|_| {
        Fault::new(format!("`{name}` is `{text}`"), "give \"image-left\" or \"image-right\"")
    })
}

/// The smallest picture that contains all points.
fn smallest_size(points: impl Iterator<Item = Pixel>) -> (u32, u32) {
    // A point beyond the largest picture stays outside of it, and is refused.
    let size = |largest: f64| (largest.max(0.0).ceil() + 1.0).min(f64::from(u32::MAX)) as u32;
    let largest = points.fold((0.0_f64, 0.0_f64), |(column, row), point| {
        (column.max(point.column_px), row.max(point.row_px))
    });
    (size(largest.0), size(largest.1))
}
