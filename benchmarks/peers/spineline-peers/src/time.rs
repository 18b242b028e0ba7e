//! Spineline's own times, through the core's public functions.

use std::hint::black_box;
use std::time::Instant;

use serde::Serialize;
use spineline::clinical::Regions;
use spineline::measure::Outline;
use spineline::multibody::{
    BodyLoad, FittedSprings, ForceSign, GeneralStatics, JointGroups, Load, Loading, Solution,
    SpineModel, Statics, StiffnessLibrary, Support, match_amplitude,
};
use spineline::personalize::evidence::FilmEvidence;
use spineline::personalize::{FitFilm, FitSettings, Personalization, personalize};
use spineline::spatial::{Mat3, Vec3};

use crate::case::Case;

/// What an engine says of one case.
#[derive(Debug, Serialize)]
pub struct Times {
    engine: &'static str,
    version: &'static str,
    case: String,
    cannot: [&'static str; 2],
    rows: Vec<Row>,
}

/// One task done in one way.
#[derive(Debug, Default, Serialize)]
struct Row {
    task: &'static str,
    method: &'static str,
    /// Median time of one solution: of one bend, but for the personalisation, which is of both.
    seconds: f64,
    /// Why the time does not count.
    #[serde(skip_serializing_if = "Option::is_none")]
    failed: Option<&'static str>,
    /// Midpoints per bend and vertebra, to be compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    midpoints_mm: Vec<Vec<[f64; 3]>>,
    /// Forces per bend, to be compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    forces_n: Vec<f64>,
    /// Multipliers found, to be compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    multipliers: Vec<f64>,
}

/// What the other engines can and the timed functions cannot.
const CANNOT: [&str; 2] = [
    "the march is for one force on T2, along a line fixed in space or at T2; other loads need the general Newton",
    "no contact, no muscles, no dynamics, no joint but three hinges in series",
];

/// Forces vary by so much from call to call, so that no branch is learnt by heart.
const WOBBLE: f64 = 1e-3;

/// Times of all tasks.
pub fn times(case: &Case) -> Times {
    let (model, library, groups) = (case.model(), case.library(), case.groups());
    let logs = case.log_multipliers();
    let statics = Statics::new(&model, &library, &groups, &logs, Support::Free);
    // The march comes first: all others are compared with its shapes.
    let rows = vec![
        equilibrium(case, &statics),
        newton(case, &model, Start::Erect),
        newton(case, &model, Start::Near),
        amplitude(case, &statics),
        personalisation(case),
    ];
    Times {
        engine: "spineline",
        version: env!("CARGO_PKG_VERSION"),
        case: case.name.clone(),
        cannot: CANNOT,
        rows,
    }
}

/// One march per bend; it needs no start.
fn equilibrium(case: &Case, statics: &Statics<'_>) -> Row {
    let loads = case.bends.each_ref().map(|bend| (bend.load(), bend.force_n));
    let mut solution = Solution::default();
    let midpoints_mm = loads.iter().map(|(load, force_n)| {
        statics.solve(load, &[*force_n], &[], &mut solution);
        solution.deformed.midpoints_mm.iter().map(|&midpoint| midpoint.into()).collect()
    });
    let midpoints_mm = midpoints_mm.collect();
    let seconds = median_seconds(2000, 50, |i| {
        let (load, force_n) = &loads[i % 2];
        let force_n = force_n * (1.0 - WOBBLE * (i % 64) as f64 / 64.0);
        statics.solve(black_box(load), black_box(&[force_n]), &[], &mut solution);
        black_box(&solution);
    });
    Row {
        task: "equilibrium",
        method: "explicit march",
        seconds,
        midpoints_mm,
        ..Default::default()
    }
}

/// Where Newton starts.
#[derive(Clone, Copy)]
enum Start {
    /// The erect spine.
    Erect,
    /// The equilibrium at 95 % of the force.
    Near,
}

/// The general solver, which is for any load, given the same line; every call starts from the same hinge angles.
fn newton(case: &Case, model: &SpineModel, start: Start) -> Row {
    let springs = case.stiffness().map(|k| Mat3::from_diagonal(&Vec3::from(k)));
    let statics = GeneralStatics::new(model, springs, Support::Free).expect("springs are positive");
    let mut converged = true;
    let mut bends = case.bends.each_ref().map(|bend| {
        let line = BodyLoad::ForceOnLine {
            force_n: Vec3::from(bend.direction) * bend.force_n,
            point_mm: Vec3::from(bend.point_mm),
        };
        let loading = Loading::single(case.vertebrae.len() - 1, line);
        let mut work = statics.work(&loading).expect("a line can be applied to T2");
        if matches!(start, Start::Near) {
            converged &= statics.solve_near(&loading, 0.95, &mut work);
        }
        let hinges = work.hinges_mut().to_vec();
        (loading, work, hinges)
    });
    let midpoints_mm = bends.iter_mut().map(|(loading, work, _)| {
        converged &= statics.solve_near(loading, 1.0, work);
        work.midpoints_mm().iter().map(|&midpoint| midpoint.into()).collect()
    });
    let midpoints_mm = midpoints_mm.collect();
    let seconds = median_seconds(1000, 10, |i| {
        let (loading, work, hinges) = &mut bends[i % 2];
        let factor = 1.0 - WOBBLE * (i % 64) as f64 / 64.0;
        work.hinges_mut().copy_from_slice(black_box(hinges));
        black_box(statics.solve_near(loading, black_box(factor), work));
    });
    Row {
        task: match start {
            Start::Erect => "equilibrium",
            Start::Near => "equilibrium_near",
        },
        method: "general Newton",
        seconds,
        failed: (!converged).then_some("Newton did not converge"),
        midpoints_mm,
        ..Default::default()
    }
}

fn amplitude(case: &Case, statics: &Statics<'_>) -> Row {
    let goals = case.bends.each_ref().map(|bend| (bend.load(), bend.lateral_tilt()));
    let forces_n = goals
        .iter()
        .map(|(load, tilt)| match_amplitude(statics, load, ForceSign::Positive, *tilt).force_n);
    let forces_n = forces_n.collect();
    let seconds = median_seconds(1000, 10, |i| {
        let (load, tilt) = &goals[i % 2];
        let tilt = *tilt * (1.0 - WOBBLE * (i % 64) as f64 / 64.0);
        black_box(match_amplitude(statics, black_box(load), ForceSign::Positive, tilt));
    });
    Row {
        task: "amplitude",
        method: "continuation from zero",
        seconds,
        forces_n,
        ..Default::default()
    }
}

/// Everything that the fit of a case is given.
pub struct Fit {
    model: SpineModel,
    library: StiffnessLibrary,
    groups: JointGroups,
    regions: Regions,
    erect: Outline,
    films: [(Outline, Load); 2],
}

impl Fit {
    /// The fit of one case.
    pub fn of(case: &Case) -> Self {
        Self {
            model: case.model(),
            library: case.library(),
            groups: case.groups(),
            regions: case.regions(),
            erect: case.erect(),
            films: std::array::from_fn(|i| (case.bend(i), case.bends[i].load())),
        }
    }

