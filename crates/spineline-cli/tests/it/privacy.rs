//! Nothing private leaves by accident: canaries in paths and in films reach no output.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fmt::Debug;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use parquet::file::reader::{FileReader, SerializedFileReader};

use crate::maker::{DEFLATED, EXPLICIT, Maker, ramp};
use crate::outputs::READINGS;
use crate::program::{self, Here, finish, json, spineline, succeeded};
use crate::unpacked::{first_held, holds, wrapped};

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
    patients_film(60, 40).file(EXPLICIT)
}

/// A film with the patient in its attributes.
fn patients_film(columns: u16, rows: u16) -> Maker {
    let mut maker = Maker::new(columns, rows, &ramp(columns, rows));
    maker.text((0x10, 0x10), "PN", PATIENT[0]).text((0x10, 0x20), "LO", PATIENT[1]);
    maker.text((0x10, 0x30), "DA", PATIENT[2]).text((0x8, 0x80), "LO", PATIENT[3]);
    maker.text((0x8, 0x90), "PN", PATIENT[4]).text((0x8, 0x50), "SH", PATIENT[5]);
    maker.text((0x8, 0x1070), "PN", PATIENT[6]).text((0x10, 0x4000), "LT", PATIENT[7]);
    maker
}

/// A folder whose path holds a canary, and its path.
fn folder() -> (Here, PathBuf) {
    let here = program::folder();
    let folder = here.path(PLACES[0]);
    fs::create_dir(&folder).expect("a folder");
    (here, folder)
}

/// Runs the program from another folder, so that every path is absolute.
fn run_there(here: &Here, arguments: &[impl AsRef<OsStr> + Debug]) {
    let home = here.path(PLACES[1]);
    let mut command = spineline(here.folder());
    command.env("HOME", &home).env("USER", PLACES[2]).env("LOGNAME", PLACES[2]);
    command.env("XDG_CONFIG_HOME", home.join(".config"));
    let output = command.args(arguments).output().expect("the program starts");
    let code = output.status.code().expect("an exit code");
    assert!(code == 0 || code == 4, "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
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

/// All cells of a Parquet file as text: its pages are compressed by Snappy.
fn cells(path: &Path) -> String {
    let file = fs::File::open(path).expect("a file");
    let file = SerializedFileReader::new(file).expect("Parquet");
    let rows = file.get_row_iter(None).expect("rows");
    rows.map(|row| row.expect("a row").to_string() + "\n").collect()
}

/// Panics where a file, or anything packed in it, holds one of these texts.
fn assert_without(path: &Path, canaries: &[&str]) {
    let mut bytes = fs::read(path).expect("a file");
    if path.extension().is_some_and(|end| end == "parquet") {
        bytes.extend(cells(path).into_bytes());
    }
    let held = first_held(&bytes, canaries);
    assert!(held.is_none(), "{held:?} in {}", path.display());
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
            "--figures",
            &to("rel"),
        ]),
        line(&["export", &case, "--to", "csv", "--out", &to("l.csv")]),
        line(&["export", &case, "--to", "slicer", "--out", &to("slicer")]),
        line(&["phantom", "--scenario", "rod", "--subject", "1", "--out", &to("phantom")]),
        line(&["noise-study", "--phantoms", "2", "--out", &to("study")]),
        line(
            &[&push[..], &["--json", &to("s.json"), "--csv", &to("s.csv"), "--svg", &to("s.svg")]]
                .concat(),
        ),
    ];
    for format in ["mjcf", "osim", "sto", "loads", "urdf"] {
        lines.push(line(&["export", &model, "--to", format, "--out", &to(format)]));
    }
    if cfg!(feature = "pdf") {
        lines.push(line(&["report", &case, "--to", "pdf", "--out", &to("r.pdf")]));
    }
    lines
}

fn inputs(folder: &Path) {
    let done = |arguments: &[&str]| succeeded(finish(spineline(folder).args(arguments)));
    done(&["phantom", "--scenario", "rod", "--subject", "1", "--noise", "0", "--out", "."]);
    fs::write(folder.join("stiffness.csv"), done(&["stiffness"])).expect("a table");
    fs::write(folder.join("readings.csv"), READINGS).expect("a table");
}

#[test]
fn no_output_names_a_folder_a_home_or_a_user() {
    let (here, folder) = folder();
    inputs(&folder);
    let out = here.path(PLACES[3]);
    for line in every_output(&folder, &out) {
        run_there(&here, &line);
    }
    let files = files(&out);
    assert!(files.len() > 60, "{} files", files.len());
    let kinds: BTreeSet<_> = files.iter().filter_map(|file| file.extension()).collect();
    for kind in ["json", "csv", "parquet", "svg", "html", "md"] {
        assert!(kinds.contains(OsStr::new(kind)), "no {kind} among {kinds:?}");
    }
    let here = here.folder().display().to_string();
    for file in files {
        assert_without(&file, &[&PLACES[..], &[here.as_str()]].concat());
    }
}

