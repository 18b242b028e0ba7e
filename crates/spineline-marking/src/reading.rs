//! A reading during marking: midpoints and axes of single vertebrae, and faults as they occur.
//!
//! Places are pixels with the centre of the first one at zero. Directions are taken in the film's frontal frame
//! ([`ImageGeometry::frontal`]: millimetres, or pixels if the spacing is unknown), so that pixels need not be square.
//! An axis is stored as in [`VertebraLandmarks`](spineline::measure::VertebraLandmarks): against the image's vertical,
//! positive clockwise.

use std::collections::BTreeMap;

use spineline::anatomy::{Level, Side};
use spineline::measure::{
    CornerFault, Corners, IliacCrests, ImageGeometry, LevelStep, Origin, Placement, cranial_of,
    runs_down,
};
use spineline::spatial::{Angle, Frontal, Pixel};

use super::body_neighbours::{Unlike, far_from_bodies, unlike_neighbours};
use super::fault::MarkingFault;

/// A vertebra of which some corners are placed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PartialLandmarks {
    /// The corners that it has so far.
    pub corners: Corners<Option<Pixel>>,
    /// How they came about.
    pub origins: Corners<Origin>,
    /// The midpoints of its left and right wall, where it was marked by them.
    pub walls: [Option<Pixel>; 2],
    /// Its axis, if it was turned by hand.
    pub axis_clockwise: Option<Angle>,
}

/// All landmarks on a film so far.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PartialReading {
    /// Vertebrae with at least a corner or an axis.
    pub vertebrae: BTreeMap<Level, PartialLandmarks>,
    /// The left and the right iliac crest.
    pub crests: [Option<Pixel>; 2],
}

/// A vertebra with four corners as it is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MarkedBody {
    /// Where the diagonals cross.
    pub midpoint: Pixel,
    /// Its axis through the midpoint: caudal and cranial end of the line to draw, nine tenths of the distance between the
    /// endplates' centres to each side.
    pub axis: [Pixel; 2],
    /// The axis against the image's vertical, positive clockwise as seen.
    pub axis_clockwise: Angle,
    /// The axis as a tilt of the patient, positive to the right.
    pub tilt: Angle,
}

/// Half the drawn axis over the distance between the endplates' centres.
const AXIS_REACH: f64 = 0.9;
/// Three corners with a flatter crossing lie on one line.
const MIN_CROSSING_ANGLE: Angle = Angle::from_deg(3.0);

impl PartialLandmarks {
    /// All four corners, once they are placed.
    #[must_use]
    pub fn complete(&self) -> Option<Corners<Pixel>> {
        self.corners.complete()
    }

    /// Whether one of its corners is placed.
    #[must_use]
    pub fn has_corner(&self) -> bool {
        self.corners.points().iter().any(Option::is_some)
    }

    /// Midpoint and axis, once four corners make a body.
    #[must_use]
    pub fn body(&self, image: &ImageGeometry) -> Option<MarkedBody> {
        let corners = self.complete()?.map(|corner| image.frontal(corner));
        let midpoint = corners.measure_location().ok()?;
        let tilt = match self.axis_clockwise {
            Some(axis) => image.tilt_from_clockwise(axis),
            None => corners.measure_tilt(),
        };
        let reach = Frontal::leaning(tilt) * (AXIS_REACH * corners.height_mm());
        Some(MarkedBody {
            midpoint: image.pixel(midpoint),
            axis: [midpoint - reach, midpoint + reach].map(|end| image.pixel(end)),
            axis_clockwise: image.tilt_from_clockwise(tilt),
            tilt,
        })
    }
}

/// The axis of a vertebra turned so that its cranial end points at a place, to 0.1° and within 90° of the vertical,
/// against the image's vertical and positive clockwise; `None` if the place is the midpoint.
///
/// ```
/// use spineline::anatomy::ImageSide;
/// use spineline::measure::ImageGeometry;
/// use spineline::spatial::Pixel;
/// use spineline_marking::turn_axis_towards;
/// let image = ImageGeometry { columns: 400, rows: 500, patient_left: ImageSide::Left, spacing: None };
/// let axis = turn_axis_towards(&image, Pixel::new(100.0, 100.0), Pixel::new(110.0, 90.0)).unwrap();
/// assert!((axis.deg() - 45.0).abs() < 1e-12, "up and to the right of the picture");
/// ```
#[must_use]
pub fn turn_axis_towards(image: &ImageGeometry, midpoint: Pixel, place: Pixel) -> Option<Angle> {
    let way = image.frontal(place) - image.frontal(midpoint);
    if !way.is_finite() || way.norm_mm() == 0.0 {
        return None;
    }
    let clockwise = image.tilt_from_clockwise(way.lateral_tilt()).deg();
    Some(Angle::from_deg(((clockwise * 10.0).round() / 10.0).clamp(-90.0, 90.0)))
}

