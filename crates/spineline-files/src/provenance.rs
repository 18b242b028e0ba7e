//! Provenance of outputs.

use std::collections::{BTreeMap, HashSet};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::FileError;
use crate::content::ContentHash;
use crate::json::parse;
use crate::published_record::PublishedRecord;
use crate::rotation_prior_record::RotationPriorRecord;
use crate::stiffness_file::StiffnessFile;

/// The run of a program, given by the program: no function here reads a clock or a command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProgramRun {
    /// Name and version.
    pub program: String,
    /// Words of the command line.
    pub command: Vec<String>,
    /// When it ran, in UTC, as RFC 3339 has it.
    pub date_utc: String,
}

/// A file that was read, and which bytes it had.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
pub struct InputFile {
    /// Its name without its folder, which may carry a name of a person.
    pub name: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
}

impl InputFile {
    /// A file with these bytes.
    #[must_use]
    pub fn of(name: impl Into<String>, bytes: &[u8]) -> Self {
        Self { name: name.into(), sha256: crate::sha256_hex(bytes) }
    }
}

spineline::named! {
    /// Whether the films are synthetic.
    pub enum FilmOrigin {
        /// All are synthetic.
        Synthetic = "synthetic",
        /// None is.
        Real = "real",
        /// Some are.
        SyntheticAndReal = "synthetic_and_real",
    }
}

impl FilmOrigin {
    /// The origin of cases that are synthetic or not; `Real` without cases.
    #[must_use]
    pub fn of(synthetic: impl IntoIterator<Item = bool>) -> Self {
        let (mut some, mut all) = (false, true);
        for synthetic in synthetic {
            some |= synthetic;
            all &= synthetic;
        }
        match (some, all) {
            (true, true) => Self::Synthetic,
            (true, false) => Self::SyntheticAndReal,
            (false, _) => Self::Real,
        }
    }
}

/// Everything on which an output depends, and the time of its making.
///
/// The options name the gauge, the order rule and, joint by joint, the source of the stiffness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Provenance {
    /// Program and its version.
    pub program: String,
    /// Words of its command line.
    pub command: Vec<String>,
    /// In UTC; the time that `SOURCE_DATE_EPOCH` names, where it is set.
    pub date_utc: String,
    /// Whether the films are `synthetic`, `real`, or `synthetic_and_real`.
    pub films: FilmOrigin,
    /// The cases with results in the file; absent without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub case_ids: Vec<String>,
    /// Files that were read.
    pub inputs: Vec<InputFile>,
    /// Seed of everything random; absent if nothing is random.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) seed: Option<u64>,
    /// Whether it was asked which multipliers the films identify; absent if not requested.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) identifiability: bool,
    /// Replicates with perturbed landmarks; absent if not requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) replicates: Option<ReplicatesRecord>,
    /// Choices of the analysis; absent where nothing was analysed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) options: Option<OptionsRecord>,
    /// Published numbers of a typical spine that results rest on; absent where nothing was analysed or simulated. Springs have their
    /// sources beside them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    published_numbers: Vec<PublishedRecord>,
    /// SHA-256 of the file in which this stands, with 64 zeros in the place of this hash; absent where a provenance file has the
    /// hash of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    content_sha256: Option<ContentHash>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ReplicatesRecord {
    pub count: u64,
    /// Deviation of a landmark in pixels; `null` for the case's own readings.
    pub noise_px: Option<f64>,
}

/// The options of an analysis, each by its name: a value as the command line takes it, or the content of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct OptionsRecord {
    /// `null` where no value is given.
    #[serde(flatten)]
    pub words: BTreeMap<String, Option<String>>,
    /// Distribution of joint rotations learned from other patients; absent for the published one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation_prior: Option<RotationPriorRecord>,
    /// Springs before personalisation, each with its source.
    pub stiffness: StiffnessFile,
}

impl Provenance {
    /// Provenance of a program's output from files.
    #[must_use]
    pub fn new(run: ProgramRun, films: FilmOrigin, inputs: Vec<InputFile>) -> Self {
        let ProgramRun { program, command, date_utc } = run;
        Self {
            program,
            command,
            date_utc,
            films,
            case_ids: Vec::new(),
            inputs,
            seed: None,
            identifiability: false,
            replicates: None,
            options: None,
            published_numbers: Vec::new(),
            content_sha256: Some(ContentHash),
        }
    }

    /// The same with the published numbers that results of patients and of models rest on.
    #[must_use]
    pub fn with_published_numbers(mut self) -> Self {
        self.published_numbers = PublishedRecord::all();
        self
    }

    /// The same for a file with results of these cases.
    #[must_use]
    pub fn of_cases(mut self, ids: impl IntoIterator<Item = String>) -> Self {
        self.case_ids = ids.into_iter().collect();
        self
    }

    /// The same within a file whose hash is in a provenance file, and not within itself.
    #[must_use]
    pub fn of_listed_file(mut self) -> Self {
        self.content_sha256 = None;
        self
    }

    /// Provenance of a file that joins others: their inputs one after the other, and the choices of the first; `None` without parts.
    #[must_use]
    pub fn joining(run: ProgramRun, parts: &[&Self]) -> Option<Self> {
        let ProgramRun { program, command, date_utc } = run;
        let origins = parts.iter().map(|part| part.films);
        let films = origins
            .reduce(|one, other| if one == other { one } else { FilmOrigin::SyntheticAndReal })?;
        // What all parts have read is one input.
        let mut known = HashSet::new();
        let inputs = parts.iter().flat_map(|part| &part.inputs);
        let inputs = inputs.filter(|file| known.insert(*file)).cloned().collect();
        let case_ids = parts.iter().flat_map(|part| part.case_ids.clone()).collect();
        let first = (*parts.first()?).clone();
        Some(Self { program, command, date_utc, films, case_ids, inputs, ..first })
    }

    /// Whether both come of one program with one request, whatever the inputs.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        self.program == other.program
            && self.seed == other.seed
            && self.identifiability == other.identifiability
            && self.replicates == other.replicates
            && self.options == other.options
    }

    /// The same with a seed.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = Some(seed);
        self
    }
}

/// Format of a provenance file.
pub const PROVENANCE_FORMAT: &str = "spineline-provenance";
const VERSION: u32 = 1;

/// Reads a provenance file.
pub fn parse_provenance(text: &str) -> Result<ProvenanceFile, FileError> {
    parse(text, PROVENANCE_FORMAT, VERSION)
}

/// Provenance of files without a place for it, as a file beside them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Spineline provenance, version 1")]
pub struct ProvenanceFile {
    format: String,
    version: u32,
    /// The files that it is of, with the hashes of their bytes.
    #[serde(rename = "of")]
    pub files: Vec<InputFile>,
    provenance: Provenance,
}

impl ProvenanceFile {
    /// Of files beside it.
    #[must_use]
    pub fn new(files: Vec<InputFile>, provenance: Provenance) -> Self {
        Self { format: PROVENANCE_FORMAT.to_owned(), version: VERSION, files, provenance }
    }

    /// What they depend on.
    #[must_use]
    pub const fn provenance(&self) -> &Provenance {
        &self.provenance
    }
}
