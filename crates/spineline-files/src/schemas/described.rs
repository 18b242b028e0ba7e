//! Descriptions of named values in schemas.

use spineline::action::{Application, LineKind};
use spineline::analysis::{AxialSource, Grouping, PitchSource, Sex};
use spineline::anatomy::{ImageSide, Named, Posture, Region, SourceCheck};
use spineline::clinical::EndRule;
use spineline::cohort::{ComparisonOutcome, RefusalStep};
use spineline::evaluate::Baseline;
use spineline::measure::{Origin, PlacementSource, SpacingPlane, TiltRule};
use spineline::multibody::{MatchStatus, Support, Timing};
use spineline::personalize::{FitTarget, TestOutcome};

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

impl Described for LineKind {
    const DEFINITION: &'static str = "LineKey";
}

impl Described for MatchStatus {
    const DEFINITION: &'static str = "MatchStatusKey";
    const DESCRIPTION: &'static str = "How a search for a force ended.";
}

impl Described for TestOutcome {
    const DEFINITION: &'static str = "TestOutcomeKey";
    const DESCRIPTION: &'static str = "How the test of a hypothesis ended.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Rejected => "The data contradict the hypothesis (p < 0.05).",
            Self::Kept => "Tested and not rejected. This does not prove the hypothesis.",
            Self::NotTested => "The test could not be made: the data say nothing.",
        }
    }
}

impl Described for ComparisonOutcome {
    const DEFINITION: &'static str = "ComparisonOutcomeKey";
    const DESCRIPTION: &'static str = "What a comparison of errors says of the first model.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Better => "Its error is smaller, significantly after Holm's correction.",
            Self::Worse => {
                "Its error is larger: significantly after Holm's correction, or the whole 95 % interval of the difference over at least six patients is above zero."
            }
            Self::NoDifference => "The data show no difference.",
            Self::NotTested => "Too few patients have both.",
        }
    }
}

impl Described for RefusalStep {
    const DEFINITION: &'static str = "RefusalStepKey";
    const DESCRIPTION: &'static str = "Step at which a case was refused.";

    fn meaning(self) -> &'static str {
        match self {
            Self::Reading => "Its file could not be read.",
            Self::Analysis => "Its films could not be analysed.",
            Self::Counting => "It was analysed, and cannot be counted beside the others.",
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

impl Described for SourceCheck {
    const DEFINITION: &'static str = "SourceCheckKey";
    const DESCRIPTION: &'static str = "How far published numbers were compared with their source.";

    fn meaning(self) -> &'static str {
        match self {
            Self::AtSource => "With its text, its abstract or its data.",
            Self::SecondHand => "With another text that quotes it.",
            Self::Unverified => "With no text.",
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
