//! `spineline import`: from films to a case, without guesses, losses or names.

use std::fs;
use std::path::Path;

use serde_json::Value as Json;
use spineline_films::{FilmLimits, read_film};

use crate::maker::{EXPLICIT, Maker, Value, ramp, text};
use crate::program::{Here, folder, split, unwrapped};

/// A name that must never be seen again.
const CANARY: &str = "Kanarienvogel";

/// A film of a patient with a name, frontal, its columns running to the patient's left.
pub fn film(number: u16) -> Maker {
    let mut maker = Maker::new(60, 40 + number, &ramp(60, 40 + number));
    maker.text((0x10, 0x10), "PN", CANARY).text((0x10, 0x20), "LO", CANARY);
    maker.text((0x08, 0x103E), "LO", CANARY).text((0x20, 0x20), "CS", "L\\F");
    maker.text((0x28, 0x30), "DS", "0.2\\0.1").text((0x28, 0xA02), "CS", "FIDUCIAL");
    maker.text((0x08, 0x18), "UI", &format!("1.2.3.{number}"));
    maker
}

pub fn put(here: &Here, name: &str, maker: &Maker) {
    here.write(name, maker.file(EXPLICIT));
}

/// The arguments that make case A of the erect film `a.dcm`, in the folder `a`.
pub const ERECT: [&str; 7] = ["a.dcm", "--case-id", "A", "--out", "a", "--film", "erect=1"];

/// The arguments that make case A of one film in the folder `a`.
fn one_film<'a>(file: &'a str, film: &'a str) -> [&'a str; 9] {
    [file, "--case-id", "A", "--out", "a", "--film", film, "--patient-left", "image-left"]
}

/// All bytes below a folder.
fn everything(folder: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    for entry in walkdir::WalkDir::new(folder).sort_by_file_name() {
        let entry = entry.expect("readable");
        bytes.extend(entry.file_name().as_encoded_bytes());
        if entry.file_type().is_file() {
            bytes.extend(fs::read(entry.path()).expect("readable"));
        }
    }
    bytes
}

fn holds(bytes: &[u8], word: &str) -> bool {
    bytes.windows(word.len()).any(|window| window.eq_ignore_ascii_case(word.as_bytes()))
}

#[test]
fn an_option_that_this_kind_of_import_does_not_use_is_refused() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    let kinds = [
        ("a.dcm --case-id A --film erect=1", "--sizes s.csv"),
        ("a.dcm --case-id A --film erect=1", "--pictures ."),
        ("a.dcm --case-id A --film erect=1", "--patient-anterior image-left"),
        ("x --midlines --case-id A", "--invert erect"),
        ("x --midlines --case-id A", "--reading x=B"),
        ("x --midlines --case-id A", "--keep-identity"),
        ("x --midlines --case-id A", "--simultaneous yes"),
        ("x --aasce --patient-left image-left", "--lateral-landmarks l.csv"),
        ("x --aasce --patient-left image-left", "--patient-anterior image-left"),
    ];
    for (kind, option) in kinds {
        let line = format!("{kind} --out a {option}");
        let error = here.import_refused(&split(&line), 2);
        assert!(error.contains(split(option)[0]), "{line}: {error}");
        assert!(!here.path("a").exists(), "{line}");
    }
}

