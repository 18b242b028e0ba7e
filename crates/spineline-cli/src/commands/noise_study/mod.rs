//! `spineline noise-study`: how robust the paper's three main claims are to landmark noise, curve order and loading scenario, on
//! synthetic patients.
//!
//! Every patient is read once per standard deviation of a corner's coordinate, with the same random numbers for all deviations, and
//! analysed once per rule and support. A claim is a number over patients with an interval over patients.

mod args;
mod drawing;
mod study;
mod text;

pub use args::NoiseStudyArgs;

use spineline_files::{FilmOrigin, Provenance};
use spineline_report::terminal::Lines;
use spineline_tables::{NoisePoint, noise_study_table};

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, print};
use crate::run::provenance::{in_svg, this_run};

pub fn run(args: &NoiseStudyArgs) -> Result<Ending, Failure> {
    let table = args.out.join("noise-study.csv");
    let figure = args.out.join("noise-study.svg");
    let outputs = Outputs::new(args.overwrite, []);
    outputs.folder(&args.out)?;
    outputs.table(&table)?;
    outputs.file(&figure)?;
    let points = study::study(args)?;
    let rows: Vec<NoisePoint<'_>> = points.iter().map(study::Point::row).collect();
    let provenance =
        Provenance::new(this_run()?, FilmOrigin::Synthetic, Vec::new()).with_seed(args.seed);
    let rows = noise_study_table(&rows);
    outputs.attempt(&table, || outputs.write_table(&table, rows.to_csv()?, &provenance));
    let svg = || in_svg(&drawing::svg(&points, args), &provenance);
    outputs.attempt(&figure, || outputs.write(&figure, svg()));
    let kept = outputs.commit();
    print(Lines::of_text(&text::report(&points, args)))?;
    kept?;
    let mut written = Lines::of("");
    written.line(format!("Table   {}", table.display()));
    written.line(format!("Figure  {} (open it in a browser)", figure.display()));
    print(written)
}
