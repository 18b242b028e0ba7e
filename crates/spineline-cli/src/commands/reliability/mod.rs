//! `spineline reliability`: agreement within and between observers.

use std::path::{Path, PathBuf};

use clap::Args;
use spineline::cohort::KnownPatients;
use spineline::measure::{FilmReadings, TiltRule};
use spineline::reliability::{FilmQuantities, QuantityReliability, RatedQuantity, assess};
use spineline_files::{FilmOrigin, InputFile, Provenance, ReliabilityFile};
use spineline_report::reliability::{full, summary};
use spineline_report::{figures, file_stem};
use spineline_tables::statistics_table;

use crate::run::failure::{Ending, Failure};
use crate::run::inputs::{CaseInput, case_files, count_once, input_of};
use crate::run::outputs::{Outputs, OverwriteArgs, is_stdout, print_document};
use crate::run::provenance::{generator, in_svg, this_run};

pub const EXAMPLES: &str = "\
Cases are pooled: subjects are case × film × vertebra, and an observer of one name is one observer.

A table has one reading per row, commas, semicolons or tabs between them (decimal commas only beside semicolons and tabs), and the columns
  quantity   measured quantity, such as tilt_T6
  unit       deg, mm, …
  subject    code of the patient, or of the patient and film
  observer   code of the reader, not a person's name
  repeat     number of the reading, from 1
  value      a number; empty, `NA` or `NaN`, or no row, where it is missing
  synthetic  true or false; this column may be absent

Examples:
  spineline reliability cases/ --figures out/agreement
  spineline reliability readings.csv --json out/reliability.json";

#[derive(Args)]
pub struct ReliabilityArgs {
    /// Case files or folders of them, or one table of readings that ends in .csv
    #[arg(required = true, value_name = "CASE|TABLE.csv")]
    inputs: Vec<PathBuf>,
    /// Write all results as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write one row per statistic as CSV (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw Bland-Altman plots as SVG into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print all statistics of every quantity and design
    #[arg(long)]
    full: bool,
    #[command(flatten)]
    overwrite: OverwriteArgs,
}

pub fn run(args: &ReliabilityArgs) -> Result<Ending, Failure> {
    let paths = [&args.json, &args.csv].into_iter().flatten();
    let to_stdout = paths.filter(|path| is_stdout(path)).count();
    if to_stdout > 1 {
        return Err(Failure::usage("only one of --json and --csv can go to the standard output"));
    }
    let files = case_files(&args.inputs)?;
    let outputs = check_outputs(args, &files)?;
    let Readings { quantities, synthetic, inputs, case_ids } = read(&files)?;
    case_ids.iter().for_each(|id| outputs.of_case(id));
    let provenance = Provenance::new(this_run()?, FilmOrigin::of([synthetic]), inputs);
    let provenance = provenance.of_cases(case_ids);
    // The readings of a quantity leave memory when their statistics are made.
    let assess = |quantity: RatedQuantity| assessed(&quantity, args.figures.is_some());
    let found: Vec<QuantityReliability> = quantities.into_iter().map(assess).collect();
    if let Some(path) = &args.json {
        let file = ReliabilityFile::new(&found, synthetic, &generator(), provenance.clone());
        outputs.attempt(path, || outputs.write(path, spineline_files::results_text(&file)));
    }
    if let Some(path) = &args.csv {
        let table = statistics_table(&found, synthetic);
        outputs.attempt(path, || outputs.write_table(path, table.to_csv()?, &provenance));
    }
    if let Some(folder) = &args.figures {
        outputs.attempt(folder, || draw(&found, synthetic, &provenance, folder, &outputs));
    }
    let kept = outputs.commit_and_say();
    if to_stdout == 0 {
        let text = if args.full { full } else { summary };
        let document = text(&found, synthetic, &generator());
        print_document(&document)?;
    }
    kept.map(|()| Ending::Done)
}

/// The statistics of a quantity. Plots need points, which take most of the memory: they are dropped unless `with_points`.
fn assessed(quantity: &RatedQuantity, with_points: bool) -> QuantityReliability {
    let mut found = assess(quantity);
    let pairs = found.designs.iter_mut().flat_map(|design| &mut design.bland_altman);
    pairs.filter(|_| !with_points).for_each(|pair| pair.points = Vec::new());
    found
}

/// Checks every output before any work.
fn check_outputs(args: &ReliabilityArgs, files: &[PathBuf]) -> Result<Outputs, Failure> {
    let outputs = Outputs::new(args.overwrite, files.iter().map(PathBuf::as_path));
    if let Some(path) = &args.json {
        outputs.file(path)?;
    }
    if let Some(path) = &args.csv {
        outputs.table(path)?;
    }
    if let Some(folder) = &args.figures {
        outputs.folder(folder)?;
    }
    Ok(outputs)
}

struct Readings {
    quantities: Vec<RatedQuantity>,
    /// Whether any film is synthetic.
    synthetic: bool,
    inputs: Vec<InputFile>,
    case_ids: Vec<String>,
}

/// The quantities of a table or of case files.
fn read(inputs: &[PathBuf]) -> Result<Readings, Failure> {
    let is_table = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if !inputs.iter().any(is_table) {
        return read_cases(inputs);
    }
    let [path] = inputs else {
        return Err(Failure::usage("give case files or one table of readings, not both"));
    };
    let failed = |error| Failure::file(path, &error);
    let text = spineline_files::read_text(path).map_err(failed)?;
    let table = spineline_files::parse_readings(&text).map_err(failed)?;
    let (quantities, synthetic) = (table.quantities, table.synthetic);
    let inputs = vec![input_of(path, &text)];
    Ok(Readings { quantities, synthetic, inputs, case_ids: Vec::new() })
}

fn read_cases(files: &[PathBuf]) -> Result<Readings, Failure> {
    let (mut known, mut quantities) = (KnownPatients::default(), FilmQuantities::default());
    let mut case_ids = Vec::new();
    let (mut synthetic, mut inputs) = (false, Vec::new());
    for path in files {
        let CaseInput { case, input, .. } = CaseInput::read(path)?;
        inputs.push(input);
        let place = path.display().to_string();
        count_once(&mut known, &place, &case)?;
        let films = case
            .films
            .iter()
            .map(|film| FilmReadings::measure(film, TiltRule::default()))
            .collect::<Result<Vec<_>, _>>();
        let films = films.map_err(|error| Failure::of(&place, &error))?;
        synthetic |= case.synthetic;
        quantities.add(&case.id, &films);
        case_ids.push(case.id);
    }
    Ok(Readings { quantities: quantities.finish(), synthetic, inputs, case_ids })
}

/// One picture per quantity and design; observers' names stay out of the files' names.
fn draw(
    found: &[QuantityReliability],
    synthetic: bool,
    provenance: &Provenance,
    folder: &Path,
    outputs: &Outputs,
) -> Result<(), Failure> {
    for (i, quantity) in found.iter().enumerate() {
        for (j, design) in quantity.designs.iter().enumerate() {
            let Some(svg) = figures::bland_altman(quantity, design, synthetic) else { continue };
            let name = file_stem(&quantity.key);
            let file = format!("{:02}-{name}-{}-{}.svg", i + 1, j + 1, design.design.key());
            outputs.write(&folder.join(file), in_svg(&svg, provenance))?;
        }
    }
    Ok(())
}
