//! Models in other programs' formats: well-formed, complete, mirrored with the model, and with escaped names.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use spineline::analysis::{AnalysisOptions, Case, PersonalisedModel, analyze};
use spineline::anatomy::Posture;
use spineline::multibody::{SpineModel, Support};
use spineline::spatial::{Angle, Mat3, Pixel, Vec3, rotation_x, rotation_y, rotation_z};
use spineline_files::{ExportError, ExportFormat, export};
use spineline_phantom::{Readers, Scenario, generate};

const FORMATS: [ExportFormat; 3] = [ExportFormat::Mjcf, ExportFormat::Osim, ExportFormat::Urdf];

pub(super) fn model(support: Support) -> PersonalisedModel {
    let case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists").case;
    let options = AnalysisOptions { support, ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a phantom");
    analysis.personalised_model(&analysis.models[0])
}

/// The text of a model in a format.
pub(super) fn exported(model: &PersonalisedModel, format: ExportFormat) -> String {
    export(model, format, "test").expect("a good model")
}

/// An element as it was read back: path from the root, attributes, text.
#[derive(Debug, Default)]
pub(super) struct Element {
    pub(super) path: String,
    attributes: Vec<(String, String)>,
    pub(super) text: String,
}

impl Element {
    pub(super) fn attribute(&self, key: &str) -> &str {
        let found = self.attributes.iter().find(|(name, _)| name == key);
        found.map_or_else(|| panic!("no `{key}` in {self:?}"), |(_, value)| value)
    }

    fn name(&self) -> &str {
        self.path.rsplit('/').next().expect("a path has an end")
    }

    fn numbers(&self, key: &str) -> Vec<f64> {
        numbers(self.attribute(key))
    }
}

pub(super) fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|n| n.parse().expect("a number")).collect()
}

fn element(open: &[String], start: &BytesStart<'_>) -> Element {
    let attributes = start
        .attributes()
        .map(|attribute| {
            let attribute = attribute.expect("well-formed, and no key twice");
            let value = quick_xml::escape::unescape(&attribute.value).expect("known entities");
            (attribute.key.as_ref().to_owned(), value.into_owned())
        })
        .collect();
    Element { path: open.join("/"), attributes, text: String::new() }
}

/// All elements in order, and all comments; anything that is not well-formed panics.
pub(super) fn read(text: &str) -> (Vec<Element>, Vec<String>) {
    let mut reader = Reader::from_str(text);
    let config = reader.config_mut();
    (config.check_comments, config.check_end_names) = (true, true);
    let name = |start: &BytesStart<'_>| start.name().as_ref().to_owned();
    let (mut open, mut at, mut all, mut comments) = (Vec::new(), Vec::new(), Vec::new(), vec![]);
    loop {
        match reader.read_event().expect("well-formed") {
            Event::Start(start) => {
                open.push(name(&start));
                at.push(all.len());
                all.push(element(&open, &start));
            }
            Event::Empty(start) => {
                open.push(name(&start));
                all.push(element(&open, &start));
                open.pop();
            }
            Event::End(_) => {
                open.pop();
                at.pop();
            }
            Event::Text(part) => {
                if let Some(&place) = at.last() {
                    all[place].text.push_str(&part);
                }
            }
            Event::GeneralRef(part) => {
                let place = *at.last().expect("inside of an element");
                let entity = format!("&{};", &*part);
                all[place].text.push_str(&quick_xml::escape::unescape(&entity).expect("known"));
            }
            Event::Comment(part) => comments.push(part.to_string()),
            Event::Eof => break,
            _ => {}
        }
    }
    assert!(open.is_empty(), "every element is closed");
    (all, comments)
}

pub(super) fn named<'a>(all: &'a [Element], name: &str) -> Vec<&'a Element> {
    all.iter().filter(|element| element.name() == name).collect()
}

