//! Ctrl-C stops long work after its present step; a second one ends the program.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use super::failure::Failure;

static STOP: AtomicBool = AtomicBool::new(false);

/// Catches Ctrl-C from now on. A program can do so once.
///
/// # Errors
/// If it cannot be caught.
pub fn catch() -> Result<(), Failure> {
    static CAUGHT: OnceLock<Result<(), String>> = OnceLock::new();
    let caught = CAUGHT.get_or_init(|| {
        ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
        })
        .map_err(|error| error.to_string())
    });
    let failed = |error| Failure::internal(format!("Ctrl-C cannot be caught: {error}"));
    caught.clone().map_err(failed)
}

/// Whether Ctrl-C was pressed.
pub fn is_requested() -> bool {
    STOP.load(Ordering::SeqCst)
}
