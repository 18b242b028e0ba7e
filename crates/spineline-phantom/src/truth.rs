//! What moves a phantom, and the true values of a posture.

use spineline::action::LineOfAction;
use spineline::anatomy::Posture;
use spineline::spatial::{Angle, Frontal};

spineline::named! {
    /// Loading scenario of the synthetic spine.
    pub enum Scenario {
        /// A force through the inflections (the paper's hypothesis).
        Rod = "rod" as "force through the inflections",
        /// Prescribed rotations, all to one side (clinical bends).
        Bend = "bend" as "all joints turn to one side",
        /// A force at T2 parallel to the iliac line (Petit's hypothesis).
        Pull = "pull" as "force at T2 along the iliac line",
        /// All segments rotate in proportion to their erect curvature: no force, and no rotation at the inflections.
        Flatten = "flatten" as "curvature scaled everywhere, no force",
        /// A force as in `rod` along a line that crosses the spine caudal of its inflections.
        Offset = "offset" as "force along a line beside the inflections",
        /// A load of the same size on every millimetre of the spine: horizontal for bends, cranial for traction.
        Spread = "spread" as "load distributed over the whole spine",
        /// Random rotation of every joint.
        Random = "random" as "joints turn at random",
        /// The weight of trunk, head and arms along the film's vertical, which is tilted relative to L4.
        Weight = "weight" as "weight along a tilted vertical",
        /// A horizontal force spread evenly over the length.
        Lateral = "lateral" as "horizontal force distributed over the length",
        /// One moment at all levels.
        Couple = "couple" as "the same moment at all levels",
        /// A force through the inflections and a horizontal one at the apex of the main thoracic curve.
        TwoForces = "two-forces" as "forces through the inflections and at the apex",
        /// As the rod, with the axis of L4 rotated on the bends: everything above it is rotated in its frame.
        TurnedBase = "turned-base" as "force through the inflections, and L4's axis turned",
        /// Weight along the film's vertical, slightly tilted relative to L4, with one moment at all levels.
        WeightAndCouple = "weight-and-couple" as "weight and the same moment at all levels",
        /// Horizontal forces of two pads: at T5 to one side, and half as much at T11 against it.
        Pads = "pads" as "horizontal forces of two pads against each other",
    }
}

impl Scenario {
    /// The three scenarios that `spineline reproduce` compares with the paper.
    pub const PAPER: [Self; 3] = [Self::Rod, Self::Bend, Self::Pull];
    /// Scenarios for a comparison of lines: [`Scenario::PAPER`] and the counter-examples.
    pub const LINES: &[Self] = Self::ALL.split_at(7).0;
    /// Scenarios for a comparison of loads, which no single line describes.
    pub const LOADS: &[Self] = Self::ALL.split_at(7).1;

    /// Whether forces move the spine; else its rotations are prescribed.
    #[must_use]
    pub const fn is_elastic(self) -> bool {
        !matches!(self, Self::Bend | Self::Flatten | Self::Random)
    }
}

/// True values of one posture of a phantom, in the global frame.
#[derive(Debug, Clone, PartialEq)]
pub struct TruePosture {
    /// The posture.
    pub posture: Posture,
    /// True locations of L4…T2.
    pub locations: Vec<Frontal>,
    /// True tilts.
    pub tilts: Vec<Angle>,
    /// True places of the two erect inflections, as material points.
    pub inflections: [Frontal; 2],
    /// True line of action; `None` for prescribed rotations, for loads without a line, and for the erect posture.
    pub line: Option<LineOfAction>,
    /// True force along it; for other loads, their size.
    pub force_n: f64,
    /// L4's tilt on the film, if the load depends on it; else the patient's tilt is random.
    pub l4_on_film: Option<Angle>,
    /// Rotation of everything above L4 in L4's frame, in addition to the load's effect.
    pub base_turn: Angle,
    /// Tilt of the iliac crests relative to L4.
    pub crest_tilt: Angle,
}
