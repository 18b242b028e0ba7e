use std::collections::BTreeMap;

use csv::{ByteRecord, ReaderBuilder, Trim};
use spineline::anatomy::{Level, Posture};
use spineline::measure::{
    Corners, IliacCrests, Origin, Placement, Reading, ReadingId, VertebraLandmarks,
};
use spineline::spatial::{Frontal, Pixel};
use spineline_files::{
    column_name, decode_text, starts_formula, stated_separator, unguarded, whole_number,
};

use super::cells::{Cells, DecimalMark};
use super::columns::{Columns, Values, View};
use super::{
    AXIS, CONFIDENCES, CORNERS, CRESTS, MAX_ROWS, OBSERVER, ORIGINS, PEDICLES, PLACED, POSTURE,
    REPEAT, SD_SHARE, VERTEBRA, WALLS,
};
use crate::film::{confidence, degrees, merge_crests, named, origin, pixel};
use crate::names::{CREST_LEFT, CREST_RIGHT, observer, parse_level, shown};
use crate::{
    ColumnHint, LandmarkError, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings,
    MarkedFilm,
};

/// Reads a table of landmarks from the bytes of its file.
///
/// # Errors
/// [`LandmarkError`], which names line and column: for too many or too few rows, a cell that is not a number, an
/// unknown column, or a repeated vertebra.
pub fn parse_csv(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    parse(bytes, hint, View::Frontal)
}

/// Reads a table of frontal films, or of a lateral one with the front in place of the left.
pub(super) fn parse(
    bytes: &[u8],
    hint: &LandmarkHint,
    view: View,
) -> Result<LandmarkFile, LandmarkError> {
    // Invalid text is read too, so that the error names its line.
    // The reader counts the end `\r\n` as a part of the next line.
    let text = decode_text(bytes).map(|text| text.replace("\r\n", "\n"));
    let bytes = text.as_ref().map_or(bytes, |text| text.as_bytes());
    let stated = text.as_ref().and_then(|text| stated_separator(text));
    let separator = match stated.and_then(|separator| u8::try_from(separator).ok()) {
        Some(separator) => separator,
        None => {
            let mut lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r'));
            separator(lines.find(|line| !line.trim_ascii().is_empty()).unwrap_or_default())?
        }
    };
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(Trim::All)
        .from_reader(bytes);
    let mut record = ByteRecord::new();
    read(&mut reader, &mut record)?;
    if stated.is_some() {
        read(&mut reader, &mut record)?;
    }
    let line = record.position().map_or(1, csv::Position::line);
    let columns = Columns::of(&record, line, view, &hint.columns)?;
    let mut table = Table {
        columns,
        hint,
        decimal: DecimalMark::beside(separator),
        named: BTreeMap::new(),
        films: BTreeMap::new(),
        not_placed: Vec::new(),
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
        table.row(Cells { record: &record, line, hint: &hint.columns })?;
    }
    table.finish()
}

/// Whether a file begins with the heading of such a table.
pub(crate) fn looks_like_csv(bytes: &[u8], hint: &ColumnHint) -> bool {
    let text = decode_text(bytes).unwrap_or_else(|| String::from_utf8_lossy(bytes));
    let mut lines = text.split(['\r', '\n']).filter(|line| !line.trim().is_empty());
    let heading = lines.nth(usize::from(stated_separator(&text).is_some()));
    let mut cells = heading.unwrap_or_default().split([',', ';', '\t']);
    cells.any(|cell| hint.column(cell.trim().trim_matches('"')).as_deref() == Some(VERTEBRA))
}

