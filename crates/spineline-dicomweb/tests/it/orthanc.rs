//! The same with Orthanc, if it is installed.

use spineline_dicomweb::{Archive, Client, FilmUid, Search, SearchKey};

use crate::answers::LIMITS;
use crate::orthanc_program::Orthanc;

#[test]
fn a_film_is_found_and_retrieved_from_orthanc() {
    let Some(orthanc) = Orthanc::start() else { return };
    let archive = Archive::parse(&format!("archive={}", orthanc.address()))
        .and_then(|archive| archive.with_login("films:secret"))
        .expect("an archive");
    let client = Client::new(LIMITS);
    let search = Search::new(SearchKey::PatientId, "P-07").expect("a search");
    assert_eq!(client.search(&archive, &search).expect("an answer").all, []);
    let sent = dicom_file();
    orthanc.store(&sent);
    let found = client.search(&archive, &search).expect("series");
    let [series] = &found.all[..] else { panic!("{found:?}") };
    assert_eq!(series.modality.as_deref(), Some("DX"));
    let other = Search::new(SearchKey::PatientId, "P-0").expect("a search");
    assert_eq!(client.search(&archive, &other).expect("an answer").all, []);
    let films = client.films(&archive, &series.uid()).expect("films");
    let [film] = &films.all[..] else { panic!("{films:?}") };
    assert_eq!((film.columns, film.rows), (Some(2), Some(1)));
    let uid = FilmUid::new(series.uid(), &film.instance).expect("a UID");
    let bytes = client.retrieve(&archive, &uid).expect("a film");
    assert_eq!(bytes, sent);
}

/// A film of two pixels in explicit little endian.
fn dicom_file() -> Vec<u8> {
    let element = |[group, element]: [u16; 2], vr: &[u8; 2], value: &[u8]| -> Vec<u8> {
        let length = u16::try_from(value.len()).expect("short");
        let long: Vec<u8> = if vr == b"OW" || vr == b"OB" {
            [&[0, 0][..], &u32::from(length).to_le_bytes()].concat()
        } else {
            length.to_le_bytes().to_vec()
        };
        [&group.to_le_bytes()[..], &element.to_le_bytes(), vr, &long, value].concat()
    };
    let class = b"1.2.840.10008.5.1.4.1.1.1.1\0";
    let meta = [
        element([2, 1], b"OB", &[0, 1]),
        element([2, 2], b"UI", class),
        element([2, 3], b"UI", b"1.2.3.45"),
        element([2, 0x10], b"UI", b"1.2.840.10008.1.2.1\0"),
        element([2, 0x12], b"UI", b"1.2.3.99"),
    ]
    .concat();
    let length = u32::try_from(meta.len()).expect("short").to_le_bytes();
    let word = |value: u16| value.to_le_bytes();
    let data = [
        element([8, 0x16], b"UI", class),
        element([8, 0x18], b"UI", b"1.2.3.45"),
        element([8, 0x60], b"CS", b"DX"),
        element([0x10, 0x10], b"PN", b"DOE^JANE"),
        element([0x10, 0x20], b"LO", b"P-07"),
        element([0x20, 0xD], b"UI", b"1.2.3\0"),
        element([0x20, 0xE], b"UI", b"1.2.3.4\0"),
        element([0x28, 2], b"US", &word(1)),
        element([0x28, 4], b"CS", b"MONOCHROME2 "),
        element([0x28, 0x10], b"US", &word(1)),
        element([0x28, 0x11], b"US", &word(2)),
        element([0x28, 0x100], b"US", &word(16)),
        element([0x28, 0x101], b"US", &word(16)),
        element([0x28, 0x102], b"US", &word(15)),
        element([0x28, 0x103], b"US", &word(0)),
        element([0x7FE0, 0x10], b"OW", &[1, 2, 3, 4]),
    ];
    [&[0; 128][..], b"DICM", &element([2, 0], b"UL", &length), &meta, &data.concat()].concat()
}
