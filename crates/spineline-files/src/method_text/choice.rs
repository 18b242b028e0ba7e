//! Named values of options, as they are spelled on the command line and in Python.

use spineline::action::LineKind;
use spineline::analysis::Grouping;
use spineline::anatomy::{ImageSide, Named, Side};
use spineline::measure::TiltRule;
use spineline::multibody::{StiffnessTable, Support};
use spineline::personalize::FitTarget;

/// A named value that an option takes.
pub trait Choice: Named + Send + Sync {
    /// How it is spelled on the command line: by default as in files.
    fn spelling(self) -> &'static str {
        self.key()
    }

    /// What a help text says of it; empty where the spelling says it.
    fn help(self) -> &'static str {
        ""
    }
}

/// The value of a spelling.
pub fn of_spelling<T: Choice>(text: &str) -> Option<T> {
    T::ALL.iter().copied().find(|value| value.spelling() == text)
}

impl Choice for Side {}

impl Choice for ImageSide {
    fn spelling(self) -> &'static str {
        match self {
            Self::Left => "image-left",
            Self::Right => "image-right",
        }
    }

    fn help(self) -> &'static str {
        match self {
            Self::Left => "Left side of the picture as viewed",
            Self::Right => "Right side of the picture as viewed",
        }
    }
}

impl Choice for LineKind {
    fn spelling(self) -> &'static str {
        match self {
            Self::Inflection => "inflection",
            Self::Iliac => "iliac",
            Self::Estimated => "estimated",
            Self::Given => "given",
        }
    }
}

impl Choice for Support {
    fn help(self) -> &'static str {
        match self {
            Self::Free => "Every joint rotates about three axes (the paper)",
            Self::Frontal => {
                "In the frontal plane, as on a table: flexion and axial rotation are locked"
            }
        }
    }
}

impl Choice for StiffnessTable {
    fn spelling(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::InVitro => "in-vitro",
            Self::IntactChest => "intact-chest",
            Self::ScolioticInVivo => "scoliotic-in-vivo",
            Self::Coupled => "coupled",
        }
    }

    fn help(self) -> &'static str {
        match self {
            Self::Paper => "Motion segments without ribs, as models of scoliotic spines take them",
            Self::InVitro => "Thoracic segments with costovertebral joints, tested in vitro",
            Self::IntactChest => "The same with the cage of ribs",
            Self::ScolioticInVivo => "Segments of scoliotic patients during surgery",
            Self::Coupled => {
                "The paper's, with axial rotation coupled to lateral bending (counts with free support)"
            }
        }
    }
}

impl Choice for TiltRule {
    fn help(self) -> &'static str {
        match self {
            Self::Endplates => "Mean direction of both endplates",
            Self::Axis => "Line through the centres of the endplates (the paper)",
        }
    }
}

impl Choice for FitTarget {
    fn help(self) -> &'static str {
        match self {
            Self::Shape => "Locations and tilts of all vertebrae",
            Self::Ferguson => {
                "Three Ferguson angles per bend, with the amplitude fixed (the paper)"
            }
        }
    }
}

impl Choice for Grouping {
    fn spelling(self) -> &'static str {
        match self {
            Self::Regional => "regional",
            Self::PerJoint => "per-joint",
        }
    }

    fn help(self) -> &'static str {
        match self {
            Self::Regional => "One multiplier per region (the paper)",
            Self::PerJoint => "One per joint, fitted to the whole shape",
        }
    }
}
