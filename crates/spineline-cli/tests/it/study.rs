//! `spineline study`: the store from the command line.

use std::fs;

use spineline_store::{Name, Signature, Store, Study};

use crate::program::{Here, folder};

/// A folder with a store of one synthetic case of one reading, whose films are small files of any bytes.
fn store() -> Here {
    let here = folder();
    here.done(&["phantom", "--subject", "1", "--out", "p", "--noise", "0"]);
    here.change("p/phantom-rod-01.json", |case| {
        for film in case["films"].as_array_mut().expect("films") {
            let posture = film["posture"].as_str().expect("a posture").to_owned();
            let file = format!("{posture}.bin");
            here.write(format!("p/{file}"), &posture);
            film["image"]["file"] = file.into();
            film["image"]["sha256"] = spineline_files::sha256_hex(posture.as_bytes()).into();
        }
    });
    here.done(&["study", "create", "s.db"]);
    let out = here.done(&["study", "add", "s.db", "p/phantom-rod-01.json"]);
    assert!(out.contains("5 films and 5 readings"), "{out}");
    here
}

#[test]
fn a_case_round_trips_through_the_store_with_equal_landmarks() {
    let here = store();
    let out = here.done(&["study", "export", "s.db", "phantom-rod-01"]);
    let before = here.text("p/phantom-rod-01.json");
    let before = spineline_files::parse_case(&before).expect("a case");
    let after = spineline_files::parse_case(&out).expect("a case");
    assert!(after.synthetic);
    assert_eq!(before.films, after.films);
    let (out, _, _) = here.run(&["study", "list", "s.db"]);
    assert!(out.contains("phantom-rod-01 (synthetic)") && out.contains("right bending"), "{out}");
}

#[test]
fn a_store_verification_reports_edits() {
    let here = store();
    let out = here.done(&["study", "verify", "s.db"]);
    let head = out.split_whitespace().find(|word| word.contains(':') && word.len() > 64);
    let head = head.expect("the end of the log").to_owned();
    let (out, error, code) = here.run(&["study", "backup", "s.db", "copy.db"]);
    assert_eq!((code, error.as_str()), (0, ""), "{out}");
    here.done(&["study", "verify", "copy.db", "--head", &head]);
    let connection = rusqlite::Connection::open(here.path("copy.db")).expect("SQLite");
    connection
        .execute_batch("UPDATE studies SET synthetic = 0")
        .expect("an edit behind the program's back");
    drop(connection);
    let (out, _, code) = here.run(&["study", "verify", "copy.db"]);
    assert_eq!(code, 3);
    assert!(out.contains("study/phantom-rod-01 differs from its entry in the log"), "{out}");
}

#[test]
fn readings_are_withdrawn_and_corrected_and_a_study_is_renamed_and_archived() {
    let (here, study) = (store(), "phantom-rod-01");
    let listed = || here.done(&["study", "list", "s.db", study]);
    let state = |reading: &str| {
        let listed = listed();
        let row = listed.lines().find(|row| row.split_whitespace().next() == Some(reading));
        row.map(|row| row.trim_end().to_owned()).expect(reading)
    };
    assert!(state("1").contains("erect") && state("1").ends_with("finished"), "{}", listed());
    let error = here.refused(&["study", "correct", "s.db", "1", "--by", "other"], 3);
    assert!(error.contains("another observer") && error.contains("`--by`"), "{error}");
    let out = here.done(&["study", "correct", "s.db", "1", "--by", "A"]);
    assert!(out.contains("Reading 6 is a copy of reading 1"), "{out}");
    assert!(state("6").ends_with("open, corrects 1"), "{}", listed());
    let withdraw = |reason| ["study", "withdraw", "s.db", "2", "--reason", reason, "--by", "lead"];
    assert!(here.refused(&withdraw(" "), 3).contains("has no reason"));
    here.done(&withdraw("T6 lies on T7"));
    assert!(state("2").ends_with("withdrawn"), "{}", listed());
    let (_, notes, _) = here.run(&["study", "export", "s.db", study]);
    assert!(notes.contains("withdrawn by lead") && notes.contains("T6 lies on T7"), "{notes}");
    let out = here.done(&["study", "withdraw", "s.db", "1", "--reason", "another patient"]);
    assert!(out.contains("Reading 6, its open correction, is withdrawn too"), "{out}");
    assert!(state("6").ends_with("withdrawn, corrects 1"), "{}", listed());

    here.done(&["study", "rename", "s.db", study, "before brace"]);
    here.done(&["study", "archive", "s.db", study]);
    assert!(here.done(&["study", "list", "s.db"]).contains("(synthetic, archived)"));
    let error = here.refused(&["study", "rename", "s.db", study, ""], 3);
    assert!(error.contains("archived") && error.contains("archive --undo"), "{error}");
    let again = here.refused(&["study", "archive", "s.db", study], 3);
    assert!(again.contains("is archived: nothing in it can be changed"), "{again}");
    here.done(&["study", "archive", "s.db", study, "--undo"]);
    let again = here.refused(&["study", "archive", "s.db", study, "--undo"], 3);
    assert!(again.contains("is not archived"), "{again}");
    let out = here.done(&["study", "rename", "s.db", study, "  "]);
    assert!(out.contains("has no label now"), "{out}");
    let label = Store::view(&here.path("s.db")).and_then(|store| {
        let study = Name::new(study)?;
        store.study(&study)
    });
    assert_eq!(label.expect("a study").label, None);
    let log = here.done(&["study", "log", "s.db"]);
    for action in ["correct", "withdraw", "rename", "archive", "unarchive"] {
        assert!(log.split_whitespace().any(|word| word == action), "{action}: {log}");
    }
    assert_eq!(log.split_whitespace().filter(|word| word.ends_with("archive")).count(), 2, "{log}");
}

