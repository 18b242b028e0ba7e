//! The inflections of the erect curve: chosen by hand, or found.

use super::AnalysisOptions;
use crate::anatomy::Posture;
use crate::curve::{CurveFit, InflectionChoice, Inflections, find_inflections};
use crate::warning::{WarningCode, Warnings};

/// The inflections that the options ask for, with a warning where they are not two.
pub(super) fn inflections_of(
    erect: &CurveFit,
    options: &AnalysisOptions,
    warnings: &mut Warnings,
) -> Inflections {
    let found = find_inflections(erect, options.min_curve);
    match options.inflections {
        InflectionChoice::ByHand(sites) => {
            warnings
                .push(WarningCode::InflectionsByHand, "the two inflections were chosen by hand");
            found.picked(erect, sites)
        }
        InflectionChoice::Automatic => {
            if found.all.len() != 2 {
                warn_of_inflections(&found, warnings);
            }
            found
        }
    }
}

fn warn_of_inflections(found: &Inflections, warnings: &mut Warnings) {
    let curves: Vec<String> = found.curves.iter().map(|part| part.turn.abs().text(0)).collect();
    let then = if found.pair.is_some() {
        "the pair around the largest curve is used"
    } else {
        "the inflection line is missing; the other lines are still compared"
    };
    let text = format!(
        "the erect curve has {} (curves of {}), not two: {then}",
        counted_inflections(found.all.len()),
        curves.join(", ")
    );
    warnings.film(WarningCode::InflectionsNotTwo, Posture::Erect, text);
}

/// A number of inflections in words.
pub(super) fn counted_inflections(inflections: usize) -> String {
    match inflections {
        0 => "no inflection".to_owned(),
        1 => "one inflection".to_owned(),
        n => format!("{n} inflections"),
    }
}
