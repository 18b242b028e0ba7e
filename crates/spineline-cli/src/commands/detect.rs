//! `spineline detect`: landmarks that a program proposes, as cases.

use std::path::{Path, PathBuf};

use clap::Args;
use spineline::analysis::Case;
use spineline::anatomy::{FilmView, ImageSide, Posture};
use spineline::measure::{
    Corners, Film, FilmLandmarks, IliacCrests, ImageGeometry, Origin, Reading, ReadingId,
    VertebraLandmarks,
};
use spineline::number::fixed;
use spineline::warning::counted;
use spineline_detect::{DetectedVertebra, Detection, Picture, Refusal, detect};
use spineline_files::{CaseFile, FilmSource, sha256_hex, to_text};
use spineline_films::{FilmFile, side_contradiction, view_contradictions};
use spineline_marking::{ViewJudgement, judge_spacing, judge_view};
use spineline_report::terminal::Lines;

use crate::options::choice::choice;
use crate::options::values::posture;
use crate::run::failure::{Ending, Failure};
use crate::run::film_decoder::{Decoder, case_film_bytes, film_bytes};
use crate::run::inputs::{CaseInput, is_case};
use crate::run::messages::{say, say_origin_of_weights};
use crate::run::outputs::{Outputs, OverwriteArgs, print};
use crate::run::progress::bar;

pub const EXAMPLES: &str = "\
Examples:
  spineline detect erect.dcm --posture erect --out found
      writes found/detected-01.json
  spineline detect P07/case.json --out found           every film of a case without a reading
  spineline check found/detected-01.json               lists what to look at
  spineline serve                                      the browser proposes the same on a film, one by one

The networks were trained on films of erect adolescents with scoliosis from one hospital, and not on bending, lateral or traction films, \
adults or implants: check films of other postures most carefully. Every corner states its confidence and its deviation, and counts as not reviewed until a person has accepted or \
moved it. The command reports levels that may be shifted by one. Iliac crests in a case help to name the vertebrae. validation/proposals.md has the errors on films that were not used for training.";

#[derive(Args)]
pub struct DetectArgs {
    /// Films from the front or from behind (DICOM, PNG, JPEG or TIFF) of one posture, or cases with their films beside them
    #[arg(required = true, value_name = "FILM|CASE")]
    films: Vec<PathBuf>,
    /// Posture of the films; a case states the posture of each film
    #[arg(long, value_name = "POSTURE", value_parser = posture)]
    posture: Option<Posture>,
    /// Folder for a case per film or case
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Side of the picture on which the patient's left is, where a film does not say; a case states it
    #[arg(long, value_name = "SIDE", value_parser = choice::<ImageSide>())]
    patient_left: Option<ImageSide>,
    #[command(flatten)]
    overwrite: OverwriteArgs,
}

