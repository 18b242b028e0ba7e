//! `spineline reproduce`: the paper's numbers on synthetic patients, or on the patients that are given.
//!
//! 18 subjects in 3 loading scenarios are made, read, and analysed with both supports. Every number of the paper is set beside
//! ours with a verdict in words. The numbers are not goals: the scenario that moved the phantoms decides which line predicts better.

mod answer;
mod args;
mod drawings;
mod files;
mod film_lengths;
mod given;
mod reports;
mod runs;

pub use args::{EXAMPLES, ReproduceArgs};

use spineline_files::{FilmOrigin, Provenance};
use spineline_phantom::SUBJECTS;
use spineline_report::reproduction::Films;

use crate::options::phantoms::readers;
use crate::run::failure::{Ending, Failure};
use crate::run::provenance::this_run;

pub fn run(args: &ReproduceArgs) -> Result<Ending, Failure> {
    if args.cases.is_empty() { of_phantoms(args) } else { given::run(args) }
}

fn of_phantoms(args: &ReproduceArgs) -> Result<Ending, Failure> {
    let readers = readers(args.noise)?;
    let outputs = answer::checked_outputs(args, [])?;
    let phantoms = runs::phantoms(args, &readers)?;
    let runs = runs::all_runs(args, &phantoms)?;
    let films = Films::Phantoms { subjects: SUBJECTS.len(), seed: args.seed };
    let provenance =
        Provenance::new(this_run()?, FilmOrigin::Synthetic, Vec::new()).with_seed(args.seed);
    let lengths = film_lengths::part(args, &phantoms)?;
    // A model without result in a scenario that contradicts it is a finding: the table counts it.
    answer::write(args, films, &runs, Some(lengths), &provenance, outputs)
}
