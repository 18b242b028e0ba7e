//! De-identification: a canary text, placed wherever a patient's name can be, is not in the output.

use std::collections::BTreeMap;

use dicom_object::{FileDicomObject, InMemDicomObject, OpenFileOptions};
use spineline_films::{
    DeidAction, DeidOptions, DeidReport, FilmError, FilmLimits, FilmRemark, StoredPixels,
    deidentify,
};
use spineline_marking::Stance;

use crate::maker::{
    BIG_ENDIAN, DEFLATED, EXPLICIT, IMPLICIT, JPEG_LOSSLESS_1, JPEG_LS, Maker, RLE, Syntax, Value,
    jpeg_lossless, jpeg_ls, ramp, rle, text,
};
use crate::reading::read;

const CANARY: &str = "KANARIENVOGEL";

fn options() -> DeidOptions {
    DeidOptions { case_id: "case-7".to_owned(), salt: [7; 32], retain_sex_and_age: false }
}

fn run(bytes: &[u8]) -> (Vec<u8>, DeidReport) {
    let done = deidentify(bytes, &options(), &FilmLimits::default()).unwrap();
    (done.bytes, done.report)
}

/// Attributes of the standard that a film often has, with their value representations.
const STANDARD: [((u16, u16), &str); 34] = [
    ((0x0008, 0x0005), "CS"),
    ((0x0008, 0x0008), "CS"),
    ((0x0008, 0x0012), "DA"),
    ((0x0008, 0x0020), "DA"),
    ((0x0008, 0x0050), "SH"),
    ((0x0008, 0x0070), "LO"),
    ((0x0008, 0x0080), "LO"),
    ((0x0008, 0x0090), "PN"),
    ((0x0008, 0x1030), "LO"),
    ((0x0008, 0x103E), "LO"),
    ((0x0010, 0x0010), "PN"),
    ((0x0010, 0x0020), "LO"),
    ((0x0010, 0x0030), "DA"),
    ((0x0010, 0x0040), "CS"),
    ((0x0010, 0x1010), "AS"),
    ((0x0010, 0x4000), "LT"),
    ((0x0012, 0x0063), "LO"),
    ((0x0018, 0x0015), "CS"),
    ((0x0018, 0x0060), "DS"),
    ((0x0018, 0x1000), "LO"),
    ((0x0018, 0x1164), "DS"),
    ((0x0018, 0x5101), "CS"),
    ((0x0020, 0x000D), "UI"),
    ((0x0020, 0x0010), "SH"),
    ((0x0020, 0x0013), "IS"),
    ((0x0020, 0x0020), "CS"),
    ((0x0020, 0x4000), "LT"),
    ((0x0028, 0x0030), "DS"),
    ((0x0028, 0x0106), "US"),
    ((0x0028, 0x1050), "DS"),
    ((0x0028, 0x1055), "LO"),
    ((0x2050, 0x0020), "CS"),
    ((0x7FE0, 0x0011), "OB"),
    ((0xFFFC, 0xFFFC), "OB"),
];

