//! Films from an image archive: a small one of this test, and Orthanc where it is installed.

use axum::http::StatusCode;
use serde_json::{Value, json};
use spineline_dicomweb::Archive;
use spineline_server::ServeOptions;
use spineline_store::{Access, Store};

use crate::browser::{Answer, App, Browser, options};
use crate::demo::app_with_demo;
use crate::dicomweb_orthanc::Orthanc;
use crate::dicomweb_server::{Asked, Reply, serve};
use crate::films::{decoding, film_of, uploaded_film, with_text};

const SERIES: &str = r#"[{"0020000D": {"vr": "UI", "Value": ["1.2"]}, "0020000E": {"vr": "UI", "Value": ["1.2.3"]},
    "00080020": {"vr": "DA", "Value": ["20240517"]}, "00080060": {"vr": "CS", "Value": ["DX"]},
    "00081030": {"vr": "LO", "Value": ["Whole spine"]}, "00201209": {"vr": "IS", "Value": [2]},
    "00100010": {"vr": "PN", "Value": [{"Alphabetic": "DOE^JANE"}]}, "00100020": {"vr": "LO", "Value": ["P-07"]}}]"#;
const FILMS: &str = r#"[{"00080018": {"vr": "UI", "Value": ["1.2.3.4"]}, "00200013": {"vr": "IS", "Value": [1]},
    "00280010": {"vr": "US", "Value": [900]}, "00280011": {"vr": "US", "Value": [400]}, "00185101": {"vr": "CS", "Value": ["PA"]}}]"#;

/// An archive with the film `1.2.3.4`, a text file `1.2.3.5`, and nothing else.
fn archive(film: Vec<u8>) -> (String, Asked) {
    serve(move |head| {
        let path = head.split(' ').nth(1)?;
        let file = |body: &[u8]| {
            let parts = [b"--b\r\nContent-Type: application/dicom\r\n\r\n", body, b"\r\n--b--\r\n"];
            let kind = "multipart/related; type=\"application/dicom\"; boundary=b";
            Reply { status: 200, kind, more: "", body: parts.concat() }
        };
        Some(if path.contains("/series?") {
            Reply::json(SERIES)
        } else if path.contains("/instances?") {
            Reply::json(FILMS)
        } else if path.ends_with("/instances/1.2.3.4") {
            file(&film)
        } else if path.ends_with("/instances/1.2.3.5") {
            file(b"a letter to Doe Jane")
        } else {
            Reply::status(404)
        })
    })
}

/// The film `1.2.3.4` of the patient that the search finds.
fn film_of_archive(app: &App) -> Vec<u8> {
    let texts = [
        ([0x08, 0x18], b"UI", "1.2.3.4\0"),
        ([0x20, 0x0D], b"UI", "1.2\0"),
        ([0x20, 0x0E], b"UI", "1.2.3\0"),
        ([0x10, 0x20], b"LO", "P-07"),
    ];
    texts.into_iter().fold(film_of(app), |bytes, (tag, vr, value)| with_text(bytes, tag, vr, value))
}

#[test]
fn a_film_that_is_not_the_one_asked_for_is_refused_with_both_uids_and_without_the_patient() {
    let app = app_with_demo();
    let right = film_of_archive(&app);
    let with = |tag, vr, value| with_text(right.clone(), tag, vr, value);
    for (film, words) in [
        (with([0x08, 0x18], b"UI", "1.2.3.9\0"), "SOP Instance UID is 1.2.3.9"),
        (with([0x20, 0x0D], b"UI", "1.9\0"), "Study Instance UID is 1.9"),
        (with([0x20, 0x0E], b"UI", "1.2.9\0"), "Series Instance UID is 1.2.9"),
        (with([0x10, 0x20], b"LO", "P-08"), "Patient ID"),
    ] {
        let (address, _) = archive(film);
        let app = App::with_token()
            .restarted(ServeOptions { archives: vec![clinic(&address)], ..decoding() });
        let browser = app.observer("Ann");
        assert_eq!(browser.post("/api/archives/search", &search_body()).status, StatusCode::OK);
        let refused = open(&browser, ["1.2", "1.2.3", "1.2.3.4"]);
        assert_eq!(refused.code(), "archive_other_film", "{}", refused.text());
        assert!(refused.text().contains(words), "{}", refused.text());
        assert!(!refused.text().contains("P-0") && !refused.text().contains("DOE"));
    }
}

fn clinic(address: &str) -> Archive {
    Archive::parse(&format!("clinic={address}"))
        .and_then(|archive| archive.with_login("films:secret"))
        .expect("an archive")
}

fn search_body() -> Value {
    json!({ "archive": "clinic", "key": "patient_id", "value": "P-07" })
}

fn open(browser: &Browser<'_>, [study, series, instance]: [&str; 3]) -> Answer {
    let film =
        json!({ "archive": "clinic", "study": study, "series": series, "instance": instance });
    browser.post("/api/archives/open", &film)
}

/// The actions of the log, with who did them.
fn log(app: &App) -> Vec<(String, String)> {
    let store = Store::open(&app.store_path()).expect("the store");
    assert!(store.verify(None).expect("verifiable").is_clean());
    let log = store.audit_log().expect("a log").into_iter();
    log.map(|entry| (entry.actor, entry.action)).collect()
}

