//! What is asked for every case, and what a run keeps from cases.

use std::path::{Path, PathBuf};

use spineline::analysis::{Analysis, ModelChoice};
use spineline::cohort::{Cohort, CohortPatient, RefusalStep, RefusedCase};
use spineline_files::Provenance;
use spineline_report::cohort::{self as cohort_report, PatientRow};
use spineline_report::document::Document;
use spineline_report::{WarningCounts, patient as report};

use super::args::AnalyzeArgs;
use crate::analysis::case::{Refusal, analyze_member};
use crate::analysis::confidence::Confidence;
use crate::analysis::record::{ReadCases, RunRecord};
use crate::run::failure::Ending;
use crate::run::inputs::CaseInput;
use crate::run::outputs::Outputs;

/// What the user asks for every case.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    pub args: &'a AnalyzeArgs,
    pub record: &'a RunRecord,
    pub outputs: &'a Outputs,
    /// Whether outputs are lists, even of one patient.
    pub is_list: bool,
}

impl Asked<'_> {
    /// Whether the patients are a cohort.
    pub(super) const fn is_cohort(self) -> bool {
        self.is_list || self.args.cohort.is_some()
    }

    /// Whether all threads work on one patient at a time, whose replicates also stop by themselves.
    pub(super) const fn is_long(self) -> bool {
        self.record.request.replicates.is_some() || self.record.request.identifiability
    }

    pub(super) fn analyze(self, path: &Path) -> Result<Analysed, Refusal> {
        let request = &self.record.request;
        let (input, mut analysis) = analyze_member(path, self.record)?;
        let threads = if self.is_long() { self.args.threads } else { 1 };
        let confidence = Confidence::compute(&input.case, &mut analysis, request, threads)
            .map_err(|failure| Refusal::new(path, Some(&input), RefusalStep::Analysis, failure))?;
        let of_cohort = || (CohortPatient::of(&analysis), PatientRow::of(&analysis));
        let (patient, row) = self.is_cohort().then(of_cohort).unzip();
        Ok(Analysed { path: path.to_owned(), input, confidence, patient, row, analysis })
    }
}

/// A case with all its results.
pub struct Analysed {
    pub(super) path: PathBuf,
    pub input: CaseInput,
    pub analysis: Analysis,
    pub confidence: Confidence,
    /// Only in a cohort.
    pub(super) patient: Option<CohortPatient>,
    pub(super) row: Option<PatientRow>,
}

/// What a run keeps from cases after their results are written.
pub struct Kept<'a> {
    pub(super) asked: Asked<'a>,
    pub read: ReadCases,
    pub(super) patients: Vec<CohortPatient>,
    pub(super) rows: Vec<PatientRow>,
    pub(super) warnings: WarningCounts,
    /// Cases of a list without a result.
    pub refused: Vec<RefusedCase>,
    /// A single case.
    pub one: Option<Analysed>,
    /// Its model to write, if requested.
    pub model: Option<ModelChoice>,
    pub together: Option<Cohort>,
    pub ending: Ending,
    pub(super) is_cut_short: bool,
    pub(super) has_replicates: bool,
}

impl<'a> Kept<'a> {
    pub(super) fn new(asked: Asked<'a>) -> Self {
        Self {
            asked,
            read: ReadCases::default(),
            patients: Vec::new(),
            rows: Vec::new(),
            warnings: WarningCounts::default(),
            refused: Vec::new(),
            one: None,
            model: None,
            together: None,
            ending: Ending::Done,
            is_cut_short: false,
            has_replicates: false,
        }
    }

    /// How the command ends.
    pub const fn ending(&self) -> Ending {
        if self.is_cut_short { Ending::Interrupted } else { self.ending }
    }

    /// Provenance of an output that is made from all cases.
    pub fn provenance(&self) -> Provenance {
        self.asked.record.provenance_of_all(&self.read)
    }

    /// The document for the terminal: a cohort or one patient in short, or with all numbers.
    pub fn shown(&self, generator: &str) -> Option<Document> {
        let is_full = self.asked.args.full;
        if let Some(Analysed { input, analysis, confidence, .. }) = &self.one {
            let patient = confidence.report(analysis, &input.case, generator);
            return Some(if is_full { report::full(&patient) } else { report::summary(&patient) });
        }
        let cohort = cohort_report::Rows {
            patients: &self.rows,
            together: self.together.as_ref()?,
            refused: &self.refused,
            generator,
        };
        Some(if is_full { cohort_report::full(&cohort) } else { cohort_report::summary(&cohort) })
    }
}
