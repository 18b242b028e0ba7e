//! A part of a cohort: case files in, tables as Parquet out.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::ThreadPool;
use spineline::analysis::{Analysis, AnalysisOptions, Subject, analyze};
use spineline::uncertainty::Uncertainty;
use spineline_files::{InputFile, Replicates, parse_case_within, read_text, sha256_hex, to_line};
use spineline_tables::{NumberFormat, Patient, Series, Table, TableError, Values, tables};

use crate::fault::Fault;
use crate::patient::{generator, options};
use crate::replicates::{asked, pool, run_replicates};
use crate::wait::beside;

/// Number, noise and seed of the replicates of every case.
type GivenReplicates = Option<(u64, String, u64)>;

/// Refuses options that no analysis takes, and replicates that there cannot be.
#[pyfunction]
pub fn check_options(
    py: Python<'_>,
    given: Vec<(String, String)>,
    replicates: GivenReplicates,
) -> PyResult<()> {
    Task::new(&given, replicates.as_ref()).map(|_| ()).map_err(|fault| fault.raise(py))
}

/// Analyses case files one after the other. A file that cannot be analysed is a row of the table `cases` with its error.
/// Returns every table as Parquet, and the number of cases without a result.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "a pair for Python")]
pub fn analyze_paths<'py>(
    py: Python<'py>,
    paths: Vec<PathBuf>,
    given: Vec<(String, String)>,
    replicates: GivenReplicates,
) -> PyResult<(Vec<(String, Bound<'py, PyBytes>)>, usize)> {
    let task = Task::new(&given, replicates.as_ref()).map_err(|fault| fault.raise(py))?;
    // As many cases are analysed at once as there are workers.
    let pool = pool(1)?;
    let made = beside(py, |stop| {
        let mut rows = Vec::new();
        for path in &paths {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            rows.push(Row::of(path, &task, &pool, stop));
        }
        let failed = rows.iter().filter(|row| row.status() != "ok").count();
        parquet(&rows, &given, replicates.as_ref()).map(|files| (files, failed))
    })?;
    let (files, failed) = made.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let files = files.iter().map(|(name, bytes)| (name.clone(), PyBytes::new(py, bytes)));
    Ok((files.collect(), failed))
}

/// What is computed of every case.
struct Task {
    options: AnalysisOptions,
    replicates: Option<Replicates>,
}

impl Task {
    fn new(
        given: &[(String, String)],
        replicates: Option<&(u64, String, u64)>,
    ) -> Result<Self, Fault> {
        let (options, _) = options(given)?;
        let replicates = replicates.map(|(count, noise, seed)| asked(*count, noise, *seed));
        Ok(Self { options, replicates: replicates.transpose()? })
    }
}

/// A case of the part.
struct Row {
    file: String,
    sha256: Option<String>,
    found: Result<Found, Fault>,
}

/// The results of a case.
struct Found {
    analysis: Analysis,
    subject: Subject,
    /// Where replicates are asked for.
    spread: Option<Uncertainty>,
}

impl Found {
    fn of(text: &str, task: &Task, pool: &ThreadPool, stop: &AtomicBool) -> Result<Self, Fault> {
        let (case, _) = parse_case_within(text)?;
        let case = case.into_case()?;
        let analysis = analyze(&case, &task.options)?;
        let replicates = task.replicates.as_ref();
        let spread = replicates.map(|asked| run_replicates(&case, &analysis, asked, pool, stop));
        Ok(Self { spread: spread.transpose()?, analysis, subject: case.subject })
    }
}

impl Row {
    fn of(path: &Path, task: &Task, pool: &ThreadPool, stop: &AtomicBool) -> Self {
        let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let text = read_text(path).map_err(Fault::from);
        let sha256 = text.as_ref().ok().map(|text| sha256_hex(text.as_bytes()));
        Self { file, sha256, found: text.and_then(|text| Found::of(&text, task, pool, stop)) }
    }

    fn status(&self) -> &'static str {
        match &self.found {
            Ok(found) if found.analysis.has_what_was_asked() => "ok",
            Ok(_) => "not_converged",
            Err(_) => "error",
        }
    }

    fn fault(&self) -> Option<&Fault> {
        self.found.as_ref().err()
    }
}

/// All tables of the part; that of the cases comes last.
fn parquet(
    rows: &[Row],
    given: &[(String, String)],
    replicates: Option<&(u64, String, u64)>,
) -> Result<Vec<(String, Vec<u8>)>, TableError> {
    let found = rows.iter().filter_map(|row| row.found.as_ref().ok());
    let patients: Vec<Patient<'_>> = found
        .map(|found| Patient {
            analysis: &found.analysis,
            subject: &found.subject,
            identified: None,
            spread: found.spread.as_ref(),
        })
        .collect();
    let inputs: Vec<InputFile> = rows
        .iter()
        .map(|row| InputFile {
            name: row.file.clone(),
            sha256: row.sha256.clone().unwrap_or_default(),
        })
        .collect();
    // Without the time, so that the same cases give the same bytes wherever they are analysed.
    let (made, options, inputs) = (generator(), to_line(&given), to_line(&inputs));
    let replicates = replicates.map(|(count, noise, seed)| {
        serde_json::json!({"count": count, "noise": noise, "seed": seed}).to_string()
    });
    let mut metadata = vec![
        ("spineline.program", made.as_str()),
        ("spineline.options", options.as_str()),
        ("spineline.inputs", inputs.as_str()),
    ];
    metadata.extend(replicates.as_deref().map(|text| ("spineline.replicates", text)));
    let mut all = tables(&patients);
    all.push(cases(rows));
    all.iter().map(|table| Ok((table.name.to_owned(), table.to_parquet(&metadata)?))).collect()
}

/// One row per case file with its status.
fn cases(rows: &[Row]) -> Table {
    let text = |name: &str, meaning, cell: &dyn Fn(&Row) -> Option<String>| Series {
        name: name.to_owned(),
        unit: "",
        meaning,
        format: NumberFormat::Shortest,
        values: Values::Text(rows.iter().map(cell).collect()),
    };
    let columns = vec![
        text("file", "name of the case file", &|row| Some(row.file.clone())),
        text("sha256", "SHA-256 of its bytes; empty where it cannot be read", &|row| {
            row.sha256.clone()
        }),
        text("case_id", "patient; empty where the case cannot be analysed", &|row| {
            row.found.as_ref().ok().map(|found| found.analysis.case_id.clone())
        }),
        text("status", "`ok`, `not_converged` or `error`", &|row| Some(row.status().to_owned())),
        text("error", "what stops the analysis", &|row| row.fault().map(Fault::text)),
        text("help", "what to do about it", &|row| row.fault().map(Fault::help)),
        text("film", "the film of the error", &|row| row.fault().and_then(Fault::film)),
        text("level", "the vertebra of the error", &|row| row.fault().and_then(Fault::level)),
    ];
    Table { name: "cases", row: "case file", columns }
}
