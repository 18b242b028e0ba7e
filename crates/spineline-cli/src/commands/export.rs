//! `spineline export`: a personalised model for other multibody programs, or the landmarks of a case for image programs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use spineline::analysis::{AnalysisOptions, Case, analyze};
use spineline::anatomy::{Posture, Region};
use spineline::clinical::CobbEnds;
use spineline_files::{
    CaseFile, ExportFormat, FileError, FilmOrigin, InputFile, Provenance, ProvenanceFile, export,
    parse_case_file, read_text, to_text,
};
use spineline_landmarks::{
    ExportedFile, LandmarkTarget, SourceImage, export_landmarks, export_lateral, openable_pictures,
    read_film_source,
};

use crate::options::values::posture;
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::{read_input, read_model};
use crate::run::messages::say;
use crate::run::outputs::{Outputs, OverwriteArgs, is_stdout};
use crate::run::provenance::{generator, this_run};

/// How to make a model file, and how each program opens the result.
pub const EXAMPLES: &str = "\
Examples:
  spineline analyze CASE.json --model model.json
  spineline export model.json --to mjcf --out spine.xml
      python -m mujoco.viewer --mjcf=spine.xml
      mujoco.MjModel.from_xml_path('spine.xml')
  spineline export model.json --to osim --out spine.osim
      opensim.Model('spine.osim').initSystem(), or File > Open Model in OpenSim
  spineline export model.json --to sto --out films.sto
      opensim.TimeSeriesTable('films.sto'), or File > Load Motion in OpenSim
  spineline export model.json --to loads --out films.loads.xml
      opensim.ExternalLoads('films.loads.xml', True), with films.sto beside it
  spineline export model.json --to urdf --out spine.urdf
      pinocchio.buildModelFromUrdf('spine.urdf')
  spineline export model.json --to vtp --out spine.vtp
  spineline export model.json --to gltf --out spine.gltf
  spineline export CASE.json --to slicer --posture erect --out erect.mrk.json
  spineline export CASE.json --to lateral-csv --out lateral.csv
  spineline export CASE.json --to labelme --posture erect --out erect.json
  spineline export CASE.json --to coco --out landmarks.json
  spineline export CASE.json --to dicom-sr --out reports

MJCF, OpenSim and URDF are in metres, newtons and radians. MJCF and URDF keep x anterior, y left, z cranial; OpenSim has x anterior, \
y cranial, z right. MJCF and OpenSim contain the springs; URDF has no element for springs, so they are in its `gazebo` \
elements. MJCF has a keyframe and a force for every film; OpenSim has a force for every film, and `sto` has \
the poses and forces of the films, which `loads` makes external loads. \
URDF has no place for them. `vtp` (VTK, for 3D Slicer and ParaView) and `gltf` have the vertebral bodies as boxes, with lateral tilt, pitch and axial \
rotation in degrees, and no joints. VTK is in mm, x left, y posterior, z cranial; glTF in metres, x left, y cranial, z anterior. The comment at the top of each model lists the forces of the films. Masses, damping and \
armature are nominal.

Landmarks are named by the patient's sides. CSV and COCO hold all frontal films in one file; Slicer gets one file per film; \
labelme and DICOM SR one per reading. labelme and COCO name the picture of a film, or POSTURE.png where the case has a DICOM \
file or none: `spineline film FILE --png POSTURE.png` writes it. For DICOM SR the case has to name the DICOM file of each film. Reports contain the patient's name and ID from that \
file. Several files are written into the folder that `--out` names.";

