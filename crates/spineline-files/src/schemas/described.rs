//! Descriptions of named values in schemas.

use spineline::action::Application;
use spineline::analysis::{AxialSource, Grouping, PitchSource, Sex};
use spineline::anatomy::{ImageSide, Named, Posture, Region};
use spineline::clinical::EndRule;
use spineline::evaluate::Baseline;
use spineline::measure::{Origin, PlacementSource, SpacingPlane, TiltRule};
use spineline::multibody::{Support, Timing};
use spineline::personalize::FitTarget;

/// A named value as the schema of a file describes it.
pub trait Described: Named {
    /// Name of its definition in a schema.
    const DEFINITION: &'static str;
    /// Description of the values; empty where the name of the definition is sufficient.
    const DESCRIPTION: &'static str = "";

    /// Meaning of this value; empty where its name is sufficient.
    fn meaning(self) -> &'static str {
        ""
    }
}

impl Described for Posture {
    const DEFINITION: &'static str = "PostureKey";
    const DESCRIPTION: &'static str = "A posture.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Erect => "Standing.",
            Self::LeftBending => "Bending to the patient's left.",
            Self::RightBending => "Bending to the patient's right.",
            Self::Neutral => "Lying at rest.",
            Self::Traction => "Lying under traction.",
        }
    }
}

impl Described for PlacementSource {
    const DEFINITION: &'static str = "PlacementSourceKey";
    const DESCRIPTION: &'static str = "Where locations and tilts come from.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Vertebrae => "Vertebrae that were seen.",
            Self::SurfaceMidline => {
                "A midline of the back surface: levels by arc length, none of them seen."
            }
        }
    }
}

impl Described for Origin {
    const DEFINITION: &'static str = "OriginKey";
    const DESCRIPTION: &'static str = "How the place of a corner came about.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Clicked => "A person clicked it.",
            Self::Completed => {
                "Completed from other landmarks of the film; nobody has looked at it."
            }
            Self::Detected => "A program found it in the picture; nobody has looked at it.",
            Self::Accepted => "A person accepted a place that a program proposed.",
            Self::Adjusted => "A person moved a place that a program had proposed.",
        }
    }
}

impl Described for Region {
    const DEFINITION: &'static str = "RegionKey";
    const DESCRIPTION: &'static str = "A region of the spine.";

    fn meaning(self) -> &'static str {
        match self {
            Self::ThoracolumbarLumbar => "Thoracolumbar or lumbar.",
            Self::MainThoracic => "Main thoracic.",
            Self::ProximalThoracic => "Proximal thoracic.",
        }
    }
}

impl Described for Support {
    const DEFINITION: &'static str = "SupportKey";
    const DESCRIPTION: &'static str = "Support of the patient.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Free => "Free above L4.",
            Self::Frontal => "A table: flexion and axial hinges are locked.",
        }
    }
}

impl Described for PitchSource {
    const DEFINITION: &'static str = "PitchSourceKey";
    const DESCRIPTION: &'static str = "Where pitch and depth of a vertebra come from.";

    fn meaning(self) -> &'static str {
        match self {
            Self::LateralFilm => "Measured: the lateral film shows the vertebra.",
            Self::Population => "Assumed: the profile of a population.",
            Self::Given => "Assumed: a profile that the options give.",
        }
    }
}

impl Described for AxialSource {
    const DEFINITION: &'static str = "AxialSourceKey";
    const DESCRIPTION: &'static str = "Where the axial rotation of a vertebra comes from.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Pedicles => "Measured: both pedicles are marked on the erect film.",
            Self::Unknown => "Not known, and zero in the model.",
            Self::Given => "Assumed: the options give it.",
        }
    }
}

impl Described for Application {
    const DEFINITION: &'static str = "ApplicationKey";
    const DESCRIPTION: &'static str = "Kind of application of a force.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Fixed => "Along a line fixed in space.",
            Self::AtT2 => "At T2's midpoint.",
        }
    }
}

impl Described for Timing {
    const DEFINITION: &'static str = "TimingKey";
    const DESCRIPTION: &'static str = "Timing of a load.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Constant => "Constant: applied before the proportional loads, and then constant.",
            Self::Proportional => {
                "Proportional: increases with the load factor, after the constant loads."
            }
        }
    }
}

impl Described for SpacingPlane {
    const DEFINITION: &'static str = "PlaneKey";
}

impl Described for ImageSide {
    const DEFINITION: &'static str = "ImageSideKey";
}

impl Described for Sex {
    const DEFINITION: &'static str = "SexKey";
}

impl Described for FitTarget {
    const DEFINITION: &'static str = "FitKey";
}

impl Described for Baseline {
    const DEFINITION: &'static str = "BaselineKey";
}

impl Described for TiltRule {
    const DEFINITION: &'static str = "TiltRuleKey";
}

impl Described for EndRule {
    const DEFINITION: &'static str = "EndRuleKey";
}

impl Described for Grouping {
    const DEFINITION: &'static str = "GroupingKey";
}
