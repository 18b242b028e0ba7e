//! Where an output comes from: program, command, date and inputs.

use std::path::Path;
use std::sync::OnceLock;
use std::time::SystemTime;

use chrono::{DateTime, SecondsFormat, Utc};
use spineline_files::{ProgramRun, Provenance};

use super::failure::Failure;
use super::shard::Shard;

/// Environment variable with the time of the run in seconds since 1970, for reproducible outputs (reproducible-builds.org).
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// Whether outputs name files with their folders, as the command line does.
static FULL_PATHS: OnceLock<bool> = OnceLock::new();

/// Sets once, for the whole run, whether outputs name files with their folders. A folder may carry the name of a patient or
/// of a user, so the default is not to.
pub fn keep_full_paths(keep: bool) {
    // Only the first call counts; there is one per run.
    let _ = FULL_PATHS.set(keep);
}

/// A file as outputs name it: without its folder.
pub fn shown_name(path: &Path) -> String {
    let name = path.file_name().filter(|_| !FULL_PATHS.get().is_some_and(|keep| *keep));
    name.unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

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
        command: shown_words(std::iter::once("spineline".to_owned()).chain(words)),
        date_utc: now()?.to_rfc3339_opts(SecondsFormat::Secs, true),
    })
}

/// The words of a command line with files named as outputs name them.
fn shown_words(words: impl Iterator<Item = String>) -> Vec<String> {
    let mut is_shard = false;
    let shown = words.map(|word| {
        let joined = word.strip_prefix(Shard::OPTION).and_then(|rest| rest.strip_prefix('='));
        let value = joined.or(is_shard.then_some(&word));
        let keeps = value.is_some_and(|value| value.parse::<Shard>().is_ok());
        is_shard = word == Shard::OPTION;
        if keeps { word } else { shown_word(&word) }
    });
    shown.collect()
}

/// A word of the command line with files named as outputs name them, after `=` and between commas too.
fn shown_word(word: &str) -> String {
    let part = |part: &str| {
        if is_path(part) { shown_name(Path::new(part)) } else { part.to_owned() }
    };
    let list = |list: &str| list.split(',').map(part).collect::<Vec<_>>().join(",");
    word.split('=').map(list).collect::<Vec<_>>().join("=")
}

/// Whether a word names a file in a folder, and not two vertebrae as in `L1/T12`.
fn is_path(word: &str) -> bool {
    let is_level = |part: &str| {
        let number = part.strip_prefix(['L', 'T', 'C', 'S']);
        number.is_some_and(|number| number.len() <= 2 && number.parse::<u8>().is_ok())
    };
    word.contains(['/', '\\']) && !word.split('/').all(is_level)
}

fn now() -> Result<DateTime<Utc>, Failure> {
    let Some(given) = std::env::var_os(EPOCH) else { return Ok(SystemTime::now().into()) };
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
    // Only its strings have these letters, where JSON takes their codes.
    let text = text.replace('&', "\\u0026").replace('<', "\\u003c").replace('>', "\\u003e");
    format!("{}\n<metadata>{text}</metadata>{}", &svg[..end], &svg[end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_command_line_lose_their_folders_and_nothing_else() {
        for (word, shown) in [
            ("/home/doe/case.json", "case.json"),
            ("Doe^Jane/case.json", "case.json"),
            ("--out=../doe/a.html", "--out=a.html"),
            ("erect=/films/doe/1.dcm", "erect=1.dcm"),
            ("a/b.csv,c/d.csv", "b.csv,d.csv"),
            ("C:\\doe\\case.json", if cfg!(windows) { "case.json" } else { "C:\\doe\\case.json" }),
            ("L1/T12,T6", "L1/T12,T6"),
            ("known-force:left_bending=30", "known-force:left_bending=30"),
            ("-", "-"),
            ("case.json", "case.json"),
        ] {
            assert_eq!(shown_word(word), shown, "{word}");
        }
    }

    #[test]
    fn the_part_of_a_cohort_is_not_a_folder() {
        let shown = |words: &[&str]| shown_words(words.iter().map(|&word| word.to_owned()));
        assert_eq!(shown(&["--shard", "3/8", "4711/1"]), ["--shard", "3/8", "1"]);
        assert_eq!(shown(&["--shard=3/8", "3/8"]), ["--shard=3/8", "8"]);
    }
}