#[test]
fn texts_about_a_store_fit_a_terminal_and_a_store_is_not_a_case() {
    let here = store();
    for command in ["list", "verify"] {
        let out = here.done(&["study", command, "s.db"]);
        assert!(out.lines().all(|line| line.chars().count() <= 100), "{out}");
    }
    // Programs get one line per entry, with whole words and whole hashes of films.
    let by = "reader-of-the-second-hospital";
    let mut case = here.json("p/phantom-rod-01.json");
    case["case_id"] = "second".into();
    here.write("p/second.json", case.to_string());
    here.done(&["study", "add", "s.db", "p/second.json", "--by", by]);
    let log = here.done(&["study", "log", "s.db"]);
    assert!(log.lines().skip(2).all(|line| line.contains('Z')) && log.contains(by), "{log}");
    let erect = format!("content/{}", spineline_files::sha256_hex(b"erect"));
    assert!(log.split_whitespace().any(|word| word == erect), "{log}");
    let error = here.refused(&["analyze", "s.db"], 3);
    assert!(
        error.contains("a study store") && error.contains("`spineline study export"),
        "{error}"
    );
}

#[test]
fn an_observer_sees_only_a_code() {
    let here = store();
    // A study that was read has no plan any more; one without readings gets one.
    let mut case = here.json("p/phantom-rod-01.json");
    case["case_id"] = "blind".into();
    for film in case["films"].as_array_mut().expect("films") {
        film["readings"] = serde_json::Value::Array(Vec::new());
    }
    here.write("p/blind.json", case.to_string());
    here.done(&["study", "add", "s.db", "p/blind.json"]);
    let alike = here.done(&["study", "plan", "s.db", "blind", "--observers", "A,a"]);
    assert!(alike.contains("`A` and `a` count as 2 observers"), "{alike}");
    let plan = ["study", "plan", "s.db", "blind", "--observers", "A, B", "--repeats", "2"];
    let out = here.done(&plan);
    assert!(out.contains("Planned 20 readings") && out.contains("the earlier plan"), "{out}");
    let (out, _, _) = here.run(&["study", "next", "s.db", "blind", "--observer", "A"]);
    assert!(out.starts_with("Next: film "), "{out}");
    for word in ["erect", "bending", "neutral", "traction", "repeat"] {
        assert!(!out.contains(word), "{out}");
    }
    let (out, error, code) = here.run(&["study", "next", "s.db", "blind", "--observer", "Typo"]);
    assert_eq!((out.as_str(), code), ("", 3), "{error}");
    assert!(error.contains("unknown observer `Typo`: the plan of blind has A, B"), "{error}");
    here.done(&["study", "archive", "s.db", "blind"]);
    let error = here.refused(&["study", "next", "s.db", "blind", "--observer", "A"], 3);
    assert!(error.contains("study blind is archived"), "{error}");
}

#[test]
fn a_case_whose_identifier_differs_in_capitals_alone_is_refused() {
    let here = store();
    let mut case = here.json("p/phantom-rod-01.json");
    case["case_id"] = "PHANTOM-rod-01".into();
    here.write("p/capitals.json", case.to_string());
    let error = here.refused(&["study", "add", "s.db", "p/capitals.json"], 3);
    assert!(error.contains("study/phantom-rod-01 exists already"), "{error}");
    assert!(error.contains("differs in more than upper and lower case"), "{error}");
}

