//! `noise-study`: the claims of the paper under landmark noise.

use spineline::cohort::Claims;
use spineline::evaluate::statistics::Share;

use crate::define::{Column, Unit, count, element, grouped, number, places, text, truth, written};
use crate::table::{NumberFormat, Table};

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
    let groups = [setting(), near(), below_mean(), better(), rod_exceeds(), curve()];
    grouped("noise_study", "scenario × support × order rule × noise", groups).fill(points)
}

const LOW: &str = "lower end of its 95 % interval";
const HIGH: &str = "upper end of its 95 % interval";
const VERDICT: &str = "whether the claim `holds`, `fails` or is `open`, by this interval and the claim's limit; empty where nothing was counted";

/// A share and its interval; a cell gets the index of the first column and of the next ones.
fn share<'a>(
    name: &str,
    meaning: &'static str,
    first: usize,
    cell: fn(&NoisePoint<'a>, usize) -> Option<f64>,
) -> [Column<NoisePoint<'a>>; 3] {
    let column = |end: &str, meaning, index| {
        written(
            NumberFormat::Places(4),
            element(&format!("{name}_share{end}"), Unit::One, meaning, first + index, cell),
        )
    };
    [column("", meaning, 0), column("_low", LOW, 1), column("_high", HIGH, 2)]
}

/// The share itself, or an end of its interval.
fn part(share: &Share, index: usize) -> f64 {
    [share.share, share.interval[0], share.interval[1]][index]
}

fn verdict(point: &NoisePoint<'_>, claim: usize) -> Option<String> {
    point.claims.verdicts()[claim].map(|verdict| verdict.key().to_owned())
}

fn setting<'a>() -> Vec<Column<NoisePoint<'a>>> {
    vec![
        truth("synthetic", "always true: the patients are phantoms", |_| Some(true)),
        text("scenario", "loading scenario of the phantoms", |row| Some(row.scenario.to_owned())),
        text("support", "`free` or `frontal`; empty where no models were made", |row| {
            row.support.map(str::to_owned)
        }),
        text("order_rule", "rule for the order of the curves", |row| Some(row.order_rule.clone())),
        number(
            "noise_sd",
            Unit::Millimetres,
            "standard deviation of a coordinate of a corner in one reading",
            |row| Some(row.noise_sd_mm),
        ),
        count("phantoms", "phantoms that were analysed", |row| Some(row.claims.patients as i64)),
        count("phantoms_lost", "phantoms that could not be made or analysed", |row| {
            Some(row.lost as i64)
        }),
    ]
}

/// Claim 1.
fn near<'a>() -> Vec<Column<NoisePoint<'a>>> {
    let mut columns: Vec<Column<NoisePoint<'a>>> =
        vec![count("phantoms_with_inflections", "phantoms with inflections", |row| {
            Some(row.claims.near.n as i64)
        })];
    columns.extend(share(
        "near",
        "share of inflections near the least-rotating segment, mean over phantoms",
        0,
        |row, index| Some(part(&row.claims.near, index)),
    ));
    columns.extend([
        places(
            "near_share_by_chance",
            Unit::One,
            "this share at random places",
            4,
            |row: &NoisePoint<'a>| Some(row.claims.near_by_chance),
        ),
        text("near_verdict", VERDICT, |row| verdict(row, 0)),
        places(
            "median_distance",
            Unit::Segments,
            "median distance of an inflection from the least-rotating segment",
            1,
            |row| Some(row.claims.median_distance_segments),
        ),
    ]);
    columns
}

