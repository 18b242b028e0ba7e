//! The public AASCE landmarks: known errors are found, and valid films have the angles of the set.

use std::collections::BTreeSet;
use std::path::PathBuf;

use spineline::analysis::{AnalysisOptions, Case, Subject, analyze};
use spineline::anatomy::{ImageSide, Level, Posture};
use spineline::measure::{Film, FilmLandmarks, ImageGeometry};
use spineline_landmarks::{
    AasceRow, AasceRows, AasceVerdict, LandmarkError, LandmarkHint, LandmarkReadings, image_sizes,
    judge_aasce, parse_mat,
};

/// Rows of the training set.
const ROWS: usize = 481;

fn folder() -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("SPINELINE_DATA") else {
        println!("skipped: SPINELINE_DATA is not set");
        return None;
    };
    let folder = PathBuf::from(folder).join("aasce");
    if !folder.is_dir() {
        println!("skipped: SPINELINE_DATA holds no folder `aasce`");
        return None;
    }
    Some(folder)
}

/// The side on which those pictures that show it have the patient's left.
fn hint() -> LandmarkHint {
    LandmarkHint { patient_left: Some(ImageSide::Right), ..LandmarkHint::default() }
}

fn rows(folder: &std::path::Path) -> Vec<AasceRow> {
    let read = |name: &str| std::fs::read(folder.join(name)).expect(name);
    let sizes = image_sizes(&read("image_sizes.csv")).expect("sizes");
    let (names, landmarks) =
        (read("labels/training/filenames.csv"), read("labels/training/landmarks.csv"));
    let hint = hint();
    let rows = AasceRows::new(&names, &landmarks, &sizes, &hint).expect("a side is given");
    rows.collect::<Result<Vec<_>, _>>().expect("all rows can be read")
}

/// Rows that someone flagged, by geometry or by looking at the pictures.
fn flags(folder: &std::path::Path, source: &str) -> BTreeSet<usize> {
    let text = std::fs::read_to_string(folder.join("row_flags.csv")).expect("flags");
    let flagged =
        text.lines().filter(|line| line.starts_with("training,") && line.contains(source));
    flagged.map(|line| line.split(',').nth(1).expect("row").parse().expect("a number")).collect()
}

#[test]
fn every_film_is_checked_and_known_errors_are_found() {
    let Some(folder) = folder() else { return };
    let rows = rows(&folder);
    assert_eq!(rows.len(), ROWS);
    let by_geometry = flags(&folder, "geometry check");
    let by_eye = flags(&folder, "scoliosistools");
    let mut caught = BTreeSet::new();
    for row in &rows {
        match judge_aasce(&row.film, ImageSide::Right).expect("a film with its size") {
            AasceVerdict::Clean { .. } => {}
            AasceVerdict::Faults(faults) => {
                assert!(!faults.is_empty() && !faults[0].to_string().is_empty());
                caught.insert(row.row);
            }
        }
    }
    let seen_only = &by_eye - &by_geometry;
    let false_alarms: Vec<usize> = (&caught - &(&by_geometry | &by_eye)).into_iter().collect();
    println!(
        "by geometry: {} of {} found, missed {:?}; by eye alone: {} of {}; others: {} of {} {:?}",
        (&caught & &by_geometry).len(),
        by_geometry.len(),
        &by_geometry - &caught,
        (&caught & &seen_only).len(),
        seen_only.len(),
        false_alarms.len(),
        ROWS - (&by_geometry | &by_eye).len(),
        false_alarms,
    );
    // On row 143 two neighbouring distances are 1.4 times their share: between one and two vertebrae, so neither.
    let missed: Vec<usize> = (&by_geometry - &caught).into_iter().collect();
    assert!(missed == [143], "missed: {missed:?}");
    // One in a hundred: the limits of the core (0.6 and 1.6 of the usual distance) were not chosen on these films.
    assert!(false_alarms.len() * 100 <= ROWS, "false alarms: {false_alarms:?}");
}

#[test]
fn the_main_angle_of_valid_films_equals_that_of_the_data_set() {
    let Some(folder) = folder() else { return };
    let angles =
        std::fs::read_to_string(folder.join("labels/training/angles.csv")).expect("angles");
    let main: Vec<f64> = angles
        .lines()
        .map(|line| line.split(',').next().expect("a column").parse().expect("a number"))
        .collect();
    let mut off: Vec<f64> = Vec::new();
    for row in rows(&folder) {
        if let AasceVerdict::Clean { main_angle } =
            judge_aasce(&row.film, ImageSide::Right).expect("a film with its size")
        {
            off.push((main_angle.deg() - main[row.row]).abs());
        }
    }
    off.sort_by(f64::total_cmp);
    let at = |part: f64| off[((off.len() - 1) as f64 * part) as usize];
    println!(
        "{} films: median {:.4}°, 95 % {:.4}°, largest {:.4}°",
        off.len(),
        at(0.5),
        at(0.95),
        at(1.0)
    );
    assert!(off.len() > 400, "few films are clean: {}", off.len());
    // The set gives five digits, so 0.0005° for angles above 10°.
    assert!(at(1.0) < 0.002, "{}", at(1.0));
}

