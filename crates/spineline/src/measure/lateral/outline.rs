use crate::anatomy::Level;
use crate::measure::Corners;
use crate::measure::bodies::{ReadBodies, bodies_of_levels, corner_sd};
use crate::spatial::{Angle, Frontal};

/// One vertebra as a lateral film shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralVertebra {
    /// Which one.
    pub level: Level,
    /// Midpoint in the film's own frame: the first coordinate to the front, the second up the film; mm, or pixels where the
    /// film has no spacing.
    pub location: Frontal,
    /// Angle of the line through the centres of both endplates from the film's vertical; flexion positive.
    pub pitch: Angle,
    /// Angles of the normals of the superior and of the inferior endplate, as they were read.
    pub endplates: [Angle; 2],
    /// Distance between the centres of the endplates, in the unit of the location.
    pub height: f64,
    /// Mean length of the endplates, in the same unit.
    pub depth: f64,
    /// Readings that marked it.
    pub readings: usize,
}

/// The spine as a lateral film shows it: means over the readings.
#[derive(Debug, Clone, PartialEq)]
pub struct LateralOutline {
    /// The vertebrae that are marked, caudal first.
    pub vertebrae: Vec<LateralVertebra>,
    /// Standard deviation of a coordinate of a corner, mean over the readings, from how the readings differ, in the unit of the
    /// locations; `None` where nothing was read twice.
    pub corner_sd: Option<f64>,
    /// Whether its lengths are millimetres; else pixels.
    pub has_spacing: bool,
    /// Whether it was exposed together with the erect film.
    pub simultaneous: bool,
}

impl LateralOutline {
    /// Of the bodies of its readings, which were checked.
    pub(super) fn of(readings: &[ReadBodies<'_>], has_spacing: bool, simultaneous: bool) -> Self {
        let marked = bodies_of_levels(readings);
        let vertebrae = marked.iter().filter_map(|(&level, bodies)| mean_vertebra(level, bodies));
        Self {
            vertebrae: vertebrae.collect(),
            corner_sd: corner_sd(readings),
            has_spacing,
            simultaneous,
        }
    }

    /// The vertebra of a level.
    #[must_use]
    pub fn vertebra(&self, level: Level) -> Option<&LateralVertebra> {
        self.vertebrae.iter().find(|vertebra| vertebra.level == level)
    }
}

/// Means over the readings of one vertebra; `None` without any.
fn mean_vertebra(level: Level, bodies: &[(&str, &Corners<Frontal>)]) -> Option<LateralVertebra> {
    let mut all: Vec<LateralVertebra> =
        bodies.iter().filter_map(|(_, body)| seen(level, body)).collect();
    // Sums in a fixed order: the order of the readings must not reach the last bit.
    let key = |v: &LateralVertebra| [v.location.y_mm, v.location.z_mm, v.pitch.rad()];
    all.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
    let share = 1.0 / all.len() as f64;
    let mean = |of: &dyn Fn(&LateralVertebra) -> f64| all.iter().map(of).sum::<f64>() * share;
    let angle = |of: &dyn Fn(&LateralVertebra) -> Angle| {
        Angle::from_rad(mean(&|vertebra| of(vertebra).rad()))
    };
    (!all.is_empty()).then(|| LateralVertebra {
        level,
        location: Frontal::new(mean(&|v| v.location.y_mm), mean(&|v| v.location.z_mm)),
        pitch: angle(&|v| v.pitch),
        endplates: [0, 1].map(|end: usize| angle(&|v| v.endplates[end])),
        height: mean(&|v| v.height),
        depth: mean(&|v| v.depth),
        readings: all.len(),
    })
}

fn seen(level: Level, body: &Corners<Frontal>) -> Option<LateralVertebra> {
    let endplates = body.measure_endplates();
    Some(LateralVertebra {
        level,
        location: body.measure_location().ok()?,
        // A tilt to the positive side is negative.
        pitch: -body.measure_tilt(),
        endplates: [-endplates.superior, -endplates.inferior],
        height: body.height_mm(),
        depth: body.mean_width_mm(),
        readings: 1,
    })
}
