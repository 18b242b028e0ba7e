//! Personalised models, and their shapes under loads.

use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spineline::analysis::PersonalisedModel;
use spineline::multibody::{Goal, Support};
use spineline::response::{CurveAngles, measure_angles};
use spineline::spatial::Angle;
use spineline_files::{
    ExportFormat, ModelFile, Simulated, export, parse_load, parse_model, results_text,
    text_with_hash, to_text,
};

use crate::analysis::Analysis;
use crate::case::Pickled;
use crate::fault::Fault;
use crate::numbers;
use crate::patient::generator;
use crate::wait::apart;

/// A personalised model.
#[pyclass(frozen, module = "spineline._native")]
pub struct Model {
    text: String,
    model: PersonalisedModel,
    /// SHA-256 of every known file that it was made from.
    sources: Vec<String>,
}

/// Reads a model from the text of its file. Without `sources`, it was made from the inputs that the file states.
#[pyfunction]
#[pyo3(signature = (text, sources = None))]
pub fn parse_model_text(text: String, sources: Option<Vec<String>>) -> Result<Model, Fault> {
    let stored = parse_model(&text)?;
    let inputs = stored.provenance.iter().flat_map(|provenance| &provenance.inputs);
    let stated = inputs.map(|input| input.sha256.clone());
    let sources = sources.unwrap_or_else(|| stated.collect());
    let model = stored.model;
    if model.spine.joints.is_empty() {
        let help = "give a model of at least two vertebrae";
        return Err(Fault::new("the model has no joint", help));
    }
    Ok(Model { text, model, sources })
}

#[pymethods]
impl Model {
    /// The model of an analysis with a line of action; `auto` means the choice of
    /// [`spineline::analysis::Analysis::choose_model`].
    #[new]
    fn new(py: Python<'_>, analysis: &Analysis, line: &str) -> Result<Self, Fault> {
        let found = &analysis.analysis;
        let automatic = (line == "auto").then(|| py.detach(|| found.choose_model()));
        let line = automatic.flatten().map_or(line, |choice| choice.kind.key());
        let Some(model) = found.models.iter().find(|model| model.kind.key() == line) else {
            let lines: Vec<&str> = found.models.iter().map(|model| model.kind.key()).collect();
            let which =
                if line == "auto" { String::new() } else { format!(" with the line `{line}`") };
            let text = format!("{}: the analysis has no model{which}", found.case_id);
            let help = match &lines[..] {
                [] => "a model needs a bending film with a line of action, and the scale of every film".to_owned(),
                lines => format!("give one of {}", lines.join(", ")),
            };
            return Err(Fault::new(text, help));
        };
        let provenance = Some(analysis.provenance.clone());
        let file = ModelFile::new(found, model, &generator(), provenance);
        parse_model_text(text_with_hash(to_text(&file)), Some(analysis.sources()))
    }

    /// Identifier of the case.
    #[getter]
    fn id(&self) -> &str {
        &self.model.case_id
    }

    /// Whether the films are synthetic.
    #[getter]
    fn synthetic(&self) -> bool {
        self.model.synthetic
    }

    /// The line of action with which it was fitted.
    #[getter]
    fn line(&self) -> &str {
        self.model.line.key()
    }

    /// Whether forces and springs are in newtons, because a force was measured.
    #[getter]
    fn absolute(&self) -> bool {
        self.model.absolute
    }

    /// Names of the vertebrae, the fixed one first.
    #[getter]
    fn levels(&self) -> Vec<String> {
        self.model.levels.iter().map(ToString::to_string).collect()
    }

    /// SHA-256 of every known file that it was made from.
    #[getter]
    fn sources(&self) -> Vec<String> {
        self.sources.clone()
    }

