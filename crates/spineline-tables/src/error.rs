//! Errors of writing a table.

/// A table that could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// As CSV.
    #[error("the table {table} as CSV: {source}")]
    Csv {
        /// Which table.
        table: &'static str,
        /// Why.
        source: csv::Error,
    },
    /// As Parquet.
    #[error("the table {table} as Parquet: {source}")]
    Parquet {
        /// Which table.
        table: &'static str,
        /// Why.
        source: parquet::errors::ParquetError,
    },
    /// Rows of a table with other columns.
    #[error("rows with other columns cannot be added to the table `{table}`")]
    Columns {
        /// Its name.
        table: &'static str,
    },
}
