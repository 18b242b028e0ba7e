//! Named values of the library, as strings.

use spineline::action::LineKind;
use spineline::analysis::PitchSource;
use spineline::anatomy::{FilmView, ImageSide, Posture};
use spineline::measure::SpacingPlane;
use spineline_files::ExportFormat;
use spineline_marking::Calibrator;
use spineline_store::Access;
pub use spineline_store::{CornerName, OriginName, RoleName, SideName, Wire};

/// Posture of the patient on a film.
pub type PostureName = Wire<Posture>;
/// What a film shows.
pub type FilmViewName = Wire<FilmView>;
/// A side of the picture as seen.
pub type ImageSideName = Wire<ImageSide>;
/// Unit of a film's lengths.
pub type SpacingPlaneName = Wire<SpacingPlane>;
/// Where pitch and depth of a vertebra of the model come from.
pub type PitchSourceName = Wire<PitchSource>;
/// Kind of a line of action.
pub type LineKindName = Wire<LineKind>;
/// Format of a model for other multibody programs.
pub type ExportFormatName = Wire<ExportFormat>;
/// Object of known size in the picture.
pub type CalibratorName = Wire<Calibrator>;
/// Way of signing in.
pub type AccessName = Wire<Access>;
