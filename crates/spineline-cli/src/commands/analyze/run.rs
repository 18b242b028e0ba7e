//! The loop over the cases.

use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use spineline::analysis::{Analysis, LineModel, ModelChoice};
use spineline::cohort::{Cohort, CohortPatient, RefusalStep, RefusedCase};
use spineline::warning::counted;
use spineline_files::Provenance;
use spineline_report::cohort::{self as cohort_report, PatientRow};
use spineline_report::document::Document;
use spineline_report::{WarningCounts, patient as report, warnings};

use super::args::AnalyzeArgs;
use super::model::choose;
use super::output::{Output, Step};
use crate::analysis::case::{Refusal, analyze_member};
use crate::analysis::cohort;
use crate::analysis::confidence::Confidence;
use crate::analysis::record::{ReadCases, RunRecord};
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::CaseInput;
use crate::run::interrupt;
use crate::run::messages::say;
use crate::run::outputs::{Outputs, print_notices};
use crate::run::progress::bar;
use crate::run::threads::stream_while;

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
    const fn is_cohort(self) -> bool {
        self.is_list || self.args.cohort.is_some()
    }

    /// Whether all threads work on one patient at a time, whose replicates also stop by themselves.
    const fn is_long(self) -> bool {
        self.record.request.replicates.is_some() || self.record.request.identifiability
    }

    fn analyze(self, path: &Path) -> Result<Analysed, Refusal> {
        let request = &self.record.request;
        let (input, analysis) = analyze_member(path, &request.options)?;
        let threads = if self.is_long() { self.args.threads } else { 1 };
        let confidence = Confidence::compute(&input.case, &analysis, request, threads)
            .map_err(|failure| Refusal::new(path, Some(&input), RefusalStep::Analysis, failure))?;
        let of_cohort = || (CohortPatient::of(&analysis), PatientRow::of(&analysis));
        let (patient, row) = self.is_cohort().then(of_cohort).unzip();
        Ok(Analysed { path: path.to_owned(), input, confidence, patient, row, analysis })
    }
}

/// A case with all its results.
pub struct Analysed {
    path: PathBuf,
    pub input: CaseInput,
    pub analysis: Analysis,
    pub confidence: Confidence,
    /// Only in a cohort.
    patient: Option<CohortPatient>,
    row: Option<PatientRow>,
}

/// What a run keeps from cases after their results are written.
pub struct Finished<'a> {
    asked: Asked<'a>,
    pub read: ReadCases,
    patients: Vec<CohortPatient>,
    rows: Vec<PatientRow>,
    warnings: WarningCounts,
    /// Cases of a list without a result.
    pub refused: Vec<RefusedCase>,
    /// A single case.
    pub one: Option<Analysed>,
    /// Its model to write, if requested.
    pub model: Option<ModelChoice>,
    /// Statistics of a cohort.
    pub together: Option<Cohort>,
    pub ending: Ending,
    is_cut_short: bool,
    has_replicates: bool,
}

