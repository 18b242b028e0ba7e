//! `spineline reliability`: do readings repeat, and how far are they off?

use std::path::{Path, PathBuf};

use clap::Args;
use csv::Writer;
use spineline::measure::FilmReadings;
use spineline::reliability::{
    BlandAltman, Design, DesignReliability, Quantity, QuantityReliability, Statistic, assess,
    film_quantities, shown_measure,
};
use spineline_files::{FilmOrigin, InputFile, Provenance, ReliabilityFile};
use spineline_report::figures;

use crate::analyze::{case_files, generator, write_file, write_or_print};
use crate::failure::{Ending, Failure};
use crate::print;
use crate::provenance::{Source, in_svg, input_of, this_run, write_table};
use crate::rows::{failed, finish};
use crate::table::{Table, wrap};

pub const EXAMPLES: &str = "\
Cases are pooled: subjects are case × film × vertebra, and an observer of one name is one observer.

A table has one reading per row and the columns
  quantity   what was read, such as tilt_T6
  unit       deg, mm, …
  subject    patient, or patient and film, by a code
  observer   who read
  repeat     the how-manieth time, from 1
  value      a number with a decimal point; leave the row out where there is none
  synthetic  true or false; this column may be absent

Examples:
  spineline reliability cases/ --figure out/agreement
  spineline reliability readings.csv --json out/reliability.json";

#[derive(Args)]
pub struct ReliabilityArgs {
    /// Case files or folders of them, or one table of readings that ends in .csv
    #[arg(required = true, value_name = "CASE|TABLE.csv")]
    inputs: Vec<PathBuf>,
    /// Write everything as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write one row per statistic as CSV (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw Bland-Altman plots as SVG into this folder
    #[arg(long, value_name = "DIR")]
    figure: Option<PathBuf>,
}

pub fn run(args: &ReliabilityArgs) -> Result<Ending, Failure> {
    let outputs = [&args.json, &args.csv].into_iter().flatten();
    let to_stdout = outputs.filter(|path| path.as_os_str() == "-").count();
    if to_stdout > 1 {
        return Err(Failure::usage("only one of --json and --csv can go to the standard output"));
    }
    let Readings { quantities, synthetic, inputs } = read(&args.inputs)?;
    let provenance = Provenance::new(this_run()?, FilmOrigin::of([synthetic]), inputs);
    let found: Vec<QuantityReliability> = quantities.iter().map(assess).collect();
    if let Some(path) = &args.json {
        let file = ReliabilityFile::new(&found, synthetic, &generator())
            .with_provenance(provenance.clone());
        write_or_print(path, &spineline_files::to_text(&file))?;
    }
    if let Some(path) = &args.csv {
        write_table(path, &csv_text(&found, synthetic)?, &provenance)?;
    }
    if let Some(folder) = &args.figure {
        draw(&found, synthetic, &provenance, folder)?;
    }
    if to_stdout == 0 {
        print(&text(&found, synthetic))?;
    }
    Ok(Ending::Done)
}

/// What was read.
struct Readings {
    quantities: Vec<Quantity>,
    /// Whether any film is made up.
    synthetic: bool,
    inputs: Vec<InputFile>,
}

/// The quantities of a table or of cases.
fn read(inputs: &[PathBuf]) -> Result<Readings, Failure> {
    let is_table = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if !inputs.iter().any(is_table) {
        return read_cases(inputs);
    }
    let [path] = inputs else {
        return Err(Failure::usage("give either case files, or one table of readings"));
    };
    let failed = |error| Failure::file(path, &error);
    let text = spineline_files::read_text(path).map_err(failed)?;
    let table = spineline_files::parse_readings(&text).map_err(failed)?;
    let (quantities, synthetic) = (table.quantities, table.synthetic);
    Ok(Readings { quantities, synthetic, inputs: vec![input_of(path, &text)] })
}

