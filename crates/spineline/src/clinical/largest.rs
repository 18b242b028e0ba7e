use crate::spatial::Angle;

/// The largest Cobb angle that any two vertebrae of a film make: the largest tilt to the right minus the largest to the left;
/// `None` without a tilt, or where one is not finite.
///
/// With tilts of mean endplates ([`Corners::measure_endplate_tilt`](crate::measure::Corners::measure_endplate_tilt)) of
/// T1 to L5 it is the main angle of public landmark sets. Regions play no part in it.
///
/// # References
/// [wu-boostnet-2017].
///
/// ```
/// use spineline::{clinical::largest_tilt_difference, spatial::Angle};
/// let tilts = [-12.0, 3.0, 21.0, -4.0].map(Angle::from_deg);
/// assert!((largest_tilt_difference(tilts).unwrap().deg() - 33.0).abs() < 1e-12);
/// assert_eq!(largest_tilt_difference([]), None);
/// ```
#[must_use]
pub fn largest_tilt_difference(tilts: impl IntoIterator<Item = Angle>) -> Option<Angle> {
    let mut tilts = tilts.into_iter();
    let first = tilts.next().filter(|tilt| tilt.rad().is_finite())?;
    let (mut least, mut greatest) = (first, first);
    for tilt in tilts {
        if !tilt.rad().is_finite() {
            return None;
        }
        least = if tilt < least { tilt } else { least };
        greatest = if tilt > greatest { tilt } else { greatest };
    }
    Some(greatest - least)
}
