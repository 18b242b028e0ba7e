//! Damaged, unusual and malicious files.

use spineline_films::{
    Attribute, Codec, CodecFault, ElementFault, FilmError, FilmKind, FilmLimits, FilmRemark,
    Lookalike, Measure, UnsupportedPhotometric, read_data_set, read_film,
};

use crate::maker::{
    BIG_ENDIAN, DEFLATED, EXPLICIT, IMPLICIT, JPEG_2000, JPEG_LOSSLESS_1, JPEG_LS, Maker, RLE,
    Syntax, Value, jpeg_lossless, jpeg_ls, ramp, rle, text,
};
use crate::reading::read;

const PIXEL_DATA: Attribute = Attribute(0x7FE0, 0x0010);

fn small() -> Maker {
    Maker::new(6, 4, &ramp(6, 4))
}

#[test]
fn f1_a_truncated_film_is_an_error_or_the_same_picture() {
    let pixels = ramp(6, 4);
    let packed = |fragment| small().fragments(vec![fragment]).clone();
    let mut odd = small();
    odd.set(
        (0x28, 0x3010),
        "SQ",
        Value::Items(vec![[((0x28, 0x3002), ("US", text("ab")))].into()]),
    );
    odd.text((0xFFFC, 0xFFFC), "OB", "some padding at the end");
    for file in [
        small().file(IMPLICIT),
        small().file(EXPLICIT),
        small().file(DEFLATED),
        odd.file(EXPLICIT),
        packed(rle(&pixels)).file(RLE),
        packed(jpeg_ls(6, 4, 12, &pixels)).file(JPEG_LS),
        packed(jpeg_lossless(6, 4, 12, &pixels, 1, 0, 0)).file(JPEG_LOSSLESS_1),
    ] {
        let whole = read(&file).unwrap();
        for end in 0..file.len() {
            if let Ok(film) = read(&file[..end]) {
                assert_eq!(film.stored, whole.stored, "cut at {end} of {}", file.len());
            }
        }
    }
}

#[test]
fn f1_truncated_or_damaged_compressed_pixels_do_not_panic() {
    let pixels = ramp(6, 4);
    let coded: [(Syntax, Vec<u8>); 3] = [
        (RLE, rle(&pixels)),
        (JPEG_LS, jpeg_ls(6, 4, 12, &pixels)),
        (JPEG_LOSSLESS_1, jpeg_lossless(6, 4, 12, &pixels, 4, 0, 0)),
    ];
    let mut refused = 0;
    for (syntax, bytes) in coded {
        for end in 0..bytes.len() {
            let file = small().fragments(vec![bytes[..end].to_vec()]).file(syntax);
            refused += usize::from(read(&file).is_err());
            for bit in 0..8 {
                let mut turned = bytes.clone();
                turned[end] ^= 1 << bit;
                if let Ok(film) = read(&small().fragments(vec![turned]).file(syntax)) {
                    assert_eq!(film.stored.len(), 24);
                }
            }
        }
    }
    assert!(refused > 100, "{refused}");
}

#[test]
fn a_picture_where_a_data_set_is_needed_is_named_as_one_and_not_as_truncated() {
    let mut file = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(3, 2).write_to(&mut file, image::ImageFormat::Png).unwrap();
    let error = read_data_set(file.get_ref()).unwrap_err();
    assert_eq!(error, FilmError::NotDicom { kind: FilmKind::Png });
    assert!(error.to_string().contains("a PNG picture"), "{error}");
    assert!(matches!(read_data_set(b"text"), Err(FilmError::NotAFilm { .. })));
    assert!(read_data_set(&small().file(EXPLICIT)).is_ok());
}

#[test]
fn f2_lengths_beyond_the_file_are_reported() {
    let mut maker = small();
    maker.text((0x0008, 0x0005), "CS", "ISO_IR 100");
    for length in [0x2020_2020_u32, 0xFFFF_FFFE, 0x7FFF_FFFF] {
        let mut file = maker.body(IMPLICIT);
        file[4..8].copy_from_slice(&length.to_le_bytes());
        let mut whole = small().file(IMPLICIT);
        whole.truncate(whole.len() - small().body(IMPLICIT).len());
        whole.extend(&file);
        let error = read(&whole).unwrap_err();
        let FilmError::Length { attribute, length: found, .. } = error else { panic!("{error:?}") };
        assert_eq!((attribute, found), (Attribute(0x0008, 0x0005), u64::from(length)));
    }
    // An undefined length outside of a sequence.
    let mut file = small().file(EXPLICIT);
    let pixels = file.windows(6).rposition(|w| w == [0xE0, 0x7F, 0x10, 0, b'O', b'W']).unwrap();
    file[pixels + 2] = 0x11;
    file[pixels + 8..pixels + 12].fill(0xFF);
    let fault = ElementFault::UndefinedLength;
    assert_eq!(
        read(&file).unwrap_err(),
        FilmError::Element { attribute: Attribute(0x7FE0, 0x11), fault }
    );
    // An odd length is accepted.
    let mut file = small().file(EXPLICIT);
    file[pixels + 8] += 1;
    file.push(0);
    assert!(read(&file).is_ok());
}

