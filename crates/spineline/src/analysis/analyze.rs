//! The method on one patient: the movement on the films, then the lines and models that explain it.

use super::comparison::Remembered;
use super::find_best_fit::find_best_fit_lines;
use super::hypotheses::fit_hypotheses;
use super::models::fit_models;
use super::{Analysis, AnalysisOptions, Case, Grouping, LineModel, Movement, Replicated};
use crate::error::{CaseError, Error};
use crate::personalize::{BestFitLoads, FitTarget};
use crate::warning::Warnings;

/// Runs all steps on one case, as far as its films reach.
///
/// An erect film alone gives the curve, its inflections and the clinical angles; every further film adds what it can.
/// Warnings give the reason for missing results. Lengths are in mm, forces in N, moments in N·mm; locations are in the global
/// frame `G` of each film ([`crate::measure`]), whose origin is L4's midpoint.
///
/// # Errors
/// [`Error`]: bad input only. A fit or a search without result is a status beside its numbers.
///
/// ```
/// use spineline::analysis::{AnalysisOptions, analyze};
/// use spineline::anatomy::Posture;
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
/// let analysis = analyze(&case, &AnalysisOptions::default())?;
/// assert_eq!(analysis.movement.erect().outline.posture, Posture::Erect);
/// // One personalised model per line of action.
/// for model in &analysis.models {
///     println!("{}: {:?} mm", model.kind, model.mean_location_error_mm(false));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyze(case: &Case, options: &AnalysisOptions) -> Result<Analysis, Error> {
    let mut analysis = analyze_films(case, options, None, None)?;
    let of_lines = analysis.kept_line_warnings();
    analysis.warnings.merge(&of_lines);
    Ok(analysis)
}

/// As [`analyze`], without lines of action and personalised models: steps 1 to 4 and the unloaded spine, in a small part of
/// the time.
///
/// # Errors
/// [`Error`]: bad input only.
pub fn analyze_movement(case: &Case, options: &AnalysisOptions) -> Result<Analysis, Error> {
    let mut warnings = Warnings::default();
    let movement = Movement::of(case, options, None, &mut warnings)?;
    Ok(Analysis::before_any_force(case, options, movement, warnings))
}

/// Fits to other readings of the same films, from which fits start.
///
/// They shorten a fit. Where minima are nearly alike, they can change in which one it ends (decision 0059).
#[derive(Debug, Clone)]
pub(crate) struct FitStarts<'a> {
    loads: Option<BestFitLoads>,
    models: &'a [LineModel],
}

impl<'a> FitStarts<'a> {
    /// The fits of an analysis.
    pub fn of(analysis: &'a Analysis) -> Self {
        Self { loads: analysis.best_fit_loads().ok(), models: &analysis.models }
    }
}

/// As [`analyze`], without warnings about lines; for a replicate, whose results are quantities, without doubts about its films either.
pub(crate) fn analyze_films(
    case: &Case,
    options: &AnalysisOptions,
    replicated: Option<Replicated<'_>>,
    starts: Option<&FitStarts<'_>>,
) -> Result<Analysis, Error> {
    if (options.target, options.grouping) == (FitTarget::Ferguson, Grouping::PerJoint) {
        return Err(CaseError::FergusonPerJoint.into());
    }
    let mut warnings = Warnings::default();
    let mut movement = Movement::of(case, options, replicated, &mut warnings)?;
    // Of these lines, a replicate uses only the comparison with the inflection line.
    if replicated.is_none() || movement.inflections.pair.is_some() {
        let start = starts.and_then(|starts| starts.loads.as_ref());
        find_best_fit_lines(&mut movement, options, start, &mut warnings);
    }
    let starts = starts.map_or(&[][..], |starts| starts.models);
    let models = fit_models(&movement, options, starts, &mut warnings);
    let hypotheses = fit_hypotheses(&movement, options, &mut warnings);
    let begun = Analysis::before_any_force(case, options, movement, warnings);
    Ok(Analysis { models, hypotheses, ..begun })
}

impl Analysis {
    /// An analysis whose lines and models are not fitted.
    fn before_any_force(
        case: &Case,
        options: &AnalysisOptions,
        movement: Movement,
        warnings: Warnings,
    ) -> Self {
        Self {
            case_id: case.id.clone(),
            synthetic: case.synthetic,
            movement,
            models: Vec::new(),
            hypotheses: Vec::new(),
            options: options.clone(),
            warnings,
            comparison: Remembered::default(),
            bands: Remembered::default(),
        }
    }
}