/// Name and stiffness of every spring that a file holds.
fn springs(all: &[Element], format: ExportFormat) -> Vec<(String, f64)> {
    let own = |text: &str| text.trim().parse::<f64>().expect("a number");
    match format {
        ExportFormat::Mjcf => named(all, "joint")
            .iter()
            .map(|joint| (joint.attribute("name").to_owned(), own(joint.attribute("stiffness"))))
            .collect(),
        ExportFormat::Osim => {
            let coordinates = all.iter().filter(|e| e.path.ends_with("Force/coordinate"));
            let values = named(all, "stiffness");
            coordinates.zip(values).map(|(c, v)| (c.text.clone(), own(&v.text))).collect()
        }
        ExportFormat::Urdf => named(all, "gazebo")
            .iter()
            .zip(named(all, "springStiffness"))
            .map(|(g, v)| (g.attribute("reference").to_owned(), own(&v.text)))
            .collect(),
        ExportFormat::Sto | ExportFormat::Loads | ExportFormat::Vtp | ExportFormat::Gltf => {
            Vec::new()
        }
    }
}

#[test]
fn every_spring_is_exported_with_its_value() {
    let model = model(Support::Free);
    for format in FORMATS {
        let (all, comments) = read(&exported(&model, format));
        let found = springs(&all, format);
        let mut wanted = Vec::new();
        for (pair, k) in model.levels.windows(2).zip(&model.stiffness_nmm_per_rad) {
            for (word, k) in ["lateral", "flexion", "axial"].iter().zip(k) {
                wanted.push((format!("{}_{}_{word}", pair[0], pair[1]), k / 1000.0));
            }
        }
        assert_eq!(found, wanted, "{format:?}");
        for word in ["SYNTHETIC", "not a medical device", "phantom-rod-01", "RELATIVE", "NOMINAL"] {
            assert!(comments[0].contains(word), "{word} in {format:?}");
        }
    }
}

#[test]
fn locked_hinges_are_omitted_or_locked() {
    let model = model(Support::Frontal);
    for format in [ExportFormat::Mjcf, ExportFormat::Urdf] {
        let (all, comments) = read(&exported(&model, format));
        assert_eq!(springs(&all, format).len(), 14);
        assert!(springs(&all, format).iter().all(|(name, _)| name.ends_with("_lateral")));
        assert!(comments[0].contains("locked"), "{}", comments[0]);
    }
    let (all, _) = read(&exported(&model, ExportFormat::Osim));
    for (coordinate, locked) in named(&all, "Coordinate").iter().zip(named(&all, "locked")) {
        let lateral = coordinate.attribute("name").ends_with("_lateral");
        assert_eq!(locked.text, if lateral { "false" } else { "true" });
    }
}