#[test]
fn a_film_of_an_archive_is_searched_opened_as_an_upload_and_logged() {
    let app = app_with_demo();
    let (address, asked) = archive(film_of_archive(&app));
    let app = app.restarted(ServeOptions { archives: vec![clinic(&address)], ..decoding() });
    let browser = app.observer("Ann");
    assert_eq!(browser.get("/api/archives").json(), json!(["clinic"]));

    let found = browser.post("/api/archives/search", &search_body()).succeeded();
    let series = found.json()["series"][0].clone();
    assert_eq!((&series["day"], &series["films"]), (&json!("2024-05-17"), &json!(2)));
    let body = json!({ "archive": "clinic", "study": series["study"], "series": series["series"] });
    let films = browser.post("/api/archives/films", &body);
    assert_eq!(films.json()["films"][0]["rows"], 900, "{}", films.text());

    let view = open(&browser, ["1.2", "1.2.3", "1.2.3.4"]).succeeded();
    let film = uploaded_film(&view.json()["upload"], "erect");
    let new = json!({ "id": "S-17", "label": null, "films": [film] });
    let made = browser.post("/api/studies", &new).succeeded();
    for answer in [&found, &films, &view, &made] {
        assert!(!answer.text().contains("DOE") && !answer.text().contains("secret"));
    }
    for end in ["", "-wal"] {
        let path = app.store_path().with_file_name(format!("store{end}"));
        let bytes = std::fs::read(path).unwrap_or_default();
        for word in ["DOE^JANE", "films:secret", "P-07"] {
            assert!(!bytes.windows(word.len()).any(|part| part == word.as_bytes()), "{word}");
        }
    }
    let log = log(&app);
    for action in ["search_clinic", "retrieve_clinic"] {
        assert!(log.contains(&("Ann".to_owned(), action.to_owned())), "{action}: {log:?}");
    }
    assert_eq!(asked.lock().expect("heads").len(), 3);
}

#[test]
fn what_an_archive_refuses_has_a_code_and_a_remedy() {
    let (address, asked) = archive(Vec::new());
    let (locked, _) = serve(|_| Some(Reply::status(401)));
    let (large, _) = serve(|_| Some(Reply { body: vec![b' '; 2000], ..Reply::json("") }));
    let (silent, _) = serve(|_| None);
    let mut limits = spineline_server::ServeLimits::default();
    limits.archive.search = std::time::Duration::from_millis(300);
    limits.archive.search_bytes = 1000;
    for (address, code) in [
        (&locked[..], "archive_login"),
        (&large, "too_large"),
        (&silent, "archive_slow"),
        ("http://127.0.0.1:9/dicom-web", "archive_unreachable"),
    ] {
        let archives = vec![clinic(address)];
        let app = App::with_token().restarted(ServeOptions { archives, limits, ..decoding() });
        let refused = app.observer("Ann").post("/api/archives/search", &search_body());
        assert_eq!(refused.code(), code, "{}", refused.text());
        let problem = refused.json();
        assert!(problem["help"].as_str().is_some_and(|help| !help.is_empty()), "{problem}");
        assert!(!refused.text().contains("P-07") && !refused.text().contains("DOE"));
        assert!(log(&app).iter().all(|(_, action)| action != "search_clinic"));
    }
    let app = App::with_token()
        .restarted(ServeOptions { archives: vec![clinic(&address)], ..decoding() });
    let browser = app.observer("Ann");
    assert_eq!(open(&browser, ["1.2", "1.2.3", "1.2.3.9"]).code(), "archive_film_missing");
    let letter = open(&browser, ["1.2", "1.2.3", "1.2.3.5"]);
    assert_eq!((letter.code().as_str(), letter.status.as_u16()), ("film", 422));
    assert!(!letter.text().contains("Doe"), "{}", letter.text());
    let before = asked.lock().expect("heads").len();
    assert_eq!(open(&browser, ["1.2", "../1", "1.2.3.4"]).code(), "bad_search");
    for wrong in [json!({ "value": "P*" }), json!({ "day": "17.05.2024" }), json!({ "value": "" })]
    {
        let mut body = search_body();
        body.as_object_mut().expect("fields").extend(wrong.as_object().expect("fields").clone());
        assert_eq!(browser.post("/api/archives/search", &body).code(), "bad_search", "{body}");
    }
    let body = json!({ "archive": "other", "key": "patient_id", "value": "P-07" });
    assert_eq!(browser.post("/api/archives/search", &body).code(), "not_found");
    assert_eq!(asked.lock().expect("heads").len(), before, "the archive was not asked");
}

#[test]
fn readers_open_no_films_of_an_archive() {
    let (address, asked) = archive(Vec::new());
    let archives = vec![clinic(&address)];
    let app =
        App::with_accounts().restarted(ServeOptions { archives, ..options(Access::Accounts) });
    let reader = app.account("reader");
    let refused = [
        reader.post("/api/archives/search", &search_body()),
        open(&reader, ["1.2", "1.2.3", "1.2.3.4"]),
    ];
    for refused in refused {
        assert_eq!(refused.code(), "not_allowed");
    }
    assert!(asked.lock().expect("heads").is_empty());
}

#[test]
fn a_film_of_orthanc_becomes_a_study() {
    let app = app_with_demo();
    let Some(orthanc) = Orthanc::start() else { return };
    orthanc.store(&with_text(film_of(&app), [0x10, 0x20], b"LO", "P-07"));
    let archives = vec![clinic(&orthanc.address())];
    let app = app.restarted(ServeOptions { archives, ..decoding() });
    let browser = app.observer("Ann");
    let found = browser.post("/api/archives/search", &search_body()).succeeded();
    let series = found.json()["series"][0].clone();
    let body = json!({ "archive": "clinic", "study": series["study"], "series": series["series"] });
    let film = browser.post("/api/archives/films", &body).json()["films"][0].clone();
    let text = |value: &Value| value.as_str().expect("a UID").to_owned();
    let [study, series, film] = [&series["study"], &series["series"], &film["instance"]].map(text);
    let view = open(&browser, [&study, &series, &film]).succeeded();
    assert!(view.json()["columns"].as_u64() > Some(10), "{}", view.text());
}
