//! `spineline reproduce`: the paper's numbers on synthetic patients.
//!
//! 18 subjects in 3 loading scenarios are made, read, and analysed with both supports. Every number of the paper is set beside
//! ours with a verdict in words. None of them is a goal: the scenario that moved the phantoms decides which line predicts better.

mod args;
mod drawings;
mod fair;
mod files;
mod film_lengths;
mod reports;
mod row;
mod runs;
mod sections;

pub use args::ReproduceArgs;

use std::path::Path;

use spineline_files::{FilmOrigin, Provenance};
use spineline_phantom::{SUBJECTS, Scenario};
use spineline_report::document::{Column, Table};
use spineline_report::terminal::{self, Lines};

use crate::options::phantoms::readers;
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, print};
use crate::run::provenance::this_run;
use row::Section;

pub fn run(args: &ReproduceArgs) -> Result<Ending, Failure> {
    let readers = readers(args.noise)?;
    let outputs = Outputs::new(args.overwrite, []);
    outputs.folder(&args.out)?;
    outputs.table(&args.out.join("summary.csv"))?;
    outputs.file(&args.out.join("summary.json"))?;
    let phantoms = runs::phantoms(args, &readers)?;
    let runs = runs::all_runs(args, &phantoms)?;
    let mut sections = sections::sections(&runs);
    sections.push(film_lengths::section(args, &phantoms)?);
    print(Lines::of_text(&text(&sections, args)))?;
    let provenance =
        Provenance::new(this_run()?, FilmOrigin::Synthetic, Vec::new()).with_seed(args.seed);
    let (figures, reports) = (args.out.join("figures"), args.out.join("reports"));
    outputs.attempt(&args.out, || files::write(&outputs, &runs, &sections, args, &provenance));
    outputs.attempt(&figures, || drawings::write(&outputs, &figures, &runs, &provenance));
    outputs.attempt(&reports, || reports::write(&outputs, &reports, &runs, &provenance));
    outputs.commit()?;
    print(closing(&args.out))?;
    // A model without result in a scenario that contradicts it is a finding: the table counts it.
    Ok(Ending::Done)
}

fn text(sections: &[Section], args: &ReproduceArgs) -> String {
    let mut text = format!(
        "Jalalian et al. 2016 on synthetic patients: {} subjects of its Table 1, in three loading scenarios (seed {})\n",
        SUBJECTS.len(),
        args.seed
    );
    for scenario in Scenario::PAPER {
        text.push_str(&format!("  {:5} {}\n", scenario.key(), scenario.meaning()));
    }
    text.push_str("Every number in the three columns on the right is SYNTHETIC; mean ± SD as the paper prints them.\n");
    for section in sections {
        let heads = ["paper", "rod", "bend", "pull"].map(Column::numbers);
        let columns = [Column::words(section.title.as_str())].into_iter().chain(heads).collect();
        let mut table = Table::new("", columns);
        for row in &section.rows {
            let mut cells = vec![format!("  {}", row.quantity), row.paper.clone()];
            cells.extend(row.ours.iter().map(|cell| cell.text.clone()));
            table.row(cells);
        }
        text.push('\n');
        // Without a width there is one line per row, and its verdict has its place below it.
        let table = terminal::table(&table, usize::MAX);
        let mut lines = table.lines();
        text.extend(lines.by_ref().take(2).map(|line| format!("{line}\n")));
        for (line, row) in lines.zip(&section.rows) {
            text.push_str(&format!("{line}\n"));
            if !row.verdict.is_empty() {
                text.push_str(&format!("      → {}\n", row.verdict));
            }
        }
        text.push_str(&terminal::paragraph(section.note, 104, "  "));
    }
    text
}

fn closing(out: &Path) -> Lines {
    let at = |name: &str| out.join(name).display().to_string();
    let mut lines = Lines::of("");
    lines.line(format!("Tables   {} (and .json)", at("summary.csv")));
    let (errors, analyses) = (at("errors"), at("analyses"));
    lines.line(format!("         {errors} (every vertebra), {analyses} (every patient)"));
    lines.line(format!("Figures  {} (open them in a browser)", at("figures")));
    lines.line(format!("Reports  {} (a cohort and one patient per scenario)", at("reports")));
    lines
}
