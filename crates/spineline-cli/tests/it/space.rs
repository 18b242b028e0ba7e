//! The third dimension from end to end: landmark files of a synthetic patient with a lateral film and pedicles → case → analysis, tables,
//! report and exported models.

use std::fs;
use std::path::Path;

use serde_json::Value;
use spineline::analysis::Case;
use spineline::anatomy::{ImageSide, Level, PediclePlace, Posture};
use spineline::measure::{Corners, FilmLandmarks, ImageGeometry};
use spineline::multibody::{StiffnessLibrary, Support};
use spineline::spatial::{Angle, Pixel};
use spineline_files::{CaseFile, to_text};
use spineline_phantom::{
    BentPhantom, SpaceBending, SpaceSetup, TrueBody, generate_bends_in_space, generate_in_space,
};

use crate::import::{film, put};
use crate::maker::Maker;
use crate::program::{Here, assert_says, folder, split, succeeded, unwrapped};

/// Pixels of the phantom for one of a picture here.
const COARSER: u32 = 10;

/// The phantom with an erect film, both bends, a lateral film and pedicles.
fn phantom() -> BentPhantom {
    let setup = SpaceSetup {
        apical_rotation: Angle::from_deg(15.0),
        pedicles: true,
        ..SpaceSetup::default()
    };
    let bending = SpaceBending { support: Support::Frontal, library: StiffnessLibrary::default() };
    generate_bends_in_space(&setup, &bending).expect("a force bends it so far")
}

/// The same films with fewer pixels, whose pictures are quickly written and read.
fn coarse(mut case: Case) -> Case {
    let places = |place: &mut Pixel| {
        place.column_px /= f64::from(COARSER);
        place.row_px /= f64::from(COARSER);
    };
    let body = |corners: Corners<Pixel>| {
        corners.map(|mut corner| {
            places(&mut corner);
            corner
        })
    };
    let size = |image: &mut ImageGeometry| {
        (image.columns, image.rows) = (image.columns / COARSER, image.rows / COARSER);
        let spacing = image.spacing.as_mut().expect("millimetres");
        spacing.column_mm *= f64::from(COARSER);
        spacing.row_mm *= f64::from(COARSER);
    };
    for film in &mut case.films {
        let FilmLandmarks::Corners { image, iliac_crests, readings } = &mut film.landmarks else {
            panic!("a film with corners");
        };
        size(image);
        for crest in iliac_crests.iter_mut().flat_map(|both| [&mut both.left, &mut both.right]) {
            places(crest);
        }
        for landmark in readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut()) {
            landmark.corners = body(landmark.corners);
            landmark.pedicles.iter_mut().flatten().for_each(places);
        }
    }
    let film = case.lateral.as_mut().expect("a lateral film");
    size(&mut film.image);
    for corners in film.readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut()) {
        *corners = body(*corners);
    }
    case
}

/// A picture of one grey, another one for every film.
fn picture(path: &Path, grey: u8, [columns, rows]: [u32; 2]) {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, columns, rows);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("into memory");
    writer.write_image_data(&vec![grey; (columns * rows) as usize]).expect("all pixels");
    writer.finish().expect("into memory");
    fs::write(path, png).expect("a picture");
}

fn side(side: ImageSide) -> &'static str {
    if side == ImageSide::Left { "image-left" } else { "image-right" }
}

