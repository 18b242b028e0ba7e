//! Tables as CSV text.

use csv::Writer;
use serde::Serialize;

use super::failure::Failure;

/// A heading and rows of cells.
///
/// # Errors
/// If a row has more or fewer cells than the heading.
pub fn rows_to_csv<Row>(
    heading: impl IntoIterator<Item = impl AsRef<[u8]>>,
    rows: impl IntoIterator<Item = Row>,
) -> Result<String, Failure>
where
    Row: IntoIterator<Item: AsRef<[u8]>>,
{
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(heading).map_err(|error| failed(&error))?;
    for row in rows {
        writer.write_record(row).map_err(|error| failed(&error))?;
    }
    text(writer)
}

/// Records whose fields name the columns.
///
/// # Errors
/// If a record has no columns.
pub fn records_to_csv(
    records: impl IntoIterator<Item = impl Serialize>,
) -> Result<String, Failure> {
    let mut writer = Writer::from_writer(Vec::new());
    for record in records {
        writer.serialize(record).map_err(|error| failed(&error))?;
    }
    text(writer)
}

fn text(writer: Writer<Vec<u8>>) -> Result<String, Failure> {
    let bytes = writer.into_inner().map_err(|error| failed(&error))?;
    String::from_utf8(bytes).map_err(|error| failed(&error))
}

fn failed(error: &dyn std::fmt::Display) -> Failure {
    Failure::internal(format!("CSV: {error}"))
}
