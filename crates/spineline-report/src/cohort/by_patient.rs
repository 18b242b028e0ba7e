//! Errors and notices of every patient of a cohort.

use std::collections::BTreeSet;

use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmRole, LineModel};
use spineline::cohort::Cohort;
use spineline::evaluate::Simulation;
use spineline::hypothesis::HypothesisScores;
use spineline::number::fixed;

use super::people::curve_size;
use crate::document::{NoticeKind, Section, Table};
use crate::patient;
use crate::phrases::{LINES, none, sentence_case};

/// Row of a patient in the tables of a cohort, without the shapes of the analysis: a few hundred bytes.
#[derive(Debug, Clone)]
pub struct PatientRow {
    case_id: Box<str>,
    synthetic: bool,
    /// Size of the main curve.
    main_curve: Option<Box<str>>,
    inflections: usize,
    models: Box<[ModelRow]>,
    /// Contradictions, warnings and notes.
    notices: [usize; 3],
    doubted_films: Option<Box<str>>,
    hypotheses: Box<[HypothesisScores]>,
}

/// A line of a patient.
#[derive(Debug, Clone)]
struct ModelRow {
    kind: LineKind,
    fitted_mm: Option<f64>,
    held_out_mm: Option<f64>,
    /// Joints that turn against the force, one number per fitted bend.
    counter_rotating: Box<str>,
    /// How the bends test the line.
    outcome: Box<str>,
}

const KINDS_OF_NOTICES: [NoticeKind; 3] =
    [NoticeKind::Contradiction, NoticeKind::Warning, NoticeKind::Note];

impl PatientRow {
    /// Most patients in a table of a terminal.
    pub const MAX_SHOWN: usize = 200;

    /// The row of an analysed patient.
    #[must_use]
    pub fn of(analysis: &Analysis) -> Self {
        let doubted = patient::doubted_films(analysis);
        Self {
            case_id: analysis.case_id.as_str().into(),
            synthetic: analysis.synthetic,
            main_curve: analysis.movement.main_curve().map(|curve| curve_size(curve).into()),
            inflections: analysis.movement.inflections.all.len(),
            models: analysis.models.iter().map(|model| ModelRow::of(analysis, model)).collect(),
            notices: KINDS_OF_NOTICES.map(|kind| notices(analysis, kind)),
            doubted_films: (!doubted.is_empty()).then(|| doubted.join(", ").into()),
            hypotheses: HypothesisScores::all(&analysis.hypotheses).into(),
        }
    }

    /// Whether it counts in means and tests: its films are not in doubt.
    pub(crate) const fn counts(&self) -> bool {
        self.doubted_films.is_none()
    }

    fn model(&self, kind: LineKind) -> Option<&ModelRow> {
        self.models.iter().find(|model| model.kind == kind)
    }

    /// Fits of other loads and bases; empty where they were not requested.
    pub(crate) fn hypotheses(&self) -> (bool, &[HypothesisScores]) {
        (self.synthetic, &self.hypotheses)
    }
}

impl ModelRow {
    fn of(analysis: &Analysis, model: &LineModel) -> Self {
        let fitted = model.simulations.iter().filter(|simulation| simulation.fitted);
        let count = |s: &Simulation| s.is_usable().then(|| s.contradicted.len().to_string());
        let counts: Vec<String> = fitted.map(|s| count(s).unwrap_or_else(none)).collect();
        Self {
            kind: model.kind,
            fitted_mm: model.mean_location_error_mm(true),
            held_out_mm: model.mean_location_error_mm(false),
            counter_rotating: counts.join(", ").into(),
            outcome: patient::outcome(analysis, model).into(),
        }
    }

    /// Mean location errors on fitted bends, on bends left out and on held-out films, of the patient at a place of the cohort.
    fn errors(&self, cohort: &Cohort, place: usize) -> [String; 3] {
        let bends = cohort.compared.of_line(self.kind, FilmRole::LeftOutBend);
        let mean = bends.and_then(|errors| errors.by_patient_mm.get(place));
        let left_out = mean.copied().filter(|mean| !mean.is_nan());
        [self.fitted_mm, left_out, self.held_out_mm]
            .map(|error| error.map_or_else(none, |error| fixed(error, 1)))
    }
}

