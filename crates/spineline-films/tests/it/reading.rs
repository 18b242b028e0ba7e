//! Every encoding of one film gives the same pixels.

use spineline::measure::SpacingPlane;
use spineline_films::{
    Attribute, Codec, CodecFault, FilmError, FilmFile, FilmKind, FilmLimits, FilmRemark,
    StoredPixels, read_film,
};
use spineline_marking::{PatientDirection, Stance, View, ViewPosition, judge_spacing, judge_view};

use crate::maker::{
    BIG_ENDIAN, DEFLATED, EXPLICIT, HTJ2K, HTJ2K_LOSSY, HTJ2K_RPCL, IMPLICIT, JPEG, JPEG_EXTENDED,
    JPEG_LOSSLESS, JPEG_LOSSLESS_1, JPEG_LS, Maker, RLE, Value, jpeg_lossless, jpeg_ls, ramp, rle,
    text,
};

pub fn read(bytes: &[u8]) -> Result<FilmFile, FilmError> {
    read_film(bytes, &FilmLimits::default())
}

/// Not square, so that an exchange of rows and columns is noticed.
const COLUMNS: u16 = 37;
const ROWS: u16 = 23;

fn noise() -> Vec<u16> {
    // A linear congruential generator: differences of every size.
    let mut state = 12345_u32;
    let step = |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 20) as u16
    };
    (0..u32::from(COLUMNS) * u32::from(ROWS)).map(step).collect()
}

#[test]
fn every_lossless_encoding_gives_the_same_pixels() {
    for pixels in [ramp(COLUMNS, ROWS), noise()] {
        let maker = Maker::new(COLUMNS, ROWS, &pixels);
        let with = |fragment: Vec<u8>| {
            let mut maker = maker.clone();
            maker.fragments(vec![fragment]).clone()
        };
        let mut files = vec![
            ("implicit", maker.file(IMPLICIT)),
            ("explicit", maker.file(EXPLICIT)),
            ("big endian", maker.file(BIG_ENDIAN)),
            ("deflated", maker.file(DEFLATED)),
            ("RLE", with(rle(&pixels)).file(RLE)),
            ("JPEG-LS", with(jpeg_ls(COLUMNS, ROWS, 12, &pixels)).file(JPEG_LS)),
        ];
        for predictor in 1..=7 {
            let coded = jpeg_lossless(COLUMNS, ROWS, 12, &pixels, predictor, 0, 0);
            files.push(("JPEG lossless", with(coded).file(JPEG_LOSSLESS)));
            let coded = jpeg_lossless(COLUMNS, ROWS, 16, &pixels, predictor, 0, 0);
            files.push(("JPEG lossless of 16 bits", with(coded).file(JPEG_LOSSLESS_1)));
        }
        for (name, file) in files {
            let film = read(&file).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!((film.columns, film.rows), (37, 23), "{name}");
            assert_eq!(film.stored, StoredPixels::Unsigned(pixels.clone()), "{name}");
            assert_eq!(film.remarks, [], "{name}");
        }
    }
}

#[test]
fn fragments_of_a_picture_are_joined() {
    let pixels = noise();
    let coded = jpeg_lossless(COLUMNS, ROWS, 12, &pixels, 1, 0, 0);
    let (a, b) = coded.split_at(coded.len() / 2 / 2 * 2);
    let mut maker = Maker::new(COLUMNS, ROWS, &pixels);
    let film = read(&maker.fragments(vec![a.to_vec(), b.to_vec()]).file(JPEG_LOSSLESS_1)).unwrap();
    assert_eq!(film.stored, StoredPixels::Unsigned(pixels));
}

#[test]
fn lossless_jpeg_that_the_decoder_misreads_is_refused() {
    // Restart markers after three rows, and two dropped low bits.
    for (restart_rows, shift) in [(3, 0), (0, 2)] {
        let coded = jpeg_lossless(COLUMNS, ROWS, 12, &noise(), 1, restart_rows, shift);
        let mut maker = Maker::new(COLUMNS, ROWS, &noise());
        let error = read(&maker.fragments(vec![coded]).file(JPEG_LOSSLESS_1)).unwrap_err();
        let fault = CodecFault::Unsupported;
        assert_eq!(error, FilmError::Codec { codec: Codec::JpegLossless, fault });
    }
}

