//! Cases: the films of one patient.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use spineline::analysis::{self, AnalysisOptions};
use spineline::anatomy::FilmView;
use spineline_files::{
    CaseFile, InputFile, MAX_FILE_BYTES, parse_case_file, parse_case_within, read_bytes,
    sha256_hex, text_of, to_text,
};
use spineline_phantom::{Readers, Scenario, generate};

use spineline_report::patient::{check, film_warnings};
use spineline_report::{html_fragment, terminal};

use crate::fault::Fault;
use crate::patient::{Finding, generator};
use crate::wait::apart;

/// The films of one patient with their landmarks.
#[pyclass(frozen, module = "spineline._native")]
pub struct Case {
    pub file: Arc<CaseFile>,
    pub case: Arc<analysis::Case>,
    pub origin: Origin,
}

/// The files that a case came from: a dictionary in Python.
#[derive(Clone, Default, FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
pub struct Origin {
    /// Name and SHA-256 of the case file that it was read from.
    input: Option<(String, String)>,
    /// SHA-256 of other files, such as landmarks.
    pub made_from: Vec<String>,
}

impl Origin {
    /// Of a case that was not read from a case file.
    pub fn of(made_from: Vec<String>) -> Self {
        Self { input: None, made_from }
    }

    /// The case file that it was read from.
    pub fn input(&self) -> Option<InputFile> {
        self.input.clone().map(|(name, sha256)| InputFile { name, sha256 })
    }
}

/// For pickle: the function that makes an object again, the text of its file, and the files that it came from.
pub type Pickled<'py, T> = (Bound<'py, PyAny>, (String, T));

impl Case {
    pub fn new(file: CaseFile, origin: Origin) -> Result<Self, Fault> {
        let case = file.clone().into_case()?;
        Ok(Self { file: Arc::new(file), case: Arc::new(case), origin })
    }

    /// Frontal films, then the lateral one.
    pub fn all_films(&self) -> Vec<FilmView> {
        let frontal = self.case.films.iter().map(|film| FilmView::Frontal(film.posture));
        frontal.chain(self.case.lateral.iter().map(|_| FilmView::Lateral)).collect()
    }
}

/// Reads a case, or the case within an analysis, from a file of this name, or from its bytes.
#[pyfunction]
#[pyo3(signature = (path, content = None))]
pub fn read_case(path: PathBuf, content: Option<Vec<u8>>) -> Result<Case, Fault> {
    let read = || -> Result<Case, Fault> {
        let content = content.map_or_else(|| read_bytes(&path, MAX_FILE_BYTES), Ok)?;
        let text = text_of(&path, content)?;
        let (file, _) = parse_case_within(&text)?;
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let input = Some((name.into_owned(), sha256_hex(text.as_bytes())));
        Case::new(file, Origin { input, ..Origin::default() })
    };
    read().map_err(|fault| fault.in_file(&path))
}

/// Reads a case from the text of its file.
#[pyfunction]
#[pyo3(signature = (text, origin = None))]
pub fn parse_case(text: &str, origin: Option<Origin>) -> Result<Case, Fault> {
    Case::new(parse_case_file(text)?, origin.unwrap_or_default())
}

/// A synthetic patient. The package has checked subject and noise.
#[pyfunction]
pub fn phantom(
    py: Python<'_>,
    scenario: &str,
    subject: usize,
    seed: u64,
    noise: f64,
) -> PyResult<Case> {
    let Some(scenario) = Scenario::ALL.into_iter().find(|known| known.key() == scenario) else {
        let names = Scenario::ALL.map(Scenario::key);
        let text = format!("unknown loading scenario `{scenario}`");
        return Err(Fault::new(text, format!("give one of {}", names.join(", "))).into());
    };
    let readers = if noise == 0.0 { Readers::exact() } else { Readers::scaled(noise) };
    let made = apart(py, move |_| generate(subject - 1, scenario, &readers, seed))?;
    let made = made.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    Ok(Case::new(CaseFile::from_case(&made.case), Origin::default())?)
}

#[pymethods]
impl Case {
    /// Identifier, without any name.
    #[getter]
    fn id(&self) -> &str {
        &self.case.id
    }

    /// Whether the films are synthetic.
    #[getter]
    fn synthetic(&self) -> bool {
        self.case.synthetic
    }

    /// Postures that have a film, in the order of the file.
    #[getter]
    fn films(&self) -> Vec<&'static str> {
        self.case.films.iter().map(|film| film.posture.key()).collect()
    }

    /// All films: frontal ones in the order of the file, then the lateral one.
    #[getter]
    fn views(&self) -> Vec<&'static str> {
        self.all_films().into_iter().map(FilmView::key).collect()
    }

    /// SHA-256 of every known file that it was made from: case file, landmarks and pictures.
    #[getter]
    pub fn sources(&self) -> Vec<String> {
        let pictures = self.all_films().into_iter().filter_map(|view| self.file.source(view));
        let input = self.origin.input().map(|input| input.sha256);
        let files = input.into_iter().chain(self.origin.made_from.iter().cloned());
        files.chain(pictures.filter_map(|picture| picture.sha256)).collect()
    }

    /// Errors and warnings about the films, one dictionary each, and the whole as text and as HTML.
    fn check(&self, py: Python<'_>) -> PyResult<(Vec<Finding>, String, String)> {
        let case = Arc::clone(&self.case);
        let checked = apart(py, move |_| analysis::analyze(&case, &AnalysisOptions::default()))?;
        let document = check(&self.case, checked.as_ref(), &generator());
        let rows = match &checked {
            Ok(found) => film_warnings(found).map(Finding::from).collect(),
            Err(error) => vec![Finding::from(error)],
        };
        Ok((rows, terminal(&document, terminal::WIDTH), html_fragment(&document)))
    }

    /// The text of its file.
    fn to_json(&self) -> String {
        to_text(&*self.file)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, Origin>> {
        let parse = py.import("spineline._native")?.getattr("parse_case")?;
        Ok((parse, (self.to_json(), self.origin.clone())))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.file == other.file
    }
}
