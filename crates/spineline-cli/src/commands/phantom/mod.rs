//! `spineline phantom`: synthetic patients as case files, and their films as DICOM files.

mod args;
mod films;

pub use args::PhantomArgs;

use std::collections::BTreeMap;

use serde::Serialize;
use spineline::anatomy::Region;
use spineline::number::fixed;
use spineline_files::CaseFile;
use spineline_phantom::{Build, Phantom, PhantomError, SUBJECTS, TrueFilm, generate_built};
use spineline_report::terminal::Lines;

use crate::options::phantoms::readers;
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, print};

pub const EXAMPLES: &str = "\
Examples:
  spineline phantom --out phantoms                     the paper's 18 subjects
  spineline phantom --out phantoms --subject 3 --films and their films as DICOM files
  spineline phantom --out phantoms --noise 0           without errors of readers";

/// The construction of the spines.
fn build(args: &PhantomArgs) -> Result<Build, Failure> {
    let (construction, scenario) = (args.construction, args.scenario);
    if !construction.takes(scenario) {
        let (construction, scenario) = (construction.key(), scenario.key());
        let error = PhantomError::Construction { scenario, construction };
        return Err(Failure::usage(format!("--construction {construction}: {error}")));
    }
    let percent = args.joint_sd;
    if !(0.0..=50.0).contains(&percent) {
        return Err(Failure::usage(format!("--joint-sd {percent}: expected 0 to 50 percent")));
    }
    Ok(Build { construction, joint_log_sd: 0.01 * percent })
}

pub fn run(args: &PhantomArgs) -> Result<Ending, Failure> {
    let scenario = args.scenario;
    let readers = readers(args.noise)?;
    let subjects = match args.subject {
        Some(number) if (1..=SUBJECTS.len()).contains(&number) => number..=number,
        Some(number) => {
            let text = format!(
                "--subject {number}: the paper's Table 1 has subjects 1 to {}",
                SUBJECTS.len()
            );
            return Err(Failure::usage(text));
        }
        None => 1..=SUBJECTS.len(),
    };
    let percent = args.film_length_sd;
    if !(0.0..=20.0).contains(&percent) {
        let text = format!("--film-length-sd {percent}: expected 0 to 20 percent");
        return Err(Failure::usage(text));
    }
    let build = build(args)?;
    let made = |number: usize| {
        let phantom = generate_built(number - 1, scenario, &readers, args.seed, build)?;
        let phantom = phantom.coarser(args.pixel_size);
        Ok(if percent > 0.0 {
            phantom.with_film_lengths(0.01 * percent, number - 1, args.seed)
        } else {
            phantom
        })
    };
    let phantoms: Vec<Phantom> = subjects
        .map(made)
        .collect::<Result<_, PhantomError>>()
        .map_err(|error| Failure::internal(error.to_string()))?;
    let outputs = Outputs::new(args.overwrite, []);
    outputs.folder(&args.out)?;
    let films = if args.films { films::write(&phantoms, args, &outputs)? } else { BTreeMap::new() };
    let mut text = Lines::default();
    for phantom in &phantoms {
        let path = args.out.join(format!("{}.json", phantom.case.id));
        let own = films.get(&phantom.case.id);
        let case = CaseFile::from_case(&phantom.case);
        let case = match own {
            Some(own) => films::with_files(case, own),
            None => case,
        };
        outputs.write(&path, spineline_files::to_text(&case))?;
        let truth = TruthFile { films: own.cloned(), ..TruthFile::new(phantom) };
        outputs.write(&path.with_extension("truth.json"), spineline_files::to_text(&truth))?;
        text.line(format!("{} (synthetic; its true values are beside it)", path.display()));
    }
    outputs.commit()?;
    let all: Vec<_> = films.values().flat_map(BTreeMap::values).collect();
    if !all.is_empty() {
        let mb = all.iter().map(|film| film.bytes).sum::<usize>() as f64 / 1e6;
        let films = all.len();
        text.line(format!("{films} synthetic films beside the cases, {} MB in all", fixed(mb, 0)));
    }
    print(text)
}

/// The true values of a phantom. Positive tilts are to the patient's right, as everywhere.
#[derive(Serialize)]
struct TruthFile {
    format: &'static str,
    case_id: String,
    synthetic: bool,
    scenario: &'static str,
    lateral_multipliers: BTreeMap<&'static str, f64>,
    postures: BTreeMap<&'static str, TruePosture>,
    /// Where `--films` drew them.
    #[serde(skip_serializing_if = "Option::is_none")]
    films: Option<films::Listing>,
}

#[derive(Serialize)]
struct TruePosture {
    locations_mm: Vec<[f64; 2]>,
    tilts_deg: Vec<f64>,
    inflections_mm: [[f64; 2]; 2],
    line_point_mm: Option<[f64; 2]>,
    line_direction: Option<[f64; 2]>,
    force_n: f64,
    /// A length on the film over the true one; absent where it is 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    film_scale: Option<f64>,
}

impl TruthFile {
    fn new(phantom: &Phantom) -> Self {
        let point = |p: spineline::spatial::Frontal| [p.y_mm, p.z_mm];
        #[expect(clippy::float_cmp, reason = "a film without its own scale has exactly 1")]
        let scale = |film: &TrueFilm| Some(film.scale).filter(|scale| *scale != 1.0);
        let posture = |p: &spineline_phantom::TruePosture| TruePosture {
            locations_mm: p.locations.iter().map(|&l| point(l)).collect(),
            tilts_deg: p.tilts.iter().map(|t| t.deg()).collect(),
            inflections_mm: p.inflections.map(point),
            line_point_mm: p.line.map(|line| point(line.point)),
            line_direction: p.line.map(|line| point(line.direction)),
            force_n: p.force_n,
            film_scale: phantom.film(p.posture).and_then(scale),
        };
        Self {
            format: "spineline-phantom-truth",
            case_id: phantom.case.id.clone(),
            synthetic: true,
            scenario: phantom.scenario.key(),
            lateral_multipliers: Region::ALL
                .iter()
                .map(|r| r.key())
                .zip(phantom.multipliers)
                .collect(),
            postures: phantom.postures.iter().map(|p| (p.posture.key(), posture(p))).collect(),
            films: None,
        }
    }
}
