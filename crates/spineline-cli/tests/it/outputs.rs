//! Where results go: what is replaced, what never is, and what is left after a failure.

use std::fs;
use std::path::Path;

use crate::maker::{EXPLICIT, Maker, ramp};
use crate::program::{Here, folder, split};

/// A folder with everything that the commands below read.
fn samples() -> Here {
    let here = folder();
    here.wrote(&["phantom", "--scenario", "rod", "--subject", "1", "--noise", "0", "--out", "p"]);
    fs::rename(here.path("p/phantom-rod-01.json"), here.path("case.json")).expect("a case");
    here.wrote(&["analyze", "case.json", "--json", "analysis.json", "--model", "model.json"]);
    here.wrote(&["study", "create", "study.spineline"]);
    here.write("readings.csv", READINGS);
    here
}

/// A table of readings.
pub const READINGS: &str = "quantity,unit,subject,observer,repeat,value,synthetic
t,deg,P1,A,1,1.0,true\nt,deg,P1,B,1,1.5,true\nt,deg,P2,A,1,3.0,true\nt,deg,P2,B,1,3.4,true
t,deg,P3,A,1,5.0,true\nt,deg,P3,B,1,5.3,true\n";

/// Every command with an output of one file; the file comes last.
const TO_FILE: [&[&str]; 21] = [
    &["analyze", "case.json", "--json"],
    &["analyze", "case.json", "--csv"],
    &["analyze", "case.json", "--chain"],
    &["analyze", "case.json", "--cohort"],
    &["analyze", "case.json", "--model"],
    &["report", "case.json", "--out"],
    &["report", "case.json", "--to", "md", "--out"],
    &["rerun", "analysis.json", "--json"],
    &["simulate", "model.json", "--push", "left", "--force", "10", "--json"],
    &["simulate", "model.json", "--push", "left", "--force", "10", "--csv"],
    &["simulate", "model.json", "--push", "left", "--force", "10", "--measures"],
    &["simulate", "model.json", "--push", "left", "--force", "10", "--svg"],
    &["export", "model.json", "--to", "mjcf", "--out"],
    &["export", "model.json", "--to", "osim", "--out"],
    &["export", "model.json", "--to", "sto", "--out"],
    &["export", "model.json", "--to", "loads", "--out"],
    &["export", "case.json", "--to", "csv", "--out"],
    &["export", "case.json", "--to", "slicer", "--posture", "erect", "--out"],
    &["export", "case.json", "--to", "coco", "--out"],
    &["reliability", "readings.csv", "--json"],
    &["reliability", "readings.csv", "--csv"],
];

/// Every command with an output of a folder that is quick enough to run here; the folder comes last.
const TO_FOLDER: [&[&str]; 8] = [
    &["analyze", "case.json", "--figures"],
    &["analyze", "case.json", "--tables"],
    &["report", "case.json", "--out", "r.html", "--figures"],
    &["rerun", "analysis.json", "--figures"],
    &["export", "case.json", "--to", "slicer", "--out"],
    &["reliability", "readings.csv", "--figures"],
    &["phantom", "--scenario", "rod", "--subject", "1", "--out"],
    &["noise-study", "--phantoms", "2", "--out"],
];

fn with<'a>(command: &[&'a str], last: &'a str) -> Vec<&'a str> {
    command.iter().copied().chain([last]).collect()
}

/// What is in a folder, with what is in the files.
fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.display().to_string();
        if path.is_dir() {
            found.extend(content(&path));
            found.push((name, Vec::new()));
        } else {
            found.push((name, fs::read(&path).unwrap_or_default()));
        }
    }
    found.sort();
    found
}

/// A refused command leaves every file as it is, and says which one it would have destroyed.
#[track_caller]
fn refuses(here: &Here, arguments: &[&str], name: &str, why: &str) {
    let before = content(here.folder());
    let (out, error, code) = here.run(arguments);
    assert_eq!(code, 3, "{arguments:?}: {out}{error}");
    assert!(error.contains(name) && error.contains(why), "{arguments:?}: {error}");
    assert!(error.contains("help: "), "{arguments:?}: {error}");
    assert!(before == content(here.folder()), "{arguments:?} changed files");
}

