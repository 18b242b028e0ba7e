//! Bends of a spine in space: springs about three axes, a force, and the frontal films of the result.

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use spineline::action::LineOfAction;
use spineline::anatomy::{Level, Morphometry, Posture};
use spineline::multibody::{
    BodyLoad, Deformed, GeneralStatics, Goal, Loading, PathOptions, SpineModel, StiffnessLibrary,
    Support, coupled_matrix,
};
use spineline::spatial::{Frontal, Mat3, Vec3};

use super::{Marker, SpacePhantom, SpaceSetup, TrueBody, View, frontal_film, generate_in_space};

/// Support and coupling of a spine in space while a horizontal force at the midpoint of T2 bends it.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceBending {
    /// Support by the patient's surroundings.
    pub support: Support,
    /// Springs, before the phantom's own multipliers.
    pub library: StiffnessLibrary,
}

/// A phantom in space with a left and a right bend beside its erect film.
#[derive(Debug, Clone, PartialEq)]
pub struct BentPhantom {
    /// All films, and the erect bodies.
    pub erect: SpacePhantom,
    /// Posture, bodies from L4 to T2, and the line of the force in the frame of the films, of both bends.
    pub bends: Vec<(Posture, Vec<TrueBody>, LineOfAction)>,
}

/// Sum of the changes of tilt between neighbours, as on the bends of planar phantoms.
const TURNS_DEG: [f64; 2] = [42.0, 36.0];
/// Multipliers of lumbar, main thoracic and upper thoracic joints, and the standard deviation of each joint's logarithm
/// (assumptions).
const MULTIPLIERS: [f64; 3] = [1.0, 2.5, 1.3];
const JOINT_LOG_SD: f64 = 0.12;

/// Makes one; `None` if the force cannot bend it far enough.
///
/// Joints lie in the middle of the discs, three tenths of the depth of a body behind their axes, unlike in a model.
#[must_use]
pub fn generate_bends_in_space(setup: &SpaceSetup, bending: &SpaceBending) -> Option<BentPhantom> {
    let mut erect = generate_in_space(setup);
    let bodies: Vec<TrueBody> =
        Level::MODEL.iter().filter_map(|&level| erect.body(level).copied()).collect();
    let model = model_of(&bodies);
    let mut rng = ChaCha12Rng::seed_from_u64(setup.seed ^ 0x5eed);
    let own = Normal::new(0.0, JOINT_LOG_SD).expect("a positive deviation");
    let springs: Vec<Mat3> = bending
        .library
        .rows()
        .iter()
        .enumerate()
        .map(|(joint, row)| {
            let [x, y, z] = row.nmm_per_rad;
            let multiplier = MULTIPLIERS[usize::from(joint > 3) + usize::from(joint > 9)]
                * f64::exp(own.sample(&mut rng));
            coupled_matrix([x * multiplier, y, z], row.axial_per_lateral)
        })
        .collect();
    let statics = GeneralStatics::new(&model, springs, bending.support).expect("positive springs");
    let mut marker = Marker::new(setup, 1);
    let view = View::frontal(setup);
    let mut bends = Vec::new();
    for (sense, total_deg) in [1.0, -1.0].into_iter().zip(TURNS_DEG) {
        let (deformed, line) = bend(&statics, sense, total_deg)?;
        let moved = |(i, body): (usize, &TrueBody)| {
            let axes = &deformed.axes[i];
            let [anterior, left, cranial] = [0, 1, 2].map(|c| axes.column(c).into_owned());
            let midpoint_mm = deformed.midpoints_mm[i];
            TrueBody { midpoint_mm, anterior, left, cranial, ..*body }
        };
        let moved: Vec<TrueBody> = bodies.iter().enumerate().map(moved).collect();
        let read = marker.read(&view, &moved, setup.habit);
        let crests = marker.crests(&view, &erect.bodies[0]);
        let tilts = [model.midpoints_mm[14], deformed.midpoints_mm[14]]
            .map(|top| Frontal::new(top.y, top.z).lateral_tilt());
        let posture =
            if tilts[1] < tilts[0] { Posture::LeftBending } else { Posture::RightBending };
        erect.case.films.push(frontal_film(&view, posture, read, crests));
        bends.push((posture, moved, line));
    }
    (bends[0].0 != bends[1].0).then_some(BentPhantom { erect, bends })
}

fn model_of(bodies: &[TrueBody]) -> SpineModel {
    let axes = |body: &TrueBody| Mat3::from_columns(&[body.anterior, body.left, body.cranial]);
    let centres: Vec<Vec3> = bodies[..bodies.len() - 1]
        .iter()
        .map(|body| {
            let [_, half_depth, half_height] = body.half_mm;
            let disc = Morphometry::of(body.level).disc_above_mm;
            Vec3::new(-0.6 * half_depth, 0.0, half_height + 0.5 * disc)
        })
        .collect();
    SpineModel::from_poses(
        bodies.iter().map(|body| body.midpoint_mm).collect(),
        bodies.iter().map(axes).collect(),
        &centres,
    )
}

/// The shape with this turn, and the line of its force; by bisection.
fn bend(
    statics: &GeneralStatics<'_>,
    sense: f64,
    total_deg: f64,
) -> Option<(Deformed, LineOfAction)> {
    let model = statics.model();
    let erect = Deformed {
        midpoints_mm: model.midpoints_mm.clone(),
        axes: model.axes.clone(),
        hinges_rad: Vec::new(),
    };
    let turned_deg = |shape: &Deformed| -> f64 {
        let changes: Vec<f64> = (0..15).map(|i| (shape.tilt(i) - erect.tilt(i)).deg()).collect();
        changes.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum()
    };
    let (mut low_n, mut high_n) = (0.0, FIRST_N);
    let mut found = loop {
        let tried = loaded(statics, sense * high_n)?;
        if turned_deg(&tried.0) >= total_deg {
            break tried;
        }
        (low_n, high_n) = (high_n, GROWTH * high_n);
        if high_n > MOST_N {
            return None;
        }
    };
    for _ in 0..20 {
        let middle_n = f64::midpoint(low_n, high_n);
        let tried = loaded(statics, sense * middle_n)?;
        if turned_deg(&tried.0) >= total_deg {
            (high_n, found) = (middle_n, tried);
        } else {
            low_n = middle_n;
        }
    }
    Some(found)
}

/// Force steps until the spine is bent far enough.
const FIRST_N: f64 = 5.0;
const GROWTH: f64 = 1.2;
const MOST_N: f64 = 2e4;

/// The shape under a horizontal force at T2, and its line.
fn loaded(statics: &GeneralStatics<'_>, size_n: f64) -> Option<(Deformed, LineOfAction)> {
    let force_n = Vec3::y() * size_n;
    let load = BodyLoad::at_midpoint(force_n);
    let options = PathOptions { look_beyond: false, ..PathOptions::default() };
    let path = statics.follow(&Loading::single(14, load), Goal::FullLoad, &options).ok()?;
    let shape = path.result()?.deformed.clone();
    let line = LineOfAction::along_iliac(shape.location(14), None);
    Some((shape, line))
}
