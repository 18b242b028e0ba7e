//! The grey pipeline, against values computed by hand from the standard's formulas.

use spineline_films::{Attribute, FilmRemark, ModalityTransform, Voi, Window, WindowFunction};

use crate::maker::{EXPLICIT, IMPLICIT, Maker, Value, text};
use crate::reading::read;

fn grey(maker: &Maker) -> Vec<u8> {
    let film = read(&maker.file(EXPLICIT)).unwrap();
    let shown = film.display(None, false).grey;
    // A viewer's picture from the values equals the file's own display.
    let screen = film.screen_values();
    let viewed: Vec<u8> =
        screen.values.iter().map(|&v| screen.default_grey[usize::from(v)]).collect();
    assert_eq!(viewed, shown);
    shown
}

fn lut(descriptor: [u16; 3], values: &[u16]) -> Value {
    let item = [
        ((0x28, 0x3002), ("US", Value::Words(descriptor.to_vec()))),
        ((0x28, 0x3006), ("OW", Value::Words(values.to_vec()))),
    ];
    Value::Items(vec![item.into()])
}

#[test]
fn f8_monochrome_1_inverts_exactly_once() {
    for (photometric, shape, expected, contradicted) in [
        ("MONOCHROME2", None, [0, 85, 170, 255], false),
        ("MONOCHROME2", Some("IDENTITY"), [0, 85, 170, 255], false),
        ("MONOCHROME2", Some("INVERSE"), [0, 85, 170, 255], true),
        ("MONOCHROME1", None, [255, 170, 85, 0], false),
        ("MONOCHROME1", Some("IDENTITY"), [255, 170, 85, 0], true),
        ("MONOCHROME1", Some("INVERSE"), [255, 170, 85, 0], false),
    ] {
        let mut maker = Maker::new(2, 2, &[0, 1, 2, 3]);
        maker.text((0x28, 4), "CS", photometric);
        if let Some(shape) = shape {
            maker.text((0x2050, 0x20), "CS", shape);
        }
        assert_eq!(grey(&maker), expected, "{photometric} {shape:?}");
        let film = read(&maker.file(EXPLICIT)).unwrap();
        let remark = film.remarks.contains(&FilmRemark::PolarityContradicted);
        assert_eq!(remark, contradicted, "{photometric} {shape:?}");
        let mut turned = expected;
        turned.reverse();
        assert_eq!(film.display(None, true).grey, turned);
    }
    let mut maker = Maker::new(2, 2, &[0, 1, 2, 3]);
    let film = read(&maker.remove((0x28, 4)).file(EXPLICIT)).unwrap();
    assert_eq!(film.remarks, [FilmRemark::PolarityNotStated]);
}

#[test]
fn windows_follow_the_formulas_of_the_standard() {
    let window = |function, center, width| Window { center, width, function };
    // C.11.2.1.2: centre 2048 and width 4096 map 0 to black and 4095 to white.
    let linear = window(WindowFunction::Linear, 2048.0, 4096.0);
    assert_eq!((linear.apply(0.0), linear.apply(4095.0)), (0.0, 1.0));
    assert!((linear.apply(2047.5) - 0.5).abs() < 1e-12);
    // Width 1 is a step between 99 and 100 for a centre of 100.
    let step = window(WindowFunction::Linear, 100.0, 1.0);
    assert_eq!((step.apply(99.0), step.apply(99.5), step.apply(100.0)), (0.0, 0.0, 1.0));
    let exact = window(WindowFunction::LinearExact, 0.5, 0.5);
    assert_eq!((exact.apply(0.25), exact.apply(0.5), exact.apply(0.75)), (0.0, 0.5, 1.0));
    let sigmoid = window(WindowFunction::Sigmoid, 10.0, 4.0);
    assert!((sigmoid.apply(11.0) - 1.0 / (1.0 + (-1.0_f64).exp())).abs() < 1e-12);
    assert!(!window(WindowFunction::Linear, 0.0, 0.5).is_valid());
    assert!(!window(WindowFunction::Sigmoid, 0.0, 0.0).is_valid());
    assert!(window(WindowFunction::LinearExact, 0.0, 0.5).is_valid());
}

#[test]
fn rescale_comes_before_the_window() {
    // 2 s - 100 with s = 50, 100, 150: 0, 100, 200. Exact window 100 ± 100.
    let mut maker = Maker::new(3, 1, &[50, 100, 150]);
    maker.text((0x28, 0x1053), "DS", "2").text((0x28, 0x1052), "DS", "-100");
    maker.text((0x28, 0x1050), "DS", "100\\7").text((0x28, 0x1051), "DS", "200\\9");
    maker.text((0x28, 0x1056), "CS", "LINEAR_EXACT");
    assert_eq!(grey(&maker), [0, 128, 255]);
    let film = read(&maker.file(EXPLICIT)).unwrap();
    assert_eq!(film.look.voi.len(), 2);
    maker.text((0x28, 0x1053), "DS", "-2").text((0x28, 0x1052), "DS", "300");
    // 200, 100, 0.
    assert_eq!(grey(&maker), [255, 128, 0]);
}

