//! The analysis that a stored model was made from, made again from its case.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, PersonalisedModel, analyze};
use spineline::error::Error;
use spineline::spatial::{Mat3, Vec3};

use crate::{FileError, StoredModel};

/// A model in a file and one of an analysis are the same where their places differ by less than this.
const SAME_MM: f64 = 1e-6;
/// The same for elements of axes, and for springs as a part of them.
const SAME_PART: f64 = 1e-6;

/// The analysis that a stored model was made from, and the line of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelSource {
    /// The analysis, without other loads and bases.
    pub analysis: Analysis,
    /// Line of action of the model.
    pub kind: LineKind,
}

const MODEL_HELP: &str = "write the model again: `spineline analyze CASE --model FILE`";

spineline::faults! {
    /// Why a stored model cannot be made again from a case.
    #[derive(Debug, thiserror::Error)]
    #[non_exhaustive]
    pub enum ModelSourceError {
        /// A model file without the options of its analysis.
        #[error("the model file does not say with which options its case was analysed")]
        #[help(MODEL_HELP)]
        NoOptions,
        /// Options that cannot be used.
        #[error(transparent)]
        #[help("write the model again with this version of the program")]
        Options(#[from] FileError),
        /// The case of another patient.
        #[error("the model belongs to the case {model}, and the case given is {case}")]
        #[help("give the case that the model was made from")]
        OtherCase {
            /// The case of the model.
            model: String,
            /// The case that was given.
            case: String,
        },
        /// A case that cannot be analysed.
        #[error(transparent)]
        #[help(error.help())]
        Analysis(#[from] Error as error),
        /// A model that the analysis lacks.
        #[error("the analysis of the case has no model with the line {line}")]
        #[help(MODEL_HELP)]
        NoModel {
            /// Line in the model file.
            line: &'static str,
        },
        /// A model that was changed, or made from other landmarks or by another version of the program.
        #[error("{what} of the model file differ from the model that the case gives now")]
        #[help("a replicate is a new analysis of the case, which cannot follow changes made by hand: give the case as it was, or write the model again: `spineline analyze CASE --model FILE`")]
        Differs {
            what: &'static str,
        },
    }
}

impl ModelSource {
    /// Analyses the case of a model again, with the options in the model's provenance.
    ///
    /// # Errors
    /// [`ModelSourceError`] where that does not give this model.
    pub fn of(model: &StoredModel, case: &Case) -> Result<Self, ModelSourceError> {
        if case.id != model.model.case_id {
            let (model, case) = (model.model.case_id.clone(), case.id.clone());
            return Err(ModelSourceError::OtherCase { model, case });
        }
        let request = model.provenance.as_ref().map(|provenance| provenance.request());
        let request = request.transpose()?.flatten().ok_or(ModelSourceError::NoOptions)?;
        let options = AnalysisOptions { hypotheses: Vec::new(), ..request.options };
        let analysis = analyze(case, &options)?;
        let kind = model.model.line;
        let found = analysis.model(kind);
        let found = found.ok_or(ModelSourceError::NoModel { line: kind.key() })?;
        match difference(&model.model, &analysis.personalised_model(found)) {
            Some(what) => Err(ModelSourceError::Differs { what }),
            None => Ok(Self { analysis, kind }),
        }
    }
}

/// The part in which two models differ; the support is ignored, since the simulation chooses it.
fn difference(one: &PersonalisedModel, other: &PersonalisedModel) -> Option<&'static str> {
    let far = |a: &Vec3, b: &Vec3| (a - b).abs().max() > SAME_MM;
    let turned = |a: &Mat3, b: &Mat3| (a - b).abs().max() > SAME_PART;
    let stiffer = |a: &Mat3, b: &Mat3| (a - b).abs().max() > SAME_PART * b.abs().max();
    let joints = |model: &PersonalisedModel| -> Vec<Vec3> {
        model.spine.joints.iter().map(|joint| joint.centre_in_inferior_mm).collect()
    };
    let any = |a: &[Mat3], b: &[Mat3], differs: &dyn Fn(&Mat3, &Mat3) -> bool| {
        a.iter().zip(b).any(|(a, b)| differs(a, b))
    };
    let any_far = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).any(|(a, b)| far(a, b));
    let places = |model: &PersonalisedModel| {
        let curves = model.curves.iter().flatten();
        curves.map(|curve| (curve.bounds, curve.cobb_ends)).collect::<Vec<_>>()
    };
    if one.levels != other.levels {
        Some("the vertebrae")
    } else if any_far(&one.spine.midpoints_mm, &other.spine.midpoints_mm)
        || any(&one.spine.axes, &other.spine.axes, &turned)
    {
        Some("the places of the vertebrae")
    } else if any_far(&joints(one), &joints(other)) {
        Some("the joint centres")
    } else if any(&one.stiffness, &other.stiffness, &stiffer) {
        Some("the springs")
    } else if places(one) != places(other) {
        Some("the regions")
    } else {
        None
    }
}