#[test]
fn jpeg_of_8_bits_is_read_within_tolerance_and_of_12_bits_is_refused() {
    let pixels: Vec<u16> = (0..64 * 32).map(|i| (i / 64 * 4) as u16).collect();
    let bytes: Vec<u8> = pixels.iter().map(|&p| p as u8).collect();
    let mut coded = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut coded, 98)
        .encode(&bytes, 64, 32, image::ExtendedColorType::L8)
        .unwrap();
    let mut maker = Maker::new(64, 32, &pixels);
    maker.word((0x28, 0x100), 8).word((0x28, 0x101), 8).word((0x28, 0x102), 7);
    let film = read(&maker.fragments(vec![coded.clone()]).file(JPEG)).unwrap();
    let largest = film.stored.iter().zip(&pixels).map(|(a, &b)| (a - i32::from(b)).abs()).max();
    assert!(largest <= Some(3), "{largest:?}");
    // The precision follows the start of frame.
    let frame = coded.windows(2).position(|pair| pair[0] == 0xFF && pair[1] == 0xC0).unwrap();
    coded[frame + 1] = 0xC1;
    coded[frame + 4] = 12;
    maker.word((0x28, 0x100), 16);
    let error = read(&maker.fragments(vec![coded]).file(JPEG_EXTENDED)).unwrap_err();
    let fault = CodecFault::LossyPrecision { bits: 12 };
    assert_eq!(error, FilmError::Codec { codec: Codec::Jpeg, fault });
    assert!(error.to_string().contains("12-bit lossy JPEG is not supported"), "{error}");
    assert!(error.help().contains("dcmdjpeg"), "{}", error.help());
}

/// The ramp of 13 × 9 pixels as OpenJPH 0.26.3 compresses it: header, then lengths of tile parts, then the tile.
const HT_HEADER: &str = "ff4fff51002940000000000d0000000900000000000000000000000d00000009000000000000000000010f0101ff50000800020000000a\
ff52000c00020001000204044001ff5c000a2088909090888888";
const HT_LENGTHS: &str = "ff55000a006000000000007d";
const HT_TILE: &str = "ff90000a00000000007d0001ff93c0002de0ff7ff7f0d7fe3ff0d7fea9fa90ff19fd1e7ef0fd7cdfb73f73420031b700c0001590000554\
000150bfdf5f0011402e30606fd900bffef7fb004080bfd600ff7e0000c06fd600c0002a600015b0000940feff7bec308c305600fefee1\
ff7ef0063811da305800fee8505400ffd9";
/// The same with losses.
const HT_LOSSY: &str = "ff4fff51002940000000000d0000000900000000000000000000000d00000009000000000000000000010f0101ff50000800020000002a\
ff52000c00020001000204044000ff5c0011229f8690039003904697d297d29761ff90000a0000000000ca0001ff93c0000ba2b9103c80\
1fca4028f7d50b3c49bf834085f347b237afce69debdfc3f735ac0d0b700c0001694000168c00015a00c76bc3181c55a7087003085e600\
81bf9900807682b5210150dc0820e300288011b6001b8084c854247d001181bf9600c00016ec000174d00005681022001648c86356e618\
e114be451ce1003ef267ddf0c5d7f85f0b7d00f070381c0e87c7c70b04ab64ad64f8a65b54e3bc609107380fe99040132c0003dd00006a\
30010b48e11a7a0519e820fca1d600ffd9";

fn from_hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().map(|c| (c as char).to_digit(16).unwrap() as u8).collect();
    digits.chunks(2).map(|pair| 16 * pair[0] + pair[1]).collect()
}

