//! One patient through all steps: [`analyze`].
//!
//! | file | question |
//! |---|---|
//! | `measured`, `checks`, `wrong_film`, `film_likelihood` | What do the films show? Are they the films that they are named after? |
//! | `movement`, `standing`, `template` | How does the spine move, before any force? How does it stand in space? |
//! | `find_best_fit`, `best_fit_line`, `compatibility` | Which force explains the rotations best? Do the bends reject a candidate? |
//! | `models`, `line_model`, `identification`, `force_path` | Which stiffness and forces belong to each line? |
//! | `hypotheses` | Which other loads explain the bends? |
//! | `compare_lines`, `comparison`, `find_bands`, `bands` | How well is a film predicted that was not fitted? |
//! | `choice`, `personalised_model` | Which model stands for the patient, and what do loads do to it? |
//! | `headline`, `verdict`, `models_verdict`, `endings`, `words` | What do the results say, in words and warnings? |
//!
//! `analyze` runs the steps, `options` has their choices, and `result` has all results.

mod analyze;
mod bands;
mod best_fit_line;
mod checks;
mod choice;
mod clinic;
mod compare_lines;
mod comparison;
mod compatibility;
mod endings;
mod film_likelihood;
mod find_bands;
mod find_best_fit;
mod force_path;
mod headline;
mod hypotheses;
mod identification;
mod inflections;
mod line_model;
mod measured;
mod models;
mod models_verdict;
mod movement;
mod options;
mod personalised_model;
mod result;
mod standing;
mod template;
mod verdict;
mod words;
mod wrong_film;

pub(crate) use analyze::{FitStarts, analyze_films};
pub use analyze::{analyze, analyze_movement};
pub use bands::{BAND_COVERAGE, Bands, FilmBands};
pub use best_fit_line::{BestFitLine, LineComparison, LineCrossing};
pub use checks::check_repeated;
pub use choice::ModelChoice;
pub(crate) use comparison::ferguson_errors_deg;
pub use comparison::{
    ComparedFilm, ComparedLine, FilmPredictor, FilmRole, FreeNumbers, LeftOutBend, LinesCompared,
    MeanErrors, Ranking,
};
pub use compatibility::{BendEvidence, Compatibility};
pub use headline::Headline;
pub use identification::{MultiplierEnding, MultiplierVerdict};
pub use line_model::LineModel;
pub(crate) use measured::Replicated;
pub use models_verdict::ModelsVerdict;
pub use movement::{FilmMovement, Movement};
pub use options::{AnalysisOptions, Grouping, Method, Reference};
pub use personalised_model::{FilmLoad, PersonalisedModel, SimulationError};
pub use result::Analysis;
pub use standing::{AxialSource, PitchSource};
pub use template::{ProfileVertebra, TemplateError};
pub(crate) use verdict::{listed, no_prediction_words};

use crate::anatomy::{Posture, named};
use crate::measure::{Film, LateralFilm};

named! {
    /// Sex of a patient as far as it was recorded.
    pub enum Sex {
        /// Female.
        Female = "female",
        /// Male.
        Male = "male",
        /// Recorded as neither.
        Other = "other",
    }
}

/// Who was X-rayed, without any name.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Subject {
    /// Sex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sex: Option<Sex>,
    /// Age at the films.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub age_years: Option<f64>,
    /// Lenke class as clinicians recorded it, such as `1A`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lenke: Option<String>,
}

/// Characters of the identifier of a case, in words.
pub const CASE_ID_RULE: &str = "1 to 64 letters (A to Z, a to z), digits, `.`, `-` and `_`";

/// Whether a text is the identifier of a case, by [`CASE_ID_RULE`]: a word without blanks, commas and carets, which names of persons have.
#[must_use]
pub fn is_case_id(text: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"._-".contains(&byte);
    (1..=64).contains(&text.len()) && text.bytes().all(is_plain)
}

/// Lenke classes, in words.
pub const LENKE_RULE: &str =
    "a type from 1 to 6, then A, B or C, then -, N or +, each where it is known: 1, 1A or 1AN";

/// Whether a text is a Lenke class, by [`LENKE_RULE`]; files allow only these.
#[must_use]
pub fn is_lenke_class(text: &str) -> bool {
    let Some(modifiers) = text.strip_prefix(['1', '2', '3', '4', '5', '6']) else { return false };
    let sagittal = modifiers.strip_prefix(['A', 'B', 'C']).unwrap_or(modifiers);
    matches!(sagittal, "" | "-" | "N" | "+")
}

/// The films of one patient.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Identifier, without any name; files allow only [`is_case_id`].
    pub id: String,
    /// Whether the films are synthetic.
    pub synthetic: bool,
    /// Who was X-rayed.
    pub subject: Subject,
    /// The films, one per posture, in any order.
    pub films: Vec<Film>,
    /// A film from the side, for the sagittal profile.
    pub lateral: Option<LateralFilm>,
}

impl Case {
    /// Frontal films of a person of whom nothing else is known.
    #[must_use]
    pub fn of_films(id: impl Into<String>, films: Vec<Film>) -> Self {
        let subject = Subject::default();
        Self { id: id.into(), synthetic: false, subject, films, lateral: None }
    }

    /// The frontal film of a posture, where the case has one.
    #[must_use]
    pub fn film(&self, posture: Posture) -> Option<&Film> {
        self.films.iter().find(|film| film.posture == posture)
    }

    /// The same, to change it.
    pub fn film_mut(&mut self, posture: Posture) -> Option<&mut Film> {
        self.films.iter_mut().find(|film| film.posture == posture)
    }
}
