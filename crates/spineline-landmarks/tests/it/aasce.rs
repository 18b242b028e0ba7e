//! The public AASCE landmarks: known errors are found, and valid films have the angles of the set.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use spineline::analysis::{AnalysisOptions, Case, analyze, check_repeated};
use spineline::anatomy::{ImageSide, Level, Posture};
use spineline::measure::{Film, FilmLandmarks, ImageGeometry, judge_landmarks};
use spineline::spatial::Pixel;
use spineline::warning::WarningCode;
use spineline_landmarks::{
    AasceRow, AasceRows, AasceVerdict, LandmarkError, LandmarkHint, LandmarkReadings, image_sizes,
    judge_aasce, parse_mat,
};

use crate::count_vertebrae;

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

/// The side with the patient's left on all pictures that show it.
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

/// The main angles of the data set, by row.
fn main_angles_deg(folder: &std::path::Path) -> Vec<f64> {
    let angles = std::fs::read_to_string(folder.join("labels/training/angles.csv"));
    let first = |line: &str| line.split(',').next().map(str::parse);
    let angles = angles.expect("angles");
    angles.lines().map(|line| first(line).expect("a column").expect("a number")).collect()
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
    // On row 143 two neighbouring distances are 1.4 times their share, between one and two vertebrae, so neither is
    // found. On row 313 the too long distance stays below the limit with distances from CT (decision 0047).
    let missed: Vec<usize> = (&by_geometry - &caught).into_iter().collect();
    assert!(missed == [143, 313], "missed: {missed:?}");
    // Two in a hundred: the limits of the core (0.6 and 1.6 of the usual distance) and the distances, from adults in
    // CT, were not chosen on these films.
    assert!(false_alarms.len() * 50 <= ROWS, "false alarms: {false_alarms:?}");
}

/// The films that a case can hold, by row; crossed corners and similar errors are refused before.
fn films(rows: &[AasceRow]) -> BTreeMap<usize, Film> {
    let film = |row: &AasceRow| {
        let (columns, rows) = row.film.size?;
        let patient_left = ImageSide::Right;
        let image = ImageGeometry { columns, rows, spacing: None, patient_left };
        row.film.clone().into_film(Some(Posture::Erect), Some(image)).ok()
    };
    rows.iter().filter_map(|row| Some((row.row, film(row)?))).collect()
}

/// The film with one corner of one vertebra moved by a part of its body's diagonal.
fn moved(film: &Film, (body, corner): (usize, usize), part: f64, direction: f64) -> Film {
    let mut film = film.clone();
    let all = &mut film.landmarks.corner_readings_mut()[0].vertebrae;
    let level = *all.keys().nth(body % all.len()).expect("a vertebra");
    let corners = &mut all.get_mut(&level).expect("marked").corners;
    let apart = |a: Pixel, b: Pixel| (a.column_px - b.column_px).hypot(a.row_px - b.row_px);
    let diagonal = apart(corners.superior_left, corners.inferior_right)
        .max(apart(corners.superior_right, corners.inferior_left));
    let place = match corner {
        0 => &mut corners.superior_left,
        1 => &mut corners.superior_right,
        2 => &mut corners.inferior_left,
        _ => &mut corners.inferior_right,
    };
    place.column_px += part * diagonal * direction.cos();
    place.row_px += part * diagonal * direction.sin();
    film
}

#[test]
fn warnings_about_corners_are_rare_on_valid_films_and_find_moved_corners() {
    let Some(folder) = folder() else { return };
    let rows = rows(&folder);
    let flagged = &flags(&folder, "geometry check") | &flags(&folder, "scoliosistools");
    let films = films(&rows);
    let mut counts: BTreeMap<WarningCode, [usize; 2]> = BTreeMap::new();
    for (row, film) in &films {
        let codes: BTreeSet<WarningCode> =
            judge_landmarks(film).all().iter().map(|warning| warning.code).collect();
        for code in codes {
            counts.entry(code).or_default()[usize::from(flagged.contains(row))] += 1;
        }
    }
    let valid = films.keys().filter(|row| !flagged.contains(row)).count();
    println!("{valid} unflagged and {} flagged films: {counts:?}", films.len() - valid);
    let unflagged = |code: WarningCode| counts.get(&code).map_or(0, |count| count[0]);
    assert!(
        unflagged(WarningCode::CornerFarFromNeighbours) * 50 <= valid,
        "more than 2 %: {counts:?}"
    );
    assert!(unflagged(WarningCode::BodySidesDiffer) * 50 <= valid, "more than 2 %: {counts:?}");

    // Every corner in turn, in directions without a pattern.
    let sound: Vec<&Film> = films
        .iter()
        .filter(|(row, film)| !flagged.contains(row) && judge_landmarks(film).all().is_empty())
        .map(|(_, film)| film)
        .collect();
    let mut found = BTreeMap::new();
    for percent in [20, 30, 40, 50, 60] {
        let is_found = |(index, film): &(usize, &&Film)| {
            let direction = 2.399_963 * (index + percent) as f64;
            let odd = moved(film, (index / 4, index % 4), percent as f64 / 100.0, direction);
            judge_landmarks(&odd).has(WarningCode::CornerFarFromNeighbours)
        };
        let count = sound.iter().enumerate().filter(is_found).count();
        found.insert(percent, 100 * count / sound.len());
    }
    println!("of {} films, found (%) by displacement (% of the diagonal): {found:?}", sound.len());
    assert!(found[&40] >= 60 && found[&60] >= 85, "{found:?}");
}

#[test]
fn no_two_films_of_the_set_are_taken_as_one() {
    let Some(folder) = folder() else { return };
    let films: Vec<Film> = films(&rows(&folder)).into_values().collect();
    let mut equal = 0;
    for (index, film) in films.iter().enumerate() {
        for other in &films[..index] {
            let other = Film { posture: Posture::Neutral, ..other.clone() };
            equal += usize::from(check_repeated(&[film.clone(), other], None).is_err());
        }
    }
    println!("{equal} pairs of {} films have the same landmarks", films.len());
    assert_eq!(equal, 0);
}

#[test]
fn the_main_angle_of_valid_films_equals_that_of_the_data_set() {
    let Some(folder) = folder() else { return };
    let main = main_angles_deg(&folder);
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
                assert_eq!(count_vertebrae(&file.films[0]), 17);
            }
        }
    }
}

#[test]
fn cobb_angles_by_endplates_are_about_one_degree_above_those_of_the_data_set() {
    // Oracle: the set's own angles are differences of mean endplate tilts; between superior and inferior endplates they are
    // about 1° larger. Axes gave 8°.
    let Some(folder) = folder() else { return };
    let main = main_angles_deg(&folder);
    let mut off: Vec<f64> = Vec::new();
    for row in rows(&folder) {
        let clean = judge_aasce(&row.film, ImageSide::Right).expect("a film with its size");
        let LandmarkReadings::Corners(readings) = &row.film.landmarks else { panic!("corners") };
        let (columns, rows) = row.film.size.expect("a size");
        let image = ImageGeometry { columns, rows, spacing: None, patient_left: ImageSide::Right };
        let landmarks =
            FilmLandmarks::Corners { image, iliac_crests: None, readings: readings.clone() };
        let case = Case::of_films("aasce", vec![Film::new(Posture::Erect, landmarks)]);
        let Ok(analysis) = analyze(&case, &AnalysisOptions::default()) else { continue };
        if let (AasceVerdict::Clean { .. }, Some(curve)) = (clean, analysis.movement.main_curve()) {
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
