//! PDF in a build without the typesetter.

use spineline_report::Document;

use crate::run::failure::Failure;

/// Always refused.
///
/// # Errors
/// Wrong usage: this build writes no PDF.
pub fn pdf(_: &Document, _: &str) -> Result<Vec<u8>, Failure> {
    Err(refusal())
}

/// The analysis JSON that is attached to a report: `None` for other files than PDF.
///
/// # Errors
/// Wrong usage for a PDF, which this build does not read.
pub fn attached(bytes: &[u8]) -> Result<Option<String>, Failure> {
    if bytes.starts_with(b"%PDF-") { Err(refusal()) } else { Ok(None) }
}

/// Refuses, before any work, a format that this build cannot write.
///
/// # Errors
/// Always.
pub fn check_is_built() -> Result<(), Failure> {
    Err(refusal())
}

fn refusal() -> Failure {
    Failure::usage("this program was built without PDF").with_line(
        "  help: build it with `cargo build --release --features pdf`, or write HTML and print it from a browser",
    )
}
