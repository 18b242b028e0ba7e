//! Sets the server's build identity, and provides the browser app: the built one, or a page that says how to build it.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    spineline_build::emit()?;
    // Read at run time: a build folder copied from another checkout must not embed its app.
    let crate_folder = env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it");
    let root = Path::new(&crate_folder).join("../../web");
    let built = root.join("dist");
    let embedded = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it")).join("web");
    if embedded.exists() {
        fs::remove_dir_all(&embedded)?;
    }
    fs::create_dir_all(&embedded)?;
    // A missing folder counts as changed at every build; its parent always exists.
    let watched = if built.exists() { &built } else { &root };
    println!("cargo:rerun-if-changed={}", watched.display());
    if built.join("index.html").exists() {
        copy(&built, &embedded)
    } else {
        println!(
            "cargo::warning=the browser app is missing: web/dist was not found; run `cargo xtask web`, then build again"
        );
        fs::copy("unbuilt.html", embedded.join("index.html")).map(drop)
    }
}

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            fs::create_dir_all(&target)?;
            copy(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}
