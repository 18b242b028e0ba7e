//! Films and readings: demonstration, landmarks, reloads, conflicts, blinded readers, uploads.

use std::time::Duration;

use axum::http::{Method, StatusCode};
use serde_json::{Value, json};
use spineline_server::{ServeLimits, ServeOptions};
use spineline_store::Access;

use crate::browser::{App, Browser, options};
use crate::demo::{add_demo, app_with_demo, demo};

/// The program that decodes films: an example, built beside the tests.
pub fn decoding() -> ServeOptions {
    let tests = std::env::current_exe().expect("this program");
    let built = tests.parent().and_then(std::path::Path::parent).expect("a folder of builds");
    let decoder = built.join("examples").join(format!("decoder{}", std::env::consts::EXE_SUFFIX));
    ServeOptions { decoder, ..options(Access::Token) }
}

pub fn app() -> App {
    App::with_token().restarted(decoding())
}

/// The study `blind`: a plan needs a study without readings, so it has only the films of the
/// demonstration.
pub fn add_unread_study(app: &App) {
    let mut store = spineline_store::Store::open(&app.store_path()).expect("the store");
    let by = crate::browser::by("Ann");
    let study = crate::browser::name("blind");
    let record = spineline_store::Study::new(study.clone(), None, true);
    store.add_study(&record, &by).expect("a study");
    for film in store.films(&crate::browser::name("demo-rod-01")).expect("films") {
        let bytes = store.content(&film.content).expect("bytes");
        store.add_film(&study, film.view, &bytes, &film.image, &by).expect("a film");
    }
}

fn corner(level: &str, corner: &str, column: f64, row: f64) -> Value {
    json!({ "kind": "place_corner", "level": level, "corner": corner, "column_px": column, "row_px": row })
}

pub fn record(
    browser: &Browser<'_>,
    reading: i64,
    revision: u64,
    events: Value,
) -> crate::browser::Answer {
    let body = json!({ "expected_revision": revision, "events": events });
    browser.post(&format!("/api/readings/{reading}/events"), &body)
}

pub fn begin(browser: &Browser<'_>, film: i64) -> i64 {
    let begun =
        browser.post(&format!("/api/films/{film}/readings"), &json!({ "repeat": 1 })).succeeded();
    begun.json()["reading"].as_i64().expect("a number")
}

#[test]
fn thumbnails_and_scales_of_films_survive_a_restart() {
    let app = app();
    let browser = app.observer("Ann");
    let film = |study: &Value| study["summary"]["films"][0].clone();
    let before = film(&add_demo(&browser));
    let id = before["film"].as_i64().expect("a number");
    let small = browser.get(&format!("/api/films/{id}/thumbnail")).body;
    drop(browser);
    // From here on films cannot be decoded.
    let nothing = ServeOptions { decoder: "/nowhere".into(), ..decoding() };
    let app = app.restarted(nothing);
    let browser = app.observer("Ann");
    let again = browser.get(&format!("/api/films/{id}/thumbnail")).succeeded();
    assert!(small.starts_with(b"\x89PNG") && again.body == small);
    assert_eq!(film(&browser.get("/api/studies/demo-rod-01").json()), before);
    assert_eq!(before["row_mm"], json!(0.2));
}