#[test]
fn urdf_joints_form_a_chain_without_gaps() {
    let model = model(Support::Free);
    let (all, _) = read(&exported(&model, ExportFormat::Urdf));
    let links = |name| named(&all, name).iter().map(|e| e.attribute("link")).collect::<Vec<_>>();
    let (parents, children) = (links("parent"), links("child"));
    assert_eq!(parents[0], "world");
    assert_eq!(parents[1..], children[..children.len() - 1], "a chain");
    let axes: Vec<_> = named(&all, "axis").iter().map(|e| e.numbers("xyz")).collect();
    assert_eq!(axes.len(), 42);
    for joint in axes.chunks(3) {
        assert_eq!(joint, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }
}

/// Rotation of a unit quaternion, scalar first.
pub(super) fn rotation(q: &[f64]) -> Mat3 {
    let (w, v) = (q[0], Vec3::new(q[1], q[2], q[3]));
    let turn = |axis: Vec3| axis + 2.0 * w * v.cross(&axis) + 2.0 * v.cross(&v.cross(&axis));
    Mat3::from_columns(&[turn(Vec3::x()), turn(Vec3::y()), turn(Vec3::z())])
}

#[test]
fn the_comment_of_a_model_has_no_last_bits() {
    let text = exported(&model(Support::Free), ExportFormat::Mjcf);
    assert!(text.contains("armature of a hinge 0.01 s2 and damping 0.2 s"), "{text}");
}

#[test]
fn mjcf_bodies_have_the_places_of_vertebrae_and_hinges_their_inferior_axes() {
    // Oracle: poses composed from the file's own numbers against the model's.
    const MM: f64 = 1e-11;
    let model = model(Support::Free);
    let (all, _) = read(&exported(&model, ExportFormat::Mjcf));
    let (mut place, mut axes) = (Vec3::zeros(), Mat3::identity());
    let joints = named(&all, "joint");
    for (i, body) in named(&all, "body").iter().enumerate() {
        let below = axes;
        place += axes * Vec3::from_column_slice(&body.numbers("pos")) * 1000.0;
        axes *= rotation(&body.numbers("quat"));
        assert!((place - model.spine.midpoints_mm[i]).norm() < MM);
        assert!((axes - model.spine.axes[i]).norm() < 1e-14);
        let Some(j) = i.checked_sub(1) else { continue };
        let centre = model.spine.midpoints_mm[j]
            + model.spine.axes[j] * model.spine.joints[j].centre_in_inferior_mm;
        for axis in 0..3 {
            let hinge = joints[3 * j + axis];
            let own = Vec3::from_column_slice(&hinge.numbers("axis"));
            assert!((axes * own - below.column(axis)).norm() < 1e-14, "x, y and z in this order");
            let at = Vec3::from_column_slice(&hinge.numbers("pos")) * 1000.0;
            assert!((place + axes * at - centre).norm() < MM);
        }
    }
}

/// Pedicles of a vertebra that is turned: not in the middle between the sides.
fn mark_pedicles(case: &mut Case, [left, right]: [f64; 2]) {
    let film = case.film_mut(Posture::Erect).expect("erect");
    for landmark in film.landmarks.corner_readings_mut()[0].vertebrae.values_mut() {
        let corners = landmark.corners;
        let middle =
            |a: Pixel, b: Pixel| [(a.column_px + b.column_px) / 2.0, (a.row_px + b.row_px) / 2.0];
        let to_left = middle(corners.superior_left, corners.inferior_left);
        let to_right = middle(corners.superior_right, corners.inferior_right);
        let at = |share: f64| {
            let [column_px, row_px] =
                [0, 1].map(|i| to_right[i] + (0.5 + share) * (to_left[i] - to_right[i]));
            Some(Pixel { column_px, row_px })
        };
        landmark.pedicles = [at(left), at(right)];
    }
}

#[test]
fn axial_rotations_from_pedicles_reach_the_bodies_of_every_format() {
    let mut case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists").case;
    mark_pedicles(&mut case, [0.35, -0.25]);
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let model = analysis.personalised_model(&analysis.models[0]);
    assert_eq!(analysis.movement.axial.len(), model.levels.len());
    let mjcf = read(&exported(&model, ExportFormat::Mjcf)).0;
    let urdf = read(&exported(&model, ExportFormat::Urdf)).0;
    let osim = read(&exported(&model, ExportFormat::Osim)).0;
    // The lowest vertebra of each file stands in the frame itself, the others in the frame of the vertebra below.
    let quaternion = named(&mjcf, "body")[0].numbers("quat");
    let [roll, pitch, yaw] = named(&urdf, "origin")[0].numbers("rpy")[..] else {
        panic!("three angles");
    };
    let fixed = rotation_z(Angle::from_rad(yaw))
        * rotation_y(Angle::from_rad(pitch))
        * rotation_x(Angle::from_rad(roll));
    for axes in [rotation(&quaternion), fixed] {
        assert!((axes - model.spine.axes[0]).norm() < 1e-14);
    }
    assert!(named(&osim, "orientation").len() > model.levels.len());
    for (axes, found) in model.spine.axes.iter().zip(&analysis.movement.axial) {
        let axial = Angle::from_sin_cos(-axes[(0, 1)], axes[(0, 0)]);
        assert!((axial - found.stokes).deg().abs() < 1e-9 && axial.deg().abs() > 3.0);
    }
}

/// The mirrored patient.
pub(super) fn mirrored(model: &PersonalisedModel) -> PersonalisedModel {
    let m = Mat3::from_diagonal(&Vec3::new(1.0, -1.0, 1.0));
    let spine = &model.spine;
    let centres: Vec<Vec3> = spine.joints.iter().map(|j| m * j.centre_in_inferior_mm).collect();
    let midpoints = spine.midpoints_mm.iter().map(|p| m * p).collect();
    let axes = spine.axes.iter().map(|r| m * r * m).collect();
    PersonalisedModel { spine: SpineModel::from_poses(midpoints, axes, &centres), ..model.clone() }
}

/// Effect of a mirror on three numbers: places change `y`, rotations the other two.
fn mirror(values: &[f64], rotation: bool) -> Vec<f64> {
    let signs = if rotation { [-1.0, 1.0, -1.0] } else { [1.0, -1.0, 1.0] };
    values.iter().zip(signs).map(|(value, sign)| value * sign).collect()
}

#[test]
fn a_mirrored_model_gives_a_mirrored_file() {
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    let model = model(Support::Free);
    let other = mirrored(&model);
    let both = |format| [&model, &other].map(|m| read(&exported(m, format)).0);
    let [one, two] = both(ExportFormat::Urdf);
    for (a, b) in named(&one, "origin").iter().zip(named(&two, "origin")) {
        assert!(close(&mirror(&a.numbers("xyz"), false), &b.numbers("xyz")));
        assert!(close(&mirror(&a.numbers("rpy"), true), &b.numbers("rpy")));
    }
    let [one, two] = both(ExportFormat::Mjcf);
    for (a, b) in named(&one, "body").iter().zip(named(&two, "body")) {
        assert!(close(&mirror(&a.numbers("pos"), false), &b.numbers("pos")));
        assert!(close(&mirror(&a.numbers("quat")[1..], true), &b.numbers("quat")[1..]));
    }
    // OpenSim's right is z: there, places change z, and rotations x and y.
    let [one, two] = both(ExportFormat::Osim);
    let signed = |text: &str, signs: [f64; 3]| -> Vec<f64> {
        numbers(text).iter().zip(signs).map(|(value, sign)| value * sign).collect()
    };
    for (key, signs) in [("translation", [1.0, 1.0, -1.0]), ("orientation", [-1.0, -1.0, 1.0])] {
        for (a, b) in named(&one, key).iter().zip(named(&two, key)) {
            assert!(close(&signed(&a.text, signs), &numbers(&b.text)), "{key}");
        }
    }
}

#[test]
fn names_are_escaped_in_every_format() {
    let mut model = model(Support::Free);
    for name in [
        "--><x>",
        "<!-- --- ----->",
        "-",
        "a\"b'c&d;&amp;",
        "]]>",
        "Müller 脊柱 \u{1F9B4} \u{202E}x",
        " spaces ",
        "",
    ] {
        model.case_id = name.to_owned();
        for format in FORMATS {
            let (all, comments) = read(&exported(&model, format));
            assert_eq!(comments.len(), 1, "{name}");
            assert!(named(&all, "x").is_empty());
            match format {
                ExportFormat::Mjcf => assert_eq!(all[0].attribute("model"), name),
                ExportFormat::Urdf => assert_eq!(all[0].attribute("name"), name),
                ExportFormat::Osim => {
                    let credits = &named(&all, "credits")[0].text;
                    assert_eq!(*credits, format!("test; case {name}"));
                    let plain = all[1].attribute("name");
                    assert!(plain.chars().all(|c| c.is_ascii_alphanumeric() || "._-".contains(c)));
                    assert!(!plain.is_empty());
                }
                ExportFormat::Sto
                | ExportFormat::Loads
                | ExportFormat::Vtp
                | ExportFormat::Gltf => {}
            }
        }
    }
}

#[test]
fn values_that_an_engine_cannot_represent_are_refused_by_name() {
    let good = model(Support::Free);
    let refused = |model: &PersonalisedModel| {
        export(model, ExportFormat::Mjcf, "test").expect_err("a bad model")
    };
    let mut bad = good.clone();
    bad.case_id = "a\u{0}b".to_owned();
    assert_eq!(refused(&bad), ExportError::Text { what: "case_id", character: '\0' });
    let mut bad = good.clone();
    bad.levels[4] = bad.levels[3];
    assert_eq!(refused(&bad), ExportError::LevelTwice { level: bad.levels[3] });
    let mut bad = good.clone();
    bad.stiffness[2][(1, 1)] = -1.0;
    let told = refused(&bad).to_string();
    assert!(told.contains("L2/L1") && told.contains("flexion") && told.contains("-1"), "{told}");
    let mut bad = good.clone();
    (bad.stiffness[2][(0, 1)], bad.stiffness[2][(1, 0)]) = (1e3, 1e3);
    let error = refused(&bad);
    assert!(error.to_string().contains("L2/L1: its springs couple"), "{error}");
    assert!(error.to_string().contains("mjcf"), "{error}");
    for word in ["--to vtp", "--to gltf", "--stiffness motion-segments", "--support frontal"] {
        assert!(error.help().contains(word), "{}", error.help());
    }
}
