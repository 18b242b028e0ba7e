//! De-identified films: what comes out is a film again, with the same pixels.
#![no_main]

use libfuzzer_sys::fuzz_target;
use spineline_films::{DeidOptions, FilmLimits, deidentify, read_film};

fuzz_target!(|bytes: &[u8]| {
    let limits = FilmLimits { pixels: 1 << 20, inflated_bytes: 4 << 20, ..FilmLimits::default() };
    let options =
        DeidOptions { case_id: "fuzz".to_owned(), salt: [7; 32], retain_sex_and_age: true };
    let Ok(clean) = deidentify(bytes, &options, &limits) else { return };
    if let Ok(before) = read_film(bytes, &limits) {
        let after = read_film(&clean.bytes, &limits).expect("what was a film is one");
        assert_eq!(before.stored.len(), after.stored.len());
    }
});
