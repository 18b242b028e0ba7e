//! Results by HTTP: models, loads, live results, and hidden results.

mod cohort;
mod corrections;
mod lateral;
mod live;
mod load_intervals;
mod loads;
mod model;
mod options;
mod pad_map;
mod server;
