//! Messages on the standard error. If the stream is full or closed, a message is dropped: the macros of the standard library
//! would panic.

use std::io::Write;
use std::panic;

use spineline_report::terminal::Lines;

/// Writes a message to the standard error: one line, unless it is made of several.
pub fn say(message: impl Into<Lines>) {
    // A closed stream changes nothing.
    let _ = std::io::stderr().lock().write_all(message.into().as_str().as_bytes());
}

/// Names the origin of the weights that propose landmarks, in a program that has them.
pub fn say_origin_of_weights() {
    #[cfg(feature = "weights")]
    say(spineline_weights::NOTE);
}

/// Runs the program so that a bug ends it with a failure. The message of a panic may quote a file, so only its place is shown.
///
/// # Errors
/// If it panics.
pub fn guarded<T>(run: impl FnOnce() -> T) -> Result<T, Bug> {
    panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or_else(String::new, |place| format!(" at {place}"));
        say(format!("error: a bug{place}; please report it"));
    }));
    panic::catch_unwind(panic::AssertUnwindSafe(run)).map_err(|_| Bug)
}

/// The program panicked, and has said so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bug;
