//! `analyze --model`: the personalised model of one case.

use std::path::Path;

use spineline::analysis::{Analysis, LineModel};
use spineline_files::{ModelFile, Provenance, to_text};

use super::args::{AnalyzeArgs, ModelLine};
use crate::options::choice::Choice;
use crate::run::failure::Failure;
use crate::run::messages::say;
use crate::run::outputs::Outputs;
use crate::run::provenance::generator;

/// The model that `--model` writes.
pub fn written_model<'a>(args: &AnalyzeArgs, analysis: &'a Analysis) -> Option<&'a LineModel> {
    let kind = match args.model_line {
        ModelLine::Kind(kind) => kind,
        ModelLine::Auto => analysis.compare_lines().best_predictor()?.0,
    };
    analysis.models.iter().find(|model| model.kind == kind)
}

/// Writes it.
///
/// # Errors
/// If there is none, or it cannot be written.
pub fn write_model(
    path: &Path,
    args: &AnalyzeArgs,
    analysis: &Analysis,
    provenance: &Provenance,
    outputs: &Outputs,
) -> Result<(), Failure> {
    let Some(model) = written_model(args, analysis) else {
        let text = match args.model_line {
            ModelLine::Kind(kind) => format!("there is no model with the {kind}"),
            ModelLine::Auto => "no line predicts a film that it was not fitted to".to_owned(),
        };
        let text = format!("{text}, so --model has nothing to write");
        return Err(Failure::input(&analysis.case_id, &text, &help_without_model(analysis)));
    };
    if matches!(args.model_line, ModelLine::Auto) {
        let why = analysis.compare_lines().choice_words().unwrap_or_default();
        say(&format!("{}: the model of the {} is written. {why}\n", analysis.case_id, model.kind));
    }
    let file = ModelFile::new(analysis, model, &generator());
    outputs.write(path, to_text(&file.with_provenance(provenance.clone())))
}

/// What gives a model to write: a line that has one, or what all lines lack.
fn help_without_model(analysis: &Analysis) -> String {
    let lines: Vec<String> = analysis
        .models
        .iter()
        .map(|model| format!("--model-line {}", model.kind.spelling()))
        .collect();
    if !lines.is_empty() {
        return format!("write another one: {}", lines.join(" or "));
    }
    if let Some(posture) = analysis.film_without_scale() {
        return format!(
            "a model needs the scale of every film, and the {posture} film has none: give `column_spacing_mm`, `row_spacing_mm` and `spacing_plane` in the case file, or import the films with --spacing, --ball or --ruler"
        );
    }
    if analysis.postures.iter().all(|posture| posture.outline.posture.bend().is_none()) {
        return "a model needs a bending film: add one to the case".to_owned();
    }
    "no bending film has a line of action, and the warnings say why: set the inflections with --inflections, or the line with --given-line".to_owned()
}