#[test]
fn films_become_a_deidentified_case() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    put(&here, "b.dcm", &film(2));
    let (out, error, code) = here.import(&split(
        ". --case-id P07 --out p07 --film erect=1 --film left-bending=2 --invert left-bending",
    ));
    assert_eq!(code, 0, "{error}");
    assert!(out.contains("Wrote p07/case.json and 2 films."), "{out}");
    let case = here.json("p07/case.json");
    let image = &case["films"][0]["image"];
    assert_eq!(case["films"][0]["posture"], "erect");
    // DICOM writes the distance of rows first.
    assert_eq!((&image["row_spacing_mm"], &image["column_spacing_mm"]), (&0.2.into(), &0.1.into()));
    assert_eq!(image["spacing_plane"], "patient");
    assert_eq!(image["spacing_source"], "fiducial");
    assert_eq!(image["patient_left"], "image_right");
    assert_eq!(image.get("inverted"), None);
    assert_eq!(case["films"][1]["image"]["inverted"], true);
    let written = fs::read(here.path("p07/erect.dcm")).expect("the film");
    assert_eq!(image["sha256"], spineline_files::sha256_hex(&written));
    let limits = FilmLimits::default();
    let (new, old) = (read_film(&written, &limits), read_film(&film(1).file(EXPLICIT), &limits));
    assert_eq!(new.expect("a film").stored, old.expect("a film").stored);
    assert!(!holds(&everything(&here.path("p07")), CANARY));
    assert!(!holds(out.as_bytes(), CANARY) && !holds(error.as_bytes(), CANARY));
    spineline_files::parse_case(&here.text("p07/case.json")).expect("a case file");
}

#[test]
fn a_film_is_found_however_its_path_is_written() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    let whole = here.path("a.dcm").display().to_string();
    for (place, name) in [(".", "a.dcm"), ("./", whole.as_str()), ("a.dcm", "./a.dcm")] {
        let choice = format!("erect={name}");
        let out = format!("out-{}", choice.len());
        here.imported(&[place, "--case-id", "A", "--out", &out, "--film", &choice]);
        assert_eq!(here.json(format!("{out}/case.json"))["films"][0]["posture"], "erect");
    }
}

#[test]
fn films_of_phantoms_make_a_synthetic_case_and_one_of_a_patient_does_not() {
    let here = folder();
    let mut phantom = film(1);
    phantom.text((0x28, 0x300), "CS", "YES");
    put(&here, "a.dcm", &phantom);
    put(&here, "b.dcm", &film(2));
    let arguments = ["a.dcm", "b.dcm", "--case-id", "A", "--film", "erect=1", "--out"];
    let out = here.imported(&[&arguments[..], &["a"]].concat());
    assert_eq!(here.json("a/case.json")["synthetic"], true);
    assert!(out.contains("SYNTHETIC"), "{out}");
    let both = [&arguments[..], &["b", "--film", "left-bending=2"]].concat();
    assert_eq!(here.import(&both).2, 0);
    assert_eq!(here.json("b/case.json")["synthetic"], false);
    // De-identification keeps the mark.
    let again = ["a", "--case-id", "A", "--film", "erect=1", "--out", "c"];
    assert_eq!(here.import(&again).2, 0);
    assert_eq!(here.json("c/case.json")["synthetic"], true);
}

#[test]
fn landmarks_of_another_program_lie_on_their_films() {
    let here = folder();
    here.done(&split("phantom --subject 1 --out p --noise 0 --pixel-size 2"));
    let case = here.json("p/phantom-rod-01.json");
    let image = &case["films"][0]["image"];
    let side = |key: &str| image[key].as_u64().expect("a number") as u16;
    let (columns, rows) = (side("columns"), side("rows"));
    // As large as the phantom's film, and as empty as a film can be.
    let pixels = vec![7; usize::from(columns) * usize::from(rows)];
    let mut blank = Maker::new(columns, rows, &pixels);
    let left = if image["patient_left"] == "image_left" { "R\\F" } else { "L\\F" };
    blank.text((0x20, 0x20), "CS", left).text((0x28, 0x30), "DS", "0.1\\0.1");
    put(&here, "erect.dcm", &blank);
    for (to, file) in [
        ("csv", "marks.csv"),
        ("slicer", "marks.mrk.json"),
        ("labelme", "marks.labelme.json"),
        ("coco", "marks.coco.json"),
    ] {
        let export =
            ["export", "p/phantom-rod-01.json", "--to", to, "--posture", "erect", "--out", file];
        here.done(&export);
        here.imported(&split(&format!(
            "erect.dcm --case-id A --out {to} --film erect=1 --landmarks {file}"
        )));
        let found = here.json(format!("{to}/case.json"));
        let landmarks = |case: &Json| {
            case["films"][0]["readings"][0]["vertebrae"]["T12"]["superior_left"].clone()
        };
        let (found, truth) = (landmarks(&found), landmarks(&case));
        for i in 0..2 {
            let apart = found[i].as_f64().expect("a number") - truth[i].as_f64().expect("a number");
            assert!(apart.abs() < 1e-9, "{to}: {found} against {truth}");
        }
    }
}

