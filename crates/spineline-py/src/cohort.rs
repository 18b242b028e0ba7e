//! A part of a cohort: case files in, tables as Parquet out.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::ThreadPool;
use rayon::prelude::*;
use spineline::analysis::{Analysis, Subject};
use spineline::cohort::{KnownPatients, PatientMarks};
use spineline::uncertainty::Uncertainty;
use spineline_files::method_text::{OptionFile, option_file, options_of};
use spineline_files::{
    CaseFile, InputFile, MAX_FILE_BYTES, Replicates, Request, parse_case_within, read_bytes,
    sha256_hex, text_of, to_line,
};
use spineline_tables::{NumberFormat, Patient, Series, Table, TableError, Values, tables};

use crate::analysis::compute;
use crate::fault::Fault;
use crate::patient::{check_case, generator, words};
use crate::replicates::{asked, pool, run_replicates};
use crate::wait::{apart, apart_with};

/// Number, noise and seed of the replicates of every case.
type GivenReplicates = Option<(u64, String, u64)>;

/// Refuses invalid options and replicates. Returns the files that options name: option, name and SHA-256.
#[pyfunction]
pub fn check_options(
    given: Vec<(String, String)>,
    replicates: GivenReplicates,
) -> Result<Vec<(String, String, String)>, Fault> {
    let task = Task::new(given, replicates)?;
    let words = |one: OptionFile| (one.option, one.file.name, one.file.sha256);
    Ok(task.option_files.into_iter().map(words).collect())
}

/// For every case file: SHA-256 of its bytes, or why it cannot be read. Refuses a patient who would count twice.
#[pyfunction]
pub fn identify_cases(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Vec<String>> {
    let threads = pool(0)?;
    let (paths, read) = apart(py, move |stop| {
        let one = |path: &PathBuf| {
            let is_stopped = stop.load(Ordering::Relaxed);
            if is_stopped { Default::default() } else { CaseText::read(path).identity() }
        };
        let read: Vec<_> = threads.install(|| paths.par_iter().map(one).collect());
        (paths, read)
    })?;
    let mut known = KnownPatients::default();
    let (identities, patients): (Vec<String>, Vec<Option<PatientMarks>>) = read.into_iter().unzip();
    for (path, patient) in paths.iter().zip(patients) {
        let added = patient.map_or(Ok(()), |patient| known.add(patient));
        added.map_err(|error| Fault::of(&error).in_file(path))?;
    }
    Ok(identities)
}

/// Analyses case files one after the other, as long as a folder exists, which the calling process removes at its end. A
/// case file is given with its result of [`identify_cases`]. A file that cannot be analysed is a row of the table
/// `cases` with its error. Returns every table with its number of rows as Parquet, and the number of cases without a
/// result.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "tuples for Python")]
pub fn analyze_paths<'py>(
    py: Python<'py>,
    cases: Vec<(PathBuf, String)>,
    given: Vec<(String, String)>,
    replicates: GivenReplicates,
    option_files: Vec<(String, String, String)>,
    build: String,
    asking: PathBuf,
) -> PyResult<(Vec<(String, usize, Bound<'py, PyBytes>)>, usize)> {
    let task = Task::new(given, replicates)?;
    task.check_files(&option_files)?;
    // The number of concurrent analyses is the number of workers.
    let pool = pool(1)?;
    let work = move |stop: &AtomicBool| -> Result<_, String> {
        let mut rows = Vec::new();
        for (path, identity) in &cases {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            rows.push(Row::of(path, identity, &task, &pool, stop)?);
        }
        let failed = rows.iter().filter(|row| row.status() != "ok").count();
        let files = parquet(&rows, &task, &build).map_err(|error| error.to_string())?;
        Ok((files, failed))
    };
    let is_asked = |py: Python<'_>| {
        let ended = || PyRuntimeError::new_err("the call that asked for it has ended");
        if py.detach(|| asking.exists()) { Ok(()) } else { Err(ended()) }
    };
    let made = apart_with(py, is_asked, work)?;
    let (files, failed) = made.map_err(PyRuntimeError::new_err)?;
    let files = files.into_iter().map(|(name, rows, bytes)| (name, rows, PyBytes::new(py, &bytes)));
    Ok((files.collect(), failed))
}

/// The computation for every case.
struct Task {
    given: Vec<(String, String)>,
    replicates: GivenReplicates,
    request: Request,
    option_files: Vec<OptionFile>,
}

impl Task {
    fn new(given: Vec<(String, String)>, replicates: GivenReplicates) -> Result<Self, Fault> {
        let (options, option_files) = options_of(words(&given))?;
        let asked: Option<Replicates> = replicates
            .as_ref()
            .map(|(count, noise, seed)| asked(*count, noise, *seed))
            .transpose()?;
        let request = Request { options, replicates: asked, identifiability: false };
        Ok(Self { given, replicates, request, option_files })
    }

    /// Refuses files of options that have changed since the cohort was requested.
    fn check_files(&self, expected: &[(String, String, String)]) -> Result<(), Fault> {
        let is_same = |one: &OptionFile, (option, _, sha256): &(String, String, String)| {
            one.option == *option && one.file.sha256 == *sha256
        };
        let found = &self.option_files;
        if found.len() == expected.len()
            && found.iter().zip(expected).all(|(one, other)| is_same(one, other))
        {
            return Ok(());
        }
        let changed = found.iter().zip(expected).find(|(one, other)| !is_same(one, other));
        let name = changed.map_or("", |(one, _)| &one.option);
        let text = format!("option `{name}`: its file has changed since the cohort was requested");
        Err(Fault::new(text, "leave the file as it is, and run the cohort again"))
    }

