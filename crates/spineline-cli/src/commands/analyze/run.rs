//! The loop over the cases.

use std::path::PathBuf;

use indicatif::ProgressBar;
use spineline::analysis::LineModel;
use spineline::cohort::RefusalStep;
use spineline::warning::counted;
use spineline_report::warnings;

use super::kept::{Analysed, Asked, Kept};
use super::model::choose;
use super::output::{Output, Step};
use crate::analysis::case::Refusal;
use crate::analysis::cohort;
use crate::analysis::confidence::interruption;
use crate::run::failure::{Ending, Failure};
use crate::run::interrupt;
use crate::run::messages::say;
use crate::run::outputs::print_notices;
use crate::run::progress::bar;
use crate::run::threads::stream_all;

/// Analyses all cases and passes each to all outputs; in a cohort, a case that fails is reported and left out.
///
/// # Errors
/// Of a single case; if threads cannot be started; an interruption before any replicate.
pub fn analyze_all<'a>(
    paths: &[PathBuf],
    asked: Asked<'a>,
    all: &[Box<dyn Output + 'a>],
) -> Result<Kept<'a>, Failure> {
    let _deferred = asked.record.request.replicates.map(|_| interrupt::defer());
    let progress =
        if asked.is_long() { ProgressBar::hidden() } else { bar("analysing", paths.len()) };
    let across = if asked.is_long() { 1 } else { asked.args.threads };
    let mut kept = Kept::new(asked);
    let run = |place: usize| {
        if interrupt::is_requested() {
            return None;
        }
        let result = asked.analyze(&paths[place]);
        let case = result.as_ref().map_err(|refusal| &*refusal.case);
        let steps: Vec<Step<'_>> = all.iter().map(|output| output.case(case)).collect();
        Some((result, steps))
    };
    let mut ended = 0;
    stream_all(&progress, 0..paths.len(), across, run, |begun| {
        let Some((result, mut steps)) = begun else { return Ok(()) };
        ended += 1;
        let checked = result.and_then(|one| match kept.read.add(&one.input, asked.record) {
            Ok(()) => Ok(one),
            Err(failure) => {
                let step = RefusalStep::Counting;
                let refusal = Refusal::new(&one.path, Some(&one.input), step, failure);
                steps = all.iter().map(|output| output.case(Err(&refusal.case))).collect();
                Err(refusal)
            }
        });
        match checked {
            Ok(one) => progress.suspend(|| kept.add(one, steps)),
            Err(refusal) if !asked.is_list => return Err(refusal.failure),
            Err(refusal) => progress.suspend(|| kept.refuse(refusal, steps)),
        }
        Ok(())
    })?;
    kept.is_cut_short |= ended < paths.len();
    if !kept.has_results() {
        return Err(Failure::interrupted());
    }
    kept.leave_out(&paths[ended..], all);
    print_notices(&kept.read.warnings());
    if !asked.args.warnings {
        print_notices(&kept.warnings.lines("--warnings"));
    }
    let of_all = || cohort::of(&kept.patients, cohort::BOOTSTRAP_SEED, asked.args.threads);
    kept.together = asked.is_cohort().then(of_all).transpose()?;
    Ok(kept)
}

impl<'a> Kept<'a> {
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
        if self.has_results() {
            if args.warnings {
                print_notices(&warnings(analysis));
            } else {
                print_notices(interruption(analysis).as_slice());
            }
            self.warnings.add(analysis);
            print_notices(self.asked.record.amplitude_note(analysis).as_slice());
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
        let left = counted(paths.len(), "case");
        say(format!("interrupted: {left} not begun; analyse them again"));
        for path in paths {
            let step = RefusalStep::Interruption;
            let Refusal { case, .. } = Refusal::new(path, None, step, Failure::interrupted());
            all.iter().for_each(|output| output.case(Err(&case))());
            self.refused.push(*case);
        }
    }

    /// Whether the run has results: nothing interrupted it, or at least one replicate is there.
    const fn has_results(&self) -> bool {
        !self.is_cut_short || self.has_replicates
    }
}