#[test]
fn high_throughput_jpeg_2000_is_read() {
    let pixels = ramp(13, 9);
    let file = |text: &str, syntax| {
        let mut stream = from_hex(text);
        if stream.len() % 2 == 1 {
            stream.push(0);
        }
        Maker::new(13, 9, &pixels).fragments(vec![stream]).file(syntax)
    };
    let plain = [HT_HEADER, HT_TILE].concat();
    let with_lengths = [HT_HEADER, HT_LENGTHS, HT_TILE].concat();
    for (text, syntax) in [(&plain, HTJ2K), (&with_lengths, HTJ2K_RPCL), (&plain, HTJ2K_LOSSY)] {
        let film =
            read(&file(text, syntax)).unwrap_or_else(|error| panic!("{}: {error}", syntax.uid));
        assert_eq!(film.stored, StoredPixels::Unsigned(pixels.clone()), "{}", syntax.uid);
    }
    let film = read(&file(HT_LOSSY, HTJ2K_LOSSY)).unwrap();
    let largest = film.stored.iter().zip(&pixels).map(|(a, &b)| (a - i32::from(b)).abs()).max();
    assert!(largest <= Some(2), "{largest:?}");
    // Single damaged bits give a picture of the right size, or an error.
    let whole = from_hex(&plain);
    for at in 0..8 * whole.len() {
        let mut damaged = whole.clone();
        damaged[at / 8] ^= 1 << (at % 8);
        let mut maker = Maker::new(13, 9, &pixels);
        if let Ok(film) = read(&maker.fragments(vec![damaged]).file(HTJ2K)) {
            assert_eq!(film.stored.len(), 13 * 9);
        }
    }
    // A truncated stream is an error; the decoder would invent the rest.
    let cut = &plain[..plain.len() - 40];
    let error = read(&file(cut, HTJ2K)).unwrap_err();
    let fault = CodecFault::Truncated;
    assert_eq!(error, FilmError::Codec { codec: Codec::Jpeg2000, fault });
}

#[test]
fn signed_pixels_and_high_bits_are_exact() {
    // 12 bits below the top of 16, two's complement.
    let pixels = [0x0010, 0x7FF0, 0x8000, 0xFFF0];
    let mut maker = Maker::new(2, 2, &pixels);
    maker.word((0x28, 0x102), 15).word((0x28, 0x103), 1);
    let film = read(&maker.file(EXPLICIT)).unwrap();
    assert_eq!(film.stored, StoredPixels::Signed(vec![1, 2047, -2048, -1]));
}

#[test]
fn eight_bit_pixels_in_big_endian_words_keep_their_order() {
    let mut maker = Maker::new(3, 1, &[]);
    maker.word((0x28, 0x100), 8).word((0x28, 0x101), 8).word((0x28, 0x102), 7);
    maker.set((0x7FE0, 0x10), "OW", Value::Words(vec![0x0201, 0x0003]));
    for syntax in [EXPLICIT, BIG_ENDIAN] {
        let film = read(&maker.file(syntax)).unwrap();
        assert_eq!(film.stored, StoredPixels::Unsigned(vec![1, 2, 3]));
    }
}

#[test]
fn grey_pictures_stored_in_colour_are_converted_with_a_remark() {
    let mut maker = Maker::new(2, 1, &[]);
    maker.word((0x28, 0x100), 8).word((0x28, 0x101), 8).word((0x28, 0x102), 7).word((0x28, 2), 3);
    for (photometric, planar, bytes) in [
        ("RGB", 0, vec![9, 9, 9, 200, 200, 200]),
        ("RGB", 1, vec![9, 200, 9, 200, 9, 200]),
        ("YBR_FULL", 0, vec![9, 128, 128, 200, 128, 128]),
    ] {
        maker.text((0x28, 4), "CS", photometric).word((0x28, 6), planar);
        maker.set((0x7FE0, 0x10), "OW", Value::Bytes(bytes));
        let film = read(&maker.file(EXPLICIT)).unwrap();
        assert_eq!(film.stored, StoredPixels::Unsigned(vec![9, 200]), "{photometric}");
        assert_eq!(film.remarks, [FilmRemark::Colour { largest_difference: 0 }]);
    }
}

#[test]
fn files_without_meta_information_are_read_with_remarks() {
    let maker = Maker::new(COLUMNS, ROWS, &noise());
    for syntax in [IMPLICIT, EXPLICIT, BIG_ENDIAN] {
        let film = read(&maker.body(syntax)).unwrap();
        assert_eq!(film.stored, StoredPixels::Unsigned(noise()));
        assert_eq!(film.remarks[0], FilmRemark::NoPreamble);
        assert!(matches!(film.remarks[1], FilmRemark::TransferSyntaxGuessed { .. }));
    }
    // Meta information without a preamble.
    let film = read(&maker.file(EXPLICIT)[132..]).unwrap();
    assert_eq!(film.stored, StoredPixels::Unsigned(noise()));
    assert_eq!(film.remarks, [FilmRemark::NoPreamble]);
}

