//! A spine in space under a force along the line through its inflections, the paper's Model-1: its bends, and results
//! of a model with the lateral film.

use std::collections::BTreeMap;

use spineline::action::{LineKind, LineOfAction};
use spineline::analysis::{Analysis, AnalysisOptions, Case, FilmRole, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::measure::{Film, FilmLandmarks, Placement, Reading, ReadingId, SpacingPlane};
use spineline::multibody::{
    BodyLoad, Deformed, GeneralStatics, Goal, Loading, PathOptions, SpineModel, StiffnessLibrary,
    Support, coupled_matrix,
};
use spineline::response::erect_shape;
use spineline::spatial::{Angle, Frontal, Mat3, Vec3};
use spineline_phantom::{
    Readers, SagittalShape, Scenario, SpaceSetup, generate, generate_in_space,
};

/// The material points on the line, as places among the vertebrae from L4 on: where the tilts of these spines are
/// largest.
const INFLECTIONS: [f64; 2] = [2.64, 9.91];
/// Sum of the turns of neighbours on a bend, as on the other phantoms.
const TOTAL_DEG: f64 = 40.0;

fn springs() -> Vec<Mat3> {
    let multiplier =
        |joint: usize| [1.0, 2.5, 1.3][usize::from(joint > 3) + usize::from(joint > 9)];
    let library = StiffnessLibrary::default();
    let rows = library.rows().iter().enumerate();
    rows.map(|(joint, row)| {
        let [x, y, z] = row.nmm_per_rad;
        coupled_matrix([x * multiplier(joint), y, z], 0.0)
    })
    .collect()
}

fn at(shape: &Deformed, place: f64) -> Frontal {
    let below = place.floor() as usize;
    let (low, high) = (shape.location(below), shape.location(below + 1));
    low + (high - low) * (place - below as f64)
}

/// A spine, and the last line through its inflections, by its crossings of the heights of the erect ones.
struct Bending<'a> {
    statics: GeneralStatics<'a>,
    heights_mm: [f64; 2],
    depth_mm: f64,
    sides_mm: [f64; 2],
}

impl<'a> Bending<'a> {
    fn new(model: &'a SpineModel, support: Support) -> Self {
        let erect = erect_shape(model);
        let places = INFLECTIONS.map(|place| at(&erect, place));
        Self {
            statics: GeneralStatics::new(model, springs(), support).expect("positive springs"),
            heights_mm: places.map(|place| place.z_mm),
            depth_mm: model.midpoints_mm[14].x,
            sides_mm: places.map(|place| place.y_mm),
        }
    }

    /// The shape under a force along a line, and the distances of the inflections from it.
    fn under(&self, sides_mm: [f64; 2], size_n: f64) -> Option<(Deformed, [f64; 2])> {
        let [low, high] = [0, 1].map(|i| Frontal::new(sides_mm[i], self.heights_mm[i]));
        let line = LineOfAction::through(low, high).ok()?;
        let force_n = Vec3::new(0.0, line.direction.y_mm, line.direction.z_mm) * size_n;
        let point_mm = Vec3::new(self.depth_mm, line.point.y_mm, line.point.z_mm);
        let load = BodyLoad::ForceOnLine { force_n, point_mm };
        let options = PathOptions { look_beyond: false, ..PathOptions::default() };
        let path =
            self.statics.follow(&Loading::single(14, load), Goal::FullLoad, &options).ok()?;
        let shape = path.result()?.deformed.clone();
        let off = INFLECTIONS.map(|place| line.lever_arm_mm(at(&shape, place)));
        Some((shape, off))
    }

    /// The shape whose inflections lie on the line of its force: Newton on both sides of the line.
    fn bent(&mut self, size_n: f64) -> Option<Deformed> {
        const H: f64 = 1e-3;
        for _ in 0..20 {
            let (shape, off) = self.under(self.sides_mm, size_n)?;
            if off[0].abs().max(off[1].abs()) < 1e-6 {
                return Some(shape);
            }
            let [a, b] = self.sides_mm;
            let by_a = self.under([a + H, b], size_n)?.1;
            let by_b = self.under([a, b + H], size_n)?.1;
            let (j00, j10) = ((by_a[0] - off[0]) / H, (by_a[1] - off[1]) / H);
            let (j01, j11) = ((by_b[0] - off[0]) / H, (by_b[1] - off[1]) / H);
            let determinant = j00 * j11 - j01 * j10;
            self.sides_mm[0] -= (j11 * off[0] - j01 * off[1]) / determinant;
            self.sides_mm[1] -= (j00 * off[1] - j10 * off[0]) / determinant;
            if !self.sides_mm.iter().all(|side| side.is_finite()) {
                return None;
            }
        }
        None
    }
}

