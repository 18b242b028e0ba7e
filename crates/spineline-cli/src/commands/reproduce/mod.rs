//! `spineline reproduce`: the paper's numbers on synthetic patients, or on the patients that are given.
//!
//! 18 subjects in 3 loading scenarios are made, read, and analysed with both supports. Every number of the paper is set beside
//! ours with a verdict in words. The numbers are not goals: the scenario that moved the phantoms decides which line predicts better.

mod args;
mod drawings;
mod files;
mod film_lengths;
mod given;
mod reports;
mod runs;

pub use args::{EXAMPLES, ReproduceArgs};

use std::path::Path;

use spineline_files::{FilmOrigin, Provenance};
use spineline_phantom::SUBJECTS;
use spineline_report::reproduction::{Films, Part, Reproduction, full, parts, short};
use spineline_report::terminal::{self, Lines};

use crate::options::phantoms::readers;
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, print};
use crate::run::provenance::this_run;
use runs::{Run, groups};

/// Columns of the answer.
const WIDTH: usize = 100;

pub fn run(args: &ReproduceArgs) -> Result<Ending, Failure> {
    if args.cases.is_empty() { of_phantoms(args) } else { given::run(args) }
}

fn of_phantoms(args: &ReproduceArgs) -> Result<Ending, Failure> {
    let readers = readers(args.noise)?;
    let outputs = checked_outputs(args, [])?;
    let phantoms = runs::phantoms(args, &readers)?;
    let runs = runs::all_runs(args, &phantoms)?;
    let films = Films::Phantoms { subjects: SUBJECTS.len(), seed: args.seed };
    let provenance =
        Provenance::new(this_run()?, FilmOrigin::Synthetic, Vec::new()).with_seed(args.seed);
    let lengths = film_lengths::part(args, &phantoms)?;
    // A model without result in a scenario that contradicts it is a finding: the table counts it.
    write(args, films, &runs, Some(lengths), &provenance, outputs)
}

/// Checks every output before any work.
fn checked_outputs<'a>(
    args: &ReproduceArgs,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<Outputs, Failure> {
    let outputs = Outputs::new(args.overwrite, inputs);
    outputs.folder(&args.out)?;
    outputs.table(&args.out.join("summary.csv"))?;
    outputs.file(&args.out.join("summary.json"))?;
    outputs.table(&args.out.join("summary.txt"))?;
    Ok(outputs)
}

/// Prints the answer and writes every file.
fn write(
    args: &ReproduceArgs,
    films: Films,
    runs: &[Run],
    more: Option<Part>,
    provenance: &Provenance,
    outputs: Outputs,
) -> Result<Ending, Failure> {
    let groups = groups(runs, args.seed);
    let reproduction = Reproduction { films, method: args.method, groups };
    let mut parts = parts(&reproduction);
    parts.extend(more);
    let answer = terminal::terminal(&short(&reproduction), WIDTH);
    let every_number = full(&reproduction, &parts);
    print(Lines::of_text(&answer))?;
    if args.full {
        print(Lines::of_text(&format!("\n{every_number}")))?;
    }
    let (figures, reports) = (args.out.join("figures"), args.out.join("reports"));
    outputs.attempt(&args.out, || {
        let text = format!("{answer}\n{every_number}");
        outputs.write_table(&args.out.join("summary.txt"), text, provenance)?;
        files::write(&outputs, runs, &parts, args, provenance)
    });
    outputs.attempt(&figures, || drawings::write(&outputs, &figures, runs, provenance));
    outputs.attempt(&reports, || reports::write(&outputs, &reports, runs, provenance));
    outputs.commit()?;
    print(closing(&args.out))
}

fn closing(out: &Path) -> Lines {
    let mut lines = Lines::of(format!("Files in {}:", out.display()));
    lines.line(
        "  summary.txt: all numbers, both supports (--full prints them); summary.csv, summary.json",
    );
    lines.line("  errors/: every vertebra; analyses/: every patient; figures/; reports/: cohorts and patients");
    lines
}
