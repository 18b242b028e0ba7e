//! Analysis, model, load and stiffness files, and tables of readings.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| spineline_fuzz_checks::other_files(bytes));