#[test]
fn f3_deeply_nested_sequences_do_not_overflow_the_stack() {
    for (private, known) in [(0x0009_u16, false), (0x0008, true)] {
        let mut file = small().file(IMPLICIT);
        for _ in 0..100_000 {
            file.extend(private.to_le_bytes());
            file.extend([0x40, 0x11, 0xFF, 0xFF, 0xFF, 0xFF]);
            file.extend([0xFE, 0xFF, 0x00, 0xE0, 0xFF, 0xFF, 0xFF, 0xFF]);
        }
        let error = read(&file).unwrap_err();
        let limit = 16;
        assert_eq!(
            error,
            FilmError::TooLarge { what: Measure::Depth, found: 17, limit },
            "{known}"
        );
    }
    // Flat, but too many.
    let mut file = small().file(IMPLICIT);
    (0..200_000).for_each(|_| file.extend([9, 0, 1, 0x10, 0, 0, 0, 0]));
    let error = read(&file).unwrap_err();
    assert!(matches!(error, FilmError::TooLarge { what: Measure::Elements, .. }), "{error}");
}

#[test]
fn f4_rows_and_columns_are_checked_before_anything_is_allocated() {
    let with = |rows, columns| {
        read(&small().word((0x28, 0x10), rows).word((0x28, 0x11), columns).file(EXPLICIT))
    };
    let found = 65535 * 65535;
    let limit = 100_000_000;
    let too_large = FilmError::TooLarge { what: Measure::Pixels, found, limit };
    assert_eq!(with(65535, 65535).unwrap_err(), too_large);
    let attribute = Attribute(0x28, 0x10);
    assert_eq!(with(0, 6).unwrap_err(), FilmError::PixelFormat { attribute, value: 0 });
    let (needed, found) = (60_000_000, 48);
    assert_eq!(with(5000, 6000).unwrap_err(), FilmError::PixelsMissing { needed, found });
    let mut wide = small();
    wide.set((0x28, 0x10), "UL", Value::Words(vec![4, 0]));
    let fault = ElementFault::Value;
    for syntax in [EXPLICIT, IMPLICIT] {
        assert_eq!(read(&wide.file(syntax)).unwrap_err(), FilmError::Element { attribute, fault });
    }
    let limits = FilmLimits { file_bytes: 100, ..FilmLimits::default() };
    let error = read_film(&small().file(EXPLICIT), &limits).unwrap_err();
    assert!(matches!(error, FilmError::TooLarge { what: Measure::FileBytes, .. }));
}

#[test]
fn f5_pixel_data_longer_than_declared_gets_a_remark_and_shorter_an_error() {
    let film = read(&small().word((0x28, 0x10), 3).file(EXPLICIT)).unwrap();
    assert_eq!(film.remarks, [FilmRemark::PixelsLeftOver { bytes: 12 }]);
    let (needed, found) = (60, 48);
    let error = read(&small().word((0x28, 0x10), 5).file(EXPLICIT)).unwrap_err();
    assert_eq!(error, FilmError::PixelsMissing { needed, found });
    let missing = PIXEL_DATA;
    let error = read(&small().remove((0x7FE0, 0x10)).file(EXPLICIT)).unwrap_err();
    assert_eq!(error, FilmError::NoPixels { missing });
}

