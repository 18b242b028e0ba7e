//! The study as a table: one row per scenario, support, rule and noise.

use spineline::evaluate::statistics::Share;
use spineline_tables::{TableError, rows_to_csv};

use super::study::Point;

const HEADING: [&str; 47] = [
    "synthetic",
    "truth",
    "support",
    "order_rule",
    "noise_sd_mm",
    "phantoms",
    "phantoms_lost",
    "phantoms_with_inflections",
    "near_share",
    "near_share_low",
    "near_share_high",
    "near_share_by_chance",
    "near_verdict",
    "median_distance_segments",
    "mean_rotation_deg",
    "inflection_rotation_deg",
    "below_mean_share",
    "below_mean_share_low",
    "below_mean_share_high",
    "below_mean_verdict",
    "phantoms_compared",
    "inflection_line_error_mm",
    "iliac_line_error_mm",
    "advantage_mm",
    "advantage_low_mm",
    "advantage_high_mm",
    "advantage_p_one_sided",
    "better_share",
    "better_share_low",
    "better_share_high",
    "better_verdict",
    "phantoms_compared_held_out",
    "better_held_out_share",
    "better_held_out_share_low",
    "better_held_out_share_high",
    "rod_exceeds_near_share",
    "rod_exceeds_near_share_low",
    "rod_exceeds_near_share_high",
    "rod_exceeds_below_mean_share",
    "rod_exceeds_below_mean_share_low",
    "rod_exceeds_below_mean_share_high",
    "rod_exceeds_advantage_share",
    "rod_exceeds_advantage_share_low",
    "rod_exceeds_advantage_share_high",
    "curve_residual_mm",
    "curve_residual_deg",
    "mean_order",
];

pub fn csv_text(points: &[Point]) -> Result<String, TableError> {
    rows_to_csv("noise_study", HEADING, points.iter().map(row))
}

/// A number, or nothing where there is none.
fn cell(value: f64, places: usize) -> String {
    if value.is_finite() { format!("{value:.places$}") } else { String::new() }
}

fn share(share: &Share) -> [String; 3] {
    [share.share, share.interval[0], share.interval[1]].map(|value| cell(value, 4))
}

fn interval(interval: Option<[f64; 2]>, places: usize) -> [String; 2] {
    interval.unwrap_or([f64::NAN; 2]).map(|value| cell(value, places))
}

fn row(point: &Point) -> Vec<String> {
    let claims = &point.claims;
    let verdicts =
        claims.verdicts().map(|verdict| verdict.map_or("", |verdict| verdict.key()).to_owned());
    let [near_verdict, below_verdict, better_verdict] = verdicts;
    let mut row = vec![
        "true".to_owned(),
        point.truth.key().to_owned(),
        point.way.support_name().to_owned(),
        point.way.rule_name(),
        format!("{}", point.noise_mm),
        claims.patients.to_string(),
        point.lost.to_string(),
        claims.near.n.to_string(),
    ];
    row.extend(share(&claims.near));
    row.extend([
        cell(claims.near_by_chance, 4),
        near_verdict,
        cell(claims.median_distance_segments, 1),
        cell(claims.rotations_deg[0], 5),
        cell(claims.rotations_deg[1], 5),
        cell(claims.below_mean, 4),
    ]);
    row.extend(interval(claims.below_mean_interval, 4));
    row.extend([
        below_verdict,
        claims.better.n.to_string(),
        cell(claims.errors_mm[0], 3),
        cell(claims.errors_mm[1], 3),
        cell(claims.advantage_mm.0, 3),
    ]);
    row.extend(interval(claims.advantage_mm.1, 3));
    row.push(claims.advantage_p.map_or_else(String::new, |p| format!("{p:.3e}")));
    row.extend(share(&claims.better));
    row.extend([better_verdict, claims.better_held_out.n.to_string()]);
    row.extend(share(&claims.better_held_out));
    let exceeds = point.rod_exceeds.as_ref();
    for claim in 0..3 {
        row.extend(exceeds.map_or_else(Default::default, |exceeds| share(&exceeds[claim])));
    }
    row.extend([cell(claims.residuals[0], 4), cell(claims.residuals[1], 4), cell(claims.order, 2)]);
    row
}
