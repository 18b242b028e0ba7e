use std::path::PathBuf;

use spineline::analysis::{CASE_ID_RULE, LENKE_RULE};
use spineline::anatomy::{FilmView, Level, Posture, Region};
use spineline::fault::ErrorPlace;
use spineline::number::{fixed, scientific};

/// Limits of the cranial distance from a vertebra's midpoint to its neighbour's, in mm: a fifth of a small child's distance and
/// twice a tall adult's (assumption). Lengths in metres or in pixels are beyond them.
pub(crate) const NEIGHBOURS_MM: [f64; 2] = [2.0, 90.0];

const SCHEMA_HELP: &str =
    "`spineline schema case` (or model, load, stiffness) prints every key with its meaning";
const ONE_KIND_HELP: &str = "describe all vertebrae of a film in the same way";
const ANALYSE_HELP: &str = "analyse the case again with `spineline analyze CASE --json FILE`";
const LEARN_HELP: &str = "learn it again with `spineline learn-prior CASE… --out FILE`";
pub(crate) const MODEL_HELP: &str =
    "write the model again with `spineline analyze CASE --model FILE`";
const TABLE_HELP: &str = "a table of readings is CSV with the columns quantity, unit, subject, observer, repeat, value; one reading per row";

spineline::faults! {
    /// Error of reading a file; `place` is where in the file.
    #[derive(Debug, thiserror::Error)]
    #[non_exhaustive]
    pub enum FileError {
        /// The file could not be opened.
        #[error("{}: {source}", path.display())]
        #[help("check the path and its permissions")]
        Read {
            path: PathBuf,
            source: std::io::Error,
        },
        /// The file is not text in UTF-8.
        #[error("{}: its text is {}", path.display(), if *utf_16 { "UTF-16 (Excel's Unicode text) instead of UTF-8".to_owned() } else { format!("not UTF-8 (byte {at})") })]
        #[help("save the file as UTF-8; in Excel as `CSV UTF-8`")]
        NotUtf8 {
            path: PathBuf,
            /// The first byte that is not, from 1.
            at: usize,
            /// Whether it is UTF-16.
            utf_16: bool,
        },
        /// The file is a database, as study stores are.
        #[error("{}: it is a database, such as a study store, and not a text", path.display())]
        #[help("`spineline study export STORE STUDY` writes a study of a store as a case file")]
        Database {
            path: PathBuf,
        },
        /// More bytes than any file of its kind needs.
        #[error(
            "{}: {}; the limit is {} MB",
            path.display(),
            bytes.map_or_else(|| "it is too large".to_owned(), |bytes| format!("it has {} MB", bytes.div_ceil(1 << 20))),
            limit >> 20
        )]
        #[help("check that it is the right file; give a cohort as one file per patient")]
        #[at(value = bytes.map(|bytes| bytes.div_ceil(1 << 20) as f64), limit = (*limit >> 20) as f64)]
        TooLarge {
            path: PathBuf,
            /// Its size, where it states one; pipes and devices do not.
            bytes: Option<u64>,
            /// How many bytes are read.
            limit: u64,
        },
        /// The text is not JSON.
        #[error("line {line}, column {column}: not JSON: {reason}")]
        #[help("numbers must be finite and keys must be quoted; an editor with JSON support shows the place")]
        Syntax {
            /// Line, from 1.
            line: usize,
            /// Column, from 1.
            column: usize,
            reason: String,
        },
        /// A key that the format does not know.
        #[error("line {line}, {place}: unknown key `{key}`{}", nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default())]
        #[help(SCHEMA_HELP)]
        UnknownKey {
            /// Line, from 1.
            line: usize,
            place: String,
            key: String,
            /// The known key that it resembles most.
            nearest: Option<String>,
        },
        /// An invalid value.
        #[error("line {line}, {place}: {reason}")]
        #[help(SCHEMA_HELP)]
        Value {
            /// Line, from 1.
            line: usize,
            place: String,
            reason: String,
        },
        /// The file has another format.
        #[error("{}", format_words(found, expected))]
        #[help("`analyze` and `check` read cases and analyses, `rerun` analyses; `simulate` reads a model, which `analyze CASE --model FILE` writes, and `--load` a load")]
        Format {
            /// Value in the file.
            found: String,
            expected: &'static str,
        },
        /// A list of entries that each need a file.
        #[error("it is a list, and a file holds one {}", expected.trim_start_matches("spineline-"))]
        #[help("write each entry of the list into its own file, and give all these files")]
        List {
            /// The format of an entry.
            expected: &'static str,
        },
        /// A newer file, or one of unknown version.
        #[error("its version is {found}, and this program reads version {supported}")]
        #[help("install a newer Spineline, or write the file again with this one")]
        Version {
            /// Value in the file.
            found: u32,
            /// What can be read.
            supported: u32,
        },
        /// A vertebra without corners and without a measured location.
        #[error("{place}: a vertebra needs either its four corners, or `location_mm` and `tilt_deg`")]
        #[help(ONE_KIND_HELP)]
        Vertebra {
            place: String,
        },
        /// Corners and locations in one film.
        #[error(
            "{posture} film: some vertebrae have corners and some have locations; a film holds one kind"
        )]
        #[help(ONE_KIND_HELP)]
        #[at(film = FilmView::from(*posture))]
        MixedKinds {
            posture: Posture,
        },
        /// Corners without a picture.
        #[error("{posture} film: corners need an `image` with its spacing and `patient_left`")]
        #[help("add `image`: columns, rows, column_spacing_mm, row_spacing_mm, patient_left")]
        #[at(film = FilmView::from(*posture))]
        NoImage {
            posture: Posture,
        },
        /// A midline as the source of corners.
        #[error(
            "{posture} film: `placement_source` is `surface_midline`, but the film has no locations and tilts"
        )]
        #[help("remove `placement_source`: a surface midline gives locations and tilts, not corners")]
        #[at(film = FilmView::from(*posture))]
        SourceOfCorners {
            posture: Posture,
        },
        /// An angle of more than half a turn.
        #[error("{place}: `{key}` is {deg}, and must be from -180 to 180")]
        #[help("give the angle in degrees, without full turns")]
        #[at(value = *deg, limit = ErrorPlace::limit(*deg, -180.0, 180.0))]
        Angle {
            place: String,
            /// The key of the angle.
            key: &'static str,
            /// The angle.
            deg: f64,
        },
        /// Locations in millimetres of a film without millimetres.
        #[error("{posture} film: its locations are in mm, but their plane is `pixels`")]
        #[help("give the `plane` of `lengths` as patient, detector or unknown")]
        #[at(film = FilmView::from(*posture))]
        LengthsOfPixels {
            posture: Posture,
        },
        /// A unit of locations in a film of corners.
        #[error("{posture} film: `lengths` is given, but the film has no locations and tilts")]
        #[help("remove `lengths`: corners take their unit from the spacing and `spacing_plane` of `image`")]
        #[at(film = FilmView::from(*posture))]
        LengthsOfCorners {
            posture: Posture,
        },
        /// A spacing in one direction only, or a plane without a spacing.
        #[error(
            "{posture} film: `column_spacing_mm`, `row_spacing_mm`, `pixel_aspect` and `spacing_plane` contradict one another"
        )]
        #[help("give both spacings and their plane (patient, detector or unknown); or leave both out and give `pixels`, with `pixel_aspect` where pixels are not square")]
        #[at(film = FilmView::from(*posture))]
        SpacingIncomplete {
            posture: Posture,
        },
        /// A spacing of the lateral film in one direction only, or beside the shape of a pixel.
        #[error(
            "lateral film: `column_spacing_mm` and `row_spacing_mm` are given together and without `pixel_aspect`, or not at all"
        )]
        #[help("give both spacings, `pixel_aspect` alone, or leave out all three")]
        #[at(film = FilmView::Lateral)]
        LateralSpacing,
        /// A spacing in millimetres for a film in pixels.
        #[error("{posture} film: `spacing_plane` is `pixels`, but a spacing in mm is given")]
        #[help("remove the spacings, or give their plane: patient, detector or unknown")]
        #[at(film = FilmView::from(*posture))]
        SpacingOfPixels {
            posture: Posture,
        },
        /// An analysis without its inputs.
        #[error("it has no `{part}`, so its inputs are unknown")]
        #[help(ANALYSE_HELP)]
        NotRepeatable {
            /// What is missing.
            part: &'static str,
        },
        /// An option of an analysis that cannot be read.
        #[error("`provenance.options`: {reason}")]
        #[help(ANALYSE_HELP)]
        Option {
            reason: String,
        },
        /// Replicates without a seed.
        #[error("`replicates` is given, but `seed` is missing")]
        #[help(ANALYSE_HELP)]
        NoSeed,
        /// A stiffness table that the model cannot use.
        #[error(transparent)]
        #[help("`spineline schema stiffness` prints the format; give every joint from L4/L3 to T3/T2 one row")]
        #[at(level = error.place().level, value = error.place().value, limit = error.place().limit)]
        Stiffness(#[from] spineline::multibody::StiffnessError as error),
        /// A prior of joint rotations whose numbers are not a distribution.
        #[error(transparent)]
        #[help(LEARN_HELP)]
        RotationPrior(#[from] spineline::evaluate::RotationPriorError),
        /// A distribution of joint rotations that was learned from the case itself.
        #[error(
            "the distribution of joint rotations was learned from the case {case_id}, so it cannot predict its films"
        )]
        #[help("leave out this distribution (a cohort predicts every patient from the others), or learn it from other cases")]
        LearnedFrom {
            case_id: String,
        },
        /// A distribution of joint rotations that was learned with other tilts.
        #[error(
            "the distribution of joint rotations was learned with tilts by `{learned}`, and this analysis measures them by `{asked}`"
        )]
        #[help("choose the tilts that it was learned with, or learn it again with `spineline learn-prior --tilt`")]
        LearnedWithTilt {
            /// The rule that it was learned with.
            learned: &'static str,
            /// The rule of the analysis.
            asked: &'static str,
        },
        /// A prior of joint rotations of vertebrae in the wrong order.
        #[error("`top` must be above `base`, both between L4 and T2, but they are {top} and {base}")]
        #[help(LEARN_HELP)]
        PriorLevels {
            /// The lowest vertebra.
            base: Level,
            /// The highest vertebra.
            top: Level,
        },
        /// Rows of different length.
        #[error("the rows of `covariance_deg2` have different lengths")]
        #[help(LEARN_HELP)]
        PriorRows,
        /// A model whose parts do not fit together.
        #[error(
            "a model needs at least two vertebrae and one joint between neighbours, and has {vertebrae} vertebrae and {joints} joints"
        )]
        #[help(MODEL_HELP)]
        ModelShape {
            vertebrae: usize,
            joints: usize,
        },
        /// A model in newtons without a measured force.
        #[error("`absolute` is true and `gauge` is `{gauge}`; only a known force gives newtons")]
        #[help(MODEL_HELP)]
        ModelAbsolute {
            /// The scale constraint.
            gauge: String,
        },
        /// Vertebrae of a model that are not in their order.
        #[error("vertebrae must be ordered from caudal to cranial, but {above} follows {below}")]
        #[help(MODEL_HELP)]
        ModelOrder {
            /// The one that comes first.
            below: Level,
            /// The one that follows.
            above: Level,
        },
        /// Vertebrae of a model that are not where bodies of this size can be.
        #[error(
            "{above} lies {} mm cranial to {below}, along {below}'s axis; the limits are {} mm to {} mm for each vertebra of the way",
            fixed(*cranial_mm, 3),
            NEIGHBOURS_MM[0],
            NEIGHBOURS_MM[1]
        )]
        #[help(MODEL_HELP)]
        #[at(level = *above, value = *cranial_mm)]
        ModelPlace {
            /// The caudal one.
            below: Level,
            /// The next one of the model.
            above: Level,
            /// Where the next midpoint lies along the axis of the caudal vertebra; negative where it is caudal.
            cranial_mm: f64,
        },
        /// An identifier with characters that [`spineline::analysis::is_case_id`] does not allow, such as the name of a person.
        #[error("`case_id` is `{found}`; expected {CASE_ID_RULE}")]
        #[help("use a short pseudonym, and never the name of a person")]
        CaseId {
            /// The identifier.
            found: String,
        },
        /// A text that is not a Lenke class ([`spineline::analysis::is_lenke_class`]), such as the name of a person.
        #[error("`lenke` of the subject is `{found}`; expected {LENKE_RULE}")]
        #[help("correct `lenke`, or leave it out; never write the name of a person there")]
        Lenke {
            /// The class.
            found: String,
        },
        /// A picture file in a folder, which may carry the name of a person.
        #[error(
            "{film} film: `file` of its image {}; expected the name of a file beside the case file",
            name.as_ref().map_or_else(
                || "does not name a file".to_owned(),
                |name| format!("names a folder or a drive before `{name}`")
            )
        )]
        #[help("put the picture beside the case file, and give its name alone, without `/`, `\\` and `:`")]
        PictureFolder {
            /// Posture of the film, or `lateral`.
            film: String,
            /// Name of the file, without its folder; absent where there is only a folder.
            name: Option<String>,
        },
        /// A text that is not a SHA-256.
        #[error("{film} film: `sha256` of its image is `{found}`; expected 64 hexadecimal digits")]
        #[help("give the SHA-256 of the picture's file, or leave `sha256` out")]
        PictureHash {
            /// Posture of the film, or `lateral`.
            film: String,
            /// The text.
            found: String,
        },
        /// One picture file of two films.
        #[error("the {a} and the {b} film are the same picture: {picture}")]
        #[help("a film shows one posture: name the right picture, or remove the film that was not taken")]
        PictureTwice {
            /// Posture of one film, or `lateral`.
            a: String,
            b: String,
            /// Its file, or its SHA-256.
            picture: String,
        },
        /// A joint of a model that does not lie between its two vertebrae.
        #[error("found joint {inferior}/{superior} where joint {lower}/{upper} is expected")]
        #[help(MODEL_HELP)]
        ModelJoint {
            /// Value in the file.
            inferior: Level,
            /// Value in the file.
            superior: Level,
            /// The vertebra below it.
            lower: Level,
            /// The vertebra above it.
            upper: Level,
        },
        /// Axes of a vertebra that do not form a rotation.
        #[error(
            "{level}: its axes depart from unit length and right angles by {}{}; a vertebra's pose needs a rotation",
            scientific(*departure, 2),
            if *right_handed { "" } else { " and are left-handed" }
        )]
        #[help(MODEL_HELP)]
        #[at(level = *level, value = *departure)]
        ModelAxes {
            level: Level,
            /// Largest element of `RᵀR - 1`.
            departure: f64,
            /// Whether they are right-handed.
            right_handed: bool,
        },
        /// A region that ends outside of its model.
        #[error("the region {region} names {level}, which is not a vertebra of this model")]
        #[help(MODEL_HELP)]
        #[at(level = *level)]
        Region {
            region: Region,
            /// What it names.
            level: Level,
        },
        /// A region whose vertebrae are not in order.
        #[error(
            "the region {region} needs inferior below apex below superior, and its Cobb ends in that order"
        )]
        #[help(MODEL_HELP)]
        RegionOrder {
            region: Region,
        },
        /// A table with an invalid heading.
        #[error("line 1: {reason}")]
        #[help(TABLE_HELP)]
        Column {
            reason: String,
        },
        /// An invalid row of a table.
        #[error("line {line}: {reason}")]
        #[help(TABLE_HELP)]
        Row {
            /// Line, from 1.
            line: u64,
            reason: String,
        },
        /// A cell of a table that is not a code, such as the name of a person.
        #[error("line {line}: `{column}` is `{found}`, and must be {rule}")]
        #[help("give a code such as A, and no name of a person")]
        RowCode {
            /// Line, from 1.
            line: u64,
            column: &'static str,
            /// The start of the cell.
            found: String,
            /// What a code is.
            rule: &'static str,
        },
        /// A load file without loads.
        #[error("`loads` is empty")]
        #[help("give at least one; `spineline schema load` prints every kind")]
        NoLoads,
        /// A load that cannot be applied to its model.
        #[error("load {number} ({kind}, {place}): {reason}")]
        #[help(help)]
        Load {
            /// Which load of the file, from 1.
            number: usize,
            kind: &'static str,
            place: String,
            reason: String,
            help: &'static str,
        },
    }
}

/// The message about a file of another format, or without a format.
fn format_words(found: &str, expected: &str) -> String {
    if found.is_empty() {
        format!("not a Spineline file: it has no `format`, which should be `{expected}`")
    } else if found.starts_with("spineline-") {
        format!("its format is `{found}`, and should be `{expected}`")
    } else {
        format!("not a Spineline file: its format is `{found}`, and should be `{expected}`")
    }
}
