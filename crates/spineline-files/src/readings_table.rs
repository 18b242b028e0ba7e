//! Tables of readings of any quantity: CSV, one reading per row.

use std::collections::BTreeMap;

use csv::{ReaderBuilder, StringRecord, Trim};
use spineline::analysis::{CASE_ID_RULE, is_case_id};
use spineline::measure::{OBSERVER_RULE, is_observer_code};
use spineline::reliability::RatedQuantity;

use crate::FileError;
use crate::nearest::nearest;
use crate::table_text::{
    column_name, is_no_number, starts_formula, stated_separator, unguarded, whole_number,
};

/// Columns of the table, in any order; the last may be absent.
const COLUMNS: [&str; 7] =
    ["quantity", "unit", "subject", "observer", "repeat", "value", "synthetic"];
/// Maximum number of readings.
const MAX_ROWS: usize = 1_000_000;
/// Maximum length of a name.
const MAX_NAME: usize = 200;

/// Readings from a table.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingsTable {
    /// One per name in the column `quantity`, in the order of names.
    pub quantities: Vec<RatedQuantity>,
    /// Whether the column `synthetic` says `true` anywhere.
    pub synthetic: bool,
}

/// Reads a table of readings: CSV with a heading, commas and decimal points, or semicolons or tabs and decimal commas or points, and the columns `quantity`, `unit`, `subject`,
/// `observer`, `repeat` (from 1), `value`, and `synthetic` (`true` or `false`) if wanted.
///
/// ```
/// let text = "quantity,unit,subject,observer,repeat,value\n\
///             tilt,deg,p1,A,1,3.5\ntilt,deg,p1,B,1,4.0\ntilt,deg,p2,A,1,7.5\ntilt,deg,p2,B,1,7.0\n";
/// let table = spineline_files::parse_readings(text)?;
/// assert_eq!(table.quantities[0].subjects(), 2);
/// # Ok::<(), spineline_files::FileError>(())
/// ```
///
/// # Errors
/// [`FileError::Column`] for a column that is missing, twice there or unknown, [`FileError::RowCode`] for a subject or an
/// observer that is not a code, and [`FileError::Row`] for another invalid row: a number that is not finite, an empty name, another
/// unit of the same quantity, a reading given twice.
pub fn parse_readings(text: &str) -> Result<ReadingsTable, FileError> {
    // Programs that write CSV for a spreadsheet put a byte-order mark first.
    // The reader counts the end `\r\n` as a part of the next line.
    let text = &*text.strip_prefix('\u{feff}').unwrap_or(text).replace("\r\n", "\n");
    let stated = stated_separator(text);
    let heading = text.lines().nth(usize::from(stated.is_some())).unwrap_or_default();
    let separator = stated.or_else(|| [';', '\t'].into_iter().find(|mark| heading.contains(*mark)));
    let separator = separator.and_then(|mark| u8::try_from(mark).ok()).unwrap_or(b',');
    let mut reader = ReaderBuilder::new()
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = reader.records();
    if stated.is_some() {
        rows.next();
    }
    let heading = rows.next().unwrap_or_else(|| Ok(StringRecord::new()));
    let heading = heading.map_err(|error| row_error(&error, 1))?;
    let columns = Columns { places: places(&heading)?, count: heading.len(), separator };
    let mut quantities: BTreeMap<String, RatedQuantity> = BTreeMap::new();
    let mut synthetic = false;
    for (count, record) in rows.enumerate() {
        let record = record.map_err(|error| row_error(&error, count as u64 + 2))?;
        let line = record.position().map_or(count as u64 + 2, csv::Position::line);
        let fault = |reason: String| FileError::Row { line, reason };
        if count == MAX_ROWS {
            return Err(fault(format!("more than {MAX_ROWS} readings")));
        }
        if record.iter().all(str::is_empty) {
            continue;
        }
        columns.check_width(&record).map_err(fault)?;
        synthetic |= columns.insert(&record, line, &mut quantities)?;
    }
    if quantities.is_empty() {
        return Err(FileError::Row { line: 2, reason: "no reading".to_owned() });
    }
    Ok(ReadingsTable { quantities: quantities.into_values().collect(), synthetic })
}

/// Where each of [`COLUMNS`] stands in the heading.
fn places(heading: &StringRecord) -> Result<BTreeMap<&'static str, usize>, FileError> {
    let mut places = BTreeMap::new();
    for (place, name) in heading.iter().enumerate() {
        // A column without a name is one of empty cells, or of another program's row numbers.
        if name.is_empty() {
            continue;
        }
        let Some(known) = COLUMNS.into_iter().find(|known| *known == column_name(name)) else {
            let hint = nearest(name, &COLUMNS)
                .map_or_else(String::new, |known| format!("; did you mean `{known}`?"));
            let reason = format!("unknown column `{}`{hint}", shortened(name));
            return Err(FileError::Column { reason });
        };
        if places.insert(known, place).is_some() {
            return Err(FileError::Column { reason: format!("column `{known}` is given twice") });
        }
    }
    match COLUMNS[..6].iter().find(|known| !places.contains_key(*known)) {
        Some(missing) => {
            Err(FileError::Column { reason: format!("column `{missing}` is missing") })
        }
        None => Ok(places),
    }
}

