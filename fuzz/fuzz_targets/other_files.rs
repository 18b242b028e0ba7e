//! Analysis, model, load and stiffness files, and tables of readings.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = spineline_files::parse_analysis(text);
    let _ = spineline_files::parse_model(text);
    let _ = spineline_files::parse_load(text);
    let _ = spineline_files::parse_stiffness(text);
    let _ = spineline_files::parse_readings(text);
});
