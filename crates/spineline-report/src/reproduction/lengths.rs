//! Beyond the paper: films of one patient that show different lengths, compared as marked and with a scale per film.

use spineline::analysis::FilmRole;
use spineline::cohort::Cohort;
use spineline::evaluate::Baseline;
use spineline::multibody::Support;
use spineline::number::{fixed, with_unit};

use super::fair::{baseline_error, error, error_with_tilt};
use super::numbers::{Part, ours};
use crate::phrases::LINES;

const NOTE: &str = "Location errors on predicted films, one mean per patient. Every film but the erect one is scaled at random, as films of 30 real patients are. With a scale per film, the scale of a predicted film comes from T2 and its prior alone. The parts above have films of one scale, which the phantoms state: both rules are the same there. The paper does not give these numbers; – marks a number without a result.";

/// Errors on predicted films whose lengths differ, by rule of film lengths: its words, and its cohorts by loading scenario.
#[must_use]
pub fn film_lengths(relative_sd: f64, rules: &[(&str, Vec<&Cohort>)]) -> Part {
    let mut rows = Vec::new();
    for (rule, cohorts) in rules {
        let mut add = |what: String, found: Vec<_>| {
            rows.push(ours(format!("{rule}: {what} (mm)"), "mm", found));
        };
        for role in FilmRole::PREDICTED {
            for kind in LINES {
                add(
                    format!("{role}, {kind}"),
                    cohorts.iter().map(|c| error(c, kind, role)).collect(),
                );
            }
            for kind in LINES {
                let found = cohorts.iter().map(|c| error_with_tilt(c, kind, role));
                add(format!("{role}, {kind} with tilt"), found.collect());
            }
            for baseline in Baseline::ALL {
                let found = cohorts.iter().map(|c| baseline_error(c, baseline, role));
                let name = baseline.long_name();
                add(format!("{role}, without mechanics, {name}"), found.collect());
            }
        }
    }
    let percent = with_unit(&fixed(100.0 * relative_sd, 1), "%");
    Part {
        title: format!("Films of different length (standard deviation {percent}), frontal support"),
        support: Some(Support::Frontal),
        rows,
        note: NOTE.to_owned(),
    }
}
