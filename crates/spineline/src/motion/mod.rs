//! Step 4: the chain in two postures → how far every segment rotates, and which rotate least.
//!
//! The rotation of a segment is `|joint angle when erect - joint angle in P|`, the paper's r. The least-rotating segment
//! is searched in two windows, between the midpoints of L2 and T9 and of T7 and T4 on the erect film. An inflection is a
//! segment of the **erect** chain and stays that segment in every posture. The segment midway between the least-rotating ones of both bends
//! ([`mean_least`], MMS_Mean) is the other estimate of a segment that does not rotate.
//!
//! # References
//! [jalalian-loa], section 3.1, figures 5, 6 and 10.

use crate::anatomy::Level;
use crate::chain::ChainPose;
use crate::curve::CurveFit;
use crate::spatial::Angle;

/// The two windows in which a least-rotating segment is sought, caudal first.
pub const LEAST_SEGMENT_WINDOWS: [(Level, Level); 2] =
    [(Level::L2, Level::T9), (Level::T7, Level::T4)];

/// The movement of the chain from the erect posture to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Rotation of every segment that both postures have, from L4 upwards.
    pub rotations: Vec<Angle>,
    /// The least-rotating segment of either window: MMS_Least.
    pub least: [usize; 2],
}

/// How well a segment stands for the least-rotating one of its window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentEstimate {
    /// The segment.
    pub segment: usize,
    /// The least-rotating one.
    pub least: usize,
    /// Distance between them in segments.
    pub distance_segments: usize,
    /// Distance between their joints on the erect film.
    pub distance_mm: f64,
    /// Rotation of the segment.
    pub rotation: Angle,
}

impl Motion {
    /// Compares two postures of one chain; `windows` come from [`least_windows`], as segments of the erect chain.
    ///
    /// ```
    /// use spineline::analysis::{AnalysisOptions, analyze_movement};
    /// use spineline::anatomy::Posture;
    /// use spineline::motion::{Motion, least_windows};
    /// use spineline_phantom::{Readers, Scenario, generate};
    ///
    /// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
    /// let movement = analyze_movement(&case, &AnalysisOptions::default())?.movement;
    /// let erect = movement.erect();
    /// let bend = movement.film(Posture::LeftBending).ok_or("no left bend")?;
    /// let windows = least_windows(&erect.fit, &erect.pose);
    /// let motion = Motion::between(&erect.pose, &bend.pose, &windows);
    /// // The segment of the caudal window that rotates least.
    /// let least = motion.least[0];
    /// assert!((windows[0].0..=windows[0].1).contains(&least));
    /// assert!(motion.rotations[least].rad() <= motion.rotations[windows[0].0].rad());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn between(erect: &ChainPose, moved: &ChainPose, windows: &[(usize, usize); 2]) -> Self {
        let rotations: Vec<Angle> = erect
            .joint_angles
            .iter()
            .zip(&moved.joint_angles)
            .map(|(a, b)| (*a - *b).wrapped().abs())
            .collect();
        let least = windows.map(|(from, to)| {
            let to = to.min(rotations.len().saturating_sub(1));
            let least =
                (from..=to).min_by(|&a, &b| rotations[a].rad().total_cmp(&rotations[b].rad()));
            least.unwrap_or(to)
        });
        Self { rotations, least }
    }

    /// Mean rotation over all segments.
    #[must_use]
    pub fn mean_rotation(&self) -> Angle {
        let sum = self.rotations.iter().fold(Angle::ZERO, |sum, &r| sum + r);
        sum * (1.0 / self.rotations.len().max(1) as f64)
    }

    /// Compares one segment per window, such as the inflections, with the least-rotating ones.
    ///
    /// `None` where the moved curve is too short to have such a segment.
    #[must_use]
    pub fn estimates(
        &self,
        erect: &ChainPose,
        segments: [usize; 2],
    ) -> Option<[SegmentEstimate; 2]> {
        let estimate = |window: usize| {
            let (segment, least) = (segments[window], self.least[window]);
            Some(SegmentEstimate {
                segment,
                least,
                distance_segments: segment.abs_diff(least),
                distance_mm: erect.joints[segment].distance_mm(erect.joints[least]),
                rotation: *self.rotations.get(segment)?,
            })
        };
        Some([estimate(0)?, estimate(1)?])
    }
}

/// The windows of the least-rotating segments, as segments of the erect chain.
///
/// The first segment is left out: its joint is L4's midpoint, which does not turn by definition of the frame.
#[must_use]
pub fn least_windows(fit: &CurveFit, erect: &ChainPose) -> [(usize, usize); 2] {
    LEAST_SEGMENT_WINDOWS.map(|(low, high)| {
        let segment = |level: Level| {
            let t = fit.vertebra_t_mm[fit.levels.nearest_index(level)];
            erect.t_mm.partition_point(|&joint| joint < t).clamp(1, erect.segments() - 1)
        };
        (segment(low), segment(high))
    })
}

/// MMS_Mean: per window, the rounded mean of the least-rotating segments of the left and right bend.
#[must_use]
pub fn mean_least(left: &Motion, right: &Motion) -> [usize; 2] {
    std::array::from_fn(|window| (left.least[window] + right.least[window]).div_ceil(2))
}