    /// Options with the names of files in place of their paths: a folder may carry the name of a person.
    fn words(&self) -> Vec<(&str, String)> {
        let word = |(name, value): &'_ (String, String)| match option_file(name, value) {
            Some(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into(),
            None => value.clone(),
        };
        self.given.iter().map(|one| (one.0.as_str(), word(one))).collect()
    }
}

/// The text of a case file, or its hash and fault.
struct CaseText(Result<String, (String, Fault)>);

impl CaseText {
    /// Reads the text; for an invalid file, returns the hash of its bytes and the fault.
    fn read(path: &Path) -> Self {
        let bytes = match read_bytes(path, MAX_FILE_BYTES) {
            Ok(bytes) => bytes,
            Err(error) => return Self(Err((error.to_string(), error.into()))),
        };
        let digest = sha256_hex(&bytes);
        Self(text_of(path, bytes).map_err(|error| (digest, error.into())))
    }

    /// The SHA-256, or why it is missing, and the marks of the patient.
    fn identity(&self) -> (String, Option<PatientMarks>) {
        match &self.0 {
            Ok(text) => {
                let marks = |(case, _): (CaseFile, _)| {
                    let id = case.id().to_owned();
                    case.into_case()
                        .map_or_else(|_| PatientMarks::of_id(id), |case| PatientMarks::of(&case))
                };
                (sha256_hex(text.as_bytes()), parse_case_within(text).ok().map(marks))
            }
            Err((identity, _)) => (identity.clone(), None),
        }
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
    /// Present if replicates are requested.
    uncertainty: Option<Uncertainty>,
}

impl Found {
    fn of(text: &str, task: &Task, pool: &ThreadPool, stop: &AtomicBool) -> Result<Self, Fault> {
        let (case, _) = parse_case_within(text)?;
        let case = case.into_case()?;
        check_case(&task.option_files, &sha256_hex(text.as_bytes()), &case.id)?;
        let (analysis, _) = compute(&case, &task.request, stop)?;
        let replicates = task.request.replicates.as_ref();
        let uncertainty = replicates
            .map(|asked| run_replicates(&case, &analysis, asked, pool, stop, &AtomicU64::new(0)));
        Ok(Self { uncertainty: uncertainty.transpose()?, analysis, subject: case.subject })
    }
}

impl Row {
    /// A case that must be the requested one.
    fn of(
        path: &Path,
        identity: &str,
        task: &Task,
        pool: &ThreadPool,
        stop: &AtomicBool,
    ) -> Result<Self, String> {
        let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let (sha256, found) = match CaseText::read(path).0 {
            Ok(text) => {
                let sha256 = sha256_hex(text.as_bytes());
                (sha256, Ok(text))
            }
            Err((identity, fault)) => (identity, Err(fault)),
        };
        if sha256 != identity {
            return Err(format!("{file} has changed since the cohort was requested"));
        }
        let is_text = found.is_ok();
        let found = found.and_then(|text| Found::of(&text, task, pool, stop));
        Ok(Self { file, sha256: Some(sha256).filter(|_| is_text), found })
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

/// All tables of the part, each with its number of rows; the table of cases comes last.
fn parquet(
    rows: &[Row],
    task: &Task,
    build: &str,
) -> Result<Vec<(String, usize, Vec<u8>)>, TableError> {
    let found = rows.iter().filter_map(|row| row.found.as_ref().ok());
    let patients: Vec<Patient<'_>> = found
        .map(|found| Patient {
            analysis: &found.analysis,
            subject: &found.subject,
            identifiability: None,
            uncertainty: found.uncertainty.as_ref(),
        })
        .collect();
    let inputs: Vec<InputFile> = rows
        .iter()
        .map(|row| InputFile {
            name: row.file.clone(),
            sha256: row.sha256.clone().unwrap_or_default(),
        })
        .collect();
    // Without the time, so that the same cases give the same bytes on any machine.
    let (made, options, inputs) = (generator(), to_line(&task.words()), to_line(&inputs));
    let option_files = to_line(&task.option_files);
    let replicates = task.replicates.as_ref().map(|(count, noise, seed)| {
        serde_json::json!({"count": count, "noise": noise, "seed": seed}).to_string()
    });
    let mut metadata = vec![
        ("spineline.program", made.as_str()),
        ("spineline.build", build),
        ("spineline.options", options.as_str()),
        ("spineline.option_files", option_files.as_str()),
        ("spineline.inputs", inputs.as_str()),
    ];
    metadata.extend(replicates.as_deref().map(|text| ("spineline.replicates", text)));
    let mut all = tables(&patients);
    all.push(cases(rows));
    let file = |table: &Table| {
        let bytes = table.to_parquet(&metadata)?;
        Ok((table.name.to_owned(), table.rows(), bytes))
    };
    all.iter().map(file).collect()
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
        text("error", "why the case has no analysis", &|row| row.fault().map(Fault::text)),
        text("help", "what to do about it", &|row| row.fault().map(Fault::help)),
        text("film", "the film of the error", &|row| row.fault().and_then(Fault::film)),
        text("level", "the vertebra of the error", &|row| row.fault().and_then(Fault::level)),
    ];
    Table { name: "cases", row: "case file", columns }
}
