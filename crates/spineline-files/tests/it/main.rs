//! Tests of files of Spineline, and of models in the formats of other programs.

mod exports;
mod files;
mod hidden;
mod loads;
mod readings;
mod repeat;
