//! Outputs that grow patient by patient, so that no analysis stays in memory.

use std::path::PathBuf;

use spineline_files::{ListText, Provenance};
use spineline_tables::{Table, chain_table, errors_table};

use super::args::AnalyzeArgs;
use super::patient::OutputParts;
use super::tables::TablesFolder;
use crate::run::failure::Failure;
use crate::run::outputs::{Outputs, Pieces};

/// The outputs that were asked for, in the making; one that fails is left out.
pub struct Written<'a> {
    outputs: &'a Outputs,
    args: &'a AnalyzeArgs,
    json: Option<Json<'a>>,
    errors: Option<Pieces<'a>>,
    chain: Option<Pieces<'a>>,
    tables: Option<TablesFolder<'a>>,
}

/// One analysis, or a list of them.
struct Json<'a> {
    pieces: Pieces<'a>,
    list: Option<ListText>,
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
        let json = |path: &'a PathBuf| {
            let list = is_list.then(ListText::default);
            Ok::<_, Failure>(Json { pieces: outputs.begin(path)?, list })
        };
        let table = |path: &'a Option<PathBuf>, heading: Table| {
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
            args,
            json: args.json.as_ref().map(json).transpose()?,
            errors: table(&args.csv, errors_table(&[]))?,
            chain: table(&args.chain, chain_table(&[]))?,
            tables: tables
                .folder
                .as_ref()
                .map(|folder| TablesFolder::new(folder, &tables.formats, outputs)),
        })
    }

    /// Adds a patient.
    pub fn add(&mut self, parts: OutputParts) {
        let (outputs, args) = (self.outputs, self.args);
        if let (Some(path), Some(item)) = (&args.json, parts.json) {
            outputs.step(path, &mut self.json, |json| {
                if let Some(list) = &mut json.list {
                    json.pieces.add(list.before_item())?;
                }
                json.pieces.add(item)
            });
        }
        let tables = [
            (&args.csv, &mut self.errors, parts.errors),
            (&args.chain, &mut self.chain, parts.chain),
        ];
        for (path, pieces, table) in tables {
            if let (Some(path), Some(table)) = (path, table) {
                outputs.step(path, pieces, |pieces| pieces.add(table.csv_rows()?));
            }
        }
        if let (Some(folder), Some(optional)) = (&args.tables.folder, parts.optional) {
            outputs.step(folder, &mut self.tables, |tables| tables.add(parts.tables, optional));
        }
    }

    /// Ends them. The provenance is made where an output has one: it names every input.
    pub fn keep(self, provenance: impl FnOnce() -> Provenance) {
        let Self { outputs, args, json, errors, chain, tables } = self;
        if let (Some(path), Some(Json { mut pieces, list })) = (&args.json, json) {
            outputs.attempt(path, || {
                if let Some(list) = list {
                    pieces.add(list.end())?;
                }
                pieces.keep().map(|_| ())
            });
        }
        if errors.is_none() && chain.is_none() && tables.is_none() {
            return;
        }
        let provenance = provenance();
        for (pieces, path) in [(errors, &args.csv), (chain, &args.chain)] {
            if let (Some(pieces), Some(path)) = (pieces, path) {
                outputs
                    .attempt(path, || outputs.write_provenance(path, pieces.keep()?, &provenance));
            }
        }
        if let (Some(folder), Some(tables)) = (&args.tables.folder, tables) {
            outputs.attempt(folder, || tables.keep(&provenance));
        }
    }
}
