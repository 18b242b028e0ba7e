//! Rules for the values of a case: angles, lengths, codes, and the pictures of its films.

use spineline_files::{CaseFile, FileError, parse_case, to_text};
use spineline_phantom::{Readers, Scenario, generate};

fn text(readers: &Readers) -> String {
    let phantom = generate(2, Scenario::Rod, readers, 5).expect("subject 3 exists");
    to_text(&CaseFile::from_case(&phantom.case))
}

fn json() -> serde_json::Value {
    serde_json::from_str(&text(&Readers::default())).expect("JSON")
}

#[test]
fn angles_are_within_half_a_turn_and_locations_have_millimetres() {
    let marked = |deg: &str| {
        let vertebra = format!("\"T7\": {{ \"axis_deg\": {deg}, \"superior_left\"");
        let plain = text(&Readers::exact());
        let start = plain.find("\"T7\"").expect("T7");
        let end = start + plain[start..].find("\"superior_left\"").expect("its corner");
        let end = end + "\"superior_left\"".len();
        parse_case(&[&plain[..start], &vertebra, &plain[end..]].concat())
    };
    assert!(marked("-180").is_ok());
    let error = marked("362.2").expect_err("more than a turn").to_string();
    assert!(error.contains("erect film, observer") && error.contains("T7: `axis_deg` is 362.2"));
    let placed = |lengths: &str, tilt_deg: &str| {
        parse_case(&format!(
            r#"{{"format": "spineline-case", "version": 1, "case_id": "A", "films": [{{"posture": "erect", {lengths}"readings":
            [{{"observer": "A", "repeat": 1, "vertebrae": {{"T7": {{"location_mm": [0, 1], "tilt_deg": {tilt_deg}}}}}}}]}}]}}"#
        ))
    };
    assert!(placed("", "180").is_ok());
    let error = placed("", "-181").expect_err("more than half a turn").to_string();
    assert!(error.contains("`tilt_deg` is -181, and must be from -180 to 180"), "{error}");
    let error = placed(r#""lengths": {"plane": "pixels"}, "#, "3").expect_err("no millimetres");
    assert!(matches!(error, FileError::LengthsOfPixels { .. }), "{error}");
}

#[test]
fn lenke_classes_picture_files_and_hashes_hold_no_other_text() {
    let parsed = |pointer: &str, value: &str| {
        let mut case = json();
        case["films"][0]["image"]["file"] = "erect.dcm".into();
        case["films"][0]["image"]["sha256"] = "0".repeat(64).into();
        *case.pointer_mut(pointer).expect("a text") = value.into();
        parse_case(&case.to_string()).map_err(|error| error.to_string())
    };
    let lenke = "/subject/lenke";
    for class in ["1", "6C", "5CN", "1A-", "2B+"] {
        assert!(parsed(lenke, class).is_ok(), "{class}");
    }
    let (file, sha256) = ("/films/0/image/file", "/films/0/image/sha256");
    let letters = "g".repeat(64);
    for (pointer, value, words) in [
        (lenke, "Jane Doe", "`lenke` of the subject is `Jane Doe`"),
        (lenke, "7A", "a type from 1 to 6"),
        (lenke, "", "a type from 1 to 6"),
        (file, "/home/jane.doe/films/erect.dcm", "erect film: `file` of its image"),
        (file, "C:\\jane.doe\\erect.dcm", "before `erect.dcm`"),
        (file, "jane.doe/erect.dcm", "before `erect.dcm`"),
        (file, "C:erect.dcm", "before `erect.dcm`"),
        (file, "jane.doe/", "does not name a file; expected the name of a file"),
        (file, "jane.doe/..", "does not name a file; expected the name of a file"),
        (file, "", "does not name a file; expected the name of a file"),
        (sha256, "zz", "erect film: `sha256` of its image is `zz`"),
        (sha256, letters.as_str(), "64 hexadecimal digits"),
    ] {
        let error = parsed(pointer, value).expect_err(value);
        assert!(error.contains(words), "{error}");
        assert!(pointer != file || !error.contains("jane"), "{error}");
    }
}

#[test]
fn one_picture_of_two_postures_is_refused_by_its_name_or_its_bytes() {
    // Oracle: a film shows one posture, from one side.
    let mut case = json();
    let films = case["films"].as_array_mut().expect("films");
    assert!(films.len() > 1);
    for film in films {
        let image = film["image"].as_object_mut().expect("an image");
        image.remove("file");
        image.remove("sha256");
    }
    case["lateral"] = serde_json::json!({
        "image": { "columns": 900, "rows": 2500, "patient_anterior": "image_left" }
    });
    let with = |second: &str, key: &str, values: [&str; 2]| {
        let mut case = case.clone();
        for (place, value) in ["/films/0/image", second].into_iter().zip(values) {
            case.pointer_mut(place).expect("an image")[key] = value.into();
        }
        parse_case(&case.to_string())
    };
    let (frontal, lateral) = ("/films/1/image", "/lateral/image");
    let hash = "0123456789abcdef".repeat(4);
    let other_hash = hash.replace('0', "f");
    for (second, name) in [(frontal, "erect"), (lateral, "lateral")] {
        for (key, value, other) in
            [("file", "film.dcm", "other.dcm"), ("sha256", &hash[..], &other_hash[..])]
        {
            let error = with(second, key, [value; 2]).expect_err("one picture");
            assert!(matches!(error, FileError::PictureTwice { .. }), "{error}");
            let text = error.to_string();
            assert!([value, "erect", name].iter().all(|word| text.contains(word)), "{text}");
            assert!(with(second, key, [value, other]).is_ok());
        }
    }
    let error = with(frontal, "sha256", [&hash, &hash.to_uppercase()]).expect_err("one picture");
    assert!(matches!(error, FileError::PictureTwice { .. }), "{error}");
}