impl PartialReading {
    /// Both crests, once both are marked.
    #[must_use]
    pub fn iliac_crests(&self) -> Option<IliacCrests> {
        let [left, right] = self.crests;
        Some(IliacCrests { left: left?, right: right? })
    }

    /// All faults of the landmarks so far: vertebrae caudal first, then the crests.
    ///
    /// Three corners already show whether sides or endplates are exchanged. The steps between the bodies give the
    /// cranial direction; for a single body it is up in the picture.
    #[must_use]
    pub fn faults(&self, image: &ImageGeometry) -> Vec<MarkingFault> {
        let mut faults = Vec::new();
        let cranial = self.cranial(image);
        let mut bodies = BTreeMap::new();
        for (&level, landmark) in &self.vertebrae {
            match fault_of(image, level, landmark, cranial) {
                Some(fault) => faults.push(fault),
                None => bodies.extend(landmark.body(image).map(|body| (level, body))),
            }
        }
        let exchanged = |fault: &MarkingFault| {
            matches!(fault, MarkingFault::Corners { fault: CornerFault::SidesExchanged, .. })
        };
        let count = faults.iter().filter(|fault| exchanged(fault)).count();
        if count > 1 && bodies.is_empty() && count == self.vertebrae.len() {
            faults = vec![if runs_down(cranial) {
                MarkingFault::RowsFromBottom { count }
            } else {
                MarkingFault::Mirrored { count }
            }];
        }
        faults.extend(order_faults(image, &bodies));
        faults.extend(self.unlike_faults(image, &bodies));
        faults.extend(self.far_faults(image));
        faults.extend(self.crest_faults(image));
        faults
    }

    fn unlike_faults(
        &self,
        image: &ImageGeometry,
        bodies: &BTreeMap<Level, MarkedBody>,
    ) -> Vec<MarkingFault> {
        let shape = |(&level, body): (&Level, &MarkedBody)| {
            let corners = self.vertebrae.get(&level)?.complete()?;
            Some((level, (corners.map(|place| image.frontal(place)), body.tilt)))
        };
        let shapes = bodies.iter().filter_map(shape).collect();
        let fault = |(level, unlike)| match unlike {
            Unlike::Width(ratio) => MarkingFault::Width { level, ratio },
            Unlike::Tilt(step) => MarkingFault::Tilt { level, step },
        };
        unlike_neighbours(&shapes).into_iter().map(fault).collect()
    }

    fn far_faults(&self, image: &ImageGeometry) -> Vec<MarkingFault> {
        let (mut bodies, mut partial) = (BTreeMap::new(), BTreeMap::new());
        for (&level, landmark) in &self.vertebrae {
            if let Some(corners) = landmark.complete() {
                bodies.insert(level, corners.map(|corner| image.frontal(corner)));
                continue;
            }
            let places = landmark.corners.points().into_iter().chain(landmark.walls).flatten();
            partial.insert(level, places.map(|place| image.frontal(place)).collect());
        }
        let fault = |(level, near, ratio)| MarkingFault::Far { level, near, ratio };
        far_from_bodies(&bodies, &partial).into_iter().map(fault).collect()
    }

    /// Vertebrae with a fault.
    pub(super) fn faulty_levels(&self, image: &ImageGeometry) -> Vec<Level> {
        let cranial = self.cranial(image);
        let faulty = self
            .vertebrae
            .iter()
            .filter(|&(&level, landmark)| fault_of(image, level, landmark, cranial).is_some());
        faulty.map(|(&level, _)| level).collect()
    }

    /// A direction towards the head: the sum of the steps between the centres of the bodies.
    fn cranial(&self, image: &ImageGeometry) -> Frontal {
        let bodies = self.vertebrae.values().filter_map(PartialLandmarks::complete);
        let sum = cranial_of(bodies.map(|body| body.map(|place| image.frontal(place)).centre()));
        if sum.norm_mm() > 0.5 { sum } else { Frontal::new(0.0, 1.0) }
    }