#[test]
fn matlab_and_csv_files_give_the_same_film() {
    let Some(folder) = folder() else { return };
    let rows = rows(&folder);
    let mut compared = 0;
    for entry in std::fs::read_dir(folder.join("mat_samples")).expect("samples") {
        let path = entry.expect("a file").path();
        let picture = path.file_stem().expect("a name").to_str().expect("UTF-8").to_owned();
        let file = parse_mat(&std::fs::read(&path).expect("bytes"), &hint()).expect("a film");
        let row = rows.iter().find(|row| row.picture == picture).expect("its row");
        assert_eq!(file.films[0].landmarks, row.film.landmarks, "{picture}");
        compared += 1;
    }
    assert!(compared >= 9, "{compared}");
}

#[test]
fn the_patients_left_is_that_of_the_picture() {
    let Some(folder) = folder() else { return };
    let path = folder.join("mat_samples/sunhl-1th-02-Jan-2017-162 A AP.jpg.mat");
    let bytes = std::fs::read(path).expect("bytes");
    let corners = |side| {
        let hint = LandmarkHint { patient_left: Some(side), ..LandmarkHint::default() };
        let LandmarkReadings::Corners(readings) =
            parse_mat(&bytes, &hint).expect("a film").films.remove(0).landmarks
        else {
            panic!("corners are marked");
        };
        readings[0].vertebrae[&Level::T5].corners
    };
    let (right, left) = (corners(ImageSide::Right), corners(ImageSide::Left));
    assert!(right.superior_left.column_px > right.superior_right.column_px);
    assert_eq!(
        (left.superior_left, left.inferior_right),
        (right.superior_right, right.inferior_left)
    );
    let unsaid = parse_mat(&bytes, &LandmarkHint::default()).expect_err("no side is given");
    assert!(matches!(unsaid, LandmarkError::Needs { .. }), "{unsaid}");
}

#[test]
fn a_damaged_matlab_file_is_an_error_or_a_film() {
    let Some(folder) = folder() else { return };
    let path = folder.join("mat_samples/sunhl-1th-02-Jan-2017-162 A AP.jpg.mat");
    let bytes = std::fs::read(path).expect("bytes");
    for end in 0..bytes.len() {
        let cut = parse_mat(&bytes[..end], &hint());
        // The checksum of the compressed variable comes last, and is not needed for the numbers.
        assert!(cut.is_err() || end + 8 > bytes.len(), "cut at {end}");
    }
    for place in 0..bytes.len() {
        for bit in 0..8 {
            let mut changed = bytes.clone();
            changed[place] ^= 1 << bit;
            if let Ok(file) = parse_mat(&changed, &hint()) {
                assert_eq!(file.films[0].vertebrae(), 17);
            }
        }
    }
}

#[test]
fn cobb_angles_by_endplates_are_about_one_degree_above_those_of_the_data_set() {
    // Oracle: the set's own angles are differences of mean endplate tilts; between superior and inferior endplates they are
    // about 1° larger. Axes gave 8°.
    let Some(folder) = folder() else { return };
    let angles =
        std::fs::read_to_string(folder.join("labels/training/angles.csv")).expect("angles");
    let main: Vec<f64> = angles
        .lines()
        .map(|line| line.split(',').next().expect("a column").parse().expect("a number"))
        .collect();
    let mut off: Vec<f64> = Vec::new();
    for row in rows(&folder) {
        let clean = judge_aasce(&row.film, ImageSide::Right).expect("a film with its size");
        let LandmarkReadings::Corners(readings) = &row.film.landmarks else { panic!("corners") };
        let (columns, rows) = row.film.size.expect("a size");
        let image = ImageGeometry { columns, rows, spacing: None, patient_left: ImageSide::Right };
        let landmarks =
            FilmLandmarks::Corners { image, iliac_crests: None, readings: readings.clone() };
        let film = Film { posture: Posture::Erect, landmarks };
        let case = Case {
            id: "aasce".to_owned(),
            synthetic: false,
            subject: Subject::default(),
            films: vec![film],
            lateral: None,
        };
        let Ok(analysis) = analyze(&case, &AnalysisOptions::default()) else { continue };
        if let (AasceVerdict::Clean { .. }, Some(curve)) = (clean, analysis.main_curve()) {
            off.push(curve.erect_size().abs().deg() - main[row.row]);
        }
    }
    let n = off.len() as f64;
    let mean = off.iter().sum::<f64>() / n;
    let sd = (off.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let above_ten = off.iter().filter(|d| d.abs() > 10.0).count();
    println!("{n} films: mean {mean:.2}°, SD {sd:.2}°, more than 10° in {above_ten}");
    assert!(n > 400.0 && mean.abs() < 2.0 && sd < 6.0, "{mean} {sd}");
}
