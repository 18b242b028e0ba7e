//! Every option of the method, defined once: its name, what it is, the values that it takes, and how they are read.

use spineline::analysis::AnalysisOptions;
use spineline::anatomy::Named;
use spineline::curve::InflectionChoice;
use spineline::multibody::StiffnessTable;

use super::parse::{
    curve_turn, end_vertebrae, film_lengths, gauge, given_line, hypotheses, inflection_sites,
    order_rule, prior,
};
use crate::{FileError, StoredRotationPrior, parse_rotation_prior, parse_stiffness};

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
    /// Stands for a value in the help of the command line.
    pub value_name: &'static str,
    /// Values that it takes.
    pub values: OptionValues,
    /// Sets it by a word.
    pub(super) read: fn(&mut AnalysisOptions, &str) -> Result<(), String>,
    /// Sets it by the text of a file; `None` where it takes no file.
    pub(super) read_file: Option<ReadFile>,
}

/// Sets an option by the text of a file, and returns the distribution of joint rotations that it holds.
pub(super) type ReadFile =
    fn(&mut AnalysisOptions, &str) -> Result<Option<StoredRotationPrior>, FileError>;

/// Values of an option, other than files.
#[derive(Debug, Clone, Copy)]
pub enum OptionValues {
    /// These and no others.
    Named(&'static [NamedValue]),
    /// These, and others that the help describes.
    Text(&'static [&'static str]),
}

/// A value with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NamedValue {
    /// How it is spelled.
    pub spelling: &'static str,
    /// What a help text says of it; empty where the spelling says it.
    pub help: &'static str,
}

impl NamedValue {
    /// A value with what a help text says of it.
    #[must_use]
    pub const fn new(spelling: &'static str, help: &'static str) -> Self {
        Self { spelling, help }
    }
}

impl MethodOption {
    /// Its values with a name; empty where it takes others too.
    #[must_use]
    pub const fn named_values(&self) -> &'static [NamedValue] {
        match self.values {
            OptionValues::Named(all) => all,
            OptionValues::Text(_) => &[],
        }
    }

    /// Whether a value may be the name of a file.
    #[must_use]
    pub const fn takes_a_file(&self) -> bool {
        self.read_file.is_some()
    }

    /// Whether this value is the name of a file.
    #[must_use]
    pub fn names_a_file(&self, value: &str) -> bool {
        let spelled = value.replace('_', "-");
        self.takes_a_file() && self.named_values().iter().all(|one| one.spelling != spelled)
    }

    /// Whether it may be given several times, each time with another film.
    #[must_use]
    pub fn may_repeat(&self) -> bool {
        self.name == "given_line"
    }

    /// Checks a value without setting anything; the file that it may name is not read.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn check(&self, value: &str) -> Result<(), String> {
        if self.names_a_file(value) {
            return Ok(());
        }
        (self.read)(&mut AnalysisOptions::default(), value)
    }
}

/// A value by its key, in either spelling.
pub(super) fn named<T: Named>(text: &str) -> Result<T, String> {
    T::from_key(&text.replace('-', "_")).ok_or_else(|| {
        let known: Vec<String> = T::ALL.iter().map(|value| value.key().replace('_', "-")).collect();
        format!("expected one of {}", known.join(", "))
    })
}

