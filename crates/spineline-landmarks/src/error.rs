use spineline::anatomy::{FilmView, Level, Posture};
use spineline::fault::ErrorPlace;
use spineline::measure::{MeasureError, OBSERVER_RULE};
use spineline_files::FileError;
use spineline_marking::MidlineError;

/// How to give the side of the picture with the patient's left.
pub(crate) const GIVE_SIDE: &str = "name the film of the file, as in `--landmarks erect=FILE`, and its side with `--patient-left`; in Python give `patient_left`";
/// How to give the posture of a film.
pub(crate) const GIVE_POSTURE: &str =
    "name the film of the file, as in `--landmarks erect=FILE`; in Python give `film`";
const CORRECT_VALUE: &str = "correct the value; write numbers without units or formulas";
/// Remedy for contradicting parts of a file.
pub(crate) const CORRECT: &str = "correct the file at that place";

spineline::faults! {
    /// Error of reading a file of landmarks; `at` is the place in the file.
    #[derive(Debug, thiserror::Error)]
    #[non_exhaustive]
    pub enum LandmarkError {
        /// The file could not be read, or is too large.
        #[error(transparent)]
        #[help(error.help())]
        #[at(film = error.place().film, level = error.place().level, value = error.place().value, limit = error.place().limit)]
        File(#[from] FileError as error),
        /// Above a limit.
        #[error("{what}: {found}; the limit is {limit}")]
        #[help("give the landmarks of one patient in one file")]
        #[at(value = *found as f64, limit = *limit as f64)]
        TooLarge {
            /// What exceeds the limit.
            what: &'static str,
            /// Number found, as far as counted.
            found: u64,
            limit: u64,
        },
        /// A folder that is not one of AASCE.
        #[error("it is a folder without {missing}, and a folder is read only as an AASCE set")]
        #[help("give the files of landmarks in it one by one, each with its own --landmarks; an AASCE set has filenames.csv, landmarks.csv and image_sizes.csv")]
        Folder {
            /// The file that an AASCE set has.
            missing: &'static str,
        },
        /// The format of the file is unknown.
        #[error("unknown landmark format: {reason}")]
        #[help("give CSV, Slicer markups, labelme or COCO JSON, surface midlines, an AASCE .mat or folder, or a DICOM report of Spineline")]
        Unrecognised {
            /// What was looked for.
            reason: String,
        },
        /// A file of another program without readable landmarks.
        #[error("the file is {what}")]
        #[help(help)]
        Foreign {
            what: &'static str,
            help: &'static str,
        },
        /// The text has another encoding.
        #[error("{at}: the text is not in UTF-8 or UTF-16")]
        #[help("save the file as UTF-8; in Excel as `CSV UTF-8`")]
        Encoding {
            at: String,
        },
        /// The text does not follow its format.
        #[error("{at}: {reason}")]
        #[help("correct the file at that place, or export it again")]
        Syntax {
            at: String,
            reason: String,
        },
        /// A column that the table does not have.
        #[error("{at}: unknown column `{name}`{}", nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default())]
        #[help("correct the name, or remove the column")]
        Column {
            at: String,
            name: String,
            /// The known name that was probably meant.
            nearest: Option<String>,
        },
        /// A value outside of a list of names.
        #[error("{at}: unknown {what} `{name}`; expected one of {}", known.join(", "))]
        #[help("write one of these names")]
        Choice {
            at: String,
            /// Kind of value.
            what: &'static str,
            /// The value.
            name: String,
            /// All names.
            known: Vec<&'static str>,
        },
        /// A name of a point that does not name a landmark.
        #[error("{at}: `{name}` does not name a landmark: {reason}")]
        #[help("name points after vertebra and corner, such as T12_superior_left or T12 SL, and iliac_crest_left, iliac_crest_right")]
        PointName {
            at: String,
            name: String,
            /// What is missing or unknown.
            reason: String,
        },
        /// A required part is missing.
        #[error("{at}: {what} is missing")]
        #[help("add it to the file")]
        Missing {
            at: String,
            what: String,
        },
        /// A cell or value that is not a number, or is implausible.
        #[error("{at}: `{value}` is not {expected}")]
        #[help(CORRECT_VALUE)]
        #[at(value = value.parse::<f64>().ok())]
        Value {
            at: String,
            /// Value found.
            value: String,
            expected: &'static str,
        },
        /// A number outside of its limits.
        #[error("{at}: `{value}` is not {expected}")]
        #[help(CORRECT_VALUE)]
        #[at(value = *value, limit = ErrorPlace::limit(*value, limits[0], limits[1]))]
        Outside {
            /// Where in the file.
            at: String,
            /// Value found.
            value: f64,
            /// Expected value.
            expected: &'static str,
            /// The least and the most.
            limits: [f64; 2],
        },
        /// An invalid code of an observer.
        #[error("{at}: the observer is `{value}`, and must be {OBSERVER_RULE}")]
        #[help("write a code for the observer, the same in all files and studies, but not the name of a person")]
        Observer {
            at: String,
            /// The observer.
            value: String,
        },
        /// A name that is not a vertebra from T1 to L5.
        #[error("{at}: `{name}` is not a vertebra from T1 to L5{}", hint.map(|hint| format!(": {hint}")).unwrap_or_default())]
        #[help("name vertebrae T1 to T12 and L1 to L5 (Th12 and D12 are read too)")]
        Vertebra {
            at: String,
            name: String,
            hint: Option<&'static str>,
        },
        /// A repeated part within one reading of one film.
        #[error("{at}: {what} is given twice{}", first.as_ref().map(|first| format!(", first at {first}")).unwrap_or_default())]
        #[help("name each vertebra once per reading; a second reading needs its own observer or repeat")]
        Duplicate {
            /// Place of the second one.
            at: String,
            what: String,
            /// Where it stands first.
            first: Option<String>,
        },
        /// A vertebra, or the pair of iliac crests, without all of its points.
        #[error("{what}: landmarks missing: {}", missing.join(", "))]
        #[help("place the missing landmarks, or remove the vertebra")]
        Incomplete {
            /// Reading and vertebra.
            what: String,
            missing: Vec<String>,
        },
        /// Confidences for some corners of a vertebra only.
        #[error("{what}: confidences missing: {}", missing.join(", "))]
        #[help("give all four corners a confidence, or none")]
        Confidences {
            /// Reading and vertebra.
            what: String,
            /// Corners without a confidence.
            missing: Vec<String>,
        },
        /// A midline on which no levels can be placed.
        #[error("{at}: {fault}")]
        #[help(fault.help())]
        #[at(value = fault.place().value, limit = fault.place().limit)]
        Midline {
            at: String,
            fault: MidlineError,
        },
        /// The file can be understood in more than one way.
        #[error("{at}: {reason}")]
        #[help(help)]
        Ambiguous {
            at: String,
            /// The possible meanings.
            reason: String,
            help: &'static str,
        },
        /// Missing data on the picture that neither the file nor the caller gives.
        #[error("{format} needs {what}; the file does not contain it")]
        #[help(help)]
        Needs {
            /// Format of the file.
            format: &'static str,
            what: &'static str,
            help: &'static str,
        },
        /// The points belong to another picture.
        #[error(
            "the landmarks belong to a picture of {} × {} pixels, and this one has {} × {}", stated.0, stated.1, given.0, given.1
        )]
        #[help("give the picture on which the landmarks were placed")]
        OtherPicture {
            /// Columns and rows that the file states.
            stated: (u32, u32),
            /// Columns and rows of the picture.
            given: (u32, u32),
        },
        /// Points in space outside of any plane of a frontal film.
        #[error("{at}: {reason}")]
        #[help("place all landmarks of a film in one slice view, without rotating the picture")]
        Plane {
            /// Markups node.
            at: String,
            /// The problem of their coordinates.
            reason: String,
        },
        /// A DICOM object that is not a landmark report of Spineline.
        #[error("the DICOM object is not a report of landmarks by Spineline: {reason}")]
        #[help("give a report that `spineline export --to dicom-sr` wrote")]
        Report {
            reason: String,
        },
        /// An error of a film or vertebra that is known.
        #[error("{error}")]
        #[help(error.help())]
        #[at(film = posture.map(FilmView::from), level = *level, value = error.place().value, limit = error.place().limit)]
        Placed {
            posture: Option<Posture>,
            level: Option<Level>,
            error: Box<Self>,
        },
        /// Landmarks that cannot be measured.
        #[error(transparent)]
        #[help(error.help())]
        #[at(film = error.place().film, level = error.place().level, value = error.place().value, limit = error.place().limit)]
        Marks(#[from] MeasureError as error),
    }
}

