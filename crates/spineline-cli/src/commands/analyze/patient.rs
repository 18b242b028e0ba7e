//! One patient analysed, and what it adds to the outputs.

use std::path::{Path, PathBuf};

use spineline::analysis::Analysis;
use spineline::cohort::{CohortPatient, RefusalStep, RefusedCase};
use spineline_files::{AnalysisFile, ListText, RefusedFile, to_text};
use spineline_report::cohort::PatientRow;
use spineline_tables::{
    OptionalTables, Table, chain_table, errors_table, tables, tables_of_refused,
};

use super::args::AnalyzeArgs;
use crate::analysis::case::{Refusal, analyze_member};
use crate::analysis::confidence::Confidence;
use crate::analysis::record::RunRecord;
use crate::run::inputs::CaseInput;

/// What is asked of every patient.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    pub args: &'a AnalyzeArgs,
    pub record: &'a RunRecord,
    /// Whether outputs are lists, of one patient too.
    pub is_list: bool,
    /// Whether the patients are a cohort.
    pub is_cohort: bool,
}

impl<'a> Asked<'a> {
    /// By the command line.
    pub const fn new(args: &'a AnalyzeArgs, record: &'a RunRecord, is_list: bool) -> Self {
        Self { args, record, is_list, is_cohort: is_list || args.cohort.is_some() }
    }

    /// Whether a patient takes so long that all threads work on one: its replicates also stop by themselves.
    pub const fn is_long(self) -> bool {
        self.record.request.replicates.is_some() || self.record.request.identifiability
    }
}

/// A patient with everything that was found.
pub struct Analysed {
    pub path: PathBuf,
    pub input: CaseInput,
    pub analysis: Analysis,
    pub confidence: Confidence,
    pub parts: OutputParts,
    /// For a cohort.
    pub row: Option<(CohortPatient, PatientRow)>,
}

/// What a patient adds to each output that was asked for.
#[derive(Default)]
pub struct OutputParts {
    pub json: Option<String>,
    pub errors: Option<Table>,
    pub chain: Option<Table>,
    pub tables: Vec<Table>,
    /// Which optional tables are among them.
    pub optional: Option<OptionalTables>,
}

impl Analysed {
    /// Reads and analyses a case.
    ///
    /// # Errors
    /// If the file is no case, or of the analysis.
    pub fn of(path: &Path, asked: Asked<'_>) -> Result<Self, Refusal> {
        let request = &asked.record.request;
        let (input, analysis) = analyze_member(path, &request.options)?;
        let threads = if asked.is_long() { asked.args.threads } else { 1 };
        let confidence = match Confidence::compute(&input.case, &analysis, request, threads) {
            Ok(confidence) => confidence,
            Err(failure) => {
                return Err(Refusal::new(path, Some(&input), RefusalStep::Analysis, failure));
            }
        };
        Ok(Self {
            path: path.to_owned(),
            parts: OutputParts::of(&input, &analysis, &confidence, asked),
            row: asked.is_cohort.then(|| (CohortPatient::of(&analysis), PatientRow::of(&analysis))),
            input,
            analysis,
            confidence,
        })
    }
}

impl OutputParts {
    /// Of a case of a list without a result: every output names it.
    pub fn refused(case: &RefusedCase, asked: Asked<'_>) -> Self {
        let args = asked.args;
        let has_tables = args.tables.folder.is_some();
        Self {
            json: args.json.is_some().then(|| ListText::item(&RefusedFile::new(case))),
            errors: args.csv.is_some().then(|| errors_table(&[]).refused(case)),
            chain: args.chain.is_some().then(|| chain_table(&[]).refused(case)),
            tables: if has_tables { tables_of_refused(case) } else { Vec::new() },
            optional: has_tables.then(|| OptionalTables::of(&[])),
        }
    }

    fn of(
        input: &CaseInput,
        analysis: &Analysis,
        confidence: &Confidence,
        asked: Asked<'_>,
    ) -> Self {
        let Asked { args, record, .. } = asked;
        let json = || {
            let file = AnalysisFile::new(analysis, input.file.clone(), record.provenance_of(input));
            let file = confidence.add_to(analysis, file);
            if asked.is_list { ListText::item(&file) } else { to_text(&file) }
        };
        let one = std::slice::from_ref(analysis);
        let patient = [confidence.patient(analysis, &input.case)];
        let has_tables = args.tables.folder.is_some();
        Self {
            json: args.json.is_some().then(json),
            errors: args.csv.is_some().then(|| errors_table(one)),
            chain: args.chain.is_some().then(|| chain_table(one)),
            tables: if has_tables { tables(&patient) } else { Vec::new() },
            optional: has_tables.then(|| OptionalTables::of(&patient)),
        }
    }
}
