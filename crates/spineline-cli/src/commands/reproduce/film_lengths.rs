//! Films of one patient that show different lengths, analysed as marked and with a scale per film.

use spineline::analysis::AnalysisOptions;
use spineline::cohort::Cohort;
use spineline::measure::FilmLengthRule;
use spineline::multibody::Support;
use spineline_phantom::{Phantom, SUBJECTS};
use spineline_report::reproduction::{self, Part};

use super::args::ReproduceArgs;
use super::runs;
use crate::run::failure::Failure;

const RULES: [(FilmLengthRule, &str); 2] = [
    (FilmLengthRule::AsMarked, "lengths as marked (the paper)"),
    (FilmLengthRule::PerFilm { relative_sd: FilmLengthRule::RELATIVE_SD }, "a scale per film"),
];

/// Errors on predicted films whose lengths differ as in real patients, by both rules.
pub fn part(args: &ReproduceArgs, phantoms: &[Phantom]) -> Result<Part, Failure> {
    let relative_sd = FilmLengthRule::RELATIVE_SD;
    let scaled = |(i, phantom): (usize, &Phantom)| {
        phantom.clone().with_film_lengths(relative_sd, i % SUBJECTS.len(), args.seed)
    };
    let phantoms: Vec<Phantom> = phantoms.iter().enumerate().map(scaled).collect();
    let mut found = Vec::new();
    for (rule, words) in RULES {
        found.push((words, cohorts(args, &phantoms, rule)?));
    }
    let by_rule: Vec<(&str, Vec<&Cohort>)> =
        found.iter().map(|(words, cohorts)| (*words, cohorts.iter().collect())).collect();
    Ok(reproduction::film_lengths(relative_sd, &by_rule))
}

fn cohorts(
    args: &ReproduceArgs,
    phantoms: &[Phantom],
    rule: FilmLengthRule,
) -> Result<Vec<Cohort>, Failure> {
    let options = AnalysisOptions { film_lengths: rule, ..args.options(Support::Frontal) };
    let tasks: Vec<_> = phantoms.iter().map(|phantom| (phantom, options.clone())).collect();
    let (_, patients) = runs::analyses(args, &tasks)?;
    runs::cohorts(args, &patients)
}
