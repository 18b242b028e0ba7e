//! `analyze --tables`: tidy tables of all cases.

use std::path::Path;

use spineline::cohort::RefusedCase;
use spineline_files::{InputFile, Provenance, ProvenanceFile, to_text};
use spineline_tables::{
    OptionalTables, ParquetWriter, Table, dictionary, tables, tables_of_refused,
};

use super::args::TableFormat;
use super::kept::{Analysed, Kept};
use super::output::{Growing, Output, Step};
use crate::run::failure::Failure;
use crate::run::outputs::{Outputs, Pieces};

/// Patients whose rows are one group of a Parquet file, so that its bytes do not depend on the threads.
const PATIENTS_PER_GROUP: usize = 64;

/// `--tables`: a folder of tables that grow patient by patient.
pub struct Tables<'a>(Growing<'a, TablesFolder<'a>>);

impl<'a> Tables<'a> {
    /// Without any table.
    pub const fn new(path: &'a Path, formats: &'a [TableFormat], outputs: &'a Outputs) -> Self {
        let optional =
            OptionalTables { uncertainty: false, hypotheses: false, space: false, axial: false };
        let begun =
            TablesFolder { path, formats, outputs, tables: Vec::new(), optional, patients: 0 };
        Self(Growing::new(outputs, path, begun))
    }
}

impl Output for Tables<'_> {
    fn case<'a>(&'a self, case: Result<&Analysed, &RefusedCase>) -> Step<'a> {
        let (rows, optional) = match case {
            Ok(Analysed { input, analysis, confidence, .. }) => {
                let patient = [confidence.patient(analysis, &input.case)];
                (tables(&patient), OptionalTables::of(&patient))
            }
            Err(refused) => (tables_of_refused(refused), OptionalTables::of(&[])),
        };
        Box::new(move || self.0.step(|folder| folder.add(rows, optional)))
    }

    fn end(self: Box<Self>, run: &Kept<'_>) {
        self.0.end(|folder| folder.keep(&run.provenance()));
    }
}

/// A table in the formats that were asked for.
struct GrowingTable<'a> {
    csv: Option<Pieces<'a>>,
    parquet: Option<(ParquetWriter, Pieces<'a>)>,
    /// Rows that are not in a file yet.
    rows: Table,
}

struct TablesFolder<'a> {
    path: &'a Path,
    formats: &'a [TableFormat],
    outputs: &'a Outputs,
    tables: Vec<GrowingTable<'a>>,
    optional: OptionalTables,
    /// Patients since the last group of rows.
    patients: usize,
}

impl<'a> TablesFolder<'a> {
    fn add(&mut self, tables: Vec<Table>, optional: OptionalTables) -> Result<(), Failure> {
        self.optional = self.optional.or(optional);
        for table in tables {
            match self.tables.iter_mut().find(|known| known.rows.name == table.name) {
                Some(known) => known.rows.append(table)?,
                None => {
                    let begun = self.begin(table)?;
                    self.tables.push(begun);
                }
            }
        }
        self.patients += 1;
        if self.patients == PATIENTS_PER_GROUP { self.write_rows() } else { Ok(()) }
    }

    fn begin(&self, rows: Table) -> Result<GrowingTable<'a>, Failure> {
        let file = |end: &str| self.outputs.begin(&self.path.join(format!("{}.{end}", rows.name)));
        let has = |format| self.formats.contains(&format);
        let csv = has(TableFormat::Csv).then(|| {
            let mut pieces = file("csv")?;
            pieces.add(rows.csv_heading()?)?;
            Ok::<_, Failure>(pieces)
        });
        let parquet = has(TableFormat::Parquet)
            .then(|| Ok::<_, Failure>((ParquetWriter::new(&rows)?, file("parquet")?)));
        Ok(GrowingTable { csv: csv.transpose()?, parquet: parquet.transpose()?, rows })
    }

    fn write_rows(&mut self) -> Result<(), Failure> {
        self.patients = 0;
        self.tables.iter_mut().try_for_each(GrowingTable::write_rows)
    }

    /// Ends all tables, and adds their dictionary and provenance.
    fn keep(mut self, provenance: &Provenance) -> Result<(), Failure> {
        if self.tables.is_empty() {
            // Columns without rows, where no case could be analysed.
            self.add(tables(&[]), OptionalTables::of(&[]))?;
        }
        if self.patients > 0 {
            self.write_rows()?;
        }
        let origin = to_text(&provenance.clone().of_listed_file());
        let mut files = Vec::new();
        for table in self.tables.drain(..) {
            table.keep(&origin, &mut files)?;
        }
        let meanings = dictionary(self.optional);
        let mut file = self.outputs.begin(&self.path.join(format!("{}.csv", meanings.name)))?;
        file.add(meanings.to_csv()?)?;
        files.push(file.keep()?);
        let file = ProvenanceFile::new(files, provenance.clone());
        self.outputs.write(&self.path.join("provenance.json"), to_text(&file))
    }
}

impl GrowingTable<'_> {
    fn write_rows(&mut self) -> Result<(), Failure> {
        if let Some(csv) = &mut self.csv {
            csv.add(self.rows.csv_rows()?)?;
        }
        if let Some((writer, pieces)) = &mut self.parquet {
            pieces.add(writer.add(&self.rows)?)?;
        }
        self.rows.clear();
        Ok(())
    }

    /// Ends the files and names them.
    fn keep(self, origin: &str, files: &mut Vec<InputFile>) -> Result<(), Failure> {
        if let Some(csv) = self.csv {
            files.push(csv.keep()?);
        }
        if let Some((writer, mut pieces)) = self.parquet {
            pieces.add(writer.finish(&[("spineline.provenance", origin)])?)?;
            files.push(pieces.keep()?);
        }
        Ok(())
    }
}