#[test]
fn no_command_replaces_its_input() {
    let here = samples();
    for command in TO_FILE {
        refuses(&here, &with(command, command[1]), command[1], "input");
    }
    // Through another spelling, a link and a second name.
    fs::hard_link(here.path("case.json"), here.path("hard.json")).expect("a link");
    let mut names = vec!["./p/../case.json", "hard.json"];
    if cfg!(unix) {
        #[cfg(unix)]
        std::os::unix::fs::symlink("case.json", here.path("soft.json")).expect("a link");
        names.push("soft.json");
    }
    for name in names {
        refuses(&here, &["analyze", "case.json", "--json", name, "--overwrite"], name, "input");
    }
    let stiffness = here.run(&["stiffness"]).0;
    here.write("stiffness.csv", stiffness);
    let arguments = "analyze case.json --stiffness stiffness.csv --csv stiffness.csv";
    refuses(&here, &split(arguments), "stiffness.csv", "input");
}

#[test]
fn no_command_replaces_a_film() {
    let here = samples();
    here.write("erect.dcm", Maker::new(60, 40, &ramp(60, 40)).file(EXPLICIT));
    here.write("bend.png", "a picture");
    here.change("case.json", |case| case["films"][1]["image"]["file"] = "bend.png".into());
    for command in TO_FILE {
        for film in ["erect.dcm", "bend.png"] {
            if film == "erect.dcm" || command[1] == "case.json" {
                let arguments = [&with(command, film)[..], &["--overwrite"]].concat();
                refuses(&here, &arguments, film, "a film");
            }
        }
    }
    // What this program drew is not the only copy.
    for size in ["3", "4"] {
        let drawn = format!("phantom --subject 1 --films --pixel-size {size} --out d --overwrite");
        here.wrote(&split(&drawn));
    }
}

#[test]
fn no_command_replaces_a_store() {
    let here = samples();
    for command in TO_FILE {
        for more in [&[][..], &["--overwrite"]] {
            let arguments = [&with(command, "study.spineline")[..], more].concat();
            refuses(&here, &arguments, "study.spineline", "store");
        }
        refuses(&here, &with(command, "study.spineline-wal"), "study.spineline-wal", "store");
    }
}

#[test]
fn what_others_wrote_is_replaced_only_when_asked() {
    let here = samples();
    for command in TO_FILE {
        here.write("mine", "notes of a week");
        refuses(&here, &with(command, "mine"), "mine", "--overwrite");
        let arguments = [&with(command, "mine")[..], &["--overwrite"]].concat();
        here.wrote(&arguments);
        let now = fs::read(here.path("mine")).expect("a file");
        assert_ne!(now, b"notes of a week", "{arguments:?}");
        fs::remove_file(here.path("mine")).expect("a file");
        let _ = fs::remove_file(here.path("mine.provenance.json"));
    }
    // A case holds landmarks, whichever program wrote it.
    fs::copy(here.path("case.json"), here.path("other.json")).expect("a copy");
    refuses(&here, &["analyze", "case.json", "--json", "other.json"], "other.json", "--overwrite");
}

#[test]
fn a_command_replaces_its_own_results() {
    let here = samples();
    for command in TO_FILE.iter().chain(&TO_FOLDER).filter(|command| command[0] != "noise-study") {
        for _ in 0..2 {
            let arguments = with(command, "result");
            here.wrote(&arguments);
        }
        let result = here.path("result");
        let removed =
            if result.is_dir() { fs::remove_dir_all(&result) } else { fs::remove_file(&result) };
        removed.expect("a result");
        let _ = fs::remove_file(here.path("result.provenance.json"));
    }
}

/// Adds something at the end of a file, or changes its last digit, which stands in a result and not in its hash.
fn edit(file: &Path, is_added: bool) {
    let mut bytes = fs::read(file).expect("a result");
    let last = bytes.iter().rposition(u8::is_ascii_digit).expect("a digit");
    if is_added {
        bytes.extend_from_slice(b"\nseen on Monday\n");
    } else {
        bytes[last] = if bytes[last] == b'7' { b'8' } else { b'7' };
    }
    fs::write(file, bytes).expect("an edited result");
}

