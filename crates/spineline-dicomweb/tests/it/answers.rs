//! Searches and films from a small server, and invalid answers.

use std::time::Duration;

use spineline_dicomweb::{
    Archive, ArchiveFault, BadQuery, Client, DicomwebError, FilmUid, Limits, Search, SearchKey,
    SeriesUid, StatedUids,
};

use crate::server::{Reply, serve};

pub const LIMITS: Limits = Limits {
    connect: Duration::from_secs(2),
    search: Duration::from_secs(2),
    search_bytes: 1 << 20,
    film: Duration::from_secs(5),
    film_bytes: 1 << 20,
};

const SERIES: &str = r#"[{
    "0020000D": {"vr": "UI", "Value": ["1.2.3"]}, "0020000E": {"vr": "UI", "Value": ["1.2.3.4"]},
    "00080020": {"vr": "DA", "Value": ["20240517"]}, "00080060": {"vr": "CS", "Value": ["DX"]},
    "00081030": {"vr": "LO", "Value": ["Whole spine"]}, "00180015": {"vr": "CS"},
    "00201209": {"vr": "IS", "Value": ["2"]}, "00100020": {"vr": "LO", "Value": ["A/1 &x=../ "]},
    "00100010": {"vr": "PN", "Value": [{"Alphabetic": "DOE^JANE"}]}}]"#;

fn archive(address: &str) -> Archive {
    Archive::parse(&format!("archive={address}")).expect("an archive")
}

fn search(value: &str) -> Search {
    Search::new(SearchKey::PatientId, value).expect("a search")
}

fn film() -> FilmUid {
    FilmUid::new(SeriesUid::new("1.2.3", "1.2.3.4").expect("UIDs"), "1.2.3.4.5").expect("a UID")
}

#[test]
fn a_search_sends_an_escaped_value_and_finds_series_without_names() {
    let (address, asked) = serve(|_| Some(Reply::json(SERIES)));
    let found =
        Client::new(LIMITS).search(&archive(&address), &search("A/1 &x=../")).expect("series");
    assert!(!found.has_more);
    let [series] = &found.all[..] else { panic!("{found:?}") };
    let uid = series.uid();
    assert_eq!((uid.study(), uid.series()), ("1.2.3", "1.2.3.4"));
    assert_eq!(series.day.as_deref(), Some("2024-05-17"));
    assert_eq!(series.description.as_deref(), Some("Whole spine"));
    assert_eq!((series.modality.as_deref(), series.films), (Some("DX"), Some(2)));
    assert!(!format!("{found:?}").contains("DOE"));
    let error = Client::new(LIMITS).search(&archive(&address), &search("A/2"));
    let error = error.expect_err("films of another patient");
    assert!(matches!(error, DicomwebError::BadAnswer { .. }), "{error}");
    let on_a_day = search("a/1 &X=../").on("2024-05-17").expect("a day");
    Client::new(LIMITS).search(&archive(&address), &on_a_day).expect("series");
    let head = asked.lock().expect("heads").join("\n");
    assert!(head.starts_with("GET /dicom-web/series?PatientID=A%2F1"), "{head}");
    assert!(head.contains("%26x%3D") && !head.contains("&x="), "{head}");
    assert!(head.contains("&StudyDate=20240517&"), "{head}");
}

#[test]
fn a_film_comes_byte_by_byte_with_the_login_of_its_server() {
    let (address, asked) = serve(|_| {
        let body =
            b"--b\r\nContent-Type: application/dicom\r\n\r\n\0\xFF\r\n--\r\n--b--\r\n".to_vec();
        let kind = "multipart/related; type=\"application/dicom\"; boundary=b";
        Some(Reply { status: 200, kind, more: "", body })
    });
    let archive = archive(&address).with_login("films:secret\n").expect("a login");
    assert!(!format!("{archive:?}").contains("secret"));
    let bytes = Client::new(LIMITS).retrieve(&archive, &film()).expect("a film");
    assert_eq!(bytes, b"\0\xFF\r\n--");
    let head = asked.lock().expect("heads").join("\n");
    assert!(
        head.contains("/dicom-web/studies/1.2.3/series/1.2.3.4/instances/1.2.3.4.5 "),
        "{head}"
    );
    assert!(head.contains("Basic ZmlsbXM6c2VjcmV0"), "{head}");
}

#[test]
fn a_warning_that_the_archive_has_more_is_passed_on() {
    // PS3.18, 8.3.4.4: `Warning: 299`.
    let warnings = [
        ("", false),
        (
            "Warning: 299 archive: \"There are 23 additional results that can be requested\"\r\n",
            true,
        ),
        ("warning: 110 x \"stale\"\r\nwarning: 299 x \"more\"\r\n", true),
        ("warning: 110 x \"299\"\r\n", false),
    ];
    for (more, wanted) in warnings {
        let (address, _) = serve(move |_| Some(Reply { more, ..Reply::json(SERIES) }));
        let client = Client::new(LIMITS);
        let found = client.search(&archive(&address), &search("A/1 &x=../")).expect("series");
        assert_eq!(found.has_more, wanted, "{more}");
        let (address, _) = serve(move |_| Some(Reply { more, ..Reply::json("[]") }));
        let films = client.films(&archive(&address), &film().series).expect("films");
        assert_eq!(films.has_more, wanted, "{more}");
    }
}

