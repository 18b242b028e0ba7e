//! Who is let in: `account`, and what `serve` demands before it listens.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use assert_cmd::assert::Assert;

use crate::program::{Here, folder, spineline};

const PASSWORD: &str = "a long enough sentence";

fn run(here: &Here, arguments: &[&str], input: &str) -> Assert {
    spineline(here.folder()).args(arguments).write_stdin(input).assert()
}

fn output_of(assert: &Assert) -> String {
    let output = assert.get_output();
    let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    format!("{out}{err}")
}

fn store_with_admin(here: &Here) {
    run(here, &["study", "create", "s.spineline"], "").success();
    add_admin(here);
}

#[test]
fn accounts_are_made_changed_and_listed() {
    let here = folder();
    store_with_admin(&here);
    let run = |arguments: &[&str], input: &str| run(&here, arguments, input);
    let add = ["account", "add", "r2", "--role", "reader", "--password-stdin", "s.spineline"];
    let weak = run(&add, "short\n").failure().code(3);
    assert!(output_of(&weak).contains("12 characters") && !output_of(&weak).contains("short"));
    let lines = run(&add, &format!("{PASSWORD}\nanother sentence\n")).failure().code(3);
    assert!(output_of(&lines).contains("more than one line"), "{}", output_of(&lines));
    run(&add, &format!("{PASSWORD}\r\n\n")).success();
    run(&add, PASSWORD).failure().code(3);
    run(&["account", "edit", "r2", "--role", "editor", "s.spineline"], "").success();
    run(&["account", "edit", "r2", "s.spineline"], "").failure().code(2);
    run(&["account", "edit", "lead", "--disable", "s.spineline"], "").failure().code(3);
    run(&["account", "grant", "r2", "none", "--role", "editor", "s.spineline"], "")
        .failure()
        .code(3);
    let list = run(&["account", "list", "s.spineline"], "").success();
    assert!(
        output_of(&list).contains("r2") && output_of(&list).contains("editor"),
        "{}",
        output_of(&list)
    );
    assert!(!output_of(&list).contains("argon2"));
    run(&["study", "verify", "s.spineline"], "").success();
}

#[test]
fn a_password_is_never_an_argument() {
    let here = folder();
    store_with_admin(&here);
    let add = ["account", "add", "r2", "--role", "reader", "s.spineline"];
    let refused = run(&here, &add, PASSWORD).failure().code(2);
    assert!(output_of(&refused).contains("--password-stdin"), "{}", output_of(&refused));
}

#[test]
fn f70_an_address_other_than_loopback_needs_accounts() {
    let here = folder();
    run(&here, &["study", "create", "s.spineline"], "").success();
    for demanding in
        [&["--bind", "0.0.0.0", "--host", "h"][..], &["--bind", "192.0.2.1"], &["--accounts"]]
    {
        let arguments = [&["serve", "s.spineline"], demanding].concat();
        let refused = run(&here, &arguments, "").failure().code(3);
        let expected = "spineline account add NAME --role admin s.spineline";
        assert!(output_of(&refused).contains(expected), "{}", output_of(&refused));
    }
    add_admin(&here);
    let nameless = run(&here, &["serve", "s.spineline", "--bind", "0.0.0.0"], "");
    assert!(output_of(&nameless.failure().code(2)).contains("--host NAME"));
}

fn add_admin(here: &Here) {
    let add = ["account", "add", "lead", "--role", "admin", "--password-stdin", "s.spineline"];
    run(here, &add, PASSWORD).success();
}

/// The first line and the standard error of a server that is then ended.
fn serve(here: &Here, arguments: &[&str]) -> (String, String) {
    let mut server = here
        .process()
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a server");
    let mut line = String::new();
    let output = server.stdout.take().expect("its output");
    BufReader::new(output).read_line(&mut line).expect("a line");
    server.kill().expect("killed");
    let told = server.wait_with_output().expect("an end").stderr;
    (line, String::from_utf8_lossy(&told).into_owned())
}

/// The first line of a server that is then ended.
fn first_line(here: &Here, arguments: &[&str]) -> String {
    serve(here, arguments).0
}

#[test]
fn f70_loopback_is_the_default() {
    let here = folder();
    let line = first_line(&here, &["serve", "new.spineline", "--port", "0"]);
    assert!(line.starts_with("http://127.0.0.1:") && line.contains("/#token="), "{line}");
    assert!(!line.contains('?'), "{line}");
    store_with_admin(&here);
    let arguments = ["serve", "s.spineline", "--port", "0", "--accounts"];
    let line = first_line(&here, &arguments);
    assert!(line.starts_with("http://127.0.0.1:") && !line.contains("token"), "{line}");
}

