use super::{Deformed, SpineModel};
use crate::spatial::{Angle, Mat3};

/// No human joint rotates farther from the erect spine: three times the largest lateral bending of any joint from L4 to T2, 9° to
/// one side at T11/T12 [white-panjabi-1990].
///
/// # Assumption
/// Three times, because scoliotic joints differ from the source's, and every single joint of a plausible shape must pass.
pub const MAX_HUMAN_JOINT: Angle = Angle::from_deg(27.0);
/// No two vertebrae rotate farther relative to each other: the lateral bending to one side of all joints from L4 to T2 together
/// [white-panjabi-1990].
pub const MAX_HUMAN_COLUMN: Angle = Angle::from_deg(91.0);

/// How far a shape is beyond the human range of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeyondHumanRange {
    /// Lower and upper vertebra.
    pub vertebrae: [usize; 2],
    /// Rotation of the upper relative to the lower one, from the erect spine.
    pub rotation: Angle,
    /// The limit that it exceeds.
    pub limit: Angle,
}

impl Deformed {
    /// Whether this shape of a spine is beyond the human range of motion; `None` if it is not.
    ///
    /// The rotation of one vertebra relative to another is the angle of the one rotation about any axis that takes their erect
    /// pose to this one, in rad from 0 to π. A joint is judged before the whole spine.
    ///
    /// # Panics
    /// If the model has another number of vertebrae.
    #[must_use]
    pub fn beyond_human_range(&self, erect: &SpineModel) -> Option<BeyondHumanRange> {
        let count = self.axes.len();
        assert_eq!(count, erect.axes.len(), "a shape of this model");
        let turned: Vec<Mat3> =
            self.axes.iter().zip(&erect.axes).map(|(now, then)| now * then.transpose()).collect();
        let between = |vertebrae: [usize; 2]| {
            rotation(&(turned[vertebrae[0]].transpose() * turned[vertebrae[1]]))
        };
        let farthest = |pairs: &mut dyn Iterator<Item = ([usize; 2], Angle)>, limit: Angle| {
            pairs
                .filter(|(_, rotation)| *rotation > limit)
                .max_by(|a, b| a.1.rad().total_cmp(&b.1.rad()))
                .map(|(vertebrae, rotation)| BeyondHumanRange { vertebrae, rotation, limit })
        };
        let joints: Vec<Angle> = (1..count).map(|upper| between([upper - 1, upper])).collect();
        let mut of_joints = joints.iter().enumerate().map(|(i, &rotation)| ([i, i + 1], rotation));
        if let Some(joint) = farthest(&mut of_joints, MAX_HUMAN_JOINT) {
            return Some(joint);
        }
        // No two vertebrae rotate farther than the joints between them do in sum.
        if joints.iter().map(|rotation| rotation.rad()).sum::<f64>() < MAX_HUMAN_COLUMN.rad() {
            return None;
        }
        let pairs = (2..count).flat_map(|gap| (0..count - gap).map(move |i| [i, i + gap]));
        farthest(&mut pairs.map(|pair| (pair, between(pair))), MAX_HUMAN_COLUMN)
    }
}

/// The angle of a rotation, from 0 to 180°.
fn rotation(matrix: &Mat3) -> Angle {
    let cosine = 0.5 * (matrix.trace() - 1.0);
    let axis = [
        matrix[(2, 1)] - matrix[(1, 2)],
        matrix[(0, 2)] - matrix[(2, 0)],
        matrix[(1, 0)] - matrix[(0, 1)],
    ];
    let sine = 0.5 * axis.iter().map(|part| part * part).sum::<f64>().sqrt();
    Angle::from_sin_cos(sine, cosine)
}
