//! Analyses: the results of all steps for one patient.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use numpy::PyArray2;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use serde_json::Value;
use spineline::analysis::{self, AnalysisOptions, Grouping, LineModel};
use spineline::measure::FilmFrame;
use spineline::personalize::Identifiability;
use spineline::spatial::Frontal;
use spineline::warning::WarningCode;
use spineline_files::method_text::{missing_known_force, options_of};
use spineline_files::{
    AnalysisFile, CaseFile, FilmOrigin, Provenance, Request, parse_analysis, parse_json,
    picture_warnings, results_line, results_text, text_with_hash,
};
use spineline_report::figures;
use spineline_report::patient::{Patient as ReportedPatient, overview, report, summary};
use spineline_report::{html, html_fragment, terminal};
use spineline_tables::{Patient, tables};

use crate::case::{Case, Origin, Pickled};
use crate::fault::Fault;
use crate::numbers;
use crate::patient::{Finding, check_case, generator, run, words};
use crate::table::Table;
use crate::wait::apart;

/// The results of all steps for one patient.
#[pyclass(frozen, module = "spineline._native")]
pub struct Analysis {
    pub file: Arc<CaseFile>,
    pub case: Arc<analysis::Case>,
    pub analysis: analysis::Analysis,
    pub request: Request,
    pub provenance: Provenance,
    /// The files that the case came from.
    pub origin: Origin,
    pub identifiability: Option<Vec<Option<Identifiability>>>,
}

/// An analysis, and the identifiability of its models if requested.
pub type Computed = (analysis::Analysis, Option<Vec<Option<Identifiability>>>);

/// Computes while other Python threads run. Short work (milliseconds) does not need a thread that checks for Ctrl-C.
fn waited_for(py: Python<'_>, case: &Arc<analysis::Case>, request: &Request) -> PyResult<Computed> {
    let options = &request.options;
    let is_short = !request.identifiability
        && options.hypotheses.is_empty()
        && options.grouping != Grouping::PerJoint;
    if is_short {
        Ok(py.detach(|| compute(case, request, &AtomicBool::new(false)))?)
    } else {
        let (case, request) = (Arc::clone(case), request.clone());
        Ok(apart(py, move |stop| compute(&case, &request, stop))??)
    }
}

/// Computes everything that a request asks of a case except replicates; returns a part if it is stopped.
///
/// # Errors
/// If the case cannot be analysed.
pub fn compute(
    case: &analysis::Case,
    request: &Request,
    stop: &AtomicBool,
) -> Result<Computed, Fault> {
    if let Some(posture) = missing_known_force(&request.options, case) {
        let text =
            format!("{}: `gauge` names the {posture} film, which this case does not have", case.id);
        return Err(Fault::new(text, "name a film of the case"));
    }
    let found = analysis::analyze(case, &request.options)?;
    let identify = |model: &LineModel| {
        let is_stopped = stop.load(Ordering::Relaxed);
        if is_stopped { None } else { found.identifiability(model) }
    };
    let identifiability =
        request.identifiability.then(|| found.models.iter().map(identify).collect());
    Ok((found, identifiability))
}

impl Analysis {
    /// The patient in the form for tables.
    fn patient(&self) -> Patient<'_> {
        Patient {
            analysis: &self.analysis,
            subject: &self.case.subject,
            identifiability: self.identifiability.as_deref(),
            uncertainty: None,
        }
    }

    /// The patient in the form for reports.
    fn reported<'a>(&'a self, generator: &'a str, json: &'a str) -> ReportedPatient<'a> {
        ReportedPatient {
            case: &self.case,
            analysis: &self.analysis,
            pictures: &[],
            identifiability: self.identifiability.as_deref(),
            uncertainty: None,
            generator,
            json,
        }
    }

    /// Its file with this provenance.
    pub fn stored(&self, provenance: &Provenance) -> AnalysisFile {
        let file = AnalysisFile::new(&self.analysis, (*self.file).clone(), provenance.clone());
        file.with_identifiability(&self.analysis, self.identifiability.as_deref())
    }

    /// The results of a posture.
    fn posture(&self, film: &str) -> Result<&analysis::FilmMovement, Fault> {
        let known = film.replace('-', "_").parse().ok();
        known.and_then(|posture| self.analysis.movement.film(posture)).ok_or_else(|| {
            let films: Vec<&str> =
                self.analysis.movement.films.iter().map(|one| one.outline.posture.key()).collect();
            let text = format!("{}: the analysis has no `{film}` film", self.analysis.case_id);
            Fault::new(text, format!("give one of {}", films.join(", ")))
        })
    }

    /// Refuses a film whose lengths are not known in mm.
    fn check_scale(&self, film: &analysis::FilmMovement) -> Result<(), Fault> {
        if film.outline.scale.mm(1.0).is_some() {
            return Ok(());
        }
        let posture = film.outline.posture;
        let text = format!(
            "{}: the {} film has no spacing, so its curve is not known in millimetres",
            self.analysis.case_id,
            posture.key()
        );
        let help = "give the spacing of the film in the case";
        Err(Fault::new(text, help).on_film(Some(posture.into())))
    }

    /// Points of a film in its mm.
    fn in_mm<'py, const N: usize>(
        &self,
        py: Python<'py>,
        film: &analysis::FilmMovement,
        points: impl ExactSizeIterator<Item = [f64; N]>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.check_scale(film)?;
        let units = film.outline.scale.units_per_mm;
        numbers::points(py, points.map(move |point| point.map(|part| units * part)))
    }
}

