//! Step 3: curves → one chain of equal micro-scale motion segments, laid on every posture.
//!
//! # Model
//! Segment `k` (from 0) is a rigid link from joint `k` to joint `k + 1`; its rotary joint sits at its caudal end, and
//! joint 0 is L4's midpoint. The joint angle is the turn of a link against the one below; the link below the first is
//! +Z. Links are laid as chords: every joint lies on the curve. The link length is found from arc lengths, which differ
//! from the chords by far less than a link.
//!
//! # Departures from the paper
//! Problem (1), `min Σ |n_0 - n_i|`, always prefers a longer link. The number of segments of the erect curve is
//! therefore held in a stated window, by default 993…1003, which covers the paper's 998 ± 3; among equal sums, the
//! number nearest to the middle of the window is taken.
//!
//! # References
//! [jalalian-loa], section 2.3 and figure 4; [denavit-hartenberg-1955].

use std::ops::RangeInclusive;

use crate::curve::Curve;
use crate::spatial::{Angle, Frontal};

/// The number of segments that the erect curve may have.
pub const SEGMENT_WINDOW: RangeInclusive<u32> = 993..=1003;

/// The largest number of segments: a link of 4 µm on a spine of 400 mm.
pub const MAX_SEGMENTS: u32 = 100_000;

/// The segment length that all postures of one patient share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    /// Number of segments on the erect curve: the paper's n.
    pub segments: usize,
    /// Length of a link: the paper's l.
    pub segment_mm: f64,
    /// The minimum of (1): how many segments the postures differ by in sum.
    pub difference: u32,
}

/// The chain laid on the curve of one posture.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainPose {
    /// Joints from L4 upwards; one more than segments.
    pub joints: Vec<Frontal>,
    /// Curve parameter of every joint.
    pub t_mm: Vec<f64>,
    /// Angle of every segment's joint, right-handed about +X: the paper's θ of an MMS.
    pub joint_angles: Vec<Angle>,
    /// Length of the curve above the last joint.
    pub leftover_mm: f64,
}

/// One row of the Denavit-Hartenberg table of the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DenavitHartenberg {
    /// Link length.
    pub a_mm: f64,
    /// Link twist.
    pub alpha: Angle,
    /// Link offset.
    pub d_mm: f64,
    /// Joint variable.
    pub theta: Angle,
}

/// Curves on which no chain can be laid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// A window that holds no number of segments, or too large ones.
    #[error(
        "the window of segments {from} to {to} is empty, starts at zero or exceeds {MAX_SEGMENTS}"
    )]
    Window {
        /// Its start.
        from: u32,
        /// Its end.
        to: u32,
    },
    /// An erect curve without length.
    #[error("the erect curve is {erect_mm} mm long, and no chain can be laid on it")]
    NoLength {
        /// Its length.
        erect_mm: f64,
    },
    /// A curve shorter than a tenth of the erect one.
    #[error("a curve is {length_mm:.1} mm long, and the erect curve {erect_mm:.1} mm")]
    TooShort {
        /// Its length.
        length_mm: f64,
        /// The erect one's.
        erect_mm: f64,
    },
}

impl Chain {
    /// Solves (1): the link length with which all curves take the most nearly equal number of segments.
    ///
    /// Lengths are arc lengths of the curves in mm, from L4 to T2; `window` holds the number of segments of the erect one.
    ///
    /// # Errors
    /// [`ChainError`]: an empty window, an erect curve without length, or a curve that is far shorter than the erect one.
    ///
    /// ```
    /// use spineline::chain::{Chain, SEGMENT_WINDOW};
    /// let chain = Chain::fit(400.0, &[398.0, 401.0], SEGMENT_WINDOW)?;
    /// assert!(SEGMENT_WINDOW.contains(&(chain.segments as u32)));
    /// assert!((400.0 - chain.segments as f64 * chain.segment_mm).abs() < chain.segment_mm);
    /// # Ok::<(), spineline::chain::ChainError>(())
    /// ```
    pub fn fit(
        erect_mm: f64,
        others_mm: &[f64],
        window: RangeInclusive<u32>,
    ) -> Result<Self, ChainError> {
        if window.is_empty() || *window.start() == 0 || *window.end() > MAX_SEGMENTS {
            return Err(ChainError::Window { from: *window.start(), to: *window.end() });
        }
        if !erect_mm.is_normal() || erect_mm < 0.0 {
            return Err(ChainError::NoLength { erect_mm });
        }
        if let Some(&length_mm) =
            others_mm.iter().find(|other| other.is_nan() || **other <= 0.1 * erect_mm)
        {
            return Err(ChainError::TooShort { length_mm, erect_mm });
        }
        // The counts change only where a length is a whole number of links, so between two such
        // lengths one trial says all. The middle of the interval keeps clear of rounding.
        let shortest = erect_mm / f64::from(window.end() + 1);
        let longest = erect_mm / f64::from(*window.start());
        let mut breaks = vec![shortest, longest];
        for &length in others_mm.iter().chain([&erect_mm]) {
            let counts = (length / longest).ceil() as u32..=(length / shortest).floor() as u32;
            breaks.extend(counts.filter(|&n| n > 0).map(|n| length / f64::from(n)));
        }
        breaks.sort_by(f64::total_cmp);
        let middle = f64::midpoint(f64::from(*window.start()), f64::from(*window.end()));
        let trial = |segment_mm: f64| {
            let count = |length: f64| (length / segment_mm).floor() as u32;
            let segments = count(erect_mm);
            let difference = others_mm.iter().map(|&other| count(other).abs_diff(segments)).sum();
            Self { segments: segments as usize, segment_mm, difference }
        };
        let off_middle = |chain: &Self| (chain.segments as f64 - middle).abs();
        let best = breaks
            .windows(2)
            .filter(|pair| pair[1] - pair[0] > 1e-12 * longest)
            .map(|pair| trial(f64::midpoint(pair[0], pair[1])))
            .filter(|chain| window.contains(&(chain.segments as u32)))
            .min_by(|a, b| {
                a.difference.cmp(&b.difference).then(off_middle(a).total_cmp(&off_middle(b)))
            });
        best.ok_or(ChainError::Window { from: *window.start(), to: *window.end() })
    }

