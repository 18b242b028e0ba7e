//! Tables as streams of Arrow, which pandas, polars, pyarrow and duckdb read.

use std::collections::HashMap;
use std::ffi::CStr;
use std::sync::Arc;

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
};
use arrow_schema::{DataType, Field, Schema};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList};
use spineline_tables::{Series, Table as Columns, Values};

use crate::numbers;

/// The name of the capsule, fixed by the Arrow PyCapsule interface.
const STREAM: &CStr = c"arrow_array_stream";

/// A table: columns of the same length.
#[pyclass(frozen, module = "spineline._native")]
pub struct Table {
    columns: Columns,
}

impl Table {
    pub fn new(columns: Columns) -> Self {
        Self { columns }
    }

    fn batch(&self) -> Result<RecordBatch, arrow_schema::ArrowError> {
        let fields: Vec<Field> = self.columns.columns.iter().map(field).collect();
        let metadata = [("spineline.row".to_owned(), self.columns.row.to_owned())];
        let schema = Schema::new(fields).with_metadata(HashMap::from(metadata));
        let arrays = self.columns.columns.iter().map(|column| array(&column.values)).collect();
        RecordBatch::try_new(Arc::new(schema), arrays)
    }
}

fn field(column: &Series) -> Field {
    let kind = match column.values {
        Values::Text(_) => DataType::Utf8,
        Values::Number(_) => DataType::Float64,
        Values::Count(_) => DataType::Int64,
        Values::Truth(_) => DataType::Boolean,
    };
    let metadata = [("unit", column.unit), ("meaning", column.meaning)];
    let metadata = metadata.map(|(key, value)| (key.to_owned(), value.to_owned()));
    Field::new(&column.name, kind, true).with_metadata(HashMap::from(metadata))
}

fn array(values: &Values) -> ArrayRef {
    match values {
        Values::Text(all) => Arc::new(StringArray::from_iter(all.iter().map(Option::as_deref))),
        Values::Number(all) => Arc::new(Float64Array::from_iter(all.iter().copied())),
        Values::Count(all) => Arc::new(Int64Array::from_iter(all.iter().copied())),
        Values::Truth(all) => Arc::new(BooleanArray::from_iter(all.iter().copied())),
    }
}

#[pymethods]
impl Table {
    /// Name of its file.
    #[getter]
    fn name(&self) -> &'static str {
        self.columns.name
    }

    /// Meaning of one row.
    #[getter]
    fn row(&self) -> &'static str {
        self.columns.row
    }

    /// Names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.columns.columns.iter().map(|column| column.name.clone()).collect()
    }

    /// Unit of every column that has one.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for column in self.columns.columns.iter().filter(|column| !column.unit.is_empty()) {
            units.set_item(&column.name, column.unit)?;
        }
        Ok(units)
    }

    /// Meaning of every column.
    #[getter]
    fn meanings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let meanings = PyDict::new(py);
        for column in &self.columns.columns {
            meanings.set_item(&column.name, column.meaning)?;
        }
        Ok(meanings)
    }

    fn __len__(&self) -> usize {
        self.columns.rows()
    }

    /// One column: numbers as a read-only array with NaN for missing values, other columns as a list with None; None
    /// for an unknown name.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(column) = self.columns.columns.iter().find(|column| column.name == name) else {
            return Ok(None);
        };
        let values = match &column.values {
            Values::Number(all) => {
                let all = all.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
                numbers::row(py, all).into_any()
            }
            Values::Text(all) => PyList::new(py, all)?.into_any(),
            Values::Count(all) => PyList::new(py, all)?.into_any(),
            Values::Truth(all) => PyList::new(py, all)?.into_any(),
        };
        Ok(Some(values))
    }

    /// The text of its CSV file.
    fn to_csv(&self) -> PyResult<String> {
        self.columns.to_csv().map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }

    /// The bytes of its Parquet file, with additional metadata as pairs.
    fn to_parquet(&self, metadata: Vec<(String, String)>) -> PyResult<Vec<u8>> {
        let pairs: Vec<(&str, &str)> =
            metadata.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
        self.columns.to_parquet(&pairs).map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }

    /// The stream of the Arrow PyCapsule interface. The requested schema is ignored, as the interface allows.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let batch = self.batch().map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        let schema = batch.schema();
        let batches = RecordBatchIterator::new([Ok(batch)], schema);
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(batches)), STREAM)
    }
}
