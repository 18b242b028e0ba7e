//! Landmarks as a table, one row per vertebra, read by people, spreadsheets and statistics programs.
//!
//! Columns are found by their names, in any order. `vertebra` and the eight corner columns are required; `posture`,
//! `observer`, `repeat` and `axis_clockwise_deg` are optional. A row whose vertebra is `iliac_crests` has the tips of
//! the patient's left and right crest in the `superior_left` and `superior_right` columns; its other corners are empty.
//! Confidences of corners that a program found, from 0 to 1, are in `superior_left_confidence` and so on: all four or
//! none. Origins of corners (`clicked`, `completed`, `detected`, `accepted`, `adjusted`) are in `superior_left_origin`
//! and so on, where an empty cell means a clicked corner. The walls that corners were completed from are in
//! `left_wall_column_px` and so on. The standard deviation of detected corners, as a part of the body's height, is in
//! `corner_sd_share`. The centres of the pedicles are in `left_pedicle_column_px` and so on. A film that another
//! program measured has `location_left_mm`, `location_cranial_mm` and `tilt_right_deg` in place of corners.
//!
//! A table of a lateral film has only `vertebra`, `observer`, `repeat`, and its corners in
//! `superior_anterior_column_px` and so on.
//!
//! # Separators
//! The heading decides: commas, semicolons or tabs, and only one of them. Beside commas the decimal mark is a point.
//! Beside semicolons and tabs it may be a comma or a point, but the same one in the whole file, without separators of
//! thousands. A first line such as `sep=;` states the separator, as Excel reads it.
//!
//! # Missing landmarks
//! A cell of a number may be empty, or contain `NaN`, `NA`, `-` and the like, for a missing number. A row without
//! numbers is skipped with a remark; one with some corners is an error that names the missing ones. Columns without a
//! known name are errors only if they hold anything.

mod cells;
mod columns;
mod lateral;
mod read;
mod write;

pub use lateral::parse_lateral_csv;
pub(super) use lateral::rows as lateral_rows;
pub(super) use read::looks_like_csv;
pub use read::parse_csv;
pub(super) use write::{rows, text};

/// Maximum number of rows; every film of a patient with a thousand readings has fewer.
pub const MAX_ROWS: u64 = 100_000;

pub(super) const POSTURE: &str = "posture";
pub(super) const OBSERVER: &str = "observer";
pub(super) const REPEAT: &str = "repeat";
pub(super) const VERTEBRA: &str = "vertebra";
pub(super) const CRESTS: &str = "iliac_crests";
pub(super) const AXIS: &str = "axis_clockwise_deg";
pub(super) const PLACED: [&str; 3] = ["location_left_mm", "location_cranial_mm", "tilt_right_deg"];
/// Column and row of each corner, in the order of the patient's corners.
pub(super) const CORNERS: [&str; 8] = [
    "superior_left_column_px",
    "superior_left_row_px",
    "superior_right_column_px",
    "superior_right_row_px",
    "inferior_left_column_px",
    "inferior_left_row_px",
    "inferior_right_column_px",
    "inferior_right_row_px",
];

/// The same on a lateral film, with the front in place of the left.
pub(super) const LATERAL_CORNERS: [&str; 8] = [
    "superior_anterior_column_px",
    "superior_anterior_row_px",
    "superior_posterior_column_px",
    "superior_posterior_row_px",
    "inferior_anterior_column_px",
    "inferior_anterior_row_px",
    "inferior_posterior_column_px",
    "inferior_posterior_row_px",
];

/// Confidence of each corner, in the same order.
pub(super) const CONFIDENCES: [&str; 4] = [
    "superior_left_confidence",
    "superior_right_confidence",
    "inferior_left_confidence",
    "inferior_right_confidence",
];

/// Origin of each corner, in the same order.
pub(super) const ORIGINS: [&str; 4] = [
    "superior_left_origin",
    "superior_right_origin",
    "inferior_left_origin",
    "inferior_right_origin",
];

/// Column and row of the centres of the left and the right pedicle.
pub(super) const PEDICLES: [&str; 4] = [
    "left_pedicle_column_px",
    "left_pedicle_row_px",
    "right_pedicle_column_px",
    "right_pedicle_row_px",
];

/// Column and row of the middles of the left and the right wall.
pub(super) const WALLS: [&str; 4] =
    ["left_wall_column_px", "left_wall_row_px", "right_wall_column_px", "right_wall_row_px"];

pub(super) const SD_SHARE: &str = "corner_sd_share";