#[test]
fn equal_secrets_map_equal_identifiers_to_equal_new_ones() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    let uid = |folder: &str, secret: &str| {
        here.imported(&split(&format!(
            "a.dcm --case-id A --out {folder} --film erect=1 --secret {secret}"
        )));
        let bytes = fs::read(here.path(folder).join("erect.dcm")).expect("the film");
        read_film(&bytes, &FilmLimits::default()).expect("a film").tags.uids.sop_instance
    };
    let (one, two, other) = (uid("1", "secret"), uid("2", "secret"), uid("3", "other"));
    assert_eq!(one, two);
    assert_ne!(one, other);
    assert_ne!(one.as_deref(), Some("1.2.3.1"));
    assert_eq!(fs::read(here.path("secret")).expect("made").len(), 32);
}

#[test]
fn a_relative_folder_of_configuration_is_ignored_so_the_secret_is_not_in_the_working_folder() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    let mut command = here.process();
    command.env("XDG_CONFIG_HOME", "relative").env("HOME", here.path("home")).env_remove("APPDATA");
    let output = command.arg("import").args(ERECT).output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!here.path("relative").exists());
    assert!(here.path("home/.config/spineline/identifiers.secret").exists());
}

#[test]
fn missing_values_are_asked_for_by_film_with_the_option_to_give_them() {
    let here = folder();
    let mut silent = film(1);
    silent.remove((0x20, 0x20));
    put(&here, "a.dcm", &silent);
    let error = here.import_refused(&ERECT, 2);
    assert!(error.contains("erect film") && error.contains("the patient's left"), "{error}");
    assert!(error.contains("--patient-left erect=image-left"), "{error}");
    assert!(!here.path("a").exists(), "nothing was written");
    here.imported(&[&ERECT[..], &["--patient-left", "erect=image-left"]].concat());
    assert_eq!(here.json("a/case.json")["films"][0]["image"]["patient_left"], "image_left");
}

#[test]
fn an_answer_that_contradicts_the_file_needs_confirmation() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    let arguments = one_film("a.dcm", "erect=1");
    let error = here.import_refused(&arguments, 2);
    assert!(error.contains("Patient Orientation") && error.contains("--accept"), "{error}");
    let out = here.imported(&[&arguments[..], &["--accept"]].concat());
    assert!(out.contains("accepted by --accept"), "{out}");
    assert_eq!(here.json("a/case.json")["films"][0]["image"]["patient_left"], "image_left");
}

#[test]
fn lateral_views_are_recognised_and_offered_for_the_profile() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    let mut lateral = film(2);
    lateral.text((0x20, 0x20), "CS", "A\\F");
    put(&here, "b.dcm", &lateral);
    let (out, _, _) = here.import(&[".", "--list"]);
    assert!(out.contains("lateral"), "{out}");
    assert!(out.lines().all(|line| line.chars().count() <= 100), "{out}");
    // Not as a frontal film, unless someone insists.
    let error = here.import_refused(&one_film(".", "erect=2"), 2);
    assert!(error.contains("lateral view"), "{error}");
    here.imported(&[".", "--case-id", "A", "--out", "a", "--film", "erect=1", "--lateral", "2"]);
    let case = here.json("a/case.json");
    assert_eq!(case["lateral"]["image"]["patient_anterior"], "image_right");
    assert_eq!(case["lateral"]["image"]["file"], "lateral.dcm");
}

