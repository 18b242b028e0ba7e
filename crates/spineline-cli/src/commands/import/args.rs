//! The command line of `import`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use spineline::analysis::{CASE_ID_RULE, is_case_id};
use spineline::anatomy::{FilmView, ImageSide, Posture};
use spineline::measure::{
    OBSERVER_RULE, ReadingId, Spacing, SpacingPlane, SpacingSource, is_observer_code,
};
use spineline::spatial::Pixel;
use spineline_files::method_text::named;
use spineline_marking::{Calibration, Calibrator};

use crate::options::choice::choice;
use crate::options::values::{number, posture};
use crate::run::failure::Failure;
use crate::run::outputs::is_same_file;

/// Shown below the options.
pub const EXAMPLES: &str = "\
Examples:
  spineline import FOLDER --list
      list the films there with their metadata, and all other files
  spineline import FOLDER --case-id P07 --out p07
      answer a few questions; writes p07/case.json with its films beside it
  spineline import films.zip --case-id P07 --out p07 \\
      --film erect=1 --film left-bending=4 --film right-bending=5 --patient-left image-left
      the same without questions; the numbers are from --list
  spineline import xray.png --case-id P07 --out p07 --film erect=1 --patient-left image-right \\
      --ball erect=212,400,337,400,25
      a picture with a 25 mm ball: two clicks and its diameter give the scale
  spineline import films --case-id P07 --out p07 --film erect=1 --film left-bending=2 \\
      --landmarks coco.json --landmarks erect=raterB.json --reading raterB.json=B
      key points of both films in one file, matched by the names of the pictures, and a second reader's file of the erect one
  spineline import --midlines lines.json --case-id P07 --out p07
      midlines of the back surface, without films

Place landmarks in the browser app or in another program: --landmarks reads CSV, 3D Slicer, AASCE, labelme, COCO and DICOM SR \
files, with the confidences of a network where the file has them. Names, numbers and dates of the patient are removed from DICOM files unless you keep them; check the pictures for \
burned-in text yourself.";

