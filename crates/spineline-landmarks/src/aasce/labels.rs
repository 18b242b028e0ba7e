use std::collections::BTreeMap;

use csv::{ByteRecord, Reader, ReaderBuilder, Trim};
use spineline::anatomy::ImageSide;

use super::{CORNERS, film_of, patient_left};
use crate::names::shown;
use crate::{LandmarkError, LandmarkHint, MarkedFilm};

/// Maximum number of rows; the set has 609.
const MAX_ROWS: u64 = 100_000;

/// One film of the folder.
#[derive(Debug, Clone, PartialEq)]
pub struct AasceRow {
    /// Row in the tables, from 0.
    pub row: usize,
    /// Line of `landmarks.csv`, from 1; the tables lack a heading.
    pub line: u64,
    /// Name of the picture.
    pub picture: String,
    /// Its landmarks, in pixels.
    pub film: MarkedFilm,
}

/// The films of a folder's two tables, read one by one, so that a bad row does not affect the others.
pub struct AasceRows<'a> {
    names: Reader<&'a [u8]>,
    landmarks: Reader<&'a [u8]>,
    sizes: &'a BTreeMap<String, (u32, u32)>,
    hint: &'a LandmarkHint,
    side: ImageSide,
    row: usize,
    ended: bool,
}

impl<'a> AasceRows<'a> {
    /// Opens the bytes of `filenames.csv` and `landmarks.csv`; `sizes` are columns and rows of the pictures by name.
    ///
    /// # Errors
    /// [`LandmarkError::Needs`] for a hint without the side of the patient's left.
    pub fn new(
        names: &'a [u8],
        landmarks: &'a [u8],
        sizes: &'a BTreeMap<String, (u32, u32)>,
        hint: &'a LandmarkHint,
    ) -> Result<Self, LandmarkError> {
        let side = patient_left(hint)?;
        let (names, landmarks) = (reader(names, false), reader(landmarks, false));
        Ok(Self { names, landmarks, sizes, hint, side, row: 0, ended: false })
    }

    fn row(&mut self) -> Result<Option<AasceRow>, LandmarkError> {
        let (mut name, mut values) = (ByteRecord::new(), ByteRecord::new());
        let line = self.row as u64 + 1;
        let at = format!("landmarks.csv, line {line}");
        let unreadable = |_| LandmarkError::Syntax {
            at: at.clone(),
            reason: "the row cannot be read".to_owned(),
        };
        let named = self.names.read_byte_record(&mut name).map_err(unreadable)?;
        let marked = self.landmarks.read_byte_record(&mut values).map_err(unreadable)?;
        self.ended = !(named && marked);
        match (named, marked) {
            (false, false) => return Ok(None),
            (true, true) => {}
            (only_names, _) => {
                let what =
                    if only_names { "a row of landmarks" } else { "a name in filenames.csv" };
                return Err(LandmarkError::missing(at, what));
            }
        }
        if self.row as u64 >= MAX_ROWS {
            self.ended = true;
            let found = MAX_ROWS + 1;
            return Err(LandmarkError::TooLarge { what: "films", found, limit: MAX_ROWS });
        }
        if values.len() != 2 * CORNERS {
            let reason = format!("{} numbers instead of 136 per film", values.len());
            return Err(LandmarkError::Syntax { at, reason });
        }
        let picture = String::from_utf8_lossy(&name[0]).into_owned();
        let &(columns, rows) = self.sizes.get(&picture).ok_or(LandmarkError::missing(
            at.clone(),
            format!(
                "the size of the picture `{}`, by which its landmarks were divided,",
                shown(&picture)
            ),
        ))?;
        let mut points = [[0.0; 2]; CORNERS];
        for (place, point) in points.iter_mut().enumerate() {
            let whole = |column: usize, size: u32| -> Result<f64, LandmarkError> {
                let at = format!("{at}, column {}", column + 1);
                // Landmarks were whole pixels before they were divided and rounded to five digits.
                Ok((number(&values[column], &at)? * f64::from(size)).round())
            };
            *point = [whole(place, columns)?, whole(place + CORNERS, rows)?];
        }
        let mut film = film_of(&points, self.hint, self.side, &at)?;
        film.picture = Some(picture.clone());
        film.size = Some((columns, rows));
        Ok(Some(AasceRow { row: self.row, line, picture, film }))
    }
}

