//! `spineline reproduce`: the paper's numbers on synthetic patients.
//!
//! 18 subjects in 3 loading scenarios are made, read, and analysed with both supports. Every number of the paper is set beside
//! ours with a verdict in words. The numbers are not goals: the scenario that moved the phantoms decides which line predicts better.

mod args;
mod drawings;
mod files;
mod film_lengths;
mod reports;
mod runs;

pub use args::ReproduceArgs;

use std::path::Path;

use spineline_files::{FilmOrigin, Provenance};
use spineline_phantom::SUBJECTS;
use spineline_report::reproduction::{full, parts, short};
use spineline_report::terminal::{self, Lines};

use crate::options::phantoms::readers;
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, print};
use crate::run::provenance::this_run;

/// Columns of the answer.
const WIDTH: usize = 100;

pub fn run(args: &ReproduceArgs) -> Result<Ending, Failure> {
    let readers = readers(args.noise)?;
    let outputs = Outputs::new(args.overwrite, []);
    outputs.folder(&args.out)?;
    outputs.table(&args.out.join("summary.csv"))?;
    outputs.file(&args.out.join("summary.json"))?;
    outputs.table(&args.out.join("summary.txt"))?;
    let phantoms = runs::phantoms(args, &readers)?;
    let runs = runs::all_runs(args, &phantoms)?;
    let scenarios = runs::scenarios(&runs, args.seed);
    let mut parts = parts(&scenarios);
    parts.push(film_lengths::part(args, &phantoms)?);
    let answer = terminal::terminal(&short(&scenarios, SUBJECTS.len(), args.seed), WIDTH);
    let every_number = full(&scenarios, &parts, SUBJECTS.len(), args.seed);
    print(Lines::of_text(&answer))?;
    if args.full {
        print(Lines::of_text(&format!("\n{every_number}")))?;
    }
    let provenance =
        Provenance::new(this_run()?, FilmOrigin::Synthetic, Vec::new()).with_seed(args.seed);
    let (figures, reports) = (args.out.join("figures"), args.out.join("reports"));
    outputs.attempt(&args.out, || {
        let text = format!("{answer}\n{every_number}");
        outputs.write_table(&args.out.join("summary.txt"), text, &provenance)?;
        files::write(&outputs, &runs, &parts, args, &provenance)
    });
    outputs.attempt(&figures, || drawings::write(&outputs, &figures, &runs, &provenance));
    outputs.attempt(&reports, || reports::write(&outputs, &reports, &runs, &provenance));
    outputs.commit()?;
    print(closing(&args.out))?;
    // A model without result in a scenario that contradicts it is a finding: the table counts it.
    Ok(Ending::Done)
}

fn closing(out: &Path) -> Lines {
    let mut lines = Lines::of(format!("Files in {}:", out.display()));
    lines.line(
        "  summary.txt: all numbers, both supports (--full prints them); summary.csv, summary.json",
    );
    lines.line("  errors/: every vertebra; analyses/: every patient; figures/; reports/: cohorts and patients");
    lines
}
