//! Small valid files of every format, made by the program itself, as seeds for fuzzing.

use spineline::analysis::{Case, analyze};
use spineline::anatomy::Posture;
use spineline::cohort::{CohortPatient, learn_rotation_prior};
use spineline::evaluate::RotationPrior;
use spineline::measure::{FilmLandmarks, ImageGeometry, TiltRule};
use spineline_files::{
    AnalysisFile, CaseFile, FilmOrigin, ModelFile, ProgramRun, Provenance, Request,
    RotationPriorFile, StiffnessFile, to_text,
};
use spineline_films::{DicomFilm, Encoding, FilmPolarity, write_dicom};
use spineline_landmarks::{LandmarkTarget, ReportOf, SourceImage, export_landmarks, write_sr};
use spineline_phantom::{Readers, Scenario, SpaceSetup, generate, generate_in_space};

/// A valid file for one target.
#[derive(Debug, Clone)]
pub struct Seed {
    /// The target's name.
    pub target: &'static str,
    /// Its own name.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// A distribution of joint rotations, learned from the smallest number of patients.
fn rotation_prior() -> Result<String, Box<dyn std::error::Error>> {
    let patients = (0..RotationPrior::MIN_PATIENTS)
        .map(|subject| {
            let phantom = generate(subject, Scenario::Rod, &Readers::exact(), 1)?;
            Ok(CohortPatient::of(&analyze(&phantom.case, &Default::default())?))
        })
        .collect::<Result<Vec<_>, Box<dyn std::error::Error>>>()?;
    let learned = learn_rotation_prior(&patients, 1)?;
    let provenance = Provenance::new(run(), FilmOrigin::Synthetic, Vec::new());
    let ids = patients.iter().map(|patient| patient.case_id().to_owned()).collect();
    Ok(to_text(&RotationPriorFile::new(&learned, ids, TiltRule::default(), provenance)))
}

fn run() -> ProgramRun {
    ProgramRun {
        program: "seeds".to_owned(),
        command: Vec::new(),
        date_utc: "1970-01-01T00:00:00Z".to_owned(),
    }
}

/// All seeds, the same at every call.
///
/// # Errors
/// If the program cannot write one of its formats.
pub fn seeds() -> Result<Vec<Seed>, Box<dyn std::error::Error>> {
    let mut all = Seeds::default();
    let phantom = generate(0, Scenario::Rod, &Readers::exact(), 1)?;
    let case = &phantom.case;
    let analysis = analyze(case, &Default::default())?;
    all.put("case", "phantom", to_text(&CaseFile::from_case(case)));
    let in_space = generate_in_space(&SpaceSetup {
        corner_sd_mm: 0.5,
        pedicles: true,
        ..SpaceSetup::default()
    })
    .case;
    all.put("case", "lateral", to_text(&CaseFile::from_case(&in_space)));
    let model = ModelFile::new(&analysis, &analysis.models[0], "seeds", None);
    all.put("other_files", "model", to_text(&model));
    let provenance = Provenance::new(run(), FilmOrigin::Synthetic, Vec::new());
    let provenance = provenance.asking(&Request::default());
    let file = AnalysisFile::new(&analysis, CaseFile::from_case(case), provenance);
    all.put("other_files", "analysis", to_text(&file));
    let library = spineline::multibody::StiffnessLibrary::default();
    all.put("other_files", "stiffness", to_text(&StiffnessFile::from(&library)));
    all.put("other_files", "rotation-prior", rotation_prior()?);
    all.put("other_files", "load", LOAD);
    all.put("other_files", "readings", READINGS);
    for encoding in [Encoding::Plain, Encoding::Rle, Encoding::JpegLs] {
        let name = format!("{encoding:?}").to_lowercase();
        let film = film(case, encoding)?;
        all.put("film", &name, &film);
        all.put("deidentify", &name, &film);
    }
    all.put("film", "png", PNG);
    for target in [LandmarkTarget::Csv, LandmarkTarget::Slicer] {
        for (i, file) in export_landmarks(case, None, target)?.iter().enumerate() {
            all.put("landmarks", &format!("{target:?}-{i}"), &file.bytes);
        }
    }
    all.put("landmarks", "labelme", LABELME);
    all.put("landmarks", "coco", COCO);
    all.put("landmarks", "midlines", MIDLINES);
    all.put("landmarks", "mat", mat());
    let report = report(case)?;
    all.put("landmarks", "report", &report);
    all.put("report", "report", &report);
    Ok(all.0)
}

#[derive(Default)]
struct Seeds(Vec<Seed>);

impl Seeds {
    fn put(&mut self, target: &'static str, name: &str, content: impl AsRef<[u8]>) {
        self.0.push(Seed { target, name: name.to_owned(), bytes: content.as_ref().to_vec() });
    }
}

/// The picture of the erect film.
fn image(case: &Case) -> &ImageGeometry {
    match &case.films[0].landmarks {
        FilmLandmarks::Corners { image, .. } => image,
        FilmLandmarks::Placements { .. } => unreachable!("phantoms have landmarks"),
    }
}

/// A film of few pixels.
fn film(case: &Case, encoding: Encoding) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let pixels: Vec<u16> = (0..12 * 9).map(|i| i * 37 % 4096).collect();
    let image = ImageGeometry { columns: 12, rows: 9, ..*image(case) };
    Ok(write_dicom(&DicomFilm {
        case_id: "seed",
        subject: &case.subject,
        posture: Posture::Erect,
        image,
        magnification: 1.1,
        polarity: FilmPolarity::Monochrome1,
        bits_stored: 12,
        pixels: &pixels,
        encoding,
    })?)
}

