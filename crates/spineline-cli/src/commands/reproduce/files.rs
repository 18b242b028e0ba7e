//! Tables of a reproduction.

use serde::Serialize;
use spineline::analysis::{Analysis, Case};
use spineline::multibody::Support;
use spineline::number::NO_BREAK;
use spineline_files::{AnalysisFile, CaseFile, Provenance, Request};
use spineline_report::reproduction::Part;
use spineline_tables::{ReproducedNumber, errors_table, reproduction_table};

use super::args::ReproduceArgs;
use super::runs::Run;
use crate::run::failure::Failure;
use crate::run::outputs::Outputs;
use crate::run::progress::bar;
use crate::run::provenance::generator;
use crate::run::threads::stream_all;

/// `summary.csv` and `summary.json` hold the table; `errors.csv` every vertebra; `analyses/` every patient.
pub fn write(
    outputs: &Outputs,
    runs: &[Run],
    parts: &[Part],
    args: &ReproduceArgs,
    provenance: &Provenance,
) -> Result<(), Failure> {
    let out = &args.out;
    let rows: Vec<ReproducedNumber> = parts.iter().flat_map(|part| numbers(part, runs)).collect();
    let table = reproduction_table(&rows).to_csv()?;
    outputs.write_table(&out.join("summary.csv"), table, provenance)?;
    let summary = Summary {
        format: "spineline-reproduction",
        version: 1,
        generator: generator(),
        synthetic: runs.iter().any(|run| run.cohort.synthetic),
        method: args.method.key(),
        provenance: provenance.clone(),
        seed: args.seed,
        noise: args.noise,
        rows,
    };
    outputs.write(&out.join("summary.json"), spineline_files::results_text(&summary))?;
    for run in runs {
        let support = run.support.key();
        let name = format!("errors-{}-{support}.csv", run.name);
        let path = out.join("errors").join(name);
        outputs.write_table(&path, errors_table(&run.analyses).to_csv()?, provenance)?;
    }
    let patients: Vec<(&Case, &Analysis)> =
        runs.iter().flat_map(|run| run.cases.iter().zip(&run.analyses)).collect();
    let text = |place: usize| {
        let (case, analysis) = patients[place];
        let name = format!("{}-{}.json", analysis.case_id, analysis.options.support.key());
        (name, spineline_files::results_text(&analysis_file(case, analysis, provenance)))
    };
    let folder = out.join("analyses");
    let bar = bar("files", patients.len());
    stream_all(&bar, 0..patients.len(), args.threads, text, |(name, text)| {
        outputs.write(&folder.join(name), text)
    })
}

/// One patient's analysis as it is written.
pub fn analysis_file(case: &Case, analysis: &Analysis, provenance: &Provenance) -> AnalysisFile {
    let request = Request { options: analysis.options.clone(), ..Request::default() };
    let provenance = provenance.clone().of_cases([analysis.case_id.clone()]).asking(&request);
    AnalysisFile::new(analysis, CaseFile::from_case(case), provenance)
}

#[derive(Serialize)]
struct Summary {
    format: &'static str,
    version: u32,
    generator: String,
    provenance: Provenance,
    synthetic: bool,
    method: &'static str,
    seed: u64,
    noise: f64,
    rows: Vec<ReproducedNumber>,
}

fn numbers(part: &Part, runs: &[Run]) -> Vec<ReproducedNumber> {
    let plain = |text: &str| text.replace(NO_BREAK, " ");
    let mut numbers = Vec::new();
    for row in &part.rows {
        for (run, cell) in runs.iter().zip(&row.ours) {
            numbers.push(ReproducedNumber {
                section: plain(&part.title),
                support: part.support.map(Support::key),
                quantity: row.quantity.trim().to_owned(),
                unit: row.unit,
                paper: row.paper.clone(),
                group: run.name,
                mean: Some(cell.mean).filter(|v| v.is_finite()),
                sd: Some(cell.sd).filter(|v| v.is_finite()),
                n: cell.n,
                text: cell.text.clone(),
                verdict: plain(&row.verdict),
            });
        }
    }
    numbers
}
