//! Case files: a case or an error, and the same case again from its own text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use spineline_files::{CaseFile, parse_case, to_text};

fuzz_target!(|text: &str| {
    if let Ok(case) = parse_case(text) {
        let once = to_text(&CaseFile::from_case(&case));
        let again = parse_case(&once).expect("our own text");
        assert_eq!(once, to_text(&CaseFile::from_case(&again)));
    }
});
