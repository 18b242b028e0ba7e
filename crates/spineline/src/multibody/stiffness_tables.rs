//! Published springs of the joints, by name.

use super::{JointStiffness, StiffnessLibrary};
use crate::anatomy::{Level, SourceCheck, named};
use crate::spatial::Angle;

named! {
    /// A table of springs before personalisation.
    ///
    /// Only the ratios between joints change a personalised model of relative stiffness; absolute values count where a force is
    /// known. `validation/stiffness.md` sets the range of motion of every table beside measured spines.
    #[default(MotionSegments)]
    pub enum StiffnessTable {
        /// Motion segments without ribs, as models of scoliotic spines take them. The paper prints no stiffness.
        ///
        /// Thoracic: the 6 × 6 matrix of [desroches-2007]
        /// after [panjabi-1976]. Lumbar: [schmidt-1998], normal discs, as compiled in [ammr-repository]; flexion is the mean of
        /// flexion and extension. T12/L1: mean of its neighbours (assumption).
        MotionSegments = "motion_segments",
        /// Thoracic segments with costovertebral joints, tested in vitro.
        ///
        /// Without the cage of ribs: 7.5 N·m over half of the range of
        /// motion of [wilke-2017], whose middle is taken. Lumbar as in [`Self::MotionSegments`].
        InVitro = "in_vitro",
        /// The same with the cage of ribs.
        ///
        /// Its removal raises the thoracic range of motion by 63.5 % in lateral bending, 63 % in
        /// flexion and extension and 58.8 % in axial rotation [liebsch-2018].
        IntactChest = "intact_chest",
        /// Segments of scoliotic patients during surgery.
        ///
        /// 0.18 °/(N·m) in lateral bending [reutlinger-2012], which is taken for
        /// every joint; flexion and axial stiffness in the ratio of [`Self::MotionSegments`] (assumptions).
        ScolioticInVivo = "scoliotic_in_vivo",
        /// The motion segments, with axial rotation coupled to lateral bending (counts with free support).
        ///
        /// Thoracic joints turn to the side of the bend
        /// [willems-1996], by 0.4 of it [fujimori-2014] (unverified). T12/L1 turns away from it by 0.5, and the joints below by less and less
        /// [lumbar-coupling-2009]; linear from there to L5/S1 (assumption).
        Coupled = "coupled",
    }
}

impl StiffnessTable {
    /// Springs of all joints.
    ///
    /// ```
    /// use spineline::multibody::StiffnessTable;
    /// use spineline::spatial::Angle;
    /// let library = StiffnessTable::InVitro.library();
    /// // T7 on T8 in lateral bending: 7.5 N·m turn it by 4.25° to one side, half of 8 to 9°.
    /// let joint = library.rows().iter().find(|row| row.superior.name() == "T7").unwrap();
    /// assert!((7500.0 / joint.nmm_per_rad[0] - Angle::from_deg(4.25).rad()).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn library(self) -> StiffnessLibrary {
        let rows = Level::MODEL.windows(2).map(|pair| {
            let (nmm_per_rad, source) = match self {
                Self::MotionSegments | Self::Coupled => motion_segment(pair[0]),
                Self::InVitro => in_vitro(pair[0], [1.0; 3]),
                Self::IntactChest => in_vitro(pair[0], [1.635, 1.63, 1.588]),
                Self::ScolioticInVivo => scoliotic(pair[0]),
            };
            let (axial_per_lateral, source) = match self {
                Self::Coupled => {
                    let (ratio, coupling) = coupling(pair[0]);
                    (ratio, format!("{source}; coupling {coupling}"))
                }
                _ => (0.0, source),
            };
            let [inferior, superior] = [pair[0], pair[1]];
            JointStiffness { inferior, superior, nmm_per_rad, axial_per_lateral, source }
        });
        StiffnessLibrary::from_rows(rows.collect()).expect("every joint has positive springs")
    }
}

impl Default for StiffnessLibrary {
    /// [`StiffnessTable::MotionSegments`](StiffnessTable::MotionSegments).
    fn default() -> Self {
        StiffnessTable::default().library()
    }
}

