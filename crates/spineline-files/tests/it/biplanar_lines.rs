//! The spine in space on biplanar X-rays of real patients, beside the line in space that others made of the same films.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use serde_json::{Value, json};
use spineline::analysis::{Analysis, AnalysisOptions, analyze};
use spineline::anatomy::{Level, Morphometry, SagittalProfile};
use spineline::measure::SpatialOutline;
use spineline::spatial::Vec3;
use spineline_files::parse_case;

/// Of both pictures, by the source of the data.
const PIXEL_MM: f64 = 0.179_363;
/// Larger than any of them.
const PICTURE_PX: [u32; 2] = [3000, 9000];

/// The lines of one patient.
struct Lines {
    /// Through the vertebral bodies on each film: column by row, in pixels, downwards.
    frontal: Vec<[f64; 2]>,
    lateral: Vec<[f64; 2]>,
    /// The line in space of the source: to the patient's right, downwards, anterior, in mm.
    in_space_mm: Vec<[f64; 3]>,
}

fn patients() -> Option<Vec<Lines>> {
    const FOLDER: &str = "pcdare/xray_lines_upright30";
    let data = std::env::var_os("SPINELINE_DATA").map(PathBuf::from);
    let Some(folder) = data.and_then(|data| fs::read_dir(data.join(FOLDER)).ok()) else {
        println!("skipped: SPINELINE_DATA is not set, or holds no folder `{FOLDER}`");
        return None;
    };
    let mut paths: Vec<PathBuf> = folder.map(|entry| entry.expect("a file").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "json"));
    paths.sort();
    let read = |path: &PathBuf| {
        let file: Value = serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON");
        let number = |value: &Value| value.as_f64().expect("a number");
        let points = |key: &str| file[key].as_array().expect("points").clone();
        let pixels = |key: &str| {
            let mut line: Vec<[f64; 2]> = points(key)
                .iter()
                .map(|point| [0, 1].map(|i| number(&point["Pixel"][i])))
                .collect();
            line.sort_by(|a, b| a[1].total_cmp(&b[1]));
            line
        };
        let in_space = points("islLinePts");
        Lines {
            frontal: pixels("apLinePts"),
            lateral: pixels("latLinePts"),
            in_space_mm: in_space.iter().map(|p| [0, 1, 2].map(|i| number(&p[i]))).collect(),
        }
    };
    Some(paths.iter().map(read).collect())
}

/// Column of a line at a row, straight between its points.
fn column(line: &[[f64; 2]], row: f64) -> f64 {
    let above = line.partition_point(|point| point[1] < row).clamp(1, line.len() - 1);
    let [from, to] = [line[above - 1], line[above]];
    from[0] + (to[0] - from[0]) * (row - from[1]) / (to[1] - from[1])
}

/// Corners of a body whose endplates are square to the line, with their centres on it: first on the left of the picture.
fn body(line: &[[f64; 2]], [top, bottom]: [f64; 2], width_px: f64) -> [[f64; 2]; 4] {
    let centres = [top, bottom].map(|row| [column(line, row), row]);
    let along = [centres[1][0] - centres[0][0], centres[1][1] - centres[0][1]];
    let half = 0.5 * width_px / along[0].hypot(along[1]);
    let [upper, lower] = centres.map(|[column, row]| {
        [-half, half].map(|half| [column + half * along[1], row - half * along[0]])
    });
    [upper[0], upper[1], lower[0], lower[1]]
}

/// A case of both films. Levels share the height of both lines, T1 to L5, as typical vertebrae do.
fn case_of(id: &str, lines: &Lines) -> String {
    let ends = |line: &[[f64; 2]]| [line[0][1], line[line.len() - 1][1]];
    let [frontal, lateral] = [ends(&lines.frontal), ends(&lines.lateral)];
    let (top, bottom) = (frontal[0].max(lateral[0]), frontal[1].min(lateral[1]));
    let above_sacrum_mm =
        |level| Morphometry::L5_ABOVE_SACRUM_MM + Morphometry::spacing_mm(Level::L5, level);
    let typical_mm = above_sacrum_mm(Level::T1) + 0.5 * Morphometry::of(Level::T1).spacing_above_mm;
    let px_per_mm = (bottom - top) / typical_mm;
    let (mut on_frontal, mut on_lateral) = (serde_json::Map::new(), serde_json::Map::new());
    for level in Level::ALL {
        let size = Morphometry::of(level);
        let middle = bottom - above_sacrum_mm(level) * px_per_mm;
        let half = 0.5 * size.body_height_mm * px_per_mm;
        let rows = [middle - half, middle + half];
        let [a, b, c, d] = body(&lines.frontal, rows, size.superior_width_mm / PIXEL_MM);
        on_frontal.insert(
            level.to_string(),
            json!({ "superior_left": b, "superior_right": a, "inferior_left": d, "inferior_right": c }),
        );
        let [a, b, c, d] = body(&lines.lateral, rows, size.superior_depth_mm / PIXEL_MM);
        on_lateral.insert(
            level.to_string(),
            json!({ "superior_anterior": a, "superior_posterior": b, "inferior_anterior": c,
                "inferior_posterior": d }),
        );
    }
    let image = json!({ "columns": PICTURE_PX[0], "rows": PICTURE_PX[1], "column_spacing_mm": PIXEL_MM,
        "row_spacing_mm": PIXEL_MM, "spacing_plane": "patient", "patient_left": "image_right" });
    let from_side = json!({ "columns": PICTURE_PX[0], "rows": PICTURE_PX[1],
        "column_spacing_mm": PIXEL_MM, "row_spacing_mm": PIXEL_MM, "patient_anterior": "image_left" });
    let reading = |vertebrae| json!([{ "observer": "A", "repeat": 1, "vertebrae": vertebrae }]);
    json!({ "format": "spineline-case", "version": 1, "case_id": id, "synthetic": false,
        "films": [{ "posture": "erect", "image": image, "readings": reading(on_frontal) }],
        "lateral": { "image": from_side, "simultaneous": true, "readings": reading(on_lateral) } })
    .to_string()
}