fn read_cases(given: &[PathBuf]) -> Result<Readings, Failure> {
    let mut cases: Vec<(String, Vec<FilmReadings>)> = Vec::new();
    let (mut synthetic, mut inputs) = (false, Vec::new());
    for path in case_files(given)? {
        let Source { case, input, .. } = Source::read(&path)?;
        inputs.push(input);
        let place = path.display().to_string();
        if cases.iter().any(|(id, _)| *id == case.id) {
            let text = format!("the case {} was given already", case.id);
            return Err(Failure::input(&place, &text, "give every case a `case_id` of its own"));
        }
        let films = case.films.iter().map(FilmReadings::measure).collect::<Result<_, _>>();
        let films = films.map_err(|error| Failure::input(&place, &error, error.help()))?;
        synthetic |= case.synthetic;
        cases.push((case.id, films));
    }
    let borrowed: Vec<(&str, &[FilmReadings])> =
        cases.iter().map(|(id, films)| (id.as_str(), films.as_slice())).collect();
    Ok(Readings { quantities: film_quantities(&borrowed), synthetic, inputs })
}

/// One table per quantity and design, the errors first.
fn text(found: &[QuantityReliability], synthetic: bool) -> String {
    let mut text = String::new();
    if synthetic {
        text.push_str("SYNTHETIC: made-up films\n\n");
    }
    for quantity in found {
        text.push_str(&wrap(&format!("{}: {}", quantity.key, quantity.meaning), 110, ""));
        for design in &quantity.designs {
            text.push_str(&design_text(design, &quantity.unit));
        }
        text.push('\n');
    }
    text.push_str(&wrap(
        "SEM, MDC95 and limits of agreement speak of the readers alone. Every correlation also grows with the spread of the subjects. Intervals take the subjects for independent; vertebrae of one film are not, so true ones are wider.",
        110,
        "",
    ));
    text
}

fn design_text(design: &DesignReliability, unit: &str) -> String {
    let few = |count: usize, word: &str| {
        if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
    };
    let mut text = format!("\n{}: {}\n", design.design, design.raters.join(" | "));
    // All statistics of a table without raters or subjects lack for the same reason.
    let mut reasons = design.statistics.iter().map(|statistic| statistic.outcome.err());
    if let Some(Some(reason)) = reasons.next()
        && reasons.all(|other| other == Some(reason))
    {
        text.push_str(&format!("  undefined: {reason}\n"));
        return text;
    }
    let n = format!("{}, {}", few(design.subjects, "subject"), few(design.raters.len(), "rater"));
    let mut table = Table::new(["Statistic", "value", "95 % CI", "unit", "n"]);
    for statistic in &design.statistics {
        table.row(cells(statistic, unit, &n));
    }
    for pair in &design.bland_altman {
        for (name, value, interval) in limits(pair) {
            let [first, second] = &pair.raters;
            let range = interval.map_or_else(|| "-".to_owned(), |i| between(i, shown_measure));
            table.row(vec![
                format!("Bland-Altman {name}, {second} minus {first}"),
                shown_measure(value),
                range,
                unit.to_owned(),
                n.clone(),
            ]);
        }
    }
    text.push_str(&table.text());
    for remark in &design.remarks {
        text.push_str(&wrap(&format!("! {remark}"), 110, "  "));
    }
    text
}

fn cells(statistic: &Statistic, unit: &str, n: &str) -> Vec<String> {
    let (value, range) = statistic.shown();
    let unit = if statistic.kind.has_unit() { unit } else { "" };
    let value = value.unwrap_or_else(|| "-".to_owned());
    vec![statistic.kind.name().to_owned(), value, range, unit.to_owned(), n.to_owned()]
}

fn between([low, high]: [f64; 2], shown: fn(f64) -> String) -> String {
    format!("{} to {}", shown(low), shown(high))
}

