//! Tests of files of Spineline, and of models in the formats of other programs.

mod bands;
mod biplanar_lines;
mod bodies;
mod case_rules;
mod exports;
mod files;
mod films_of_exports;
mod goldens;
mod hidden;
mod left_out_bends;
mod loads;
mod public_cases;
mod readings;
mod repeat;
mod standing;
