//! Writes all results: whole files, either all files of a command or no file; streams; the standard output.

mod parts;
mod pieces;
mod staged;
mod target;
mod there;

pub use pieces::Pieces;
pub use staged::{Outputs, OverwriteArgs};
pub use target::{is_same_file, is_stdout};

use std::io::{self, ErrorKind, IsTerminal, Write};

use spineline_report::document::{Document, Notice};
use spineline_report::terminal::{self, Lines};
use terminal_size::terminal_size_of;

use super::failure::{Ending, Failure};
use super::messages::{columns, say};

/// Writes lines for a person to the standard output. It ignores a closed pipe.
pub fn print(text: impl Into<Lines>) -> Result<Ending, Failure> {
    to_stdout(text.into().as_str())
}

/// Writes a document for a person to the standard output.
pub fn print_document(document: &Document) -> Result<Ending, Failure> {
    print(Lines::of_text(&terminal::terminal(document, width())))
}

/// [`columns`] of the standard output; without a terminal, [`terminal::WIDTH`].
pub fn width() -> usize {
    terminal_size_of(io::stdout()).map_or(terminal::WIDTH, columns)
}

/// Columns of a table with a line per entry: [`width`] on a terminal; in a file or a pipe without limit, so that programs find whole
/// words.
pub fn entry_width() -> usize {
    if io::stdout().is_terminal() { width() } else { usize::MAX }
}

/// Writes text for a program to the standard output, as it is; a terminal gets it as text for a person.
pub fn print_data(text: &str) -> Result<Ending, Failure> {
    if io::stdout().is_terminal() { print(Lines::of_text(text)) } else { to_stdout(text) }
}

fn to_stdout(text: &str) -> Result<Ending, Failure> {
    let mut output = io::stdout().lock();
    // Without the flush, output would be lost silently on a full disk.
    shown(output.write_all(text.as_bytes()).and_then(|()| output.flush()))
}

/// Checks a write to the standard output; a closed pipe is not an error.
pub fn shown(written: io::Result<()>) -> Result<Ending, Failure> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::write("standard output", &error))
        }
        _ => Ok(Ending::Done),
    }
}

/// Writes notices to the standard error; outside of a terminal one line each, so that other programs can read them by line.
pub fn print_notices(notices: &[Notice]) {
    for notice in notices {
        say(terminal::notice(notice, usize::MAX).trim_end());
    }
}