    /// Lays the chain on a curve by marching equal chords from L4 upwards, as far as whole links reach.
    #[must_use]
    pub fn lay(&self, curve: &Curve) -> ChainPose {
        let mut last = Joint::at(curve, 0.0);
        let mut stride_mm = [self.segment_mm / last.tangent.norm_mm(); 3];
        let (mut t_mm, mut joints) = (vec![last.t_mm], vec![last.point]);
        loop {
            // Strides change slowly from link to link, so that the next is extrapolated from the last three.
            let guess_mm = last.t_mm + 3.0 * (stride_mm[2] - stride_mm[1]) + stride_mm[0];
            let next = last.next(curve, guess_mm, self.segment_mm);
            if next.t_mm > curve.end_mm() {
                break;
            }
            stride_mm = [stride_mm[1], stride_mm[2], next.t_mm - last.t_mm];
            t_mm.push(next.t_mm);
            joints.push(next.point);
            last = next;
        }
        let mut tilt_below = Angle::ZERO;
        let joint_angles = joints
            .windows(2)
            .map(|link| {
                let tilt = (link[1] - link[0]).lateral_tilt();
                let angle = (tilt - tilt_below).wrapped();
                tilt_below = tilt;
                angle
            })
            .collect();
        let end = curve.point(curve.end_mm());
        let leftover_mm = joints[joints.len() - 1].distance_mm(end);
        ChainPose { joints, t_mm, joint_angles, leftover_mm }
    }
}

/// A place on a curve where a link begins.
struct Joint {
    t_mm: f64,
    point: Frontal,
    tangent: Frontal,
}

impl Joint {
    fn at(curve: &Curve, t_mm: f64) -> Self {
        let (point, tangent) = curve.point_and_tangent(t_mm);
        Self { t_mm, point, tangent }
    }

    /// Where the chord from here has the length of a link, sought from a guess; perhaps beyond T2.
    fn next(&self, curve: &Curve, guess_mm: f64, segment_mm: f64) -> Self {
        /// What Newton's method leaves after a step of this size is of its square, times the curvature: below rounding.
        const SMALL_MM: f64 = 3e-6;
        let mut next = Self::at(curve, guess_mm);
        // Newton on |p(t) - joint| = l; the chord is nearly straight, so that one or two steps meet rounding.
        for _ in 0..8 {
            let chord = next.point - self.point;
            let length = chord.dot(chord).sqrt();
            let step = (length - segment_mm) * length / chord.dot(next.tangent);
            if step.abs() < SMALL_MM {
                next.t_mm -= step;
                next.point = next.point - next.tangent * step;
                break;
            }
            next = Self::at(curve, next.t_mm - step);
        }
        next
    }
}

impl ChainPose {
    /// Number of segments on this curve: the paper's `n_i`.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.joint_angles.len()
    }

    /// The segment whose joint lies nearest to a point.
    #[must_use]
    pub fn nearest_segment(&self, point: Frontal) -> usize {
        let off = |k: &usize| self.joints[*k].distance_mm(point);
        (0..self.segments()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
    }

    /// The Denavit-Hartenberg table: `a = l`, `α = 0`, `d = 0`, and the joint angle as variable.
    #[must_use]
    pub fn to_denavit_hartenberg(&self, chain: &Chain) -> Vec<DenavitHartenberg> {
        let row = |&theta: &Angle| DenavitHartenberg {
            a_mm: chain.segment_mm,
            alpha: Angle::ZERO,
            d_mm: 0.0,
            theta,
        };
        self.joint_angles.iter().map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_equal_curves_take_the_middle_of_the_window() {
        let chain = Chain::fit(389.0, &[389.0; 4], SEGMENT_WINDOW).expect("five curves");
        assert_eq!((chain.segments, chain.difference), (998, 0));
        assert!((chain.segment_mm * 998.5 - 389.0).abs() < 0.2);
    }

    #[test]
    fn the_sum_is_the_least_of_a_fine_search() {
        let others = [391.3, 387.2, 389.9, 392.8];
        let chain = Chain::fit(389.0, &others, SEGMENT_WINDOW).expect("five curves");
        let sum = |l: f64| -> u32 {
            let n = (389.0_f64 / l).floor() as u32;
            others.iter().map(|o| ((o / l).floor() as u32).abs_diff(n)).sum()
        };
        let (short, long) = (389.0 / 1004.0, 389.0 / 993.0);
        let least =
            (1..20_000).map(|i| sum(short + (long - short) * f64::from(i) / 20_000.0)).min();
        assert_eq!(Some(chain.difference), least);
        assert_eq!(sum(chain.segment_mm), chain.difference);
    }

    #[test]
    fn a_window_without_numbers_is_refused() {
        #[allow(clippy::reversed_empty_ranges)]
        let refused = Chain::fit(389.0, &[], 10..=9);
        assert_eq!(refused, Err(ChainError::Window { from: 10, to: 9 }));
    }
}
