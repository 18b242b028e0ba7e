use std::collections::BTreeMap;

use csv::{ByteRecord, ReaderBuilder, Trim};
use spineline::anatomy::{Level, Named, Posture};
use spineline::measure::{
    Corners, IliacCrests, Origin, Placement, Reading, ReadingId, VertebraLandmarks,
};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline_files::nearest;

use super::columns::{Columns, Values, View};
use super::{
    AXIS, CONFIDENCES, CORNERS, CRESTS, MAX_ROWS, OBSERVER, ORIGINS, PEDICLES, PLACED, POSTURE,
    REPEAT, SD_SHARE, VERTEBRA, WALLS, starts_formula,
};
use crate::film::{confidence, merge_crests, origin, pixel};
use crate::names::{coordinate, observer, parse_level, shown};
use crate::{
    LandmarkError, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings, MarkedFilm,
};

/// Reads a table of landmarks from the bytes of its file.
///
/// # Errors
/// [`LandmarkError`], which names line and column. A row too many or too few, a cell that is no number, an unknown column
/// and a vertebra given twice are errors.
pub fn parse_csv(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    parse(bytes, hint, View::Frontal)
}

/// Reads a table of frontal films, or of a lateral one with the front in place of the left.
pub(super) fn parse(
    bytes: &[u8],
    hint: &LandmarkHint,
    view: View,
) -> Result<LandmarkFile, LandmarkError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let separator = separator(first_line(bytes))?;
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(Trim::All)
        .from_reader(bytes);
    let mut record = ByteRecord::new();
    read(&mut reader, &mut record)?;
    let columns = Columns::of(&record, view)?;
    let mut table = Table {
        columns,
        hint,
        decimal: (separator == b',').then_some('.'),
        films: BTreeMap::new(),
    };
    let mut rows = 0;
    while read(&mut reader, &mut record)? {
        rows += 1;
        if rows > MAX_ROWS {
            return Err(LandmarkError::TooLarge { what: "rows", found: rows, limit: MAX_ROWS });
        }
        let line = record.position().map_or(0, csv::Position::line);
        // Empty rows of a spreadsheet.
        if record.iter().all(<[u8]>::is_empty) {
            continue;
        }
        table.row(&record, line)?;
    }
    table.finish()
}

/// Whether a file begins with the heading of such a table.
pub(crate) fn looks_like_csv(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    first_line(bytes).split(|byte| matches!(byte, b',' | b';' | b'\t')).any(|cell| {
        cell.trim_ascii().trim_ascii_start() == VERTEBRA.as_bytes() || cell == b"\"vertebra\""
    })
}

fn first_line(bytes: &[u8]) -> &[u8] {
    bytes.split(|byte| matches!(byte, b'\n' | b'\r')).next().unwrap_or_default()
}

fn separator(heading: &[u8]) -> Result<u8, LandmarkError> {
    let found: Vec<u8> =
        [b',', b';', b'\t'].into_iter().filter(|byte| heading.contains(byte)).collect();
    match found[..] {
        [one] => Ok(one),
        [] => Err(LandmarkError::Unrecognised {
            reason: "the heading has neither commas, nor semicolons, nor tabs".to_owned(),
        }),
        _ => Err(LandmarkError::Ambiguous {
            at: "line 1".to_owned(),
            reason: "the heading holds more than one of comma, semicolon and tab".to_owned(),
        }),
    }
}

fn read(reader: &mut csv::Reader<&[u8]>, record: &mut ByteRecord) -> Result<bool, LandmarkError> {
    reader.read_byte_record(record).map_err(|error| LandmarkError::Syntax {
        at: format!("line {}", error.position().map_or(0, csv::Position::line)),
        reason: "the row cannot be read".to_owned(),
    })
}

/// Rows of one film read so far.
#[derive(Default)]
struct FilmRows {
    crests: Option<IliacCrests>,
    landmarks: BTreeMap<ReadingId, BTreeMap<Level, (VertebraLandmarks, u64)>>,
    placements: BTreeMap<ReadingId, BTreeMap<Level, (Placement, u64)>>,
}