#[test]
fn a_reading_is_recorded_undone_reloaded_and_finished() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let study = demo(&browser);
    assert_eq!(study["summary"]["id"], "demo-rod-01");
    assert_eq!(study["summary"]["synthetic"], true);
    let films = study["summary"]["films"].as_array().expect("films");
    assert_eq!(films.len(), 5);
    assert!(films.iter().all(|film| film["readings"].as_array().map(Vec::len) == Some(6)));
    assert_eq!(browser.get("/api/studies").json().as_array().map(Vec::len), Some(1));

    let film = films[0]["film"].as_i64().expect("a number");
    let pixels = browser.get(&format!("/api/films/{film}/pixels")).succeeded();
    let number = |name: &str| pixels.header(name).parse::<f64>().expect("a number");
    let count = number("x-spineline-columns") * number("x-spineline-rows");
    assert_eq!(pixels.body.len() as f64, 2.0 * count);
    assert!(number("x-spineline-window-width") > 1.0 && number("x-spineline-max") > 1000.0);
    let small = browser.get(&format!("/api/films/{film}/thumbnail"));
    assert!(small.body.starts_with(b"\x89PNG"));

    let reading = begin(&browser, film);
    let first = browser.get(&format!("/api/readings/{reading}")).json();
    assert_eq!(
        first["next"],
        json!({ "kind": "corner", "level": "L4", "corner": "superior_left" })
    );
    let body = [
        corner("L4", "superior_left", 900.0, 2000.0),
        corner("L4", "superior_right", 1130.0, 2000.0),
        corner("L4", "inferior_right", 1140.0, 2120.0),
        corner("L4", "inferior_left", 890.0, 2120.0),
    ];
    let marked = record(&browser, reading, 0, json!(body)).json()["reading"].clone();
    assert_eq!(marked["revision"], 4);
    assert_eq!(marked["proposals"][0]["level"], "L3");
    assert_eq!(marked["vertebrae"][0]["complete"], true);
    let undone =
        record(&browser, reading, 4, json!([{ "kind": "undo" }])).json()["reading"].clone();
    assert_eq!(
        (&undone["undoable"], &undone["redoable"], &undone["vertebrae"][0]["complete"]),
        (&json!(3), &json!(1), &json!(false))
    );

    let app = app.restarted(decoding());
    let browser = app.observer("Ann");
    let known = browser.get(&format!("/api/readings/{reading}")).json();
    assert_eq!(known["vertebrae"], undone["vertebrae"]);
    let redone =
        record(&browser, reading, 5, json!([{ "kind": "redo" }])).json()["reading"].clone();
    assert_eq!(redone["vertebrae"], marked["vertebrae"]);
    let finish = |revision: u64| {
        let body = json!({ "expected_revision": revision });
        browser.post(&format!("/api/readings/{reading}/finish"), &body)
    };
    assert_eq!(finish(6).json()["finished"], true);
    assert_eq!(finish(6).status, StatusCode::OK, "the same once more");
}

#[test]
fn f58_two_sessions_of_one_observer_lose_no_change() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let film = demo(&browser)["summary"]["films"][0]["film"].as_i64().expect("a number");
    let reading = begin(&browser, film);
    let click = json!([corner("L4", "superior_left", 900.0, 2000.0)]);
    assert_eq!(record(&browser, reading, 0, click.clone()).status, StatusCode::OK);
    // The acknowledgement was lost: the same request again records nothing.
    let again = record(&browser, reading, 0, click);
    assert_eq!(
        (again.status, again.json()["reading"]["revision"].clone()),
        (StatusCode::OK, json!(1))
    );

    let late = [
        corner("L4", "superior_left", 950.0, 2000.0),
        corner("L4", "superior_right", 990.0, 2000.0),
    ];
    let lost = record(&browser, reading, 0, json!(late));
    assert_eq!(lost.status, StatusCode::CONFLICT);
    let lost = lost.json();
    assert_eq!(lost["problem"]["code"], "conflict");
    assert_eq!(lost["reading"]["vertebrae"][0]["corners"][0]["px"], json!([900.0, 2000.0]));
    let kept = lost["reading"]["conflicts"].as_array().expect("conflicts");
    assert_eq!(kept.len(), 2, "both lost clicks are kept");
    assert_eq!(kept[0]["text"], "L4 superior left corner to (950.0, 2000.0)");

    // The next refusal lists its own conflicts, and the reading lists all.
    let later = record(&browser, reading, 0, json!([corner("L4", "inferior_left", 7.0, 8.0)]));
    assert_eq!(later.status, StatusCode::CONFLICT);
    let later = later.json()["reading"]["conflicts"].clone();
    let texts: Vec<_> =
        later.as_array().expect("conflicts").iter().map(|lost| &lost["text"]).collect();
    assert_eq!(texts, ["L4 inferior left corner to (7.0, 8.0)"]);
    let whole = browser.get(&format!("/api/readings/{reading}")).json();
    assert_eq!(whole["conflicts"].as_array().map(Vec::len), Some(3));

    // A part of a step is never recorded.
    let half = [corner("L4", "superior_right", 990.0, 2000.0), json!({ "kind": "redo" })];
    assert_eq!(record(&browser, reading, 1, json!(half)).status, StatusCode::UNPROCESSABLE_ENTITY);
    assert_eq!(browser.get(&format!("/api/readings/{reading}")).json()["revision"], 1);
}