#[test]
fn entries_of_another_series_or_day_are_refused() {
    let of_other =
        r#"[{"00080018": {"Value": ["1.2.3.4.5"]}, "0020000E": {"Value": ["1.2.3.9"]}}]"#;
    let (address, _) = serve(move |_| Some(Reply::json(of_other)));
    let error = Client::new(LIMITS).films(&archive(&address), &film().series);
    assert!(matches!(error, Err(DicomwebError::BadAnswer { .. })), "{error:?}");
    let (address, _) = serve(|_| Some(Reply::json(SERIES)));
    let other_day = search("A/1 &x=../").on("2024-05-18").expect("a day");
    let error = Client::new(LIMITS).search(&archive(&address), &other_day);
    assert!(matches!(error, Err(DicomwebError::BadAnswer { .. })), "{error:?}");
}

#[test]
fn a_file_of_another_film_is_refused_with_both_uids() {
    let archive = archive("http://localhost/x");
    let right =
        StatedUids { study: Some("1.2.3"), series: Some("1.2.3.4"), instance: Some("1.2.3.4.5") };
    assert_eq!(film().check(&archive, right), Ok(()));
    for (file, attribute) in [
        (StatedUids { study: Some("1.2.9"), ..right }, "Study Instance UID"),
        (StatedUids { series: Some("1.2.3.9"), ..right }, "Series Instance UID"),
        (StatedUids { instance: Some("1.2.3.4.9"), ..right }, "SOP Instance UID"),
        (StatedUids { instance: None, ..right }, "SOP Instance UID"),
    ] {
        let error = film().check(&archive, file).expect_err("another film");
        let text = error.to_string();
        assert!(text.contains(attribute) && text.contains("1.2.3"), "{text}");
        assert!(text.contains(".9") || text.contains("not stated"), "{text}");
        assert!(!error.help().is_empty());
    }
}

#[test]
fn redirects_are_not_followed() {
    let (elsewhere, reached) = serve(|_| Some(Reply::json("[]")));
    let more: &'static str = Box::leak(format!("location: {elsewhere}/\r\n").into_boxed_str());
    let (address, _) = serve(move |_| Some(Reply { more, ..Reply::status(302) }));
    let error = Client::new(LIMITS).search(&archive(&address), &search("P1")).expect_err("refused");
    assert!(matches!(error, DicomwebError::Redirect { status: 302, .. }), "{error}");
    assert!(reached.lock().expect("heads").is_empty());
}

#[test]
fn refusals_have_types_and_quote_nothing() {
    for (status, is_right) in [
        (401, (|e| matches!(e, DicomwebError::Login { .. })) as fn(&DicomwebError) -> bool),
        (404, |e| matches!(e, DicomwebError::NotFound { .. })),
        (500, |e| matches!(e, DicomwebError::Refused { status: 500, .. })),
    ] {
        let (address, _) = serve(move |_| Some(Reply::status(status)));
        let error = Client::new(LIMITS).retrieve(&archive(&address), &film()).expect_err("refused");
        assert!(is_right(&error), "{status}: {error}");
        assert!(!error.to_string().contains("DOE") && !error.help().is_empty());
    }
    // A service without the list of all series is at another address; nobody asked for a film.
    let (address, _) = serve(|_| Some(Reply::status(404)));
    let error = Client::new(LIMITS).search(&archive(&address), &search("P1")).expect_err("refused");
    assert!(matches!(error, DicomwebError::Refused { status: 404, .. }), "{error}");
    assert!(error.help().contains("the address"), "{}", error.help());
    for bad in ["{}", "<html>", r#"[{"0020000D": {"Value": ["../1"]}}]"#, "[1]"] {
        let (address, _) = serve(move |_| Some(Reply::json(bad)));
        let error = Client::new(LIMITS).search(&archive(&address), &search("P1")).expect_err(bad);
        assert!(matches!(error, DicomwebError::BadAnswer { .. }), "{bad}: {error}");
    }
}

#[test]
fn large_and_slow_answers_end_at_their_limits() {
    let (address, _) = serve(|_| {
        let body = vec![b' '; (1 << 20) + 1];
        Some(Reply { body, ..Reply::json("") })
    });
    let error =
        Client::new(LIMITS).search(&archive(&address), &search("P1")).expect_err("too large");
    assert!(matches!(error, DicomwebError::TooLarge { .. }), "{error}");
    let (address, _) = serve(|_| None);
    let error =
        Client::new(LIMITS).search(&archive(&address), &search("P1")).expect_err("too slow");
    assert!(matches!(error, DicomwebError::TooSlow { .. }), "{error}");
    let error = Client::new(LIMITS).search(&archive("http://127.0.0.1:9/x"), &search("P1"));
    assert!(matches!(error, Err(DicomwebError::Unreachable { .. })), "{error:?}");
}

