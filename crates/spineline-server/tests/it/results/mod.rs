//! Results by HTTP: models, loads, live results, and hidden results.

mod cohort;
mod live;
mod model;
mod options;
mod server;