    fn crest_faults(&self, image: &ImageGeometry) -> Vec<MarkingFault> {
        let [left, right] = self.crests;
        let off = |crest: Option<Pixel>, side| {
            crest
                .filter(|&place| !image.contains(place))
                .map(|_| MarkingFault::CrestOffPicture { side })
        };
        let exchanged = left.zip(right).filter(|&(left, right)| {
            let to_left = image.frontal(left) - image.frontal(right);
            to_left.cross(self.cranial(image)) < 0.0
        });
        let exchanged = exchanged.map(|_| MarkingFault::CrestsExchanged);
        [off(left, Side::Left), off(right, Side::Right), exchanged].into_iter().flatten().collect()
    }
}

fn fault_of(
    image: &ImageGeometry,
    level: Level,
    landmark: &PartialLandmarks,
    cranial: Frontal,
) -> Option<MarkingFault> {
    let outside = |place: &Pixel| !image.contains(*place);
    let mut places = landmark.corners.points().into_iter().chain(landmark.walls).flatten();
    if let Some(place) = places.find(outside) {
        return Some(MarkingFault::OffPicture { level, place });
    }
    let corners = landmark.corners.map(|corner| corner.map(|place| image.frontal(place)));
    match corners.complete() {
        Some(corners) => four_corners(level, corners, cranial),
        None => {
            let fault = three_corners(&corners, cranial)?;
            Some(MarkingFault::Corners { level, fault })
        }
    }
}

fn four_corners(level: Level, corners: Corners<Frontal>, cranial: Frontal) -> Option<MarkingFault> {
    let fault = match corners.measure_location() {
        Err(CornerFault::Crossed) if is_concave(&corners) => {
            return Some(MarkingFault::NotConvex { level });
        }
        Err(fault) => fault,
        Ok(_) if !corners.points_along(cranial) => CornerFault::UpsideDown,
        Ok(_) if !corners.sides_agree() => CornerFault::SidesExchanged,
        Ok(_) => return None,
    };
    Some(MarkingFault::Corners { level, fault })
}

/// A body turns in one direction at every corner; a corner within the others turns in the opposite direction.
fn is_concave(corners: &Corners<Frontal>) -> bool {
    let [a, b, d, c] = corners.points();
    let around = [a, b, c, d];
    let turns = (0..4).map(|i| {
        let (before, at, after) = (around[i], around[(i + 1) % 4], around[(i + 2) % 4]);
        (at - before).cross(after - at) > 0.0
    });
    matches!(turns.filter(|&turn| turn).count(), 1 | 3)
}

/// The fault that three corners show: they always include one endplate and one wall.
fn three_corners(corners: &Corners<Option<Frontal>>, cranial: Frontal) -> Option<CornerFault> {
    let &Corners { superior_left, superior_right, inferior_left, inferior_right } = corners;
    let way = |from: Option<Frontal>, to: Option<Frontal>| Some(to? - from?);
    let to_left =
        way(superior_right, superior_left).or_else(|| way(inferior_right, inferior_left))?;
    let up = way(inferior_left, superior_left).or_else(|| way(inferior_right, superior_right))?;
    let crossing = to_left.cross(up);
    if crossing.abs() <= MIN_CROSSING_ANGLE.rad().sin() * to_left.norm_mm() * up.norm_mm() {
        return Some(CornerFault::Flat);
    }
    if up.dot(cranial) < 0.0 {
        return Some(CornerFault::UpsideDown);
    }
    (crossing < 0.0).then_some(CornerFault::SidesExchanged)
}

fn order_faults(image: &ImageGeometry, bodies: &BTreeMap<Level, MarkedBody>) -> Vec<MarkingFault> {
    let placed: Vec<(Level, Placement)> = bodies
        .iter()
        .map(|(&level, body)| {
            let location = image.frontal(body.midpoint);
            (level, Placement::new(location, body.tilt))
        })
        .collect();
    let faults = LevelStep::between(&placed).into_iter().filter_map(|step| {
        let (inferior, superior) = (step.inferior, step.superior);
        if step.is_out_of_order() {
            return Some(MarkingFault::OutOfOrder { inferior, superior, share: step.share });
        }
        let ratio = step.ratio;
        step.is_unusual().then_some(MarkingFault::Distance { inferior, superior, ratio })
    });
    faults.collect()
}
