//! Nothing private leaves by accident: canaries in paths and in films reach no output.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::maker::{EXPLICIT, Maker, ramp};
use crate::program::{run, spineline};

/// In the folders of all inputs and outputs, the home folder and the user's name.
const PLACES: [&str; 4] = ["zq-folder-canary", "zq-home-canary", "zq-user-canary", "zq-out-canary"];
/// In the films.
const PATIENT: [&str; 8] = [
    "ZqNameCanary",
    "ZqIdCanary",
    "19470311",
    "ZqHospitalCanary",
    "ZqDoctorCanary",
    "ZqAccessionCanary",
    "ZqOperatorCanary",
    "ZqCommentCanary",
];

fn film() -> Vec<u8> {
    let mut maker = Maker::new(60, 40, &ramp(60, 40));
    maker.text((0x10, 0x10), "PN", PATIENT[0]).text((0x10, 0x20), "LO", PATIENT[1]);
    maker.text((0x10, 0x30), "DA", PATIENT[2]).text((0x8, 0x80), "LO", PATIENT[3]);
    maker.text((0x8, 0x90), "PN", PATIENT[4]).text((0x8, 0x50), "SH", PATIENT[5]);
    maker.text((0x8, 0x1070), "PN", PATIENT[6]).text((0x10, 0x4000), "LT", PATIENT[7]);
    maker.file(EXPLICIT)
}

/// A folder whose path holds a canary, and its path.
fn folder() -> (TempDir, PathBuf) {
    let here = tempfile::tempdir().expect("a temporary folder");
    let folder = here.path().join(PLACES[0]);
    fs::create_dir(&folder).expect("a folder");
    (here, folder)
}