    /// Midpoints of the erect vertebrae.
    fn midpoints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        numbers::points(py, self.model.spine.midpoints_mm.iter().map(|&point| point.into()))
    }

    /// The text of its file.
    fn to_json(&self) -> String {
        self.text.clone()
    }

    /// The model in the format of another program: `mjcf`, `osim`, `sto`, `loads`, `urdf`, `vtp` or `gltf`.
    fn export(&self, format: &str) -> Result<String, Fault> {
        let Ok(format) = format.parse::<ExportFormat>() else {
            let text = format!("unknown format `{format}`");
            let help = "give \"mjcf\", \"osim\", \"sto\", \"loads\", \"urdf\", \"vtp\" or \"gltf\"";
            return Err(Fault::new(text, help));
        };
        let written = export(&self.model, format, &generator());
        written.map_err(|error| Fault::of(&error))
    }

    /// The model under the loads of a load file, up to their full size or up to a lateral tilt to the patient's right.
    fn simulate(
        &self,
        py: Python<'_>,
        loads: &str,
        tilt_right_deg: Option<f64>,
        largest_factor: Option<f64>,
        support: Option<&str>,
    ) -> PyResult<Simulation> {
        let mut model = self.model.clone();
        if let Some(name) = support {
            let Ok(support) = name.parse::<Support>() else {
                let text = format!("unknown support `{name}`");
                return Err(Fault::new(text, "give \"free\" or \"frontal\"").into());
            };
            model.support = support;
        }
        let loads = parse_load(loads).map_err(Fault::from)?;
        let tilt = tilt_right_deg.map(|degrees| Goal::LateralTilt(Angle::from_deg(degrees)));
        let goal = tilt.unwrap_or(Goal::FullLoad);
        let found = apart(py, move |stop| {
            Simulated::of(model, loads, goal, largest_factor, Vec::new(), &mut |_, _| {
                if stop.load(Ordering::Relaxed) {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            })
        })?;
        let found = found.map_err(|error| Fault::of(&error))?;
        Ok(Simulation { found, sources: self.sources.clone() })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, Vec<String>>> {
        let parse = py.import("spineline._native")?.getattr("parse_model_text")?;
        Ok((parse, (self.text.clone(), self.sources.clone())))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

/// A model under loads.
#[pyclass(frozen, module = "spineline._native")]
pub struct Simulation {
    found: Simulated,
    /// SHA-256 of every known file that the model was made from.
    sources: Vec<String>,
}

#[pymethods]
impl Simulation {
    /// How the search ended.
    #[getter]
    fn status(&self) -> &'static str {
        self.found.response.ending.key()
    }

    /// What that means.
    #[getter]
    fn meaning(&self) -> &'static str {
        self.found.response.ending.meaning()
    }

    /// Whether the simulation has a result.
    #[getter]
    fn is_usable(&self) -> bool {
        self.found.response.ending.is_usable()
    }

    /// SHA-256 of every known file that the model was made from.
    #[getter]
    fn sources(&self) -> Vec<String> {
        self.sources.clone()
    }

    /// Code and text of every warning.
    #[getter]
    fn warnings(&self) -> Vec<(&'static str, String)> {
        let warnings = self.found.warnings.iter();
        warnings.map(|one| (one.code.key(), one.message.clone())).collect()
    }

    /// The text of its file.
    fn to_json(&self, py: Python<'_>) -> String {
        py.detach(|| results_text(&self.found.file(&generator())))
    }

    /// Midpoints of the vertebrae of the result, or else of the nearest shape; None if the path could not be started.
    fn midpoints<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(shape) = self.found.response.shape() else { return Ok(None) };
        numbers::points(py, shape.midpoints_mm.iter().map(|&point| point.into())).map(Some)
    }

    /// Angles of the same shape in degrees by name and region; None if the path could not be started.
    fn angles<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(shape) = self.found.response.shape() else { return Ok(None) };
        let measured = measure_angles(shape, &self.found.places);
        let by_region = |angle: fn(&CurveAngles) -> Option<Angle>| -> PyResult<Bound<'py, PyDict>> {
            let regions = PyDict::new(py);
            for curve in &measured.curves {
                if let Some(angle) = angle(curve) {
                    regions.set_item(curve.region.key(), angle.deg())?;
                }
            }
            Ok(regions)
        };
        let angles = PyDict::new(py);
        angles.set_item("lateral_tilt", measured.lateral_tilt.deg())?;
        angles.set_item("cobb", by_region(|curve| curve.ends.cobb)?)?;
        angles.set_item("tilt_range", by_region(|curve| Some(curve.ends.tilt_range))?)?;
        angles.set_item("ferguson", by_region(|curve| Some(curve.ferguson))?)?;
        Ok(Some(angles))
    }
}

/// A force by its direction in the patient's terms and its size, in the frame of the model.
#[pyfunction]
pub fn force_vector(towards: &str, size: f64) -> Result<[f64; 3], Fault> {
    let Some(direction) = spineline_files::direction(towards) else {
        let names = spineline_files::DIRECTIONS.map(|(name, _)| name);
        let text = format!("unknown direction `{towards}`");
        return Err(Fault::new(text, format!("give one of {}", names.join(", "))));
    };
    Ok(direction.map(|part| part * size))
}
