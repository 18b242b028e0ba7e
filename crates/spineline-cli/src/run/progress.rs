//! Progress bars for long work; silent if the error stream is not a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar with a known number of steps.
pub fn bar(what: &str, steps: usize) -> ProgressBar {
    styled(ProgressBar::new(steps as u64), "{msg} {wide_bar} {pos}/{len} ({eta})", what)
}

/// A counter for work of unknown length.
pub fn spinner(what: &str) -> ProgressBar {
    styled(ProgressBar::no_length(), "{msg} {spinner} {pos}", what)
}

/// A message that changes, for work without steps to count.
pub fn status() -> ProgressBar {
    styled(ProgressBar::new_spinner(), "{spinner} {msg}", "")
}

/// A message for work that does not say how far it is.
pub fn working(what: &str) -> ProgressBar {
    let shown = status();
    shown.set_message(what.to_owned());
    shown.enable_steady_tick(Duration::from_millis(100));
    shown
}

fn styled(bar: ProgressBar, template: &str, what: &str) -> ProgressBar {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(what.to_owned());
    bar
}
