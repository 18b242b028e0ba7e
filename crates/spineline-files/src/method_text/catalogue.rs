//! Every option of the method: its name, what it is, and the values that it takes.

use spineline::analysis::Grouping;
use spineline::measure::TiltRule;
use spineline::multibody::{StiffnessTable, Support};
use spineline::personalize::FitTarget;

use super::choice::Choice;

/// An option of the method.
#[derive(Debug, Clone, Copy)]
pub struct MethodOption {
    /// Its name; `-` and `_` are the same in it.
    pub name: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// What it does, and the values that it takes.
    pub help: &'static str,
    /// The value that it has where none is given; empty where that is no text.
    pub default: &'static str,
    /// Values that it takes.
    pub values: OptionValues,
}

/// Values of an option.
#[derive(Debug, Clone, Copy)]
pub enum OptionValues {
    /// These and no others.
    Named(fn() -> Vec<NamedValue>),
    /// These, or the name of a file.
    NamedOrFile(fn() -> Vec<NamedValue>),
    /// These, and others that the help describes.
    Text(&'static [&'static str]),
    /// The name of a file.
    File,
}

impl OptionValues {
    /// Whether a value may be the name of a file.
    #[must_use]
    pub const fn takes_a_file(&self) -> bool {
        matches!(self, Self::NamedOrFile(_) | Self::File)
    }

    /// Whether this value is the name of a file.
    #[must_use]
    pub fn names_a_file(&self, value: &str) -> bool {
        let spelled = value.replace('_', "-");
        match self {
            Self::NamedOrFile(all) => {
                !all().iter().any(|one| [value, spelled.as_str()].contains(&one.spelling))
            }
            Self::File => true,
            Self::Named(_) | Self::Text(_) => false,
        }
    }
}

/// A value with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NamedValue {
    /// How it is spelled.
    pub spelling: &'static str,
    /// What a help text says of it; empty where the spelling says it.
    pub help: &'static str,
}

fn named_values<T: Choice>() -> Vec<NamedValue> {
    T::ALL
        .iter()
        .map(|one| NamedValue { spelling: one.spelling(), help: Choice::help(*one) })
        .collect()
}

/// All options of the method, in the order of the help of the command line.
pub const OPTIONS: [MethodOption; 15] = [
    MethodOption {
        name: "order_rule",
        title: "Order of the curves",
        help: "Polynomial order of the curves: `leave-one-out`, `paper`, or a number from 4 to 12",
        default: "leave-one-out",
        values: OptionValues::Text(&["leave-one-out", "paper", "5", "6", "7", "8"]),
    },
    MethodOption {
        name: "gauge",
        title: "Scale constraint (gauge)",
        help: "Scale constraint (gauge) of stiffness and force: `geometric-mean`, `frozen-force`, or `known-force:POSTURE=NEWTON` such as known-force:traction=120",
        default: "geometric-mean",
        values: OptionValues::Text(&["geometric-mean", "frozen-force", "known-force:traction=120"]),
    },
    MethodOption {
        name: "support",
        title: "Support",
        help: "Support of the patient; the paper's is `free`",
        default: "frontal",
        values: OptionValues::Named(named_values::<Support>),
    },
    MethodOption {
        name: "fit",
        title: "Fitted to",
        help: "Quantity that the stiffness is fitted to",
        default: "shape",
        values: OptionValues::Named(named_values::<FitTarget>),
    },
    MethodOption {
        name: "tilt",
        title: "Tilts",
        help: "Landmarks from which the tilt of a vertebra is measured",
        default: "endplates",
        values: OptionValues::Named(named_values::<TiltRule>),
    },
    MethodOption {
        name: "film_lengths",
        title: "Lengths of the films",
        help: "Lengths of the films: `per-film` (each has a scale of its own against the erect film; standard deviation 3.3 % where films do not state the error of theirs), that standard deviation in percent, or `as-marked` (one scale, as in the paper)",
        default: "per-film",
        values: OptionValues::Text(&["per-film", "as-marked"]),
    },
    MethodOption {
        name: "end_vertebrae",
        title: "End vertebrae",
        help: "End vertebrae of Cobb angles: `erect` (the most tilted ones of the erect film, kept on every film), `each-film`, or REGION=LEVEL/LEVEL such as main-thoracic=T12/T5",
        default: "erect",
        values: OptionValues::Text(&["erect", "each-film", "main-thoracic=T12/T5"]),
    },
    MethodOption {
        name: "multipliers",
        title: "Multipliers",
        help: "Joints that share a stiffness multiplier",
        default: "regional",
        values: OptionValues::Named(named_values::<Grouping>),
    },
    MethodOption {
        name: "prior",
        title: "Prior of the multipliers",
        help: "Log-normal prior of the multipliers about their mean: `none`, a standard deviation of ln such as 0.3, or `in-vivo` (0.5, the standard deviation between segments of living scoliotic spines)",
        default: "none",
        values: OptionValues::Text(&["none", "in-vivo", "0.3"]),
    },
    MethodOption {
        name: "rotation_prior",
        title: "Distribution of joint rotations",
        help: "Distribution of joint rotations that `spineline learn-prior` learned from other patients, for the predictions without mechanics that models are compared with [default: published mobilities]",
        default: "",
        values: OptionValues::File,
    },
    MethodOption {
        name: "stiffness",
        title: "Stiffness table",
        help: "Stiffness table to start from: `paper`, `in-vitro`, `intact-chest`, `scoliotic-in-vivo` or `coupled` (`spineline stiffness` prints them), or a file",
        default: "paper",
        values: OptionValues::NamedOrFile(named_values::<StiffnessTable>),
    },
    MethodOption {
        name: "inflections",
        title: "Inflections",
        help: "Inflections set by hand, caudal first, each a vertebra or a disc, such as L1/T12,T6 [default: found on the erect film]",
        default: "",
        values: OptionValues::Text(&[]),
    },
    MethodOption {
        name: "min_curve",
        title: "Minimum angle of a curve",
        help: "Minimum angle of a curve between inflections, in degrees",
        default: "5",
        values: OptionValues::Text(&[]),
    },
    MethodOption {
        name: "given_line",
        title: "Given line of action",
        help: "Additional line of action: POSTURE=Y,Z,TILT with a point in mm and the lateral tilt from cranial in degrees, positive to the right; may be repeated",
        default: "",
        values: OptionValues::Text(&[]),
    },
    MethodOption {
        name: "compare_models",
        title: "Compared loads and bases",
        help: "Compare other loads and base supports with the paper's line, on fitted and left-out films: `all`, or names such as couple,weight,inflection-line+free-base (see docs/models.md)",
        default: "",
        values: OptionValues::Text(&["all"]),
    },
];

/// The names of all options of the method; `-` and `_` are the same in them.
pub const OPTION_NAMES: [&str; OPTIONS.len()] = {
    let mut names = [""; OPTIONS.len()];
    let mut place = 0;
    while place < names.len() {
        names[place] = OPTIONS[place].name;
        place += 1;
    }
    names
};

/// The option of a name.
///
/// # Panics
/// If no option has it: names are written in the code.
#[must_use]
pub fn option_named(name: &str) -> &'static MethodOption {
    OPTIONS.iter().find(|option| option.name == name).expect("an option of the method")
}
