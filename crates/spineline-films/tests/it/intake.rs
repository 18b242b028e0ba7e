//! Search for films in folders and archives: faults F16, F63, F64 and F65.

use std::fs;
use std::io::Write;
use std::path::Path;

use spineline_films::intake::{IntakeError, IntakeLimits, Reason, Survey, read, survey};
use spineline_films::{FilmKind, Lookalike};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// The first bytes of a picture; a survey reads no more.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n and the rest";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn look(path: &Path) -> Survey {
    look_within(path, &IntakeLimits::default())
}

fn look_within(path: &Path, limits: &IntakeLimits) -> Survey {
    survey(&[path.to_owned()], limits, |_| ()).expect("the path exists")
}

fn reasons(survey: &Survey) -> Vec<&Reason> {
    survey.passed_over.iter().map(|passed| &passed.reason).collect()
}

fn archive(path: &Path, entries: &[(&str, &[u8])]) {
    let mut writer = ZipWriter::new(fs::File::create(path).expect("a new file"));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for (name, bytes) in entries {
        writer.start_file(*name, options).expect("an entry");
        writer.write_all(bytes).expect("its bytes");
    }
    writer.finish().expect("an archive");
}

#[test]
fn films_are_found_in_nested_folders_and_other_files_are_named() {
    let here = folder();
    fs::create_dir_all(here.path().join("a/b")).expect("folders");
    fs::write(here.path().join("a/b/one.png"), PNG).expect("a file");
    fs::write(here.path().join("a/notes.txt"), "<notes>").expect("a file");
    fs::write(here.path().join("report.pdf"), "%PDF-1.7").expect("a file");
    fs::write(here.path().join("empty.dcm"), "").expect("a file");
    // The kind follows from the bytes, not from the name.
    fs::write(here.path().join("z.txt"), [&[0; 128], b"DICM\0\0".as_slice()].concat())
        .expect("a file");
    let found = look(here.path());
    let kinds: Vec<FilmKind> = found.films.iter().map(|film| film.kind).collect();
    assert_eq!(kinds, [FilmKind::Png, FilmKind::Dicom]);
    assert_eq!(
        reasons(&found),
        [
            &Reason::NotAFilm(Lookalike::Text),
            &Reason::NotAFilm(Lookalike::Empty),
            &Reason::NotAFilm(Lookalike::Pdf)
        ]
    );
    let bytes = read(&found.films[0].place, &IntakeLimits::default()).expect("still there");
    assert_eq!(bytes, PNG);
}

#[test]
fn names_reserved_on_other_systems_are_accepted() {
    let here = folder();
    let long = format!("{}.png", "x".repeat(250));
    for name in ["CON", "nul.png", "..png", " .png", "Film.PNG", "film.png", "é\u{301}.png", &long]
    {
        fs::write(here.path().join(name), PNG).expect("a file");
    }
    assert_eq!(look(here.path()).films.len(), 8);
}

#[test]
#[cfg(unix)]
fn links_below_a_folder_are_not_followed() {
    use std::os::unix::fs::symlink;
    let here = folder();
    fs::create_dir(here.path().join("films")).expect("a folder");
    fs::write(here.path().join("films/one.png"), PNG).expect("a file");
    symlink(here.path(), here.path().join("films/loop")).expect("a link");
    symlink("/nowhere/at/all", here.path().join("films/broken")).expect("a link");
    let found = look(here.path());
    assert_eq!(found.films.len(), 1);
    assert_eq!(reasons(&found), [&Reason::NotPlain, &Reason::NotPlain]);
    // A given link is followed.
    symlink(here.path().join("films"), here.path().join("link")).expect("a link");
    assert_eq!(look(&here.path().join("link")).films.len(), 1);
}

#[test]
fn a_missing_path_is_an_error_and_not_an_empty_list() {
    let here = folder();
    let wrong = here.path().join("fils");
    let error = survey(&[wrong], &IntakeLimits::default(), |_| ()).expect_err("it is not there");
    assert!(matches!(error, IntakeError::Missing { .. }), "{error}");
    assert!(error.to_string().contains("fils"));
}

#[test]
fn limits_of_files_folders_and_sizes_are_reported() {
    let here = folder();
    let deep = here.path().join("1/2/3/4");
    fs::create_dir_all(&deep).expect("folders");
    fs::write(deep.join("deep.png"), PNG).expect("a file");
    fs::write(here.path().join("large.png"), [PNG, &[0; 2000]].concat()).expect("a file");
    let limits = IntakeLimits { depth: 2, entry_bytes: 1000, ..IntakeLimits::default() };
    let found = look_within(here.path(), &limits);
    assert!(found.films.is_empty());
    assert!(matches!(
        reasons(&found)[..],
        [Reason::TooDeep { limit: 2 }, Reason::TooLarge { limit: 1000, .. }]
    ));
    let limits = IntakeLimits { entries: 3, ..IntakeLimits::default() };
    let error = survey(&[here.path().to_owned()], &limits, |_| ()).expect_err("more than three");
    assert_eq!(error, IntakeError::TooMany { limit: 3 });
}

#[test]
fn films_are_read_from_archives_without_unpacking_to_disk() {
    let here = folder();
    let path = here.path().join("films.zip");
    let other = [PNG, b" and more"].concat();
    archive(&path, &[("a/one.png", PNG), ("notes.txt", b"<x>"), ("two.png", &other)]);
    let files = || fs::read_dir(here.path()).expect("a folder").count();
    let before = files();
    let found = look(here.path());
    assert_eq!(found.films.len(), 2);
    assert_eq!(read(&found.films[1].place, &IntakeLimits::default()).expect("there"), other);

    assert_eq!(before, files());
    // An entry is printed by its number: its name may be a patient's.
    assert!(found.films[1].place.to_string().ends_with("films.zip, entry 3"));
}

