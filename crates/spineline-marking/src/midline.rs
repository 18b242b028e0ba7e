//! Levels placed by arc length on a midline of the spine without visible vertebrae.
//!
//! Surface topography gives the line of the spinous processes, but no vertebrae. Levels are placed as on a typical
//! spine: each has the same share of the line's length as of the typical length between the line's ends. A level's tilt
//! is the tilt of the chord between the middles of the discs below and above it.
//!
//! # Assumptions
//! Proportions of an adult spine hold for this patient, and the line's ends are at the named vertebrae. The seventh cervical
//! vertebra is as long as the first thoracic one. The spinous processes follow the bodies; in a scoliotic spine the axial
//! rotation carries them towards the concave side, so the line is straighter than the spine.
//!
//! # References
//! Distances of the midpoints: [vid-ct] and [bruno-2015], by [`Morphometry`].

use std::collections::BTreeMap;
use std::str::FromStr;

use spineline::anatomy::{Level, Morphometry, UnknownLevel};
use spineline::fault::ErrorPlace;
use spineline::measure::Placement;
use spineline::number::fixed;
use spineline::spatial::Frontal;

/// Distance of two neighbouring points above which the line between them is unknown: more than one vertebra.
const MAX_GAP_MM: f64 = 40.0;

/// Length of the line as a part of the typical length between its ends; outside of this range, coordinates are not
/// millimetres, or the ends are wrong.
const LENGTH_SHARE: [f64; 2] = [0.5, 1.6];

/// An end of a midline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MidlineEnd {
    /// The seventh cervical vertebra.
    C7,
    /// The middle of a vertebra of the model's seventeen.
    Middle(Level),
    /// The superior endplate of the sacrum.
    S1,
}

impl MidlineEnd {
    /// Distance above the sacrum on a typical spine, along it.
    fn above_sacrum_mm(self) -> f64 {
        match self {
            Self::S1 => 0.0,
            Self::Middle(level) => middle_above_sacrum_mm(level),
            Self::C7 => {
                middle_above_sacrum_mm(Level::T1) + Morphometry::of(Level::T1).spacing_above_mm
            }
        }
    }
}

impl FromStr for MidlineEnd {
    type Err = UnknownLevel;

    fn from_str(name: &str) -> Result<Self, UnknownLevel> {
        match name {
            "C7" => Ok(Self::C7),
            "S1" => Ok(Self::S1),
            level => level.parse().map(Self::Middle),
        }
    }
}

/// A point of a midline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MidlinePoint {
    /// In the frontal plane.
    pub frontal: Frontal,
    /// Anterior coordinate; 0 on a line in the frontal plane only.
    pub anterior_mm: f64,
}

impl MidlinePoint {
    fn distance_mm(self, other: Self) -> f64 {
        self.frontal.distance_mm(other.frontal).hypot(self.anterior_mm - other.anterior_mm)
    }
}

/// A line along the spine, from its cranial end to its caudal one.
#[derive(Debug, Clone, PartialEq)]
pub struct Midline {
    /// Its points.
    pub points: Vec<MidlinePoint>,
    /// The end at its first point.
    pub cranial_end: MidlineEnd,
    /// The end at its last point.
    pub caudal_end: MidlineEnd,
}

spineline::faults! {
    /// A midline on which levels cannot be placed.
    #[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum MidlineError {
        /// Too few points, or a point that is not a number.
        #[error("a midline needs at least two points, all of them numbers")]
        #[help("give the points of the line as numbers in millimetres")]
        Points,
        /// The cranial end is not above the caudal one.
        #[error("the cranial end of the midline is not above its caudal end")]
        #[help("name the vertebrae at the first and the last point: C7, T1 to L5, or S1")]
        Ends,
        /// The points run from the sacrum upwards.
        #[error(
            "the first point of the midline is lower than the last one by {} mm",
            fixed(*lower_mm, 0)
        )]
        #[help("give the points from the cranial to the caudal end, and check the directions of the axes")]
        UpsideDown {
            /// By how much.
            lower_mm: f64,
        },
        /// A spine cannot have this length.
        #[error(
            "the midline is {} mm long, and between such ends {} to {} mm are expected",
            fixed(*length_mm, 1),
            fixed(*low_mm, 0),
            fixed(*high_mm, 0)
        )]
        #[help("give millimetres, and check which vertebrae the line ends at")]
        #[at(value = *length_mm, limit = ErrorPlace::limit(*length_mm, *low_mm, *high_mm))]
        Length {
            /// Length along the line.
            length_mm: f64,
            /// The shortest.
            low_mm: f64,
            /// The longest.
            high_mm: f64,
        },
        /// Neighbouring points are too far apart.
        #[error(
            "points {} and {} of the midline are {} mm apart, and the limit is {} mm",
            after + 1,
            after + 2,
            fixed(*gap_mm, 0),
            fixed(*limit_mm, 0)
        )]
        #[help("give more points of the line, at least one per vertebra")]
        #[at(value = *gap_mm, limit = *limit_mm)]
        Gap {
            /// Index of the first of the two.
            after: usize,
            gap_mm: f64,
            /// The largest.
            limit_mm: f64,
        },
    }
}

