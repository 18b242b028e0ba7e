//! The notices that the program prints.

use crate::program::{assert_says, folder};

#[test]
fn licences_of_crates_fonts_weights_and_the_app_are_printed() {
    let text = folder().done(&["licences"]);
    // The crates of the program, of its font and of the Python module, with licences by their text.
    let crates = ["crate rusqlite 0", "crate dejavu 2", "crate pyo3 0", "crate tokio 1"];
    assert_says(&text, &crates);
    let licences = ["Permission is hereby granted", "Bitstream Vera", "Apache License"];
    assert_says(&text, &licences);
    assert!(text.len() < 2_000_000, "every text stands once: {}", text.len());
    assert_eq!(text.contains("AASCE 2019"), cfg!(feature = "weights"));
    for package in ["svelte", "three", "openapi-fetch"] {
        assert_eq!(
            text.contains(&format!("## {package}")),
            spineline_server::has_app(),
            "{package}"
        );
    }
    assert_eq!(text.contains("crate typst-assets"), cfg!(feature = "pdf"));
}
