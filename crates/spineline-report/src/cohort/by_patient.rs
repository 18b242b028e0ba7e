//! Errors and notices of every patient of a cohort.

use std::collections::BTreeSet;

use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmRole, LineModel};
use spineline::cohort::Cohort;
use spineline::hypothesis::HypothesisScores;
use spineline::number::fixed;

use super::people::curve_size;
use crate::document::{Column, NoticeKind, Section, Table};
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
    /// Doubted films.
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

/// Doubted films of a patient.
fn doubted_films(analysis: &Analysis) -> Option<Box<str>> {
    let films = patient::doubted_films(analysis);
    (!films.is_empty()).then(|| films.join(", ").into())
}

impl PatientRow {
    /// Most patients in a table of a terminal.
    pub const MAX_SHOWN: usize = 200;

    /// The row of an analysed patient.
    #[must_use]
    pub fn of(analysis: &Analysis) -> Self {
        Self {
            case_id: analysis.case_id.as_str().into(),
            synthetic: analysis.synthetic,
            main_curve: analysis.movement.main_curve().map(|curve| curve_size(curve).into()),
            inflections: analysis.movement.inflections.all.len(),
            models: analysis.models.iter().map(|model| ModelRow::of(analysis, model)).collect(),
            notices: KINDS_OF_NOTICES.map(|kind| notices(analysis, kind)),
            doubted_films: doubted_films(analysis),
            hypotheses: HypothesisScores::all(&analysis.hypotheses).into(),
        }
    }

    /// Fits of other loads and bases; empty where they were not requested.
    pub(crate) fn hypotheses(&self) -> (bool, &[HypothesisScores]) {
        (self.synthetic, &self.hypotheses)
    }
}

impl ModelRow {
    fn of(analysis: &Analysis, model: &LineModel) -> Self {
        let fitted = model.simulations.iter().filter(|simulation| simulation.fitted);
        let counts: Vec<String> = fitted.map(|s| s.contradicted.len().to_string()).collect();
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
    let mut columns = vec![Column::words("Patient"), Column::numbers("Main Cobb angle (°)")];
    columns.extend(kinds.iter().map(|kind| Column::words(sentence_case(&kind.to_string()))));
    columns.push(Column::words("Films in doubt"));
    let all = patients.len();
    let shown = if most < all {
        format!("the first {most} of {all} patients")
    } else {
        "each patient".to_owned()
    };
    let mut table =
        Table::new(format!("A single force along the line, by the bends of {shown}"), columns);
    for patient in patients.iter().take(most) {
        let of = |kind| patient.models.iter().find(|model| model.kind == kind);
        let mut row = vec![patient.case_id.to_string(), or_none(patient.main_curve.as_deref())];
        row.extend(
            kinds.iter().map(|&kind| of(kind).map_or_else(none, |model| model.outcome.to_string())),
        );
        row.push(or_none(patient.doubted_films.as_deref()));
        table.row(row);
    }
    table
}

/// A row per patient and line, and the notices of every patient.
pub fn section(patients: &[PatientRow], cohort: &Cohort) -> Section {
    let mut section = new();
    let columns = vec![
        Column::words("Case"),
        Column::words("Line of action"),
        Column::numbers("Fitted bends (mm)"),
        Column::numbers("Bends left out (mm)"),
        Column::numbers("Held-out films (mm)"),
        Column::words("Counter-rotating joints"),
    ];
    let mut table = Table::new(caption("every patient"), columns);
    for (place, patient) in patients.iter().enumerate() {
        for model in &patient.models {
            let mut row = vec![patient.case_id.to_string(), model.kind.to_string()];
            row.extend(model.errors(cohort, place));
            row.push(model.counter_rotating.to_string());
            table.row(row);
        }
    }
    table.note = "Each line on the films on which it has a result. Counter-rotating joints: joints of each fitted bend that turn against the force. Patients without a model have no row.".to_owned();
    section.table(table);
    let columns = KINDS_OF_NOTICES.map(|kind| Column::numbers(format!("{}s", kind.word())));
    let films = Column::words("Doubted films");
    let columns = [Column::words("Case")].into_iter().chain(columns).chain([films]).collect();
    let mut table = Table::new("Contradictions, warnings and notes of every patient", columns);
    for patient in patients {
        let mut row = vec![patient.case_id.to_string()];
        row.extend(patient.notices.map(|count| count.to_string()));
        row.push(or_none(patient.doubted_films.as_deref()));
        table.row(row);
    }
    section.table(table);
    section
}

/// One row for each of the first patients, in as many columns as a terminal has room for.
pub fn summary(patients: &[PatientRow], cohort: &Cohort) -> Section {
    let mut section = new();
    let mut columns = vec![
        Column::words("Case"),
        Column::numbers("Main Cobb angle (°)"),
        Column::numbers("Inflections"),
    ];
    columns.extend(
        LINES.map(|kind| Column::words(format!("{} (mm)", sentence_case(&kind.to_string())))),
    );
    columns.push(Column::numbers("Counter-rotating joints"));
    columns.push(Column::numbers("Contradictions, warnings, notes"));
    let (most, all) = (PatientRow::MAX_SHOWN, patients.len());
    let (shown, rest) = if most < all {
        let first = format!("the first {most} of {all} patients");
        (first, " --tables and --json write all patients.")
    } else {
        ("every patient".to_owned(), "")
    };
    let mut table = Table::new(caption(&shown), columns);
    for (place, patient) in patients.iter().take(most).enumerate() {
        table.row(patient.summary(cohort, place));
    }
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

impl PatientRow {
    fn summary(&self, cohort: &Cohort, place: usize) -> Vec<String> {
        let mut row = vec![
            self.case_id.to_string(),
            or_none(self.main_curve.as_deref()),
            self.inflections.to_string(),
        ];
        let of = |kind| self.models.iter().find(|model| model.kind == kind);
        row.extend(LINES.map(|kind| {
            of(kind).map_or_else(none, |model| model.errors(cohort, place).join(" / "))
        }));
        row.push(of(LINES[0]).map_or_else(none, |model| model.counter_rotating.to_string()));
        row.push(self.notices.map(|count| count.to_string()).join(", "));
        row
    }
}

fn or_none(text: Option<&str>) -> String {
    text.map_or_else(none, str::to_owned)
}

fn notices(analysis: &Analysis, kind: NoticeKind) -> usize {
    let all = analysis.warnings.all().iter();
    all.filter(|warning| NoticeKind::from(warning.code.severity()) == kind).count()
}
