//! The browser's types are generated from a file that must equal the program's description.

#[test]
fn the_stored_interface_description_is_current() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/src/api/openapi.json");
    let kept = std::fs::read_to_string(path).unwrap_or_default();
    let made = spineline_server::openapi().to_pretty_json().expect("a description is JSON");
    assert!(
        kept.trim_end() == made,
        "run: cargo run -p spineline-server --example openapi > web/src/api/openapi.json"
    );
}