#[derive(Args)]
pub struct ExportArgs {
    /// Model file, from `spineline analyze CASE --model FILE`; or a case file, for its landmarks
    #[arg(value_name = "MODEL|CASE")]
    file: PathBuf,
    /// Format: `mjcf` for MuJoCo, `osim` for OpenSim 4 with the films as `sto` and their forces as `loads`, `urdf` for Pinocchio, Gazebo, Drake and others;
    /// vertebral bodies as `vtp` for 3D Slicer and ParaView, or `gltf`; of landmarks,
    /// `csv`, `lateral-csv` of the lateral film, `slicer` for 3D Slicer, `labelme`, `coco` for COCO keypoints, `dicom-sr` for a DICOM report
    #[arg(long, value_enum, value_name = "FORMAT")]
    to: Target,
    /// File to write (`-`: standard output), or a folder for several files
    #[arg(long, value_name = "PATH", default_value = "-")]
    out: PathBuf,
    /// Export the landmarks of this posture's film only
    #[arg(long, value_name = "POSTURE", value_parser = posture)]
    posture: Option<Posture>,
    /// Date and time of a DICOM report in UTC, as YYYYMMDDhhmmss [default: now]
    #[arg(long, value_name = "TIME", value_parser = moment)]
    written: Option<[String; 2]>,
    #[command(flatten)]
    overwrite: OverwriteArgs,
}

/// What is written: a model or the landmarks of a case.
#[derive(Clone, Copy, PartialEq)]
enum Target {
    Model(ExportFormat),
    Landmarks(LandmarkName),
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum LandmarkName {
    /// Landmarks as a table
    Csv,
    /// Landmarks of the lateral film as a table
    LateralCsv,
    /// Landmarks as point lists of 3D Slicer
    Slicer,
    /// Landmarks as named points of labelme
    Labelme,
    /// Landmarks as keypoints of COCO
    Coco,
    /// Landmarks, tilts and Cobb angles as DICOM reports
    DicomSr,
}

impl ValueEnum for Target {
    fn value_variants<'a>() -> &'a [Self] {
        static TARGETS: LazyLock<Vec<Target>> = LazyLock::new(|| {
            let models = ExportFormat::ALL.into_iter().map(Target::Model);
            let landmarks =
                LandmarkName::value_variants().iter().map(|&name| Target::Landmarks(name));
            models.chain(landmarks).collect()
        });
        &TARGETS
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::Model(format) => Some(PossibleValue::new(format.key()).help(format.programs())),
            Self::Landmarks(name) => name.to_possible_value(),
        }
    }
}

pub fn run(args: &ExportArgs) -> Result<Ending, Failure> {
    let format = match args.to {
        Target::Model(format) => format,
        Target::Landmarks(name) => return landmarks(args, name),
    };
    if args.posture.is_some() {
        return Err(Failure::usage("--posture is for landmarks only"));
    }
    let outputs = Outputs::new(args.overwrite, [args.file.as_path()]);
    outputs.file(&args.out)?;
    let model = read_model(&args.file)?.model;
    let text = export(&model, format, &generator())
        .map_err(|error| Failure::of(args.file.display(), &error))?;
    outputs.of_case(&model.case_id);
    outputs.write(&args.out, text)?;
    outputs.commit_and_say().map(|()| Ending::Done)
}

fn landmarks(args: &ExportArgs, name: LandmarkName) -> Result<Ending, Failure> {
    if args.written.is_some() && name != LandmarkName::DicomSr {
        return Err(Failure::usage("--written is for DICOM reports only"));
    }
    let file = read_case_file(&args.file)?;
    let case = file.clone().into_case().map_err(|error| Failure::file(&args.file, &error))?;
    let (sources, curves, written);
    let pictures = openable_pictures(&file, &case);
    let target = match name {
        LandmarkName::LateralCsv => return lateral_landmarks(args, &case),
        LandmarkName::Csv => LandmarkTarget::Csv,
        LandmarkName::Slicer => LandmarkTarget::Slicer,
        LandmarkName::Labelme => LandmarkTarget::Labelme { pictures: &pictures },
        LandmarkName::Coco => LandmarkTarget::Coco { pictures: &pictures },
        LandmarkName::DicomSr => {
            sources = read_sources(&file, &case, args)?;
            curves = curves_of(&case);
            written = args.written.clone().unwrap_or_else(now);
            let [date, time] = &written;
            LandmarkTarget::DicomSr { sources: &sources, curves: &curves, written: [date, time] }
        }
    };
    let files = export_landmarks(&case, args.posture, target)
        .map_err(|error| Failure::of(args.file.display(), &error))?;
    for part in target.left_out(&case) {
        say(format!("note: this format has no place for {part}; the case keeps them"));
    }
    write_landmarks(args, &case, &files)
}

