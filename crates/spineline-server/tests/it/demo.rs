//! A store with the demonstration: drawn once, and copied for each test.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use serde_json::Value;

use crate::browser::{App, Browser};
use crate::films::{app, decoding};

pub const STUDY: &str = "demo-rod-01";

/// An app whose store has the demonstration.
pub fn app_with_demo() -> App {
    App::copy_of(&drawn_store(), decoding())
}

/// The demonstration as this person sees it.
pub fn demo(browser: &Browser<'_>) -> Value {
    browser.get(&format!("/api/studies/{STUDY}")).json()
}

/// Adds the demonstration.
pub fn add_demo(browser: &Browser<'_>) -> Value {
    browser.post("/api/studies/demo", &Value::Null).succeeded().json()
}

/// A store shared by the tests of this build; tests must not change it. Drawing the films takes seconds.
fn drawn_store() -> PathBuf {
    let here = Path::new(env!("CARGO_TARGET_TMPDIR")).join("demo");
    fs::create_dir_all(&here).expect("a folder");
    let lock = File::create(here.join("lock")).expect("a lock");
    lock.lock().expect("no other test draws");
    let built = std::env::current_exe().and_then(fs::metadata).and_then(|file| file.modified());
    let built = built.expect("a time").duration_since(UNIX_EPOCH).expect("after 1970");
    let store = here.join(format!("{}", built.as_nanos()));
    if !store.exists() {
        remove_old(&here);
        let app = app();
        add_demo(&app.observer("Ann"));
        app.keep(&store);
    }
    store
}

/// Removes the stores of earlier builds.
fn remove_old(here: &Path) {
    for entry in fs::read_dir(here).expect("a folder").map(|entry| entry.expect("an entry")) {
        if entry.path().is_dir() {
            fs::remove_dir_all(entry.path()).expect("removed");
        }
    }
}
