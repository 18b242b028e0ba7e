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
use crate::fault::faults;
use crate::number::fixed;
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

const LENGTHS_HELP: &str =
    "check the spacing of the films: their curves should be about equally long";

faults! {
    /// Curves on which no chain can be laid.
    pub enum ChainError {
        /// A window that holds no number of segments, or too large ones.
        #[error("the window of segments {from} to {to} is empty, starts at zero or exceeds {MAX_SEGMENTS}")]
        #[code("segment_window")]
        #[help("give a window from at least 1 to at most 100,000 segments, such as 993 to 1003")]
        Window {
            from: u32,
            to: u32,
        },
        /// An erect curve without length.
        #[error("the erect curve is {erect_mm} mm long, and no chain can be laid on it")]
        #[code("curve_without_length")]
        #[help(LENGTHS_HELP)]
        #[at(value = *erect_mm)]
        NoLength {
            /// Its length.
            erect_mm: f64,
        },
        /// A curve shorter than a tenth of the erect one.
        #[error(
            "a curve is {} mm long, and the erect curve {} mm",
            fixed(*length_mm, 1),
            fixed(*erect_mm, 1)
        )]
        #[code("curve_too_short")]
        #[help(LENGTHS_HELP)]
        #[at(value = *length_mm)]
        TooShort {
            length_mm: f64,
            /// The erect one's.
            erect_mm: f64,
        },
    }
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
        // Between two lengths at which a count changes, all lengths give the same counts: one trial in the middle tells them,
        // away from rounding.
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
        let mut strides_mm = [self.segment_mm / last.tangent.norm_mm(); 3];
        let most = self.segments + self.segments / 8;
        let (mut t_mm, mut joints) = (Vec::with_capacity(most), Vec::with_capacity(most));
        t_mm.push(last.t_mm);
        joints.push(last.point);
        'links: loop {
            for expected in Joint::expected(curve, last.t_mm, strides_mm) {
                let next = last.next(curve, expected, self.segment_mm);
                if next.t_mm > curve.end_mm() {
                    break 'links;
                }
                strides_mm = [strides_mm[1], strides_mm[2], next.t_mm - last.t_mm];
                t_mm.push(next.t_mm);
                joints.push(next.point);
                last = next;
            }
        }
        let joint_angles = joint_angles(&joints, self.segment_mm);
        let end = curve.point(curve.end_mm());
        let leftover_mm = joints[joints.len() - 1].distance_mm(end);
        ChainPose { joints, t_mm, joint_angles, leftover_mm }
    }
}

/// The turn of every link against the one below; the link below the first is +Z. All links have one length.
fn joint_angles(joints: &[Frontal], segment_mm: f64) -> Vec<Angle> {
    let per_square_mm = 1.0 / (segment_mm * segment_mm);
    let mut below = Frontal::new(0.0, segment_mm);
    let links = joints.windows(2).map(|ends| ends[1] - ends[0]);
    links
        .map(|link| {
            let [sine, cosine] = [below.cross(link), below.dot(link)];
            below = link;
            angle_of(sine * per_square_mm, cosine * per_square_mm)
        })
        .collect()
}

/// The angle of a sine and a cosine. Nearly all links turn by milliradians, whose arcsine is summed from its series in place.
///
/// # Accuracy
/// The first omitted term is 3e-19 of the angle at the largest sine for which the series is used.
fn angle_of(sine: f64, cosine: f64) -> Angle {
    const SMALL: f64 = 0.02;
    if cosine < 0.0 || sine.abs() > SMALL {
        return Angle::from_sin_cos(sine, cosine);
    }
    let u = sine * sine;
    let series = 1.0 / 6.0 + u * (3.0 / 40.0 + u * (15.0 / 336.0 + u * (105.0 / 3456.0)));
    Angle::from_rad(sine + sine * u * series)
}

/// How many joints are foreseen at once.
const AT_ONCE: usize = 4;

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

    /// Where the next joints lie about, from the last three strides, which change slowly from link to link. The curve is evaluated at
    /// all of them at once, so that the links need not wait for it one by one.
    fn expected(curve: &Curve, t_mm: f64, strides_mm: [f64; 3]) -> [Self; AT_ONCE] {
        let [before, last, mut stride_mm] = strides_mm;
        let mut growth_mm = stride_mm - last;
        let growth_of_growth_mm = growth_mm - (last - before);
        let mut next_mm = t_mm;
        let places_mm = std::array::from_fn(|_| {
            growth_mm += growth_of_growth_mm;
            stride_mm += growth_mm;
            next_mm += stride_mm;
            next_mm
        });
        let all = curve.points_and_tangents::<AT_ONCE>(places_mm);
        std::array::from_fn(|i| {
            let (point, tangent) = all[i];
            Self { t_mm: places_mm[i], point, tangent }
        })
    }

    /// Where the chord from here has the length of a link, sought from where it is expected; perhaps beyond T2.
    fn next(&self, curve: &Curve, expected: Self, segment_mm: f64) -> Self {
        /// After a step of this size, the error that Newton's method leaves is below rounding.
        const SMALL_MM: f64 = 3e-6;
        let mut next = expected;
        // Newton on |p(t) - joint| = l; the chord is nearly straight, so that one or two steps meet rounding.
        for _ in 0..8 {
            let chord = next.point - self.point;
            let length = chord.dot(chord).sqrt();
            let per_mm2 = 1.0 / chord.dot(next.tangent);
            let step = (length - segment_mm) * length * per_mm2;
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
    fn small_angles_agree_with_the_library() {
        // Oracle: the library's sine and cosine.
        for i in -4000..=4000 {
            let rad = 1e-5 * f64::from(i);
            let found = angle_of(rad.sin(), rad.cos()).rad();
            assert!((found - rad).abs() <= 2.0 * f64::EPSILON * rad.abs(), "{rad}: {found}");
        }
        let back = angle_of(1e-3_f64.sin(), -1e-3_f64.cos()).rad();
        assert!((back - (std::f64::consts::PI - 1e-3)).abs() < 1e-15);
    }

    #[test]
    fn a_window_without_numbers_is_refused() {
        #[allow(clippy::reversed_empty_ranges)]
        let refused = Chain::fit(389.0, &[], 10..=9);
        assert_eq!(refused, Err(ChainError::Window { from: 10, to: 9 }));
    }
}
