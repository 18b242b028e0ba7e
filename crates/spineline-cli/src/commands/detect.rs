//! `spineline detect`: landmarks that a program proposes, as cases.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use spineline::analysis::{Case, Subject};
use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::{
    Corners, Film, FilmLandmarks, ImageGeometry, Origin, Reading, ReadingId, VertebraLandmarks,
};
use spineline::warning::counted;
use spineline_detect::{Detection, Picture, detect};
use spineline_files::{CaseFile, FilmSource, sha256_hex, to_text};
use spineline_films::FilmFile;
use spineline_films::intake::{IntakeLimits, Place, read};
use spineline_marking::{View, judge_spacing, judge_view};
use spineline_report::terminal::Lines;

use crate::options::choice::choice;
use crate::run::failure::{Ending, Failure};
use crate::run::film_decoder::Decoder;
use crate::run::messages::say;
use crate::run::outputs::{Outputs, OverwriteArgs, print};
use crate::run::progress::bar;

pub const EXAMPLES: &str = "\
Examples:
  spineline detect erect.dcm --out found               writes found/detected-01.json
  spineline check found/detected-01.json               lists what to look at
  spineline serve                                      the browser shows the same proposals on a film, one by one (P)

It was trained on films of erect adolescents with scoliosis from one hospital. It was never shown bending, lateral or traction films,
adults, or implants. Every corner states its confidence and its deviation, and counts as not reviewed until a person has accepted or
moved it. Levels that may be shifted by one are reported. docs/proposals.md has its errors on films that it has not seen.";

#[derive(Args)]
pub struct DetectArgs {
    /// Films of erect spines, from the front or from behind: DICOM, PNG, JPEG or TIFF
    #[arg(required = true, value_name = "FILM")]
    films: Vec<PathBuf>,
    /// Folder for a case per film
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Side of the picture on which the patient's left is, where a film does not say
    #[arg(long, value_name = "SIDE", value_parser = choice::<ImageSide>())]
    patient_left: Option<ImageSide>,
    #[command(flatten)]
    overwrite: OverwriteArgs,
}

pub fn run(args: &DetectArgs) -> Result<Ending, Failure> {
    let outputs = Outputs::new(args.overwrite, args.films.iter().map(PathBuf::as_path));
    outputs.folder(&args.out)?;
    let decoder = Decoder::new()?;
    let progress = bar("films", args.films.len());
    let (mut text, mut ending) = (Lines::default(), Ending::Done);
    for (number, path) in (1..).zip(&args.films) {
        let id = format!("detected-{number:02}");
        match found(&decoder, path, args.patient_left, id) {
            Ok((case, detection)) => {
                let out = args.out.join(format!("detected-{number:02}.json"));
                outputs.write(&out, to_text(&case))?;
                add_summary(&mut text, &out, &detection);
            }
            // The other films are looked at all the same.
            Err(failure) => {
                progress.suspend(|| say(&failure));
                ending = Ending::BadInput;
            }
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    outputs.commit()?;
    print(text)?;
    Ok(ending)
}

/// The case of one film. Its identifier is none of the film's names, which may be that of a patient.
fn found(
    decoder: &Decoder,
    path: &Path,
    stated: Option<ImageSide>,
    id: String,
) -> Result<(CaseFile, Detection), Failure> {
    let place = path.display().to_string();
    let bytes = read(&Place::File(path.to_owned()), &IntakeLimits::default())
        .map_err(|error| Failure::intake(&error))?;
    let sha256 = sha256_hex(&bytes);
    let film =
        decoder.decode(bytes).map_err(|error| Failure::input(&place, &error, error.help()))?;
    let view = judge_view(&film.tags.view, None);
    if view.view == Some(View::Lateral) {
        let help = "only films of erect spines from the front or from behind";
        return Err(Failure::input(&place, &"the film states a lateral view", help));
    }
    let Some(patient_left) = view.patient_left.or(stated) else {
        let what = "the film does not say on which side of the picture the patient's left is";
        let help = "give --patient-left image-left or image-right (look for the lead marker, the heart, the stomach's bubble)";
        return Err(Failure::input(&place, &what, help));
    };
    let spacing = judge_spacing(&film.tags.spacing).spacing;
    let image = ImageGeometry { columns: film.columns, rows: film.rows, spacing, patient_left };
    let detection = in_picture(&film, &image).map_err(|refusal| {
        Failure::input(&place, &refusal, "only films of erect spines from the front or from behind")
    })?;
    let vertebrae: BTreeMap<_, _> = detection
        .vertebrae
        .iter()
        .map(|found| {
            let confidence = found.confidence;
            let landmarks = VertebraLandmarks {
                origins: Corners::all(Origin::Detected),
                confidence: Some(found.corners.map(|_| confidence)),
                sd_share: Some(found.sd_share),
                ..VertebraLandmarks::clicked(found.corners)
            };
            (found.level, landmarks)
        })
        .collect();
    let reading = Reading { id: ReadingId::new("spineline-detect", 1), vertebrae };
    let landmarks = FilmLandmarks::Corners { image, iliac_crests: None, readings: vec![reading] };
    let film = Film { posture: Posture::Erect, landmarks };
    let subject = Subject::default();
    let case = Case { id, synthetic: false, subject, films: vec![film], lateral: None };
    let source = FilmSource { file: None, sha256: Some(sha256), inverted: false };
    Ok((CaseFile::from_case(&case).with_source(Posture::Erect, source), detection))
}

fn in_picture(
    film: &FilmFile,
    image: &ImageGeometry,
) -> Result<Detection, spineline_detect::Refusal> {
    // As a reader sees it: the networks were trained on pictures for people.
    let shown = film.display(None, false);
    let values: Vec<f32> = shown.grey.iter().map(|&grey| f32::from(grey)).collect();
    detect(&Picture {
        columns: shown.columns as usize,
        rows: shown.rows as usize,
        pixel_aspect: image.spacing.map_or(1.0, |spacing| spacing.aspect()),
        patient_left: image.patient_left,
        values: &values,
    })
}

fn add_summary(text: &mut Lines, out: &Path, detection: &Detection) {
    let Detection { vertebrae, doubts } = detection;
    let ends = vertebrae.first().zip(vertebrae.last());
    let range =
        ends.map_or_else(String::new, |(low, high)| format!(", {} to {}", low.level, high.level));
    let count = vertebrae.len();
    let mean = |of: fn(&spineline_detect::DetectedVertebra) -> f64| {
        100.0 * vertebrae.iter().map(of).sum::<f64>() / count.max(1) as f64
    };
    let (confidence, sd) = (mean(|one| one.confidence), mean(|one| one.sd_share));
    text.line(format!(
        "{}: {}{range}; mean confidence {confidence:.0} %, standard deviation of a corner {sd:.0} % of a vertebral height",
        out.display(),
        counted(count, "level")
    ));
    for doubt in doubts {
        text.line(format!("  check the levels: {doubt}"));
    }
}