/// How the bends of the first patients test every line.
pub fn outcomes(patients: &[PatientRow], most: usize) -> Table {
    let kinds: BTreeSet<LineKind> = patients
        .iter()
        .flat_map(|patient| patient.models.iter().map(|model| model.kind))
        .filter(|&kind| kind != LineKind::Estimated)
        .collect();
    let all = patients.len();
    let shown = if most < all {
        format!("the first {most} of {all} patients")
    } else {
        "each patient".to_owned()
    };
    let caption = format!("A single force along the line, by the bends of {shown}");
    Table::of(caption, patients.iter().take(most), |add| {
        add.words("Patient", |patient| patient.case_id.to_string());
        add.numbers("Main Cobb angle (°)", |patient| or_none(patient.main_curve.as_deref()));
        for kind in kinds {
            add.words(sentence_case(&kind.to_string()), |patient| {
                or_none(patient.model(kind).map(|model| &*model.outcome))
            });
        }
        add.words("Films in doubt", |patient| or_none(patient.doubted_films.as_deref()));
    })
}

/// A row per patient and line, and the notices of every patient.
pub fn section(patients: &[PatientRow], cohort: &Cohort) -> Section {
    let mut section = new();
    let models = patients.iter().enumerate().flat_map(|(place, patient)| {
        let of_patient = patient.models.iter();
        of_patient.map(move |model| (patient, model, model.errors(cohort, place)))
    });
    let mut table = Table::of(caption("every patient"), models, |add| {
        add.words("Case", |(patient, ..)| patient.case_id.to_string());
        add.words("Line of action", |(_, model, _)| model.kind.to_string());
        add.numbers("Fitted bends (mm)", |(.., errors)| errors[0].clone());
        add.numbers("Bends left out (mm)", |(.., errors)| errors[1].clone());
        add.numbers("Held-out films (mm)", |(.., errors)| errors[2].clone());
        add.words("Counter-rotating joints", |(_, model, _)| model.counter_rotating.to_string());
    });
    table.note = "Each line on the films on which it has a result. Counter-rotating joints: joints of each fitted bend that turn against the force. Patients without a model have no row.".to_owned();
    section.table(table);
    let caption = "Contradictions, warnings and notes of every patient";
    section.table(Table::of(caption, patients, |add| {
        add.words("Case", |patient| patient.case_id.to_string());
        for (place, kind) in KINDS_OF_NOTICES.into_iter().enumerate() {
            let head = format!("{}s", kind.word());
            add.numbers(head, |patient| patient.notices[place].to_string());
        }
        add.words("Doubted films", |patient| or_none(patient.doubted_films.as_deref()));
    }));
    section
}

/// One row for each of the first patients, in as many columns as a terminal has room for.
pub fn summary(patients: &[PatientRow], cohort: &Cohort) -> Section {
    let mut section = new();
    let (most, all) = (PatientRow::MAX_SHOWN, patients.len());
    let (shown, rest) = if most < all {
        let first = format!("the first {most} of {all} patients");
        (first, " --tables and --json write all patients.")
    } else {
        ("every patient".to_owned(), "")
    };
    let first = patients.iter().take(most).enumerate();
    let mut table = Table::of(caption(&shown), first, |add| {
        add.words("Case", |(_, patient)| patient.case_id.to_string());
        add.numbers("Main Cobb angle (°)", |(_, patient)| or_none(patient.main_curve.as_deref()));
        add.numbers("Inflections", |(_, patient)| patient.inflections.to_string());
        for kind in LINES {
            let head = format!("{} (mm)", sentence_case(&kind.to_string()));
            add.words(head, |(place, patient)| {
                let model = patient.model(kind);
                model.map_or_else(none, |model| model.errors(cohort, *place).join(" / "))
            });
        }
        add.numbers("Counter-rotating joints", |(_, patient)| {
            or_none(patient.model(LINES[0]).map(|model| &*model.counter_rotating))
        });
        add.numbers("Contradictions, warnings, notes", |(_, patient)| {
            patient.notices.map(|count| count.to_string()).join(", ")
        });
    });
    table.note = format!(
        "Location errors: fitted bends / bends left out / held-out films, each over the films on which the line has a result. Counter-rotating joints: joints of each fitted bend that turn against the force along the {}.{rest}",
        LINES[0]
    );
    section.table(table);
    section
}

/// Caption of a table of these patients.
fn caption(patients: &str) -> String {
    format!("Mean location errors of {patients}")
}

fn new() -> Section {
    Section::new("by-patient", "Patient by patient")
}

fn or_none(text: Option<&str>) -> String {
    text.map_or_else(none, str::to_owned)
}

fn notices(analysis: &Analysis, kind: NoticeKind) -> usize {
    let all = analysis.all_warnings();
    all.filter(|warning| NoticeKind::from(warning.code.severity()) == kind).count()
}
