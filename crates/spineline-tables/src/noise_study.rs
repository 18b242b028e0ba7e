//! `noise-study`: the claims of the paper under landmark noise.

use spineline::cohort::Claims;
use spineline::evaluate::statistics::Share;

use crate::define::{Columns, ENDS_95, table};
use crate::table::{NumberFormat, NumberFormat::Places, Table};

/// The claims in one setting of the study.
#[derive(Debug, Clone)]
pub struct NoisePoint<'a> {
    /// Loading scenario of the phantoms.
    pub scenario: &'static str,
    /// Support of the patient in the models; `None` where no model was made.
    pub support: Option<&'static str>,
    /// Rule for the order of the curves.
    pub order_rule: String,
    /// Standard deviation of a coordinate of a corner in one reading.
    pub noise_sd_mm: f64,
    /// The claims.
    pub claims: &'a Claims,
    /// Phantoms that could not be made or analysed.
    pub lost: usize,
    /// Per claim: how often the number of a rod phantom exceeds one of this scenario; `None` where rods are not studied.
    pub rod_exceeds: Option<[Share; 3]>,
}

/// One row per scenario, support, rule and noise.
#[must_use]
pub fn noise_study_table(points: &[NoisePoint<'_>]) -> Table {
    table("noise_study", "scenario × support × order rule × noise", points, |add| {
        setting(add);
        near(add);
        below_mean(add);
        better(add);
        rod_exceeds(add);
        curve(add);
    })
}

type Points<'r, 'a> = Columns<'r, NoisePoint<'a>>;

const VERDICT: &str = "whether the claim `holds`, `fails` or is `open`, by this interval and the claim's limit; empty where nothing was counted";

/// A share and its interval.
fn share(
    add: &mut Points<'_, '_>,
    name: &str,
    meaning: &'static str,
    share: impl Fn(&NoisePoint<'_>) -> Option<(f64, Option<[f64; 2]>)>,
) {
    let place = Places(4);
    add.number(&format!("{name}_share"), meaning, |row| Some(share(row)?.0)).format = place;
    for (end, (name_of_end, meaning)) in ["low", "high"].into_iter().zip(ENDS_95).enumerate() {
        let name = format!("{name}_share_{name_of_end}");
        add.number(&name, meaning, |row| Some(share(row)?.1?[end])).format = place;
    }
}

const fn with_interval(share: &Share) -> Option<(f64, Option<[f64; 2]>)> {
    Some((share.share, Some(share.interval)))
}

fn verdict(add: &mut Points<'_, '_>, name: &str, claim: usize) {
    add.text(name, VERDICT, |row| row.claims.verdicts()[claim].map(|verdict| verdict.key()));
}

fn setting(add: &mut Points<'_, '_>) {
    add.truth("synthetic", "always true: the patients are phantoms", |_| true);
    add.text("scenario", "loading scenario of the phantoms", |row| row.scenario);
    add.text("support", "`free` or `frontal`; empty where no models were made", |row| row.support);
    add.text("order_rule", "rule for the order of the curves", |row| row.order_rule.clone());
    add.number(
        "noise_sd_mm",
        "standard deviation of a coordinate of a corner in one reading",
        |row| row.noise_sd_mm,
    );
    add.count("phantoms", "phantoms that were analysed", |row| row.claims.patients);
    add.count("phantoms_lost", "phantoms that could not be made or analysed", |row| row.lost);
}

/// Claim 1.
fn near(add: &mut Points<'_, '_>) {
    add.count("phantoms_with_inflections", "phantoms with inflections", |row| row.claims.near.n);
    share(
        add,
        "near",
        "share of inflections near the least-rotating segment, mean over phantoms",
        |row| with_interval(&row.claims.near),
    );
    add.number("near_share_by_chance", "this share at random places", |row| {
        row.claims.near_by_chance
    })
    .format = Places(4);
    verdict(add, "near_verdict", 0);
    add.number(
        "median_distance_segments",
        "median distance of an inflection from the least-rotating segment",
        |row| row.claims.median_distance_segments,
    )
    .format = Places(1);
}

/// Claim 2.
fn below_mean(add: &mut Points<'_, '_>) {
    let rotations = [
        ("mean_rotation_deg", "mean rotation of all segments"),
        ("inflection_rotation_deg", "mean rotation of the inflections"),
    ];
    for (place, (name, meaning)) in rotations.into_iter().enumerate() {
        add.number(name, meaning, |row| row.claims.rotations_deg[place]).format = Places(5);
    }
    share(
        add,
        "below_mean",
        "part of the mean rotation by which the inflections rotate less",
        |row| Some((row.claims.below_mean, row.claims.below_mean_interval)),
    );
    verdict(add, "below_mean_verdict", 1);
}

/// Claim 3.
fn better(add: &mut Points<'_, '_>) {
    advantage(add);
    share(
        add,
        "better",
        "share of phantoms with a smaller location error of the fitted films with the inflection line",
        |row| with_interval(&row.claims.better),
    );
    verdict(add, "better_verdict", 2);
    add.count("phantoms_compared_held_out", "phantoms with both lines on held-out films", |row| {
        row.claims.better_held_out.n
    });
    share(add, "better_held_out", "the share of held-out films", |row| {
        with_interval(&row.claims.better_held_out)
    });
}

fn advantage(add: &mut Points<'_, '_>) {
    add.count("phantoms_compared", "phantoms with both lines on fitted films", |row| {
        row.claims.better.n
    });
    let mut number = |name, meaning, cell: fn(&NoisePoint<'_>) -> Option<f64>| {
        add.number(name, meaning, cell).format = Places(3);
    };
    number("inflection_line_error_mm", "mean location error, inflection line", |row| {
        Some(row.claims.errors_mm[0])
    });
    number("iliac_line_error_mm", "mean location error, iliac line", |row| {
        Some(row.claims.errors_mm[1])
    });
    number("advantage_mm", "by which the inflection line's error is smaller", |row| {
        Some(row.claims.advantage_mm.0)
    });
    number("advantage_low_mm", ENDS_95[0], |row| Some(row.claims.advantage_mm.1?[0]));
    number("advantage_high_mm", ENDS_95[1], |row| Some(row.claims.advantage_mm.1?[1]));
    add.number(
        "advantage_p_one_sided",
        "one-sided p value of the paired t-test with a mean per phantom",
        |row| row.claims.advantage_p,
    )
    .format = NumberFormat::Scientific(3);
}

/// Whether the scenario can be distinguished from a rod.
fn rod_exceeds(add: &mut Points<'_, '_>) {
    let meanings = [
        (
            "rod_exceeds_near",
            "how often the number of claim 1 of a rod phantom exceeds one of this scenario; 0.5: not distinguishable",
        ),
        ("rod_exceeds_below_mean", "the same for claim 2"),
        ("rod_exceeds_advantage", "the same for claim 3"),
    ];
    for (claim, (name, meaning)) in meanings.into_iter().enumerate() {
        share(add, name, meaning, |row| with_interval(&row.rod_exceeds.as_ref()?[claim]));
    }
}

fn curve(add: &mut Points<'_, '_>) {
    add.number("curve_residual_mm", "mean residual of the curves", |row| row.claims.residuals[0])
        .format = Places(4);
    add.number("curve_residual_deg", "mean residual of their tilts", |row| {
        row.claims.residuals[1]
    })
    .format = Places(4);
    add.number("mean_order", "mean order of the curves", |row| row.claims.order).format = Places(2);
}
