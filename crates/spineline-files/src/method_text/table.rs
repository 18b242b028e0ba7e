//! Every option of the method, defined once: its name, what it is, the values that it takes, how they are read, and how they are shown.

use spineline::analysis::{AnalysisOptions, Grouping, Method};
use spineline::anatomy::Named;
use spineline::curve::InflectionChoice;
use spineline::measure::{AmplitudeEnds, TiltRule};
use spineline::multibody::{StiffnessTable, Support};
use spineline::personalize::FitTarget;

use super::parse::{
    curve_turn, end_vertebrae, film_lengths, gauge, given_lines, hypotheses, inflection_sites,
    named, order_rule, prior, reference,
};
use super::{show, words};
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
    /// Stands for a value in the help of the command line.
    pub value_name: &'static str,
    /// Values that it takes.
    pub values: OptionValues,
    /// Whether it may be given several times, each time with more.
    pub may_repeat: bool,
    /// Whether a study keeps it. The other options have separate results in a study.
    pub of_a_study: bool,
    /// Sets it by a word.
    pub(super) read: fn(&mut AnalysisOptions, &str) -> Result<(), String>,
    /// Sets it by the text of a file; `None` where it takes no file.
    pub(super) read_file: Option<ReadFile>,
    /// Its value as [`Self::read`] takes it; empty if no word gives it.
    pub(super) show: fn(&AnalysisOptions) -> String,
    /// Its value in a report.
    pub(super) words: fn(&AnalysisOptions) -> String,
}

/// Sets an option by the text of a file, and returns the distribution of joint rotations that it holds.
pub(super) type ReadFile =
    fn(&mut AnalysisOptions, &str) -> Result<Option<StoredRotationPrior>, FileError>;

/// Values of an option, other than files.
#[derive(Debug, Clone, Copy)]
pub enum OptionValues {
    /// These and no others.
    Named(fn() -> Vec<NamedValue>),
    /// These, and others that the help describes.
    Text(&'static [&'static str]),
}

/// A value with a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedValue {
    /// How it is spelled.
    pub spelling: String,
    /// Its sentence in the help.
    pub help: String,
}

/// The values of a type, as options spell them.
#[must_use]
pub fn named_values<T: Named>() -> Vec<NamedValue> {
    let value = |value: &T| NamedValue {
        spelling: show::spelling(*value),
        help: value.help().trim_end_matches('.').to_owned(),
    };
    T::ALL.iter().map(value).collect()
}

impl MethodOption {
    /// Its values with a name; empty where it takes others too.
    #[must_use]
    pub fn named_values(&self) -> Vec<NamedValue> {
        match self.values {
            OptionValues::Named(all) => all(),
            OptionValues::Text(_) => Vec::new(),
        }
    }

    /// Its value among some options, as the command line takes it; empty if no word gives it.
    #[must_use]
    pub fn shown(&self, options: &AnalysisOptions) -> String {
        (self.show)(options)
    }

    /// The value that it has where none is given; empty if no word gives it.
    #[must_use]
    pub fn default_text(&self) -> String {
        self.shown(&AnalysisOptions::default())
    }

