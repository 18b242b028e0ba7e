//! Lengths and angles of lines that are drawn on a film and not stored.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What to measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum DrawnRequest {
    /// The length of a line.
    Length {
        /// One end.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        from_px: [f64; 2],
        /// Other end.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        to_px: [f64; 2],
    },
    /// The angle between two lines.
    Angle {
        /// One end of the first line.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        first_from_px: [f64; 2],
        /// Its other end.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        first_to_px: [f64; 2],
        /// One end of the second line.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        second_from_px: [f64; 2],
        /// Its other end.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        second_to_px: [f64; 2],
    },
}

/// The measured value. It is not stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DrawnView {
    /// With its standard deviation and unit, such as `123.4 ± 0.9 mm` or `23.4 ± 0.3°`.
    pub text: String,
    /// Text that explains the unit and the deviation.
    pub note: String,
}
