//! Radiographs of any kind: pixels or a typed error, and a display of what was read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use spineline_films::{FilmLimits, read_film};

fuzz_target!(|bytes: &[u8]| {
    let limits = FilmLimits { pixels: 1 << 20, inflated_bytes: 4 << 20, ..FilmLimits::default() };
    if let Ok(film) = read_film(bytes, &limits) {
        let shown = film.display(None, false);
        assert_eq!(shown.grey.len(), film.stored.len());
    }
});
