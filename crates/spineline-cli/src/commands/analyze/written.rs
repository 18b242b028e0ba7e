//! Outputs that grow patient by patient, so that no analysis stays in memory.

use spineline_files::{ListText, Provenance};
use spineline_tables::{Table, chain_table, errors_table};

use super::args::AnalyzeArgs;
use super::patient::OutputParts;
use super::tables::TablesFolder;
use crate::run::failure::Failure;
use crate::run::outputs::{Outputs, Pieces};

/// The outputs that were asked for, in the making.
pub struct Written<'a> {
    outputs: &'a Outputs,
    json: Option<Pieces<'a>>,
    /// For a list of analyses.
    list: Option<ListText>,
    errors: Option<Pieces<'a>>,
    chain: Option<Pieces<'a>>,
    tables: Option<TablesFolder<'a>>,
}

impl<'a> Written<'a> {
    /// Begins them.
    ///
    /// # Errors
    /// If one cannot be written.
    pub fn begin(
        args: &'a AnalyzeArgs,
        is_list: bool,
        outputs: &'a Outputs,
    ) -> Result<Self, Failure> {
        let table = |path: &'a Option<std::path::PathBuf>, heading: Table| {
            let begun = path.as_ref().map(|path| {
                let mut pieces = outputs.begin(path)?;
                pieces.add(heading.csv_heading()?)?;
                Ok::<_, Failure>(pieces)
            });
            begun.transpose()
        };
        let tables = &args.tables;
        Ok(Self {
            outputs,
            json: args.json.as_ref().map(|path| outputs.begin(path)).transpose()?,
            list: is_list.then(ListText::default),
            errors: table(&args.csv, errors_table(&[]))?,
            chain: table(&args.chain, chain_table(&[]))?,
            tables: tables
                .folder
                .as_ref()
                .map(|folder| TablesFolder::new(folder, &tables.formats, outputs)),
        })
    }

    /// Adds a patient.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, parts: OutputParts) -> Result<(), Failure> {
        if let (Some(json), Some(item)) = (&mut self.json, parts.json) {
            if let Some(list) = &mut self.list {
                json.add(list.before_item())?;
            }
            json.add(item)?;
        }
        let tables = [(&mut self.errors, parts.errors), (&mut self.chain, parts.chain)];
        for (pieces, table) in tables {
            if let (Some(pieces), Some(table)) = (pieces, table) {
                pieces.add(table.csv_rows()?)?;
            }
        }
        if let (Some(tables), Some(optional)) = (&mut self.tables, parts.optional) {
            tables.add(parts.tables, optional)?;
        }
        Ok(())
    }

    /// Ends them. The provenance is made where an output has one: it names every input.
    ///
    /// # Errors
    /// If one cannot be written.
    pub fn keep(
        self,
        args: &AnalyzeArgs,
        provenance: impl FnOnce() -> Provenance,
    ) -> Result<(), Failure> {
        if let Some(mut json) = self.json {
            if let Some(list) = self.list {
                json.add(list.end())?;
            }
            json.keep()?;
        }
        if self.errors.is_none() && self.chain.is_none() && self.tables.is_none() {
            return Ok(());
        }
        let provenance = provenance();
        for (pieces, path) in [(self.errors, &args.csv), (self.chain, &args.chain)] {
            if let (Some(pieces), Some(path)) = (pieces, path) {
                self.outputs.write_provenance(path, pieces.keep()?, &provenance)?;
            }
        }
        self.tables.map_or(Ok(()), |tables| tables.keep(&provenance))
    }
}