/// Analyses all cases and passes each to all outputs; in a cohort, a case that fails is reported and left out.
///
/// # Errors
/// Of a single case; if threads cannot be started; an interruption before any replicate.
pub fn analyze_all<'a>(
    paths: &[PathBuf],
    asked: Asked<'a>,
    all: &[Box<dyn Output + 'a>],
) -> Result<Finished<'a>, Failure> {
    let _deferred = asked.record.request.replicates.map(|_| interrupt::defer());
    let progress =
        if asked.is_long() { ProgressBar::hidden() } else { bar("analysing", paths.len()) };
    let across = if asked.is_long() { 1 } else { asked.args.threads };
    let mut finished = Finished::new(asked);
    let run = |place: usize| {
        let result = asked.analyze(&paths[place]);
        let case = result.as_ref().map_err(|refusal| &*refusal.case);
        let steps: Vec<Step<'_>> = all.iter().map(|output| output.case(case)).collect();
        (result, steps)
    };
    let goes_on = || !interrupt::is_requested();
    let mut ended = 0;
    stream_while(&progress, (paths.len(), across), goes_on, run, |(result, mut steps)| {
        ended += 1;
        let checked = result.and_then(|one| match finished.read.add(&one.input, asked.record) {
            Ok(()) => Ok(one),
            Err(failure) => {
                let step = RefusalStep::Counting;
                let refusal = Refusal::new(&one.path, Some(&one.input), step, failure);
                steps = all.iter().map(|output| output.case(Err(&refusal.case))).collect();
                Err(refusal)
            }
        });
        match checked {
            Ok(one) => progress.suspend(|| finished.add(one, steps)),
            Err(refusal) if !asked.is_list => return Err(refusal.failure),
            Err(refusal) => progress.suspend(|| finished.refuse(refusal, steps)),
        }
        Ok(())
    })?;
    finished.leave_out(&paths[ended..], all);
    finished.check_interruption()?;
    print_notices(&finished.read.warnings());
    if !asked.args.warnings {
        print_notices(&finished.warnings.lines("--warnings"));
    }
    let of_all = || cohort::of(&finished.patients, asked.args.threads);
    finished.together = asked.is_cohort().then(of_all).transpose()?;
    Ok(finished)
}

impl<'a> Finished<'a> {
    fn new(asked: Asked<'a>) -> Self {
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

    /// Adds a patient to the outputs, prints its messages, and keeps the rest.
    fn add(&mut self, mut one: Analysed, steps: Vec<Step<'_>>) {
        let Analysed { analysis, confidence, .. } = &one;
        let args = self.asked.args;
        self.asked.outputs.of_case(&analysis.case_id);
        steps.into_iter().for_each(|step| step());
        self.is_cut_short |= confidence.is_cut_short();
        self.has_replicates |= confidence.has_replicates();
        self.model = args.model.as_ref().and_then(|_| choose(args, analysis));
        let chosen = self.model.as_ref().and_then(|choice| analysis.model(choice.kind));
        let is_written = args.model.is_none() || chosen.is_some_and(LineModel::is_converged);
        if self.ending == Ending::Done && !(analysis.has_what_was_asked() && is_written) {
            self.ending = Ending::NotConverged;
        }
        // Interrupted before any replicate: print nothing.
        if !self.is_cut_short || self.has_replicates {
            if args.warnings {
                print_notices(&warnings(analysis));
            }
            self.warnings.add(analysis);
            print_notices(confidence.interruption(analysis).as_slice());
        }
        self.patients.extend(one.patient.take());
        self.rows.extend(one.row.take());
        if !self.asked.is_list {
            self.one = Some(one);
        }
    }

    /// Reports a case without a result; every output names it.
    fn refuse(&mut self, Refusal { case, failure }: Refusal, steps: Vec<Step<'_>>) {
        say(&failure);
        self.ending = Ending::BadInput;
        case.case_id.iter().for_each(|id| self.asked.outputs.of_case(id));
        steps.into_iter().for_each(|step| step());
        self.refused.push(*case);
    }

    /// Names the cases that were not begun because the run was interrupted, in every output.
    fn leave_out(&mut self, paths: &[PathBuf], all: &[Box<dyn Output + 'a>]) {
        if paths.is_empty() {
            return;
        }
        self.is_cut_short = true;
        let left = counted(paths.len(), "case");
        say(format!("interrupted: {left} not begun; analyse them again"));
        for path in paths {
            let step = RefusalStep::Interruption;
            let Refusal { case, .. } = Refusal::new(path, None, step, Failure::interrupted());
            all.iter().for_each(|output| output.case(Err(&case))());
            self.refused.push(*case);
        }
    }

    fn check_interruption(&self) -> Result<(), Failure> {
        let has_results = !self.is_cut_short || self.has_replicates;
        if has_results { Ok(()) } else { Err(Failure::interrupted()) }
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
