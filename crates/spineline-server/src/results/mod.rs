//! Results from landmarks: over a film, beside it, in 3D, and over all studies.
//! The library computes everything from the current case of a study; this module converts it to text and pixels.

mod background;
mod cohort;
mod computations;
mod curves;
mod exports;
mod findings;
mod heights;
mod live;
mod load;
mod load_intervals;
mod loads;
mod model;
mod notices;
mod options;
mod overlay;
mod pad_map;
mod preview;
mod record;
mod reliability;
mod sections;
mod simulated;
mod study;
mod summary;

pub use summary::summary;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::state::AppState;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(live::live))
        .routes(routes!(preview::preview))
        .routes(routes!(record::record))
        .merge(options::routes())
        .merge(exports::routes())
        .merge(computations::routes())
        .routes(routes!(sections::lines))
        .routes(routes!(sections::space))
        .routes(routes!(study::findings))
        .routes(routes!(study::overlay))
        .routes(routes!(heights::heights))
        .routes(routes!(model::model))
        .routes(routes!(load::load))
        .merge(loads::routes())
        .merge(pad_map::routes())
        .merge(load_intervals::routes())
        .routes(routes!(cohort::cohort))
        .routes(routes!(cohort::pooled))
        .routes(routes!(reliability::reliability))
}