fn separator(heading: &[u8]) -> Result<u8, LandmarkError> {
    let found: Vec<u8> =
        [b',', b';', b'\t'].into_iter().filter(|byte| heading.contains(byte)).collect();
    match found[..] {
        [one] => Ok(one),
        [] => Err(LandmarkError::Unrecognised {
            reason: "the heading has no commas, semicolons or tabs".to_owned(),
        }),
        _ => Err(LandmarkError::Ambiguous {
            at: "line 1".to_owned(),
            reason: "the heading holds more than one of comma, semicolon and tab".to_owned(),
            help: "separate all columns by one of them, or state it in a first line such as `sep=;`",
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
    decimal: DecimalMark,
    /// Whether rows state an observer, and a repeat, by name of the column; all rows or none.
    named: BTreeMap<&'static str, bool>,
    films: BTreeMap<Option<Posture>, FilmRows>,
    /// Rows without landmarks.
    not_placed: Vec<String>,
}

impl Table<'_> {
    fn row(&mut self, row: Cells<'_>) -> Result<(), LandmarkError> {
        let is_empty = |place: &usize| row.record.get(*place).is_none_or(<[u8]>::is_empty);
        if let Some(column) = self.columns.unknown.iter().find(|c| !is_empty(&c.place)) {
            return Err(column.refused());
        }
        // Spreadsheets add empty cells beyond the heading.
        let is_longer = !(self.columns.count..row.record.len()).all(|place| is_empty(&place));
        if row.record.len() < self.columns.count || is_longer {
            let (found, wanted) = (row.record.len(), self.columns.count);
            return Err(LandmarkError::Syntax {
                at: row.row_place(),
                reason: format!("{found} cells, but the heading has {wanted}"),
            });
        }
        let posture = self.posture(row)?;
        let vertebra = row.text(self.columns.vertebra, VERTEBRA)?;
        if column_name(vertebra) == CRESTS && self.columns.view == View::Frontal {
            return self.crests(row, posture).map_err(|error| error.of(posture, None));
        }
        let level = parse_level(vertebra, &row.cell_place(VERTEBRA));
        let level = level.map_err(|error| error.of(posture, None))?;
        self.vertebra(row, posture, level).map_err(|error| error.of(posture, Some(level)))
    }

    fn vertebra(
        &mut self,
        row: Cells<'_>,
        posture: Option<Posture>,
        level: Level,
    ) -> Result<(), LandmarkError> {
        let id = self.reading(row)?;
        if self.values_blank(row).iter().all(|&blank| blank) {
            self.not_placed.push(format!("{level} of {}", row.row_place()));
            return Ok(());
        }
        let first = match self.columns.values {
            Values::Corners(columns) => {
                self.check_corners(row, level)?;
                let landmarks = self.landmarks(row, columns)?;
                let film = self.films.entry(posture).or_default();
                let reading = film.landmarks.entry(id.clone()).or_default();
                reading.insert(level, (landmarks, row.line)).map(|(_, line)| line)
            }
            Values::Placements(columns) => {
                let [y, z] = [0, 1].map(|i| self.decimal.number(row, columns[i], PLACED[i]));
                let location = Frontal::new(y?, z?);
                let tilt = self.decimal.number(row, columns[2], PLACED[2])?;
                let tilt = degrees(tilt, &row.cell_place(PLACED[2]))?;
                let placement = Placement::new(location, tilt);
                let film = self.films.entry(posture).or_default();
                let reading = film.placements.entry(id.clone()).or_default();
                reading.insert(level, (placement, row.line)).map(|(_, line)| line)
            }
        };
        match first {
            None => Ok(()),
            Some(first) => Err(LandmarkError::Duplicate {
                at: row.cell_place(VERTEBRA),
                what: format!("{level} of observer {id}"),
                first: Some(row.hint.line_place(first)),
            }),
        }
    }

    /// A vertebra with the corners in these columns.
    fn landmarks(
        &mut self,
        row: Cells<'_>,
        corners: [usize; 8],
    ) -> Result<VertebraLandmarks, LandmarkError> {
        let points = self.pixels(row, corners)?;
        let axis_clockwise = match self.columns.axis {
            Some(column) if !row.is_blank(column) => {
                Some(degrees(self.decimal.number(row, column, AXIS)?, &row.cell_place(AXIS))?)
            }
            _ => None,
        };
        Ok(VertebraLandmarks {
            axis_clockwise,
            confidence: self.confidence(row)?,
            origins: self.origins(row)?,
            walls: self.sides(row, self.columns.walls, WALLS)?,
            pedicles: self.sides(row, self.columns.pedicles, PEDICLES)?,
            sd_share: self.sd_share(row)?,
            ..VertebraLandmarks::clicked(points.into())
        })
    }

    /// The confidences of a row, all four or none.
    fn confidence(&mut self, row: Cells<'_>) -> Result<Option<Corners<f64>>, LandmarkError> {
        let Some(columns) = self.columns.confidences else { return Ok(None) };
        if columns.iter().all(|&column| row.is_blank(column)) {
            return Ok(None);
        }
        let mut values = [0.0; 4];
        for i in 0..4 {
            let value = self.decimal.number(row, columns[i], CONFIDENCES[i])?;
            values[i] = confidence(value, &row.cell_place(CONFIDENCES[i]))?;
        }
        Ok(Some(values.into()))
    }

    /// The origins of a row; a corner without one is clicked.
    fn origins(&self, row: Cells<'_>) -> Result<Corners<Origin>, LandmarkError> {
        let mut origins = [Origin::Clicked; 4];
        for (i, column) in self.columns.origins.into_iter().flatten().enumerate() {
            let cell = row.text(column, ORIGINS[i])?;
            if !cell.is_empty() {
                origins[i] = origin(cell, &row.cell_place(ORIGINS[i]))?;
            }
        }
        Ok(origins.into())
    }

    /// The left and the right place of a row in these columns, each with both coordinates or none.
    fn sides(
        &mut self,
        row: Cells<'_>,
        columns: Option<[usize; 4]>,
        names: [&'static str; 4],
    ) -> Result<[Option<Pixel>; 2], LandmarkError> {
        let mut sides = [None; 2];
        let Some(columns) = columns else { return Ok(sides) };
        for (side, place) in sides.iter_mut().enumerate() {
            let both = [2 * side, 2 * side + 1];
            if both.iter().all(|&i| row.is_blank(columns[i])) {
                continue;
            }
            let [column_px, row_px] = both.map(|i| self.decimal.number(row, columns[i], names[i]));
            *place = Some(pixel(column_px?, row_px?, &row.row_place())?);
        }
        Ok(sides)
    }

    /// The deviation of detected corners as a part of the body's height.
    fn sd_share(&mut self, row: Cells<'_>) -> Result<Option<f64>, LandmarkError> {
        let Some(column) = self.columns.sd_share.filter(|&column| !row.is_blank(column)) else {
            return Ok(None);
        };
        let share = self.decimal.number(row, column, SD_SHARE)?;
        if share > 0.0 {
            return Ok(Some(share));
        }
        Err(LandmarkError::Outside {
            at: row.cell_place(SD_SHARE),
            value: share,
            expected: "a standard deviation above zero",
            limits: [0.0, f64::INFINITY],
        })
    }

    fn crests(&mut self, row: Cells<'_>, posture: Option<Posture>) -> Result<(), LandmarkError> {
        let Values::Corners(columns) = self.columns.values else {
            return Err(LandmarkError::Ambiguous {
                at: row.cell_place(VERTEBRA),
                reason: "iliac crests need columns of corners".to_owned(),
                help: "remove the row: a table of locations cannot contain iliac crests",
            });
        };
        for (column, name) in columns.into_iter().zip(CORNERS).skip(4) {
            if !row.is_blank(column) {
                return Err(LandmarkError::Value {
                    at: row.cell_place(name),
                    value: row.shown(column),
                    expected: "empty, as it is in a row of iliac crests",
                });
            }
        }
        let blank = [[0, 1], [2, 3]].map(|side| side.iter().any(|&i| row.is_blank(columns[i])));
        match blank {
            [false, false] => {}
            [true, true] => {
                self.not_placed.push(format!("the iliac crests of {}", row.row_place()));
                return Ok(());
            }
            [left, _] => {
                return Err(LandmarkError::Incomplete {
                    what: format!("{}, iliac crests", row.row_place()),
                    missing: vec![if left { CREST_LEFT } else { CREST_RIGHT }.to_owned()],
                });
            }
        }
        let mut tips = [0.0; 4];
        for i in 0..4 {
            tips[i] = self.decimal.number(row, columns[i], CORNERS[i])?;
        }
        let at = row.row_place();
        let left = pixel(tips[0], tips[1], &at)?;
        let right = pixel(tips[2], tips[3], &at)?;
        let film = self.films.entry(posture).or_default();
        merge_crests(&mut film.crests, Some(IliacCrests { left, right }), &at)
    }

    /// Which numbers of a vertebra are missing.
    fn values_blank(&self, row: Cells<'_>) -> Vec<bool> {
        let columns: &[usize] = match &self.columns.values {
            Values::Corners(columns) => columns,
            Values::Placements(columns) => columns,
        };
        columns.iter().map(|&column| row.is_blank(column)).collect()
    }

    /// Refuses a vertebra with only some of its corners.
    fn check_corners(&self, row: Cells<'_>, level: Level) -> Result<(), LandmarkError> {
        let blank = self.values_blank(row);
        let names = self.columns.view.corners();
        let missing: Vec<String> = blank
            .chunks_exact(2)
            .zip(names.chunks_exact(2))
            .filter(|(blank, _)| blank.contains(&true))
            .map(|(_, names)| names[0].trim_end_matches("_column_px").to_owned())
            .collect();
        if missing.is_empty() {
            return Ok(());
        }
        Err(LandmarkError::Incomplete { what: format!("{}, {level}", row.row_place()), missing })
    }

    fn pixels(&mut self, row: Cells<'_>, columns: [usize; 8]) -> Result<[Pixel; 4], LandmarkError> {
        let mut values = [0.0; 8];
        let names = self.columns.view.corners();
        for i in 0..8 {
            values[i] = self.decimal.number(row, columns[i], names[i])?;
        }
        let at = row.row_place();
        let point = |i: usize| pixel(values[2 * i], values[2 * i + 1], &at);
        Ok([point(0)?, point(1)?, point(2)?, point(3)?])
    }

    fn posture(&self, row: Cells<'_>) -> Result<Option<Posture>, LandmarkError> {
        let Some(column) = self.columns.posture else { return Ok(self.hint.posture) };
        let cell = row.text(column, POSTURE)?;
        if cell.is_empty() {
            return Ok(self.hint.posture);
        }
        named(cell, "posture", &row.cell_place(POSTURE)).map(Some)
    }

    /// The cell of the observer or the repeat, which must be filled in all rows or in none; `None` if it is empty.
    fn naming<'a>(
        &mut self,
        row: Cells<'a>,
        column: Option<usize>,
        name: &'static str,
    ) -> Result<Option<&'a str>, LandmarkError> {
        let Some(column) = column else { return Ok(None) };
        let cell = row.text(column, name)?;
        let is_filled = !cell.is_empty();
        if *self.named.entry(name).or_insert(is_filled) != is_filled {
            let (at, what) = (row.row_place(), format!("the {name}, which other rows"));
            let verb = if is_filled { " lack," } else { " have," };
            return Err(LandmarkError::missing(at, what + verb));
        }
        Ok(is_filled.then_some(cell))
    }

    fn reading(&mut self, row: Cells<'_>) -> Result<ReadingId, LandmarkError> {
        let mut id = self.hint.reading.clone();
        if let Some(cell) = self.naming(row, self.columns.observer, OBSERVER)? {
            if starts_formula(cell) {
                return Err(LandmarkError::Value {
                    at: row.cell_place(OBSERVER),
                    value: shown(cell),
                    expected: "the code of an observer: spreadsheets would read it as a formula",
                });
            }
            id.observer = observer(unguarded(cell), &row.cell_place(OBSERVER))?;
        }
        if let Some(cell) = self.naming(row, self.columns.repeat, REPEAT)? {
            id.repeat = whole_number(cell).filter(|&repeat| repeat > 0).ok_or_else(|| {
                LandmarkError::Value {
                    at: row.cell_place(REPEAT),
                    value: shown(cell),
                    expected: "a whole number from 1",
                }
            })?;
        }
        Ok(id)
    }

    fn finish(self) -> Result<LandmarkFile, LandmarkError> {
        if self.films.is_empty() {
            return Err(LandmarkError::missing("the table", "a row with landmarks"));
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
        let passed_over = (!self.not_placed.is_empty())
            .then(|| format!("without landmarks, and skipped: {}", self.not_placed.join(", ")));
        Ok(LandmarkFile {
            format: LandmarkFormat::Csv,
            films: films.collect(),
            remarks: passed_over.into_iter().collect(),
        })
    }
}

fn readings<T>(rows: BTreeMap<ReadingId, BTreeMap<Level, (T, u64)>>) -> Vec<Reading<T>> {
    rows.into_iter()
        .map(|(id, vertebrae)| Reading {
            id,
            vertebrae: vertebrae.into_iter().map(|(level, (value, _))| (level, value)).collect(),
        })
        .collect()
}