#[test]
fn f59_a_stale_edit_of_a_film_is_refused_and_kept() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let film = demo(&browser)["summary"]["films"][0]["film"].as_i64().expect("a number");
    let edit = |revision: u64, edit: Value| {
        let body = json!({ "expected_revision": revision, "edit": edit });
        browser.post(&format!("/api/films/{film}/edits"), &body)
    };
    let ball = json!({ "kind": "scale", "from_px": [100.0, 100.0], "to_px": [200.0, 100.0],
        "length_mm": 25.0, "length_sd_mm": 0.05, "calibrator": "ball" });
    let scaled = edit(0, ball).json();
    assert_eq!(scaled["revision"], 1);
    let text = scaled["image"]["spacing_text"].as_str().expect("text");
    assert!(text.starts_with("0.250 × 0.250 mm") && text.contains("ball"), "{text}");
    let stale = edit(0, json!({ "kind": "inverted", "inverted": true }));
    assert_eq!(stale.status, StatusCode::CONFLICT);
    let study = browser.get("/api/studies/demo-rod-01").json();
    assert_eq!(study["conflicts"][0]["text"], "erect film: grey values inverted");
    let case = browser.get("/api/studies/demo-rod-01/case");
    assert_eq!(case.header("content-disposition"), "attachment; filename=\"demo-rod-01.json\"");
    assert_eq!(case.json()["films"][0]["image"]["spacing_source"], "ball");
    assert_eq!(case.json()["films"][0]["checked"], Value::Null);

    // A person compared it with the records.
    let checked = edit(1, json!({ "kind": "checked", "checked": true })).json();
    assert_eq!((&checked["checked"], &checked["revision"]), (&json!(true), &json!(2)));
    let case = browser.get("/api/studies/demo-rod-01/case").json();
    assert_eq!(case["films"][0]["checked"], true);
    assert_eq!(case["films"][0]["image"]["checked"], Value::Null);
}

/// A DICOM film of the demonstration.
pub fn demo_film(app: &App, number: usize) -> Vec<u8> {
    let store = spineline_store::Store::open(&app.store_path()).expect("the store");
    let film = store.films(&crate::browser::name("demo-rod-01")).expect("films").remove(number);
    store.content(&film.content).expect("bytes")
}

/// A DICOM film with a patient's name, which is the demonstration's with the name exchanged for another of its length.
pub fn film_of(app: &App) -> Vec<u8> {
    let mut bytes = demo_film(app, 0);
    let old = b"PHANTOM^ROD01";
    let at = bytes.windows(old.len()).position(|part| part == old).expect("the name");
    bytes[at..at + old.len()].copy_from_slice(b"DOE^JANE SMIT");
    bytes
}

/// A film of a new study: an upload, with the scale of its file.
pub fn uploaded_film(upload: &Value, posture: &str) -> Value {
    json!({ "upload": upload, "posture": posture, "patient_left": "image_left",
        "scale": { "kind": "file" } })
}

pub fn upload(browser: &Browser<'_>, bytes: Vec<u8>) -> crate::browser::Answer {
    browser.send(Method::POST, "/api/uploads", "application/octet-stream", bytes)
}

#[test]
fn a_patients_name_reaches_neither_answers_nor_the_store() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let bytes = film_of(&app);
    let uploaded = upload(&browser, bytes).succeeded();
    let view = uploaded.json();
    let id = view["upload"].as_str().expect("a name");
    assert!(browser.get(&format!("/api/uploads/{id}/thumbnail")).body.starts_with(b"\x89PNG"));
    let others = app.observer("Bob");
    assert_eq!(others.get(&format!("/api/uploads/{id}/thumbnail")).status, StatusCode::NOT_FOUND);
    let film = uploaded_film(&view["upload"], "erect");
    let new = json!({ "id": "S-17", "label": null, "films": [film] });
    let made = browser.post("/api/studies", &new).succeeded();
    let case = browser.get("/api/studies/S-17/case");
    for answer in [&uploaded, &made, &case] {
        assert!(!answer.text().contains("DOE"), "{}", answer.text());
    }
    for end in ["", "-wal"] {
        let path = app.store_path().with_file_name(format!("store{end}"));
        let bytes = std::fs::read(path).unwrap_or_default();
        assert!(!bytes.windows(8).any(|part| part == b"DOE^JANE"), "store{end} holds the name");
    }
}

