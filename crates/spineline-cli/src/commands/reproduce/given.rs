//! The paper's numbers on the patients that are given.

use spineline::analysis::{Analysis, Case};
use spineline::cohort::CohortPatient;
use spineline::multibody::Support;
use spineline_files::Request;
use spineline_report::reproduction::Films;

use super::answer::{checked_outputs, write};
use super::args::ReproduceArgs;
use super::runs::{Run, SUPPORTS};
use crate::analysis::case::analyze_input;
use crate::analysis::cohort::{self, Members};
use crate::analysis::record::RunRecord;
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::case_files;
use crate::run::outputs::print_notices;
use crate::run::threads::map_all;

/// Name of the group of all patients, and its meaning.
const GROUP: [&str; 2] = ["films", "the films that were given"];

pub fn run(args: &ReproduceArgs) -> Result<Ending, Failure> {
    let paths = case_files(&args.cases)?;
    let outputs = checked_outputs(args, paths.iter().map(AsRef::as_ref))?;
    let options = args.options(Support::Free);
    let record = RunRecord::asking(Request { options, ..Request::default() })?;
    let members = Members::analyze(&paths, &record, args.threads)?;
    print_notices(&members.read.warnings());
    members.read.ids().iter().for_each(|id| outputs.of_case(id));
    let provenance = record.provenance_of_all(&members.read).with_seed(args.seed);
    let options = args.options(Support::Frontal);
    let frontal = map_all("frontal support", &members.sources, args.threads, |(path, source)| {
        analyze_input(path, source, &options)
    })?;
    let frontal: Vec<Analysis> = frontal.into_iter().collect::<Result<_, _>>()?;
    let cases: Vec<Case> = members.sources.iter().map(|(_, source)| source.case.clone()).collect();
    let mut runs = Vec::new();
    for (support, analyses) in SUPPORTS.into_iter().zip([members.analyses, frontal]) {
        let patients: Vec<CohortPatient> = analyses.iter().map(CohortPatient::of).collect();
        let cohort = cohort::of(&patients, args.seed, args.threads)?;
        let [name, meaning] = GROUP;
        let meaning = meaning.to_owned();
        runs.push(Run { name, meaning, support, cases: cases.clone(), analyses, cohort });
    }
    let ending = write(args, Films::Given, &runs, None, &provenance, outputs)?;
    Ok(if members.refused.is_empty() { ending } else { Ending::BadInput })
}
