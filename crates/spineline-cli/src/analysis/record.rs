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
    /// SHA-256 of the cases that the distribution of joint rotations was learned from.
    learned_from: Vec<String>,
    /// In the order of the analyses.
    pub cases: Vec<CaseInput>,
}

impl RunRecord {
    /// Of this run, before any case is read.
    ///
    /// # Errors
    /// If a file that the options name cannot be read.
    pub fn new(method: &MethodArgs, uncertainty: &UncertaintyArgs) -> Result<Self, Failure> {
        let request = request(method, uncertainty)?;
        let shared = method.files().map(|path| read_input(path)).collect::<Result<_, _>>()?;
        let learned_from = method.stored_rotation_prior()?.map(|stored| stored.learned_from);
        let learned_from = learned_from.unwrap_or_default();
        Ok(Self { run: this_run()?, request, shared, learned_from, cases: Vec::new() })
    }

    /// Refuses a case whose rotations are known already: what is then predicted of it is no prediction.
    ///
    /// # Errors
    /// If the distribution of joint rotations was learned from it.
    pub fn refuse_learned(&self, source: &CaseInput) -> Result<(), Failure> {
        if self.learned_from.contains(&source.input.sha256) {
            let text = format!(
                "the distribution of joint rotations was learned from the case {}, so it cannot predict its films",
                source.case.id
            );
            let help = "leave out --rotation-prior (a cohort predicts every patient from the others), or learn it from other cases";
            return Err(Failure::input(&source.input.name, &text, help));
        }
        Ok(())
    }

    /// Refuses a case whose identifier was read before, since a cohort would count its patient twice, or which
    /// [`RunRecord::refuse_learned`] refuses.
    ///
    /// # Errors
    /// If one of both is so.
    pub fn refuse_known(
        &self,
        (analysis, source): (Analysis, CaseInput),
    ) -> Result<(Analysis, CaseInput), Failure> {
        self.refuse_learned(&source)?;
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
