//! Every command of the guide, run as a reader would: page by page, in one folder.
#![cfg(unix)]

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use spineline::warning::WarningCode;

use crate::program::folder;

/// Commands of a page.
struct Block {
    /// Page and line.
    place: String,
    /// `sh`, or `sh,ignore` for what a test cannot run.
    kind: String,
    text: String,
}

fn guide() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/src")
}

/// The pages in the order of the summary; those that are made for the book alone have no commands.
fn pages() -> Vec<String> {
    let summary = fs::read_to_string(guide().join("SUMMARY.md")).expect("a summary");
    let links = summary.lines().filter_map(|line| line.split_once("](")?.1.strip_suffix(')'));
    links.filter(|page| guide().join(page).exists()).map(str::to_owned).collect()
}

fn blocks(page: &str) -> Vec<Block> {
    let text = fs::read_to_string(guide().join(page)).expect("a page");
    let mut found: Vec<Block> = Vec::new();
    let mut inside = false;
    for (number, line) in text.lines().enumerate() {
        let is_indented = line.starts_with(' ') && line.trim_start().starts_with("```");
        assert!(!is_indented, "{page}:{}: an indented block would not run", number + 1);
        match (inside, line.strip_prefix("```")) {
            (false, Some(kind)) => {
                let place = format!("{page}:{}", number + 1);
                found.push(Block { place, kind: kind.to_owned(), text: String::new() });
                inside = true;
            }
            (true, Some(_)) => inside = false,
            (true, None) => found.last_mut().expect("it began").text += &format!("{line}\n"),
            (false, None) => {}
        }
    }
    found.into_iter().filter(|block| block.kind.starts_with("sh")).collect()
}

#[test]
fn every_command_of_the_guide_runs() {
    let here = folder();
    let beside = Path::new(env!("CARGO_BIN_EXE_spineline")).parent().expect("a folder").to_owned();
    let path = env::var_os("PATH").unwrap_or_default();
    let path = env::join_paths([beside].into_iter().chain(env::split_paths(&path)));
    let path = path.expect("folders without colons");
    let mut ran = 0;
    for block in pages().iter().flat_map(|page| blocks(page)) {
        if block.kind == "sh,ignore" {
            assert!(block.text.starts_with("# "), "{}: say why no test runs it", block.place);
            continue;
        }
        assert_eq!(block.kind, "sh", "{}", block.place);
        let mut shell = Command::new("sh");
        shell.args(["-eu", "-c", &block.text]).current_dir(here.folder()).env("PATH", &path);
        // `import` writes its secret there.
        shell.env("XDG_CONFIG_HOME", here.path("configuration"));
        let output = shell.output().expect("a shell");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}:\n{}{said}", block.place, block.text);
        ran += 1;
    }
    assert!(ran >= 15, "only {ran} blocks were found");
}

#[test]
fn every_option_in_the_text_of_the_guide_exists() {
    // Options of cargo.
    const OTHERS: [&str; 2] = ["--features", "--no-default-features"];
    let completions = folder().done(&["completions", "bash"]);
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '-';
    let known: Vec<&str> = completions.split(|c: char| !is_letter(c)).chain(OTHERS).collect();
    for page in pages() {
        let text = fs::read_to_string(guide().join(&page)).expect("a page");
        // What follows a backtick up to the end of the word; a word of text follows its end, and is not an option.
        for rest in text.split('`').filter(|rest| rest.starts_with("--")) {
            let option = rest.split(|c: char| !is_letter(c)).next().expect("a word");
            assert!(known.contains(&option), "{page}: {option}");
        }
    }
}

#[test]
fn the_guide_shows_every_command_on_studies_and_accounts() {
    let shown: String =
        pages().iter().flat_map(|page| blocks(page)).map(|block| block.text).collect();
    for group in ["study", "account"] {
        let mut help = Command::new(env!("CARGO_BIN_EXE_spineline"));
        let help = help.args([group, "--help"]).output().expect("it runs").stdout;
        let help = String::from_utf8(help).expect("a text");
        let (_, commands) = help.split_once("Commands:\n").expect("a list of commands");
        let (commands, _) = commands.split_once("\n\n").expect("an end of the list");
        // Further lines of a text begin with more spaces.
        let commands = commands.lines().filter_map(|line| line.strip_prefix("  "));
        let names = commands.filter_map(|line| line.split(' ').next());
        let names: Vec<&str> = names.filter(|name| !name.is_empty() && *name != "help").collect();
        assert!(names.len() >= 5, "{help}");
        for name in names {
            assert!(shown.contains(&format!("spineline {group} {name} ")), "{group} {name}");
        }
    }
}

#[test]
fn every_page_is_in_the_summary() {
    let listed = pages();
    for entry in fs::read_dir(guide()).expect("the guide") {
        let name = entry.expect("a file").file_name().into_string().expect("a name");
        // Pictures stand beside the pages that show them.
        let is_page = name.ends_with(".md") && name != "SUMMARY.md";
        assert!(!is_page || listed.contains(&name), "{name} is not in the summary");
    }
}

#[test]
fn the_guide_says_what_to_do_about_every_warning() {
    let checks = fs::read_to_string(guide().join("checks.md")).expect("a page");
    let missing =
        WarningCode::ALL.iter().filter(|code| !checks.contains(&format!("`{}`", code.key())));
    let missing: Vec<_> = missing.map(|code| code.key()).collect();
    assert!(missing.is_empty(), "checks.md names no {missing:?}");
}