#[test]
fn a_recumbent_film_given_as_erect_needs_confirmation() {
    let here = folder();
    let mut lying = film(1);
    let code = [((0x08, 0x100), ("SH", text("102538003"))), ((0x08, 0x102), ("SH", text("SCT")))];
    lying.set((0x54, 0x410), "SQ", Value::Items(vec![code.into()]));
    put(&here, "a.dcm", &lying);
    let error = here.import_refused(&ERECT, 2);
    assert!(error.contains("recumbent") && error.contains("erect"), "{error}");
}

#[test]
fn one_picture_cannot_show_two_postures_and_one_identifier_two_pictures() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    let mut copy = film(1);
    copy.text((0x08, 0x18), "UI", "1.2.3.99");
    put(&here, "b.dcm", &copy);
    let arguments = split("a.dcm b.dcm --case-id A --out a --film erect=1 --film left-bending=2");
    let error = here.import_refused(&arguments, 3);
    assert!(error.contains("the same picture"), "{error}");
    let mut changed = film(2);
    changed.text((0x08, 0x18), "UI", "1.2.3.1");
    put(&here, "b.dcm", &changed);
    let out = here.imported(&arguments);
    assert!(out.contains("the same SOP Instance UID"), "{out}");
}

#[test]
fn a_ball_gives_the_scale_with_its_error_and_overrides_the_file() {
    let here = folder();
    let mut bare = film(1);
    bare.remove((0x28, 0x30)).remove((0x28, 0xA02));
    put(&here, "a.dcm", &bare);
    let out = here.imported(&[&ERECT[..], &["--ball", "erect=10,20,50,20,25+-0.1"]].concat());
    assert!(out.contains("a ball in the picture"), "{out}");
    let image = &here.json("a/case.json")["films"][0]["image"];
    // 25 mm over 40 pixels; each click scatters by half a pixel, the diameter by 0.4 %.
    assert_eq!(image["column_spacing_mm"], 0.625);
    let sd = image["spacing_relative_sd"].as_f64().expect("a number");
    let by_hand = (0.5 / 40f64.powi(2) + (0.1f64 / 25.0).powi(2)).sqrt();
    assert!((sd - by_hand).abs() < 1e-12, "{sd}");
    for (ball, words) in [
        ("erect=10,20,11,20,25", "1.0 pixels apart"),
        ("erect=70,110,75,110,25", "the point 70.0, 110.0 lies outside of the 60 × 41 picture"),
    ] {
        let asked = ["a.dcm", "--case-id", "A", "--out", "b", "--film", "erect=1", "--ball", ball];
        let error = here.import_refused(&asked, 2);
        assert!(unwrapped(&error).contains(words), "{error}");
    }
}

#[test]
fn a_film_without_spacing_is_in_pixels() {
    let here = folder();
    let mut bare = film(1);
    bare.remove((0x28, 0x30));
    put(&here, "a.dcm", &bare);
    let out = here.imported(&ERECT);
    assert!(out.contains("pixels (taken as square)"), "{out}");
    let image = &here.json("a/case.json")["films"][0]["image"];
    assert_eq!(image["spacing_plane"], "pixels");
    assert_eq!(image.get("column_spacing_mm"), None);
}

#[test]
fn a_case_is_never_overwritten() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    assert_eq!(here.import(&ERECT).2, 0);
    let before = everything(&here.path("a"));
    let error = here.import_refused(&ERECT, 3);
    assert!(error.contains("overwrites nothing"), "{error}");
    assert_eq!(before, everything(&here.path("a")));
    // Nor are the patient's own films, where they have the names that a case would give them.
    fs::create_dir(here.path("own")).expect("a folder");
    put(&here, "own/left_bending.dcm", &film(3));
    let into = ["own", "--case-id", "A", "--out", "own", "--film", "erect=1"];
    let error = here.import_refused(&into, 3);
    assert!(error.contains("own/left_bending.dcm"), "{error}");
    assert_eq!(fs::read(here.path("own/left_bending.dcm")).expect("there"), film(3).file(EXPLICIT));
}