#[test]
fn names_that_point_outside_of_an_archive_are_skipped() {
    let here = folder();
    let path = here.path().join("traversal.zip");
    let names =
        ["../../etc/one.png", "/etc/two.png", "C:\\three.png", "a/../../four.png", "\\five.png"];
    let entries: Vec<(&str, &[u8])> = names.iter().map(|name| (*name, PNG)).collect();
    archive(&path, &entries);
    let found = look(&path);
    assert!(found.films.is_empty(), "{:?}", found.films);
    assert_eq!(reasons(&found), [&Reason::UnsafeName; 5]);
}

#[test]
fn an_archive_with_one_name_twice_is_refused_and_loses_no_film_silently() {
    let here = folder();
    let path = here.path().join("films.zip");
    let other = [PNG, b"another film"].concat();
    let names = ["erect.png", "other.png", "a/erect.png", "Erect.png"];
    for again in names {
        // The writer refuses a second entry of the same name, so the test renames one afterwards, in both places.
        let stand_in = "x".repeat(again.len());
        let entries: Vec<(&str, &[u8])> = names
            .iter()
            .map(|&name| (name, PNG))
            .chain([(stand_in.as_str(), &other[..])])
            .collect();
        archive(&path, &entries);
        let mut bytes = fs::read(&path).expect("an archive");
        for start in 0..bytes.len() - stand_in.len() {
            if bytes[start..].starts_with(stand_in.as_bytes()) {
                bytes[start..start + again.len()].copy_from_slice(again.as_bytes());
            }
        }
        fs::write(&path, bytes).expect("an archive");
        let found = look(&path);
        assert_eq!(found.films, [], "{again}");
        assert_eq!(reasons(&found), [&Reason::SameNames], "{again}");
    }
    // Names that differ only in capitals or folders are different.
    archive(&path, &names.map(|name| (name, PNG)));
    assert_eq!(look(&path).films.len(), names.len());
}

#[test]
fn a_nested_archive_is_not_opened() {
    let here = folder();
    let (inner, outer) = (here.path().join("inner.zip"), here.path().join("outer.zip"));
    archive(&inner, &[("one.png", PNG)]);
    archive(&outer, &[("inner.zip", &fs::read(&inner).expect("a file")), ("two.png", PNG)]);
    let found = look(&outer);
    assert_eq!(found.films.len(), 1);
    assert_eq!(reasons(&found), [&Reason::Nested]);
}

#[test]
fn an_archive_bomb_is_refused_by_declared_and_by_actual_size() {
    let here = folder();
    let path = here.path().join("bomb.zip");
    let zeros = [PNG, &vec![0; 4 << 20]].concat();
    archive(&path, &[("a.png", &zeros), ("b.png", &zeros), ("c.png", &zeros)]);
    assert!(fs::metadata(&path).expect("a file").len() < 100_000);
    let limits = IntakeLimits { archive_bytes: 9 << 20, ..IntakeLimits::default() };
    let found = look_within(&path, &limits);
    assert_eq!(found.films.len(), 2);
    assert!(matches!(reasons(&found)[..], [Reason::ArchiveTooLarge { .. }]));
    let limits = IntakeLimits { entry_bytes: 1 << 20, ..IntakeLimits::default() };
    let place = &found.films[0].place;
    assert!(matches!(
        read(place, &limits),
        Err(IntakeError::Gone { reason: Reason::TooLarge { .. }, .. })
    ));
}

#[test]
fn a_damaged_archive_does_not_stop_the_search() {
    let here = folder();
    let path = here.path().join("films.zip");
    archive(&path, &[("one.png", PNG), ("two.png", PNG)]);
    let whole = fs::read(&path).expect("a file");
    for length in 0..whole.len() {
        fs::write(&path, &whole[..length]).expect("a file");
        let found = look(&path);
        assert!(
            !found.films.is_empty() || !found.passed_over.is_empty(),
            "{length} bytes are lost"
        );
    }
    for (place, byte) in whole.iter().enumerate() {
        let mut broken = whole.clone();
        broken[place] = !byte;
        fs::write(&path, &broken).expect("a file");
        for film in look(&path).films {
            // Read or refused; a wrong checksum is refused.
            let _ = read(&film.place, &IntakeLimits::default());
        }
    }
}

#[test]
fn a_film_deleted_during_the_search_is_named() {
    let here = folder();
    let path = here.path().join("one.png");
    fs::write(&path, PNG).expect("a file");
    let found = look(here.path());
    fs::remove_file(&path).expect("it was there");
    let error = read(&found.films[0].place, &IntakeLimits::default()).expect_err("it is gone");
    assert!(error.to_string().contains("one.png: it cannot be read: no such file"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_folder_in_place_of_a_film_is_named_as_one() {
    let here = folder();
    let place = spineline_films::intake::Place::File(here.path().to_owned());
    let error = read(&place, &IntakeLimits::default()).expect_err("a folder");
    assert_eq!(error.help(), "name the film or the case file in the folder");
    let denied = Reason::Unreadable(std::io::ErrorKind::PermissionDenied);
    assert_eq!(IntakeError::Gone { place, reason: denied }.help(), "check that you may read it");
}
