//! What a run was asked and what it has read.

use spineline::analysis::Analysis;
use spineline_files::{FilmOrigin, InputFile, ProgramRun, Provenance, Request};
use spineline_report::document::{Notice, NoticeKind};

use crate::options::method::MethodArgs;
use crate::options::request;
use crate::options::uncertainty::UncertaintyArgs;
use crate::run::failure::Failure;
use crate::run::inputs::{CaseInput, read_input};
use crate::run::provenance::this_run;

/// What this run was asked and what it has read: the provenance of its outputs.
pub struct RunRecord {
    run: ProgramRun,
    /// What is asked of every case.
    pub request: Request,
    /// Files that were read for all cases.
    shared: Vec<InputFile>,
    /// In the order of the analyses.
    pub cases: Vec<CaseInput>,
}

impl RunRecord {
    /// Of this run, before any case is read.
    ///
    /// # Errors
    /// If a stiffness table cannot be read.
    pub fn new(method: &MethodArgs, uncertainty: &UncertaintyArgs) -> Result<Self, Failure> {
        let request = request(method, uncertainty)?;
        let tables = method.stiffness_file().into_iter();
        let shared = tables.map(|path| read_input(path)).collect::<Result<_, _>>()?;
        Ok(Self { run: this_run()?, request, shared, cases: Vec::new() })
    }

    /// Refuses a case whose identifier was read before: a cohort would count its patient twice.
    ///
    /// # Errors
    /// If the identifier was read before.
    pub fn refuse_duplicate(
        &self,
        (analysis, source): (Analysis, CaseInput),
    ) -> Result<(Analysis, CaseInput), Failure> {
        if self.cases.iter().any(|earlier| earlier.case.id == source.case.id) {
            let text = format!("the case {} was given already", source.case.id);
            let help = "give every case a `case_id` of its own";
            return Err(Failure::input(&source.input.name, &text, help));
        }
        Ok((analysis, source))
    }

    /// Warnings about cases that were read from analyses with other options.
    pub fn warnings(&self) -> Vec<Notice> {
        let other = |asked: &Request| asked.options != self.request.options;
        let others = self.cases.iter().filter(|source| source.request.as_ref().is_some_and(other));
        let warning = |source: &CaseInput| Notice {
            kind: NoticeKind::Warning,
            place: source.input.name.clone(),
            text: "this analysis was made with other options; `spineline rerun` keeps them"
                .to_owned(),
            code: "other_options".to_owned(),
        };
        others.map(warning).collect()
    }

    /// Provenance of an output that is made from some of the cases.
    pub fn provenance_of(&self, cases: &[CaseInput]) -> Provenance {
        let films = FilmOrigin::of(cases.iter().map(|source| source.case.synthetic));
        let inputs = cases.iter().map(|source| source.input.clone());
        let inputs = inputs.chain(self.shared.iter().cloned()).collect();
        Provenance::new(self.run.clone(), films, inputs).asking(&self.request)
    }

    /// Provenance of an output that is made from all cases.
    pub fn provenance(&self) -> Provenance {
        self.provenance_of(&self.cases)
    }
}
