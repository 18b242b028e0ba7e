//! Combines a film's metadata with the user's options; what is missing or contradictory becomes a question.

use std::fmt;

use spineline::anatomy::{FilmView, ImageSide, Posture};
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane, SpacingSource};
use spineline::number::fixed;
use spineline_films::{
    FilmDoubt, shape_contradiction, side_contradiction, spacing_question, view_contradictions,
};
use spineline_marking::{Calibration, judge_view};

use super::args::{ImportArgs, answer_for};
use super::candidates::{ChosenFilm, Seen};
use crate::run::failure::Failure;

pub struct ResolvedFilm {
    pub view: FilmView,
    /// Place in the list of films.
    pub index: usize,
    /// The geometry of its picture; a lateral film has the front in place of the left.
    pub image: ImageGeometry,
    pub inverted: bool,
    /// Of the lateral film, whether it was exposed together with the erect one.
    pub simultaneous: bool,
    /// Whether its file says that it is a phantom's.
    pub is_phantom: bool,
    /// SHA-256 of the file that was looked at.
    pub source: String,
    /// Remarks on the film and what was done about them.
    pub notes: Vec<String>,
}

/// Something that only a person can answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    pub view: FilmView,
    pub about: About,
}

/// What a question is about.
#[derive(Clone, Debug, PartialEq)]
pub enum About {
    /// The side of the picture on which the patient's left (or front) is.
    Side,
    /// The file contradicts the user.
    Contradiction(String),
    /// The file states the distances between pixels, or their shape, in a way that does not tell what they are.
    Spacing(String),
}

impl fmt::Display for Question {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { view, about } = self;
        match about {
            About::Side => write!(
                f,
                "{view} film: the file does not state on which side of the picture the patient's {} is",
                asked_side(*view)
            ),
            About::Contradiction(text) | About::Spacing(text) => write!(f, "{view} film: {text}"),
        }
    }
}

/// The side of the patient that a question names.
pub const fn asked_side(view: FilmView) -> &'static str {
    match view {
        FilmView::Frontal(_) => "left",
        FilmView::Lateral => "front",
    }
}

impl Question {
    /// How it is answered on the command line.
    pub fn answer(&self) -> String {
        match (&self.about, self.view) {
            (About::Side, FilmView::Lateral) => {
                "--patient-anterior image-left or image-right".to_owned()
            }
            (About::Side, view) => format!(
                "--patient-left {0}=image-left or {0}=image-right (look for the lead marker, the heart, the stomach's bubble)",
                view.key().replace('_', "-")
            ),
            (About::Spacing(_), view) => {
                let film = match view {
                    FilmView::Frontal(_) => format!("{}=", view.key().replace('_', "-")),
                    FilmView::Lateral => String::new(),
                };
                format!(
                    "--spacing {film}COLUMN,ROW,PLANE in mm, such as --spacing {film}0.25,0.5,unknown; where the shape of a pixel alone is known, its width and height and the plane `pixels`, such as --spacing {film}1,1,pixels for square pixels"
                )
            }
            (About::Contradiction(_), _) => {
                "correct your options, choose another film, or --accept if you are sure".to_owned()
            }
        }
    }
}

/// Resolves one film, or returns the questions that are open.
pub fn resolve(
    args: &ImportArgs,
    chosen: &ChosenFilm<'_>,
    doubts: &[FilmDoubt],
    side_by_dialogue: Option<ImageSide>,
) -> Result<Result<ResolvedFilm, Vec<Question>>, Failure> {
    let &ChosenFilm { view, index, seen } = chosen;
    let mut questions = Vec::new();
    let others = seen.remarks.iter().filter(|remark| !remark.is_other_body_part());
    let mut notes: Vec<String> = others.map(ToString::to_string).collect();
    let judged = judge_view(&seen.tags.view, view.posture());
    let mut contradicted = view_contradictions(view, &judged);
    contradicted.extend(doubts.iter().map(|doubt| doubt.text.clone()));
    let by_file = match view {
        FilmView::Frontal(_) => judged.patient_left,
        FilmView::Lateral => judged.patient_anterior,
    };
    let said = match view {
        FilmView::Frontal(_) => answer_for(&args.patient_left, view),
        FilmView::Lateral => args.patient_anterior,
    };
    let said = said.or(side_by_dialogue);
    contradicted
        .extend(said.and_then(|said| side_contradiction(view, &judged, said, "your option")));
    let said_spacing = answer_for(&args.spacing, view);
    let by_tags = seen.spacing();
    // Where the file leaves the shape open, the option decides it.
    let by_tags = by_tags.spacing.filter(|_| by_tags.question().is_none());
    if let Some((by_tags, said)) = by_tags.zip(said_spacing) {
        contradicted.extend(shape_contradiction(&by_tags, &said, "your --spacing"));
    }
    for text in contradicted {
        if args.accept {
            notes.push(format!("{text}; accepted by --accept"));
        } else {
            questions.push(Question { view, about: About::Contradiction(text) });
        }
    }
    if said_spacing.is_none() {
        let asked = spacing_question(&seen.tags, &seen.remarks);
        questions.extend(asked.map(|text| Question { view, about: About::Spacing(text) }));
    }
    let Some(patient_left) = said.or(by_file) else {
        questions.push(Question { view, about: About::Side });
        return Ok(Err(questions));
    };
    if !questions.is_empty() {
        return Ok(Err(questions));
    }
    let spacing = spacing(args, view, seen, &mut notes)?;
    let inverted = view.posture().is_some_and(|posture| args.invert.contains(&posture));
    Ok(Ok(ResolvedFilm {
        view,
        index,
        image: ImageGeometry { columns: seen.columns, rows: seen.rows, spacing, patient_left },
        inverted,
        simultaneous: false,
        is_phantom: seen.tags.is_phantom,
        source: seen.source.clone(),
        notes,
    }))
}

