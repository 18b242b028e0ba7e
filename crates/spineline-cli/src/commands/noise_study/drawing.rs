//! The study as one figure.

use spineline::cohort::Claims;
use spineline::multibody::Support;
use spineline::warning::counted;
use spineline_phantom::Scenario;
use spineline_report::figures::{NoisePanel, NoiseRow, NoiseScenario, noise_study};

use super::args::NoiseStudyArgs;
use super::study::{Point, WAYS, Way};

pub fn svg(points: &[Point], args: &NoiseStudyArgs) -> String {
    let scenarios: Vec<NoiseScenario> = args
        .scenarios()
        .iter()
        .map(|scenario| NoiseScenario {
            name: scenario.key().to_owned(),
            meaning: scenario.to_string(),
        })
        .collect();
    let movement: Vec<Way> = WAYS.into_iter().filter(|way| way.has_movement()).collect();
    let modelled: Vec<Way> = WAYS.into_iter().filter(|way| way.support.is_some()).collect();
    let row = |heading: &str, y_label: &str, ways: &[Way], limit, value: Value| NoiseRow {
        heading: heading.to_owned(),
        y_label: y_label.to_owned(),
        limit_percent: 100.0 * limit,
        panels: ways.iter().map(|&way| panel(points, args, way, value)).collect(),
    };
    let rows = [
        row(
            "Claim 1: share of inflections (INF) within 2 segments of the least-rotating one (paper: 100 %)",
            "near (%)",
            &movement,
            Claims::NEAR_LIMIT,
            |c| [c.near.share, c.near.interval[0], c.near.interval[1]],
        ),
        row(
            "Claim 2: how far the rotation of INF lies below the mean rotation (paper: 93 %)",
            "below mean (%)",
            &movement,
            Claims::BELOW_LIMIT,
            |c| {
                let [low, high] = c.below_mean_interval.unwrap_or([f64::NAN; 2]);
                [c.below_mean, low, high]
            },
        ),
        row(
            "Claim 3: share of patients with a smaller location error by the inflection line than by the iliac line",
            "better (%)",
            &modelled,
            Claims::BETTER_LIMIT,
            |c| [c.better.share, c.better.interval[0], c.better.interval[1]],
        ),
    ];
    let about = format!("{} per scenario, seed {}", counted(args.phantoms, "patient"), args.seed);
    noise_study(&scenarios, &rows, &about, true)
}

/// A claim's number and the ends of its interval.
type Value = fn(&Claims) -> [f64; 3];

fn panel(points: &[Point], args: &NoiseStudyArgs, way: Way, value: Value) -> NoisePanel {
    let curve = |scenario: Scenario| {
        let own = points.iter().filter(|p| (p.scenario, p.way) == (scenario, way));
        own.map(|p| (p.noise_mm, value(&p.claims).map(|share| 100.0 * share))).collect()
    };
    let name = match way.support {
        Some(Support::Frontal) => format!("{}, on a table", way.rule_name()),
        _ => way.rule_name(),
    };
    NoisePanel { name, curves: args.scenarios().into_iter().map(curve).collect() }
}
