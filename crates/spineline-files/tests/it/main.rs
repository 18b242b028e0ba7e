//! Tests of files of Spineline, and of models in the formats of other programs.

mod exports;
mod files;
mod hidden;
mod loads;
mod public_cases;
mod readings;
mod repeat;