#[test]
fn repeated_answers_and_answers_about_unknown_films_are_refused() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    let refused = |more: &[&str]| here.import_refused(&[&ERECT[..], more].concat(), 2);
    let twice = ["--patient-left", "image-right", "--patient-left", "image-left"];
    assert!(refused(&twice).contains("--patient-left is given twice"));
    let both = ["--ball", "erect=1,1,40,1,25", "--ruler", "erect=1,1,40,1,100"];
    assert!(refused(&both).contains("the erect film"));
    assert!(refused(&["--invert", "traction"]).contains("--film traction="));
}

#[test]
fn without_a_choice_films_are_listed_and_no_file_is_written() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    here.write("notes.txt", "<notes>");
    let error = here.import_refused(&[".", "--case-id", "A", "--out", "a"], 2);
    assert!(error.contains("--film erect=1") && error.contains("notes.txt"), "{error}");
    let error = here.import_refused(&[".", "--case-id", "A", "--out", "a", "--film", "erect=7"], 2);
    assert!(error.contains("film 7 is not among the films that were found (1)"), "{error}");
    assert!(!here.path("a").exists());
}

#[test]
fn pictures_are_stored_without_metadata() {
    let here = folder();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 30, 20);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.add_text_chunk("Patient".to_owned(), CANARY.to_owned()).expect("a text");
    let pixels: Vec<u8> = (0..600u32).map(|i| (i * 7 % 251) as u8).collect();
    encoder.write_header().expect("a header").write_image_data(&pixels).expect("pixels");
    assert!(holds(&png, CANARY));
    here.write("a.png", &png);
    here.imported(&one_film("a.png", "erect=1"));
    let written = fs::read(here.path("a/erect.png")).expect("the film");
    assert!(!holds(&written, CANARY));
    let film = read_film(&written, &FilmLimits::default()).expect("a film");
    assert!(film.stored.iter().eq(pixels.iter().map(|&p| i32::from(p))));
}

#[test]
fn a_breast_a_leg_or_another_patient_needs_confirmation() {
    let here = folder();
    let altered = [
        ("breast", (0x18, 0x15), "CS", "BREAST", "(BREAST)"),
        ("leg", (0x18, 0x15), "CS", "LEG", "(LEG)"),
        ("mammogram", (0x08, 0x60), "CS", "MG", "(BREAST)"),
        ("patient", (0x10, 0x20), "LO", "SOMEONE-ELSE-7", "Patient ID differs"),
        ("sex", (0x10, 0x40), "CS", "M", "Patient's Sex differs"),
    ];
    let mut first = film(1);
    first.text((0x10, 0x20), "LO", "SOMEONE-1").text((0x10, 0x40), "CS", "F");
    first.text((0x18, 0x15), "CS", "SPINE");
    put(&here, "a.dcm", &first);
    for (name, tag, vr, value, expected) in altered {
        let mut other = film(2);
        other.text((0x10, 0x20), "LO", "SOMEONE-1").text((0x10, 0x40), "CS", "F");
        other.text(tag, vr, value);
        let file = format!("{name}.dcm");
        put(&here, &file, &other);
        let import = |more: &[&str]| {
            let films = ["--film", "erect=1", "--film", "left_bending=2"];
            let base = ["a.dcm", file.as_str(), "--case-id", "A", "--out", name];
            here.import(&[&base[..], &films[..], more].concat())
        };
        let (_, error, code) = import(&[]);
        assert_eq!(code, 2, "{name}: {error}");
        assert!(error.contains(expected) && error.contains("--accept"), "{name}: {error}");
        // The patient's own identity appears in no message.
        assert!(!error.contains("SOMEONE"), "{error}");
        let (out, error, code) = import(&["--accept"]);
        assert_eq!(code, 0, "{name}: {error}");
        assert!(unwrapped(&out).contains("accepted by --accept"), "{out}");
        assert!(!holds(&everything(&here.path(name)), "SOMEONE"), "{name}");
    }
}
