//! Effects of a lateral film, the support and coupling on left-out bends and on the line of action, on phantoms in
//! space.

use rayon::prelude::*;
use spineline::action::{LineKind, LineOfAction};
use spineline::analysis::{Analysis, AnalysisOptions, FilmRole, analyze};
use spineline::anatomy::Posture;
use spineline::multibody::{StiffnessLibrary, StiffnessTable, Support};
use spineline::spatial::{Angle, Frontal};
use spineline_phantom::{
    BentPhantom, SagittalShape, SpaceBending, SpaceSetup, generate_bends_in_space,
};

/// Compared values of a phantom's film.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    /// Left out: mean location error of the iliac line, along which the force acts, and of the estimated line.
    left_out_mm: [Option<f64>; 2],
    /// Angle between the true line and the line of best fit to the rotations.
    line: Option<Angle>,
    /// Difference of its lever arms from the true line's, as a part of the latter.
    arms: Option<f64>,
}

/// A way to model: its name, use of the lateral film and pedicles, support and springs.
struct Way {
    name: &'static str,
    in_space: bool,
    support: Support,
    library: StiffnessLibrary,
}

/// Springs that nearly lock flexion, and with axial rotation that follows lateral bending.
fn guided() -> StiffnessLibrary {
    let mut rows = StiffnessTable::Coupled.library().rows().to_vec();
    for row in &mut rows {
        row.nmm_per_rad[1] *= 1e3;
        row.nmm_per_rad[2] *= 1e3;
    }
    StiffnessLibrary::from_rows(rows).expect("positive springs")
}

fn ways() -> Vec<Way> {
    let [paper, coupled] =
        [StiffnessTable::MotionSegments, StiffnessTable::Coupled].map(|t| t.library());
    let way = |name, in_space, support, library: &StiffnessLibrary| Way {
        name,
        in_space,
        support,
        library: library.clone(),
    };
    vec![
        way("frontal", false, Support::Frontal, &paper),
        way("frontal, lateral film", true, Support::Frontal, &paper),
        way("frontal with coupled turn, lateral film", true, Support::Free, &guided()),
        way("free", false, Support::Free, &paper),
        way("free, lateral film", true, Support::Free, &paper),
        way("free, coupled", false, Support::Free, &coupled),
        way("free, coupled, lateral film", true, Support::Free, &coupled),
    ]
}

/// Support and coupling of the phantoms.
fn truths() -> Vec<(&'static str, Support, StiffnessLibrary)> {
    let [paper, coupled] =
        [StiffnessTable::MotionSegments, StiffnessTable::Coupled].map(|t| t.library());
    vec![
        ("frontal", Support::Frontal, paper.clone()),
        ("frontal with coupled turn", Support::Free, guided()),
        ("free", Support::Free, paper),
        ("free, coupled", Support::Free, coupled),
    ]
}

fn setup(seed: u64) -> SpaceSetup {
    let shapes = SagittalShape::ALL;
    SpaceSetup {
        shape: shapes[seed as usize % shapes.len()],
        largest_tilt: Angle::from_deg(18.0 + 3.0 * (seed % 4) as f64),
        apical_rotation: Angle::from_deg(10.0 + 4.0 * (seed % 3) as f64),
        pedicles: true,
        corner_sd_mm: 0.3,
        seed,
        ..SpaceSetup::default()
    }
}

fn analysis(phantom: &BentPhantom, way: &Way) -> Analysis {
    let mut case = phantom.erect.case.clone();
    if !way.in_space {
        case.lateral = None;
        let readings = case.films[0].landmarks.corner_readings_mut();
        readings[0].vertebrae.values_mut().for_each(|landmark| landmark.pedicles = [None; 2]);
    }
    let options = AnalysisOptions {
        support: way.support,
        library: way.library.clone(),
        ..AnalysisOptions::default()
    };
    analyze(&case, &options).expect("a sound case")
}

/// The true line in the frame of the film, whose origin is L4.
fn in_g(phantom: &BentPhantom, analysis: &Analysis, posture: Posture) -> Option<LineOfAction> {
    let (_, bodies, line) = phantom.bends.iter().find(|(p, ..)| *p == posture)?;
    let turn = analysis.movement.film(posture)?.outline.l4_on_film;
    let l4 = bodies[0].midpoint_mm;
    let point = (line.point - Frontal::new(l4.y, l4.z)).rotated(-turn);
    Some(LineOfAction { point, direction: line.direction.rotated(-turn), ..*line })
}

