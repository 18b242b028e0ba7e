//! Tables of readings of any quantity: CSV, one reading per row.

use std::collections::BTreeMap;

use csv::{ReaderBuilder, StringRecord};
use spineline::reliability::RatedQuantity;

use crate::FileError;
use crate::json::nearest;

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

/// Reads a table of readings: CSV with a heading, commas, decimal points, and the columns `quantity`, `unit`, `subject`,
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
/// [`FileError::Column`] for a column that is missing, twice there or unknown, and [`FileError::Row`] for what does not
/// fit in a row: no finite number, an empty name, another unit of the same quantity, a reading given twice.
pub fn parse_readings(text: &str) -> Result<ReadingsTable, FileError> {
    // Programs that write CSV for a spreadsheet put a byte-order mark first.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader = ReaderBuilder::new().from_reader(text.as_bytes());
    let heading = reader.headers().map_err(|error| row_error(&error, 1))?.clone();
    let places = places(&heading)?;
    let mut quantities: BTreeMap<String, RatedQuantity> = BTreeMap::new();
    let mut synthetic = false;
    for (count, record) in reader.records().enumerate() {
        let record = record.map_err(|error| row_error(&error, count as u64 + 2))?;
        let line = record.position().map_or(count as u64 + 2, csv::Position::line);
        let fault = |reason: String| FileError::Row { line, reason };
        if count == MAX_ROWS {
            return Err(fault(format!("more than {MAX_ROWS} readings")));
        }
        synthetic |= insert(&record, &places, &mut quantities).map_err(fault)?;
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
        let Some(known) = COLUMNS.into_iter().find(|known| *known == name.trim()) else {
            let hint = match name.contains(';') || name.contains('\t') {
                true => "; columns must be separated by commas".to_owned(),
                false => nearest(name, &COLUMNS)
                    .map_or_else(String::new, |known| format!("; did you mean `{known}`?")),
            };
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

/// Adds one row to its quantity, and returns whether it is of a synthetic film.
fn insert(
    record: &StringRecord,
    places: &BTreeMap<&'static str, usize>,
    quantities: &mut BTreeMap<String, RatedQuantity>,
) -> Result<bool, String> {
    let cell = |column: &str| {
        places.get(column).and_then(|&place| record.get(place)).unwrap_or_default().trim()
    };
    let name = |column| name(column, cell(column));
    let (key, unit) = (name("quantity")?, name("unit")?);
    let (subject, observer) = (name("subject")?, name("observer")?);
    let repeat = match cell("repeat").parse::<u32>() {
        Ok(repeat) if repeat > 0 => repeat,
        _ => {
            return Err(format!(
                "`repeat` is `{}`; it must be a whole number from 1",
                shortened(cell("repeat"))
            ));
        }
    };
    let value = match cell("value").parse::<f64>() {
        Ok(value) if value.is_finite() => value,
        _ => {
            let found = shortened(cell("value"));
            return Err(format!(
                "`value` is `{found}`; it must be a number with a decimal point; remove rows without a value"
            ));
        }
    };
    let synthetic = match cell("synthetic") {
        "true" => true,
        "false" => false,
        "" if !places.contains_key("synthetic") => false,
        other => {
            return Err(format!("`synthetic` is `{}`; it must be true or false", shortened(other)));
        }
    };
    let quantity = quantities
        .entry(key.to_owned())
        .or_insert_with(|| RatedQuantity::new(key, unit, "as in the table of readings"));
    if quantity.unit != unit {
        return Err(format!("`{key}` is in {unit}, but in {} above", quantity.unit));
    }
    if !quantity.insert(subject, observer, repeat, value) {
        return Err(format!(
            "`{key}` of subject {subject} by observer {observer}, repeat {repeat}, is given twice"
        ));
    }
    Ok(synthetic)
}

/// A cell that names something.
fn name<'a>(column: &str, text: &'a str) -> Result<&'a str, String> {
    if text.is_empty() {
        return Err(format!("`{column}` is empty"));
    }
    if text.chars().count() > MAX_NAME {
        return Err(format!("`{column}` has more than {MAX_NAME} letters"));
    }
    if text.chars().any(char::is_control) {
        return Err(format!("`{column}` holds a control character"));
    }
    // A spreadsheet would take it for a formula when it opens a result.
    if text.starts_with(['=', '@', '+', '-']) {
        return Err(format!("`{column}` starts like a formula: `{}`", shortened(text)));
    }
    Ok(text)
}

fn row_error(error: &csv::Error, line: u64) -> FileError {
    let line = error.position().map_or(line, csv::Position::line);
    let reason = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} cells, but the heading has {expected_len}")
        }
        _ => "not CSV".to_owned(),
    };
    FileError::Row { line, reason }
}

/// Enough of a text to find it by.
fn shortened(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(40).collect()
}
