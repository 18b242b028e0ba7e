//! Files of Spineline, and models in the formats of other programs: what is written, read back, and refused.

mod exports;
mod files;
mod loads;
mod readings;
mod repeat;
