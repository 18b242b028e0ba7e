//! `spineline film` and the decoder behind it.

#![allow(clippy::unwrap_used)]

use std::io::Write;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use spineline_films::{ChildLimits, FilmError, FilmLimits, decode_in_child, read_film};

use crate::maker::{DEFLATED, EXPLICIT, Maker, RLE, Value, ramp};
use crate::program::folder;

fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin!("spineline").to_path_buf()
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::File::create(&path).unwrap().write_all(bytes).unwrap();
    path
}

#[test]
fn a_film_decoded_in_the_child_is_unchanged() {
    let mut maker = Maker::new(37, 23, &ramp(37, 23));
    maker.text((0x20, 0x20), "CS", "L\\F").text((0x18, 0x1164), "DS", "0.2\\0.1");
    maker.text((0x28, 0x30), "DS", "0,1").word((0x28, 0x103), 1);
    let bytes = maker.file(EXPLICIT);
    let limits = ChildLimits::default();
    let film = decode_in_child(&program(), &["decode-film"], bytes.clone(), &limits).unwrap();
    assert_eq!(film, read_film(&bytes, &FilmLimits::default()).unwrap());
}

#[test]
fn errors_of_a_film_in_the_child_are_unchanged() {
    let film = Maker::new(6, 4, &ramp(6, 4));
    let mut bomb = film.clone();
    bomb.set((9, 0x1010), "OB", Value::Bytes(vec![0; 40 << 20]));
    let mut limits = ChildLimits::default();
    limits.film.inflated_bytes = 16 << 20;
    let mut deep = film.file(EXPLICIT);
    for _ in 0..100_000 {
        deep.extend([8, 0, 0x40, 0x11, b'S', b'Q', 0, 0, 0xFF, 0xFF, 0xFF, 0xFF]);
        deep.extend([0xFE, 0xFF, 0, 0xE0, 0xFF, 0xFF, 0xFF, 0xFF]);
    }
    let whole = film.file(EXPLICIT);
    for bytes in [&b"%PDF"[..], &whole[..300], &bomb.file(DEFLATED), &deep] {
        let error =
            decode_in_child(&program(), &["decode-film"], bytes.to_vec(), &limits).unwrap_err();
        assert_eq!(error, read_film(bytes, &limits.film).unwrap_err());
    }
}

#[cfg(unix)]
#[test]
fn f62_a_film_that_needs_more_memory_than_allowed_is_an_error() {
    // 81 million equal pixels take a few MB as run lengths, and hundreds unpacked. The limit is of the address space, in which a
    // test build with PDF itself takes 140 MiB.
    let side = 9000_u16;
    let plane: Vec<u8> = (0..81_000_000 / 128 + 1).flat_map(|_| [129_u8, 7]).collect();
    let tail = 128 * (81_000_000 / 128 + 1) - 81_000_000;
    let plane = [&plane[..plane.len() - 2], &[(257 - (128 - tail)) as u8, 7]].concat();
    let mut coded: Vec<u8> =
        [2, 64, 64 + plane.len() as u32].iter().flat_map(|word| word.to_le_bytes()).collect();
    coded.resize(64, 0);
    coded.extend(&plane);
    coded.extend(&plane);
    let mut maker = Maker::new(side, side, &[]);
    let bytes = maker.fragments(vec![coded]).file(RLE);
    for limit_bytes in [250 << 20, 350 << 20] {
        let limits = ChildLimits { memory_bytes: limit_bytes, ..ChildLimits::default() };
        let film = decode_in_child(&program(), &["decode-film"], bytes.clone(), &limits);
        assert_eq!(film.unwrap_err(), FilmError::DecoderMemory { limit_bytes });
    }
}

