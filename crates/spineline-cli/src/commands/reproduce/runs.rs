//! Every phantom made and analysed.

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::cohort::{Cohort, CohortPatient};
use spineline::multibody::Support;
use spineline_phantom::{Readers, SUBJECTS, Truth, generate};

use super::args::ReproduceArgs;
use crate::run::failure::Failure;
use crate::run::threads::map_all;

/// The phantoms of one loading scenario, analysed with one support.
pub struct Run {
    /// The loading scenario.
    pub truth: Truth,
    /// Their support.
    pub support: Support,
    /// One case per subject of Table 1.
    pub cases: Vec<Case>,
    /// Their analyses.
    pub analyses: Vec<Analysis>,
    /// Their statistics.
    pub cohort: Cohort,
}

/// Both supports: the paper's, and a patient on a table.
const SUPPORTS: [Support; 2] = [Support::Free, Support::Frontal];

/// The support in words.
pub fn support_words(support: Support) -> &'static str {
    match support {
        Support::Free => "free support (the paper's)",
        Support::Frontal => "frontal support (in the frontal plane, as on a table)",
    }
}

/// Analyses every phantom with both supports; the order of the results does not depend on the threads.
pub fn all_runs(args: &ReproduceArgs, readers: &Readers) -> Result<Vec<Run>, Failure> {
    let tasks: Vec<(Truth, usize)> =
        Truth::ALL.iter().flat_map(|&truth| (0..SUBJECTS.len()).map(move |i| (truth, i))).collect();
    let results = map_all("phantoms", &tasks, args.threads, |&(truth, subject)| {
        let phantom =
            generate(subject, truth, readers, args.seed).map_err(|error| error.to_string())?;
        let with = |support| {
            let options =
                AnalysisOptions { support, target: args.fit, ..AnalysisOptions::default() };
            analyze(&phantom.case, &options)
                .map_err(|error| format!("{}: {error}", phantom.case.id))
        };
        let analyses = [with(SUPPORTS[0])?, with(SUPPORTS[1])?];
        Ok::<_, String>((phantom.case, analyses))
    })?;
    let mut by_support: [Vec<Analysis>; 2] = Default::default();
    let mut cases = Vec::new();
    for result in results {
        let (case, [free, frontal]) = result.map_err(Failure::internal)?;
        cases.push(case);
        by_support[0].push(free);
        by_support[1].push(frontal);
    }
    let mut runs = Vec::new();
    for (support, analyses) in SUPPORTS.into_iter().zip(by_support) {
        let (mut cases, mut analyses) = (cases.iter().cloned(), analyses.into_iter());
        for truth in Truth::ALL {
            let analyses: Vec<Analysis> = analyses.by_ref().take(SUBJECTS.len()).collect();
            let cohort =
                Cohort::of(&analyses.iter().map(CohortPatient::of).collect::<Vec<_>>(), args.seed);
            let cases = cases.by_ref().take(SUBJECTS.len()).collect();
            runs.push(Run { truth, support, cases, analyses, cohort });
        }
    }
    Ok(runs)
}
