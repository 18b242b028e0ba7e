//! `analyze --model`: the personalised model of one case.

use std::path::Path;

use spineline::analysis::{Analysis, ModelChoice};
use spineline_files::{ModelFile, to_text};

use super::args::{AnalyzeArgs, ModelLine, line_name};
use super::kept::{Analysed, Kept};
use super::output::Output;
use crate::run::failure::Failure;
use crate::run::messages::say;
use crate::run::outputs::Outputs;
use crate::run::provenance::generator;

/// The model that `--model` writes; without words where the user names its line. `None` without a model.
pub fn choose(args: &AnalyzeArgs, analysis: &Analysis) -> Option<ModelChoice> {
    match args.model_line {
        ModelLine::Kind(kind) => {
            analysis.model(kind).map(|model| ModelChoice { kind: model.kind, words: String::new() })
        }
        ModelLine::Auto => analysis.choose_model(),
    }
}

/// `--model`: the personalised model of one case.
pub struct Model<'a> {
    pub path: &'a Path,
    pub args: &'a AnalyzeArgs,
    pub outputs: &'a Outputs,
}

impl Output for Model<'_> {
    fn end(self: Box<Self>, run: &Kept<'_>) {
        let Some(Analysed { analysis, .. }) = &run.one else { return };
        let chosen = run.model.as_ref().and_then(|choice| {
            let model = analysis.model(choice.kind)?;
            Some((model, &choice.words))
        });
        let Some((model, why)) = chosen else { return self.say_missing(analysis) };
        let is_made = self.outputs.attempt(self.path, || {
            let file = ModelFile::new(analysis, model, &generator(), Some(run.provenance()));
            self.outputs.write(self.path, to_text(&file))
        });
        if is_made && !why.is_empty() {
            let (case, kind) = (&analysis.case_id, model.kind);
            say(format!("{case}: the model of the {kind} is written. {why}"));
        }
    }
}

impl Model<'_> {
    /// Names the missing model and the options that give one.
    fn say_missing(&self, analysis: &Analysis) {
        let what = match self.args.model_line {
            ModelLine::Kind(kind) => format!("the analysis has no model with the {kind}"),
            ModelLine::Auto => "the analysis has no model".to_owned(),
        };
        let why = format!("{}: {what}", analysis.case_id);
        say(&Failure::target(self.path, &why, &help_without_model(analysis)));
    }
}

/// How to get a model: a line that has one, or the input that all lines lack.
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