#[test]
fn a_result_that_was_edited_is_replaced_only_when_asked() {
    let here = samples();
    let file = here.path("result");
    for command in TO_FILE {
        for is_added in [true, false] {
            let arguments = with(command, "result");
            here.run(&arguments);
            edit(&file, is_added);
            refuses(&here, &arguments, "result", "--overwrite");
            here.wrote(&[&arguments[..], &["--overwrite"]].concat());
            fs::remove_file(&file).expect("a result");
            let _ = fs::remove_file(here.path("result.provenance.json"));
        }
    }
}

#[test]
fn an_edited_file_of_a_folder_is_replaced_only_when_asked() {
    let here = samples();
    for (command, name) in [
        (TO_FOLDER[0], "phantom-rod-01-overview.svg"),
        (TO_FOLDER[1], "joints.csv"),
        (TO_FOLDER[1], "joints.parquet"),
        (TO_FOLDER[3], "phantom-rod-01-overview.svg"),
        (TO_FOLDER[4], "erect.mrk.json"),
    ] {
        let arguments = with(command, "result");
        here.run(&arguments);
        edit(&here.path("result").join(name), true);
        let before = content(here.folder());
        let (_, error, code) = here.run(&arguments);
        assert!(code == 3 && error.contains(name) && error.contains("--overwrite"), "{error}");
        assert!(before == content(here.folder()), "{arguments:?} changed files");
        fs::remove_dir_all(here.path("result")).expect("a folder");
    }
    let report = ["report", "case.json", "--to", "md", "--out", "r.md", "--figures", "pictures"];
    here.run(&report);
    let folder = fs::read_dir(here.path("r-figures")).expect("figures");
    let figure = folder.map(|one| one.expect("a figure").path()).min().expect("a figure");
    edit(&figure, false);
    let before = fs::read(&figure).expect("a figure");
    let (_, error, code) = here.run(&report);
    let name = figure.file_name().expect("a name").to_string_lossy();
    assert!(code == 3 && error.contains(&*name) && error.contains("--overwrite"), "{error}");
    assert!(fs::read(&figure).expect("a figure") == before);
}

#[test]
fn a_result_of_another_patient_is_replaced_only_when_asked() {
    let here = samples();
    here.wrote(&["phantom", "--scenario", "rod", "--subject", "2", "--noise", "0", "--out", "p"]);
    fs::rename(here.path("p/phantom-rod-02.json"), here.path("other-case.json")).expect("a case");
    let other = "analyze other-case.json --json other-analysis.json --model other-model.json";
    here.wrote(&split(other));
    for command in TO_FILE.iter().filter(|command| command[1] != "readings.csv") {
        here.wrote(&with(command, "result"));
        let other = format!("other-{}", command[1]);
        let mut arguments = with(command, "result");
        arguments[1] = &other;
        refuses(&here, &arguments, "phantom-rod-01", "--overwrite");
        here.wrote(&[&arguments[..], &["--overwrite"]].concat());
        here.wrote(&arguments);
        fs::remove_file(here.path("result")).expect("a result");
        let _ = fs::remove_file(here.path("result.provenance.json"));
        let _ = fs::remove_dir_all(here.path("result-figures"));
    }
    // A cohort may gain patients and lose none.
    let of = |cases: &[&str]| {
        let outputs = ["--json", "all.json", "--csv", "all.csv", "--tables", "tables"];
        here.run(&[&["analyze"], cases, &outputs].concat())
    };
    assert_eq!(of(&["case.json"]).2, 0);
    assert_eq!(of(&["case.json", "other-case.json"]).2, 0);
    let (_, error, code) = of(&["case.json"]);
    assert!(code == 3 && error.contains("phantom-rod-02"), "{error}");
}

#[test]
#[cfg(unix)]
fn a_result_is_made_again_from_a_pipe() {
    let here = samples();
    let case = fs::read(here.path("case.json")).expect("a case");
    for _ in 0..2 {
        let outputs = ["--json", "a.json", "--csv", "a.csv", "--tables", "t", "--figures", "f"];
        let mut command = crate::program::spineline(here.folder());
        command.args(["analyze", "/dev/stdin"]).args(outputs).write_stdin(case.clone());
        let (_, error, code) = crate::program::finish(&mut command);
        assert_eq!(code, 0, "{error}");
    }
}

