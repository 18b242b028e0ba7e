//! The identity changes only with the code of a crate and of its dependencies.

use std::fs;
use std::path::Path;

use spineline_build::Sources;

/// A workspace with a program, its library, and an unused crate.
fn workspace() -> tempfile::TempDir {
    let root = tempfile::tempdir().expect("a folder");
    let files = [
        ("Cargo.lock", "versions"),
        ("crates/core/Cargo.toml", "[package]\nname = \"core\"\n[dependencies]\nserde = \"1\"\n"),
        ("crates/core/src/lib.rs", "pub const A: u8 = 1;"),
        ("crates/core/src/deep/data.txt", "1 2 3"),
        ("crates/core/tests/it/main.rs", "#[test] fn a() {}"),
        ("crates/middle/Cargo.toml", "[dependencies]\ncore.workspace = true\n"),
        ("crates/middle/src/lib.rs", ""),
        (
            "crates/program/Cargo.toml",
            "[dependencies]\nmiddle = { path = \"../middle\" }\n[dev-dependencies]\nother = { path = \"../other\" }\n",
        ),
        ("crates/program/src/main.rs", "fn main() {}"),
        ("crates/other/Cargo.toml", "[package]"),
        ("crates/other/src/lib.rs", "// another"),
    ];
    for (name, text) in files {
        let path = root.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    }
    root
}

fn identity(root: &Path) -> String {
    let sources = Sources::of(&root.join("crates/program")).expect("sources");
    sources.identity().expect("files that can be read")
}

#[test]
fn equal_sources_have_one_identity_in_any_folder() {
    let (one, other) = (workspace(), workspace());
    let found = identity(one.path());
    assert_eq!(found, identity(other.path()));
    assert_eq!(found.len(), 64);
}

#[test]
fn any_change_of_what_is_built_changes_the_identity() {
    let root = workspace();
    let mut known = vec![identity(root.path())];
    for name in [
        "crates/core/src/lib.rs",
        "crates/core/src/deep/data.txt",
        "crates/core/src/deep/new.rs",
        "crates/middle/Cargo.toml",
        "crates/program/src/main.rs",
        "Cargo.lock",
    ] {
        let path = root.path().join(name);
        let text = fs::read_to_string(&path).unwrap_or_default();
        fs::write(&path, text + "\n# changed").expect("a file");
        let now = identity(root.path());
        assert!(!known.contains(&now), "{name}");
        known.push(now);
    }
}

#[test]
fn tests_and_crates_that_are_not_used_do_not_count() {
    let root = workspace();
    let before = identity(root.path());
    for name in ["crates/core/tests/it/main.rs", "crates/other/src/lib.rs"] {
        fs::write(root.path().join(name), "// changed").expect("a file");
    }
    assert_eq!(identity(root.path()), before);
}
