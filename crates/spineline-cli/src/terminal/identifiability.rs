//! Identifiability of the multipliers as text.

use std::fmt::Write;

use spineline::analysis::{Analysis, LineModel};
use spineline::personalize::{Identifiability, MultiplierInformation, ProfileEnd};

use super::table::Table;

/// The part of a report about which multipliers the bending films identify.
pub fn text(analysis: &Analysis, found: &[Option<Identifiability>]) -> String {
    let mut text = String::from(
        "Identifiability of every multiplier from the bending films (profile likelihood; ratios to their geometric mean)\n",
    );
    for (model, found) in analysis.models.iter().zip(found) {
        match found {
            Some(found) => text.push_str(&model_text(analysis, model, found)),
            None => {
                let _ = writeln!(
                    text,
                    "\n{}: the fit did not converge, so there is no result",
                    model.kind
                );
            }
        }
    }
    text
}

fn model_text(analysis: &Analysis, model: &LineModel, found: &Identifiability) -> String {
    let prior = analysis.options.prior;
    let mut heading = vec!["Multiplier", "value", "95 % interval", "sd of ln", "verdict"];
    if prior.is_some() {
        heading.extend(["sd with prior", "of it from films"]);
    }
    let mut table = Table::new(heading);
    for ((name, value), one) in
        model.groups.names().iter().zip(model.multipliers()).zip(&found.multipliers)
    {
        let mut row = vec![
            name.replace('_', " "),
            format!("{value:.2}"),
            interval(one),
            deviation(one.log_sd),
            one.profile.verdict().to_string(),
        ];
        if let Some(prior) = prior {
            row.push(one.log_sd_with_prior.map_or_else(String::new, deviation));
            let share = one.film_share(prior.log_sd);
            row.push(share.map_or_else(String::new, |share| format!("{:.0} %", 100.0 * share)));
        }
        table.row(row);
    }
    let mut text = format!("\n{}\n{}", model.kind, table.text());
    if found.variance_factor > 1.0 {
        let times = found.variance_factor.sqrt();
        let _ = writeln!(
            text,
            "  Residuals are {times:.1} times what noise explains; intervals are widened by this factor."
        );
    }
    if let Some(weakest) = found.directions.first() {
        let what = if weakest.gauge_share > 0.9 {
            "the level of all, which the scale constraint (gauge) fixes"
        } else {
            "a ratio"
        };
        let _ = writeln!(text, "  Least known: {what} (sd of ln {}).", deviation(weakest.log_sd));
    }
    if found.multipliers.iter().any(|one| one.profile.improves()) {
        text.push_str("  A profile found a lower minimum than the fit did.\n");
    }
    text
}

fn interval(one: &MultiplierInformation) -> String {
    let end = |end: ProfileEnd, open: &str| match end {
        ProfileEnd::At(log) => format!("{:.2}", log.exp()),
        ProfileEnd::Open => open.to_owned(),
        ProfileEnd::Lost(_) => "?".to_owned(),
    };
    format!("{} to {}", end(one.profile.lower, "below 0.1"), end(one.profile.upper, "above 10"))
}

fn deviation(log_sd: f64) -> String {
    if log_sd < 100.0 { format!("{log_sd:.2}") } else { "unlimited".to_owned() }
}
