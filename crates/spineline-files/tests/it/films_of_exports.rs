//! Films in exported models: poses that balance the force of their film, mirrored with the model, and left out without an equilibrium.

use spineline::action::Application;
use spineline::analysis::PersonalisedModel;
use spineline::anatomy::Posture;
use spineline::multibody::{PathEnding, Support};
use spineline::spatial::{Mat3, Vec3};
use spineline_files::{ExportError, ExportFormat, export};

use super::exports::{Element, exported, mirrored, model, named, numbers, read, rotation};

/// The tolerance of the solver on hinges of a few hundred N·m/rad.
const NM: f64 = 1e-6;
const RAD: f64 = 1e-9;

/// The same model with small forces at T2's midpoint.
fn pushed_at_t2(support: Support) -> PersonalisedModel {
    let mut model = model(support);
    for load in &mut model.loads {
        load.application = Application::AtT2;
        load.direction = [0.0, 0.8, -0.6];
        load.force_n = if load.posture == Posture::RightBending { -15.0 } else { 15.0 };
    }
    model
}

fn vector(element: &Element, key: &str) -> Vec3 {
    Vec3::from_column_slice(&numbers(element.attribute(key)))
}

/// A hinge of a posed MJCF model.
struct Hinge {
    axis: Vec3,
    centre_m: Vec3,
    spring_nm: f64,
}

/// The hinges and T2's midpoint in a pose, from the numbers of the file alone.
fn posed(all: &[Element], qpos: &[f64]) -> (Vec<Hinge>, Vec3) {
    let (mut place, mut axes, mut hinges) = (Vec3::zeros(), Mat3::identity(), Vec::<Hinge>::new());
    for element in all {
        if element.path.ends_with("/body") {
            place += axes * vector(element, "pos");
            axes *= rotation(&numbers(element.attribute("quat")));
        } else if element.path.ends_with("/joint") {
            let (centre, angle) = (vector(element, "pos"), qpos[hinges.len()]);
            let (axis, centre_m) = (axes * vector(element, "axis"), place + axes * centre);
            let stiffness = numbers(element.attribute("stiffness"))[0];
            let half = axis * (angle / 2.0).sin();
            axes = rotation(&[(angle / 2.0).cos(), half.x, half.y, half.z]) * axes;
            place = centre_m - axes * centre;
            hinges.push(Hinge { axis, centre_m, spring_nm: stiffness * angle });
        }
    }
    assert_eq!(hinges.len(), qpos.len());
    (hinges, place)
}

fn with_name<'a>(all: &'a [Element], kind: &str, name: &str) -> &'a Element {
    let mut elements = named(all, kind).into_iter().filter(|e| !e.path.contains("/default/"));
    let found = elements.find(|element| element.attribute("name") == name);
    found.unwrap_or_else(|| panic!("no {kind} {name}"))
}

#[test]
fn in_every_keyframe_the_springs_balance_the_force_of_its_film() {
    // Oracle: the moment of a force about an axis, from the file's own numbers.
    let models = [Support::Free, Support::Frontal].map(|s| [model(s), pushed_at_t2(s)]);
    for model in models.as_flattened() {
        let (all, comments) = read(&exported(model, ExportFormat::Mjcf));
        let keys = named(&all, "key");
        assert_eq!(keys.len(), model.loads.len(), "{}", comments[0]);
        for (key, load) in keys.iter().zip(&model.loads) {
            let name = load.posture.key();
            assert_eq!(key.attribute("name"), name);
            let (hinges, top_m) = posed(&all, &numbers(key.attribute("qpos")));
            let force_n = vector(with_name(&all, "numeric", &format!("{name}_force")), "data");
            let site = with_name(&all, "site", &format!("{name}_load"));
            let in_space = site.path == "mujoco/worldbody/site";
            assert_eq!(in_space, load.application == Application::Fixed);
            let point_m = vector(site, "pos") + if in_space { Vec3::zeros() } else { top_m };
            assert!(force_n.norm() > 1.0 && hinges.iter().any(|h| h.spring_nm.abs() > 0.1));
            for hinge in hinges {
                let moment_nm = hinge.axis.dot(&(point_m - hinge.centre_m).cross(&force_n));
                assert!((hinge.spring_nm - moment_nm).abs() < NM, "{name}");
            }
        }
    }
}

/// Names of the columns of a motion, and its rows without the time.
fn motion(model: &PersonalisedModel) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = exported(model, ExportFormat::Sto);
    let (header, table) = text.split_once("endheader\n").expect("a header");
    let mut lines = table.lines();
    let columns: Vec<String> =
        lines.next().expect("names").split('\t').skip(1).map(str::to_owned).collect();
    let rows: Vec<Vec<f64>> = lines.map(|line| numbers(&line.replace('\t', " "))).collect();
    assert!(header.contains(&format!("\nnRows={}\n", rows.len())), "{header}");
    assert!(header.contains(&format!("\nnColumns={}\n", columns.len() + 1)), "{header}");
    assert!(header.contains("SYNTHETIC"), "{header}");
    for (second, row) in rows.iter().enumerate() {
        assert_eq!((row.len(), row[0]), (columns.len() + 1, second as f64));
    }
    (columns, rows.into_iter().map(|row| row[1..].to_vec()).collect())
}

