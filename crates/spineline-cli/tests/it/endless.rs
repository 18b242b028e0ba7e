//! Inputs without an end, or larger than any file of their kind: refused before memory is spent on them.

use std::fs::{self, File};
use std::process::Command;

use crate::maker::{EXPLICIT, Maker, ramp};
use crate::program::{self, Here, spineline, unwrapped};

/// Commands that read the file `@` whole, with the limit in the refusal.
const READERS: [(&str, &str); 11] = [
    ("check @", "the limit is 64 MB"),
    ("analyze @", "the limit is 64 MB"),
    ("analyze phantom-rod-01.json --stiffness @", "the limit is 64 MB"),
    ("simulate @ --push left", "the limit is 64 MB"),
    ("export @ --to csv", "the limit is 64 MB"),
    ("report @ --out report.html", "the limit is 64 MB"),
    ("reliability @", "the limit is 64 MB"),
    ("study add studies.spineline @", "the limit is 64 MB"),
    (
        "import film.dcm --film erect=1 --case-id P1 --out P1 --patient-left image-left --landmarks @",
        "the limit is 64 MB",
    ),
    ("import aasce --aasce --sizes @ --patient-left image-left --out sets", "the limit is 64 MB"),
    ("rerun @", "the limit is 256 MB"),
];

/// A folder with what the commands need besides.
fn folder() -> Here {
    let here = program::folder();
    here.done(&["phantom", "--subject", "1", "--out", "."]);
    here.done(&["study", "create", "studies.spineline"]);
    here.write("film.dcm", Maker::new(60, 40, &ramp(60, 40)).file(EXPLICIT));
    fs::create_dir(here.path("aasce")).expect("a folder");
    here
}

/// Standard error and exit code of a shell line in which `@` stands for a file, with little more memory than a decoder of films asks for.
fn limited(here: &Here, before: &str, line: &str, file: &str) -> (String, Option<i32>) {
    let program = spineline(here.folder()).get_program().to_owned();
    let script = format!("ulimit -v 3200000; {before}\"$0\" {}", line.replace('@', file));
    let mut command = Command::new("sh");
    let output = command.current_dir(here.folder()).args(["-c", &script]).arg(program).output();
    let output = output.expect("a shell");
    (unwrapped(&String::from_utf8_lossy(&output.stderr)), output.status.code())
}

#[cfg(unix)]
#[test]
fn a_device_without_an_end_is_refused_by_its_limit() {
    let here = folder();
    for (line, limit) in READERS {
        let (error, code) = limited(&here, "", line, "/dev/zero");
        assert_eq!(code, Some(3), "{line}: {error}");
        for part in ["/dev/zero: it is too large", limit, "help: "] {
            assert!(error.contains(part), "{line}: {error}");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_without_an_end_is_refused_by_its_limit() {
    let here = folder();
    for (line, limit) in [READERS[0], READERS[6], READERS[10]] {
        let (error, code) = limited(&here, "yes | ", line, "/dev/stdin");
        assert_eq!(code, Some(3), "{line}: {error}");
        assert!(error.contains(limit), "{line}: {error}");
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_that_ends_is_read_as_a_file() {
    let here = folder();
    for (file, line) in [("phantom-rod-01.json", "check"), ("film.dcm", "film")] {
        let script = format!("cat {file} | \"$0\" {line} /dev/stdin");
        let mut command = Command::new("sh");
        command.current_dir(here.folder()).args(["-c", &script]);
        let program = spineline(here.folder()).get_program().to_owned();
        let output = command.arg(program).output().expect("a shell");
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{line}: {error}");
    }
}

#[cfg(unix)]
#[test]
fn a_file_that_is_not_a_film_is_not_read_to_its_end() {
    let here = folder();
    let (error, code) = limited(&here, "", "film @", "/dev/zero");
    assert_eq!(code, Some(3), "{error}");
    assert!(error.contains("/dev/zero") && error.contains("help: "), "{error}");
    // What begins like a film, and never ends.
    let before = "(cat film.dcm; cat /dev/zero) | ";
    let (error, code) = limited(&here, before, "film @", "/dev/stdin");
    assert_eq!(code, Some(3), "{error}");
    assert!(error.contains("the limit is 268435456"), "{error}");
}

#[test]
fn a_file_that_is_too_large_is_refused_by_its_size() {
    let here = folder();
    File::create(here.path("large")).and_then(|file| file.set_len(1 << 30)).expect("a sparse file");
    for (line, limit) in READERS {
        let arguments: Vec<_> = line.split(' ').map(|part| part.replace('@', "large")).collect();
        let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
        let error = here.refused(&arguments, 3);
        for part in ["large: it has 1024 MB", limit, "help: "] {
            assert!(unwrapped(&error).contains(part), "{line}: {error}");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_in_a_folder_of_cases_is_not_waited_for() {
    let here = folder();
    let made = Command::new("mkfifo").arg(here.path("pipe.json")).status();
    assert!(made.expect("mkfifo").success());
    let error = here.refused(&["check", "."], 3);
    assert!(error.contains("pipe.json: it is not a plain file"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_pipe_that_a_case_names_as_a_film_is_not_waited_for() {
    let here = folder();
    let case = "phantom-rod-01.json";
    here.change(case, |case| {
        for (number, film) in case["films"].as_array_mut().expect("films").iter_mut().enumerate() {
            film["image"]["file"] = format!("{number}.dcm").into();
        }
    });
    let made = Command::new("mkfifo").arg(here.path("0.dcm")).status();
    assert!(made.expect("mkfifo").success());
    std::os::unix::fs::symlink("/dev/zero", here.path("1.dcm")).expect("a link");
    let (error, code) = limited(&here, "", "report @ --out report.html", case);
    assert_eq!(code, Some(0), "{error}");
    assert!(error.contains("erect film is not shown") && error.contains("regular file"), "{error}");
    for line in ["export @ --to dicom-sr --posture erect", "study add studies.spineline @"] {
        let (error, code) = limited(&here, "", line, case);
        assert_eq!(code, Some(3), "{line}: {error}");
        assert!(error.contains("0.dcm: it is not a regular file"), "{line}: {error}");
    }
    fs::remove_file(here.path("0.dcm")).expect("the pipe");
    fs::copy(here.path("film.dcm"), here.path("0.dcm")).expect("a film");
    let (error, code) = limited(&here, "", "study add studies.spineline @", case);
    assert_eq!(code, Some(3), "{error}");
    assert!(error.contains("1.dcm: it is not a regular file"), "{error}");
}

#[cfg(unix)]
#[test]
fn an_input_that_an_analysis_names_is_read_from_plain_files_alone() {
    let here = folder();
    let analyze = ["analyze", "phantom-rod-01.json", "--json", "analysis.json"];
    assert_ne!(here.run(&analyze).2, 3);
    let text = here.text("analysis.json");
    let other = text.replace("\"name\": \"phantom-rod-01.json\"", "\"name\": \"/dev/zero\"");
    assert!(other != text, "it names its input");
    here.write("analysis.json", other);
    let (error, code) = limited(&here, "", "rerun @", "analysis.json");
    assert_eq!(code, Some(0), "{error}");
}
