//! Pictures that show no frontal spine.

mod refusals;