fn analyzed(lines: &Lines) -> Analysis {
    let case = parse_case(&case_of("biplanar", lines)).expect("a case");
    analyze(&case, &AnalysisOptions::default()).expect("a sound case")
}

/// The nearest place of a polyline.
fn nearest(line: &[Vec3], place: &Vec3) -> Vec3 {
    let on_link = |link: &[Vec3]| {
        let along = link[1] - link[0];
        let share =
            ((place - link[0]).dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        link[0] + along * share
    };
    let off = |a: &Vec3| (a - place).norm();
    let places = line.windows(2).map(on_link);
    places.min_by(|a, b| off(a).total_cmp(&off(b))).expect("a link")
}

/// Mean distance of the vertebrae from the line of the source, once both lie in one place: their frames are parallel.
fn distance_mm(space: &SpatialOutline, lines: &Lines) -> f64 {
    let theirs: Vec<Vec3> = lines
        .in_space_mm
        .iter()
        .map(|[right, down, ahead]| Vec3::new(*ahead, -right, -down))
        .collect();
    let mut ours: Vec<Vec3> = space.vertebrae.iter().map(|vertebra| vertebra.place_mm).collect();
    let count = ours.len() as f64;
    // Heights of both are rows of one scanner; the source's lowest point lies at or below the lowest vertebra.
    let lowest = theirs.iter().fold(theirs[0], |a, b| if b.z < a.z { *b } else { a });
    ours.iter_mut().for_each(|place| *place += lowest);
    for _ in 0..200 {
        let shift: Vec3 =
            ours.iter().map(|place| nearest(&theirs, place) - place).sum::<Vec3>() / count;
        ours.iter_mut().for_each(|place| *place += shift);
        if shift.norm() < 1e-6 {
            break;
        }
    }
    ours.iter().map(|place| (nearest(&theirs, place) - place).norm()).sum::<f64>() / count
}

#[test]
fn vertebrae_of_biplanar_films_lie_on_the_line_in_space_of_others() {
    let Some(patients) = patients() else { return };
    let template = SagittalProfile::default();
    let mut of_template: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (number, lines) in patients.iter().enumerate() {
        let analysis = analyzed(lines);
        let space = analysis.movement.space.as_ref().expect("both films show all vertebrae");
        let distance = distance_mm(space, lines);
        let own = space.profile(&template);
        let [kyphosis, lordosis] =
            [&own.turns_deg[4..14], &own.turns_deg[..3]].map(|turns| turns.iter().sum::<f64>());
        let off = own.turns_deg.iter().zip(&template.turns_deg).map(|(own, usual)| own - usual);
        let squares: f64 = off.clone().map(|off| off * off).sum();
        // Pitch of every vertebra above the lowest one, as the template has it, minus the measured one.
        let pitch = off.scan(0.0, |sum, off| {
            *sum += off;
            Some(*sum)
        });
        let farthest = pitch.fold(0.0, |most: f64, off| most.max(off.abs()));
        println!(
            "file {number}: {distance:.2} mm from their line; T12 to T2 {kyphosis:.0}°, L4 to L1 {lordosis:.0}°; template: {:.1}° at a joint, {farthest:.0}° at most at a vertebra",
            (squares / 14.0).sqrt()
        );
        let error = analysis.template_error().expect("both films show all vertebrae");
        let by_hand = (squares / 14.0).sqrt();
        assert!((error.joint_rms.deg() - by_hand).abs() < 1e-9, "file {number}");
        of_template.entry("joint").or_default().push(by_hand);
        of_template.entry("vertebra, the lowest one in place").or_default().push(farthest);
        let mut add = |what, value| of_template.entry(what).or_default().push(value);
        add("vertebra, the top above the base: root mean square", error.vertebra_rms.deg());
        add("vertebra, the top above the base: worst", error.worst().1.deg());
        add("depth in mm, root mean square", error.depth_rms_mm);
        assert!(distance < 2.0, "file {number}: {distance:.2} mm");
        assert!(space.alignment.residual_mm < 1.0, "heights of one scanner agree");
    }
    for (what, values) in of_template {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let [low, high] = [f64::min, f64::max].map(|of| values.iter().copied().reduce(of));
        let (low, high) = low.zip(high).expect("at least one patient");
        println!("template, {what}: {mean:.1} ({low:.1} to {high:.1})");
    }
}

/// For the picture of all profiles, by `spineline report target/biplanar/*.json --out target/profiles.html`. Its data stay out of
/// the project.
#[test]
#[ignore = "writes cases of real patients to target/biplanar, for a picture of their profiles"]
fn cases_of_biplanar_films_are_written() {
    let Some(patients) = patients() else { return };
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/biplanar"));
    fs::create_dir_all(&folder).expect("a folder");
    for (number, lines) in patients.iter().enumerate() {
        let id = format!("biplanar-{:02}", number + 1);
        fs::write(folder.join(format!("{id}.json")), case_of(&id, lines)).expect("written");
    }
}