/// Source of T12/L1.
const NEIGHBOURS: &str = "mean of T11/T12 and L1/L2 (assumption)";

/// Lateral, flexion and axial stiffness of the joint above a vertebra, in N·mm/rad.
fn motion_segment(inferior: Level) -> ([f64; 3], String) {
    let (n_m_per_rad, source): ([f64; 3], _) = match inferior {
        Level::L4 | Level::L3 | Level::L2 => {
            ([132.0, 126.0, 481.0], SourceCheck::SecondHand.cite("schmidt-1998, ammr-repository"))
        }
        Level::L1 => ([140.0, 139.0, 317.0], NEIGHBOURS.to_owned()),
        _ => ([148.0, 152.0, 153.0], SourceCheck::SecondHand.cite("panjabi-1976, desroches-2007")),
    };
    (n_m_per_rad.map(|value| 1000.0 * value), source)
}

/// The moment of the tests in vitro, in N·mm.
const TEST_NMM: f64 = 7500.0;

/// Thoracic springs times a factor per axis; the lumbar ones are as in `MotionSegments`, T12/L1 the mean of its neighbours.
fn in_vitro(inferior: Level, factors: [f64; 3]) -> ([f64; 3], String) {
    let thoracic = |range_deg: [f64; 3]| -> [f64; 3] {
        // A range covers both directions.
        std::array::from_fn(|axis| {
            factors[axis] * TEST_NMM / Angle::from_deg(0.5 * range_deg[axis]).rad()
        })
    };
    let with_ribs = factors[0] > 1.0;
    let source = if with_ribs { "wilke-2017, liebsch-2018" } else { "wilke-2017" };
    let source = SourceCheck::AtSource.cite(source);
    let lower = [8.5, 7.0, 7.5];
    match inferior {
        Level::L4 | Level::L3 | Level::L2 => motion_segment(inferior),
        Level::L1 => {
            let ((below, _), above) = (motion_segment(Level::L2), thoracic(lower));
            let mean = std::array::from_fn(|axis| 0.5 * (below[axis] + above[axis]));
            (mean, NEIGHBOURS.to_owned())
        }
        Level::T12 | Level::T11 => (thoracic(lower), source),
        Level::T10 | Level::T9 | Level::T8 => (thoracic([8.5, 7.0, 11.0]), source),
        _ => (thoracic([11.0, 7.0, 11.0]), source),
    }
}

/// Axial rotation per lateral rotation of the joint above a vertebra.
fn coupling(inferior: Level) -> (f64, String) {
    // At T12/L1 3.0° of bending and 1.5° of rotation away from it, at L5/S1 3.4° and 0.2° towards it.
    let [upper, lowest] = [1.5 / 3.0, -0.2 / 3.4];
    let between = |joints_below: f64| upper + (lowest - upper) * joints_below / 5.0;
    let lumbar = "lumbar-coupling-2009, linear between T12/L1 and L5/S1 (assumption)";
    let (ratio, source) = match inferior {
        Level::L1 => (upper, "lumbar-coupling-2009"),
        Level::L2 => (between(1.0), lumbar),
        Level::L3 => (between(2.0), lumbar),
        Level::L4 => (between(3.0), lumbar),
        _ => {
            let size = SourceCheck::Unverified.cite("fujimori-2014");
            return (-0.4, format!("willems-1996 (side), {size}"));
        }
    };
    (ratio, SourceCheck::AtSource.cite(source))
}

/// The springs of motion segments, all multiplied so that lateral bending equals the value measured in patients.
fn scoliotic(inferior: Level) -> ([f64; 3], String) {
    let lateral = 1000.0 / Angle::from_deg(0.18).rad();
    let (own, _) = motion_segment(inferior);
    let source = "reutlinger-2012 (apical segments); ratios of the axes as in `motion_segments` (assumption)";
    (own.map(|value| value * lateral / own[0]), SourceCheck::AtSource.cite(source))
}
