//! `spineline reproduce`: the paper's numbers on synthetic patients.
//!
//! 18 subjects × 3 truths are made, read, and analysed with both supports. Every number of the paper is laid beside ours
//! with a verdict in words. None of them is a goal: the truth that moved the phantoms decides which line wins.

mod drawings;
mod fair;
mod files;
mod reports;
mod rows;

use std::path::Path;

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::cohort::Cohort;
use spineline::multibody::Support;
use spineline_files::{FilmOrigin, Provenance};
use spineline_phantom::{Readers, SUBJECTS, Truth, generate};

use crate::args::ReproduceArgs;
use crate::failure::{Ending, Failure};
use crate::phantom::readers;
use crate::print;
use crate::progress::map_all;
use crate::provenance::this_run;
use crate::table::{Table, wrap};
use rows::Section;

/// The phantoms of one truth, analysed with one support.
pub struct Run {
    /// What moved the phantoms.
    pub truth: Truth,
    /// What held them.
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

pub fn support_name(support: Support) -> &'static str {
    match support {
        Support::Free => "free",
        Support::Frontal => "frontal",
    }
}

fn support_words(support: Support) -> &'static str {
    match support {
        Support::Free => "free support (the paper's)",
        Support::Frontal => "frontal support (the patient lies on a table)",
    }
}

pub fn run(args: &ReproduceArgs) -> Result<Ending, Failure> {
    let readers = readers(args.noise)?;
    let runs = all_runs(args, &readers)?;
    let sections = rows::sections(&runs);
    print(&text(&sections, args))?;
    let provenance =
        Provenance::new(this_run()?, FilmOrigin::Synthetic, Vec::new()).with_seed(args.seed);
    files::write(&args.out, &runs, &sections, args, &provenance)?;
    drawings::write(&args.out.join("figures"), &runs, &provenance)?;
    reports::write(&args.out.join("reports"), &runs, &provenance)?;
    print(&closing(&args.out))?;
    // A model without result against a truth that contradicts it is a finding: the table counts it.
    Ok(Ending::Done)
}

/// Analyses every phantom with both supports; the order of the results is fixed, whatever the threads do.
fn all_runs(args: &ReproduceArgs, readers: &Readers) -> Result<Vec<Run>, Failure> {
    let tasks: Vec<(Truth, usize)> =
        Truth::ALL.iter().flat_map(|&truth| (0..SUBJECTS.len()).map(move |i| (truth, i))).collect();
    let results = map_all("phantoms", &tasks, args.threads, |&(truth, subject)| {
        let phantom =
            generate(subject, truth, readers, args.seed).map_err(|error| error.to_string())?;
        let with = |support| {
            let options = AnalysisOptions {
                support,
                target: args.fit.target(),
                ..AnalysisOptions::default()
            };
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
            let cohort = Cohort::of(&analyses.iter().collect::<Vec<_>>(), args.seed);
            let cases = cases.by_ref().take(SUBJECTS.len()).collect();
            runs.push(Run { truth, support, cases, analyses, cohort });
        }
    }
    Ok(runs)
}

fn text(sections: &[Section], args: &ReproduceArgs) -> String {
    let mut text = format!(
        "Jalalian et al. 2016 on synthetic patients: {} subjects of its Table 1, moved in three ways (seed {})\n",
        SUBJECTS.len(),
        args.seed
    );
    for truth in Truth::ALL {
        text.push_str(&format!("  {:5} {}\n", truth.key(), truth.meaning()));
    }
    text.push_str("Every number in the three columns on the right is SYNTHETIC; mean ± SD as the paper prints them.\n");
    for section in sections {
        let mut table = Table::new([section.title.as_str(), "paper", "rod", "bend", "pull"]);
        for row in &section.rows {
            let mut cells = vec![format!("  {}", row.quantity), row.paper.clone()];
            cells.extend(row.ours.iter().map(|cell| cell.text.clone()));
            table.row(cells);
        }
        text.push('\n');
        let table = table.text();
        let mut lines = table.lines();
        text.extend(lines.by_ref().take(2).map(|line| format!("{line}\n")));
        for (line, row) in lines.zip(&section.rows) {
            text.push_str(&format!("{line}\n"));
            if !row.verdict.is_empty() {
                text.push_str(&format!("      → {}\n", row.verdict));
            }
        }
        text.push_str(&wrap(section.note, 104, "  "));
    }
    text
}

fn closing(out: &Path) -> String {
    format!(
        "\nTables   {} (and .json)\n         {} has every vertebra, {} every patient\n\
         Figures  {} (open them in a browser)\n\
         Reports  {} (a cohort per truth, and one patient)\n",
        out.join("summary.csv").display(),
        out.join("errors").display(),
        out.join("analyses").display(),
        out.join("figures").display(),
        out.join("reports").display()
    )
}
