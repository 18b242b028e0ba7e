//! The only writer of CSV: comma between cells, decimal point, UTF-8, quotes where needed.

use csv::Writer;

use crate::error::TableError;

/// A heading and rows of cells. The name of the table is for the message of the error.
///
/// # Errors
/// [`TableError::Csv`] if a row has more or fewer cells than the heading.
pub(crate) fn rows_to_csv<Row>(
    table: &'static str,
    heading: impl IntoIterator<Item = impl AsRef<[u8]>>,
    rows: impl IntoIterator<Item = Row>,
) -> Result<String, TableError>
where
    Row: IntoIterator<Item: AsRef<[u8]>>,
{
    let failed = |source| TableError::Csv { table, source };
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(heading).map_err(failed)?;
    for row in rows {
        writer.write_record(row).map_err(failed)?;
    }
    text(table, writer)
}

fn text(table: &'static str, writer: Writer<Vec<u8>>) -> Result<String, TableError> {
    let bytes = writer
        .into_inner()
        .map_err(|error| TableError::Csv { table, source: error.into_error().into() })?;
    Ok(String::from_utf8(bytes).expect("texts are UTF-8"))
}
