//! What follows from the marks: over a film, beside it, in three dimensions, and over all studies.
//!
//! Everything is computed by the library from the case of a study as it stands; this module puts it into words and pixels.

mod cohort;
mod curves;
mod findings;
mod live;
mod load;
mod model;
mod notices;
mod overlay;
mod preview;
mod record;
mod reliability;
mod simulated;
mod study;
mod summary;
mod words;

pub use summary::summary;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::state::AppState;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(live::live))
        .routes(routes!(preview::preview))
        .routes(routes!(record::record))
        .routes(routes!(study::analysis_file))
        .routes(routes!(study::findings))
        .routes(routes!(study::overlay))
        .routes(routes!(model::model))
        .routes(routes!(load::load))
        .routes(routes!(cohort::cohort))
        .routes(routes!(reliability::reliability))
}