/// Angle between two lines, and difference of their lever arms about the vertebrae as a part of the first line's, after
/// both forces are scaled to agree: root mean square over root mean square.
fn compare(about: &[Frontal], one: &LineOfAction, other: &LineOfAction) -> (Angle, f64) {
    let arms = |line: &LineOfAction| -> Vec<f64> {
        about.iter().map(|&place| line.lever_arm_mm(place)).collect()
    };
    let [a, b] = [one, other].map(arms);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let rest = dot(&a, &a) - dot(&a, &b).powi(2) / dot(&b, &b);
    (one.angle_to(other), (rest / dot(&a, &a)).max(0.0).sqrt())
}

fn found(phantom: &BentPhantom, way: &Way) -> Vec<Found> {
    let analysis = analysis(phantom, way);
    let compared = analysis.comparison();
    let of_bend = |posture: Posture| {
        let film = compared
            .films
            .iter()
            .find(|film| film.posture == posture && film.role == FilmRole::LeftOutBend);
        let left_out_mm = [LineKind::Iliac, LineKind::Estimated].map(|kind| {
            let place = compared.lines.iter().position(|line| line.kind == kind)?;
            Some(film?.simulations[place].as_ref()?.shape.mean_location_error_mm())
        });
        let both = in_g(phantom, &analysis, posture).zip(
            analysis.movement.film(posture).and_then(|posture| posture.best_fit_line.as_ref()),
        );
        let locations: Vec<Frontal> = analysis
            .movement
            .film(posture)
            .map(|film| film.outline.locations().collect())
            .unwrap_or_default();
        let apart = both.map(|(line, best)| compare(&locations, &line, &best.line));
        Found { left_out_mm, line: apart.map(|a| a.0), arms: apart.map(|a| a.1) }
    };
    [Posture::LeftBending, Posture::RightBending].map(of_bend).to_vec()
}

fn phantom(
    seed: u64,
    (_, support, library): &(&str, Support, StiffnessLibrary),
) -> Option<BentPhantom> {
    let bending = SpaceBending { support: *support, library: library.clone() };
    generate_bends_in_space(&setup(seed), &bending)
}

/// Mean, its standard error, and the number of values if some are missing.
fn cell(values: impl Iterator<Item = Option<f64>>) -> String {
    let all: Vec<Option<f64>> = values.collect();
    let known: Vec<f64> = all.iter().flatten().copied().collect();
    let n = known.len() as f64;
    let mean = known.iter().sum::<f64>() / n;
    let variance = known.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let missing = if known.len() < all.len() { format!(" ({n})") } else { String::new() };
    format!("{mean:.2} ± {:.2}{missing}", (variance / n).sqrt())
}

#[test]
#[ignore = "a minute: cargo test --release -p spineline-phantom --test it space_bends -- --ignored --nocapture"]
fn what_a_lateral_film_changes_in_bends_and_lines() {
    const SEEDS: u64 = 40;
    println!(
        "| truth | model | bends | iliac line, mm | estimated line, mm | line, degrees | lever arms |"
    );
    println!("|---|---|---|---|---|---|---|");
    for truth in truths() {
        let phantoms: Vec<BentPhantom> =
            (0..SEEDS).into_par_iter().filter_map(|seed| phantom(seed, &truth)).collect();
        for way in ways() {
            let all: Vec<Found> = phantoms.par_iter().flat_map(|p| found(p, &way)).collect();
            let column = |value: &dyn Fn(&Found) -> Option<f64>| cell(all.iter().map(value));
            println!(
                "| {} | {} | {} | {} | {} | {} | {} |",
                truth.0,
                way.name,
                all.len(),
                column(&|f| f.left_out_mm[0]),
                column(&|f| f.left_out_mm[1]),
                column(&|f| f.line.map(Angle::deg)),
                column(&|f| f.arms),
            );
        }
    }
}

/// Bends have their stated size.
#[test]
fn bends_in_space_turn_as_they_should() {
    let truths = truths();
    for truth in &truths {
        let made = phantom(1, truth).expect("a force that bends");
        for ((posture, bodies, _), total_deg) in made.bends.iter().zip([42.0, 36.0]) {
            let tilt = |cranial: spineline::spatial::Vec3| {
                Angle::from_sin_cos(-cranial.y, cranial.z).deg()
            };
            let changes: Vec<f64> = bodies
                .iter()
                .map(|body| {
                    let erect = made.erect.body(body.level).expect("every level").cranial;
                    tilt(body.cranial) - tilt(erect)
                })
                .collect();
            let sum: f64 = changes.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
            assert!((sum - total_deg).abs() < 0.01, "{}, {posture:?}: {sum}", truth.0);
        }
    }
}
