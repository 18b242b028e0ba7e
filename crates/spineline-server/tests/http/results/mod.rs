//! Results over the wire: models, loads, live results, and who sees none.

mod live;
mod model;
mod server;