#[test]
fn spacing_and_view_are_taken_from_the_tags() {
    let mut maker = Maker::new(2, 2, &[0; 4]);
    maker.text((0x18, 0x1164), "DS", "0.20\\0.10").text((0x18, 0x1114), "DS", "1.25");
    maker.text((0x18, 0x5101), "CS", "PA").text((0x20, 0x20), "CS", "L\\F");
    let code = |value: &str| [((0x0008, 0x0100), ("SH", text(value)))].into();
    maker.set((0x54, 0x410), "SQ", Value::Items(vec![code("F-10440")]));
    let film = read(&maker.file(IMPLICIT)).unwrap();
    let spacing = judge_spacing(&film.tags.spacing).spacing.unwrap();
    assert_eq!((spacing.row_mm, spacing.column_mm), (0.16, 0.08));
    assert_eq!(spacing.plane, SpacingPlane::Patient);
    assert_eq!(film.tags.view.orientation, Some([PatientDirection::Left, PatientDirection::Foot]));
    assert_eq!(film.tags.view.view_position, Some(ViewPosition::Frontal));
    assert_eq!(film.tags.view.stance, Some(Stance::Erect));
    assert_eq!(judge_view(&film.tags.view, None).view, Some(View::Frontal));
    assert_eq!(film.tags.uids.sop_instance.as_deref(), Some("1.2.3.4.5.1"));
    maker.remove((0x18, 0x5101)).remove((0x20, 0x20));
    maker.set((0x54, 0x220), "SQ", Value::Items(vec![code("R-10236")]));
    let view = read(&maker.file(EXPLICIT)).unwrap().tags.view;
    assert_eq!(view.view_position, Some(ViewPosition::Lateral));
}

#[test]
fn pictures_of_other_formats_are_read_and_have_no_spacing() {
    let words: Vec<u16> = ramp(5, 3).iter().map(|&p| p * 16).collect();
    let grey = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(5, 3, words.clone()).unwrap();
    for (format, kind) in
        [(image::ImageFormat::Png, FilmKind::Png), (image::ImageFormat::Tiff, FilmKind::Tiff)]
    {
        let mut file = std::io::Cursor::new(Vec::new());
        grey.write_to(&mut file, format).unwrap();
        let film = read(file.get_ref()).unwrap();
        assert_eq!((film.kind, film.columns, film.rows), (kind, 5, 3));
        assert_eq!(film.stored, StoredPixels::Unsigned(words.clone()));
        assert_eq!(judge_spacing(&film.tags.spacing).spacing, None);
        // The smallest value is black, and the largest white.
        let white = words.iter().copied().max().unwrap() as f64;
        let shown = words.iter().map(|&word| (255.0 * word as f64 / white).round() as u8);
        assert_eq!(film.display(None, false).grey, shown.collect::<Vec<_>>());
        for end in 0..file.get_ref().len() {
            // Any result but a panic; the last bytes of a PNG hold no pixels.
            let _ = read(&file.get_ref()[..end]).is_ok();
        }
    }
}

#[test]
fn an_unreadable_table_is_named() {
    let mut table = std::collections::BTreeMap::new();
    // A value of UL has four bytes; these are six, and a reader of four is out of step.
    table.insert((0x28, 0x1199), ("UL", Value::Words(vec![0; 3])));
    let mut maker = Maker::new(2, 2, &[0; 4]);
    maker.set((0x28, 0x3010), "SQ", Value::Items(vec![table]));
    let film = read(&maker.file(EXPLICIT)).unwrap();
    assert_eq!(film.look.voi, []);
    let attribute = Attribute(0x28, 0x3010);
    assert_eq!(film.remarks, [FilmRemark::Unusable { attribute }]);
}

#[test]
fn a_colour_picture_of_16_bits_is_refused_as_one() {
    let words = vec![500_u16; 4 * 3 * 3];
    let picture = image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(4, 3, words).unwrap();
    let mut file = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut file, image::ImageFormat::Tiff).unwrap();
    let error = read(&file.into_inner()).unwrap_err();
    assert!(error.to_string().contains("colour image"), "{error}");
    assert!(error.to_string().contains("a greyscale one is needed"), "{error}");
    assert!(error.help().contains("greyscale"), "{error}");
}
