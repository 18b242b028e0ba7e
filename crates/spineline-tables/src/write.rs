//! Tables as files.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use spineline_files::guarded;

use crate::error::TableError;
use crate::table::{Series, Table, Values};

/// The version of the columns; another number means that some columns have another meaning.
pub const SCHEMA_VERSION: u32 = 1;

impl Table {
    /// The table as CSV: a heading, commas between cells, decimal points, UTF-8, empty cells without a value, and a quote before texts that a
    /// spreadsheet would run ([`spineline_files::guarded`]).
    pub fn to_csv(&self) -> Result<String, TableError> {
        Ok(self.csv_heading()? + &self.csv_rows()?)
    }

    /// The first line of [`Table::to_csv`].
    pub fn csv_heading(&self) -> Result<String, TableError> {
        self.csv(|writer| writer.write_record(self.columns.iter().map(|column| &column.name)))
    }

    /// The other lines.
    pub fn csv_rows(&self) -> Result<String, TableError> {
        self.csv(|writer| {
            (0..self.rows()).try_for_each(|row| {
                writer.write_record(self.columns.iter().map(|column| csv_cell(column, row)))
            })
        })
    }

    fn csv(
        &self,
        write: impl FnOnce(&mut csv::Writer<Vec<u8>>) -> csv::Result<()>,
    ) -> Result<String, TableError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let written = write(&mut writer)
            .and_then(|()| Ok(writer.into_inner().map_err(|error| error.into_error())?));
        let bytes = written.map_err(|source| TableError::Csv { table: self.name, source })?;
        Ok(String::from_utf8(bytes).expect("texts are UTF-8"))
    }

    /// The table as Parquet ([`ParquetWriter`]).
    pub fn to_parquet(&self, metadata: &[(&str, &str)]) -> Result<Vec<u8>, TableError> {
        let mut file = ParquetWriter::new(self)?;
        let rows = file.add(self)?;
        Ok([rows, file.finish(metadata)?].concat())
    }

    fn by_column(&self, of: impl Fn(&Series) -> &'static str) -> String {
        let pairs = self.columns.iter().map(|column| (column.name.clone(), of(column).into()));
        serde_json::Value::Object(pairs.collect()).to_string()
    }

    fn schema(&self) -> parquet::errors::Result<TypePtr> {
        let field = |column: &Series| {
            let (physical, logical) = match column.values {
                Values::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
                Values::Number(_) => (Physical::DOUBLE, None),
                Values::Count(_) => (Physical::INT64, None),
                Values::Truth(_) => (Physical::BOOLEAN, None),
            };
            let field = Type::primitive_type_builder(&column.name, physical)
                .with_logical_type(logical)
                .with_repetition(Repetition::OPTIONAL);
            field.build().map(Arc::new)
        };
        let fields = self.columns.iter().map(field).collect::<Result<_, _>>()?;
        Type::group_type_builder(self.name).with_fields(fields).build().map(Arc::new)
    }
}

/// A Parquet file that is made group of rows by group of rows, compressed by Snappy: the bytes that the functions return, one after
/// the other.
///
/// Its key-value metadata has the version of the columns (`spineline.schema_version`), what a row is (`spineline.row`), the units and
/// meanings of all columns as JSON (`spineline.units`, `spineline.meanings`), and what else is given.
pub struct ParquetWriter {
    table: &'static str,
    file: SerializedFileWriter<Vec<u8>>,
}

impl ParquetWriter {
    /// With the columns of a table, whose rows are not written yet.
    pub fn new(table: &Table) -> Result<Self, TableError> {
        let failed = |source| TableError::Parquet { table: table.name, source };
        let own = [
            ("spineline.schema_version", SCHEMA_VERSION.to_string()),
            ("spineline.row", table.row.to_owned()),
            ("spineline.units", table.by_column(|column| column.unit)),
            ("spineline.meanings", table.by_column(|column| column.meaning)),
        ];
        let own = own.into_iter().map(|(key, value)| KeyValue::new(key.to_owned(), value));
        let properties = WriterProperties::builder()
            .set_created_by(format!("spineline {}", env!("CARGO_PKG_VERSION")))
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(own.collect()));
        let schema = table.schema().map_err(failed)?;
        let file = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties.build()));
        Ok(Self { table: table.name, file: file.map_err(failed)? })
    }

    /// The rows of a table with the same columns as one group.
    pub fn add(&mut self, table: &Table) -> Result<Vec<u8>, TableError> {
        let written = self.add_group(table);
        written.map_err(|source| TableError::Parquet { table: self.table, source })
    }

    fn add_group(&mut self, table: &Table) -> parquet::errors::Result<Vec<u8>> {
        let mut group = self.file.next_row_group()?;
        for column in &table.columns {
            write_column(&mut group, &column.values)?;
        }
        group.close()?;
        self.file.flush()?;
        // The writer counts places in the file, so that the returned bytes can leave memory.
        Ok(std::mem::take(self.file.inner_mut()))
    }

    /// The end of the file, with further metadata.
    pub fn finish(mut self, metadata: &[(&str, &str)]) -> Result<Vec<u8>, TableError> {
        for &(key, value) in metadata {
            let pair = KeyValue::new(key.to_owned(), value.to_owned());
            self.file.append_key_value_metadata(pair);
        }
        let ended = self.file.into_inner();
        ended.map_err(|source| TableError::Parquet { table: self.table, source })
    }
}

fn csv_cell(column: &Series, row: usize) -> String {
    let text = column.shown(row);
    match column.values {
        Values::Text(_) => guarded(&text).into_owned(),
        Values::Number(_) | Values::Count(_) | Values::Truth(_) => text,
    }
}

fn write_column<W: std::io::Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &Values,
) -> parquet::errors::Result<()> {
    match values {
        Values::Text(all) => {
            write_values::<ByteArrayType, _, _>(group, all, |text| ByteArray::from(text.as_str()))
        }
        Values::Number(all) => write_values::<DoubleType, _, _>(group, all, |number| *number),
        Values::Count(all) => write_values::<Int64Type, _, _>(group, all, |count| *count),
        Values::Truth(all) => write_values::<BoolType, _, _>(group, all, |truth| *truth),
    }
}

/// Writes the values that there are, and for every row whether it has one.
fn write_values<D: DataType, T, W: std::io::Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[Option<T>],
    stored: impl Fn(&T) -> D::T,
) -> parquet::errors::Result<()> {
    let present: Vec<D::T> = values.iter().flatten().map(stored).collect();
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let mut column = group.next_column()?.expect("one per column of the schema");
    column.typed::<D>().write_batch(&present, Some(&levels), None)?;
    column.close()
}