pub fn run(args: &DetectArgs) -> Result<Ending, Failure> {
    let has_options = args.posture.is_some() || args.patient_left.is_some();
    if let Some(case) = args.films.iter().find(|path| has_options && is_case(path)) {
        return Err(Failure::usage(format!(
            "--posture and --patient-left are about films; {} is a case, which states both",
            case.display()
        )));
    }
    let outputs = Outputs::new(args.overwrite, args.films.iter().map(PathBuf::as_path));
    outputs.folder(&args.out)?;
    say_origin_of_weights();
    let decoder = Decoder::new()?;
    let progress = bar("films", args.films.len());
    let (mut text, mut ending) = (Lines::default(), Ending::Done);
    for (number, path) in (1..).zip(&args.films) {
        let id = format!("detected-{number:02}");
        let made = match is_case(path) {
            true => of_case(&decoder, path),
            false => of_film(&decoder, path, args, &id),
        };
        match made {
            Ok(made) => {
                let out = args.out.join(format!("{}.json", made.case.id()));
                outputs.of_case(made.case.id());
                outputs.write(&out, to_text(&made.case))?;
                made.found.iter().for_each(|(posture, found)| {
                    add_summary(&mut text, &format!("{}, {posture}", out.display()), found);
                });
            }
            // The other films are still processed.
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

/// A case with landmarks that were found.
struct Made {
    case: CaseFile,
    found: Vec<(Posture, Detection)>,
}

/// The case of one film. It gets a new identifier, since the name of the file may contain the patient's name.
fn of_film(decoder: &Decoder, path: &Path, args: &DetectArgs, id: &str) -> Result<Made, Failure> {
    let place = path.display().to_string();
    let Some(posture) = args.posture else {
        let help = "give --posture erect, left-bending, right-bending, neutral or traction, or a case with the postures of its films";
        return Err(Failure::input(&place, "the posture of the film is not known", help));
    };
    let (film, sha256) = decoded(decoder, path, film_bytes(path)?)?;
    let view = judge_view(&film.tags.view, Some(posture));
    check_answers(&place, &view, posture, args.patient_left)?;
    let Some(patient_left) = view.patient_left.or(args.patient_left) else {
        let what = "the film does not say on which side of the picture the patient's left is";
        let help = "give --patient-left image-left or image-right (look for the lead marker, the heart, the stomach's bubble)";
        return Err(Failure::input(&place, what, help));
    };
    let spacing = judge_spacing(&film.tags.spacing).spacing;
    let image = ImageGeometry { columns: film.columns, rows: film.rows, spacing, patient_left };
    let (reading, detection) = read_film(&film, &image, None, &place)?;
    let landmarks = FilmLandmarks::Corners { image, iliac_crests: None, readings: vec![reading] };
    let mut case = Case::of_films(id, vec![Film::new(posture, landmarks)]);
    case.synthetic = film.tags.is_phantom;
    let source = FilmSource { file: None, sha256: Some(sha256), inverted: false };
    let case = CaseFile::from_case(&case).with_source(posture, source);
    Ok(Made { case, found: vec![(posture, detection)] })
}

/// Refuses answers that the file contradicts.
fn check_answers(
    place: &str,
    file: &ViewJudgement,
    posture: Posture,
    patient_left: Option<ImageSide>,
) -> Result<(), Failure> {
    let view = FilmView::Frontal(posture);
    let mut contradicted = view_contradictions(view, file);
    let said = patient_left.and_then(|side| side_contradiction(view, file, side, "your option"));
    contradicted.extend(said);
    if contradicted.is_empty() {
        return Ok(());
    }
    let help = "correct your options (only films from the front or from behind are read); if the file is wrong, make a case with `spineline import --accept`";
    Err(Failure::input(place, contradicted.join("; "), help))
}

/// A case with landmarks for its films without a reading.
fn of_case(decoder: &Decoder, path: &Path) -> Result<Made, Failure> {
    let CaseInput { file, mut case, .. } = CaseInput::read(path)?;
    let mut found = Vec::new();
    for film in &mut case.films {
        let posture = film.posture;
        let FilmLandmarks::Corners { image, iliac_crests, readings } = &mut film.landmarks else {
            continue;
        };
        let picture = file.source(posture).and_then(|source| source.file);
        let Some(picture) = picture.filter(|_| readings.is_empty()) else { continue };
        let picture = path.with_file_name(picture);
        let (decoded, _) = decoded(decoder, &picture, case_film_bytes(&picture)?)?;
        let place = picture.display().to_string();
        let (reading, detection) = read_film(&decoded, image, *iliac_crests, &place)?;
        readings.push(reading);
        found.push((posture, detection));
    }
    if found.is_empty() {
        let help = "films with a reading are left as they are; `spineline import` makes a case without readings";
        let what = "no film has a picture and lacks a reading";
        return Err(Failure::input(path.display(), what, help));
    }
    let mut made = CaseFile::from_case(&case);
    for film in &case.films {
        if let Some(source) = file.source(film.posture) {
            made = made.with_source(film.posture, FilmSource { file: None, ..source });
        }
    }
    Ok(Made { case: made, found })
}

/// The required view.
const FRONTAL: &str = "only films from the front or from behind";

/// A film and the hash of its file.
fn decoded(decoder: &Decoder, path: &Path, bytes: Vec<u8>) -> Result<(FilmFile, String), Failure> {
    let sha256 = sha256_hex(&bytes);
    let film = decoder.decode(bytes).map_err(|error| Failure::of(path.display(), &error))?;
    Ok((film, sha256))
}

/// The landmarks that the networks find.
fn read_film(
    film: &FilmFile,
    image: &ImageGeometry,
    crests: Option<IliacCrests>,
    place: &str,
) -> Result<(Reading<VertebraLandmarks>, Detection), Failure> {
    let refused = |refusal| match refusal {
        Refusal::NoNetworks => {
            Failure::input(place, refusal, "use a program built with the feature `weights`")
        }
        _ => Failure::input(place, refusal, FRONTAL),
    };
    let detection = in_picture(film, image, crests).map_err(refused)?;
    let landmarks = |found: &DetectedVertebra| {
        let landmarks = VertebraLandmarks {
            origins: Corners::all(Origin::Detected),
            confidence: Some(found.corners.map(|_| found.confidence)),
            sd_share: Some(found.sd_share),
            ..VertebraLandmarks::clicked(found.corners)
        };
        (found.level, landmarks)
    };
    let vertebrae = detection.vertebrae.iter().map(landmarks).collect();
    Ok((Reading { id: ReadingId::new("spineline-detect", 1), vertebrae }, detection))
}

fn in_picture(
    film: &FilmFile,
    image: &ImageGeometry,
    crests: Option<IliacCrests>,
) -> Result<Detection, Refusal> {
    // Displayed as for a reader: the networks were trained on such pictures.
    let shown = film.display(None, false);
    let values: Vec<f32> = shown.grey.iter().map(|&grey| f32::from(grey)).collect();
    let picture = Picture {
        columns: shown.columns as usize,
        rows: shown.rows as usize,
        pixel_aspect: image.spacing.map_or(1.0, |spacing| spacing.aspect()),
        patient_left: image.patient_left,
        values: &values,
    };
    detect(&picture, crests)
}

fn add_summary(text: &mut Lines, film: &str, detection: &Detection) {
    let vertebrae = &detection.vertebrae;
    let ends = vertebrae.first().zip(vertebrae.last());
    let range =
        ends.map_or_else(String::new, |(low, high)| format!(", {} to {}", low.level, high.level));
    let count = vertebrae.len();
    let mean = |of: fn(&DetectedVertebra) -> f64| {
        100.0 * vertebrae.iter().map(of).sum::<f64>() / count.max(1) as f64
    };
    let (confidence, sd) = (mean(|one| one.confidence), mean(|one| one.sd_share));
    text.line(format!(
        "{}: {}{range}; mean confidence {} %, standard deviation of a corner {} % of a vertebral height",
        film,
        counted(count, "level"),
        fixed(confidence, 0),
        fixed(sd, 0)
    ));
    let levels = if detection.count.is_sure() { "levels" } else { "check the levels" };
    text.line(format!("  {levels}: {}", detection.count));
    if let Some(left_out) = detection.left_out() {
        text.line(format!("  {left_out}"));
    }
}
