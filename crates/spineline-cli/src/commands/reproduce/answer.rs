//! The answer of a reproduction on the screen, and its files.

use std::path::Path;

use spineline_files::Provenance;
use spineline_report::reproduction::{Films, Part, Reproduction, full, parts, short};
use spineline_report::terminal::{self, Lines};

use super::args::ReproduceArgs;
use super::runs::{Run, groups};
use super::{drawings, files, reports};
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, print};

/// Columns of the answer.
const WIDTH: usize = 100;

/// Checks every output before any work.
pub fn checked_outputs<'a>(
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
pub fn write(
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