/// Runs the program from another folder, so that every path is absolute.
fn run_there(here: &Path, arguments: &[String]) -> i32 {
    let home = here.join(PLACES[1]);
    let mut command = spineline(here);
    command.env("HOME", &home).env("USER", PLACES[2]).env("LOGNAME", PLACES[2]);
    command.env("XDG_CONFIG_HOME", home.join(".config"));
    let output = command.args(arguments).output().expect("the program starts");
    let code = output.status.code().expect("an exit code");
    assert!(code == 0 || code == 4, "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    code
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

/// Whether bytes hold a text as it is, in UTF-16, or written for an address.
fn holds(bytes: &[u8], text: &str) -> bool {
    let wide = |unit: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(unit).collect::<Vec<u8>>();
    let forms = [
        text.as_bytes().to_vec(),
        wide(u16::to_le_bytes),
        wide(u16::to_be_bytes),
        text.replace('-', "%2D").into_bytes(),
    ];
    forms.iter().any(|form| bytes.windows(form.len()).any(|window| window == form.as_slice()))
}

/// Every command with an output, with its files in one folder.
fn every_output(inputs: &Path, out: &Path) -> Vec<Vec<String>> {
    let case = inputs.join("phantom-rod-01.json").display().to_string();
    let model = out.join("model.json").display().to_string();
    let analysis = out.join("analysis.json").display().to_string();
    let readings = inputs.join("readings.csv").display().to_string();
    let to = |name: &str| out.join(name).display().to_string();
    let line = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let push = ["simulate", &model, "--push", "left", "--force", "10"];
    let mut lines = vec![
        line(&[
            "analyze",
            &case,
            "--json",
            &to("analysis.json"),
            "--csv",
            &to("v.csv"),
            "--chain",
            &to("chain.csv"),
            "--cohort",
            &to("cohort.json"),
            "--model",
            &to("model.json"),
            "--figures",
            &to("figures"),
            "--tables",
            &to("tables"),
            "--stiffness",
            &inputs.join("stiffness.csv").display().to_string(),
        ]),
        line(&["report", &case, "--out", &to("r.html"), "--figures", &to("pictures")]),
        line(&["report", &case, "--to", "md", "--out", &to("r.md")]),
        line(&["rerun", &analysis, "--json", &to("again.json"), "--figures", &to("again")]),
        line(&[
            "reliability",
            &readings,
            "--json",
            &to("rel.json"),
            "--csv",
            &to("rel.csv"),
            "--figure",
            &to("rel"),
        ]),
        line(&["export", &case, "--to", "csv", "--out", &to("l.csv")]),
        line(&["export", &case, "--to", "slicer", "--out", &to("slicer")]),
        line(&["phantom", "--truth", "rod", "--subject", "1", "--out", &to("phantom")]),
        line(&["noise-study", "--phantoms", "2", "--out", &to("study")]),
        line(
            &[&push[..], &["--json", &to("s.json"), "--csv", &to("s.csv"), "--svg", &to("s.svg")]]
                .concat(),
        ),
    ];
    for format in ["mjcf", "osim", "urdf"] {
        lines.push(line(&["export", &model, "--to", format, "--out", &to(format)]));
    }
    if cfg!(feature = "pdf") {
        lines.push(line(&["report", &case, "--to", "pdf", "--out", &to("r.pdf")]));
    }
    lines
}

const READINGS: &str = "quantity,unit,subject,observer,repeat,value,synthetic
t,deg,P1,A,1,1.0,true\nt,deg,P1,B,1,1.5,true\nt,deg,P2,A,1,3.0,true\nt,deg,P2,B,1,3.4,true
t,deg,P3,A,1,5.0,true\nt,deg,P3,B,1,5.3,true\n";

fn inputs(folder: &Path) {
    let (_, error, code) =
        run(folder, &["phantom", "--truth", "rod", "--subject", "1", "--noise", "0", "--out", "."]);
    assert_eq!(code, 0, "{error}");
    fs::write(folder.join("stiffness.csv"), run(folder, &["stiffness"]).0).expect("a table");
    fs::write(folder.join("readings.csv"), READINGS).expect("a table");
}

#[test]
fn no_output_names_a_folder_a_home_or_a_user() {
    let (here, folder) = folder();
    inputs(&folder);
    let out = here.path().join(PLACES[3]);
    for line in every_output(&folder, &out) {
        run_there(here.path(), &line);
    }
    let files = files(&out);
    assert!(files.len() > 60, "{} files", files.len());
    let here = here.path().display().to_string();
    for file in files {
        let bytes = fs::read(&file).expect("a file");
        for canary in PLACES.iter().copied().chain([here.as_str()]) {
            assert!(!holds(&bytes, canary), "{canary} in {}", file.display());
        }
    }
}

#[test]
fn the_command_line_can_be_kept_whole() {
    let (here, folder) = folder();
    inputs(&folder);
    let case = folder.join("phantom-rod-01.json").display().to_string();
    let out = here.path().join("analysis.json");
    let line = ["analyze", &case, "--full-paths", "--json", &out.display().to_string()];
    run_there(here.path(), &line.map(str::to_owned));
    let text = fs::read_to_string(&out).expect("an analysis");
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(value["provenance"]["inputs"][0]["name"], case.as_str());
}

#[test]
fn a_cohort_names_a_case_that_it_refuses_without_its_folder() {
    let (here, folder) = folder();
    let folder = folder.join("cases");
    fs::create_dir(&folder).expect("a folder");
    inputs(&folder);
    fs::write(folder.join("broken.json"), "{").expect("a file");
    fs::remove_file(folder.join("phantom-rod-01.truth.json")).expect("a file");
    let out = here.path().join("cohort.html");
    let program = assert_cmd::cargo::cargo_bin("spineline");
    let status = Command::new(program)
        .args(["report".as_ref(), folder.as_os_str(), "--out".as_ref(), out.as_os_str()])
        .status()
        .expect("the program starts");
    assert_eq!(status.code(), Some(3));
    let bytes = fs::read(&out).expect("a report");
    assert!(holds(&bytes, "broken.json") && !holds(&bytes, PLACES[0]));
}

#[test]
fn an_imported_film_keeps_nothing_of_its_patient() {
    let (here, folder) = folder();
    fs::write(folder.join("ZqNameCanary.dcm"), film()).expect("a film");
    let out = here.path().join("p07");
    let store = here.path().join("studies.spineline").display().to_string();
    let text = |path: &Path| path.display().to_string();
    let case = text(&out.join("case.json"));
    let words = |line: &[&str]| line.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let choice =
        ["--film", "erect=1", "--patient-left", "image-left", "--accept", "--case-id", "P07"];
    let ball = ["--ball", "erect=10,10,20,10,25"];
    let (from, to) = (text(&folder), text(&out));
    let import = [&["import", &from, "--out", &to][..], &choice, &ball].concat();
    run_there(here.path(), &words(&import));
    run_there(here.path(), &words(&["study", "create", &store]));
    run_there(here.path(), &words(&["study", "add", &store, &case]));
    let made = files(&out).into_iter().chain([PathBuf::from(store)]);
    for file in made {
        let bytes = fs::read(&file).expect("a file");
        for canary in PATIENT.iter().chain(&PLACES) {
            assert!(!holds(&bytes, canary), "{canary} in {}", file.display());
        }
    }
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).expect("a file").permissions().mode() & 0o777
    }

    #[test]
    fn stores_and_what_lies_beside_them_are_their_owners_alone() {
        let here = tempfile::tempdir().expect("a temporary folder");
        let at = |name: &str| here.path().join(name);
        // Whatever the user lets others do with new files.
        let shell = |line: &str| {
            let program = assert_cmd::cargo::cargo_bin("spineline");
            let status = Command::new("sh")
                .args(["-c", &format!("umask 0; \"$0\" {line}")])
                .arg(program)
                .current_dir(here.path())
                .status();
            assert!(status.expect("a shell").success(), "{line}");
        };
        shell("study create s.spineline");
        shell("study backup s.spineline copy.spineline");
        for name in ["s.spineline", "copy.spineline"] {
            assert_eq!(mode(&at(name)), 0o600, "{name}");
        }
        let store = spineline_store::Store::open(&at("s.spineline")).expect("a store");
        for entry in fs::read_dir(here.path()).expect("a folder") {
            let path = entry.expect("an entry").path();
            assert_eq!(mode(&path), 0o600, "{}", path.display());
        }
        drop(store);
    }

    #[test]
    fn serve_warns_of_an_older_store_that_others_can_read() {
        let here = tempfile::tempdir().expect("a temporary folder");
        assert_eq!(run(here.path(), &["study", "create", "s.spineline"]).2, 0);
        let path = here.path().join("s.spineline");
        assert_eq!(spineline_store::wider_permissions(&path), None);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).expect("permissions");
        // It cannot listen where another program does, and ends after the warning.
        let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = taken.local_addr().expect("an address").port().to_string();
        let (_, error, code) = run(here.path(), &["serve", "s.spineline", "--port", &port]);
        assert_eq!(code, 3, "{error}");
        assert!(error.contains("0644") && error.contains("chmod 600"), "{error}");
    }
}