fn report(case: &Case) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let FilmLandmarks::Corners { image, iliac_crests, readings } = &case.films[0].landmarks else {
        unreachable!("phantoms have landmarks")
    };
    let source = SourceImage {
        sop_class_uid: "1.2.840.10008.5.1.4.1.1.1.1".to_owned(),
        sop_instance_uid: "2.25.1".to_owned(),
        study_instance_uid: "2.25.2".to_owned(),
        series_instance_uid: "2.25.3".to_owned(),
        modality: "DX".to_owned(),
        size: (image.columns, image.rows),
        patient_name: "seed".to_owned(),
        patient_id: "seed".to_owned(),
        ..SourceImage::default()
    };
    Ok(write_sr(&ReportOf {
        posture: Posture::Erect,
        image,
        iliac_crests: *iliac_crests,
        reading: &readings[0],
        curves: &[],
        source: &source,
        written: ["20260101", "120000"],
    })?)
}

/// A MATLAB file with 68 points, not compressed.
fn mat() -> Vec<u8> {
    let mut file = format!("{:<124}", "MATLAB 5.0 MAT-file").into_bytes();
    file.extend([0, 1, b'I', b'M']);
    let points: Vec<u8> = (0..136u16).flat_map(|i| (i * 7 % 600).to_le_bytes()).collect();
    let mut body = Vec::new();
    let mut element = |kind: u32, bytes: &[u8]| {
        body.extend(kind.to_le_bytes());
        body.extend((bytes.len() as u32).to_le_bytes());
        body.extend(bytes);
        body.resize(body.len().next_multiple_of(8), 0);
    };
    element(6, &[11, 0, 0, 0, 0, 0, 0, 0]);
    element(5, &[68, 0, 0, 0, 2, 0, 0, 0]);
    element(1, b"p2");
    element(4, &points);
    file.extend(14u32.to_le_bytes());
    file.extend((body.len() as u32).to_le_bytes());
    file.extend(body);
    file
}

/// One white pixel.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0\x3a\x7e\x9b\x55\
\0\0\0\nIDAT\x78\x9c\x63\xf8\x0f\0\x01\x01\x01\0\x1b\xb6\xee\x56\0\0\0\0IEND\xae\x42\x60\x82";

const LOAD: &str = r#"{ "format": "spineline-load", "version": 1, "loads": [
  { "kind": "force_on_line", "level": "T2", "force": [0, 10, 0], "point_mm": [-10, 0, 380] },
  { "kind": "follower_force", "level": "T5", "force_in_vertebra": [0, 5, 0], "point_in_vertebra_mm": [0, 0, 2] },
  { "kind": "moment", "level": "T3", "moment": [100, 0, 0] },
  { "kind": "gravity", "body_weight": 40 },
  { "kind": "pad", "level": "T9", "point_in_vertebra_mm": [0, -40, 0], "direction": [0, 1, 0], "force_per_mm": 2, "advance_mm": 5 },
  { "kind": "strap", "level": "T4", "anchor_mm": [0, -200, 300], "force_per_mm": 1, "shortening_mm": 5 },
  { "kind": "rod", "inferior": "T12", "superior": "T6", "turn_deg": [9, 0, 0], "timing": "held" } ] }"#;

const READINGS: &str = "quantity,unit,subject,observer,repeat,value\n\
tilt,deg,1,A,1,2.5\ntilt,deg,1,B,1,2.7\ntilt,deg,2,A,1,-3\ntilt,deg,2,B,1,-2.1\n";

const LABELME: &str = r#"{ "version": "5.0", "imagePath": "a.png", "imageWidth": 600, "imageHeight": 900, "shapes": [
  { "label": "T12", "shape_type": "polygon", "points": [[100, 200], [160, 202], [158, 240], [102, 238]] },
  { "label": "L1_superior_left", "shape_type": "point", "points": [[101, 260]], "score": 0.5 } ] }"#;

const COCO: &str = r#"{ "images": [{ "id": 1, "file_name": "a.png", "width": 600, "height": 900 }],
  "categories": [{ "id": 1, "name": "T12", "keypoints": ["superior_left", "superior_right", "inferior_left", "inferior_right"] }],
  "annotations": [{ "id": 1, "image_id": 1, "category_id": 1, "keypoints": [100, 200, 2, 160, 202, 2, 102, 238, 2, 158, 240, 2],
    "keypoint_scores": [0.9, 0.8, 0.75, 1] }] }"#;

const MIDLINES: &str = r#"{ "midlines": [{ "posture": "erect", "observer": "A", "repeat": 1, "cranial_end": "T2", "caudal_end": "L4",
  "axes": ["right", "caudal"], "points_mm": [[0, 0], [4, 38], [8, 76], [10, 114], [9, 152], [6, 190], [2, 228], [0, 266],
  [-1, 304], [0, 342], [1, 370]] }] }"#;
