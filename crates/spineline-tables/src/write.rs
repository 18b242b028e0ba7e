//! Tables as files.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use crate::error::TableError;
use crate::table::{Series, Table, Values};

/// The tables' columns are those of this version; another number means that some mean something else.
pub const SCHEMA_VERSION: u32 = 1;

impl Table {
    /// The table as CSV: a heading, commas between cells, decimal points, UTF-8, empty cells without a value.
    ///
    /// # Errors
    /// [`TableError::Csv`].
    pub fn to_csv(&self) -> Result<String, TableError> {
        self.csv().map_err(|source| TableError::Csv { table: self.name, source })
    }

    fn csv(&self) -> csv::Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.columns.iter().map(|column| &column.name))?;
        for row in 0..self.rows() {
            writer.write_record(self.columns.iter().map(|column| column.shown(row)))?;
        }
        let bytes = writer.into_inner().map_err(|error| error.into_error())?;
        Ok(String::from_utf8(bytes).expect("texts are UTF-8"))
    }

    /// The table as Parquet, compressed by Snappy. Its key-value metadata has the version of the columns
    /// (`spineline.schema_version`), what a row is (`spineline.row`), the units and meanings of all columns as JSON
    /// (`spineline.units`, `spineline.meanings`), and what else is given.
    ///
    /// # Errors
    /// [`TableError::Parquet`].
    pub fn to_parquet(&self, metadata: &[(&str, &str)]) -> Result<Vec<u8>, TableError> {
        self.parquet(metadata).map_err(|source| TableError::Parquet { table: self.name, source })
    }

    fn parquet(&self, metadata: &[(&str, &str)]) -> parquet::errors::Result<Vec<u8>> {
        let own = [
            ("spineline.schema_version", SCHEMA_VERSION.to_string()),
            ("spineline.row", self.row.to_owned()),
            ("spineline.units", self.by_column(|column| column.unit)),
            ("spineline.meanings", self.by_column(|column| column.meaning)),
        ];
        let given = metadata.iter().map(|&(key, value)| (key, value.to_owned()));
        let pairs =
            own.into_iter().chain(given).map(|(key, value)| KeyValue::new(key.to_owned(), value));
        let properties = WriterProperties::builder()
            .set_created_by(format!("spineline {}", env!("CARGO_PKG_VERSION")))
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(pairs.collect()));
        let mut bytes = Vec::new();
        let properties = Arc::new(properties.build());
        let mut file = SerializedFileWriter::new(&mut bytes, self.schema()?, properties)?;
        let mut group = file.next_row_group()?;
        for column in &self.columns {
            write_column(&mut group, &column.values)?;
        }
        group.close()?;
        file.close()?;
        Ok(bytes)
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
