//! Messages on the standard error. If the stream is full or closed, a message is dropped: the macros of the standard library
//! would panic.

use std::io::{self, Write};
use std::panic;

use spineline_report::terminal::{Lines, within};
use terminal_size::{Height, Width, terminal_size_of};

/// Columns of text for a person: the width of the terminal, from 80 to 120.
pub fn columns(size: (Width, Height)) -> usize {
    usize::from(size.0.0).clamp(80, 120)
}

/// Writes a message to the standard error: one line, unless it is made of several. A terminal gets longer lines wrapped.
pub fn say(message: impl Into<Lines>) {
    let width = terminal_size_of(io::stderr()).map_or(usize::MAX, columns);
    let text = within(&message.into(), width);
    // A closed stream changes nothing.
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Names the origin of the weights that propose landmarks, in a program that has them.
pub fn say_origin_of_weights() {
    #[cfg(feature = "weights")]
    say(spineline_weights::NOTE);
}

/// Runs the program; `None` if it panicked, and a message has said so. The message of a panic may quote a file, so only its
/// place is shown.
pub fn guarded<T>(run: impl FnOnce() -> T) -> Option<T> {
    panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or_else(String::new, |place| format!(" at {place}"));
        say(format!("error: a bug{place}; please report it"));
    }));
    panic::catch_unwind(panic::AssertUnwindSafe(run)).ok()
}