#[test]
fn canaries_are_found_in_what_is_packed() {
    for (kind, bytes) in wrapped(PATIENT[0]) {
        assert!(holds(&bytes, PATIENT[0]), "{kind}");
    }
    let mut maker = Maker::new(60, 40, &ramp(60, 40));
    maker.text((0x10, 0x10), "PN", PATIENT[0]);
    assert!(holds(&maker.file(DEFLATED), PATIENT[0]), "deflated DICOM");
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 1, 1);
    let text = format!("{} {}", PATIENT[0], PATIENT[0]);
    encoder.add_ztxt_chunk("Comment".to_owned(), text).expect("Latin 1");
    let mut writer = encoder.write_header().expect("into memory");
    writer.write_image_data(&[0]).expect("one pixel");
    writer.finish().expect("into memory");
    assert!(holds(&png, PATIENT[0]), "a text of PNG");
}

#[test]
fn the_search_looks_into_real_outputs() {
    // The identifier of the case stands in all of them, and in some of them only compressed.
    let (here, folder) = folder();
    inputs(&folder);
    let case = folder.join("phantom-rod-01.json").display().to_string();
    let out = here.path("out");
    let to = |name: &str| out.join(name).display().to_string();
    run_there(&here, &["analyze", &case, "--tables", &to("t")]);
    let table = out.join("t").join("vertebrae.parquet");
    assert!(cells(&table).contains("phantom-rod-01"), "{}", cells(&table));
    if cfg!(feature = "pdf") {
        let line = ["report", &case, "--to", "pdf", "--out", &to("r.pdf")];
        run_there(&here, &line);
        let bytes = fs::read(out.join("r.pdf")).expect("a report");
        // A key of the attached analysis.
        assert!(holds(&bytes, "sagittal_profile"));
    }
}

#[test]
fn the_command_line_can_be_kept_whole() {
    let (here, folder) = folder();
    inputs(&folder);
    let case = folder.join("phantom-rod-01.json").display().to_string();
    let out = here.path("analysis.json");
    let line = ["analyze", &case, "--full-paths", "--json", &out.display().to_string()];
    run_there(&here, &line);
    let value = here.json("analysis.json");
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
    let out = here.path("cohort.html");
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
    let out = here.path("p07");
    let store = here.path("studies.spineline").display().to_string();
    let text = |path: &Path| path.display().to_string();
    let case = text(&out.join("case.json"));
    let choice =
        ["--film", "erect=1", "--patient-left", "image-left", "--accept", "--case-id", "P07"];
    let ball = ["--ball", "erect=10,10,20,10,25"];
    let (from, to) = (text(&folder), text(&out));
    let import = [&["import", &from, "--out", &to][..], &choice, &ball].concat();
    run_there(&here, &import);
    run_there(&here, &["study", "create", &store]);
    run_there(&here, &["study", "add", &store, &case]);
    let made = files(&out).into_iter().chain([PathBuf::from(store)]);
    for file in made {
        assert_without(&file, &[&PATIENT[..], &PLACES].concat());
    }
}

/// Landmarks of two vertebrae on a film of 60 × 400 pixels.
const LANDMARKS: &str =
    "posture,observer,repeat,vertebra,superior_left_column_px,superior_left_row_px,\
superior_right_column_px,superior_right_row_px,inferior_left_column_px,inferior_left_row_px,\
inferior_right_column_px,inferior_right_row_px
erect,A,1,T9,15,100,45,100,15,120,45,120\nerect,A,1,T8,15,70,45,70,15,90,45,90\n";