/// Claim 2.
fn below_mean<'a>() -> Vec<Column<NoisePoint<'a>>> {
    let mut columns = vec![
        places(
            "mean_rotation",
            Unit::Degrees,
            "mean rotation of all segments",
            5,
            |row: &NoisePoint<'a>| Some(row.claims.rotations_deg[0]),
        ),
        places(
            "inflection_rotation",
            Unit::Degrees,
            "mean rotation of the inflections",
            5,
            |row| Some(row.claims.rotations_deg[1]),
        ),
    ];
    columns.extend(share(
        "below_mean",
        "part of the mean rotation by which the inflections rotate less",
        0,
        |row, index| match index {
            0 => Some(row.claims.below_mean),
            end => row.claims.below_mean_interval.map(|interval| interval[end - 1]),
        },
    ));
    columns.push(text("below_mean_verdict", VERDICT, |row| verdict(row, 1)));
    columns
}

/// Claim 3.
fn better<'a>() -> Vec<Column<NoisePoint<'a>>> {
    let mut columns = advantage();
    columns.extend(share(
        "better",
        "share of phantoms whose fitted films have a smaller location error with the inflection line",
        0,
        |row, index| Some(part(&row.claims.better, index)),
    ));
    columns.extend([
        text("better_verdict", VERDICT, |row| verdict(row, 2)),
        count("phantoms_compared_held_out", "phantoms with both lines on held-out films", |row| {
            Some(row.claims.better_held_out.n as i64)
        }),
    ]);
    columns.extend(share("better_held_out", "the share of held-out films", 0, |row, index| {
        Some(part(&row.claims.better_held_out, index))
    }));
    columns
}

fn advantage<'a>() -> Vec<Column<NoisePoint<'a>>> {
    let mm = Unit::Millimetres;
    let interval_end: fn(&NoisePoint<'a>, usize) -> Option<f64> =
        |row, end| row.claims.advantage_mm.1.map(|interval| interval[end]);
    vec![
        count("phantoms_compared", "phantoms with both lines on fitted films", |row| {
            Some(row.claims.better.n as i64)
        }),
        places("inflection_line_error", mm, "mean location error, inflection line", 3, |row| {
            Some(row.claims.errors_mm[0])
        }),
        places("iliac_line_error", mm, "mean location error, iliac line", 3, |row| {
            Some(row.claims.errors_mm[1])
        }),
        places("advantage", mm, "by which the inflection line's error is smaller", 3, |row| {
            Some(row.claims.advantage_mm.0)
        }),
        written(NumberFormat::Places(3), element("advantage_low", mm, LOW, 0, interval_end)),
        written(NumberFormat::Places(3), element("advantage_high", mm, HIGH, 1, interval_end)),
        written(
            NumberFormat::Scientific(3),
            number(
                "advantage_p_one_sided",
                Unit::One,
                "one-sided p value of the paired t-test with a mean per phantom",
                |row| row.claims.advantage_p,
            ),
        ),
    ]
}

/// Whether the scenario can be distinguished from a rod.
fn rod_exceeds<'a>() -> Vec<Column<NoisePoint<'a>>> {
    let meanings = [
        (
            "rod_exceeds_near",
            "how often the number of claim 1 of a rod phantom exceeds one of this scenario; 0.5: not distinguishable",
        ),
        ("rod_exceeds_below_mean", "the same for claim 2"),
        ("rod_exceeds_advantage", "the same for claim 3"),
    ];
    let columns = meanings.into_iter().enumerate().flat_map(|(claim, (name, meaning))| {
        share(name, meaning, 3 * claim, |row, index| {
            row.rod_exceeds.as_ref().map(|claims| part(&claims[index / 3], index % 3))
        })
    });
    columns.collect()
}

fn curve<'a>() -> Vec<Column<NoisePoint<'a>>> {
    vec![
        places("curve_residual", Unit::Millimetres, "mean residual of the curves", 4, |row| {
            Some(row.claims.residuals[0])
        }),
        places("curve_residual", Unit::Degrees, "mean residual of their tilts", 4, |row| {
            Some(row.claims.residuals[1])
        }),
        places("mean_order", Unit::One, "mean order of the curves", 2, |row| {
            Some(row.claims.order)
        }),
    ]
}