/// Texts in all value representations, at every unneeded attribute.
fn with_canaries() -> Maker {
    let mut maker = Maker::new(6, 4, &ramp(6, 4));
    let wide: Vec<u8> = CANARY.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let representations = [
        "AE", "AS", "AT", "CS", "DA", "DS", "DT", "FD", "FL", "IS", "LO", "LT", "OB", "OD", "OF",
        "OW", "PN", "SH", "SL", "SS", "ST", "TM", "UC", "UI", "UL", "UN", "UR", "US", "UT",
    ];
    for (number, vr) in (0_u16..).zip(representations) {
        // Standard, unknown, private, curve, overlay.
        for group in [0x0008, 0x0010, 0x0018, 0x0020, 0x0032, 0x0040, 0x0043, 0x5000, 0x6000] {
            maker.text((group, 0xEE00 + number), vr, CANARY);
        }
        maker.set((0x0011, 0x1000 + number), vr, Value::Bytes(wide.clone()));
    }
    for (tag, vr) in STANDARD {
        maker.text(tag, vr, CANARY);
    }
    let item = || -> BTreeMap<_, _> {
        [
            ((0x0008, 0x0100), ("SH", text(CANARY))),
            ((0x0008, 0x0104), ("LO", text(CANARY))),
            ((0x0010, 0x0010), ("PN", text(CANARY))),
            ((0x0028, 0x3002), ("US", text(CANARY))),
            ((0x0028, 0x3003), ("LO", text(CANARY))),
        ]
        .into()
    };
    for tag in
        [(0x0008, 0x1110), (0x0040, 0x0275), (0x0054, 0x0220), (0x0028, 0x3000), (0x0009, 0x1001)]
    {
        let mut nested = item();
        nested.insert((0x0040, 0xA730), ("SQ", Value::Items(vec![item()])));
        maker.set(tag, "SQ", Value::Items(vec![nested]));
    }
    // A known code with another text, and a whole table with an explanation.
    let mut code = item();
    code.insert((0x0008, 0x0100), ("SH", text("F-10440")));
    maker.set((0x0054, 0x0410), "SQ", Value::Items(vec![code]));
    let mut table = item();
    table.insert((0x28, 0x3002), ("US", Value::Words(vec![2, 0, 16])));
    table.insert((0x28, 0x3006), ("OW", Value::Words(vec![7, 9])));
    maker.set((0x0028, 0x3010), "SQ", Value::Items(vec![table]));
    maker.preamble[..CANARY.len()].copy_from_slice(CANARY.as_bytes());
    for (tag, vr) in [((2, 0x13), "SH"), ((2, 0x16), "AE"), ((2, 0x102), "OB")] {
        maker.meta.insert(tag, (vr, text(CANARY)));
    }
    maker
}

fn holds(bytes: &[u8], canary: &str) -> bool {
    let wide =
        |order: fn(u16) -> [u8; 2]| -> Vec<u8> { canary.encode_utf16().flat_map(order).collect() };
    let mut swapped = canary.as_bytes().to_vec();
    swapped.chunks_exact_mut(2).for_each(|pair| pair.swap(0, 1));
    [canary.as_bytes().to_vec(), swapped, wide(u16::to_le_bytes), wide(u16::to_be_bytes)]
        .iter()
        .any(|form| bytes.windows(form.len()).any(|window| window == form))
}

fn parsed(bytes: &[u8]) -> FileDicomObject<InMemDicomObject> {
    OpenFileOptions::new().from_reader(bytes).unwrap()
}

#[test]
fn f73_no_identity_text_remains_in_any_encoding() {
    let maker = with_canaries();
    for syntax in [IMPLICIT, EXPLICIT, BIG_ENDIAN, DEFLATED] {
        let file = maker.file(syntax);
        let (bytes, report) = run(&file);
        assert!(!holds(&bytes, CANARY), "{}", syntax.uid);
        assert!(!holds(&bytes, &CANARY[..5]), "{}", syntax.uid);
        assert!(!format!("{report:?}").contains(&CANARY[..5]));
        let (old, new) = (read(&file).unwrap(), read(&bytes).unwrap());
        assert_eq!(old.stored, new.stored);
        assert!(!format!("{old:?}{:?}", old.remarks).contains(&CANARY[..5]));
        assert_eq!(new.tags.view.stance, Some(Stance::Erect), "the erect patient is still erect");
        assert_eq!(new.tags.view.view_position, None, "a word that is not a term is removed");
        assert_eq!(new.look, old.look, "the table is still there");
        assert!(bytes[..128].iter().all(|&b| b == 0), "F15");
        let action = |tag| report.entries.iter().find(|e| e.attribute == tag).map(|e| e.action);
        use spineline_films::Attribute as A;
        assert_eq!(action(A(0x10, 0x10)), Some(DeidAction::Replaced));
        assert_eq!(action(A(0x10, 0x30)), Some(DeidAction::Emptied));
        assert_eq!(action(A(0x10, 0x4000)), Some(DeidAction::Removed));
        assert_eq!(action(A(0x43, 0xEE00)), Some(DeidAction::Removed));
        assert_eq!(action(A(0x12, 0x64)), Some(DeidAction::Added));
    }
}