impl Midline {
    /// The levels whose middles lie on the line.
    ///
    /// # Definition
    /// With `h(v)` the distance of a level above the sacrum on a typical spine, `a` and `b` the distances of the
    /// cranial and the caudal end, and `S` the length of the line, `v` lies at the arc length `S (a − h(v)) / (a − b)`
    /// from the cranial end.
    ///
    /// # Errors
    /// [`MidlineError`].
    ///
    /// ```
    /// use spineline::anatomy::Level;
    /// use spineline_marking::{Midline, MidlineEnd, MidlinePoint};
    /// use spineline::spatial::Frontal;
    /// let points = (0..=45).map(|i| MidlinePoint { frontal: Frontal::new(0.0, -10.0 * f64::from(i)), anterior_mm: 0.0 });
    /// let line = Midline { points: points.collect(), cranial_end: MidlineEnd::C7, caudal_end: MidlineEnd::S1 };
    /// let levels = line.place_levels()?;
    /// assert_eq!(levels.len(), 17);
    /// assert!(levels[&Level::L4].location.z_mm < levels[&Level::T2].location.z_mm);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn place_levels(&self) -> Result<BTreeMap<Level, Placement>, MidlineError> {
        let [top_mm, bottom_mm] =
            [self.cranial_end, self.caudal_end].map(MidlineEnd::above_sacrum_mm);
        if top_mm <= bottom_mm {
            return Err(MidlineError::Ends);
        }
        let arcs = self.arc_lengths(top_mm - bottom_mm)?;
        let length_mm = arcs[arcs.len() - 1];
        let share = length_mm / (top_mm - bottom_mm);
        let at = |above_sacrum_mm: f64| self.at(&arcs, share * (top_mm - above_sacrum_mm));
        let seen = Level::ALL
            .into_iter()
            .map(|level| (level, middle_above_sacrum_mm(level)))
            .filter(|&(_, middle_mm)| (bottom_mm..=top_mm).contains(&middle_mm));
        Ok(seen
            .map(|(level, middle_mm)| {
                let [below_mm, above_mm] = disc_distances_mm(level);
                let chord = at(middle_mm + above_mm) - at(middle_mm - below_mm);
                (level, Placement::new(at(middle_mm), chord.lateral_tilt()))
            })
            .collect())
    }

    /// Length of the line from its first point to every one.
    fn arc_lengths(&self, typical_mm: f64) -> Result<Vec<f64>, MidlineError> {
        let finite = |p: &MidlinePoint| p.frontal.is_finite() && p.anterior_mm.is_finite();
        let [first, .., last] = self.points[..] else { return Err(MidlineError::Points) };
        if !self.points.iter().all(finite) {
            return Err(MidlineError::Points);
        }
        let mut arcs = vec![0.0];
        let mut length_mm = 0.0;
        for pair in self.points.windows(2) {
            length_mm += pair[0].distance_mm(pair[1]);
            arcs.push(length_mm);
        }
        let [low_mm, high_mm] = LENGTH_SHARE.map(|share| share * typical_mm);
        if !(low_mm..=high_mm).contains(&length_mm) {
            return Err(MidlineError::Length { length_mm, low_mm, high_mm });
        }
        let lower_mm = last.frontal.z_mm - first.frontal.z_mm;
        if lower_mm >= 0.0 {
            return Err(MidlineError::UpsideDown { lower_mm });
        }
        let gaps = arcs.windows(2).map(|pair| pair[1] - pair[0]).enumerate();
        match gaps.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((after, gap_mm)) if gap_mm > MAX_GAP_MM => {
                Err(MidlineError::Gap { after, gap_mm, limit_mm: MAX_GAP_MM })
            }
            _ => Ok(arcs),
        }
    }

    /// The place at an arc length, or the nearest end.
    fn at(&self, arcs: &[f64], arc_mm: f64) -> Frontal {
        let after = arcs.partition_point(|&arc| arc <= arc_mm).clamp(1, arcs.len() - 1);
        let [from_mm, to_mm] = [arcs[after - 1], arcs[after]];
        let part = if to_mm > from_mm { (arc_mm - from_mm) / (to_mm - from_mm) } else { 0.0 };
        let [from, to] = [self.points[after - 1].frontal, self.points[after].frontal];
        from + (to - from) * part.clamp(0.0, 1.0)
    }
}

