//! Patients made and analysed.

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::cohort::{Claims, Cohort, CohortPatient, PatientClaims};
use spineline::multibody::Support;
use spineline::reliability::{QuantityReliability, assess, film_quantities};
use spineline_phantom::{Phantom, Readers, SUBJECTS, Scenario, generate};
use spineline_report::reproduction::Group;

use super::args::ReproduceArgs;
use crate::run::failure::Failure;
use crate::run::threads::map_all;

/// Patients analysed together with one support.
pub struct Run {
    /// Name of their group.
    pub name: &'static str,
    /// What the name means.
    pub meaning: String,
    pub support: Support,
    pub cases: Vec<Case>,
    pub analyses: Vec<Analysis>,
    /// Their statistics.
    pub cohort: Cohort,
}

/// Both supports: the paper's, and a patient on a table.
pub const SUPPORTS: [Support; 2] = [Support::Free, Support::Frontal];

/// The subjects of Table 1 in every scenario, in the order of [`Scenario::PAPER`]; it does not depend on the threads.
pub fn phantoms(args: &ReproduceArgs, readers: &Readers) -> Result<Vec<Phantom>, Failure> {
    let tasks: Vec<(Scenario, usize)> = Scenario::PAPER
        .iter()
        .flat_map(|&scenario| (0..SUBJECTS.len()).map(move |i| (scenario, i)))
        .collect();
    let made = map_all("phantoms", &tasks, args.threads, |&(scenario, subject)| {
        generate(subject, scenario, readers, args.seed).map_err(|error| error.to_string())
    })?;
    made.into_iter().collect::<Result<_, String>>().map_err(Failure::internal)
}

/// Analyses of phantoms with their options, and the same patients for a cohort.
pub fn analyses(
    args: &ReproduceArgs,
    tasks: &[(&Phantom, AnalysisOptions)],
) -> Result<(Vec<Analysis>, Vec<CohortPatient>), Failure> {
    let results = map_all("analyses", tasks, args.threads, |(phantom, options)| {
        let case = &phantom.case;
        let analysis = analyze(case, options).map_err(|error| format!("{}: {error}", case.id))?;
        let patient = CohortPatient::of(&analysis);
        Ok((analysis, patient))
    })?;
    results.into_iter().collect::<Result<_, String>>().map_err(Failure::internal)
}

/// Statistics of the subjects of Table 1, scenario by scenario.
pub fn cohorts(args: &ReproduceArgs, patients: &[CohortPatient]) -> Result<Vec<Cohort>, Failure> {
    let scenarios: Vec<_> = patients.chunks(SUBJECTS.len()).collect();
    map_all("statistics", &scenarios, args.threads, |patients| Cohort::of(patients, args.seed))
}

/// Analyses every phantom with both supports.
pub fn all_runs(args: &ReproduceArgs, phantoms: &[Phantom]) -> Result<Vec<Run>, Failure> {
    let tasks: Vec<_> = SUPPORTS
        .into_iter()
        .flat_map(|support| phantoms.iter().map(move |phantom| (phantom, args.options(support))))
        .collect();
    let (analyses, patients) = analyses(args, &tasks)?;
    let cohorts = cohorts(args, &patients)?;
    let mut analyses = analyses.into_iter();
    let scenarios = SUPPORTS
        .into_iter()
        .flat_map(|support| Scenario::PAPER.map(|scenario| (support, scenario)));
    let phantoms = phantoms.chunks(SUBJECTS.len()).cycle();
    let runs =
        scenarios.zip(phantoms).zip(cohorts).map(|(((support, scenario), phantoms), cohort)| {
            let cases = phantoms.iter().map(|phantom| phantom.case.clone()).collect();
            let analyses = analyses.by_ref().take(SUBJECTS.len()).collect();
            let (name, meaning) = (scenario.key(), scenario.to_string());
            Run { name, meaning, support, cases, analyses, cohort }
        });
    Ok(runs.collect())
}

/// The results of every group with both supports, and the paper's claims with its support.
pub fn groups(runs: &[Run], seed: u64) -> Vec<Group<'_>> {
    let with = |support| runs.iter().filter(move |run| run.support == support);
    let [free, frontal] = SUPPORTS.map(with);
    free.zip(frontal)
        .map(|(free, frontal)| {
            let patients: Vec<PatientClaims> =
                free.analyses.iter().map(PatientClaims::of).collect();
            Group {
                name: free.name,
                meaning: free.meaning.clone(),
                free: &free.cohort,
                frontal: &frontal.cohort,
                claims: Claims::of(&patients, seed),
                readings: readings(&free.analyses),
            }
        })
        .collect()
}

fn readings(analyses: &[Analysis]) -> Vec<QuantityReliability> {
    let cases: Vec<_> =
        analyses.iter().map(|one| (one.case_id.as_str(), &*one.movement.readings)).collect();
    film_quantities(&cases).iter().map(assess).collect()
}
