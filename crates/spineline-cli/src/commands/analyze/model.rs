//! `analyze --model`: the personalised model of one case.

use std::path::Path;

use spineline::analysis::{Analysis, LineModel, ModelChoice};
use spineline_files::{ModelFile, Provenance, to_text};

use super::args::{AnalyzeArgs, ModelLine, line_name};
use crate::run::failure::Failure;
use crate::run::messages::say;
use crate::run::outputs::Outputs;
use crate::run::provenance::generator;

/// The model that `--model` writes; without words where the user names its line. `None` where there is none.
pub fn choose(args: &AnalyzeArgs, analysis: &Analysis) -> Option<ModelChoice> {
    match args.model_line {
        ModelLine::Kind(kind) => {
            analysis.model(kind).map(|model| ModelChoice { kind: model.kind, words: String::new() })
        }
        ModelLine::Auto => analysis.choose_model(),
    }
}

/// Writes the chosen model, and says which one it is where the program chose it.
///
/// # Errors
/// If it cannot be written.
pub fn write_model(
    path: &Path,
    (analysis, model, why): (&Analysis, &LineModel, &str),
    provenance: &Provenance,
    outputs: &Outputs,
) -> Result<(), Failure> {
    let file = ModelFile::new(analysis, model, &generator());
    outputs.write(path, to_text(&file.with_provenance(provenance.clone())))?;
    if !why.is_empty() {
        let (case, kind) = (&analysis.case_id, model.kind);
        say(format!("{case}: the model of the {kind} is written. {why}"));
    }
    Ok(())
}

/// Names the missing model and the options that give one.
pub fn say_missing(path: &Path, args: &AnalyzeArgs, analysis: &Analysis) {
    let what = match args.model_line {
        ModelLine::Kind(kind) => format!("there is no model with the {kind}"),
        ModelLine::Auto => "there is no model".to_owned(),
    };
    let why = format!("{}: {what}", analysis.case_id);
    say(&Failure::target(path, &why, &help_without_model(analysis)));
}

/// What gives a model to write: a line that has one, or what all lines lack.
fn help_without_model(analysis: &Analysis) -> String {
    let lines: Vec<String> = analysis
        .models
        .iter()
        .map(|model| format!("--model-line {}", line_name(model.kind)))
        .collect();
    if !lines.is_empty() {
        return format!("write another one: {}", lines.join(" or "));
    }
    if let Some(posture) = analysis.movement.film_without_scale() {
        return format!(
            "a model needs the scale of every film, and the {posture} film has none: give `column_spacing_mm`, `row_spacing_mm` and `spacing_plane` in the case file, or import the films with --spacing, --ball or --ruler"
        );
    }
    if analysis.movement.films.iter().all(|posture| posture.outline.posture.bend().is_none()) {
        return "a model needs a bending film: add one to the case".to_owned();
    }
    "no bending film has a line of action, and the warnings say why: set the inflections with --inflections, or the line with --given-line".to_owned()
}