#[test]
fn names_that_differ_in_case_alone_are_one_name() {
    let here = samples();
    let arguments = ["analyze", "case.json", "--json", "Out.x", "--csv", "oUT.x"];
    refuses(&here, &arguments, "oUT.x", "two outputs");
    let new = ["analyze", "case.json", "--json", "new/./Out.x", "--csv", "New/out.x"];
    refuses(&here, &new, "out.x", "two outputs");
    let figure = "figures/phantom-rod-01-OVERVIEW.svg";
    refuses(
        &here,
        &["analyze", "case.json", "--json", figure, "--figures", "figures"],
        "phantom-rod-01-overview.svg",
        "two outputs",
    );
    let case = here.text("case.json");
    fs::create_dir(here.path("two")).expect("a folder");
    for id in ["P01", "p01"] {
        let text = case.replace("phantom-rod-01", id);
        let name = format!("two/of-{}.json", u8::from(id == "P01"));
        here.write(name, text);
    }
    let cohort = ["analyze", "two", "--json", "all.json", "--figures", "figures"];
    let (_, error, code) = here.run(&cohort);
    assert!(code == 3 && error.contains("was given already as"), "{error}");
}

#[test]
fn two_outputs_need_two_files() {
    let here = samples();
    let arguments = ["analyze", "case.json", "--json", "out.x", "--csv", "./out.x"];
    refuses(&here, &arguments, "out.x", "two outputs");
    let beside = ["analyze", "case.json", "--csv", "a.csv", "--json", "a.csv.provenance.json"];
    refuses(&here, &beside, "a.csv.provenance.json", "two outputs");
    here.refused(&["analyze", "case.json", "--json", "-", "--csv", "-"], 2);
}

#[test]
fn a_place_that_cannot_be_written_is_refused_before_any_work() {
    let here = samples();
    // A file where a folder is needed; the second case does not exist, so that reading it would be reported first.
    for command in [TO_FILE.as_slice(), TO_FOLDER.as_slice()].concat() {
        refuses(
            &here,
            &with(command, "readings.csv/result"),
            "readings.csv",
            "could not be written",
        );
    }
    // An hour of work, if it were begun.
    let long = ["noise-study", "--phantoms", "1000", "--out", "readings.csv"];
    refuses(&here, &long, "readings.csv", "could not be written");
    let long = ["reproduce", "--out", "readings.csv"];
    refuses(&here, &long, "readings.csv", "could not be written");
    let long = ["analyze", "case.json", "--replicates", "1000000", "--json", "p"];
    refuses(&here, &long, "p ", "name a file");
}