impl LandmarkError {
    /// A part that is missing at this place.
    pub(crate) fn missing(at: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Missing { at: at.into(), what: what.into() }
    }

    /// The same error, of a film and a vertebra.
    pub(crate) fn of(self, posture: Option<Posture>, level: Option<Level>) -> Self {
        Self::Placed { posture, level, error: Box::new(self) }
    }

    /// What is wrong, without film and vertebra.
    #[must_use]
    pub fn cause(&self) -> &Self {
        match self {
            Self::Placed { error, .. } => error.cause(),
            _ => self,
        }
    }
}

spineline::faults! {
    /// A case that a landmark format cannot represent.
    #[derive(Debug, Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum LandmarkExportError {
        /// The posture has no film.
        #[error("the case has no {0} film")]
        #[help("name a posture that the case has a film of")]
        #[at(film = FilmView::from(*posture))]
        NoFilm(Posture as posture),
        /// Locations and tilts instead of corners.
        #[error("{0} film: it holds locations and tilts of another program, and no corners")]
        #[help("give a case that has corners of the vertebrae, or export as CSV or Slicer")]
        #[at(film = FilmView::from(*posture))]
        NoCorners(Posture as posture),
        /// Films with corners and films with locations do not go into one table.
        #[error("some films hold corners and some hold locations; a table holds only one kind")]
        #[help("export one posture at a time")]
        MixedKinds,
        /// Estimated levels in a format that cannot mark them as estimated.
        #[error(
            "{0} film: its levels were estimated on a surface midline, which this format cannot state"
        )]
        #[help("pass on the case file or the midline itself")]
        #[at(film = FilmView::from(*posture))]
        Estimated(Posture as posture),
        /// The name of an observer that a format cannot represent.
        #[error("the observer `{name}` cannot be written: {reason}")]
        #[help("give the observer a short code without control characters")]
        Observer {
            name: String,
            reason: &'static str,
        },
        /// A reading without any vertebra.
        #[error("{what}: no landmarks")]
        #[help("place the landmarks of a vertebra, or remove the reading from the case")]
        Nothing {
            /// Film and reading.
            what: String,
        },
        /// A coordinate that a format cannot represent.
        #[error("{what}, {level}: a corner is not a number, or lies outside of the picture")]
        #[help("run `spineline check CASE` to list the problems of the landmarks")]
        #[at(level = *level)]
        Corner {
            /// Film and reading.
            what: String,
            level: Level,
        },
        /// An iliac crest that a report cannot hold.
        #[error("{0} film: an iliac crest lies outside of the picture")]
        #[help("place the tips of both iliac crests on the picture, or remove both")]
        #[at(film = FilmView::from(*posture))]
        Crests(Posture as posture),
        /// The picture does not match the landmarks.
        #[error("{0}")]
        #[help("name the film's DICOM file as `file` of its `image` in the case; in Python give it as `dicom`")]
        Source(String),
        /// Another file than the one with the landmarks.
        #[error("{posture} film: {why}")]
        #[help("give the film on which the landmarks were placed, or correct `sha256` of its `image` in the case")]
        #[at(film = FilmView::from(*posture))]
        OtherFile {
            /// The film.
            posture: Posture,
            /// Why.
            why: String,
        },
        /// The DICOM writer refused.
        #[error("the report could not be encoded: {0}")]
        #[help("remove unusual characters from the names in the case")]
        Encode(String),
    }
}