#[test]
fn a_case_is_served_from_a_store_beside_it() {
    let here = folder();
    let films = ["--films", "--pixel-size", "2", "--subject", "1", "--out", "p"];
    run(&here, &[&["phantom"][..], &films].concat(), "").success();
    let case = "p/phantom-rod-01.json";
    let before = std::fs::read(here.path(case)).expect("a case");
    for _ in 0..2 {
        let line = first_line(&here, &["serve", case, "--port", "0"]);
        assert!(line.contains("phantom-rod-01: added") || line.starts_with("http://"), "{line}");
        let list = run(&here, &["study", "list", "p/phantom-rod-01.spineline"], "");
        assert!(output_of(&list.success()).contains("phantom-rod-01"));
    }
    assert_eq!(std::fs::read(here.path(case)).expect("a case"), before);
    // A mark of the byte order, and another ending.
    let marked = ["\u{feff}".as_bytes(), &before].concat();
    here.write("p/marked.case", marked);
    let line = first_line(&here, &["serve", "p/marked.case", "--port", "0"]);
    assert!(line.contains("phantom-rod-01: added"), "{line}");
    // A film that was exchanged later.
    here.write("p/phantom-rod-01-erect.dcm", "another film");
    let (_, told) = serve(&here, &["serve", case, "--port", "0"]);
    assert!(told.contains("has another erect film"), "{told}");
    // Another case of the same name.
    here.change(case, |case| case["case_id"] = "other".into());
    let refused = output_of(&run(&here, &["serve", case, "--port", "0"], "").failure().code(3));
    assert!(
        refused.contains("the case other") && refused.contains("keeps phantom-rod-01"),
        "{refused}"
    );
}

#[test]
fn nothing_is_left_of_a_refused_case_or_a_misspelt_path() {
    let here = folder();
    here.write("torn.json", "{");
    here.write("model.json", "{\"format\": \"spineline-model\"}");
    let missing = ["none.json", "none.JSON", "none/case.json"].map(|name| (name, "no such case"));
    let others = [("torn.json", "torn.json"), ("model.json", "spineline-model")];
    let store = [("none/s.spineline", "its folder does not exist")];
    for (path, expected) in missing.into_iter().chain(others).chain(store) {
        let refused = output_of(&run(&here, &["serve", path, "--port", "0"], "").failure().code(3));
        assert!(refused.contains(expected), "{path}: {refused}");
    }
    let left = std::fs::read_dir(here.folder()).expect("a folder");
    let left = left.map(|entry| entry.expect("an entry").file_name());
    let left: Vec<_> = left.filter(|name| name.to_string_lossy().contains("spineline")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_program_without_the_app_says_so_before_its_address() {
    let here = folder();
    let (_, told) = serve(&here, &["serve", "new.spineline", "--port", "0"]);
    // The page of a program without the app loads no script.
    assert_eq!(told.contains("cargo xtask web"), !spineline_server::has_app(), "{told}");
}

#[test]
fn archives_need_a_name_an_address_and_a_login_from_a_file() {
    let here = folder();
    here.write("clinic.login", "no colon, but a secret\n");
    let archive = ["--dicomweb", "clinic=http://127.0.0.1:8042/dicom-web"];
    for (arguments, code, expected) in [
        (&["--dicomweb", "clinic"][..], 2, "NAME=ADDRESS"),
        (&["--dicomweb", "clinic=ftp://a.example"], 2, "https://"),
        (&["--dicomweb-login", "clinic=clinic.login"], 2, "no --dicomweb names"),
        (&[archive, archive].concat(), 2, "twice"),
        (&[archive, ["--dicomweb-login", "clinic"]].concat(), 2, "NAME=FILE"),
        (&[archive, ["--dicomweb-login", "clinic=none"]].concat(), 3, "none"),
        (&[archive, ["--dicomweb-login", "clinic=clinic.login"]].concat(), 3, "USER:PASSWORD"),
    ] {
        let arguments = [&["serve", "s.spineline", "--port", "0"][..], arguments].concat();
        let refused = output_of(&run(&here, &arguments, "").failure().code(code));
        assert!(refused.contains(expected) && !refused.contains("secret"), "{refused}");
    }
}