/// Where the columns stand, and what separates them.
struct Columns {
    places: BTreeMap<&'static str, usize>,
    count: usize,
    separator: u8,
}

impl Columns {
    /// A row has as many cells as the heading; more of them are empty.
    fn check_width(&self, record: &StringRecord) -> Result<(), String> {
        let is_whole =
            record.len() >= self.count && record.iter().skip(self.count).all(str::is_empty);
        if is_whole {
            return Ok(());
        }
        Err(format!("{} cells, but the heading has {}", record.len(), self.count))
    }

    /// A number; beside semicolons and tabs its decimal mark may be a comma.
    fn parsed(&self, cell: &str) -> Option<f64> {
        let text =
            if self.separator == b',' { cell.to_owned() } else { cell.replacen(',', ".", 1) };
        text.parse().ok()
    }

    /// Adds one row to its quantity, and returns whether it is of a synthetic film.
    fn insert(
        &self,
        record: &StringRecord,
        line: u64,
        quantities: &mut BTreeMap<String, RatedQuantity>,
    ) -> Result<bool, FileError> {
        let places = &self.places;
        let fault = |reason: String| FileError::Row { line, reason };
        let cell = |column: &str| {
            places.get(column).and_then(|&place| record.get(place)).unwrap_or_default()
        };
        let name = |column: &str| checked_name(column, cell(column)).map_err(fault);
        let code = |column: &'static str, rule, is_code: fn(&str) -> bool| {
            let text = name(column)?;
            if is_code(text) {
                return Ok(text);
            }
            Err(FileError::RowCode { line, column, found: shortened(text), rule })
        };
        let (key, unit) = (name("quantity")?, name("unit")?);
        let subject = code("subject", CASE_ID_RULE, is_case_id)?;
        let observer = code("observer", OBSERVER_RULE, is_observer_code)?;
        let repeat = whole_number(cell("repeat")).filter(|&repeat| repeat > 0);
        let repeat = repeat.ok_or_else(|| {
            let found = shortened(cell("repeat"));
            fault(format!("`repeat` is `{found}`; it must be a whole number from 1"))
        })?;
        let parsed = self.parsed(cell("value"));
        // An empty value: nobody read the subject.
        if is_no_number(cell("value")) {
            return Ok(false);
        }
        let value = parsed.filter(|value| value.is_finite()).ok_or_else(|| {
            let found = shortened(cell("value"));
            fault(format!("`value` is `{found}`, which is not a number"))
        })?;
        let synthetic = match cell("synthetic").to_ascii_lowercase().as_str() {
            "true" => true,
            "false" => false,
            "" if !places.contains_key("synthetic") => false,
            other => {
                let other = shortened(other);
                return Err(fault(format!("`synthetic` is `{other}`; it must be true or false")));
            }
        };
        let quantity = quantities
            .entry(key.to_owned())
            .or_insert_with(|| RatedQuantity::new(key, unit, "as in the table of readings"));
        if quantity.unit != unit {
            return Err(fault(format!("`{key}` is in {unit}, but in {} above", quantity.unit)));
        }
        if !quantity.insert(subject, observer, repeat, value) {
            return Err(fault(format!(
                "`{key}` of subject {subject} by observer {observer}, repeat {repeat}, is given twice"
            )));
        }
        Ok(synthetic)
    }
}

/// A cell that names something.
fn checked_name<'a>(column: &str, cell: &'a str) -> Result<&'a str, String> {
    if starts_formula(cell) {
        let cell = shortened(cell);
        return Err(format!("`{column}` starts like a formula, which spreadsheets run: `{cell}`"));
    }
    let text = unguarded(cell);
    if text.is_empty() {
        return Err(format!("`{column}` is empty"));
    }
    if text.chars().count() > MAX_NAME {
        return Err(format!("`{column}` has more than {MAX_NAME} letters"));
    }
    if text.chars().any(char::is_control) {
        return Err(format!("`{column}` holds a control character"));
    }
    Ok(text)
}

fn row_error(error: &csv::Error, line: u64) -> FileError {
    let line = error.position().map_or(line, csv::Position::line);
    FileError::Row { line, reason: "not CSV".to_owned() }
}

/// The start of a text, to find it by.
fn shortened(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(40).collect()
}
