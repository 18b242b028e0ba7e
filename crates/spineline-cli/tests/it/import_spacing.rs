//! `spineline import` of films that state the distances or the shape of their pixels in other ways than the standard has it.

use crate::import::{ERECT, film, put};
use crate::maker::Maker;
use crate::program::{folder, unwrapped};

/// The arguments that make case B of the erect film `b.dcm`, in the folder `b`.
const B: [&str; 7] = ["b.dcm", "--case-id", "B", "--out", "b", "--film", "erect=1"];

/// A film with one text changed.
fn film_with(tag: (u16, u16), vr: &'static str, value: &str) -> Maker {
    let mut maker = film(1);
    maker.text(tag, vr, value);
    maker
}

#[test]
fn a_spacing_that_cannot_be_read_is_asked_for_and_a_shape_alone_answers_it() {
    let here = folder();
    put(&here, "a.dcm", &film_with((0x28, 0x30), "DS", "0,5"));
    let error = here.import_refused(&ERECT, 2);
    assert!(error.contains("is `0,5`") && error.contains("--spacing erect="), "{error}");
    assert!(!here.path("a/case.json").exists());
    let out = here.imported(&[&ERECT[..], &["--spacing", "1,2,pixels"]].concat());
    assert!(out.contains("erect"), "{out}");
    let image = &here.json("a/case.json")["films"][0]["image"];
    assert_eq!((&image["pixel_aspect"], &image["spacing_plane"]), (&2.0.into(), &"pixels".into()));
    assert_eq!(image.get("column_spacing_mm"), None);
    // Two numbers with a comma between have one meaning.
    put(&here, "b.dcm", &film_with((0x28, 0x30), "DS", "0.500,0.250"));
    let out = here.imported(&B);
    let words = unwrapped(&out);
    assert!(words.contains("is `0.500,0.250`") && words.contains("--spacing"), "{out}");
}

#[test]
fn a_spacing_in_metres_is_asked_for_and_refused() {
    let here = folder();
    put(&here, "a.dcm", &film_with((0x28, 0x30), "DS", "0.0002\\0.0002"));
    let error = here.import_refused(&ERECT, 2);
    assert!(error.contains("--spacing erect="), "{error}");
    let metres = [&ERECT[..], &["--spacing", "0.0002,0.0002,patient"]].concat();
    let error = here.import_refused(&metres, 2);
    assert!(unwrapped(&error).contains("from 0.01 to 5 mm"), "{error}");
}

#[test]
fn a_pixel_aspect_ratio_is_used_without_a_spacing_and_asked_about_where_it_contradicts_one() {
    let here = folder();
    let mut alone = film_with((0x28, 0x34), "IS", "1\\2");
    alone.remove((0x28, 0x30)).remove((0x28, 0xA02));
    put(&here, "a.dcm", &alone);
    here.imported(&ERECT);
    let image = &here.json("a/case.json")["films"][0]["image"];
    assert_eq!(image["pixel_aspect"], 0.5);
    assert_eq!(image["spacing_source"], "pixel_aspect");
    // The spacing has rows at twice the distance of columns.
    put(&here, "b.dcm", &film_with((0x28, 0x34), "IS", "1\\2"));
    let error = here.import_refused(&B, 2);
    assert!(error.contains("2.000") && error.contains("0.500"), "{error}");
}

#[test]
fn a_detector_with_another_shape_of_pixels_than_pixel_spacing_is_asked_about() {
    let here = folder();
    // Pixel Spacing has rows at twice the distance of columns.
    put(&here, "a.dcm", &film_with((0x18, 0x1164), "DS", "0.11\\0.11"));
    let error = here.import_refused(&ERECT, 2);
    let words = unwrapped(&error);
    assert!(words.contains("2.000") && words.contains("1.000 times by Imager"), "{error}");
    assert!(words.contains("--spacing erect=") && !here.path("a").exists(), "{error}");
    here.imported(&[&ERECT[..], &["--spacing", "0.1,0.1,patient"]].concat());
    assert_eq!(here.json("a/case.json")["films"][0]["image"]["row_spacing_mm"], 0.1);
}

#[test]
fn another_shape_of_pixels_than_the_files_needs_confirmation() {
    let here = folder();
    put(&here, "a.dcm", &film(1));
    // A shape alone, without millimetres.
    let mut shape = film_with((0x28, 0x34), "IS", "1\\2");
    shape.remove((0x28, 0x30)).remove((0x28, 0xA02));
    put(&here, "shape.dcm", &shape);
    let all = ["--case-id", "A", "--film", "erect=1", "--out"];
    for (file, spacing, by_file) in [
        ("a.dcm", "0.15,0.15,patient", "2.000"),
        ("a.dcm", "1,1,pixels", "2.000"),
        ("shape.dcm", "0.15,0.15,patient", "0.500"),
    ] {
        let words = [&[file][..], &all, &["refused", "--spacing", spacing]].concat();
        let error = here.import_refused(&words, 2);
        let text = unwrapped(&error);
        let said = format!("1.000 times as high as wide, and the file {by_file} times");
        assert!(text.contains(&said) && text.contains("--accept"), "{file} {spacing}: {error}");
        assert!(!here.path("refused").exists());
        let out = format!("{file}-{}", spacing.len());
        let words = [&[file][..], &all, &[out.as_str(), "--spacing", spacing, "--accept"]].concat();
        let shown = here.imported(&words);
        assert!(unwrapped(&shown).contains("accepted by --accept"), "{shown}");
    }
    // The file's shape at another scale.
    here.imported(&[&["a.dcm"][..], &all, &["same", "--spacing", "0.15,0.3,patient"]].concat());
    here.imported(&[&["shape.dcm"][..], &all, &["own", "--spacing", "0.2,0.1,unknown"]].concat());
}

#[test]
fn a_ball_that_contradicts_the_given_spacing_is_noted() {
    let here = folder();
    let mut bare = film(1);
    bare.remove((0x28, 0x30)).remove((0x28, 0xA02));
    put(&here, "a.dcm", &bare);
    let all = ["a.dcm", "--case-id", "A", "--film", "erect=1", "--out"];
    // 25 mm over 40 pixels are 0.625 mm a pixel: 1.25 times 0.5 mm. A detector's 0.7 mm are a magnification of 1.12.
    let import = |out: &str, spacing: &str| {
        let words = [out, "--ball", "erect=10,20,50,20,25", "--spacing", spacing];
        let shown = unwrapped(&here.imported(&[&all[..], &words].concat()));
        let image = &here.json(format!("{out}/case.json"))["films"][0]["image"];
        assert_eq!(image["column_spacing_mm"], 0.625);
        shown
    };
    let shown = import("a", "0.5,0.5,patient");
    assert!(shown.contains("is 1.250 times your --spacing; your --spacing is not used"), "{shown}");
    for (out, spacing) in
        [("b", "0.63,0.63,patient"), ("c", "0.7,0.7,detector"), ("d", "1,1,pixels")]
    {
        let shown = import(out, spacing);
        assert!(!shown.contains("your --spacing"), "{shown}");
    }
}