/// Sum of the changes between neighbours of an angle of the vertebrae.
fn turns_deg(erect: &Deformed, shape: &Deformed, angle: fn(&Deformed, usize) -> Angle) -> f64 {
    let change = |i: usize| (angle(shape, i) - angle(erect, i)).deg();
    (0..14).map(|i| (change(i + 1) - change(i)).abs()).sum()
}

fn tilt(shape: &Deformed, vertebra: usize) -> Angle {
    shape.tilt(vertebra)
}

fn pitch(shape: &Deformed, vertebra: usize) -> Angle {
    let cranial = shape.axes[vertebra].column(2).into_owned();
    Angle::from_sin_cos(cranial.x, cranial.y.hypot(cranial.z))
}

/// Change of the lateral tilt of the line from L4 to T2.
fn leans_deg(erect: &Deformed, shape: &Deformed) -> f64 {
    (shape.location(14).lateral_tilt() - erect.location(14).lateral_tilt()).deg()
}

/// Increases a force of one sense until the spine turns far enough: the force and the shape, or else the largest force
/// that was found.
fn bend(model: &SpineModel, support: Support, sense: f64) -> Result<(f64, Deformed), f64> {
    let erect = erect_shape(model);
    let mut bending = Bending::new(model, support);
    let (mut low_n, mut size_n) = (0.0, 20.0);
    let mut found: Option<(f64, Deformed)> = None;
    while found.is_none() {
        let shape = bending.bent(sense * size_n).ok_or(low_n)?;
        if turns_deg(&erect, &shape, tilt) >= TOTAL_DEG {
            found = Some((size_n, shape));
        } else {
            (low_n, size_n) = (size_n, 1.1 * size_n);
        }
    }
    let (mut high_n, mut shape) = found.expect("the loop ends with one");
    for _ in 0..14 {
        let middle_n = f64::midpoint(low_n, high_n);
        let tried = bending.bent(sense * middle_n).ok_or(low_n)?;
        if turns_deg(&erect, &tried, tilt) >= TOTAL_DEG {
            (high_n, shape) = (middle_n, tried);
        } else {
            low_n = middle_n;
        }
    }
    // A spine that folds jumps to a much larger turn.
    if turns_deg(&erect, &shape, tilt) < 1.5 * TOTAL_DEG { Ok((high_n, shape)) } else { Err(low_n) }
}

/// The frontal film of a shape, without error.
fn film(posture: Posture, shape: &Deformed) -> Film {
    let vertebrae: BTreeMap<Level, Placement> = Level::MODEL
        .iter()
        .enumerate()
        .map(|(i, &level)| (level, Placement::new(shape.location(i), shape.tilt(i))))
        .collect();
    let readings = vec![Reading { id: ReadingId::new("A", 1), vertebrae }];
    Film::new(posture, FilmLandmarks::placed(SpacingPlane::Patient, readings))
}

/// Fitted and left-out bends: number of results out of two each, and mean location error.
fn cell(analysis: &Analysis, kind: LineKind, role: FilmRole) -> String {
    let compared = analysis.comparison();
    let Some(place) = compared.lines.iter().position(|line| line.kind == kind) else {
        return "no model".to_owned();
    };
    let films = compared.films.iter().filter(|film| film.role == role);
    let errors: Vec<f64> = films
        .filter_map(|film| Some(film.simulations[place].as_ref()?.shape.mean_location_error_mm()))
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    if errors.is_empty() { "none".to_owned() } else { format!("{mean:.2} ({})", errors.len()) }
}

fn spines() -> impl Iterator<Item = (String, Case, Analysis)> {
    SagittalShape::ALL.into_iter().flat_map(|shape| {
        [20.0, 27.0].map(|tilt_deg| {
            let setup = SpaceSetup {
                shape,
                largest_tilt: Angle::from_deg(tilt_deg),
                apical_rotation: Angle::from_deg(12.0),
                pedicles: true,
                ..SpaceSetup::default()
            };
            let case = generate_in_space(&setup).case;
            let analysis = analyze(&case, &AnalysisOptions::default()).expect("a sound case");
            (format!("{shape:?}, {tilt_deg}°"), case, analysis)
        })
    })
}