#[test]
fn film_describes_a_file_without_the_patients_identity() {
    let folder = tempfile::tempdir().unwrap();
    let mut maker = Maker::new(4, 2, &[0, 100, 200, 300, 400, 500, 600, 700]);
    maker.text((0x10, 0x10), "PN", "Doe^Jane").text((0x10, 0x20), "LO", "4711-XY");
    maker.text((0x28, 4), "CS", "MONOCHROME1").text((0x18, 0x1164), "DS", "0.2\\0.1");
    // Quality Control Image: what is shown is a phantom.
    maker.text((0x28, 0x300), "CS", "YES");
    let path = write(folder.path(), "film.dcm", &maker.file(EXPLICIT));
    let png = folder.path().join("film.png");
    let run = |arguments: &[&str]| {
        let mut command = Command::new(program());
        let output = command.arg("film").arg(&path).args(arguments).output().unwrap();
        let text =
            String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
        assert!(!text.contains("Doe") && !text.contains("4711"), "{text}");
        text
    };
    let text = run(&["--png", png.to_str().unwrap()]);
    for part in [
        "4 columns, 2 rows",
        "MONOCHROME1: small values are bright",
        "mm (detector)",
        "not square",
        " · SYNTHETIC\n",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let shown = read_film(&std::fs::read(&png).unwrap(), &FilmLimits::default()).unwrap();
    assert_eq!(shown.stored.iter().collect::<Vec<_>>(), [255, 219, 182, 146, 109, 73, 36, 0]);
    run(&["--png", png.to_str().unwrap(), "--overwrite", "--invert", "--window", "350,1"]);
    let shown = read_film(&std::fs::read(&png).unwrap(), &FilmLimits::default()).unwrap();
    assert_eq!(shown.stored.iter().collect::<Vec<_>>(), [0, 0, 0, 0, 255, 255, 255, 255]);
    let json: serde_json::Value = serde_json::from_str(&run(&["--json"])).unwrap();
    assert_eq!((json["rows"].as_u64(), json["spacing"]["row_mm"].as_f64()), (Some(2), Some(0.2)));
    assert_eq!(json["synthetic"], true);
}

#[test]
fn film_refuses_other_files_with_help_and_continues() {
    let folder = tempfile::tempdir().unwrap();
    let bad = write(folder.path(), "report.pdf", b"%PDF-1.7");
    let good = write(folder.path(), "film.dcm", &Maker::new(2, 2, &[1, 2, 3, 4]).file(EXPLICIT));
    let output = Command::new(program()).arg("film").args([bad, good]).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("looks like a PDF document"));
    assert!(String::from_utf8_lossy(&output.stdout).contains("2 columns, 2 rows"));
    assert!(!String::from_utf8_lossy(&output.stdout).contains("SYNTHETIC"));
}

#[test]
fn a_preview_is_imported_with_the_shape_of_its_pixels_as_synthetic() {
    let here = folder();
    let mut maker = Maker::new(60, 40, &ramp(60, 40));
    maker.text((0x18, 0x1164), "DS", "0.2\\0.1").text((0x28, 0x300), "CS", "YES");
    here.write("film.dcm", maker.file(EXPLICIT));
    here.done(&["film", "film.dcm", "--png", "film.png"]);
    let beside = here.json("film.png.provenance.json");
    assert_eq!(beside["provenance"]["films"], "synthetic");
    assert_eq!(beside["provenance"]["inputs"][0]["name"], "film.dcm");
    let png = std::fs::read(here.path("film.png")).unwrap();
    assert_eq!(beside["of"][0]["sha256"], spineline_files::sha256_hex(&png));
    // The provenance names the file, so that the same command may make it again.
    here.done(&["film", "film.dcm", "--png", "film.png", "--invert"]);
    let case = ["--case-id", "A", "--out", "a", "--film", "erect=1"];
    let side = ["--patient-left", "image-left"];
    here.imported(&[&["film.png"], &case[..], &side].concat());
    let made = here.json("a/case.json");
    assert_eq!(made["synthetic"], true);
    let image = &made["films"][0]["image"];
    assert_eq!((&image["pixel_aspect"], &image["spacing_plane"]), (&2.0.into(), &"pixels".into()));
}