#[test]
fn no_error_and_no_debug_text_contains_an_identity_text() {
    let file = with_canaries().file(EXPLICIT);
    for end in (0..file.len()).step_by(7) {
        let error = match deidentify(&file[..end], &options(), &FilmLimits::default()) {
            Ok(done) => {
                assert!(!holds(&done.bytes, CANARY));
                continue;
            }
            Err(error) => error,
        };
        assert!(!format!("{error} {error:?} {}", error.help()).contains(&CANARY[..5]));
    }
}

#[test]
fn another_program_reads_the_deidentified_file_and_its_codes() {
    let mut maker = with_canaries();
    maker.text((0x10, 0x40), "CS", "F").text((0x10, 0x1010), "AS", "093Y");
    maker.text((0x18, 0x1164), "DS", "0.15\\0.15").text((0x20, 0x20), "CS", "L\\F");
    for (retain, codes, age) in
        [(false, vec!["113100"], None), (true, vec!["113100", "113108"], Some("090Y"))]
    {
        let options = DeidOptions { retain_sex_and_age: retain, ..options() };
        let done = deidentify(&maker.file(EXPLICIT), &options, &FilmLimits::default()).unwrap();
        let object = parsed(&done.bytes);
        let text =
            |name: &str| object.element_by_name(name).unwrap().to_str().unwrap().into_owned();
        assert_eq!((text("PatientName"), text("PatientID")), ("case-7".into(), "case-7".into()));
        assert_eq!(text("PatientIdentityRemoved"), "YES");
        assert_eq!(text("LongitudinalTemporalInformationModified"), "REMOVED");
        assert_eq!(text("ImagerPixelSpacing"), "0.15\\0.15");
        assert_eq!(text("PatientOrientation"), "L\\F");
        let items =
            object.element_by_name("DeidentificationMethodCodeSequence").unwrap().items().unwrap();
        let found: Vec<String> = items
            .iter()
            .map(|item| item.element_by_name("CodeValue").unwrap().to_str().unwrap().into_owned())
            .collect();
        assert_eq!(found, codes);
        let found =
            object.element_by_name("PatientAge").ok().map(|e| e.to_str().unwrap().into_owned());
        assert_eq!(found.as_deref(), age);
        assert_eq!(object.meta().media_storage_sop_instance_uid(), text("SOPInstanceUID"));
    }
}

#[test]
fn uids_are_consistent_within_a_study_and_depend_on_the_salt() {
    let uids = |salt: u8, instance: &str| {
        let mut maker = Maker::new(6, 4, &ramp(6, 4));
        maker.text((8, 0x18), "UI", instance);
        let options = DeidOptions { salt: [salt; 32], ..options() };
        let done = deidentify(&maker.file(EXPLICIT), &options, &FilmLimits::default()).unwrap();
        read(&done.bytes).unwrap().tags.uids
    };
    let (a, b, c) = (uids(1, "1.2.3"), uids(1, "1.2.4"), uids(2, "1.2.3"));
    assert_eq!(a.study_instance, b.study_instance);
    assert_ne!(a.sop_instance, b.sop_instance);
    assert_ne!(a.sop_instance, c.sop_instance);
    assert_eq!(a.sop_class.as_deref(), Some("1.2.840.10008.5.1.4.1.1.1"));
    let uid = a.sop_instance.unwrap();
    assert!(uid.starts_with("2.25.") && uid.len() <= 64);
    assert!(!format!("{:?}", options()).contains("7, 7"), "the salt is a secret");
}