impl Iterator for AasceRows<'_> {
    type Item = Result<AasceRow, LandmarkError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let row = self.row().transpose();
        self.row += 1;
        row
    }
}

/// Names of the pictures in the bytes of `filenames.csv`, in its order.
///
/// # Errors
/// [`LandmarkError`], which names the line.
pub fn picture_names(names: &[u8]) -> Result<Vec<String>, LandmarkError> {
    let mut found = Vec::new();
    for record in reader(names, false).into_byte_records() {
        if found.len() as u64 >= MAX_ROWS {
            let found = MAX_ROWS + 1;
            return Err(LandmarkError::TooLarge { what: "films", found, limit: MAX_ROWS });
        }
        let record = record.map_err(|error| LandmarkError::Syntax {
            at: format!("filenames.csv, line {}", error.position().map_or(1, csv::Position::line)),
            reason: "the row cannot be read".to_owned(),
        })?;
        found.push(String::from_utf8_lossy(record.get(0).unwrap_or_default()).into_owned());
    }
    Ok(found)
}

/// Sizes of pictures from a table with the columns `filename`, `width_px` and `height_px`; other columns are ignored.
///
/// # Errors
/// [`LandmarkError`], which names line and column.
pub fn image_sizes(bytes: &[u8]) -> Result<BTreeMap<String, (u32, u32)>, LandmarkError> {
    let mut table = reader(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), true);
    let at = |line: u64| format!("the sizes of the pictures, line {line}");
    let unreadable = |error: csv::Error| LandmarkError::Syntax {
        at: at(error.position().map_or(1, csv::Position::line)),
        reason: "the row cannot be read".to_owned(),
    };
    let heading = table.byte_headers().map_err(unreadable)?.clone();
    let column = |name: &str| {
        heading
            .iter()
            .position(|cell| cell == name.as_bytes())
            .ok_or_else(|| LandmarkError::missing(at(1), format!("the column `{name}`")))
    };
    let places = [column("filename")?, column("width_px")?, column("height_px")?];
    let mut sizes = BTreeMap::new();
    let mut record = ByteRecord::new();
    while table.read_byte_record(&mut record).map_err(unreadable)? {
        let line = record.position().map_or(0, csv::Position::line);
        let [name, width, height] = places.map(|place| record.get(place).unwrap_or_default());
        let side = |cell: &[u8]| {
            let found = std::str::from_utf8(cell).ok().and_then(|text| text.parse::<u32>().ok());
            found.filter(|&side| side > 0).ok_or_else(|| LandmarkError::Value {
                at: at(line),
                value: shown(&String::from_utf8_lossy(cell)),
                expected: "a number of pixels",
            })
        };
        let size = (side(width)?, side(height)?);
        let name = String::from_utf8_lossy(name).into_owned();
        if sizes.len() as u64 >= MAX_ROWS {
            let found = MAX_ROWS + 1;
            return Err(LandmarkError::TooLarge { what: "pictures", found, limit: MAX_ROWS });
        }
        if sizes.insert(name.clone(), size).is_some_and(|first| first != size) {
            let what = format!("`{}`, with another size,", shown(&name));
            return Err(LandmarkError::Duplicate { at: at(line), what, first: None });
        }
    }
    Ok(sizes)
}

fn reader(bytes: &[u8], heading: bool) -> Reader<&[u8]> {
    ReaderBuilder::new().has_headers(heading).flexible(true).trim(Trim::All).from_reader(bytes)
}

fn number(cell: &[u8], at: &str) -> Result<f64, LandmarkError> {
    let found = std::str::from_utf8(cell).ok().and_then(|text| text.parse::<f64>().ok());
    found.filter(|value| value.is_finite()).ok_or_else(|| LandmarkError::Value {
        at: at.to_owned(),
        value: shown(&String::from_utf8_lossy(cell)),
        expected: "a number",
    })
}