/// Bias and limits of agreement, with their intervals.
fn limits(pair: &BlandAltman) -> [(&'static str, f64, Option<[f64; 2]>); 3] {
    let bounds = pair.limit_intervals.ok();
    [
        ("bias", pair.bias, pair.bias_interval.ok()),
        ("lower limit", pair.limits[0], bounds.map(|bounds| bounds[0])),
        ("upper limit", pair.limits[1], bounds.map(|bounds| bounds[1])),
    ]
}

/// One row per statistic, and per bias and limit of every pair.
fn csv_text(found: &[QuantityReliability], synthetic: bool) -> Result<String, Failure> {
    let mut writer = Writer::from_writer(Vec::new());
    let heading = [
        "synthetic",
        "quantity",
        "design",
        "observer",
        "raters",
        "repeats",
        "subjects",
        "dropped",
        "statistic",
        "name",
        "value",
        "sd",
        "ci95_low",
        "ci95_high",
        "unit",
        "undefined",
    ];
    writer.write_record(heading).map_err(|e| failed(&e))?;
    for quantity in found {
        for design in &quantity.designs {
            let shared = [
                synthetic.to_string(),
                quantity.key.clone(),
                design.design.key().to_owned(),
                match &design.design {
                    Design::IntraObserver { observer } => observer.clone(),
                    _ => String::new(),
                },
                design.raters.len().to_string(),
                design.repeats.iter().map(usize::to_string).collect::<Vec<_>>().join(" "),
                design.subjects.to_string(),
                design.dropped.to_string(),
            ];
            let own = design.statistics.iter().map(|s| statistic_cells(s, &quantity.unit));
            let pairs = design.bland_altman.iter();
            let pairs =
                pairs.flat_map(|pair| limits(pair).map(|l| limit_cells(pair, l, &quantity.unit)));
            for cells in own.chain(pairs) {
                let row = shared.iter().chain(&cells);
                writer.write_record(row).map_err(|e| failed(&e))?;
            }
        }
    }
    finish(writer)
}

fn statistic_cells(statistic: &Statistic, unit: &str) -> [String; 8] {
    let kind = statistic.kind;
    let estimate = statistic.outcome.ok();
    let interval = estimate.and_then(|estimate| estimate.interval.ok());
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    [
        kind.key().to_owned(),
        kind.name().to_owned(),
        number(estimate.map(|estimate| estimate.value)),
        number(estimate.and_then(|estimate| estimate.sd)),
        number(interval.map(|interval| interval[0])),
        number(interval.map(|interval| interval[1])),
        if kind.has_unit() { unit.to_owned() } else { String::new() },
        statistic.outcome.err().map_or_else(String::new, |reason| reason.key().to_owned()),
    ]
}

fn limit_cells(
    pair: &BlandAltman,
    (name, value, interval): (&str, f64, Option<[f64; 2]>),
    unit: &str,
) -> [String; 8] {
    let [first, second] = &pair.raters;
    let bound = |i: usize| interval.map_or_else(String::new, |bounds| bounds[i].to_string());
    [
        format!("bland_altman_{}", name.replace(' ', "_")),
        format!("{second} minus {first}"),
        value.to_string(),
        if name == "bias" { pair.sd.to_string() } else { String::new() },
        bound(0),
        bound(1),
        unit.to_owned(),
        String::new(),
    ]
}

/// One picture per quantity and design; observers' names stay out of the files' names.
fn draw(
    found: &[QuantityReliability],
    synthetic: bool,
    provenance: &Provenance,
    folder: &Path,
) -> Result<(), Failure> {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
    for (i, quantity) in found.iter().enumerate() {
        for (j, design) in quantity.designs.iter().enumerate() {
            let Some(svg) = figures::bland_altman(quantity, design, synthetic) else { continue };
            let name: String = quantity.key.chars().map(plain).take(40).collect();
            let file = format!("{:02}-{name}-{}-{}.svg", i + 1, j + 1, design.design.key());
            write_file(&folder.join(file), in_svg(&svg, provenance))?;
        }
    }
    Ok(())
}