#[test]
fn compressed_pixels_are_copied_exactly_without_surplus_bytes() {
    let pixels = ramp(6, 4);
    let coded = jpeg_lossless(6, 4, 12, &pixels, 1, 0, 0);
    let mut maker = Maker::new(6, 4, &pixels);
    let (bytes, report) = run(&maker.fragments(vec![coded.clone()]).file(JPEG_LOSSLESS_1));
    assert!(bytes.windows(coded.len()).any(|window| window == coded));
    assert_eq!(read(&bytes).unwrap().stored, StoredPixels::Unsigned(pixels.clone()));
    assert_eq!(report.remarks, []);
    // A comment of the codec, and words after its end.
    let comment = [&[0xFF, 0xFE, 0, CANARY.len() as u8 + 2][..], CANARY.as_bytes()].concat();
    let mut talking = coded.clone();
    talking.splice(2..2, comment);
    talking.extend(CANARY.as_bytes());
    let (bytes, _) = run(&maker.fragments(vec![talking]).file(JPEG_LOSSLESS_1));
    assert!(!holds(&bytes, CANARY));
    assert_eq!(read(&bytes).unwrap().stored, StoredPixels::Unsigned(pixels.clone()));
    let mut raw: Vec<u8> = pixels.iter().flat_map(|p| p.to_le_bytes()).collect();
    raw.extend(CANARY.as_bytes());
    let mut maker = Maker::new(6, 4, &[]);
    maker.set((0x7FE0, 0x10), "OW", Value::Bytes(raw)).text((0x28, 0x301), "CS", "YES");
    let (bytes, report) = run(&maker.file(EXPLICIT));
    assert!(!holds(&bytes, CANARY));
    assert_eq!(report.remarks, [FilmRemark::BurnedIn]);
    maker.remove((0x28, 0x301));
    assert_eq!(run(&maker.file(EXPLICIT)).1.remarks, [FilmRemark::BurnedInUnknown]);
}

/// A ramp of 12 bits with a name in the four unused bits of each word.
fn with_name(shift: u32) -> Vec<u16> {
    let nibbles = CANARY.bytes().flat_map(|byte| [byte >> 4, byte & 15]);
    let mut words: Vec<u16> = ramp(6, 5).iter().map(|word| word << shift).collect();
    let name_at = if shift == 0 { 12 } else { 0 };
    for (word, nibble) in words.iter_mut().zip(nibbles) {
        *word |= u16::from(nibble) << name_at;
    }
    words
}

/// Whether the stored bytes hold the nibbles of the name at this place of their words.
fn nibbles_hold_name(bytes: &[u8]) -> bool {
    let nibbles: Vec<u8> = CANARY.bytes().flat_map(|byte| [byte >> 4, byte & 15]).collect();
    let of = |part: fn(u8) -> u8, from: usize| -> Vec<u8> {
        bytes[from..].iter().step_by(2).map(|&byte| part(byte)).collect()
    };
    let parts: [fn(u8) -> u8; 2] = [|byte| byte >> 4, |byte| byte & 15];
    let all = parts.into_iter().flat_map(|part| [of(part, 0), of(part, 1)]);
    all.into_iter().any(|found| found.windows(nibbles.len()).any(|window| window == nibbles))
}