#[derive(Args, Clone)]
pub struct ImportArgs {
    /// Films (DICOM, PNG, JPEG, TIFF), folders of them, and ZIP archives
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// List the films that were found and write nothing
    #[arg(long)]
    pub list: bool,
    /// Folder for the case; it must not hold a case
    #[arg(long, value_name = "DIR", required_unless_present = "list")]
    pub out: Option<PathBuf>,
    /// Identifier of the patient in this study: letters, digits, `-`, `_`; not a name or a hospital number
    #[arg(long, value_name = "ID", required_unless_present_any = ["list", "aasce"], value_parser = case_id)]
    pub case_id: Option<String>,
    /// Film of a posture: POSTURE=N with the number from `--list`, or POSTURE=FILE; may be repeated
    #[arg(long, value_name = "POSTURE=FILM", value_parser = film_choice)]
    pub film: Vec<(Posture, FilmChoice)>,
    /// Lateral film, for the sagittal profile: its number from `--list`, or its file
    #[arg(long, value_name = "FILM", value_parser = film)]
    pub lateral: Option<FilmChoice>,
    /// Side of the picture with the patient's left, where the file does not state it or is wrong: for all films, or for one
    /// as in erect=image-left; may be repeated
    #[arg(long, value_name = "[POSTURE=]SIDE", value_parser = side_of_film)]
    pub patient_left: Vec<OfFilm<ImageSide>>,
    /// Side of the lateral picture with the patient's front
    #[arg(long, value_parser = choice::<ImageSide>(), value_name = "SIDE")]
    pub patient_anterior: Option<ImageSide>,
    /// Whether the erect and the lateral film were exposed together, as biplanar scanners do, where the files do not state it
    /// or are wrong: then no turn of the lateral film is estimated, and no scale where both have a spacing
    #[arg(long, value_name = "YES|NO", value_parser = yes_or_no, requires = "lateral")]
    pub simultaneous: Option<bool>,
    /// Pixel spacing of columns and rows in mm and its plane, where the file has none or is wrong, as in
    /// 0.143,0.143,patient or erect=0.1,0.2,detector. With the plane `pixels` the width and height of a pixel are relative, as in
    /// 1,2,pixels: for angles without lengths; may be repeated
    #[arg(long, value_name = "[POSTURE=]COLUMN,ROW,PLANE", value_parser = spacing_of_film, allow_hyphen_values = true)]
    pub spacing: Vec<OfFilm<Spacing>>,
    /// Calibration ball in the picture: two pixels at opposite ends of a diameter, and the diameter in mm, optionally with its
    /// standard deviation, as in erect=212,400,337,400,25 or erect=212,400,337,400,25+-0.1; may be repeated
    #[arg(long, value_name = "POSTURE=COLUMN,ROW,COLUMN,ROW,MM", value_parser = ball)]
    pub ball: Vec<(Posture, Calibration)>,
    /// Ruler in the picture: two pixels on it, and the length between them in mm; format as `--ball`
    #[arg(long, value_name = "POSTURE=COLUMN,ROW,COLUMN,ROW,MM", value_parser = ruler)]
    pub ruler: Vec<(Posture, Calibration)>,
    /// File of landmarks from another program, for all films or for one as in erect=erect.mrk.json; may be repeated. `--help`
    /// lists the formats
    #[arg(long, value_name = "[POSTURE=]FILE", value_parser = landmarks)]
    pub landmarks: Vec<OfFilm<PathBuf>>,
    /// Observer, and repeat [default: 1], of a file of landmarks that states none, as in raterB.json=B or raterB.json=B:2; may be repeated
    #[arg(long, value_name = "FILE=OBSERVER[:REPEAT]", value_parser = reading)]
    pub reading: Vec<(PathBuf, ReadingId)>,
    /// Table (CSV) of landmarks on the lateral film, as `export --to lateral-csv` writes it; may be repeated. `--help` has its columns
    #[arg(long, value_name = "FILE", requires = "lateral")]
    pub lateral_landmarks: Vec<PathBuf>,
    /// Read the paths as folders of AASCE landmarks (filenames.csv, landmarks.csv): check every row, and write a case for
    /// each row without faults
    #[arg(long, conflicts_with_all = ["film", "lateral", "simultaneous", "landmarks", "case_id"])]
    pub aasce: bool,
    /// Read the paths as files of midlines from surface topography, and write a case without pictures; its levels are placed by
    /// arc length and marked as estimated
    #[arg(long, conflicts_with_all = ["list", "film", "lateral", "landmarks", "aasce", "patient_left", "spacing", "ball", "ruler"])]
    pub midlines: bool,
    /// Table with the sizes of the pictures of an AASCE folder, in pixels [default: image_sizes.csv in the folder; without it,
    /// the sizes are read from the pictures]
    #[arg(long, value_name = "FILE", requires = "aasce", conflicts_with = "pictures")]
    pub sizes: Option<PathBuf>,
    /// Folder with the pictures of an AASCE folder, whose sizes are read [default: the folder itself, or ../../data/NAME as in
    /// the published set]
    #[arg(long, value_name = "DIR", requires = "aasce")]
    pub pictures: Option<PathBuf>,
    /// Invert black and white of this film; may be repeated
    #[arg(long, value_name = "POSTURE", value_parser = posture)]
    pub invert: Vec<Posture>,
    /// Continue where a file contradicts your options
    #[arg(long)]
    pub accept: bool,
    /// Keep names, numbers and dates in DICOM files
    #[arg(long)]
    pub keep_identity: bool,
    /// Keep sex and age in DICOM files
    #[arg(long, conflicts_with = "keep_identity")]
    pub keep_characteristics: bool,
    /// File with the secret that maps identifiers, created if it does not exist; the same secret gives the same new
    /// identifiers. Do not pass it on [default: in your configuration folder]
    #[arg(long, value_name = "FILE")]
    pub secret: Option<PathBuf>,
}

/// A film by its number in the list, or by its file.
#[derive(Clone, Debug, PartialEq)]
pub enum FilmChoice {
    Number(usize),
    File(PathBuf),
}

/// A value for one film, or for all.
#[derive(Clone, Debug, PartialEq)]
pub struct OfFilm<T> {
    pub posture: Option<Posture>,
    pub value: T,
}

/// The value for a film: one that names the film goes before a general one.
pub fn answer_for<T: Copy>(all: &[OfFilm<T>], view: FilmView) -> Option<T> {
    let posture = view.posture();
    let named = all.iter().find(|said| posture.is_some() && said.posture == posture);
    let general = || all.iter().find(|said| said.posture.is_none());
    named.or_else(general).map(|said| said.value)
}

impl ImportArgs {
    /// The ball or the ruler in a posture's film, as if its pixels were square; the caller sets their aspect.
    pub fn calibration(&self, posture: Posture) -> Option<Calibration> {
        let mut all = self.ball.iter().chain(&self.ruler);
        all.find(|(of, _)| *of == posture).map(|(_, calibration)| *calibration)
    }

