//! Beyond the paper: films of one patient that show different lengths, compared as marked and with a scale per film.

use spineline::action::LineKind;
use spineline::analysis::{AnalysisOptions, FilmRole, analyze};
use spineline::cohort::{Cohort, CohortPatient};
use spineline::evaluate::Baseline;
use spineline::measure::FilmLengthRule;
use spineline::multibody::Support;
use spineline_phantom::{Readers, SUBJECTS, Truth, generate};

use super::args::ReproduceArgs;
use super::fair::{NONE, baseline_error, error};
use super::row::{Row, Section};
use crate::run::failure::Failure;
use crate::run::threads::map_all;

const RULES: [(FilmLengthRule, &str); 2] = [
    (FilmLengthRule::AsMarked, "lengths as marked (the paper)"),
    (FilmLengthRule::PerFilm { relative_sd: FilmLengthRule::RELATIVE_SD }, "a scale per film"),
];

/// Errors on predicted films whose lengths differ as those of real patients do, by either rule.
pub fn section(args: &ReproduceArgs, readers: &Readers) -> Result<Section, Failure> {
    let cohorts = RULES.map(|(rule, _)| cohorts(args, readers, rule));
    let mut rows = Vec::new();
    for ((_, words), cohorts) in RULES.into_iter().zip(cohorts) {
        let cohorts = cohorts?;
        let cohorts = cohorts.each_ref();
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
    readers: &Readers,
    rule: FilmLengthRule,
) -> Result<[Cohort; 3], Failure> {
    let tasks: Vec<(Truth, usize)> =
        Truth::ALL.iter().flat_map(|&truth| (0..SUBJECTS.len()).map(move |i| (truth, i))).collect();
    let options = AnalysisOptions {
        support: Support::Frontal,
        target: args.fit,
        film_lengths: rule,
        ..AnalysisOptions::default()
    };
    let results =
        map_all("films of different length", &tasks, args.threads, |&(truth, subject)| {
            let phantom = generate(subject, truth, readers, args.seed)
                .map_err(|error| error.to_string())?
                .with_film_lengths(FilmLengthRule::RELATIVE_SD, subject, args.seed);
            analyze(&phantom.case, &options)
                .map(|analysis| CohortPatient::of(&analysis))
                .map_err(|error| format!("{}: {error}", phantom.case.id))
        })?;
    let patients: Vec<CohortPatient> =
        results.into_iter().collect::<Result<_, String>>().map_err(Failure::internal)?;
    let mut by_truth = patients.chunks(SUBJECTS.len());
    Ok(Truth::ALL.map(|_| Cohort::of(by_truth.next().unwrap_or_default(), args.seed)))
}