#[test]
fn modality_table_values_of_interest_table_and_polarity_apply_in_order() {
    let mut maker = Maker::new(4, 1, &[9, 10, 11, 12]);
    // 10 → 3, 11 → 1, 12 → 2; 9 lies below and gets the first.
    maker.set((0x28, 0x3000), "SQ", lut([3, 10, 16], &[3, 1, 2]));
    // 1 → 10, 2 → 100, 3 → 255 of 255.
    maker.set((0x28, 0x3010), "SQ", lut([3, 1, 8], &[10, 100, 255]));
    // A window beside the table is the second choice.
    maker.text((0x28, 0x1050), "DS", "1").text((0x28, 0x1051), "DS", "1");
    assert_eq!(grey(&maker), [255, 255, 10, 100]);
    maker.text((0x28, 4), "CS", "MONOCHROME1");
    assert_eq!(grey(&maker), [0, 0, 245, 155]);
    let film = read(&maker.file(IMPLICIT)).unwrap();
    assert!(matches!(film.look.modality, ModalityTransform::Lut(_)));
    assert!(matches!(film.look.voi[..], [Voi::Lut(_), Voi::Window(_)]));
}

#[test]
fn f9_invalid_tables_and_windows_show_the_full_range_with_a_remark() {
    let whole = vec![0, 128, 255];
    let voi = Attribute(0x28, 0x3010);
    let width = Attribute(0x28, 0x1051);
    let mut maker = Maker::new(3, 1, &[100, 200, 300]);
    maker.set((0x28, 0x3010), "SQ", lut([5, 0, 16], &[1, 2, 3]));
    assert_eq!(grey(&maker), whole);
    let remarks = |maker: &Maker| read(&maker.file(EXPLICIT)).unwrap().remarks;
    assert_eq!(remarks(&maker), [FilmRemark::LookupUnusable { attribute: voi }]);
    // 0 entries mean 65536, which are missing here.
    maker.set((0x28, 0x3010), "SQ", lut([0, 0, 16], &[]));
    assert_eq!(remarks(&maker), [FilmRemark::LookupUnusable { attribute: voi }]);
    // Here they exist: each value maps to itself.
    let identity: Vec<u16> = (0..=u16::MAX).collect();
    maker.set((0x28, 0x3010), "SQ", lut([0, 0, 16], &identity));
    assert_eq!(remarks(&maker), []);
    assert_eq!(grey(&maker), [0, 1, 1]);
    maker.remove((0x28, 0x3010));
    for bad in ["0", "-5", "0.5", "nan", "wide"] {
        maker.text((0x28, 0x1050), "DS", "200").text((0x28, 0x1051), "DS", bad);
        assert_eq!(grey(&maker), whole, "{bad}");
        assert!(
            remarks(&maker).contains(&FilmRemark::LookupUnusable { attribute: width }),
            "{bad}"
        );
    }
    maker.remove((0x28, 0x1050)).remove((0x28, 0x1051)).text((0x28, 0x1053), "DS", "0");
    assert_eq!(grey(&maker), whole);
    assert_eq!(remarks(&maker), [FilmRemark::Unusable { attribute: Attribute(0x28, 0x1053) }]);
}

#[test]
fn padding_does_not_widen_the_default_window() {
    let mut maker = Maker::new(4, 1, &[4000, 100, 200, 300]);
    maker.word((0x28, 0x120), 4000);
    assert_eq!(grey(&maker), [255, 0, 128, 255]);
    maker.word((0x28, 0x121), 4095);
    assert_eq!(grey(&maker), [255, 0, 128, 255]);
    // Only padding, and one value only: no division by zero.
    assert_eq!(grey(&Maker::new(2, 1, &[7, 7])).len(), 2);
}

#[test]
fn values_for_a_viewer_carry_their_scale() {
    let mut maker = Maker::new(3, 1, &[10, 20, 40]);
    maker.text((0x28, 0x1053), "DS", "0.5").text((0x28, 0x1052), "DS", "7");
    for (photometric, values) in [("MONOCHROME2", [0, 10, 30]), ("MONOCHROME1", [30, 20, 0])] {
        maker.text((0x28, 4), "CS", photometric);
        let screen = read(&maker.file(EXPLICIT)).unwrap().screen_values();
        assert_eq!(screen.values, values, "greater is brighter");
        let device: Vec<f64> = values
            .iter()
            .map(|&v| screen.modality_offset + screen.modality_step * f64::from(v))
            .collect();
        assert_eq!(device, [12.0, 17.0, 27.0]);
    }
}

#[test]
fn values_for_a_viewer_have_all_windows_of_the_file() {
    let mut maker = Maker::new(3, 1, &[10, 20, 40]);
    let windows = |maker: &Maker| read(&maker.file(EXPLICIT)).unwrap().screen_values().file_windows;
    assert_eq!(windows(&maker), Vec::<[f64; 2]>::new());
    maker.text((0x28, 0x1050), "DS", "20\\30").text((0x28, 0x1051), "DS", "10\\12");
    // The smallest value of the picture is 0 for the viewer.
    assert_eq!(windows(&maker), [[10.0, 10.0], [20.0, 12.0]]);
    maker.text((0x28, 4), "CS", "MONOCHROME1");
    // The largest one is.
    assert_eq!(windows(&maker), [[20.0, 10.0], [10.0, 12.0]]);
}

#[test]
fn packed_tables_of_8_bits_are_read() {
    let mut maker = Maker::new(3, 1, &[0, 1, 2]);
    let item = [
        ((0x28, 0x3002), ("US", Value::Words(vec![3, 0, 8]))),
        ((0x28, 0x3006), ("OW", Value::Bytes(vec![10, 20, 30, 0]))),
        ((0x28, 0x3003), ("LO", text("packed"))),
    ];
    maker.set((0x28, 0x3010), "SQ", Value::Items(vec![item.into()]));
    assert_eq!(grey(&maker), [10, 20, 30]);
}