    /// Refuses options that this kind of import does not use. It looks at all of them, because clap drops a requirement where another
    /// option conflicts with what is required.
    pub fn check_kind(&self) -> Result<(), Failure> {
        let of_films = [
            ("--patient-anterior", self.patient_anterior.is_some()),
            ("--simultaneous", self.simultaneous.is_some()),
            ("--spacing", !self.spacing.is_empty()),
            ("--ball", !self.ball.is_empty()),
            ("--ruler", !self.ruler.is_empty()),
            ("--reading", !self.reading.is_empty()),
            ("--lateral-landmarks", !self.lateral_landmarks.is_empty()),
            ("--invert", !self.invert.is_empty()),
            ("--accept", self.accept),
            ("--keep-identity", self.keep_identity),
            ("--keep-characteristics", self.keep_characteristics),
            ("--secret", self.secret.is_some()),
        ];
        let of_aasce = [("--sizes", self.sizes.is_some()), ("--pictures", self.pictures.is_some())];
        let (idle, kind) = match (self.aasce, self.midlines) {
            (true, _) => (of_films.to_vec(), "--aasce"),
            (false, true) => ([&of_films[..], &of_aasce].concat(), "--midlines"),
            (false, false) => (of_aasce.to_vec(), "films"),
        };
        let idle: Vec<&str> = idle.iter().filter(|one| one.1).map(|one| one.0).collect();
        if idle.is_empty() {
            return Ok(());
        }
        Err(Failure::usage(format!("an import of {kind} does not use {}", idle.join(" and "))))
    }

    /// Refuses two answers to one question.
    pub fn check_answers(&self) -> Result<(), Failure> {
        let twice = |option: &str, postures: &[Option<Posture>]| {
            let repeated = postures.iter().enumerate().find(|(i, p)| postures[..*i].contains(p));
            match repeated {
                None => Ok(()),
                Some((_, posture)) => {
                    let film =
                        posture.map_or_else(|| "all films".to_owned(), |p| format!("the {p} film"));
                    Err(Failure::usage(format!("{option} is given twice for {film}")))
                }
            }
        };
        let calibrators = self.ball.iter().chain(&self.ruler).map(|(p, _)| Some(*p));
        self.check_readings()?;
        twice("--patient-left", &self.patient_left.iter().map(|o| o.posture).collect::<Vec<_>>())?;
        twice("--spacing", &self.spacing.iter().map(|o| o.posture).collect::<Vec<_>>())?;
        twice("a scale by --ball or --ruler", &calibrators.collect::<Vec<_>>())?;
        twice("--invert", &self.invert.iter().copied().map(Some).collect::<Vec<_>>())
    }

    /// Refuses a reading of a file that is not given, or two of one file.
    fn check_readings(&self) -> Result<(), Failure> {
        for (i, (file, _)) in self.reading.iter().enumerate() {
            let name = file.display();
            let mut given =
                self.landmarks.iter().map(|of| &of.value).chain(&self.lateral_landmarks);
            if !given.any(|one| is_same_file(one, file)) {
                return Err(Failure::usage(format!(
                    "--reading names {name}, which is not a given file of landmarks: add it with --landmarks or --lateral-landmarks"
                )));
            }
            if self.reading[..i].iter().any(|(other, _)| is_same_file(other, file)) {
                return Err(Failure::usage(format!("--reading is given twice for {name}")));
            }
        }
        Ok(())
    }

    /// Observer and repeat that were given for a file.
    pub fn reading_of(&self, file: &Path) -> Option<&ReadingId> {
        self.reading.iter().find(|(of, _)| is_same_file(of, file)).map(|(_, id)| id)
    }

    /// Refuses answers about a film that was not chosen.
    pub fn check_chosen(&self, views: &[FilmView]) -> Result<(), Failure> {
        if self.patient_anterior.is_some() && !views.contains(&FilmView::Lateral) {
            return Err(Failure::usage(
                "--patient-anterior is about the lateral film, which was not chosen: add --lateral FILM",
            ));
        }
        let chosen: Vec<Posture> = views.iter().filter_map(|view| view.posture()).collect();
        let sides = self.patient_left.iter().filter_map(|o| o.posture);
        let spacings = self.spacing.iter().filter_map(|o| o.posture);
        let scales = self.ball.iter().chain(&self.ruler).map(|(posture, _)| *posture);
        let mut named = sides.chain(spacings).chain(scales).chain(self.invert.iter().copied());
        match named.find(|posture| !chosen.contains(posture)) {
            None => Ok(()),
            Some(posture) => Err(Failure::usage(format!(
                "an option names the {posture} film, which was not chosen: add --film {}=…",
                posture.key().replace('_', "-")
            ))),
        }
    }

    /// The postures that were given a film.
    pub fn films(&self) -> BTreeMap<Posture, &FilmChoice> {
        self.film.iter().map(|(posture, choice)| (*posture, choice)).collect()
    }
}

fn case_id(text: &str) -> Result<String, String> {
    if is_case_id(text) { Ok(text.to_owned()) } else { Err(format!("expected {CASE_ID_RULE}")) }
}

fn yes_or_no(text: &str) -> Result<bool, String> {
    match text {
        "yes" => Ok(true),
        "no" => Ok(false),
        other => Err(format!("`{other}` is not `yes` or `no`")),
    }
}