/// Landmark files and pictures of the phantom, and the case that `import` makes of them, in `case`.
fn imported(here: &Here, case: &Case) {
    here.write("phantom.json", to_text(&CaseFile::from_case(case)));
    here.done(&["export", "phantom.json", "--to", "csv", "--out", "frontal.csv"]);
    here.done(&["export", "phantom.json", "--to", "lateral-csv", "--out", "lateral.csv"]);
    let film = case.lateral.as_ref().expect("a lateral film");
    let mut arguments: Vec<String> = vec!["import".into()];
    let (mut chosen, mut patient_left) = (Vec::new(), ImageSide::Left);
    for (i, frontal) in case.films.iter().enumerate() {
        let FilmLandmarks::Corners { image, .. } = &frontal.landmarks else {
            panic!("a film with corners");
        };
        patient_left = image.patient_left;
        let name = format!("{}.png", frontal.posture.key());
        picture(&here.path(&name), 60 + 10 * i as u8, [image.columns, image.rows]);
        chosen.extend([
            "--film".to_owned(),
            format!("{}={name}", frontal.posture.key().replace('_', "-")),
        ]);
        arguments.push(name);
    }
    picture(&here.path("side.png"), 200, [film.image.columns, film.image.rows]);
    let spacing = film.image.spacing.expect("millimetres");
    let spacing = format!("{},{},patient", spacing.column_mm, spacing.row_mm);
    arguments.push("side.png".into());
    arguments.extend(chosen);
    let given = format!(
        "--lateral side.png --patient-anterior {} --patient-left {} --spacing {spacing} \
         --landmarks frontal.csv --lateral-landmarks lateral.csv --simultaneous yes \
         --case-id space-01 --out case --secret secret",
        side(film.image.patient_left),
        side(patient_left),
    );
    let films: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let out = here.done(&[films, split(&given)].concat());
    assert!(!out.contains("No landmarks yet"), "{out}");
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

/// The axial rotation by the pedicles of a body: its tangent is the true one times `share`, the place of the pedicles of the body
/// over their place in the reader's table.
fn read_axial(body: &TrueBody) -> Angle {
    let [beside_mm, behind_mm] = body.pedicle_mm();
    let reader = PediclePlace::of(body.level);
    let share = (behind_mm / beside_mm) / (reader.behind_mm / reader.beside_mm);
    Angle::from_rad((share * body.axial.rad().tan()).atan())
}

/// Compares pitches of the analysis with the projected bodies, and axial rotations with their pedicles.
fn check_angles(analysis: &Value, truth: &BentPhantom) {
    let space = &analysis["space"];
    assert_eq!(space["alignment"]["simultaneous"], true);
    assert!(number(&space["alignment"]["turn_deg"]).abs() < 1e-12, "nothing is estimated");
    for level in Level::ALL {
        let body = truth.erect.body(level).expect("L5 to T1");
        let axis = body.cranial;
        let pitch_deg = Angle::from_sin_cos(axis.x, axis.yz().norm()).deg();
        let found = number(&space["vertebrae"][level.name()]["pitch_3d_deg"]);
        assert!((found - pitch_deg).abs() < 1e-6, "{level}: {found} and {pitch_deg}");
        let found = number(&analysis["axial_rotation"][level.name()]["axial_3d_deg"]);
        let wanted = read_axial(body).deg();
        assert!((found - wanted).abs() < 1e-6, "{level}: {found} and {wanted}");
    }
    let joint = number(&space["template"]["joint_rms_deg"]);
    assert!((0.1..20.0).contains(&joint), "{joint}");
}

#[test]
fn landmark_files_with_a_lateral_film_reach_every_output() {
    let here = folder();
    let truth = phantom();
    imported(&here, &coarse(truth.erect.case.clone()));
    let case = here.json("case/case.json");
    assert_eq!(case["lateral"]["simultaneous"], true);
    let marked = |reading: &Value| reading["vertebrae"].as_object().map_or(0, |all| all.len());
    assert_eq!(marked(&case["lateral"]["readings"][0]), Level::ALL.len());
    let outputs = ["--json", "analysis.json", "--tables", "tables", "--model", "model.json"];
    let analyze = ["analyze", "case/case.json", "--model-line", "iliac"];
    here.wrote(&[&analyze[..], &outputs].concat());
    check_angles(&here.json("analysis.json"), &truth);
    for (table, rows) in [("space_vertebrae", 17), ("axial_rotation", 17)] {
        let text = here.text(format!("tables/{table}.csv"));
        assert_eq!(text.lines().count(), 1 + rows, "{table}");
    }
    here.wrote(&["report", "case/case.json", "--out", "report.html"]);
    let report = here.text("report.html");
    let parts = [
        "Both films were exposed together",
        "Sagittal profile",
        "the profile of a population",
        "Nash",
    ];
    assert_says(&report, &parts);
    for format in ["mjcf", "osim", "urdf", "vtp", "gltf"] {
        let text = here.done(&["export", "model.json", "--to", format]);
        for part in [
            "MEASURED on the lateral film (L4 to T2)",
            "MEASURED from both pedicles on the erect film (L4 to T2)",
        ] {
            assert!(text.contains(part), "{format}: {part}");
        }
    }
}

#[test]
fn a_bad_table_of_the_lateral_film_is_refused_by_line_and_column() {
    let here = folder();
    let case = coarse(generate_in_space(&SpaceSetup::default()).case);
    here.write("phantom.json", to_text(&CaseFile::from_case(&case)));
    let note = here.run(&["export", "phantom.json", "--to", "csv"]).1;
    assert!(note.contains("landmarks of the lateral film"), "{note}");
    let table = here.done(&["export", "phantom.json", "--to", "lateral-csv"]);
    for (i, grey) in [(1, 60), (2, 70)] {
        picture(&here.path(format!("{i}.png")), grey, [500, 700]);
    }
    let import = split(
        "import 1.png 2.png --film erect=1.png --lateral 2.png --patient-left image-left \
         --patient-anterior image-left --lateral-landmarks bad.csv --case-id A --out a \
         --keep-identity",
    );
    let fails = |text: &str, part: &str| {
        here.write("bad.csv", text);
        let error = here.refused(&import, 3);
        assert!(error.contains("bad.csv") && error.contains(part), "{part}: {error}");
    };
    fails(
        &table.replace("superior_anterior_column_px", "superior_front_column_px"),
        "superior_anterior_column_px",
    );
    let first = table.lines().nth(1).expect("a vertebra");
    let cut = first.rsplit_once(',').expect("cells").0;
    fails(&table.replace(first, &format!("{cut},x")), "inferior_posterior_row_px");
    fails(&table.replace(first, &format!("{cut},9000")), "lateral film");
    assert!(!here.path("a/case.json").exists(), "nothing was written");
    assert!(case.films.iter().all(|film| film.posture == Posture::Erect));
}

#[test]
fn films_of_one_exposure_are_recognised_by_their_files_or_by_the_option() {
    let here = folder();
    let side = |number: u16, attributes: &[((u16, u16), &'static str, &str)]| {
        let mut maker = film(number);
        if number > 1 {
            maker.text((0x20, 0x20), "CS", "A\\F");
        }
        for (tag, vr, value) in attributes {
            maker.text(*tag, vr, value);
        }
        maker
    };
    let at = |time| [((0x08, 0x22), "DA", "20250301"), ((0x08, 0x32), "TM", time)];
    let in_frame = [((0x20, 0x52), "UI", "1.2.3.77")];
    let imports = |folder: &str, both: [&Maker; 2], more: &[&str]| {
        put(&here, "a.dcm", both[0]);
        put(&here, "b.dcm", both[1]);
        let chosen = ["--film", "erect=a.dcm", "--lateral", "b.dcm", "--case-id", "A"];
        here.import(&[&["a.dcm", "b.dcm", "--out", folder][..], &chosen, more].concat())
    };
    let silent = [side(1, &[]), side(2, &[])];
    let framed = [side(1, &in_frame), side(2, &in_frame)];
    let at_once = [side(1, &at("101500")), side(2, &at("101501.2"))];
    let apart = [side(1, &at("101500")), side(2, &at("101635"))];
    let midnight = [side(1, &at("000000")), side(2, &at("000000"))];
    let none: &[&str] = &[];
    let together = ["--simultaneous", "yes", "--accept"];
    for (folder, films, more, simultaneous, note) in [
        ("1", &silent, none, None, "taken as not exposed together"),
        ("2", &framed, none, Some(true), "one Frame of Reference UID"),
        ("3", &at_once, none, Some(true), "Acquisition Times 1 s apart"),
        ("4", &apart, none, None, "Wrote"),
        ("5", &midnight, none, None, "taken as not exposed together"),
        ("6", &silent, &together[..2], Some(true), "Wrote"),
        ("7", &apart, &together[..], Some(true), "95 s apart"),
    ] {
        let out = succeeded(imports(folder, [&films[0], &films[1]], more));
        assert!(unwrapped(&out).contains(note), "{folder}: {out}");
        let found = here.json(format!("{folder}/case.json"))["lateral"]["simultaneous"].as_bool();
        assert_eq!(found, simultaneous, "{folder}");
    }
    let (_, error, code) = imports("8", [&framed[0], &framed[1]], &["--simultaneous", "no"]);
    assert_eq!(code, 2, "{error}");
    assert!(error.contains("Frame of Reference") && error.contains("--accept"), "{error}");
}
