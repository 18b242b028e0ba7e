//! Corners that are given in another order in every vertebra of a reading.

use super::Corners;
use crate::spatial::Frontal;

/// Places of the four corners: superior left, superior right, inferior left, inferior right.
pub(super) const PLACES: [usize; 4] = [0, 1, 2, 3];
/// Left and right exchanged: the film is mirrored, which is another fault.
pub(super) const MIRRORED: [usize; 4] = [1, 0, 3, 2];
/// Largest angle of a body's axis to the line through its neighbours, by its cosine; a body that lies on its side is beyond it.
const COS_LIMIT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// An order in which four corners were given: the corner of each place is given in another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CornerOrder([usize; 4]);

impl CornerOrder {
    /// The only order under which all bodies of a reading, caudal first, are bodies of one spine; `None` if it is the right one, if no
    /// order fits, and if only left and right are exchanged.
    pub(super) fn of(bodies: &[Corners<Frontal>]) -> Option<Self> {
        let centres: Vec<Frontal> = bodies.iter().map(Corners::centre).collect();
        let last = centres.len().checked_sub(1).filter(|&last| last > 0)?;
        let fits = |order: &[usize; 4]| {
            bodies.iter().enumerate().all(|(i, body)| {
                let along = centres[(i + 1).min(last)] - centres[i.saturating_sub(1)];
                is_body(&in_order(body, *order), along)
            })
        };
        let mut fitting = orders().filter(fits);
        match (fitting.next(), fitting.next()) {
            (Some(order), None) if order != PLACES && order != MIRRORED => Some(Self(order)),
            _ => None,
        }
    }

    /// The exchange, by the names of the four places.
    #[must_use]
    pub fn words(self, names: [&str; 4]) -> String {
        let Self(order) = self;
        let pair = |&place: &usize| order[place] > place && order[order[place]] == place;
        let pairs = PLACES
            .into_iter()
            .filter(pair)
            .map(|place| format!("{} and {} are exchanged", names[place], names[order[place]]));
        let apart = |&place: &usize| order[order[place]] != place;
        let others = PLACES.into_iter().filter(apart).map(|place| {
            format!(
                "the corner that is given as {} is the {} one",
                names[order[place]], names[place]
            )
        });
        pairs.chain(others).collect::<Vec<_>>().join(", ")
    }
}

/// The body whose corner of each place is given in the place that the order names.
fn in_order(body: &Corners<Frontal>, order: [usize; 4]) -> Corners<Frontal> {
    let given = body.points();
    order.map(|k| given[k]).into()
}

/// Whether four corners make a body whose axis runs along the spine there.
fn is_body(corners: &Corners<Frontal>, along: Frontal) -> bool {
    let axis = (corners.superior_left + corners.superior_right)
        - (corners.inferior_left + corners.inferior_right);
    corners.measure_location().is_ok()
        && corners.sides_agree()
        && axis.dot(along) > COS_LIMIT * axis.norm_mm() * along.norm_mm()
}

/// Every order of four places.
fn orders() -> impl Iterator<Item = [usize; 4]> {
    let all = (0..256).map(|code: usize| [code & 3, (code >> 2) & 3, (code >> 4) & 3, code >> 6]);
    all.filter(|order| PLACES.iter().all(|place| order.contains(place)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::Angle;

    const NAMES: [&str; 4] = ["SL", "SR", "IL", "IR"];

    /// Bodies 40 mm wide and 25 mm high along an arc, in an order of their corners.
    fn spine(order: [usize; 4]) -> Vec<Corners<Frontal>> {
        let body = |i: usize| {
            let turn = Angle::from_deg(8.0 * i as f64 - 28.0);
            let at = |y, z| {
                Frontal::new(2.0 * i as f64, 34.0 * i as f64) + Frontal::new(y, z).rotated(turn)
            };
            let places = [at(20.0, 12.0), at(-20.0, 12.5), at(19.0, -12.0), at(-20.0, -12.0)];
            let mut given = places;
            for (place, k) in order.into_iter().enumerate() {
                given[k] = places[place];
            }
            Corners::from(given)
        };
        (0..8).map(body).collect()
    }

    #[test]
    fn every_order_of_the_corners_is_recognised() {
        for order in orders() {
            let found = CornerOrder::of(&spine(order));
            let right = ![PLACES, MIRRORED].contains(&order);
            assert_eq!(found, right.then_some(CornerOrder(order)), "{order:?}");
        }
        assert_eq!(orders().count(), 24);
    }

    #[test]
    fn what_is_exchanged_is_said() {
        let words = |order| CornerOrder(order).words(NAMES);
        assert_eq!(words([0, 1, 3, 2]), "IL and IR are exchanged");
        assert_eq!(words([2, 3, 0, 1]), "SL and IL are exchanged, SR and IR are exchanged");
        // Around the body from the superior right one.
        assert!(words([1, 3, 0, 2]).starts_with("the corner that is given as SR is the SL one, "));
    }

    #[test]
    fn one_wrong_body_is_no_order() {
        let mut bodies = spine(PLACES);
        bodies[3] = in_order(&bodies[3], [0, 1, 3, 2]);
        assert_eq!(CornerOrder::of(&bodies), None);
        assert_eq!(CornerOrder::of(&bodies[..1]), None);
    }
}
