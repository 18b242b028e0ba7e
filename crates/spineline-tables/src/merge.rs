//! Tables of parts of a cohort as one: rows one after the other, in the order of the parts.

use std::collections::HashSet;
use std::sync::Arc;

use bytes::Bytes;
use parquet::column::reader::ColumnReader;
use parquet::column::writer::ColumnCloseResult;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use spineline_files::unguarded;

/// A part of a table that does not fit the first one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// It has other columns.
    #[error("its columns differ from the first part")]
    Columns,
    /// It is not CSV.
    #[error("it is not CSV: {0}")]
    Csv(#[from] csv::Error),
    /// It is not Parquet.
    #[error("it is not Parquet: {0}")]
    Parquet(#[from] ParquetError),
    /// It is not a table with a patient per row.
    #[error("it has no column `{CASE_ID}`")]
    NoCases,
}

/// The key of every table of patients.
const CASE_ID: &str = "case_id";

/// CSV files with the same heading as one.
///
/// ```
/// use spineline_tables::CsvMerger;
///
/// let mut merger = CsvMerger::default();
/// let merged = merger.add("case_id,n\na,1\n")?.to_owned() + merger.add("case_id,n\nb,2\n")?;
/// assert_eq!(merged, "case_id,n\na,1\nb,2\n");
/// assert!(merger.add("case_id,m\nc,3\n").is_err());
/// # Ok::<(), spineline_tables::MergeError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct CsvMerger {
    heading: Option<String>,
}

impl CsvMerger {
    /// Returns the bytes that the next part adds to the file.
    ///
    /// # Errors
    /// [`MergeError::Columns`].
    pub fn add<'a>(&mut self, part: &'a str) -> Result<&'a str, MergeError> {
        // Names of columns have no line break.
        let end = part.find('\n').map_or(part.len(), |at| at + 1);
        let (own, rows) = part.split_at(end);
        match &self.heading {
            None => {
                self.heading = Some(own.to_owned());
                Ok(part)
            }
            Some(heading) if heading == own => Ok(rows),
            Some(_) => Err(MergeError::Columns),
        }
    }
}

/// Parquet files with the same columns as one: their groups of rows as they were stored.
#[derive(Default)]
pub struct ParquetMerger {
    file: Option<SerializedFileWriter<Vec<u8>>>,
}

impl ParquetMerger {
    /// Returns the bytes that the next part adds to the file.
    ///
    /// # Errors
    /// [`MergeError::Columns`], [`MergeError::Parquet`].
    pub fn add(&mut self, part: Vec<u8>, replaced: &[&str]) -> Result<Vec<u8>, MergeError> {
        let bytes = Bytes::from(part);
        let reader = SerializedFileReader::new(bytes.clone())?;
        let about = reader.metadata().file_metadata();
        let mut file = match self.file.take() {
            Some(file) => file,
            None => begin(&reader, replaced)?,
        };
        if about.schema_descr().root_schema() != file.schema_descr().root_schema() {
            return Err(MergeError::Columns);
        }
        append(&mut file, &bytes, &reader)?;
        file.flush().map_err(ParquetError::from)?;
        let added = std::mem::take(file.inner_mut());
        self.file = Some(file);
        Ok(added)
    }

    /// The end of the file, with metadata that replace the ones left out of the first part.
    ///
    /// # Errors
    /// [`MergeError::Parquet`].
    pub fn finish(self, metadata: &[(&str, &str)]) -> Result<Vec<u8>, MergeError> {
        let Some(mut file) = self.file else { return Ok(Vec::new()) };
        for &(key, value) in metadata {
            file.append_key_value_metadata(KeyValue::new(key.to_owned(), value.to_owned()));
        }
        Ok(file.into_inner()?)
    }
}

/// An empty file with the columns of another one, and its metadata but for what will be replaced.
fn begin(
    like: &SerializedFileReader<Bytes>,
    replaced: &[&str],
) -> ParquetResult<SerializedFileWriter<Vec<u8>>> {
    let about = like.metadata().file_metadata();
    let pairs = about.key_value_metadata().into_iter().flatten();
    let kept = pairs.filter(|pair| !replaced.contains(&pair.key.as_str())).cloned().collect();
    let properties = WriterProperties::builder()
        .set_created_by(about.created_by().unwrap_or_default().to_owned())
        .set_key_value_metadata(Some(kept));
    let schema = about.schema_descr().root_schema_ptr();
    SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties.build()))
}

/// Copies the groups of rows without decoding them.
fn append(
    file: &mut SerializedFileWriter<Vec<u8>>,
    bytes: &Bytes,
    reader: &SerializedFileReader<Bytes>,
) -> ParquetResult<()> {
    for rows in reader.metadata().row_groups() {
        let mut group = file.next_row_group()?;
        for column in rows.columns() {
            let copied = ColumnCloseResult {
                bytes_written: column.compressed_size() as u64,
                rows_written: rows.num_rows() as u64,
                metadata: column.clone(),
                bloom_filter: None,
                column_index: None,
                offset_index: None,
            };
            group.append_column(bytes, copied)?;
        }
        group.close()?;
    }
    Ok(())
}

/// The patients of a table as CSV.
///
/// # Errors
/// [`MergeError::Csv`], [`MergeError::NoCases`].
pub fn csv_case_ids(table: &str) -> Result<HashSet<String>, MergeError> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let place = reader.headers()?.iter().position(|name| name == CASE_ID);
    let place = place.ok_or(MergeError::NoCases)?;
    let cell = |row: csv::Result<csv::StringRecord>| {
        Ok(unguarded(row?.get(place).unwrap_or_default()).to_owned())
    };
    reader.records().map(cell).collect()
}

/// The patients of a table as Parquet.
///
/// # Errors
/// [`MergeError::Parquet`], [`MergeError::NoCases`].
pub fn parquet_case_ids(table: Vec<u8>) -> Result<HashSet<String>, MergeError> {
    let reader = SerializedFileReader::new(Bytes::from(table))?;
    let columns = reader.metadata().file_metadata().schema_descr().columns();
    let place = columns.iter().position(|column| column.name() == CASE_ID);
    let place = place.ok_or(MergeError::NoCases)?;
    let mut all = HashSet::new();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or_default();
        let ColumnReader::ByteArrayColumnReader(mut column) = group.get_column_reader(place)?
        else {
            return Err(MergeError::NoCases);
        };
        let (mut values, mut levels) = (Vec::new(), Vec::new());
        column.read_records(rows, Some(&mut levels), None, &mut values)?;
        for value in values {
            all.insert(value.as_utf8()?.to_owned());
        }
    }
    Ok(all)
}
