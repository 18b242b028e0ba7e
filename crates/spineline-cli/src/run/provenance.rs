//! Where an output comes from: program, command, date and inputs.

use chrono::{DateTime, SecondsFormat, Utc};
use spineline_files::{ProgramRun, Provenance};

use super::failure::Failure;

/// Environment variable with the time of the run in seconds since 1970, for reproducible outputs (reproducible-builds.org).
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// The program and its version, as files name what wrote them.
pub fn generator() -> String {
    format!("spineline {}", env!("CARGO_PKG_VERSION"))
}

/// This run of the program.
///
/// # Errors
/// If `SOURCE_DATE_EPOCH` is set and is not a time.
pub fn this_run() -> Result<ProgramRun, Failure> {
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    Ok(ProgramRun {
        program: generator(),
        command: std::iter::once("spineline".to_owned()).chain(words).collect(),
        date_utc: now()?.to_rfc3339_opts(SecondsFormat::Secs, true),
    })
}

fn now() -> Result<DateTime<Utc>, Failure> {
    let Some(given) = std::env::var_os(EPOCH) else { return Ok(Utc::now()) };
    let seconds = given.to_str().and_then(|text| text.parse::<i64>().ok());
    seconds.and_then(|seconds| DateTime::from_timestamp(seconds, 0)).ok_or_else(|| {
        Failure::usage(format!(
            "{EPOCH} is `{}`; expected whole seconds since 1970",
            given.to_string_lossy()
        ))
    })
}

/// An SVG with its provenance as metadata, which viewers do not draw.
pub fn in_svg(svg: &str, provenance: &Provenance) -> String {
    let Some(end) = svg.find("<svg").and_then(|start| Some(start + svg[start..].find('>')? + 1))
    else {
        return svg.to_owned();
    };
    let text = spineline_files::to_text(provenance);
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    format!("{}\n<metadata>{text}</metadata>{}", &svg[..end], &svg[end..])
}