/// An app that keeps this number of uploads, for this long.
fn with_room(per_account: usize, in_all: usize, kept: Duration) -> App {
    let mut limits = ServeLimits::default();
    limits.uploads.per_account.films = per_account;
    limits.uploads.in_all.films = in_all;
    limits.uploads.kept = kept;
    app_with_demo().restarted(ServeOptions { limits, ..decoding() })
}

#[test]
fn uploads_that_no_study_uses_have_a_limit_that_says_what_to_do() {
    let app = with_room(2, 3, Duration::from_secs(3600));
    let (ann, bob) = (app.observer("Ann"), app.observer("Bob"));
    let bytes = film_of(&app);
    let id = |answer: crate::browser::Answer| {
        answer.succeeded().json()["upload"].as_str().expect("a name").to_owned()
    };
    let first = id(upload(&ann, bytes.clone()));
    id(upload(&ann, bytes.clone()));
    // Refused before it is decoded.
    let full = upload(&ann, b"no film at all".to_vec());
    assert_eq!(
        (full.status, full.code().as_str()),
        (StatusCode::TOO_MANY_REQUESTS, "too_many_uploads")
    );
    let problem = full.json();
    let text = format!("{} {}", problem["message"], problem["help"]);
    for part in ["your uploaded films", "2 films", "create a study", "remove films", "min"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let wait_s: u32 = full.header("retry-after").parse().expect("seconds");
    assert!(wait_s > 60 && wait_s <= 3600, "{wait_s}");

    id(upload(&bob, bytes.clone()));
    let full = upload(&bob, bytes.clone());
    assert_eq!(full.code(), "too_many_uploads");
    assert!(full.text().contains("all users"), "{}", full.text());

    // Discarding an own upload makes room; another user's cannot be discarded.
    let path = format!("/api/uploads/{first}");
    assert_eq!(bob.delete(&path).status, StatusCode::NOT_FOUND);
    assert_eq!(ann.get(&format!("{path}/thumbnail")).status, StatusCode::OK);
    assert_eq!(ann.delete(&path).status, StatusCode::NO_CONTENT);
    assert_eq!(ann.get(&format!("{path}/thumbnail")).status, StatusCode::NOT_FOUND);
    // A refused upload takes no room.
    assert_eq!(upload(&ann, b"no film at all".to_vec()).code(), "film");
    id(upload(&ann, bytes));
}

#[test]
fn uploads_that_no_study_uses_are_dropped_in_time() {
    let app = with_room(1, 1, Duration::ZERO);
    let ann = app.observer("Ann");
    let bytes = film_of(&app);
    for _ in 0..3 {
        let view = upload(&ann, bytes.clone()).succeeded();
        let id = view.json()["upload"].as_str().expect("a name").to_owned();
        let gone = ann.get(&format!("/api/uploads/{id}/thumbnail"));
        assert_eq!(gone.status, StatusCode::NOT_FOUND);
    }
}

#[test]
fn an_invalid_file_is_refused_without_quoting_its_content() {
    let app = app();
    let browser = app.observer("Ann");
    let refused = upload(&browser, b"%PDF-1.7 Doe Jane".to_vec());
    assert_eq!(
        (refused.status, refused.code().as_str()),
        (StatusCode::UNPROCESSABLE_ENTITY, "film")
    );
    assert!(!refused.text().contains("Doe"));
}

#[test]
fn no_answer_to_a_blinded_reader_contains_a_posture() {
    let app = app_with_demo();
    let lead = app.observer("Ann");
    add_unread_study(&app);
    let plan = json!({ "observers": ["Bob"], "repeats": 2, "washout_days": 0 });
    assert_eq!(lead.post("/api/studies/blind/plan", &plan).status, StatusCode::OK);

    let reader = app.observer("Bob");
    let detail = reader.get("/api/studies/blind");
    let code = detail.json()["plan"]["next"]["code"].as_str().expect("a code").to_owned();
    let begun = reader.post(&format!("/api/codes/{code}/readings"), &Value::Null).succeeded();
    let reading = begun.json()["reading"].as_i64().expect("a number");
    let pixels = reader.get(&format!("/api/readings/{reading}/pixels"));
    assert_eq!((pixels.status, pixels.header("etag").as_str()), (StatusCode::OK, ""));
    let answers = [
        detail,
        begun,
        reader.get(&format!("/api/readings/{reading}")),
        reader.get(&format!("/api/readings/{reading}/thumbnail")),
        record_one(&reader, reading),
    ];
    let recorded = answers[4].json();
    assert_eq!((&recorded["reading"]["revision"], &recorded["live"]), (&json!(1), &Value::Null));
    for answer in &answers {
        let told = format!("{:?} {}", answer.headers, answer.text());
        for word in ["erect", "bending", "neutral", "traction", "\"repeat\":1"] {
            assert!(!told.contains(word), "{word} in {told}");
        }
    }
    for film in 6..=10 {
        let status = reader.get(&format!("/api/films/{film}/pixels")).status;
        assert_eq!(status, StatusCode::NOT_FOUND);
    }
    assert_eq!(lead.get(&format!("/api/readings/{reading}")).status, StatusCode::NOT_FOUND);
    assert_eq!(lead.get("/api/studies/blind/case").status, StatusCode::FORBIDDEN);
}

fn record_one(browser: &Browser<'_>, reading: i64) -> crate::browser::Answer {
    record(browser, reading, 0, json!([corner("L4", "superior_left", 5.0, 5.0)]))
}

/// Gives an attribute of an explicit little endian file another text of even length.
pub fn with_text(
    mut bytes: Vec<u8>,
    [group, element]: [u16; 2],
    vr: &[u8; 2],
    value: &str,
) -> Vec<u8> {
    let head = [&group.to_le_bytes()[..], &element.to_le_bytes()[..], &vr[..]].concat();
    let at = bytes.windows(head.len()).position(|part| part == head).expect("the attribute") + 6;
    let old = usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let length = u16::try_from(value.len()).expect("short").to_le_bytes();
    bytes.splice(at..at + 2 + old, length.into_iter().chain(value.bytes()));
    bytes
}

#[test]
fn another_part_of_the_body_is_reported_at_the_upload() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    for (part, doubted) in [("BREAST", true), ("LEG ", true), ("SPINE ", false)] {
        let bytes = with_text(demo_film(&app, 0), [0x18, 0x15], b"CS", part);
        let view = upload(&browser, bytes).json();
        let mut notices = view["notices"].as_array().expect("notices").iter();
        let found = notices.find(|notice| notice["code"] == "other_body_part");
        assert_eq!(found.is_some(), doubted, "{part}: {view}");
        if let Some(notice) = found {
            assert_eq!(notice["severity"], "warning", "{notice}");
            assert!(notice["text"].as_str().is_some_and(|text| text.contains(part.trim())));
        }
    }
}

