//! Analysis, model, load and stiffness files, and tables of readings.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = spineline_io::parse_analysis(text);
    let _ = spineline_io::parse_model(text);
    let _ = spineline_io::parse_load(text);
    let _ = spineline_io::parse_stiffness(text);
    let _ = spineline_io::parse_readings(text);
});