/// All options of the method, in the order of the help of the command line.
pub const OPTIONS: [MethodOption; 15] = [
    MethodOption {
        name: "order_rule",
        title: "Order of the curves",
        help: "Polynomial order of the curves: `leave-one-out`, `paper`, or a number from 4 to 12",
        default: "leave-one-out",
        value_name: "RULE",
        values: OptionValues::Text(&["leave-one-out", "paper", "5", "6", "7", "8"]),
        read: |options, text| order_rule(text).map(|it| options.order_rule = it),
        read_file: None,
    },
    MethodOption {
        name: "gauge",
        title: "Scale constraint (gauge)",
        help: "Scale constraint (gauge) of stiffness and force: `geometric-mean`, `frozen-force`, or `known-force:POSTURE=NEWTON` such as known-force:traction=120",
        default: "geometric-mean",
        value_name: "GAUGE",
        values: OptionValues::Text(&["geometric-mean", "frozen-force", "known-force:traction=120"]),
        read: |options, text| gauge(text).map(|it| options.gauge = it),
        read_file: None,
    },
    MethodOption {
        name: "support",
        title: "Support",
        help: "Support of the patient; the paper's is `free`",
        default: "frontal",
        value_name: "SUPPORT",
        values: OptionValues::Named(&[
            NamedValue::new("free", "Every joint rotates about three axes (the paper)"),
            NamedValue::new(
                "frontal",
                "In the frontal plane, as on a table: flexion and axial rotation are locked",
            ),
        ]),
        read: |options, text| named(text).map(|it| options.support = it),
        read_file: None,
    },
    MethodOption {
        name: "fit",
        title: "Fitted to",
        help: "Quantity that the stiffness is fitted to",
        default: "shape",
        value_name: "FIT",
        values: OptionValues::Named(&[
            NamedValue::new("shape", "Locations and tilts of all vertebrae"),
            NamedValue::new(
                "ferguson",
                "Three Ferguson angles per bend, with the amplitude fixed (the paper)",
            ),
        ]),
        read: |options, text| named(text).map(|it| options.target = it),
        read_file: None,
    },
    MethodOption {
        name: "tilt",
        title: "Tilts",
        help: "Landmarks from which the tilt of a vertebra is measured",
        default: "endplates",
        value_name: "TILT",
        values: OptionValues::Named(&[
            NamedValue::new("endplates", "Mean direction of both endplates"),
            NamedValue::new("axis", "Line through the centres of the endplates (the paper)"),
        ]),
        read: |options, text| named(text).map(|it| options.tilt = it),
        read_file: None,
    },
    MethodOption {
        name: "film_lengths",
        title: "Lengths of the films",
        help: "Lengths of the films: `per-film` (each has a scale of its own against the erect film; standard deviation 3.3 % where films do not state the error of theirs), that standard deviation in percent, or `as-marked` (one scale, as in the paper)",
        default: "per-film",
        value_name: "RULE",
        values: OptionValues::Text(&["per-film", "as-marked"]),
        read: |options, text| film_lengths(text).map(|it| options.film_lengths = it),
        read_file: None,
    },
    MethodOption {
        name: "end_vertebrae",
        title: "End vertebrae",
        help: "End vertebrae of Cobb angles: `erect` (the most tilted ones of the erect film, kept on every film), `each-film`, or REGION=LEVEL/LEVEL such as main-thoracic=T12/T5",
        default: "erect",
        value_name: "CHOICE",
        values: OptionValues::Text(&["erect", "each-film", "main-thoracic=T12/T5"]),
        read: |options, text| end_vertebrae(text).map(|it| options.ends = it),
        read_file: None,
    },
    MethodOption {
        name: "multipliers",
        title: "Multipliers",
        help: "Joints that share a stiffness multiplier",
        default: "regional",
        value_name: "MULTIPLIERS",
        values: OptionValues::Named(&[
            NamedValue::new("regional", "One multiplier per region (the paper)"),
            NamedValue::new("per-joint", "One per joint, fitted to the whole shape"),
        ]),
        read: |options, text| named(text).map(|it| options.grouping = it),
        read_file: None,
    },
    MethodOption {
        name: "prior",
        title: "Prior of the multipliers",
        help: "Log-normal prior of the multipliers about their mean: `none`, a standard deviation of ln such as 0.3, or `in-vivo` (0.5, the standard deviation between segments of living scoliotic spines)",
        default: "none",
        value_name: "none|in-vivo|SD",
        values: OptionValues::Text(&["none", "in-vivo", "0.3"]),
        read: |options, text| prior(text).map(|it| options.prior = it),
        read_file: None,
    },
    MethodOption {
        name: "rotation_prior",
        title: "Distribution of joint rotations",
        help: "Distribution of joint rotations that `spineline learn-prior` learned from other patients, for the predictions without mechanics that models are compared with [default: published mobilities]",
        default: "",
        value_name: "FILE",
        values: OptionValues::Named(&[]),
        read: |_, _| Err("expected a file of `spineline learn-prior`".to_owned()),
        read_file: Some(|options, text| {
            let stored = parse_rotation_prior(text)?;
            options.rotation_prior = Some(stored.prior.clone());
            Ok(Some(stored))
        }),
    },
    MethodOption {
        name: "stiffness",
        title: "Stiffness table",
        help: "Stiffness table to start from: `paper`, `in-vitro`, `intact-chest`, `scoliotic-in-vivo` or `coupled` (`spineline stiffness` prints them), or a file",
        default: "paper",
        value_name: "TABLE|FILE",
        values: OptionValues::Named(&[
            NamedValue::new(
                "paper",
                "Motion segments without ribs, as models of scoliotic spines take them",
            ),
            NamedValue::new(
                "in-vitro",
                "Thoracic segments with costovertebral joints, tested in vitro",
            ),
            NamedValue::new("intact-chest", "The same with the cage of ribs"),
            NamedValue::new("scoliotic-in-vivo", "Segments of scoliotic patients during surgery"),
            NamedValue::new(
                "coupled",
                "The paper's, with axial rotation coupled to lateral bending (counts with free support)",
            ),
        ]),
        read: |options, text| {
            named::<StiffnessTable>(text).map(|table| options.library = table.library())
        },
        read_file: Some(|options, text| {
            options.library = parse_stiffness(text)?;
            Ok(None)
        }),
    },
    MethodOption {
        name: "inflections",
        title: "Inflections",
        help: "Inflections set by hand, caudal first, each a vertebra or a disc, such as L1/T12,T6 [default: found on the erect film]",
        default: "",
        value_name: "SITE,SITE",
        values: OptionValues::Text(&[]),
        read: |options, text| {
            inflection_sites(text).map(|it| options.inflections = InflectionChoice::ByHand(it))
        },
        read_file: None,
    },
    MethodOption {
        name: "min_curve",
        title: "Minimum angle of a curve",
        help: "Minimum angle of a curve between inflections, in degrees",
        default: "5",
        value_name: "DEG",
        values: OptionValues::Text(&[]),
        read: |options, text| curve_turn(text).map(|it| options.min_curve = it),
        read_file: None,
    },
    MethodOption {
        name: "given_line",
        title: "Given line of action",
        help: "Additional line of action: POSTURE=Y,Z,TILT with a point in mm and the lateral tilt from cranial in degrees, positive to the right; may be repeated",
        default: "",
        value_name: "LINE",
        values: OptionValues::Text(&[]),
        read: |options, text| given_line(text).map(|it| options.given_lines.push(it)),
        read_file: None,
    },
    MethodOption {
        name: "compare_models",
        title: "Compared loads and bases",
        help: "Compare other loads and base supports with the paper's line, on fitted and left-out films: `all`, or names such as couple,weight,inflection-line+free-base (see docs/models.md)",
        default: "",
        value_name: "all|NAME,NAME",
        values: OptionValues::Text(&["all"]),
        read: |options, text| hypotheses(text).map(|it| options.hypotheses = it),
        read_file: None,
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