#[test]
fn the_motion_of_opensim_has_the_poses_of_the_keyframes() {
    for support in [Support::Free, Support::Frontal] {
        let model = model(support);
        let (columns, rows) = motion(&model);
        let (all, _) = read(&exported(&model, ExportFormat::Osim));
        let coordinates = named(&all, "Coordinate");
        let names: Vec<&str> = coordinates.iter().map(|c| c.attribute("name")).collect();
        let hinges = names.len();
        assert_eq!(columns[..hinges], names);
        assert!(rows[0].iter().all(|number| *number == 0.0), "erect");
        let (all, _) = read(&exported(&model, ExportFormat::Mjcf));
        let free: Vec<&str> = named(&all, "joint").iter().map(|j| j.attribute("name")).collect();
        for (row, key) in rows[1..].iter().zip(named(&all, "key")) {
            let angles = columns[..hinges].iter().zip(row);
            let (turning, locked): (Vec<_>, Vec<_>) =
                angles.partition(|(name, _)| free.contains(&name.as_str()));
            let angles: Vec<f64> = turning.into_iter().map(|(_, angle)| *angle).collect();
            assert_eq!(angles, numbers(key.attribute("qpos")));
            assert!(locked.into_iter().all(|(_, angle)| *angle == 0.0));
        }
    }
}

#[test]
fn external_loads_have_the_forces_of_the_motion_at_points_of_their_lines() {
    // Oracle: the forces of the model; a line through T2's midpoint passes the midpoint of the pose.
    for model in [model(Support::Free), pushed_at_t2(Support::Free)] {
        let (all, comments) = read(&exported(&model, ExportFormat::Loads));
        assert!(comments[0].contains("SYNTHETIC"));
        let text = |kind: &str| named(&all, kind)[0].text.clone();
        assert_eq!(text("applied_to_body"), "T2");
        assert_eq!(text("datafile"), "films.sto");
        let (columns, rows) = motion(&model);
        let vector = |row: &[f64], kind: &str| {
            let part = |axis| {
                let name = format!("{}{axis}", text(kind));
                row[columns.iter().position(|column| *column == name).expect("a column")]
            };
            // OpenSim's x, y, z are anterior, cranial and right.
            Vec3::new(part("x"), -part("z"), part("y"))
        };
        let (bodies, _) = read(&exported(&model, ExportFormat::Mjcf));
        assert_eq!(rows.len(), 1 + model.loads.len());
        for ((row, load), key) in rows[1..].iter().zip(&model.loads).zip(named(&bodies, "key")) {
            let force_n = vector(row, "force_identifier");
            assert!((force_n - load.force_vector_n()).norm() < 1e-9, "{:?}", load.posture);
            let point_m = vector(row, "point_identifier");
            let expected_m = match load.application {
                Application::Fixed => Vec3::from(load.point_mm) / 1000.0,
                Application::AtT2 => posed(&bodies, &numbers(key.attribute("qpos"))).1,
            };
            assert!((point_m - expected_m).norm() < 1e-9, "{:?}", load.posture);
        }
    }
}

#[test]
fn a_mirrored_model_has_mirrored_films() {
    let model = model(Support::Free);
    let mut other = mirrored(&model);
    for load in &mut other.loads {
        load.point_mm[1] *= -1.0;
        load.direction[1] *= -1.0;
    }
    let (columns, rows) = motion(&model);
    for (one, two) in rows.iter().zip(motion(&other).1) {
        for ((name, a), b) in columns.iter().zip(one).zip(two) {
            // OpenSim's x is anterior and its y cranial.
            let stays =
                ["_flexion", "_vx", "_vy", "_px", "_py"].iter().any(|end| name.ends_with(end));
            let sign = if stays { 1.0 } else { -1.0 };
            assert!((sign * a - b).abs() < RAD, "{name}");
        }
    }
    let points = [model, other].map(|model| {
        let (all, _) = read(&exported(&model, ExportFormat::Osim));
        let values = all
            .iter()
            .filter(|e| e.path.ends_with("PrescribedForce/FunctionSet/objects/Constant/value"));
        values.map(|value| numbers(&value.text)[0]).collect::<Vec<f64>>()
    });
    assert_eq!(points[0].len(), 6 * 4, "force and point of four films");
    for (i, (a, b)) in points[0].iter().zip(&points[1]).enumerate() {
        // OpenSim's z is to the patient's right.
        assert!((if i % 3 == 2 { a + b } else { a - b }).abs() < 1e-12);
    }
}

#[test]
fn a_film_without_an_equilibrium_has_no_pose_and_the_file_says_why() {
    let mut model = model(Support::Free);
    model.loads[0].status = PathEnding::Unreachable;
    // A force that folds the spine.
    model.loads[1].force_n = -1e5;
    model.loads[1].application = Application::AtT2;
    let missing = [model.loads[0].posture.key(), model.loads[1].posture.key()];
    for format in [
        ExportFormat::Mjcf,
        ExportFormat::Osim,
        ExportFormat::Urdf,
        ExportFormat::Sto,
        ExportFormat::Loads,
    ] {
        let text = exported(&model, format);
        let lines: Vec<&str> = text.lines().filter(|line| line.contains("so no pose")).collect();
        assert_eq!(lines.len(), 2, "{format:?}");
        assert!(lines[0].contains(missing[0]) && lines[0].contains("no pose: unreachable"));
        assert!(lines[1].contains(missing[1]), "{}", lines[1]);
    }
    let (all, _) = read(&exported(&model, ExportFormat::Mjcf));
    assert_eq!(named(&all, "key").len(), model.loads.len() - 2);
    assert_eq!(named(&all, "numeric").len(), model.loads.len() - 2);
    let (all, _) = read(&exported(&model, ExportFormat::Osim));
    assert_eq!(named(&all, "PrescribedForce").len(), model.loads.len() - 2);
    assert!(named(&all, "appliesForce").iter().all(|applies| applies.text == "false"));
    assert_eq!(motion(&model).1.len(), model.loads.len() - 1, "the erect row and the others");
    model.loads[1] = model.loads[0];
    let error = export(&model, ExportFormat::Mjcf, "test").expect_err("two films of one name");
    assert_eq!(error, ExportError::FilmTwice { posture: model.loads[0].posture });
}