#[test]
fn f6_unknown_syntaxes_and_codec_bombs_are_refused_from_their_headers() {
    let uid = "1.2.840.10008.1.2.4.110";
    let error = read(&small().file(Syntax { uid, ..EXPLICIT })).unwrap_err();
    assert_eq!(error, FilmError::TransferSyntax { uid: Some(uid.to_owned()) });
    let error = read(&small().file(Syntax { uid: "Doe^John", ..EXPLICIT })).unwrap_err();
    assert_eq!(error, FilmError::TransferSyntax { uid: None });
    // Two gigapixels in headers of a few bytes.
    let bomb = |mut coded: Vec<u8>, at: usize| {
        coded[at..at + 4].fill(0xFF);
        coded
    };
    let pixels = ramp(6, 4);
    let stated = [6, 4];
    let coded = [65535, 65535];
    let fault = CodecFault::Size { coded, stated };
    let lossless = bomb(jpeg_lossless(6, 4, 12, &pixels, 1, 0, 0), 7);
    let error = read(&small().fragments(vec![lossless]).file(JPEG_LOSSLESS_1)).unwrap_err();
    assert_eq!(error, FilmError::Codec { codec: Codec::JpegLossless, fault });
    let ls = bomb(jpeg_ls(6, 4, 12, &pixels), 7);
    let error = read(&small().fragments(vec![ls]).file(JPEG_LS)).unwrap_err();
    assert_eq!(error, FilmError::Codec { codec: Codec::JpegLs, fault });
    let mut wavelets = vec![0xFF, 0x4F, 0xFF, 0x51, 0, 41, 0, 0];
    for word in [65535_u32, 65535, 0, 0, 65535, 65535, 0, 0] {
        wavelets.extend(word.to_be_bytes());
    }
    wavelets.extend([0, 1, 11, 1, 1]);
    let error = read(&small().fragments(vec![wavelets.clone()]).file(JPEG_2000)).unwrap_err();
    assert_eq!(error, FilmError::Codec { codec: Codec::Jpeg2000, fault });
    // The right size, in tiles of one pixel: the 24 tiles are accepted, and the stream ends early; no crash.
    for (at, value) in [(8, 6_u32), (12, 4), (24, 1), (28, 1)] {
        wavelets[at..at + 4].copy_from_slice(&value.to_be_bytes());
    }
    let error = read(&small().fragments(vec![wavelets]).file(JPEG_2000)).unwrap_err();
    assert!(matches!(error, FilmError::Codec { codec: Codec::Jpeg2000, .. }), "{error}");
    // Zeros compress by a factor of 1000.
    let mut maker = small();
    maker.set((0x0009, 0x1010), "OB", Value::Bytes(vec![0; 1 << 20]));
    let limits = FilmLimits { inflated_bytes: 1 << 16, ..FilmLimits::default() };
    let error = read_film(&maker.file(DEFLATED), &limits).unwrap_err();
    assert!(matches!(error, FilmError::TooLarge { what: Measure::InflatedBytes, .. }), "{error}");
}

#[test]
fn f7_frames_palettes_and_unusual_bit_depths_are_named() {
    let error = |maker: &mut Maker| read(&maker.file(EXPLICIT)).unwrap_err();
    assert_eq!(error(small().text((0x28, 8), "IS", "30")), FilmError::Frames { frames: 30 });
    assert_eq!(error(small().text((0x28, 8), "IS", "1A")), FilmError::Frames { frames: 0 });
    assert!(read(&small().text((0x28, 8), "IS", "1").file(EXPLICIT)).is_ok());
    let photometric = UnsupportedPhotometric::Palette;
    assert_eq!(
        error(small().text((0x28, 4), "CS", "PALETTE COLOR")),
        FilmError::Photometric { photometric }
    );
    let photometric = UnsupportedPhotometric::Deep;
    let mut colour = small();
    colour.text((0x28, 4), "CS", "RGB").word((0x28, 2), 3);
    assert_eq!(error(&mut colour), FilmError::Photometric { photometric });
    let missing = Attribute(0x28, 0x101);
    assert_eq!(error(small().remove((0x28, 0x101))), FilmError::NoPixels { missing });
    let attribute = Attribute(0x28, 0x100);
    for value in [1, 12, 32, 0] {
        let found = error(small().word((0x28, 0x100), value));
        assert_eq!(found, FilmError::PixelFormat { attribute, value: u32::from(value) });
    }
    for (element, value) in
        [(0x101, 17), (0x101, 0), (0x102, 16), (0x102, 5), (0x103, 2), (0x002, 3)]
    {
        let found = error(small().word((0x28, element), value));
        let attribute = Attribute(0x28, element);
        assert_eq!(found, FilmError::PixelFormat { attribute, value: u32::from(value) });
    }
}

#[test]
fn f10_zero_spacings_are_passed_to_the_core_unchanged() {
    let film = read(&small().text((0x28, 0x30), "DS", "0.000\\0.000").file(EXPLICIT)).unwrap();
    assert_eq!(film.tags.spacing.pixel_mm, Some([0.0, 0.0]));
    assert_eq!(spineline_marking::judge_spacing(&film.tags.spacing).spacing, None);
    let film = read(&small().text((0x28, 0x30), "DS", "0.1\\0.2").file(EXPLICIT)).unwrap();
    assert_eq!(film.tags.spacing.pixel_mm, Some([0.1, 0.2]), "rows first");
}

#[test]
fn f11_magnification_is_left_to_the_core() {
    let mut maker = small();
    maker.text((0x18, 0x1164), "DS", "0.1\\0.1").text((0x18, 0x1114), "DS", "0.9");
    let film = read(&maker.file(EXPLICIT)).unwrap();
    let judged = spineline_marking::judge_spacing(&film.tags.spacing);
    assert_eq!(judged.spacing.map(|s| s.plane), Some(spineline::measure::SpacingPlane::Detector));
}