fn lateral_landmarks(args: &ExportArgs, case: &Case) -> Result<Ending, Failure> {
    if args.posture.is_some() {
        return Err(Failure::usage("--posture is for frontal films only"));
    }
    let file = export_lateral(case).map_err(|error| Failure::of(args.file.display(), &error))?;
    write_landmarks(args, case, &[file])
}

/// One file by the name that the user gave, several in a folder; their provenance beside them.
fn write_landmarks(
    args: &ExportArgs,
    case: &Case,
    files: &[ExportedFile],
) -> Result<Ending, Failure> {
    let outputs = Outputs::new(args.overwrite, [args.file.as_path()]);
    let origin = FilmOrigin::of([case.synthetic]);
    outputs.of_case(&case.id);
    let provenance = Provenance::new(this_run()?, origin, vec![read_input(&args.file)?]);
    let provenance = provenance.of_cases([case.id.clone()]);
    if let [only] = files {
        outputs.table(&args.out)?;
        outputs.write_table(&args.out, &only.bytes[..], &provenance)?;
        return outputs.commit_and_say().map(|()| Ending::Done);
    }
    if is_stdout(&args.out) {
        return Err(Failure::usage(format!(
            "there are {} files to write; give a folder with --out, or one film with --posture",
            files.len()
        )));
    }
    outputs.folder(&args.out)?;
    for exported in files {
        outputs.write(&args.out.join(&exported.name), &exported.bytes[..])?;
    }
    let list = files.iter().map(|file| InputFile::of(&*file.name, &file.bytes)).collect();
    let list = to_text(&ProvenanceFile::new(list, provenance));
    outputs.write(&args.out.join("provenance.json"), list)?;
    outputs.commit_and_say().map(|()| Ending::Done)
}

fn read_case_file(path: &Path) -> Result<CaseFile, Failure> {
    read_text(path).and_then(|text| parse_case_file(&text)).map_err(|error| match &error {
        FileError::Format { found, .. } if found == "spineline-model" => Failure::input(
            path.display(),
            &error,
            "landmarks belong to a case; export a model to mjcf, osim, sto, urdf, vtp or gltf",
        ),
        _ => Failure::file(path, &error),
    })
}

/// The DICOM files that the case names, beside it.
fn read_sources(
    file: &CaseFile,
    case: &Case,
    args: &ExportArgs,
) -> Result<BTreeMap<Posture, SourceImage>, Failure> {
    let folder = args.file.parent().unwrap_or(Path::new(""));
    let mut sources = BTreeMap::new();
    for film in case.films.iter().filter(|film| args.posture.is_none_or(|p| p == film.posture)) {
        let stated = file.source(film.posture).unwrap_or_default();
        let Some(name) = &stated.file else { continue };
        // `CaseFile::into_case` refuses a name in another folder.
        let source = read_film_source(film.posture, &stated, &folder.join(name));
        let source = source.map_err(|error| Failure::of(args.file.display(), &error))?;
        sources.insert(film.posture, source);
    }
    Ok(sources)
}

/// The ends of the curves as `spineline analyze` finds them; empty if the case cannot be analysed.
fn curves_of(case: &Case) -> Vec<(Region, CobbEnds)> {
    match analyze(case, &AnalysisOptions::default()) {
        Ok(analysis) => analysis.movement.end_vertebrae(),
        Err(error) => {
            say(format!("note: the reports have no Cobb angles: {error}"));
            Vec::new()
        }
    }
}

fn now() -> [String; 2] {
    let now = chrono::DateTime::<chrono::Utc>::from(std::time::SystemTime::now());
    [now.format("%Y%m%d").to_string(), now.format("%H%M%S").to_string()]
}

fn moment(text: &str) -> Result<[String; 2], String> {
    chrono::NaiveDateTime::parse_from_str(text, "%Y%m%d%H%M%S")
        .ok()
        .filter(|_| text.len() == 14)
        .map(|_| [text[..8].to_owned(), text[8..].to_owned()])
        .ok_or_else(|| "expected YYYYMMDDhhmmss, such as 20260131235959".to_owned())
}