#[test]
fn a_name_in_bits_that_hold_no_pixel_is_cleared() {
    for (shift, high) in [(0, 11), (4, 15)] {
        for representation in [0, 1] {
            for syntax in [IMPLICIT, EXPLICIT, BIG_ENDIAN, DEFLATED] {
                let words = with_name(shift);
                let mut maker = Maker::new(6, 5, &words);
                maker.word((0x28, 0x102), high).word((0x28, 0x103), representation);
                let file = maker.file(syntax);
                assert!(syntax == DEFLATED || nibbles_hold_name(&file), "the test means something");
                let (bytes, _) = run(&file);
                assert!(!nibbles_hold_name(&bytes), "{shift} {} {representation}", syntax.uid);
                assert_eq!(read(&bytes).unwrap().stored, read(&file).unwrap().stored);
            }
            let mut maker = Maker::new(6, 5, &[]);
            maker.word((0x28, 0x102), high).word((0x28, 0x103), representation);
            // Also text after the last run.
            let frame = [&rle(&with_name(shift))[..], CANARY.as_bytes()].concat();
            let file = maker.fragments(vec![frame]).file(RLE);
            let (bytes, _) = run(&file);
            let raw = read(&bytes).unwrap();
            assert_eq!(raw.stored, read(&file).unwrap().stored);
            assert_eq!(raw.remarks, []);
            assert!(!holds(&bytes, CANARY));
            // The same words without the name give the same file.
            let plain: Vec<u16> = ramp(6, 5).iter().map(|word| word << shift).collect();
            let plain = maker.fragments(vec![rle(&plain)]).file(RLE);
            assert_eq!(run(&plain).0, bytes);
        }
    }
    let mut maker = Maker::new(6, 5, &[]);
    maker.word((0x28, 0x100), 8).word((0x28, 0x101), 6).word((0x28, 0x102), 5);
    maker.set((0x7FE0, 0x10), "OB", Value::Bytes((0..30).map(|i| i | (i % 4) << 6).collect()));
    let (bytes, _) = run(&maker.file(EXPLICIT));
    assert_eq!(bytes[bytes.len() - 30..], (0..30).collect::<Vec<u8>>());
}

#[test]
fn a_compressed_film_with_a_name_in_bits_that_hold_no_pixel_is_refused() {
    let words = with_name(0);
    for (syntax, coded) in [
        (JPEG_LS, jpeg_ls(6, 5, 16, &words)),
        (JPEG_LOSSLESS_1, jpeg_lossless(6, 5, 16, &words, 1, 0, 0)),
    ] {
        let file = Maker::new(6, 5, &[]).fragments(vec![coded]).file(syntax);
        let error = deidentify(&file, &options(), &FilmLimits::default()).unwrap_err();
        assert_eq!(error, FilmError::HiddenBits { bits_stored: 12 });
        assert!(error.to_string().contains("12 bits") && error.help().contains("uncompressed"));
    }
    // A codec of 16 bits with 12-bit values is accepted.
    let file = Maker::new(6, 5, &[]).fragments(vec![jpeg_ls(6, 5, 16, &ramp(6, 5))]).file(JPEG_LS);
    assert_eq!(read(&run(&file).0).unwrap().stored, StoredPixels::Unsigned(ramp(6, 5)));
}

#[test]
fn pictures_become_plain_png_files() {
    let grey: Vec<u8> = (0..12).collect();
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new(&mut jpeg)
        .encode(&grey, 4, 3, image::ExtendedColorType::L8)
        .unwrap();
    // A comment right after the start of the image.
    let mut comment = vec![0xFF, 0xFE, 0, CANARY.len() as u8 + 2];
    comment.extend(CANARY.as_bytes());
    jpeg.splice(2..2, comment);
    let (bytes, _) = run(&jpeg);
    assert!(!holds(&bytes, CANARY));
    assert_eq!(read(&bytes).unwrap().stored, read(&jpeg).unwrap().stored);
    let words: Vec<u16> = (0..12).map(|i| i * 5000).collect();
    let picture = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(4, 3, words.clone()).unwrap();
    let mut tiff = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut tiff, image::ImageFormat::Tiff).unwrap();
    let (bytes, _) = run(tiff.get_ref());
    assert_eq!(read(&bytes).unwrap().stored, StoredPixels::Unsigned(words));
}

#[test]
fn a_case_identifier_is_a_short_word() {
    let file = Maker::new(6, 4, &ramp(6, 4)).file(Syntax { ..EXPLICIT });
    for case_id in ["", "a b", "Ä", "x\\y", &"x".repeat(65)] {
        let options = DeidOptions { case_id: case_id.to_owned(), ..options() };
        let result = deidentify(&file, &options, &FilmLimits::default());
        assert_eq!(result.unwrap_err(), FilmError::CaseId);
    }
}
