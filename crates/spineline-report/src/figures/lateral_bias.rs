//! The bias of a lateral film without correction.

use spineline::spatial::{Angle, Orientation};

use super::page::Page;
use super::panel::{Axis, Panel};
use super::style::{BLACK, BLUE, Ink, VERMILLION};

/// Tilts up to which the figure goes.
const LARGEST_TILT_DEG: f64 = 40.0;

/// A pitch of 20° in space as a lateral film shows it, over the frontal tilt of the vertebra: by its axis and by both ways to read
/// its endplates.
#[must_use]
pub fn lateral_bias() -> String {
    let true_pitch = Angle::from_deg(20.0);
    let mut page = Page::new("A lateral film misjudges the pitch of a tilted vertebra", false);
    page.notes.push(
        "Round endplates square to the axis of the vertebra, no axial rotation, parallel rays. The pitch in space is 20°."
            .to_owned(),
    );
    let label = "tilt of the vertebra on the frontal film (deg)";
    let x = Axis::numbers(label, [0.0, LARGEST_TILT_DEG], 10.0);
    let y = Axis::numbers("pitch (deg)", [14.0, 26.0], 2.0);
    let mut panel = Panel::new(x, y, [page.inner_px() - 84.0, 360.0]);
    type Shown = fn(&Orientation) -> Angle;
    let curves: [(&str, Ink, Shown); 3] = [
        (
            "without correction: axis, or endplates by the outline of their rims",
            Ink::new(VERMILLION, "8 3", 2.0),
            Orientation::lateral_pitch,
        ),
        ("corrected by the frontal film", Ink::new(BLACK, "", 2.2), |stands| {
            Orientation::of_axis(stands.tilt, stands.lateral_pitch()).pitch
        }),
        (
            "without correction: endplates by their middle lines",
            Ink::new(BLUE, "2 2", 2.0),
            Orientation::middle_line_pitch,
        ),
    ];
    for (name, ink, shown) in curves {
        let places = (0..=80).map(|i| {
            let tilt_deg = LARGEST_TILT_DEG * f64::from(i) / 80.0;
            let tilt = Angle::from_deg(tilt_deg);
            let stands = Orientation { tilt, pitch: true_pitch, axial: Angle::ZERO };
            (tilt_deg, shown(&stands).deg())
        });
        let curve = panel.trace(ink, places);
        panel.marks.push(curve);
        page.entry(ink, name);
    }
    page.rows.push(vec![panel]);
    page.into_svg()
}