#[test]
fn the_standard_output_takes_any_file_but_one_only() {
    let here = samples();
    for command in TO_FILE.iter().filter(|command| !command.contains(&"md")) {
        let before = content(here.folder());
        let out = here.wrote(&with(command, "-"));
        assert!(!out.is_empty() && !out.contains("Report   -"), "{command:?}");
        let here = content(here.folder());
        let more: Vec<&String> =
            here.iter().filter(|file| !before.contains(file)).map(|(name, _)| name).collect();
        assert!(more.is_empty(), "{command:?} wrote {more:?}");
    }
    let before = content(here.folder());
    // Markdown has its figures beside it.
    for command in TO_FOLDER.iter().chain(TO_FILE.iter().filter(|file| file.contains(&"md"))) {
        here.refused(&with(command, "-"), 2);
        assert!(before == content(here.folder()) && !here.path("-").exists(), "{command:?}");
    }
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{FileTypeExt, symlink};
    use std::process::{Command, Stdio};
    use std::thread;

    use super::*;

    fn is_pipe(path: &Path) -> bool {
        fs::symlink_metadata(path).is_ok_and(|found| found.file_type().is_fifo())
    }

    #[test]
    fn a_device_is_written_into_and_stays_one() {
        let here = samples();
        symlink("/dev/null", here.path("null")).expect("a link");
        for command in TO_FILE {
            here.wrote(&with(command, "null"));
            let link = fs::symlink_metadata(here.path("null")).expect("a link");
            assert!(link.is_symlink(), "{command:?}");
            let device = fs::metadata("/dev/null").expect("a device");
            assert!(device.file_type().is_char_device(), "{command:?}");
        }
    }

    #[test]
    fn a_pipe_is_written_into_and_stays_one() {
        let here = samples();
        let pipe = here.path("pipe");
        let made = Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
        assert!(made.success());
        for command in [TO_FILE[0], TO_FILE[1], TO_FILE[11]] {
            let reader = thread::spawn({
                let pipe = pipe.clone();
                move || fs::read_to_string(pipe).expect("text")
            });
            here.wrote(&with(command, "pipe"));
            assert!(!reader.join().expect("read").is_empty(), "{command:?}");
            assert!(is_pipe(&pipe), "{command:?}");
        }
    }

    #[test]
    fn the_device_of_the_standard_output_is_the_standard_output() {
        let here = samples();
        let (dash, ..) = here.run(&["export", "model.json", "--to", "mjcf", "--out", "-"]);
        for name in ["/dev/stdout", "/proc/self/fd/1"] {
            let log = fs::File::create(here.path("log")).expect("a file");
            let status = here
                .process()
                .args(["export", "model.json", "--to", "mjcf", "--out", name])
                .stdout(Stdio::from(log))
                .status()
                .expect("the program starts");
            assert!(status.success());
            assert_eq!(here.text("log"), dash);
        }
    }

    #[test]
    fn a_killed_run_leaves_nothing_that_the_next_one_does_not_remove() {
        let here = samples();
        let parts = || {
            let names = content(here.folder()).into_iter().map(|(name, _)| name);
            names.filter(|name| name.ends_with(".part")).count()
        };
        let long = ["--json", "a.json", "--replicates", "1000000", "--seed", "1"];
        let mut child = here
            .process()
            .args(["analyze", "case.json"])
            .args(long)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        while parts() == 0 {
            thread::sleep(std::time::Duration::from_millis(10));
        }
        // What a run has that goes on stays.
        assert_eq!(here.run(&["analyze", "case.json", "--csv", "b.csv"]).2, 0);
        assert!(parts() > 0);
        child.kill().expect("it runs");
        child.wait().expect("an end");
        assert!(parts() > 0);
        assert_eq!(here.run(&["analyze", "case.json", "--json", "a.json"]).2, 0);
        assert_eq!(parts(), 0);
    }

    #[test]
    fn a_link_stays_and_what_it_leads_to_is_replaced() {
        let here = samples();
        fs::create_dir(here.path("far")).expect("a folder");
        symlink("far/result", here.path("link")).expect("a link");
        for command in TO_FILE {
            // The first time, the link leads to nothing.
            for _ in 0..2 {
                here.wrote(&with(command, "link"));
                let link = fs::symlink_metadata(here.path("link")).expect("a link");
                assert!(link.is_symlink(), "{command:?}");
                let target = fs::metadata(here.path("far/result")).expect("a file");
                assert!(target.is_file() && target.len() > 0, "{command:?}");
            }
            for name in ["far/result", "link.provenance.json"] {
                let _ = fs::remove_file(here.path(name));
            }
        }
        symlink("round", here.path("round")).expect("a link");
        let error = here.refused(&["analyze", "case.json", "--json", "round"], 3);
        assert!(error.contains("circle"), "{error}");
    }

    #[test]
    fn a_folder_is_complete_or_as_it_was() {
        let here = samples();
        for command in TO_FOLDER {
            here.wrote(&with(command, "whole"));
            let whole = here.path("whole");
            let files = fs::read_dir(&whole).expect("a folder");
            let names = files.map(|entry| entry.expect("an entry").file_name());
            // Something of the user's lies where the last file goes.
            let last = names.max().expect("files");
            fs::remove_dir_all(&whole).expect("a folder");
            fs::create_dir(&whole).expect("a folder");
            fs::write(whole.join(&last), "notes of a week").expect("a file");
            let name = last.to_string_lossy().into_owned();
            let before = content(&whole);
            let error = here.refused(&with(command, "whole"), 3);
            assert!(error.contains(&name) && error.contains("--overwrite"), "{error}");
            // The table of a study is a result by itself.
            assert!(command[0] == "noise-study" || before == content(&whole), "{command:?}");
            assert_eq!(fs::read(whole.join(&last)).expect("a file"), b"notes of a week");
            fs::remove_dir_all(&whole).expect("a folder");
            let _ = fs::remove_file(here.path("r.html"));
        }
    }
}
