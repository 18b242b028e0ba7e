//! Numbers of analysis files before a change of structure, which must not move them.
//!
//! This does not show that a number is right. A change that moves numbers writes `goldens.txt` again in a separate commit, and its
//! decision record says why: `SPINELINE_WRITE_GOLDENS=1 cargo nextest run --workspace -E 'test(goldens)'`.

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;
use spineline::analysis::{AnalysisOptions, Case, Grouping, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::measure::{FilmLandmarks, TiltRule};
use spineline::multibody::Support;
use spineline::personalize::{FitTarget, Gauge, LogNormalPrior};
use spineline::uncertainty::{LandmarkNoise, MonteCarlo};
use spineline_files::method_text::set_option;
use spineline_files::{AnalysisFile, CaseFile, FilmOrigin, Provenance, Request, to_text};
use spineline_phantom::{Readers, Scenario, SpaceSetup, generate, generate_in_space};

use super::repeat::run;

/// Parts of a number's section by which it may differ from the stored one.
const TOLERANCE: f64 = 1e-12;

/// Numbers of one section of a file, in their order, without their keys, which may be renamed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Section {
    count: usize,
    /// Sum of the compressed numbers, each with the weight of its place, so that two exchanged numbers differ.
    weighted: f64,
    /// Sum of their magnitudes, against which the tolerance counts.
    magnitude: f64,
}

impl Section {
    fn of(value: &Value) -> Self {
        let mut section = Self::default();
        section.add(value);
        section
    }

    fn add(&mut self, value: &Value) {
        match value {
            Value::Number(number) => {
                // Compressed, so that no large number hides small ones.
                let number = number.as_f64().expect("a double").asinh();
                self.count += 1;
                let weight = 1.0 + (self.count as f64 * 0.618_033_988_749_895).fract();
                self.weighted += weight * number;
                self.magnitude += number.abs();
            }
            Value::Array(all) => all.iter().for_each(|one| self.add(one)),
            Value::Object(all) => all.values().for_each(|one| self.add(one)),
            _ => {}
        }
    }

    fn is_near(&self, stored: &Self) -> bool {
        self.count == stored.count
            && (self.weighted - stored.weighted).abs() <= TOLERANCE * stored.magnitude
    }
}

fn rod() -> Case {
    generate(3, Scenario::Rod, &Readers::default(), 1).expect("subject 4 exists").case
}

/// Without a scale on any film.
fn pixels_only() -> Case {
    let mut case = rod();
    for film in &mut case.films {
        let FilmLandmarks::Corners { image, .. } = &mut film.landmarks else { continue };
        image.spacing = None;
    }
    case
}

/// T2 and T3 are above the picture of the neutral film.
fn hidden_top() -> Case {
    let mut case = rod();
    for film in case.films.iter_mut().filter(|film| film.posture == Posture::Neutral) {
        let readings = film.landmarks.corner_readings_mut();
        readings.iter_mut().for_each(|one| one.vertebrae.retain(|level, _| *level < Level::T3));
    }
    case
}

/// Every way through the method: the name of the case, the case, and its options.
fn cases() -> Vec<(&'static str, Case, AnalysisOptions)> {
    let default = AnalysisOptions::default;
    let known = Gauge::KnownForce { posture: Posture::LeftBending, force_n: 60.0 };
    let paper = AnalysisOptions {
        tilt: TiltRule::Axis,
        support: Support::Free,
        target: FitTarget::Ferguson,
        ..default()
    };
    let prior = Some(LogNormalPrior::IN_VIVO);
    let mut all_loads = default();
    set_option(&mut all_loads, "compare_models", "all").expect("a known option");
    vec![
        ("default", rod(), default()),
        ("pixels only", pixels_only(), default()),
        ("hidden top", hidden_top(), default()),
        ("lateral film", generate_in_space(&SpaceSetup::default()).case, default()),
        ("tilts by axes, free support, Ferguson angles", rod(), paper),
        ("known force", rod(), AnalysisOptions { gauge: known, ..default() }),
        ("prior", rod(), AnalysisOptions { prior, ..default() }),
        ("per joint", rod(), AnalysisOptions { grouping: Grouping::PerJoint, prior, ..default() }),
        ("other loads", rod(), all_loads),
    ]
}

/// Every section of every file.
fn sections() -> Vec<(String, Section)> {
    let mut found = Vec::new();
    for (name, case, options) in cases() {
        let analysis = analyze(&case, &options).expect(name);
        let request = Request { options, ..Request::default() };
        let provenance = Provenance::new(run(), FilmOrigin::Synthetic, Vec::new()).asking(&request);
        let mut file = AnalysisFile::new(&analysis, CaseFile::from_case(&case), provenance);
        if name == "default" {
            let noise = LandmarkNoise::Pixels(2.0);
            let replicates = MonteCarlo::new(&case, &analysis, noise, 1).expect("sound noise");
            let mut tally = replicates.tally();
            (0..40).for_each(|index| tally.add(&replicates.replicate(index)));
            file = file.with_uncertainty(&analysis, Some(&tally.finish(40)));
            let found: Vec<_> =
                analysis.models.iter().map(|model| analysis.identifiability(model)).collect();
            file = file.with_identifiability(&analysis, Some(&found));
        }
        let json: Value = serde_json::from_str(&to_text(&file)).expect("JSON");
        let all = json.as_object().expect("a file");
        let computed =
            all.iter().filter(|(key, _)| !["case", "provenance"].contains(&key.as_str()));
        found.extend(computed.map(|(key, value)| (format!("{name}: {key}"), Section::of(value))));
    }
    found.retain(|(_, section)| section.count > 0);
    found
}

#[test]
fn a_change_of_structure_moves_no_number() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/goldens.txt");
    let now = sections();
    let mut text = String::from(
        "# Section: numbers, their weighted sum, the sum of their magnitudes. Synthetic.\n",
    );
    for (name, one) in &now {
        writeln!(text, "{name} = {} {:?} {:?}", one.count, one.weighted, one.magnitude)
            .expect("a text");
    }
    if std::env::var_os("SPINELINE_WRITE_GOLDENS").is_some() {
        fs::write(path, &text).expect("the stored numbers");
    }
    let stored = fs::read_to_string(path).expect("the stored numbers");
    let stored: Vec<(&str, Section)> = stored
        .lines()
        .filter_map(|line| line.split_once(" = "))
        .map(|(name, numbers)| {
            let numbers: Vec<&str> = numbers.split(' ').collect();
            let number = |i: usize| numbers[i].parse().expect("a number");
            let count = numbers[0].parse().expect("a count");
            (name, Section { count, weighted: number(1), magnitude: number(2) })
        })
        .collect();
    let moved: Vec<String> = now
        .iter()
        .filter(|(name, one)| {
            !stored.iter().any(|(known, then)| known == name && one.is_near(then))
        })
        .map(|(name, _)| name.clone())
        .collect();
    assert!(moved.is_empty() && stored.len() == now.len(), "moved: {moved:#?}");
}
