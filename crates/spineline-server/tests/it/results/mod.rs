//! Results over the wire: models, loads, live results, and who sees none.

mod cohort;
mod live;
mod model;
mod server;
