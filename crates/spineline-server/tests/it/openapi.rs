//! The browser's types are made of a file that must be what the program describes.

#[test]
fn the_description_beside_the_app_is_the_programs() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/src/api/openapi.json");
    let kept = std::fs::read_to_string(path).unwrap_or_default();
    let made = spineline_server::openapi().to_pretty_json().expect("a description is JSON");
    assert!(
        kept.trim_end() == made,
        "run: cargo run -p spineline-server --example openapi > web/src/api/openapi.json"
    );
}
