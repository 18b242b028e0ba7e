//! Synthetic patients read with noise and analysed in several ways.

use spineline::analysis::{AnalysisOptions, analyze, analyze_movement};
use spineline::cohort::{Claims, PatientClaims};
use spineline::curve::OrderRule;
use spineline::evaluate::statistics::Share;
use spineline::multibody::Support;
use spineline_phantom::{Readers, SUBJECTS, Scenario, generate_read};
use spineline_tables::NoisePoint;

use super::args::NoiseStudyArgs;
use crate::options::phantoms::options_of;
use crate::run::failure::Failure;
use crate::run::threads::map_all;

/// Standard deviations of a corner's coordinate in one reading.
pub const NOISE_MM: [f64; 7] = [0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0];
/// How the films are analysed.
pub const WAYS: [Way; 7] = [
    Way { rule: OrderRule::LeaveOneOut, support: Some(Support::Free) },
    Way { rule: OrderRule::TwoInflections, support: Some(Support::Free) },
    Way { rule: OrderRule::Fixed(6), support: Some(Support::Free) },
    Way { rule: OrderRule::Fixed(9), support: None },
    Way { rule: OrderRule::Fixed(12), support: None },
    Way { rule: OrderRule::LeaveOneOut, support: Some(Support::Frontal) },
    Way { rule: OrderRule::TwoInflections, support: Some(Support::Frontal) },
];

/// One way to analyse films.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    pub rule: OrderRule,
    /// What holds the patient; `None`: no models, which take most of the time.
    pub support: Option<Support>,
}

impl Way {
    pub fn rule_name(self) -> String {
        match self.rule {
            OrderRule::LeaveOneOut => "leave-one-out".to_owned(),
            OrderRule::Paper => "paper".to_owned(),
            OrderRule::TwoInflections => "two-inflections".to_owned(),
            OrderRule::Fixed(order) => format!("order {order}"),
        }
    }

    pub fn support_name(self) -> &'static str {
        self.support.map_or("", Support::key)
    }

    /// Whether movements are reported for it: they do not depend on the support and are reported once.
    pub fn has_movement(self) -> bool {
        self.support != Some(Support::Frontal)
    }
}

/// The claims in one setting: one point of a curve.
pub struct Point {
    pub scenario: Scenario,
    pub way: Way,
    pub noise_mm: f64,
    pub claims: Claims,
    /// Phantoms that could not be made or analysed.
    pub lost: usize,
    /// Per claim: how often the number of a rod phantom exceeds one of this scenario. 0.5: they cannot be distinguished. `None`
    /// where rods are not studied.
    pub rod_exceeds: Option<[Share; 3]>,
}

impl Point {
    pub fn row(&self) -> NoisePoint<'_> {
        NoisePoint {
            scenario: self.scenario.key(),
            support: self.way.support.map(Support::key),
            order_rule: self.way.rule_name(),
            noise_sd_mm: self.noise_mm,
            claims: &self.claims,
            lost: self.lost,
            rod_exceeds: self.rod_exceeds,
        }
    }
}

/// Ways and noises of one scenario, in the order of the points.
fn settings() -> impl Iterator<Item = (Way, usize)> {
    WAYS.into_iter().flat_map(|way| (0..NOISE_MM.len()).map(move |noise| (way, noise)))
}

/// Analyses every patient in every setting.
pub fn study(args: &NoiseStudyArgs) -> Result<Vec<Point>, Failure> {
    let scenarios = args.scenarios();
    let tasks: Vec<(Scenario, u32)> = scenarios
        .iter()
        .flat_map(|&scenario| (0..args.phantoms).map(move |i| (scenario, i)))
        .collect();
    let found = map_all("phantoms", &tasks, args.threads, |&(scenario, number)| {
        of_phantom(scenario, number, args)
    })?;
    let phantoms = args.phantoms as usize;
    let mut points = Vec::new();
    let mut rods: Vec<Vec<PatientClaims>> = Vec::new();
    for (scenario, found) in scenarios.into_iter().zip(found.chunks(phantoms)) {
        for (i, (way, noise)) in settings().enumerate() {
            let patients: Vec<PatientClaims> =
                found.iter().filter_map(|claims| claims.get(i)?.clone()).collect();
            if scenario == Scenario::Rod {
                rods.push(patients.clone());
            }
            points.push(Point {
                scenario,
                way,
                noise_mm: NOISE_MM[noise],
                claims: Claims::of(&patients, args.seed),
                lost: phantoms - patients.len(),
                rod_exceeds: rods.get(i).map(|rods| exceeds(rods, &patients)),
            });
        }
    }
    Ok(points)
}

/// Every setting of one phantom; empty if it cannot be made.
fn of_phantom(
    scenario: Scenario,
    number: u32,
    args: &NoiseStudyArgs,
) -> Vec<Option<PatientClaims>> {
    let rows = SUBJECTS.len() as u32;
    let readers = NOISE_MM.map(|corner_sd_mm| Readers { corner_sd_mm, ..Readers::exact() });
    let subject = (number % rows) as usize;
    let Ok(read) = generate_read(subject, number / rows, scenario, &readers, args.seed) else {
        return Vec::new();
    };
    let one = |(way, noise): (Way, usize)| {
        let of_support = options_of(way.support.unwrap_or_default(), args.fit);
        let options = AnalysisOptions { order_rule: way.rule, ..of_support };
        let run = if way.support.is_some() { analyze } else { analyze_movement };
        Some(PatientClaims::of(&run(&read[noise].case, &options).ok()?))
    };
    settings().map(one).collect()
}

fn exceeds(rods: &[PatientClaims], others: &[PatientClaims]) -> [Share; 3] {
    let by = |value: &dyn Fn(&PatientClaims) -> Option<f64>| {
        let numbers = |all: &[PatientClaims]| all.iter().filter_map(value).collect::<Vec<f64>>();
        Share::of_exceeding(&numbers(rods), &numbers(others))
    };
    [
        by(&PatientClaims::near),
        by(&PatientClaims::below_mean),
        by(&|patient| patient.advantage_mm(true)),
    ]
}