#[test]
fn films_of_two_patients_or_of_a_leg_are_refused_until_confirmed() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let film = |number: usize, posture: &str, [id, sex, part]: [&str; 3]| {
        let bytes = with_text(demo_film(&app, number), [0x10, 0x20], b"LO", id);
        let bytes = with_text(bytes, [0x10, 0x40], b"CS", sex);
        let bytes = with_text(bytes, [0x18, 0x15], b"CS", part);
        uploaded_film(&upload(&browser, bytes).json()["upload"], posture)
    };
    for (study, stated, doubt) in [
        ("S-1", ["AAAA", "F ", "SPINE "], None),
        ("S-2", ["BBBB", "F ", "SPINE "], Some("Patient ID differs from the erect film")),
        ("S-3", ["BBBB", "M ", "SPINE "], Some("Patient ID and Patient's Sex differ")),
        ("S-4", ["AAAA", "F ", "LEG "], Some("(LEG)")),
    ] {
        let films = [film(0, "erect", ["AAAA", "F ", "SPINE "]), film(1, "left_bending", stated)];
        let mut new = json!({ "id": study, "label": null, "films": films });
        let made = browser.post("/api/studies", &new);
        let Some(doubt) = doubt else {
            assert_eq!(made.status, StatusCode::OK, "{study}: {}", made.text());
            continue;
        };
        assert_eq!(made.status, StatusCode::UNPROCESSABLE_ENTITY, "{study}: {}", made.text());
        let problem = made.json();
        assert_eq!(problem["code"], "doubtful_film", "{problem}");
        let message = problem["message"].as_str().expect("a message");
        assert!(message.contains("left bending film: "), "{message}");
        assert!(message.contains(doubt) && !message.contains("BBBB"), "{message}");
        new["accept_doubtful_films"] = true.into();
        let made = browser.post("/api/studies", &new);
        assert_eq!(made.status, StatusCode::OK, "{study}: {}", made.text());
    }
}