#[test]
fn a_file_that_is_not_a_store_is_not_changed() {
    let here = folder();
    here.write("notes.txt", "notes");
    for command in ["create", "list", "verify", "log"] {
        let error = here.refused(&["study", command, "notes.txt"], 3);
        assert!(error.contains("notes.txt") && error.contains("help:"), "{error}");
    }
    assert_eq!(fs::read(here.path("notes.txt")).expect("still there"), b"notes");
    let error = here.refused(&["study", "list", "missing.db"], 3);
    assert!(error.contains("missing.db"), "{error}");
}

#[test]
fn a_film_of_another_case_is_refused_before_any_write() {
    let here = store();
    let text = here.text("p/phantom-rod-01.json").replace("phantom-rod-01", "other");
    here.write("p/phantom-rod-01.json", text);
    here.write("p/neutral.bin", "changed");
    let error = here.refused(&["study", "add", "s.db", "p/phantom-rod-01.json"], 3);
    assert!(error.contains("neutral film") && error.contains("SHA-256"), "{error}");
    assert!(!here.run(&["study", "list", "s.db"]).0.contains("other"));
}

#[test]
fn a_backup_beside_the_log_of_a_killed_server_is_refused_and_restore_puts_it_in_place() {
    let here = store();
    let at = |name: &str| here.path(name);
    here.done(&["study", "backup", "s.db", "copy.db"]);
    // Two changes that only the log holds, as a killed server leaves them.
    let by =
        Signature::new(Name::new("lead").expect("a name"), std::time::SystemTime::now().into());
    let mut writer = Store::open(&at("s.db")).expect("a store");
    for id in ["T-1", "T-2"] {
        let id = Name::new(id).expect("a name");
        writer.add_study(&Study::new(id, None, true), &by).expect("a study");
    }
    let held = here.refused(&["study", "restore", "copy.db", "s.db"], 3);
    assert!(held.contains("another program has the store open"), "{held}");
    for (from, to) in [("copy.db", "k.db"), ("s.db-wal", "k.db-wal"), ("s.db-head", "k.db-head")] {
        fs::copy(at(from), at(to)).expect("a copy");
    }
    let files = || ["k.db", "k.db-wal"].map(|name| fs::read(at(name)).expect("a file"));
    let before = files();
    let add = ["study", "add", "k.db", "p/phantom-rod-01.json"];
    let account = ["account", "add", "A", "--role", "admin", "--password-stdin", "k.db"];
    let verify = ["study", "verify", "k.db"];
    for command in [&add[..], &account, &["serve", "k.db", "--port", "0"], &verify] {
        let error = here.refused(command, 3);
        assert!(error.contains("k.db-wal") && error.contains("study restore"), "{error}");
    }
    assert!(files() == before);
    let out = here.done(&["study", "restore", "copy.db", "k.db"]);
    assert!(
        out.contains("k.db was restored from copy.db") && out.contains("k.db.replaced-1"),
        "{out}"
    );
    let head = |store: &str| {
        let out = here.done(&["study", "verify", store]);
        out.split_whitespace().find(|word| word.len() > 64).expect("the end of the log").to_owned()
    };
    assert_eq!(head("k.db"), head("copy.db"));
    assert_eq!(fs::read(at("k.db.replaced-1-wal")).expect("the log"), before[1]);
}

#[test]
fn a_backup_that_cannot_be_restored_is_named_and_the_store_is_not() {
    let here = store();
    here.done(&["study", "backup", "s.db", "copy.db"]);
    let whole = fs::read(here.path("copy.db")).expect("the backup");
    here.write("cut.db", &whole[..whole.len() / 2]);
    for (backup, words) in
        [("cut.db", "cut.db: the backup is damaged"), ("no.db", "no.db: backup not found")]
    {
        let error = here.refused(&["study", "restore", backup, "s.db"], 3);
        assert!(
            error.starts_with(&format!("error: {words}; the store was not changed")),
            "{error}"
        );
        assert!(!error.contains("s.db"), "{error}");
    }
    here.done(&["study", "verify", "s.db"]);
}

#[test]
fn a_name_that_is_not_allowed_is_refused_with_its_option_and_value() {
    let here = folder();
    let plan = ["study", "plan", "s.db", "P07", "--observers", "A,Dr. B"];
    let error = here.refused(&plan, 2);
    assert!(error.contains("'Dr. B' for '--observers") && error.contains("S-017"), "{error}");
    let error = here.refused(&["study", "archive", "s.db", "P07", "--by", ""], 2);
    assert!(error.contains("'' for '--by"), "{error}");
}

#[test]
fn an_error_names_a_missing_store_once() {
    let here = folder();
    let error = here.refused(&["study", "list", "s.db"], 3);
    assert!(error.starts_with("error: s.db: store not found"), "{error}");
    assert!(error.contains("spineline study create"), "{error}");
}
