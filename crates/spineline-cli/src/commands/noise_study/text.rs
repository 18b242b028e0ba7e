//! The study as text: the noise up to which every claim holds.

use spineline::cohort::{ClaimVerdict, Claims, NEAR_SEGMENTS};
use spineline::number::fixed;
use spineline::warning::counted;
use spineline_phantom::Scenario;
use spineline_report::document::Table;
use spineline_report::terminal;

use super::args::NoiseStudyArgs;
use super::study::{NOISE_MM, Point, WAYS, Way};

pub fn report(points: &[Point], args: &NoiseStudyArgs) -> String {
    let mut text = format!(
        "The paper's claims over landmark noise: {} per loading scenario (seed {}), read once at each noise of {} to {} mm \
         (standard deviation of a corner's coordinate)\n",
        counted(args.phantoms, "SYNTHETIC patient"),
        args.seed,
        NOISE_MM[0],
        NOISE_MM[NOISE_MM.len() - 1]
    );
    for scenario in args.scenarios() {
        text.push_str(&format!("  {:8} {scenario}\n", scenario.key()));
    }
    let lost: usize = points.iter().map(|point| point.lost).sum();
    if lost > 0 {
        text.push_str(&format!(
            "{lost} analyses are missing, of phantoms that could not be made or analysed.\n"
        ));
    }
    let percent = |limit: f64| 100.0 * limit;
    let near = format!(
        "Claim 1: more than {} % of inflections within {NEAR_SEGMENTS} segments of the least-rotating one",
        fixed(percent(Claims::NEAR_LIMIT), 0)
    );
    let below = format!(
        "Claim 2: inflections rotate by more than {} % less than the mean",
        fixed(percent(Claims::BELOW_LIMIT), 0)
    );
    let movement = WAYS.into_iter().filter(|way| way.has_movement());
    let movement: Vec<(String, Way)> = movement.map(|way| (way.rule_name(), way)).collect();
    text.push_str(&table(points, args, 0, &movement, &near));
    text.push_str(&table(points, args, 1, &movement, &below));
    let modelled = WAYS.into_iter().filter(|way| way.support.is_some());
    let name = |way: Way| format!("{}, {}", way.rule_name(), way.support_name());
    let modelled: Vec<(String, Way)> = modelled.map(|way| (name(way), way)).collect();
    let better = "Claim 3: the inflection line has a smaller location error than the iliac line in most patients";
    text.push_str(&table(points, args, 2, &modelled, better));
    text.push_str(&terminal::paragraph(
        "A claim holds where the whole 95 % interval over patients supports it, and fails where the whole interval contradicts it; \
         otherwise it is open. `to x mm`: holds at every noise from 0 to x. `reversed`: the opposite holds at every noise.",
        terminal::WIDTH,
        "  ",
    ));
    text
}

fn table(
    points: &[Point],
    args: &NoiseStudyArgs,
    claim: usize,
    ways: &[(String, Way)],
    title: &str,
) -> String {
    let table = Table::of(title, args.scenarios(), |add| {
        add.words("Scenario", |scenario| scenario.key());
        for (name, way) in ways {
            add.numbers(name, |&scenario| verdict(points, claim, scenario, *way));
        }
    });
    format!("\n{}", terminal::table(&table, terminal::WIDTH))
}

/// Where a claim holds, along the noise.
fn verdict(points: &[Point], claim: usize, scenario: Scenario, way: Way) -> String {
    let along: Vec<(f64, Option<ClaimVerdict>)> = points
        .iter()
        .filter(|p| (p.scenario, p.way) == (scenario, way))
        .map(|p| (p.noise_mm, p.claims.verdicts()[claim]))
        .collect();
    let holds = |verdict: &Option<ClaimVerdict>| *verdict == Some(ClaimVerdict::Holds);
    let fails = |verdict: &Option<ClaimVerdict>| *verdict == Some(ClaimVerdict::Fails);
    let last = along.iter().take_while(|(_, verdict)| holds(verdict)).last();
    match last {
        Some((noise_mm, _)) if *noise_mm == 0.0 => "at 0 mm only".to_owned(),
        Some((noise_mm, _)) => format!("to {noise_mm} mm"),
        None if along.iter().any(|(_, verdict)| holds(verdict)) => "not at 0 mm".to_owned(),
        None if along.iter().all(|(_, verdict)| fails(verdict)) => {
            if claim == 2 { "reversed" } else { "never" }.to_owned()
        }
        None => "open".to_owned(),
    }
}