#[pymethods]
impl Analysis {
    /// Analyses a case with options given as text.
    #[new]
    fn new(
        py: Python<'_>,
        case: &Case,
        given: Vec<(String, String)>,
        identifiability: bool,
        command: Vec<String>,
        date_utc: String,
    ) -> PyResult<Self> {
        let (options, files) = options_of(words(&given)).map_err(Fault::from)?;
        let input = case.origin.input();
        let sha256 = input.as_ref().map_or("", |input| &input.sha256);
        check_case(&files, sha256, &case.case.id)?;
        let request = Request { options, replicates: None, identifiability };
        let (found, identifiability) = waited_for(py, &case.case, &request)?;
        let inputs = input.into_iter().chain(files.into_iter().map(|one| one.file));
        let films = FilmOrigin::of([case.case.synthetic]);
        let provenance = Provenance::new(run(command, date_utc), films, inputs.collect());
        let provenance = provenance.of_cases([case.case.id.clone()]).asking(&request);
        Ok(Self {
            file: Arc::clone(&case.file),
            case: Arc::clone(&case.case),
            analysis: found,
            request,
            provenance,
            origin: case.origin.clone(),
            identifiability,
        })
    }

    /// Repeats an analysis from its file, which must give the same results. Replicates are left out.
    #[staticmethod]
    #[pyo3(signature = (text, origin = None))]
    fn repeat(py: Python<'_>, text: &str, origin: Option<Origin>) -> PyResult<Self> {
        let stored = parse_analysis(text).map_err(Fault::from)?;
        let request = Request { replicates: None, ..stored.request };
        let case = Arc::new(stored.case);
        let (mut found, identifiability) = waited_for(py, &case, &request)?;
        let then = parse_json(text).map_err(Fault::from)?;
        found.warnings.merge(&picture_warnings(&then));
        // The file does not say which of its inputs the case was read from: films may come from Python, and options from files.
        let stated = stored.provenance.inputs.iter().map(|input| input.sha256.clone());
        let origin = origin.unwrap_or_else(|| Origin::of(stated.collect()));
        let again = Self {
            file: Arc::new(stored.case_file),
            case,
            analysis: found,
            provenance: stored.provenance.asking(&request),
            origin,
            request,
            identifiability,
        };
        let now = py.detach(|| results_text(&again.stored(&again.provenance)));
        let now = parse_json(&now).map_err(Fault::from)?;
        if results(then) == results(now) {
            return Ok(again);
        }
        let what = format!(
            "{}: this version of Spineline ({}) finds other results than {}, which wrote the analysis",
            again.analysis.case_id,
            generator(),
            again.provenance.program
        );
        let help = "install the same version everywhere, or compare both with `spineline rerun`";
        Err(Fault::new(what, help).into())
    }

    /// Identifier of the case.
    #[getter]
    fn id(&self) -> &str {
        &self.analysis.case_id
    }

    /// Whether the films are synthetic.
    #[getter]
    fn synthetic(&self) -> bool {
        self.analysis.synthetic
    }

    /// Whether a model was fitted, and everything that was asked for has a result.
    #[getter]
    fn is_usable(&self) -> bool {
        !self.analysis.models.is_empty() && self.analysis.has_what_was_asked()
    }