/// Distance of the middle of a level above the sacrum on a typical spine, along it.
fn middle_above_sacrum_mm(level: Level) -> f64 {
    Morphometry::L5_ABOVE_SACRUM_MM + Morphometry::spacing_mm(Level::L5, level)
}

/// Distances from the midpoint of a level of a typical spine to the middles of the discs below and above.
fn disc_distances_mm(level: Level) -> [f64; 2] {
    let below_mm = level.next_below().map_or(Morphometry::L5_ABOVE_SACRUM_MM, |below| {
        0.5 * Morphometry::of(below).spacing_above_mm
    });
    [below_mm, 0.5 * Morphometry::of(level).spacing_above_mm]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: impl Iterator<Item = [f64; 3]>) -> Midline {
        let points = points
            .map(|[y, z, anterior_mm]| MidlinePoint { frontal: Frontal::new(y, z), anterior_mm });
        Midline {
            points: points.collect(),
            cranial_end: MidlineEnd::C7,
            caudal_end: MidlineEnd::S1,
        }
    }

    /// A straight line with a lateral tilt of 10° to the patient's left.
    fn leaning() -> Midline {
        let (sin, cos) = spineline::spatial::Angle::from_deg(10.0).rad().sin_cos();
        line((0..=220).map(|i| [sin * 2.0 * (220 - i) as f64, -cos * 2.0 * i as f64, 0.0]))
    }

    #[test]
    fn levels_divide_a_straight_line_like_a_typical_spine() {
        let line = leaning();
        let levels = line.place_levels().expect("a line of 440 mm");
        assert_eq!(levels.len(), Level::ALL.len());
        let typical_mm = MidlineEnd::C7.above_sacrum_mm();
        for pair in Level::ALL.windows(2) {
            let [low, high] = [levels[&pair[0]], levels[&pair[1]]];
            let expected = Morphometry::spacing_mm(pair[0], pair[1]) * 440.0 / typical_mm;
            assert!((low.location.distance_mm(high.location) - expected).abs() < 1e-9);
            assert!((high.tilt.deg() + 10.0).abs() < 1e-9, "{}", high.tilt.deg());
        }
    }

    #[test]
    fn depth_counts_for_the_arc_length() {
        // As long, but deep: every frontal distance is smaller by the same factor.
        let flat = line((0..=220).map(|i| [0.0, -2.0 * i as f64, 0.0]));
        let deep = line((0..=220).map(|i| [0.0, -1.6 * i as f64, 1.2 * i as f64]));
        let [flat, deep] = [flat, deep].map(|line| line.place_levels().expect("a line"));
        for level in Level::ALL {
            assert!((0.8 * flat[&level].location.z_mm - deep[&level].location.z_mm).abs() < 1e-9);
        }
    }

    #[test]
    fn only_levels_on_the_line_are_placed() {
        let mut line = leaning();
        line.points.truncate(170);
        line.cranial_end = MidlineEnd::Middle(Level::T2);
        line.caudal_end = MidlineEnd::Middle(Level::L4);
        let levels = line.place_levels().expect("a line");
        assert!(levels.keys().copied().eq(Level::MODEL));
        assert_eq!(levels[&Level::T2].location, line.points[0].frontal);
    }

    #[test]
    fn invalid_midlines_are_refused() {
        let refused = |change: &dyn Fn(&mut Midline)| {
            let mut line = leaning();
            change(&mut line);
            let error = line.place_levels().expect_err("changed on purpose");
            assert!(!error.help().is_empty());
            error
        };
        let metres = refused(&|line| {
            for point in &mut line.points {
                point.frontal = point.frontal * 0.001;
            }
        });
        assert!(matches!(metres, MidlineError::Length { .. }), "{metres}");
        let turned = refused(&|line| line.points.reverse());
        assert!(matches!(turned, MidlineError::UpsideDown { .. }), "{turned}");
        let gap = refused(&|line| drop(line.points.drain(50..80)));
        assert!(matches!(gap, MidlineError::Gap { after: 49, .. }), "{gap}");
        let ends = refused(&|line| line.cranial_end = MidlineEnd::S1);
        assert_eq!(ends, MidlineError::Ends);
        assert_eq!(refused(&|line| line.points.truncate(1)), MidlineError::Points);
        let nan = refused(&|line| line.points[3].anterior_mm = f64::NAN);
        assert_eq!(nan, MidlineError::Points);
    }
}
