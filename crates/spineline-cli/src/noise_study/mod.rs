//! `spineline noise-study`: over which landmark noise, for which rule of the curves' order and for which truth the paper's three
//! headline claims hold, on synthetic patients.
//!
//! Every patient is read once per deviation of a corner's coordinate, with the same random numbers for all deviations, and
//! analysed once per rule and support. A claim is a number over patients with an interval over patients.

mod drawing;
mod rows;
mod text;

use std::path::PathBuf;

use clap::Args;
use spineline::analysis::{AnalysisOptions, analyze, analyze_movement};
use spineline::cohort::{Claims, PatientClaims};
use spineline::curve::OrderRule;
use spineline::evaluate::statistics::Share;
use spineline::multibody::Support;
use spineline_files::{FilmOrigin, Provenance};
use spineline_phantom::{Readers, SUBJECTS, Truth, generate_read};

use crate::analyze::write_file;
use crate::args::threads;
use crate::failure::{Ending, Failure};
use crate::options::FitName;
use crate::phantom::TruthName;
use crate::print;
use crate::progress::map_all;
use crate::provenance::{in_svg, this_run, write_table};

/// Standard deviations of a corner's coordinate in one reading.
pub const NOISE_MM: [f64; 7] = [0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0];
/// How the films are analysed.
pub const WAYS: [Way; 7] = [
    Way { rule: OrderRule::LeaveOneOut, support: Some(Support::Free) },
    Way { rule: OrderRule::Paper, support: Some(Support::Free) },
    Way { rule: OrderRule::Fixed(6), support: Some(Support::Free) },
    Way { rule: OrderRule::Fixed(9), support: None },
    Way { rule: OrderRule::Fixed(12), support: None },
    Way { rule: OrderRule::LeaveOneOut, support: Some(Support::Frontal) },
    Way { rule: OrderRule::Paper, support: Some(Support::Frontal) },
];

/// One way to analyse films.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// Order of the curves.
    pub rule: OrderRule,
    /// What holds the patient; `None`: no models, which take most of the time.
    pub support: Option<Support>,
}

impl Way {
    pub fn rule_name(self) -> String {
        match self.rule {
            OrderRule::LeaveOneOut => "leave-one-out".to_owned(),
            OrderRule::Paper => "paper".to_owned(),
            OrderRule::Fixed(order) => format!("order {order}"),
        }
    }

    pub fn support_name(self) -> &'static str {
        self.support.map_or("", crate::reproduce::support_name)
    }

    /// Whether it tells of movements: those do not depend on the support, and are told once.
    pub fn tells_movement(self) -> bool {
        self.support != Some(Support::Frontal)
    }
}

/// What is studied.
#[derive(Args)]
pub struct NoiseStudyArgs {
    /// Folder for the table and the figure
    #[arg(long, value_name = "DIR", default_value = "out/noise-study")]
    pub out: PathBuf,
    /// Seed of the phantoms, of their noise and of the bootstrap
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Phantoms per truth; they take the rows of the paper's Table 1 in turn
    #[arg(long, value_name = "N", default_value_t = 36, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub phantoms: u32,
    /// Threads; 0 uses all cores. The results do not depend on it
    #[arg(long, default_value = "0", value_parser = threads)]
    pub threads: usize,
    /// What moved the phantoms, separated by commas; all if not given
    #[arg(long, value_name = "TRUTHS", value_enum, value_delimiter = ',')]
    pub truths: Vec<TruthName>,
    /// What the stiffness is fitted to; the paper fitted Ferguson angles
    #[arg(long, value_enum, default_value_t = FitName::Ferguson)]
    pub fit: FitName,
}

/// One point of a curve: what the claims are worth in one setting.
pub struct Point {
    pub truth: Truth,
    pub way: Way,
    pub noise_mm: f64,
    pub claims: Claims,
    /// Phantoms that could not be made or analysed.
    pub lost: usize,
    /// Per claim: how often a rod phantom's number exceeds that of one of this truth. 0.5: they cannot be told apart. `None`
    /// where rods are not studied.
    pub rod_exceeds: Option<[Share; 3]>,
}

pub fn run(args: &NoiseStudyArgs) -> Result<Ending, Failure> {
    let points = study(args)?;
    let table = args.out.join("noise-study.csv");
    let figure = args.out.join("noise-study.svg");
    let provenance =
        Provenance::new(this_run()?, FilmOrigin::Synthetic, Vec::new()).with_seed(args.seed);
    write_table(&table, &rows::csv_text(&points)?, &provenance)?;
    write_file(&figure, in_svg(&drawing::svg(&points, args), &provenance))?;
    print(&text::report(&points, args))?;
    print(&format!(
        "\nTable   {}\nFigure  {} (open it in a browser)\n",
        table.display(),
        figure.display()
    ))
}

/// Ways and deviations of one truth, in the order of the points.
fn settings() -> impl Iterator<Item = (Way, usize)> {
    WAYS.into_iter().flat_map(|way| (0..NOISE_MM.len()).map(move |noise| (way, noise)))
}

impl NoiseStudyArgs {
    /// What is studied, in the order of the figure.
    pub fn truths(&self) -> Vec<Truth> {
        let wanted: Vec<Truth> = self.truths.iter().map(|name| name.0).collect();
        let every = Truth::EVERY.into_iter();
        every.filter(|truth| wanted.is_empty() || wanted.contains(truth)).collect()
    }
}

fn study(args: &NoiseStudyArgs) -> Result<Vec<Point>, Failure> {
    let truths = args.truths();
    let tasks: Vec<(Truth, u32)> =
        truths.iter().flat_map(|&truth| (0..args.phantoms).map(move |i| (truth, i))).collect();
    let found = map_all("phantoms", &tasks, args.threads, |&(truth, number)| {
        of_phantom(truth, number, args)
    })?;
    let phantoms = args.phantoms as usize;
    let mut points = Vec::new();
    let mut rods: Vec<Vec<PatientClaims>> = Vec::new();
    for (truth, found) in truths.into_iter().zip(found.chunks(phantoms)) {
        for (i, (way, noise)) in settings().enumerate() {
            let patients: Vec<PatientClaims> =
                found.iter().filter_map(|claims| claims.get(i)?.clone()).collect();
            if truth == Truth::Rod {
                rods.push(patients.clone());
            }
            points.push(Point {
                truth,
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

/// Every setting of one phantom; none where it cannot be made.
fn of_phantom(truth: Truth, number: u32, args: &NoiseStudyArgs) -> Vec<Option<PatientClaims>> {
    let rows = SUBJECTS.len() as u32;
    let readers = NOISE_MM.map(|corner_sd_mm| Readers { corner_sd_mm, ..Readers::exact() });
    let subject = (number % rows) as usize;
    let Ok(read) = generate_read(subject, number / rows, truth, &readers, args.seed) else {
        return Vec::new();
    };
    let one = |(way, noise): (Way, usize)| {
        let options = AnalysisOptions {
            support: way.support.unwrap_or_default(),
            order_rule: way.rule,
            target: args.fit.target(),
            ..AnalysisOptions::default()
        };
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
