//! `analyze --tables`: tidy tables of all cases.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use spineline_files::{InputFile, Provenance, ProvenanceFile, to_text};
use spineline_tables::{OptionalTables, Patient, Table, dictionary, tables};

use crate::run::failure::Failure;
use crate::run::outputs::Outputs;

/// Tables for pandas, R, Excel and others.
#[derive(Args)]
#[command(next_help_heading = "Tables")]
pub struct TablesArgs {
    /// Write tidy tables into this folder: patients, postures, vertebrae, joints, models, multipliers, springs, lines, clinical,
    /// reliability and warnings, and other loads and uncertainty where they are asked for; dictionary.csv defines every
    /// column, provenance.json names the inputs
    #[arg(long = "tables", value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// File formats of the tables
    #[arg(
        long = "tables-format",
        value_name = "FORMAT,FORMAT",
        value_enum,
        value_delimiter = ',',
        default_values = ["csv", "parquet"],
        requires = "folder"
    )]
    pub formats: Vec<TableFormat>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum TableFormat {
    /// Comma-separated text
    Csv,
    /// Typed columns with units and provenance, for pandas, polars, R and DuckDB
    Parquet,
}

/// Writes all tables of some patients, their dictionary and their provenance.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    folder: &Path,
    formats: &[TableFormat],
    patients: &[Patient<'_>],
    provenance: &Provenance,
    outputs: &Outputs,
) -> Result<(), Failure> {
    let mut folder = Folder { path: folder, files: Vec::new(), outputs };
    let origin = to_text(provenance);
    for table in tables(patients) {
        if formats.contains(&TableFormat::Csv) {
            folder.add(&table, "csv", table.to_csv()?.as_bytes())?;
        }
        if formats.contains(&TableFormat::Parquet) {
            let bytes = table.to_parquet(&[("spineline.provenance", &origin)]);
            folder.add(&table, "parquet", &bytes?)?;
        }
    }
    let meanings = dictionary(OptionalTables::of(patients));
    folder.add(&meanings, "csv", meanings.to_csv()?.as_bytes())?;
    let file = ProvenanceFile::new(folder.files, provenance.clone());
    outputs.write(&folder.path.join("provenance.json"), to_text(&file))
}

/// A folder of tables, and what was written into it.
struct Folder<'a> {
    path: &'a Path,
    files: Vec<InputFile>,
    outputs: &'a Outputs,
}

impl Folder<'_> {
    fn add(&mut self, table: &Table, end: &str, bytes: &[u8]) -> Result<(), Failure> {
        let name = format!("{}.{end}", table.name);
        self.outputs.write(&self.path.join(&name), bytes)?;
        self.files.push(InputFile::of(name, bytes));
        Ok(())
    }
}