    /// Its value among some options, in the words of a report.
    #[must_use]
    pub fn words(&self, options: &AnalysisOptions) -> String {
        (self.words)(options)
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

/// The method from which the fewest choices differ; the default one of two.
#[must_use]
pub fn nearest_method(options: &AnalysisOptions) -> Method {
    let departures = |method: &Method| departures(options, &method.options()).count();
    Method::ALL.into_iter().min_by_key(departures).unwrap_or_default()
}

/// The options whose values differ from a method.
pub fn departures<'a>(
    options: &'a AnalysisOptions,
    method: &'a AnalysisOptions,
) -> impl Iterator<Item = &'static MethodOption> + use<'a> {
    // The first row is the method itself.
    OPTIONS[1..].iter().filter(|option| option.words(options) != option.words(method))
}

/// All options of the method, in the order of the help of the command line. The first one sets all others.
pub const OPTIONS: [MethodOption; 18] = [
    MethodOption {
        name: "method",
        title: "Method",
        help: "Method that the other options start from; each that is given replaces a choice of the method",
        value_name: "METHOD",
        values: OptionValues::Named(named_values::<Method>),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| named::<Method>(text).map(|method| *options = method.options()),
        read_file: None,
        show: |options| show::spelling(nearest_method(options)),
        words: |options| words::named(nearest_method(options)),
    },
    MethodOption {
        name: "order_rule",
        title: "Order of the curves",
        help: "Polynomial order of the curves: `leave-one-out`; `two-inflections`: least residual among orders with two inflections; `paper`: least residual, nearly always order 12; or a number from 4 to 12",
        value_name: "RULE",
        values: OptionValues::Text(&[
            "leave-one-out",
            "two-inflections",
            "paper",
            "5",
            "6",
            "7",
            "8",
        ]),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| order_rule(text).map(|it| options.order_rule = it),
        read_file: None,
        show: |options| show::order_rule(options.order_rule),
        words: |options| words::order_rule(options.order_rule),
    },
    MethodOption {
        name: "gauge",
        title: "Scale constraint (gauge)",
        help: "Scale constraint (gauge) of stiffness and force: `geometric-mean`, `frozen-force`, or `known-force:POSTURE=NEWTON` such as known-force:traction=120",
        value_name: "GAUGE",
        values: OptionValues::Text(&["geometric-mean", "frozen-force", "known-force:traction=120"]),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| gauge(text).map(|it| options.gauge = it),
        read_file: None,
        show: |options| show::gauge(options.gauge),
        words: |options| words::gauge(options.gauge),
    },
    MethodOption {
        name: "support",
        title: "Support",
        help: "Support of the patient; the paper's is `free`",
        value_name: "SUPPORT",
        values: OptionValues::Named(named_values::<Support>),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| named(text).map(|it| options.support = it),
        read_file: None,
        show: |options| show::spelling(options.support),
        words: |options| words::named(options.support),
    },
    MethodOption {
        name: "reference",
        title: "Reference",
        help: "Load on the springs in the shape of the erect film: `unloaded` (the paper), or `loaded:KG`, the weight of trunk, head and arms of a body of this mass, such as loaded:50. Use it if the patient lies on all other films, which are then without this weight",
        value_name: "unloaded|loaded:KG",
        values: OptionValues::Text(&["unloaded", "loaded:50"]),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| reference(text).map(|it| options.reference = it),
        read_file: None,
        show: |options| show::reference(options.reference),
        words: |options| words::reference(options.reference),
    },
    MethodOption {
        name: "fit",
        title: "Fitted to",
        help: "Quantity that the stiffness is fitted to",
        value_name: "FIT",
        values: OptionValues::Named(named_values::<FitTarget>),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| named(text).map(|it| options.target = it),
        read_file: None,
        show: |options| show::spelling(options.target),
        words: |options| words::named(options.target),
    },
    MethodOption {
        name: "tilt",
        title: "Tilts",
        help: "Landmarks from which the tilt of a vertebra is measured",
        value_name: "TILT",
        values: OptionValues::Named(named_values::<TiltRule>),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| named(text).map(|it| options.tilt = it),
        read_file: None,
        show: |options| show::spelling(options.tilt),
        words: |options| words::named(options.tilt),
    },
    MethodOption {
        name: "amplitude",
        title: "Amplitude",
        help: "Vertebrae between which the amplitude of a film is measured",
        value_name: "ENDS",
        values: OptionValues::Named(named_values::<AmplitudeEnds>),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| named(text).map(|it| options.amplitude = it),
        read_file: None,
        show: |options| show::spelling(options.amplitude),
        words: |options| words::named(options.amplitude),
    },
    MethodOption {
        name: "film_lengths",
        title: "Lengths of the films",
        help: "Lengths of the films: `per-film` (each film has a scale against the erect film; its standard deviation is 3.3 % where it or the erect film states no error), a number (another standard deviation, in percent), or `as-marked` (one scale, as in the paper)",
        value_name: "RULE",
        values: OptionValues::Text(&["per-film", "as-marked"]),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| film_lengths(text).map(|it| options.film_lengths = it),
        read_file: None,
        show: |options| show::film_lengths(options.film_lengths),
        words: |options| words::film_lengths(options.film_lengths),
    },
    MethodOption {
        name: "end_vertebrae",
        title: "End vertebrae",
        help: "End vertebrae of Cobb angles: `erect` (the most tilted ones of the erect film, kept on every film), `each-film`, or REGION=LEVEL/LEVEL such as main-thoracic=T12/T5",
        value_name: "CHOICE",
        values: OptionValues::Text(&["erect", "each-film", "main-thoracic=T12/T5"]),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| end_vertebrae(text).map(|it| options.ends = it),
        read_file: None,
        show: |options| show::end_vertebrae(&options.ends),
        words: |options| words::end_vertebrae(&options.ends),
    },
    MethodOption {
        name: "multipliers",
        title: "Multipliers",
        help: "Joints that share a stiffness multiplier",
        value_name: "MULTIPLIERS",
        values: OptionValues::Named(named_values::<Grouping>),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| named(text).map(|it| options.grouping = it),
        read_file: None,
        show: |options| show::spelling(options.grouping),
        words: |options| words::named(options.grouping),
    },
    MethodOption {
        name: "prior",
        title: "Prior of the multipliers",
        help: "Log-normal prior of the multipliers, centred at their mean: `none`, a standard deviation of ln such as 0.3, or `in-vivo` (0.5, the standard deviation between segments of living scoliotic spines)",
        value_name: "none|in-vivo|SD",
        values: OptionValues::Text(&["none", "in-vivo", "0.3"]),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| prior(text).map(|it| options.prior = it),
        read_file: None,
        show: |options| show::prior(options.prior),
        words: |options| words::prior(options.prior),
    },
    MethodOption {
        name: "rotation_prior",
        title: "Distribution of joint rotations",
        help: "Distribution of joint rotations that `spineline learn-prior` learned from other patients, for predictions without mechanics and, with the tilt of T2, for lines and loads [default: published mobilities]",
        value_name: "FILE",
        values: OptionValues::Named(Vec::new),
        may_repeat: false,
        of_a_study: true,
        read: |_, _| Err("expected a file of `spineline learn-prior`".to_owned()),
        read_file: Some(|options, text| {
            let stored = parse_rotation_prior(text)?;
            options.rotation_prior = Some(stored.prior.clone());
            Ok(Some(stored))
        }),
        show: |_| String::new(),
        words: |options| words::rotation_prior(options.rotation_prior.as_ref()),
    },
    MethodOption {
        name: "stiffness",
        title: "Stiffness table",
        help: "Stiffness table to start from: `motion-segments`, `in-vitro`, `intact-chest`, `scoliotic-in-vivo` or `coupled` (`spineline stiffness` prints them), or a file",
        value_name: "TABLE|FILE",
        values: OptionValues::Named(named_values::<StiffnessTable>),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| {
            named::<StiffnessTable>(text).map(|table| options.library = table.library())
        },
        read_file: Some(|options, text| {
            options.library = parse_stiffness(text)?;
            Ok(None)
        }),
        show: |options| show::stiffness(&options.library),
        words: |options| words::stiffness(&options.library),
    },
    MethodOption {
        name: "inflections",
        title: "Inflections",
        help: "Inflections set by hand, caudal first, each a disc or the midpoint of a vertebra, such as L1/T12,T6 [default: found on the erect film]",
        value_name: "SITE,SITE",
        values: OptionValues::Text(&[]),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| {
            inflection_sites(text).map(|it| options.inflections = InflectionChoice::ByHand(it))
        },
        read_file: None,
        show: |options| show::inflections(options.inflections),
        words: |options| words::inflections(options.inflections),
    },
    MethodOption {
        name: "min_curve",
        title: "Minimum angle of a curve",
        help: "Minimum angle of a curve between inflections, in degrees",
        value_name: "DEG",
        values: OptionValues::Text(&[]),
        may_repeat: false,
        of_a_study: true,
        read: |options, text| curve_turn(text).map(|it| options.min_curve = it),
        read_file: None,
        show: |options| show::min_curve(options.min_curve),
        words: |options| format!("{}°", show::min_curve(options.min_curve)),
    },
    MethodOption {
        name: "given_line",
        title: "Given line of action",
        help: "Additional line of action: POSTURE=Y,Z,TILT with a point in mm and the lateral tilt from cranial in degrees, positive to the right; may be repeated",
        value_name: "LINE",
        values: OptionValues::Text(&[]),
        may_repeat: true,
        of_a_study: true,
        read: |options, text| given_lines(&mut options.given_lines, text),
        read_file: None,
        show: |options| show::given_lines(&options.given_lines),
        words: |options| words::given_lines(&options.given_lines),
    },
    MethodOption {
        name: "compare_models",
        title: "Compared loads and bases",
        help: "Compare other loads and base supports with the paper's line, on fitted and left-out films: `all`, or names such as couple,weight,inflection-line+free-base (see validation/lines.md)",
        value_name: "all|NAME,NAME",
        values: OptionValues::Text(&["all"]),
        may_repeat: false,
        of_a_study: false,
        read: |options, text| hypotheses(text).map(|it| options.hypotheses = it),
        read_file: None,
        show: |options| show::hypotheses(&options.hypotheses),
        words: |options| words::hypotheses(&options.hypotheses),
    },
];
