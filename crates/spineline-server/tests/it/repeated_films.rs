//! One film for two postures is noticed when it is uploaded, and refused in a study.

use axum::http::StatusCode;
use serde_json::{Value, json};
use spineline::analysis::Subject;
use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane};
use spineline_films::{DicomFilm, Encoding, FilmPolarity, write_dicom};

use crate::browser::Browser;
use crate::films::{app, upload};

const SIZE: [u32; 2] = [80, 64];

/// A small film with these pixels; its identifier follows from the posture.
fn film(posture: Posture, grey: u16, encoding: Encoding) -> Vec<u8> {
    film_of_size(SIZE, posture, grey, encoding)
}

pub fn film_of_size(
    [columns, rows]: [u32; 2],
    posture: Posture,
    grey: u16,
    encoding: Encoding,
) -> Vec<u8> {
    let pixels: Vec<u16> = (0..columns * rows).map(|at| at as u16 % 1000 + grey).collect();
    let spacing = Some(Spacing::stated(0.1, 0.1, SpacingPlane::Patient));
    let film = DicomFilm {
        case_id: "small",
        subject: &Subject::default(),
        posture,
        image: ImageGeometry { columns, rows, spacing, patient_left: ImageSide::Left },
        magnification: 1.1,
        polarity: FilmPolarity::Monochrome2,
        bits_stored: 12,
        pixels: &pixels,
        encoding,
    };
    write_dicom(&film).expect("a sound film")
}

/// Uploads a film; its name and the codes of its notices.
fn uploaded(browser: &Browser<'_>, bytes: Vec<u8>) -> (String, Vec<String>) {
    let view = upload(browser, bytes).succeeded().json();
    let notices = view["notices"].as_array().expect("a list").iter();
    let codes = notices.map(|notice| notice["code"].as_str().expect("a code").to_owned());
    (view["upload"].as_str().expect("a name").to_owned(), codes.collect())
}

#[test]
fn a_second_file_of_an_uploaded_film_is_noticed() {
    let app = app();
    let (ann, bob) = (app.observer("Ann"), app.observer("Bob"));
    let repeated = |codes: &[String]| {
        ["picture_repeated", "identifier_repeated"].map(|code| codes.iter().any(|c| c == code))
    };
    let first = film(Posture::Erect, 0, Encoding::Plain);
    assert_eq!(repeated(&uploaded(&ann, first).1), [false, false]);
    // Another file and identifier, and the same pixels.
    let copy = film(Posture::Neutral, 0, Encoding::Rle);
    assert_eq!(repeated(&uploaded(&ann, copy.clone()).1), [true, false]);
    // Other pixels, and the same identifier.
    let changed = film(Posture::Erect, 1, Encoding::Plain);
    assert_eq!(repeated(&uploaded(&ann, changed).1), [false, true]);
    let other = film(Posture::Traction, 2, Encoding::Plain);
    assert_eq!(repeated(&uploaded(&ann, other).1), [false, false]);
    // Other users' uploads stay hidden.
    assert_eq!(repeated(&uploaded(&bob, copy).1), [false, false]);
}

#[test]
fn one_picture_in_two_files_makes_no_study_of_two_postures() {
    let app = app();
    let browser = app.observer("Ann");
    let [first, copy, other] = [
        film(Posture::Erect, 0, Encoding::Plain),
        film(Posture::Neutral, 0, Encoding::Rle),
        film(Posture::Neutral, 5, Encoding::Rle),
    ]
    .map(|bytes| uploaded(&browser, bytes).0);
    let image = |file: &str| {
        json!({ "columns": SIZE[0], "rows": SIZE[1], "patient_left": "image_left",
            "spacing_plane": "pixels", "file": file })
    };
    let erect = json!({ "posture": "erect", "image": image("a.dcm"), "readings": [] });
    let neutral = json!({ "posture": "neutral", "image": image("b.dcm"), "readings": [] });
    for (second, is_refused) in [(&copy, true), (&other, false)] {
        let text = json!({ "format": "spineline-case", "version": 1, "case_id": "S-1",
            "synthetic": true, "films": [erect, neutral] });
        let names =
            json!([{ "name": "a.dcm", "upload": first }, { "name": "b.dcm", "upload": second }]);
        let case = json!({ "text": text.to_string(), "films": names });
        let scale = json!({ "kind": "file" });
        let new = |posture: &str, upload: &str| {
            json!({ "upload": upload, "posture": posture, "patient_left": "image_left",
                "scale": scale })
        };
        let study = json!({ "id": "S-2", "label": null,
            "films": [new("erect", &first), new("neutral", second)] });
        let asked: [(&str, &Value); 2] = [("/api/studies", &study), ("/api/studies/case", &case)];
        for (path, body) in asked {
            let made = browser.post(path, body);
            if is_refused {
                assert_eq!(made.status, StatusCode::UNPROCESSABLE_ENTITY, "{path} {}", made.text());
                let text = made.text();
                for part in ["erect film", "neutral film", "the same picture"] {
                    assert!(text.contains(part), "{path}: no {part} in {text}");
                }
            } else if path == "/api/studies/case" {
                // The uploads went into the first study.
                assert_eq!(made.status, StatusCode::NOT_FOUND, "{path} {}", made.text());
            } else {
                assert_eq!(made.status, StatusCode::OK, "{path} {}", made.text());
            }
        }
    }
}

#[test]
fn a_study_takes_one_lateral_film_with_the_side_of_the_front() {
    let app = app();
    let browser = app.observer("Ann");
    let postures = [Posture::Erect, Posture::Neutral, Posture::Traction];
    let uploads: Vec<String> = (0..)
        .zip(postures)
        .map(|(grey, posture)| uploaded(&browser, film(posture, grey, Encoding::Plain)).0)
        .collect();
    let new = |view: &str, side: &str, upload: &String| {
        json!({ "upload": upload, "posture": view, "patient_left": side,
            "simultaneous": true, "scale": { "kind": "file" } })
    };
    let [erect, lateral, second] = [
        new("erect", "image_left", &uploads[0]),
        new("lateral", "image_right", &uploads[1]),
        new("lateral", "image_right", &uploads[2]),
    ];
    let refused = browser.post(
        "/api/studies",
        &json!({ "id": "S-1", "label": null, "films": [erect, lateral, second] }),
    );
    assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert!(refused.text().contains("two lateral films"), "{}", refused.text());
    let mut new = json!({ "id": "S-1", "label": null, "films": [erect, lateral] });
    // The files of the test state a frontal view.
    let doubted = browser.post("/api/studies", &new);
    assert_eq!(doubted.code(), "doubtful_film", "{}", doubted.text());
    assert!(doubted.text().contains("lateral film: the file says that this is a frontal view"));
    new["accept_doubtful_films"] = true.into();
    let made = browser.post("/api/studies", &new).succeeded();
    let case = browser.get("/api/studies/S-1/case").text();
    let lateral = spineline_files::parse_case(&case).expect("a case").lateral.expect("its film");
    assert_eq!((lateral.image.patient_left, lateral.simultaneous), (ImageSide::Right, true));
    assert!(lateral.image.spacing.is_some());
    // The lateral film has no posture.
    let films = made.json()["summary"]["films"].clone();
    let film = films.as_array().expect("films").iter().find(|film| film["posture"] == "lateral");
    let number = &film.expect("the lateral film")["film"];
    let edit =
        json!({ "expected_revision": 0, "edit": { "kind": "posture", "posture": "neutral" } });
    let edited = browser.post(&format!("/api/films/{number}/edits"), &edit);
    assert_eq!(edited.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", edited.text());
}