fn film(text: &str) -> Result<FilmChoice, String> {
    match usize::from_str(text) {
        Ok(0) => Err("films are numbered from 1".to_owned()),
        Ok(number) => Ok(FilmChoice::Number(number)),
        Err(_) if text.is_empty() => Err("expected the number of a film, or its file".to_owned()),
        Err(_) => Ok(FilmChoice::File(PathBuf::from(text))),
    }
}

fn film_choice(text: &str) -> Result<(Posture, FilmChoice), String> {
    let (name, chosen) =
        text.split_once('=').ok_or_else(|| "expected POSTURE=FILM, such as erect=1 (the number of the film in `import --list`) or erect=IM001.dcm (its file)".to_owned())?;
    Ok((posture(name)?, film(chosen)?))
}

/// The value, and the posture before an equals sign if there is one.
fn of_film<T>(text: &str, value: impl Fn(&str) -> Result<T, String>) -> Result<OfFilm<T>, String> {
    Ok(match text.split_once('=') {
        Some((name, rest)) => OfFilm { posture: Some(posture(name)?), value: value(rest)? },
        None => OfFilm { posture: None, value: value(text)? },
    })
}

fn landmarks(text: &str) -> Result<OfFilm<PathBuf>, String> {
    // A file name may contain an equals sign, but a misspelt posture before it must not pass unnoticed.
    of_film(text, |file| match file {
        "" => Err("expected a file".to_owned()),
        file => Ok(PathBuf::from(file)),
    })
}

fn reading(text: &str) -> Result<(PathBuf, ReadingId), String> {
    let expected =
        || "expected FILE=OBSERVER or FILE=OBSERVER:REPEAT, such as b.json=B:2".to_owned();
    // A file name may contain an equals sign; an observer has neither that nor a colon.
    let (file, id) =
        text.rsplit_once('=').filter(|(file, _)| !file.is_empty()).ok_or_else(expected)?;
    let (observer, repeat) = id.split_once(':').unwrap_or((id, "1"));
    if !is_observer_code(observer) {
        return Err(format!("the observer is `{observer}`, and must be {OBSERVER_RULE}"));
    }
    let repeat = repeat.parse().ok().filter(|&repeat: &u32| repeat > 0);
    let repeat = repeat.ok_or_else(|| "the repeat must be a whole number from 1".to_owned())?;
    Ok((PathBuf::from(file), ReadingId::new(observer, repeat)))
}

fn side_of_film(text: &str) -> Result<OfFilm<ImageSide>, String> {
    of_film(text, |side| {
        named(&side.to_ascii_lowercase())
            .map_err(|_| format!("`{side}` is not `image-left` or `image-right`"))
    })
}

fn spacing_of_film(text: &str) -> Result<OfFilm<Spacing>, String> {
    of_film(text, |value| {
        let expected = || "expected COLUMN,ROW,PLANE, such as 0.143,0.143,patient".to_owned();
        let [column, row, plane] = value.split(',').collect::<Vec<_>>()[..] else {
            return Err(expected());
        };
        let plane: SpacingPlane = plane
            .parse()
            .map_err(|_| format!("`{plane}` is not patient, detector, unknown or pixels"))?;
        let (column, row) = (number(column)?, number(row)?);
        let spacing = match plane {
            SpacingPlane::Pixels => Spacing::of_aspect(row / column, SpacingSource::Stated),
            plane => Spacing::stated(column, row, plane),
        };
        if spacing.is_plausible() {
            Ok(spacing)
        } else {
            let [least, most] = [Spacing::MIN_MM, Spacing::MAX_MM];
            Err(format!("spacing {column},{row} mm: both must be from {least} to {most} mm"))
        }
    })
}

fn ball(text: &str) -> Result<(Posture, Calibration), String> {
    calibration(text, Calibrator::Ball)
}

fn ruler(text: &str) -> Result<(Posture, Calibration), String> {
    calibration(text, Calibrator::Ruler)
}

fn calibration(text: &str, calibrator: Calibrator) -> Result<(Posture, Calibration), String> {
    let expected =
        || "expected POSTURE=COLUMN,ROW,COLUMN,ROW,MM, such as erect=212,400,337,400,25".to_owned();
    let (name, rest) = text.split_once('=').ok_or_else(expected)?;
    let [a, b, c, d, length] = rest.split(',').collect::<Vec<_>>()[..] else {
        return Err(expected());
    };
    let (length, sd) = length.split_once("+-").unwrap_or((length, "0"));
    Ok((
        posture(name)?,
        Calibration {
            calibrator,
            clicks: [Pixel::new(number(a)?, number(b)?), Pixel::new(number(c)?, number(d)?)],
            length_mm: number(length)?,
            length_sd_mm: number(sd)?,
            click_sd_px: Calibration::CLICK_SD_PX,
            pixel_aspect: 1.0,
        },
    ))
}
