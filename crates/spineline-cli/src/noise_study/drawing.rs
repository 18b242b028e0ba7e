//! The study as one figure.

use spineline::cohort::Claims;
use spineline::multibody::Support;
use spineline_phantom::Truth;
use spineline_report::figures::{NoiseCurve, NoisePanel, NoiseRow, NoiseTruth, noise_study};

use super::{NoiseStudyArgs, Point, RULES, rule_name};

pub fn svg(points: &[Point], args: &NoiseStudyArgs) -> String {
    let truths: Vec<NoiseTruth> = Truth::EVERY
        .iter()
        .map(|truth| NoiseTruth {
            name: truth.key().to_owned(),
            meaning: truth.meaning().to_owned(),
        })
        .collect();
    let row =
        |heading: &str, y_label: &str, support, limit, value: fn(&Claims) -> [f64; 3]| NoiseRow {
            heading: heading.to_owned(),
            y_label: y_label.to_owned(),
            limit_percent: 100.0 * limit,
            panels: RULES.map(|rule| panel(points, support, rule_name(rule), value, rule)).to_vec(),
        };
    let rows = [
        row(
            "Claim 1: share of inflections (INF) within 2 segments of the least-rotating one (paper: 100 %)",
            "near (%)",
            Support::Free,
            Claims::NEAR_LIMIT,
            |c| [c.near.share, c.near.interval[0], c.near.interval[1]],
        ),
        row(
            "Claim 2: how far the rotation of INF lies below the mean rotation (paper: 93 %)",
            "below mean (%)",
            Support::Free,
            Claims::BELOW_LIMIT,
            |c| {
                let [low, high] = c.below_mean_interval.unwrap_or([f64::NAN; 2]);
                [c.below_mean, low, high]
            },
        ),
        row(
            "Claim 3: share of patients with a smaller location error by the inflection line than by the iliac line",
            "better (%)",
            Support::Free,
            Claims::BETTER_LIMIT,
            better,
        ),
        row(
            "Claim 3 for a patient on a table: flexion and axial hinges locked",
            "better (%)",
            Support::Frontal,
            Claims::BETTER_LIMIT,
            better,
        ),
    ];
    let about = format!("{} patients per truth, seed {}", args.phantoms, args.seed);
    noise_study(&truths, &rows, &about, true)
}

fn better(claims: &Claims) -> [f64; 3] {
    [claims.better.share, claims.better.interval[0], claims.better.interval[1]]
}

fn panel(
    points: &[Point],
    support: Support,
    name: String,
    value: fn(&Claims) -> [f64; 3],
    rule: spineline::curve::OrderRule,
) -> NoisePanel {
    let curve = |truth: Truth| NoiseCurve {
        points: points
            .iter()
            .filter(|p| (p.truth, p.support, p.rule) == (truth, support, rule))
            .map(|p| (p.noise_mm, value(&p.claims).map(|share| 100.0 * share)))
            .collect(),
    };
    NoisePanel { name, curves: Truth::EVERY.map(curve).to_vec() }
}
