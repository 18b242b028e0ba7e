//! Beyond the paper: films of one patient that show different lengths, compared as marked and with a scale per film.

use spineline::action::LineKind;
use spineline::analysis::{AnalysisOptions, FilmRole};
use spineline::cohort::Cohort;
use spineline::evaluate::Baseline;
use spineline::measure::FilmLengthRule;
use spineline::multibody::Support;
use spineline_phantom::{Phantom, SUBJECTS, Scenario};

use super::args::ReproduceArgs;
use super::fair::{NONE, baseline_error, error};
use super::row::{Row, Section};
use super::runs;
use crate::options::phantoms::options_of;
use crate::run::failure::Failure;

const RULES: [(FilmLengthRule, &str); 2] = [
    (FilmLengthRule::AsMarked, "lengths as marked (the paper)"),
    (FilmLengthRule::PerFilm { relative_sd: FilmLengthRule::RELATIVE_SD }, "a scale per film"),
];

/// Errors on predicted films whose lengths differ as those of real patients do, by either rule.
pub fn section(args: &ReproduceArgs, phantoms: &[Phantom]) -> Result<Section, Failure> {
    let scaled = |(i, phantom): (usize, &Phantom)| {
        let subject = i % SUBJECTS.len();
        phantom.clone().with_film_lengths(FilmLengthRule::RELATIVE_SD, subject, args.seed)
    };
    let phantoms: Vec<Phantom> = phantoms.iter().enumerate().map(scaled).collect();
    let mut rows = Vec::new();
    for (rule, words) in RULES {
        let cohorts = cohorts(args, &phantoms, rule)?;
        let cohorts: [&Cohort; Scenario::PAPER.len()] =
            std::array::from_fn(|scenario| &cohorts[scenario]);
        let mut add = |what: String, ours| {
            rows.push(Row {
                quantity: format!("{words}: {what} (mm)"),
                unit: "mm",
                paper: NONE.to_owned(),
                ours,
                verdict: String::new(),
            });
        };
        for role in [FilmRole::LeftOutBend, FilmRole::HeldOut] {
            for kind in [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated] {
                add(format!("{role}, {kind}"), cohorts.map(|c| error(c, kind, role)));
            }
            for baseline in Baseline::ALL {
                let ours = cohorts.map(|c| baseline_error(c, baseline, role));
                add(format!("{role}, without mechanics, {baseline}"), ours);
            }
        }
    }
    let percent = 100.0 * FilmLengthRule::RELATIVE_SD;
    Ok(Section {
        title: format!(
            "Films of different length (standard deviation {percent} %), frontal support"
        ),
        support: Some(Support::Frontal),
        rows,
        note: "Location errors on predicted films, one mean per patient. Every film but the erect one is scaled at random, as films of 30 real patients are. With a scale per film that of a predicted film comes from T2 and its prior alone. The sections above have films of one scale, which the phantoms state: both rules are the same there.",
    })
}

fn cohorts(
    args: &ReproduceArgs,
    phantoms: &[Phantom],
    rule: FilmLengthRule,
) -> Result<Vec<Cohort>, Failure> {
    let options = AnalysisOptions { film_lengths: rule, ..options_of(Support::Frontal, args.fit) };
    let tasks: Vec<_> = phantoms.iter().map(|phantom| (phantom, options.clone())).collect();
    let (_, patients) = runs::analyses(args, &tasks)?;
    runs::cohorts(args, &patients)
}