/// The spacing of a film: by a ball or a ruler, by the option, or by its file.
fn spacing(
    args: &ImportArgs,
    view: FilmView,
    seen: &Seen,
    notes: &mut Vec<String>,
) -> Result<Option<Spacing>, Failure> {
    let judged = seen.spacing();
    let said = answer_for(&args.spacing, view);
    let calibration = view.posture().and_then(|posture| args.calibration(posture));
    let calibrated = calibration.map(|clicked| {
        // A ball does not give the aspect ratio of a pixel; a spacing does, in any plane.
        let known = said.or(judged.spacing);
        let pixel_aspect = known.map_or(clicked.pixel_aspect, |spacing| spacing.aspect());
        Calibration { pixel_aspect, ..clicked }
            .spacing([seen.columns, seen.rows])
            .map_err(|error| Failure::usage(format!("the scale of the {view} film: {error}")))
    });
    let calibrated = calibrated.transpose()?;
    if let Some((said, used)) = said.zip(calibrated) {
        compare(view, "your --spacing", &said, &used, notes);
    }
    let Some(used) = calibrated.or(said) else {
        notes.extend(judged.remarks.iter().map(ToString::to_string));
        return Ok(judged.spacing);
    };
    if let Some(file) = judged.spacing {
        compare(view, "the file's", &file, &used, notes);
    }
    Ok(Some(used))
}

/// Notes a scale that differs from another one, which is not used, by more than a magnification can.
fn compare(view: FilmView, name: &str, other: &Spacing, used: &Spacing, notes: &mut Vec<String>) {
    if !(other.has_millimetres() && used.has_millimetres()) {
        return;
    }
    let ratio = used.column_mm / other.column_mm;
    let usual = match other.plane {
        SpacingPlane::Patient => 0.95..=1.05,
        _ => 0.7..=1.02,
    };
    if !usual.contains(&ratio) {
        let source = match other.source {
            SpacingSource::Stated => String::new(),
            source => format!(" ({source})"),
        };
        notes.push(format!(
            "the scale used for the {view} film is {} times {name}{source}; {name} is not used",
            fixed(ratio, 3)
        ));
    }
}

/// Checks the films of the case together: each is another picture, and the erect film is among them.
pub fn check_films(films: &[ChosenFilm<'_>]) -> Result<(), Failure> {
    for (i, film) in films.iter().enumerate() {
        let twin = films[..i].iter().find(|other| other.seen.picture == film.seen.picture);
        if let Some(other) = twin {
            return Err(Failure::input(
                format!("{} film and {} film", other.view, film.view),
                "both are the same picture",
                "choose a different film for each posture",
            ));
        }
    }
    if films.iter().any(|film| film.view == FilmView::Frontal(Posture::Erect)) {
        return Ok(());
    }
    Err(Failure::usage("a case needs an erect film: choose it, as in --film erect=1"))
}

/// Films that carry the same identifier and different pixels.
pub fn same_identifier(films: &[ChosenFilm<'_>]) -> Vec<String> {
    let mut notes = Vec::new();
    for (i, film) in films.iter().enumerate() {
        let uid = &film.seen.tags.uids.sop_instance;
        let is_same =
            |other: &&ChosenFilm<'_>| uid.is_some() && other.seen.tags.uids.sop_instance == *uid;
        for other in films[..i].iter().filter(is_same) {
            notes.push(format!(
                "the {} film and the {} film have the same SOP Instance UID but different pixels: one was changed without a new identifier",
                other.view, film.view
            ));
        }
    }
    notes
}
