//! Figures of a reproduction, named after the paper's.

use std::path::Path;

use spineline::action::LineKind;
use spineline::analysis::FilmRole;
use spineline::anatomy::Posture;
use spineline::multibody::Support;
use spineline_files::Provenance;
use spineline_report::figures::{self, EstimateGroup, InflectionSample, LocationErrorSample};
use spineline_report::paper::{self, PaperMean};

use super::runs::Run;
use crate::run::failure::Failure;
use crate::run::outputs::Outputs;
use crate::run::provenance::in_svg;

/// The patient that stands for all in figures of one patient.
pub const EXAMPLE: usize = 0;

pub fn write(
    outputs: &Outputs,
    folder: &Path,
    runs: &[Run],
    provenance: &Provenance,
) -> Result<(), Failure> {
    // A figure that a group lacks is left out.
    let save = |name: String, svg: Option<String>| match svg {
        Some(svg) => outputs.write(&folder.join(format!("{name}.svg")), in_svg(&svg, provenance)),
        None => Ok(()),
    };
    let free: Vec<&Run> = runs.iter().filter(|run| run.support == Support::Free).collect();
    for run in &free {
        let (scenario, example) = (run.name, &run.analyses[EXAMPLE]);
        save(format!("overview-{scenario}"), Some(figures::case_overview(example)))?;
        let unit = figures::functional_unit(&run.cases[EXAMPLE], example);
        save(format!("figure-02-unit-{scenario}"), unit)?;
        save(format!("figure-04-chain-{scenario}"), Some(figures::chain(example)))?;
        save(format!("figure-05-rotations-{scenario}"), figures::rotations(example))?;
        let groups = EstimateGroup::of(&run.cohort);
        let estimates = figures::least_rotating_estimates(&groups, run.cohort.synthetic);
        save(format!("figure-10-estimates-{scenario}"), estimates)?;
    }
    let synthetic = runs.iter().any(|run| run.cohort.synthetic);
    let inflections: Vec<InflectionSample> = free
        .iter()
        .map(|run| InflectionSample {
            name: run.name.to_owned(),
            distances_segments: run.cohort.inflection[0].all_distances_segments.clone(),
            rotations_deg: run.cohort.inflection[0].all_rotations_deg.clone(),
        })
        .collect();
    let distances = figures::inflection_distances(&inflections, None, true, synthetic);
    save("figure-06-inflections".to_owned(), distances)?;
    for support in [Support::Free, Support::Frontal] {
        let runs: Vec<&Run> = runs.iter().filter(|run| run.support == support).collect();
        error_figures(&runs, support.key(), &save)?;
        runs.iter().try_for_each(|run| example(run, &save))?;
    }
    Ok(())
}

/// Figure 8: location errors by line, on fitted and on held-out films.
fn error_figures(
    runs: &[&Run],
    support: &str,
    save: &impl Fn(String, Option<String>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    type OfPaper = fn(LineKind) -> Option<PaperMean>;
    let errors = |role: FilmRole, of_paper: OfPaper| -> Vec<LocationErrorSample> {
        runs.iter()
            .flat_map(|run| {
                run.cohort.compared.of_role(role).map(move |errors| LocationErrorSample {
                    group: run.name.to_owned(),
                    line: errors.kind,
                    errors_mm: errors.all_location_mm.clone(),
                    paper: of_paper(errors.kind),
                })
            })
            .collect()
    };
    let synthetic = runs.iter().any(|run| run.cohort.synthetic);
    let fitted = errors(FilmRole::Fitted, paper::fitted_location_error_mm);
    let held_out = errors(FilmRole::HeldOut, paper::held_out_location_error_mm);
    let kinds = [
        ("fitted", fitted, "bending films, fitted"),
        ("held-out", held_out, "neutral and traction films, held out"),
    ];
    for (name, errors, films) in kinds {
        let films = format!("{films}, support {support}");
        let drawn = figures::location_errors(&errors, &films, synthetic);
        save(format!("figure-08-errors-{name}-{support}"), drawn)?;
    }
    Ok(())
}

/// Figures 9 and 11 of one patient.
fn example(
    run: &Run,
    save: &impl Fn(String, Option<String>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let (scenario, support, analysis) = (run.name, run.support.key(), &run.analyses[EXAMPLE]);
    for posture in [Posture::LeftBending, Posture::Traction] {
        let drawn = figures::measured_and_simulated(analysis, posture);
        save(format!("figure-09-{}-{scenario}-{support}", posture.key()), drawn)?;
    }
    let model = analysis.model(LineKind::Inflection);
    let parts = [0.0, 0.5, 1.0, 1.25];
    let path = model.and_then(|m| analysis.force_path(m, Posture::RightBending, &parts));
    let drawn = path.map(|shapes| {
        let unit = "of the force found";
        figures::force_path(analysis, Posture::RightBending, LineKind::Inflection, &shapes, unit)
    });
    save(format!("figure-11-force-{scenario}-{support}"), drawn)
}