#[test]
fn landmarks_of_a_de_identified_film_leave_without_its_patient() {
    let (here, folder) = folder();
    let mut film = patients_film(60, 400);
    film.text((0x28, 0x30), "DS", "1\\1");
    fs::write(folder.join("film.dcm"), film.file(DEFLATED)).expect("a film");
    fs::write(folder.join("marks.csv"), LANDMARKS).expect("landmarks");
    let text = |path: PathBuf| path.display().to_string();
    let (from, marks) = (text(folder.join("film.dcm")), text(folder.join("marks.csv")));
    let root = here.folder().display().to_string();
    let places = [&PLACES[..], &[root.as_str()]].concat();
    let choice = ["--film", "erect=1", "--patient-left", "image-left", "--accept"];
    for (name, keep, patient) in [("p07", None, false), ("kept", Some("--keep-identity"), true)] {
        let out = here.path(PLACES[3]).join(name);
        let to = text(out.clone());
        let import = ["import", &from, "--landmarks", &marks, "--case-id", "P07", "--out", &to];
        let import = [&import[..], &choice, keep.as_slice()].concat();
        run_there(&here, &import);
        let case = text(out.join("case.json"));
        let exports = out.join("exports");
        for (format, file) in [("dicom-sr", "r.dcm"), ("slicer", "s.mrk.json"), ("csv", "l.csv")] {
            let to = text(exports.join(file));
            run_there(&here, &["export", &case, "--to", format, "--out", &to]);
        }
        let preview = text(exports.join("film.png"));
        let film = text(out.join("erect.dcm"));
        run_there(&here, &["film", &film, "--png", &preview, "--json"]);
        let made = files(&exports);
        assert!(made.len() >= 4, "{made:?}");
        for file in made {
            assert_without(&file, &places);
            // Reports carry the patient of their film, as the help of `export` says; nothing else does.
            let is_report = file.extension().is_some_and(|end| end == "dcm");
            if !(patient && is_report) {
                assert_without(&file, &PATIENT);
            }
        }
    }
}

#[test]
fn results_with_a_patients_film_do_not_name_the_patient() {
    let (here, folder) = folder();
    inputs(&folder);
    let path = folder.join("phantom-rod-01.json");
    let mut case = json(&fs::read_to_string(&path).expect("a case"));
    let image = &mut case["films"][0]["image"];
    image["file"] = "film.dcm".into();
    let side = |key: &str| {
        let side = image[key].as_u64().expect("a number");
        u16::try_from(side).expect("a film")
    };
    let film = patients_film(side("columns"), side("rows"));
    fs::write(folder.join("film.dcm"), film.file(EXPLICIT)).expect("a film");
    fs::write(&path, case.to_string()).expect("a case");
    let case = path.display().to_string();
    let out = here.path(PLACES[3]);
    let to = |name: &str| out.join(name).display().to_string();
    run_there(&here, &["report", &case, "--out", &to("r.html")]);
    let outputs = ["--json", &to("a.json"), "--tables", &to("t"), "--figures", &to("f")];
    run_there(&here, &[&["analyze", &case][..], &outputs].concat());
    if cfg!(feature = "pdf") {
        run_there(&here, &["report", &case, "--to", "pdf", "--out", &to("r.pdf")]);
    }
    let report = fs::read(out.join("r.html")).expect("a report");
    assert!(holds(&report, "base64,") && holds(&report, "IHDR"), "the film is in the report");
    for file in files(&out) {
        assert_without(&file, &[&PATIENT[..], &PLACES].concat());
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
        let here = program::folder();
        let at = |name: &str| here.path(name);
        // Whatever the user lets others do with new files.
        let shell = |line: &str| {
            let program = assert_cmd::cargo::cargo_bin("spineline");
            let status = Command::new("sh")
                .args(["-c", &format!("umask 0; \"$0\" {line}")])
                .arg(program)
                .current_dir(here.folder())
                .status();
            assert!(status.expect("a shell").success(), "{line}");
        };
        shell("study create s.spineline");
        shell("study backup s.spineline copy.spineline");
        for name in ["s.spineline", "copy.spineline"] {
            assert_eq!(mode(&at(name)), 0o600, "{name}");
        }
        let store = spineline_store::Store::open(&at("s.spineline")).expect("a store");
        for entry in fs::read_dir(here.folder()).expect("a folder") {
            let path = entry.expect("an entry").path();
            assert_eq!(mode(&path), 0o600, "{}", path.display());
        }
        drop(store);
    }

    #[test]
    fn serve_warns_of_an_older_store_that_others_can_read() {
        let here = program::folder();
        here.done(&["study", "create", "s.spineline"]);
        let path = here.path("s.spineline");
        assert_eq!(spineline_store::wider_permissions(&path), None);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).expect("permissions");
        // It cannot listen where another program does, and ends after the warning.
        let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = taken.local_addr().expect("an address").port().to_string();
        let login = here.path("clinic.login");
        fs::write(&login, "films:secret\n").expect("a file");
        fs::set_permissions(&login, fs::Permissions::from_mode(0o640)).expect("permissions");
        let archive = ["--dicomweb", "clinic=http://192.0.2.1/dicom-web"];
        let serve = ["serve", "s.spineline", "--port", &port];
        let login = ["--dicomweb-login", "clinic=clinic.login"];
        let error = here.refused(&[&serve[..], &archive, &login].concat(), 3);
        assert!(error.contains("0644") && error.contains("chmod 600 s.spineline"), "{error}");
        assert!(error.contains("0640") && error.contains("chmod 600 clinic.login"), "{error}");
        assert!(error.contains("not encrypted") && !error.contains("secret"), "{error}");
    }
}
