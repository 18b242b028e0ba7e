//! From a file of 12 megapixels to pixels that are ready for the screen, per encoding.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use spineline_films::{FilmLimits, read_film};

#[path = "../tests/it/maker.rs"]
mod maker;
use maker::{
    DEFLATED, EXPLICIT, JPEG_LOSSLESS_1, JPEG_LS, Maker, RLE, jpeg_lossless, jpeg_ls, rle,
};

const COLUMNS: u16 = 3000;
const ROWS: u16 = 4000;

/// Broad shadows and the noise of a detector: compresses by about the same factor as a real film does.
fn shadows() -> Vec<u16> {
    let mut state = 1_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 16) / 65536.0 - 0.5
    };
    let mut pixels = Vec::new();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let (x, y) = (f64::from(column) / 400.0, f64::from(row) / 300.0);
            let shadow = 2000.0 + 1200.0 * x.sin() * y.cos();
            pixels.push((shadow + 8.0 * (noise() + noise() + noise())) as u16);
        }
    }
    pixels
}

fn films(c: &mut Criterion) {
    let pixels = shadows();
    let plain = Maker::new(COLUMNS, ROWS, &pixels);
    let with = |fragment: Vec<u8>| {
        let mut maker = plain.clone();
        maker.fragments(vec![fragment]).clone()
    };
    let mut files = vec![
        ("uncompressed".to_owned(), plain.file(EXPLICIT)),
        ("deflated".to_owned(), plain.file(DEFLATED)),
        ("rle".to_owned(), with(rle(&pixels)).file(RLE)),
        (
            "jpeg_lossless".to_owned(),
            with(jpeg_lossless(COLUMNS, ROWS, 12, &pixels, 1, 0, 0)).file(JPEG_LOSSLESS_1),
        ),
        ("jpeg_ls".to_owned(), with(jpeg_ls(COLUMNS, ROWS, 12, &pixels)).file(JPEG_LS)),
    ];
    // JPEG 2000 cannot be encoded here, so a real film of 3.1 megapixels is used.
    if let Some(data) = std::env::var_os("SPINELINE_DATA") {
        for name in ["RG3_J2KR", "RG3_J2KI", "RG3_JPLL", "RG3_JLSL"] {
            let path = std::path::Path::new(&data).join(format!("dicom-samples/wg04/{name}.dcm"));
            if let Ok(bytes) = std::fs::read(path) {
                files.push((format!("{name} (3.1 MP)"), bytes));
            }
        }
    }
    let mut group = c.benchmark_group("film to screen, 12 MP");
    group.sample_size(10);
    for (name, bytes) in files {
        group.bench_function(name, |b| {
            b.iter(|| {
                let film = read_film(black_box(&bytes), &FilmLimits::default()).expect("a film");
                film.display(None, false)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, films);
criterion_main!(benches);