    /// From outlines to multipliers, with the search for a start.
    pub fn run(&self) -> Personalization {
        let evidence = self.films.each_ref().map(|(outline, _)| {
            FilmEvidence::measure(&self.model, &self.library, &self.erect, outline)
        });
        let films: [FitFilm<'_>; 2] = std::array::from_fn(|i| {
            let (outline, load) = &self.films[i];
            FitFilm { outline, evidence: &evidence[i], load: *load }
        });
        let settings = FitSettings::of_shapes(&self.regions, Support::Free);
        let (model, erect, groups) = (&self.model, &self.erect, &self.groups);
        let springs = FittedSprings { model, erect, library: &self.library, groups };
        personalize(springs, &films, &settings, None)
    }
}

fn personalisation(case: &Case) -> Row {
    let fit = Fit::of(case);
    let found = fit.run();
    let seconds = median_seconds(1000, 1, |_| {
        black_box(black_box(&fit).run());
    });
    Row {
        task: "personalisation",
        method: "own start, Levenberg-Marquardt",
        seconds,
        forces_n: found.loads.iter().map(|load| load[0]).collect(),
        multipliers: found.log_multipliers.iter().map(|log| log.exp()).collect(),
        ..Default::default()
    }
}

/// Median over samples of the mean time of one call; a sample of several calls makes the clock's own time small.
fn median_seconds(samples: usize, calls: usize, mut work: impl FnMut(usize)) -> f64 {
    let mut call = 0;
    let mut means: Vec<f64> = (0..samples + samples / 10)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..calls {
                work(call);
                call += 1;
            }
            start.elapsed().as_secs_f64() / calls as f64
        })
        // The first tenth warms up.
        .skip(samples / 10)
        .collect();
    means.sort_by(f64::total_cmp);
    means[means.len() / 2]
}
