//! Published lateral bending of healthy joints.

use crate::anatomy::Levels;
use crate::spatial::Angle;

/// Lateral bending to one side of the joints from L4/L3 to T3/T2, in degrees: representative values of healthy spines
/// [white-panjabi-1990].
const LATERAL_BENDING_DEG: [f64; 14] =
    [8.0, 6.0, 6.0, 8.0, 9.0, 7.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 5.0, 6.0];

/// Published lateral bending to one side of every joint of a spine, caudal first.
///
/// ```
/// use spineline::anatomy::Levels;
/// use spineline::evaluate::published_lateral_bending;
/// let joints = published_lateral_bending(Levels::COMPLETE);
/// // T12 on T11 bends most.
/// assert_eq!((joints.len(), joints[4].deg()), (14, 9.0));
/// ```
#[must_use]
pub fn published_lateral_bending(levels: Levels) -> Vec<Angle> {
    let first = levels.first_joint();
    LATERAL_BENDING_DEG[first..first + levels.joints()]
        .iter()
        .map(|&deg| Angle::from_deg(deg))
        .collect()
}