    /// Postures that have a film, the erect one first.
    #[getter]
    fn films(&self) -> Vec<&'static str> {
        self.analysis.movement.films.iter().map(|one| one.outline.posture.key()).collect()
    }

    /// The lines of action that have a model.
    #[getter]
    fn lines(&self) -> Vec<&'static str> {
        self.analysis.models.iter().map(|model| model.kind.key()).collect()
    }

    /// The verdict in sentences.
    #[getter]
    fn verdict(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.analysis.verdict())
    }

    /// The case that was analysed.
    #[getter]
    fn case(&self) -> Case {
        Case {
            file: Arc::clone(&self.file),
            case: Arc::clone(&self.case),
            origin: self.origin.clone(),
        }
    }

    /// SHA-256 of every known file that it was made from: of the case, and of its options.
    #[getter]
    pub fn sources(&self) -> Vec<String> {
        let inputs = self.provenance.inputs.iter().map(|input| input.sha256.clone());
        self.case().sources().into_iter().chain(inputs).collect()
    }

    /// Every warning, in the order of the steps.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> Vec<Finding> {
        py.detach(|| self.analysis.all_warnings().map(Finding::from).collect())
    }

    /// The text of its file.
    fn to_json(&self, py: Python<'_>) -> String {
        py.detach(|| text_with_hash(results_text(&self.stored(&self.provenance))))
    }

    /// All tables, in the order of the dictionary.
    fn tables(&self, py: Python<'_>) -> Vec<Table> {
        py.detach(|| tables(&[self.patient()])).into_iter().map(Table::new).collect()
    }

    /// A page of text for a terminal.
    fn summary(&self, py: Python<'_>) -> String {
        let made = generator();
        py.detach(|| terminal(&summary(&self.reported(&made, "")), terminal::WIDTH))
    }

    /// What a notebook shows.
    fn overview_html(&self, py: Python<'_>) -> String {
        py.detach(|| html_fragment(&overview(&self.analysis, &generator())))
    }

    /// The report as one HTML page.
    fn report_html(&self, py: Python<'_>) -> String {
        let made = generator();
        py.detach(|| {
            let json = results_line(&self.stored(&self.provenance));
            text_with_hash(html(&report(&self.reported(&made, &json))))
        })
    }

    /// A figure as SVG; None if it would be empty.
    #[pyo3(signature = (name, film = None))]
    fn figure(&self, name: &str, film: Option<&str>) -> PyResult<Option<String>> {
        let posture = film.map(|film| self.posture(film)).transpose()?;
        let found = &self.analysis;
        Ok(match (name, posture) {
            ("overview", None) => Some(figures::case_overview(found)),
            ("rotations", None) => figures::rotations(found),
            ("simulated", Some(film)) => {
                figures::measured_and_simulated(found, film.outline.posture)
            }
            _ => return Err(PyRuntimeError::new_err(format!("no figure `{name}`"))),
        })
    }

    /// The name of a film in files; refuses an unknown film.
    fn film_name(&self, film: &str) -> Result<&'static str, Fault> {
        self.posture(film).map(|found| found.outline.posture.key())
    }

    /// Points of the curve of a film: (n, 2), patient's left and cranial, mm.
    fn curve_points<'py>(
        &self,
        py: Python<'py>,
        film: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let posture = self.posture(film)?;
        let points = posture.pose.joints.iter().map(|point| [point.y_mm, point.z_mm]);
        self.in_mm(py, posture, points)
    }

    /// Measured midpoints of the vertebrae of a film, the lowest first, and their names.
    fn locations<'py>(
        &self,
        py: Python<'py>,
        film: &str,
    ) -> PyResult<(Vec<String>, Bound<'py, PyArray2<f64>>)> {
        let posture = self.posture(film)?;
        let vertebrae = &posture.outline.vertebrae;
        let levels = vertebrae.iter().map(|vertebra| vertebra.level.to_string()).collect();
        let points = vertebrae.iter().map(|v| [v.location.y_mm, v.location.z_mm]);
        Ok((levels, self.in_mm(py, posture, points)?))
    }

    /// Places of the two inflections of the erect curve on a film, the caudal one first; None if the curve lacks them.
    fn inflections<'py>(
        &self,
        py: Python<'py>,
        film: &str,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let posture = self.posture(film)?;
        let Some(points) = posture.inflection_points else { return Ok(None) };
        let points = points.map(|point| [point.y_mm, point.z_mm]);
        self.in_mm(py, posture, points.into_iter()).map(Some)
    }

    /// Places of points of a film's frame on its picture: (n, 2), column and row; None without a picture.
    fn to_pixels<'py>(
        &self,
        py: Python<'py>,
        film: &str,
        points: Vec<[f64; 2]>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let posture = self.posture(film)?;
        self.check_scale(posture)?;
        let marked = self.case.film(posture.outline.posture);
        let frame = marked.and_then(|marked| FilmFrame::of(marked, &posture.outline));
        let Some(frame) = frame else { return Ok(None) };
        let pixels = points.into_iter().map(|[y_mm, z_mm]| {
            let internal = 1.0 / posture.outline.scale.units_per_mm;
            let place = frame.pixel(Frontal::new(y_mm, z_mm) * internal);
            [place.column_px, place.row_px]
        });
        numbers::points(py, pixels).map(Some)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, Origin>> {
        let repeat = py.get_type::<Self>().getattr("repeat")?;
        Ok((repeat, (self.to_json(py), self.origin.clone())))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.file == other.file
            && self.request == other.request
            && self.analysis == other.analysis
            && self.identifiability == other.identifiability
    }
}

/// Seconds that the library alone needs to analyse a case, for comparison with calls from Python.
#[pyfunction]
pub fn time_analysis(py: Python<'_>, case: &Case) -> Result<f64, Fault> {
    py.detach(|| {
        let start = Instant::now();
        // Freeing the memory of a result is included.
        drop(analysis::analyze(&case.case, &AnalysisOptions::default())?);
        Ok(start.elapsed().as_secs_f64())
    })
}

/// The results of an analysis, without the request and without the replicates and their warning.
fn results(mut file: Value) -> Value {
    if let Some(parts) = file.as_object_mut() {
        parts.remove("provenance");
        parts.remove("uncertainty");
        if let Some(warnings) = parts.get_mut("warnings").and_then(Value::as_array_mut) {
            warnings.retain(|one| one["code"] != WarningCode::ReplicatesInterrupted.key());
        }
    }
    file
}