#[test]
fn f13_long_and_non_latin_names_do_not_change_the_picture() {
    let whole = read(&small().file(EXPLICIT)).unwrap();
    for name in ["Ä\u{202E}\u{7}^".to_owned(), "X".repeat(65_000)] {
        let mut maker = small();
        maker.text((0x10, 0x10), "PN", &name).text((0x8, 0x5), "CS", "ISO 2022 IR 87");
        let film = read(&maker.file(EXPLICIT)).unwrap();
        assert_eq!(film.stored, whole.stored);
        assert!(!format!("{film:?}").contains(&name));
    }
}

#[test]
fn f15_a_preamble_of_another_format_does_not_change_the_detected_format() {
    let mut maker = small();
    maker.preamble[..4].copy_from_slice(b"II*\0");
    assert_eq!(read(&maker.file(EXPLICIT)).unwrap(), read(&small().file(EXPLICIT)).unwrap());
    maker.preamble[..2].copy_from_slice(b"MZ");
    assert!(read(&maker.file(EXPLICIT)).is_ok());
}

#[test]
fn f16_other_files_are_reported_with_their_likely_format() {
    for (bytes, looks_like) in [
        (&b""[..], Lookalike::Empty),
        (b"PK\x03\x04....", Lookalike::Zip),
        (b"%PDF-1.7 ....", Lookalike::Pdf),
        (b"\0\0\0\x18ftypheic", Lookalike::Heic),
        (b"MZ..........", Lookalike::Program),
        (b"<html>......", Lookalike::Text),
        (b"garbage", Lookalike::Unknown),
    ] {
        assert_eq!(read(bytes).unwrap_err(), FilmError::NotAFilm { looks_like });
    }
    for modality in ["CT", "RTPLAN"] {
        let error = read(&small().text((8, 0x60), "CS", modality).file(EXPLICIT)).unwrap_err();
        assert_eq!(error, FilmError::Modality { modality: Some(modality.to_owned()) });
        assert!(!error.help().is_empty());
    }
    let error = read(&small().text((8, 0x60), "CS", "DOE JOHN").file(EXPLICIT)).unwrap_err();
    assert_eq!(error, FilmError::Modality { modality: None });
}

#[test]
fn sequences_of_unknown_attributes_are_implicit_inside() {
    // VR UN with undefined length, and after it the film goes on.
    let mut maker = small();
    maker.set((0x0009, 0x1010), "UN", Value::Items(vec![]));
    let mut file = maker.file(EXPLICIT);
    let at = file.windows(6).position(|w| w == [9, 0, 0x10, 0x10, b'U', b'N']).unwrap() + 12;
    let item = [0xFE, 0xFF, 0, 0xE0, 10, 0, 0, 0, 9, 0, 1, 0x10, 2, 0, 0, 0, b'a', b'b'];
    file.splice(at..at, item);
    assert_eq!(read(&file).unwrap().stored, read(&small().file(EXPLICIT)).unwrap().stored);
}

#[test]
fn files_that_pass_the_scan_are_read_by_dicom_rs() {
    let code = || [((0x0008, 0x0100), ("SH", text("F-10440")))].into();
    let mut maker = small();
    maker.set((0x54, 0x410), "SQ", Value::Items(vec![code(), code()]));
    let mut table = std::collections::BTreeMap::new();
    table.insert((0x28, 0x3002), ("US", Value::Words(vec![2, 0, 16])));
    table.insert((0x28, 0x3006), ("OW", Value::Words(vec![7, 9])));
    table.insert((0x40, 0x410), ("SQ", Value::Items(vec![code()])));
    maker.set((0x28, 0x3010), "SQ", Value::Items(vec![table]));
    maker.set((0x18, 0x9999), "FD", Value::Words(vec![0; 8])).word((0x28, 0x120), 5);
    let packed = maker.clone().fragments(vec![vec![1; 10], vec![2; 10]]).clone();
    let mut read_well = 0;
    for (file, start) in [
        (maker.file(IMPLICIT), 132),
        (maker.file(EXPLICIT), 132),
        (maker.file(BIG_ENDIAN), 132),
        (packed.file(JPEG_LS), 132),
    ] {
        for at in start..file.len() {
            for value in [0, 1, 2, 3, 7, 0x20, 0x40, 0x55, 0x7F, 0x80, 0xFE, 0xFF, file[at] ^ 1] {
                let mut turned = file.clone();
                turned[at] = value;
                let film = read(&turned);
                assert_ne!(film, Err(FilmError::DataSet), "{value} at {at}");
                read_well += usize::from(film.is_ok());
            }
        }
    }
    assert!(read_well > 1000, "{read_well}");
}