/// An answer cut at every place, and with every byte changed.
fn damaged(whole: &[u8]) -> Vec<Vec<u8>> {
    let cut = (0..whole.len()).map(|end| whole[..end].to_vec());
    let changed = (0..whole.len()).map(|at| {
        let mut bytes = whole.to_vec();
        bytes[at] ^= 0x15;
        bytes
    });
    cut.chain(changed).collect()
}

#[test]
fn damaged_answers_are_films_series_or_errors() {
    const WHOLE: &[u8] = b"--b\r\nContent-Type: application/dicom\r\n\r\nfilm\r\n--b--\r\n";
    let client = Client::new(LIMITS);
    let bodies = damaged(WHOLE);
    let (count, mut next) = (bodies.len(), bodies.into_iter());
    let (address, _) = serve(move |_| {
        let kind = "multipart/related; boundary=b";
        Some(Reply { status: 200, kind, more: "", body: next.next()? })
    });
    let films: Vec<_> = (0..count).map(|_| client.retrieve(&archive(&address), &film())).collect();
    let is_whole = |film: &Result<Vec<u8>, _>| film.as_deref() == Ok(b"film");
    assert!(films.iter().any(is_whole) && films.iter().any(Result::is_err));
    let bodies = damaged(SERIES.as_bytes());
    let (count, mut next) = (bodies.len(), bodies.into_iter());
    let (address, _) = serve(move |_| Some(Reply { body: next.next()?, ..Reply::json("") }));
    for _ in 0..count {
        if let Err(error) = client.search(&archive(&address), &search("A/1 &x=../")) {
            assert!(matches!(error, DicomwebError::BadAnswer { .. }), "{error}");
        }
    }
}

#[test]
fn only_addresses_of_servers_are_taken_from_the_command_line() {
    for bad in [
        "archive",
        "Archive=https://a.example",
        "=https://a.example",
        "archive=ftp://a.example",
        "archive=//a.example",
        "archive=https://user:secret@a.example",
        "archive=https://a.example/x?y=1",
        "archive=https://a.example/#x",
    ] {
        let fault = Archive::parse(bad).expect_err(bad);
        assert!(
            !fault.to_string().contains("secret") || matches!(fault, ArchiveFault::Form { .. })
        );
    }
}

#[test]
fn plain_http_is_exposed_unless_it_stays_on_this_machine() {
    for (address, is_exposed) in [
        ("http://localhost:8042/dicom-web/", false),
        ("http://127.0.0.1:8042", false),
        ("http://[::1]:8042", false),
        ("http://127.0.0.1.a.example", true),
        ("http://192.0.2.1", true),
    ] {
        assert_eq!(archive(address).is_exposed(), is_exposed, "{address}");
    }
}

#[test]
fn an_encrypted_connection_needs_a_program_that_makes_it() {
    let parsed = Archive::parse("archive=https://a.example/dicom-web");
    if cfg!(feature = "https") {
        assert!(!parsed.expect("an archive").is_exposed());
    } else {
        let fault = parsed.expect_err("no encryption");
        assert_eq!(fault, ArchiveFault::Encryption { name: "archive".to_owned() });
        assert!(fault.to_string().contains("--features https"), "{fault}");
    }
}

#[cfg(feature = "https")]
#[test]
fn a_server_without_encryption_is_named_as_such() {
    use std::io::{Read, Write};
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = format!("https://{}", listener.local_addr().expect("an address"));
    std::thread::spawn(move || {
        for connection in listener.incoming() {
            let mut connection = connection.expect("a connection");
            let _ = connection.read(&mut [0; 1 << 14]);
            let _ = connection.write_all(b"HTTP/1.1 400 Bad Request\r\n\r\n");
        }
    });
    let error = Client::new(LIMITS).search(&archive(&address), &search("A")).expect_err("no TLS");
    assert!(matches!(error, DicomwebError::Unreachable { .. }), "{error}");
    assert!(error.to_string().contains("does not speak TLS"), "{error}");
}

#[test]
fn only_exact_values_and_uids_are_searched_for() {
    for bad in ["", "  ", "*", "A?", "A\\B", "A\nB", &"x".repeat(65)] {
        assert!(Search::new(SearchKey::PatientId, bad).is_err(), "{bad:?}");
    }
    for bad in ["", "2024", "20240517", "2024-05-1", "2024-5-017", "2024-05-17-", "2024–05–17"]
    {
        assert_eq!(search("A").on(bad), Err(BadQuery::Day), "{bad:?}");
    }
    for bad in ["", "1..2", "../1", "1.2/3", "1.2?x", ".1", "1.", &"1".repeat(65)] {
        assert_eq!(SeriesUid::new("1.2", bad), Err(BadQuery::Uid), "{bad:?}");
    }
}