/// Results of models with the line through the inflections and with the iliac line on two bends, with and without the
/// lateral film.
fn models(case: &Case, support: Support, [left, right]: [&Deformed; 2]) -> [String; 2] {
    let mut case = case.clone();
    case.films.truncate(1);
    case.films.push(film(Posture::LeftBending, left));
    case.films.push(film(Posture::RightBending, right));
    let options = AnalysisOptions { support, ..AnalysisOptions::default() };
    let mut row = |in_space: bool| {
        if !in_space {
            case.lateral = None;
        }
        let found = match analyze(&case, &options) {
            Ok(found) => found,
            Err(error) => return format!("{in_space} | {error} | | |"),
        };
        let of = |kind| {
            let [fitted, left_out] = [FilmRole::Fitted, FilmRole::LeftOutBend];
            format!("{} | {}", cell(&found, kind, fitted), cell(&found, kind, left_out))
        };
        format!("{in_space} | {} | {}", of(LineKind::Inflection), of(LineKind::Iliac))
    };
    [row(true), row(false)]
}

#[test]
#[ignore = "half a minute: cargo test --release -p spineline-phantom --test it inflection_force -- --ignored --nocapture"]
fn what_a_force_through_the_inflections_does_in_space() {
    println!("| spine | support | sense | force, N | L4 to T2 leans by, ° | turns of flexion, ° |");
    println!("|---|---|---|---|---|---|");
    let mut rows = String::new();
    for (name, case, analysis) in spines() {
        let erect = erect_shape(&analysis.movement.spine);
        for support in [Support::Frontal, Support::Free] {
            let mut bends = Vec::new();
            for sense in [1.0, -1.0] {
                let words = match bend(&analysis.movement.spine, support, sense) {
                    Ok((size_n, shape)) => {
                        let leans = leans_deg(&erect, &shape);
                        let flexion = turns_deg(&erect, &shape, pitch);
                        bends.push((leans, shape));
                        format!("{size_n:.0} | {leans:.1} | {flexion:.0}")
                    }
                    Err(size_n) => format!("folds above {size_n:.0} | |"),
                };
                println!("| {name} | {support:?} | {sense:+} | {words} |");
            }
            // The bend with the larger tilt to the right is the right one, however small the difference.
            bends.sort_by(|a, b| a.0.total_cmp(&b.0));
            if let [(_, left), (_, right)] = &bends[..] {
                for row in models(&case, support, [left, right]) {
                    rows.push_str(&format!("| {name} | {support:?} | {row} |\n"));
                }
            }
        }
    }
    println!(
        "\n| spine | support | lateral film | Model-1 fitted | left out | Model-2 fitted | left out |\n|---|---|---|---|---|---|---|\n{rows}"
    );
}

/// Lateral tilt of bends of planar phantoms, whose force also runs through their inflections.
#[test]
#[ignore = "for comparison with the study above"]
fn rods_in_the_plane_lean() {
    for subject in 0..18 {
        let Ok(phantom) = generate(subject, Scenario::Rod, &Readers::exact(), 1) else { continue };
        let found = analyze(&phantom.case, &AnalysisOptions::default()).expect("a phantom");
        let amplitude = |posture| found.movement.film(posture).map(|p| p.outline.amplitude().deg());
        let erect = amplitude(Posture::Erect).expect("erect");
        let leans = [Posture::LeftBending, Posture::RightBending]
            .map(|posture| amplitude(posture).map(|deg| ((deg - erect) * 10.0).round() / 10.0));
        println!("{subject}: {leans:?}");
    }
}

/// The force acts nearly along a spine: it bends it within its curves, hardly tilts it, and flexes it if it is free.
#[test]
fn a_force_through_the_inflections_hardly_leans_a_spine_and_flexes_a_free_one() {
    let (_, _, analysis) = spines().last().expect("a spine");
    let erect = erect_shape(&analysis.movement.spine);
    for support in [Support::Frontal, Support::Free] {
        let mut bending = Bending::new(&analysis.movement.spine, support);
        let shape = bending.bent(100.0).expect("a small force");
        let off = bending.under(bending.sides_mm, 100.0).expect("the same force").1;
        assert!(
            off[0].abs().max(off[1].abs()) < 1e-6,
            "both inflections lie on the line of the force"
        );
        let turned = turns_deg(&erect, &shape, tilt);
        let leans = leans_deg(&erect, &shape).abs();
        assert!(turned > 3.0 && leans < 0.15 * turned, "{turned}° of turns lean it by {leans}°");
        let flexed = turns_deg(&erect, &shape, pitch);
        assert_eq!(flexed > turned, support == Support::Free, "{support:?}: {flexed}°");
    }
}
