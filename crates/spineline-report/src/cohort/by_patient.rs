//! Errors and notices of every patient of a cohort.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmRole, LineModel};
use spineline::cohort::Cohort;
use spineline::evaluate::statistics::Summary;

use super::people::curve_size;
use crate::document::{Column, NoticeKind, Section, Table};
use crate::phrases::{none, sentence_case};

/// The lines of the table in a terminal.
const KINDS: [LineKind; 3] = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated];
const LEFT_OUT: &str = "A bend left out counts where all lines have a result on it.";

/// A row per patient and line, and the notices of every patient.
pub fn section(analyses: &[Analysis], cohort: &Cohort) -> Section {
    let mut section = new();
    let columns = vec![
        Column::words("Case"),
        Column::words("Line of action"),
        Column::numbers("Fitted bends (mm)"),
        Column::numbers("Bends left out (mm)"),
        Column::numbers("Held-out films (mm)"),
        Column::words("Counter-rotating joints"),
    ];
    let mut table = Table::new(CAPTION, columns);
    for (place, analysis) in analyses.iter().enumerate() {
        for model in &analysis.models {
            let errors = errors(cohort, place, model);
            let words = [analysis.case_id.clone(), model.kind.to_string()];
            table.row(words.into_iter().chain(errors).chain([against(model)]).collect());
        }
    }
    table.note = format!(
        "{LEFT_OUT} Counter-rotating joints: joints of each fitted bend that turn against the force. Patients without a model have no row."
    );
    section.table(table);
    let kinds = [NoticeKind::Contradiction, NoticeKind::Warning, NoticeKind::Note];
    let columns = kinds.map(|kind| Column::numbers(format!("{}s", kind.word())));
    let films = Column::words("Doubted films");
    let columns = [Column::words("Case")].into_iter().chain(columns).chain([films]).collect();
    let mut table = Table::new("Contradictions, warnings and notes of every patient", columns);
    for analysis in analyses {
        let counts = kinds.map(|kind| notices(analysis, kind));
        let doubted = doubted_films(analysis);
        table.row([analysis.case_id.clone()].into_iter().chain(counts).chain([doubted]).collect());
    }
    section.table(table);
    section
}

/// One row per patient, in as many columns as a terminal has room for.
pub fn summary(analyses: &[Analysis], cohort: &Cohort) -> Section {
    let mut section = new();
    let mut columns = vec![
        Column::words("Case"),
        Column::numbers("Main Cobb angle (°)"),
        Column::numbers("Inflections"),
    ];
    columns.extend(
        KINDS.map(|kind| Column::words(format!("{} (mm)", sentence_case(&kind.to_string())))),
    );
    columns.push(Column::numbers("Counter-rotating joints"));
    columns.push(Column::numbers("Contradictions, warnings, notes"));
    let mut table = Table::new(CAPTION, columns);
    for (place, analysis) in analyses.iter().enumerate() {
        table.row(summary_row(analysis, cohort, place));
    }
    table.note = format!(
        "Location errors: fitted bends / bends left out / held-out films. {LEFT_OUT} Counter-rotating joints: joints of each fitted bend that turn against the force along the {}.",
        KINDS[0]
    );
    section.table(table);
    section
}

const CAPTION: &str = "Mean location errors of every patient";

fn new() -> Section {
    Section::new("by-patient", "Patient by patient")
}

fn summary_row(analysis: &Analysis, cohort: &Cohort, place: usize) -> Vec<String> {
    let main = analysis.main_curve();
    let mut row = vec![
        analysis.case_id.clone(),
        main.map_or_else(none, curve_size),
        analysis.inflections.all.len().to_string(),
    ];
    let of = |kind| analysis.models.iter().find(|model| model.kind == kind);
    row.extend(
        KINDS.map(|kind| {
            of(kind).map_or_else(none, |model| errors(cohort, place, model).join(" / "))
        }),
    );
    row.push(of(KINDS[0]).map_or_else(none, against));
    let kinds = [NoticeKind::Contradiction, NoticeKind::Warning, NoticeKind::Note];
    row.push(kinds.map(|kind| notices(analysis, kind)).join(", "));
    row
}

/// Mean location errors on fitted bends, on bends left out and on held-out films, of the patient at a place of the cohort.
fn errors(cohort: &Cohort, place: usize, model: &LineModel) -> [String; 3] {
    let bends = cohort.compared.errors.iter();
    let mut bends = bends.filter(|e| e.role == FilmRole::LeftOutBend && e.kind == model.kind);
    let values = bends.next().and_then(|errors| errors.location_mm.by_patient.get(place));
    let left_out = values.filter(|values| !values.is_empty()).map(|v| Summary::of(v).mean);
    let [fitted, held_out] = [true, false].map(|fitted| model.mean_location_error_mm(fitted));
    [fitted, left_out, held_out].map(|error| error.map_or_else(none, |error| format!("{error:.1}")))
}

/// Joints that turn against the force, one number per fitted bend.
fn against(model: &LineModel) -> String {
    let fitted = model.postures.iter().filter(|simulation| simulation.fitted);
    fitted.map(|s| s.contradicted.len().to_string()).collect::<Vec<_>>().join(", ")
}

/// Films of a patient that may be wrong ones.
fn doubted_films(analysis: &Analysis) -> String {
    let mut films: Vec<String> = Vec::new();
    for warning in analysis.film_doubts() {
        let film = warning.posture.map_or_else(|| "lateral".to_owned(), |p| p.to_string());
        if !films.contains(&film) {
            films.push(film);
        }
    }
    if films.is_empty() { none() } else { films.join(", ") }
}

fn notices(analysis: &Analysis, kind: NoticeKind) -> String {
    let all = analysis.warnings.all().iter();
    all.filter(|warning| NoticeKind::from(warning.severity()) == kind).count().to_string()
}
