//! Radiographs of any kind.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| spineline_fuzz_checks::film(bytes));