struct Table<'a> {
    columns: Columns,
    hint: &'a LandmarkHint,
    /// The decimal mark; where both are possible, as soon as one was met.
    decimal: Option<char>,
    films: BTreeMap<Option<Posture>, FilmRows>,
}

impl Table<'_> {
    fn row(&mut self, record: &ByteRecord, line: u64) -> Result<(), LandmarkError> {
        if record.len() != self.columns.count {
            let (found, wanted) = (record.len(), self.columns.count);
            return Err(LandmarkError::Syntax {
                at: format!("line {line}"),
                reason: format!("{found} cells, but the heading has {wanted}"),
            });
        }
        let posture = self.posture(record, line)?;
        let vertebra = text(record, self.columns.vertebra, line, VERTEBRA)?;
        if vertebra == CRESTS && self.columns.view == View::Frontal {
            return self.crests(record, line, posture);
        }
        let at = place(line, VERTEBRA);
        let level = parse_level(vertebra, &at)?;
        let id = self.reading(record, line)?;
        let twice = |first: u64| LandmarkError::Duplicate {
            at: at.clone(),
            what: format!("{level} of observer {id}"),
            first: Some(format!("line {first}")),
        };
        match self.columns.values {
            Values::Corners(columns) => {
                let points = self.pixels(record, line, columns)?;
                let axis_clockwise = match self.columns.axis {
                    Some(column) if !record[column].is_empty() => {
                        Some(Angle::from_deg(self.number(record, column, line, AXIS)?))
                    }
                    _ => None,
                };
                let landmarks = VertebraLandmarks {
                    axis_clockwise,
                    confidence: self.confidence(record, line)?,
                    origins: self.origins(record, line)?,
                    walls: self.sides(record, line, self.columns.walls, WALLS)?,
                    pedicles: self.sides(record, line, self.columns.pedicles, PEDICLES)?,
                    sd_share: self.sd_share(record, line)?,
                    ..VertebraLandmarks::clicked(in_order(points))
                };
                let film = self.films.entry(posture).or_default();
                let reading = film.landmarks.entry(id.clone()).or_default();
                match reading.get(&level) {
                    Some((_, first)) => return Err(twice(*first)),
                    None => reading.insert(level, (landmarks, line)),
                };
            }
            Values::Placements(columns) => {
                let [y, z, tilt] =
                    [0, 1, 2].map(|i| self.number(record, columns[i], line, PLACED[i]));
                let placement = Placement::new(Frontal::new(y?, z?), Angle::from_deg(tilt?));
                let film = self.films.entry(posture).or_default();
                let reading = film.placements.entry(id.clone()).or_default();
                match reading.get(&level) {
                    Some((_, first)) => return Err(twice(*first)),
                    None => reading.insert(level, (placement, line)),
                };
            }
        }
        Ok(())
    }

    /// The confidences of a row, all of them or none.
    fn confidence(
        &mut self,
        record: &ByteRecord,
        line: u64,
    ) -> Result<Option<Corners<f64>>, LandmarkError> {
        let Some(columns) = self.columns.confidences else { return Ok(None) };
        if columns.iter().all(|&column| record[column].is_empty()) {
            return Ok(None);
        }
        let mut values = [0.0; 4];
        for i in 0..4 {
            let value = self.number(record, columns[i], line, CONFIDENCES[i])?;
            values[i] = confidence(value, &place(line, CONFIDENCES[i]))?;
        }
        Ok(Some(in_order(values)))
    }

    /// The origins of a row; a corner without one is clicked.
    fn origins(&self, record: &ByteRecord, line: u64) -> Result<Corners<Origin>, LandmarkError> {
        let mut origins = [Origin::Clicked; 4];
        for (i, column) in self.columns.origins.into_iter().flatten().enumerate() {
            let cell = text(record, column, line, ORIGINS[i])?;
            if !cell.is_empty() {
                origins[i] = origin(cell, &place(line, ORIGINS[i]))?;
            }
        }
        Ok(in_order(origins))
    }

    /// The left and the right place of a row in these columns, each with both coordinates or none.
    fn sides(
        &mut self,
        record: &ByteRecord,
        line: u64,
        columns: Option<[usize; 4]>,
        names: [&'static str; 4],
    ) -> Result<[Option<Pixel>; 2], LandmarkError> {
        let mut sides = [None; 2];
        let Some(columns) = columns else { return Ok(sides) };
        for (side, place) in sides.iter_mut().enumerate() {
            let [column, row] = [2 * side, 2 * side + 1];
            if [column, row].iter().all(|&i| record[columns[i]].is_empty()) {
                continue;
            }
            let [column, row] =
                [column, row].map(|i| self.number(record, columns[i], line, names[i]));
            *place = Some(pixel(column?, row?, &format!("line {line}"))?);
        }
        Ok(sides)
    }

    /// The deviation of detected corners as a part of the body's height.
    fn sd_share(&mut self, record: &ByteRecord, line: u64) -> Result<Option<f64>, LandmarkError> {
        let Some(column) = self.columns.sd_share.filter(|&column| !record[column].is_empty())
        else {
            return Ok(None);
        };
        let share = self.number(record, column, line, SD_SHARE)?;
        if share > 0.0 {
            return Ok(Some(share));
        }
        Err(LandmarkError::Value {
            at: place(line, SD_SHARE),
            value: share.to_string(),
            expected: "a standard deviation above zero",
        })
    }

    fn crests(
        &mut self,
        record: &ByteRecord,
        line: u64,
        posture: Option<Posture>,
    ) -> Result<(), LandmarkError> {
        let Values::Corners(columns) = self.columns.values else {
            return Err(LandmarkError::Ambiguous {
                at: place(line, VERTEBRA),
                reason: "iliac crests need columns of corners".to_owned(),
            });
        };
        for (column, name) in columns.into_iter().zip(CORNERS).skip(4) {
            if !record[column].is_empty() {
                return Err(LandmarkError::Value {
                    at: place(line, name),
                    value: shown(&String::from_utf8_lossy(&record[column])),
                    expected: "empty, as it is in a row of iliac crests",
                });
            }
        }
        let mut tips = [0.0; 4];
        for i in 0..4 {
            tips[i] = self.number(record, columns[i], line, CORNERS[i])?;
        }
        let at = format!("line {line}");
        let left = pixel(tips[0], tips[1], &at)?;
        let right = pixel(tips[2], tips[3], &at)?;
        let film = self.films.entry(posture).or_default();
        merge_crests(&mut film.crests, Some(IliacCrests { left, right }), &at)
    }

    fn pixels(
        &mut self,
        record: &ByteRecord,
        line: u64,
        columns: [usize; 8],
    ) -> Result<[Pixel; 4], LandmarkError> {
        let mut values = [0.0; 8];
        let names = self.columns.view.corners();
        for i in 0..8 {
            values[i] = self.number(record, columns[i], line, names[i])?;
        }
        let at = format!("line {line}");
        let point = |i: usize| pixel(values[2 * i], values[2 * i + 1], &at);
        Ok([point(0)?, point(1)?, point(2)?, point(3)?])
    }

    fn posture(&self, record: &ByteRecord, line: u64) -> Result<Option<Posture>, LandmarkError> {
        let Some(column) = self.columns.posture else { return Ok(self.hint.posture) };
        let cell = text(record, column, line, POSTURE)?;
        if cell.is_empty() {
            return Ok(self.hint.posture);
        }
        let keys = Posture::ALL.map(Posture::key);
        let wanted = cell.to_ascii_lowercase().replace(['-', ' '], "_");
        match Posture::from_key(&wanted) {
            Some(posture) => Ok(Some(posture)),
            None => Err(LandmarkError::Unknown {
                at: place(line, POSTURE),
                what: "posture",
                name: shown(cell),
                nearest: nearest(&shown(&wanted), &keys),
            }),
        }
    }

    fn reading(&self, record: &ByteRecord, line: u64) -> Result<ReadingId, LandmarkError> {
        let mut id = self.hint.reading.clone();
        if let Some(column) = self.columns.observer {
            let cell = text(record, column, line, OBSERVER)?;
            if starts_formula(cell) {
                return Err(LandmarkError::Value {
                    at: place(line, OBSERVER),
                    value: shown(cell),
                    expected: "the code of an observer: spreadsheets would read it as a formula",
                });
            }
            // A quote guards a name that looks like a formula.
            let name = cell.strip_prefix('\'').filter(|rest| guarded(rest)).unwrap_or(cell);
            id.observer = observer(name, &place(line, OBSERVER))?;
        }
        if let Some(column) = self.columns.repeat {
            let cell = text(record, column, line, REPEAT)?;
            id.repeat = cell.parse().ok().filter(|&repeat| repeat > 0).ok_or_else(|| {
                LandmarkError::Value {
                    at: place(line, REPEAT),
                    value: shown(cell),
                    expected: "a whole number from 1",
                }
            })?;
        }
        Ok(id)
    }

    fn number(
        &mut self,
        record: &ByteRecord,
        column: usize,
        line: u64,
        name: &str,
    ) -> Result<f64, LandmarkError> {
        let cell = text(record, column, line, name)?;
        let at = || place(line, name);
        for landmark in ['.', ','] {
            if cell.contains(landmark) && *self.decimal.get_or_insert(landmark) != landmark {
                return Err(LandmarkError::Ambiguous {
                    at: at(),
                    reason: format!(
                        "`{}`: numbers use both commas and points; use only one as the decimal separator",
                        shown(cell)
                    ),
                });
            }
        }
        let value = cell.replacen(',', ".", 1).parse().map_err(|_| LandmarkError::Value {
            at: at(),
            value: shown(cell),
            expected: "a number",
        })?;
        coordinate(value, &at())
    }

    fn finish(self) -> Result<LandmarkFile, LandmarkError> {
        if self.films.is_empty() {
            return Err(LandmarkError::Missing {
                at: "the table".to_owned(),
                what: "a row with a vertebra".to_owned(),
            });
        }
        let corners = matches!(self.columns.values, Values::Corners(_));
        let films = self.films.into_iter().map(|(posture, rows)| MarkedFilm {
            posture,
            picture: None,
            size: None,
            iliac_crests: rows.crests,
            landmarks: if corners {
                LandmarkReadings::Corners(readings(rows.landmarks))
            } else {
                LandmarkReadings::Placements(readings(rows.placements))
            },
        });
        Ok(LandmarkFile {
            format: LandmarkFormat::Csv,
            films: films.collect(),
            remarks: Vec::new(),
        })
    }
}

/// Corners from values in the order of the columns.
fn in_order<T>(
    [superior_left, superior_right, inferior_left, inferior_right]: [T; 4],
) -> Corners<T> {
    Corners { superior_left, superior_right, inferior_left, inferior_right }
}

fn readings<T>(rows: BTreeMap<ReadingId, BTreeMap<Level, (T, u64)>>) -> Vec<Reading<T>> {
    rows.into_iter()
        .map(|(id, vertebrae)| Reading {
            id,
            vertebrae: vertebrae.into_iter().map(|(level, (value, _))| (level, value)).collect(),
        })
        .collect()
}

/// Whether the writer puts a quote before such a name.
pub(super) fn guarded(name: &str) -> bool {
    starts_formula(name) || name.starts_with('\'')
}

fn text<'a>(
    record: &'a ByteRecord,
    column: usize,
    line: u64,
    name: &str,
) -> Result<&'a str, LandmarkError> {
    std::str::from_utf8(&record[column]).map_err(|_| LandmarkError::Value {
        at: place(line, name),
        value: shown(&String::from_utf8_lossy(&record[column])),
        expected: "text in UTF-8",
    })
}

fn place(line: u64, column: &str) -> String {
    format!("line {line}, column `{column}`")
}
