//! Lines of action on the same films, of one patient and of a cohort.

use spineline::analysis::{FilmRole, FreeNumbers, LinesCompared, probability};
use spineline::cohort::{Clustered, Cohort, ErrorKind, LinePairTest, LinesOverPatients};

use super::table::{Table, wrap};

const WIDTH: usize = 110;

/// One patient: every line by kind of film.
pub fn patient_text(found: &LinesCompared) -> String {
    let mut table = Table::new([
        "Lines on the same films",
        "films",
        "location error (mm)",
        "Ferguson error (°)",
        "numbers from the films",
    ]);
    for (place, line) in found.lines.iter().enumerate() {
        for role in FilmRole::ALL {
            let Some(errors) = found.errors(place, role) else { continue };
            table.row(vec![
                format!("{:15} {role}", line.kind.to_string()),
                errors.films.to_string(),
                format!("{:.2}", errors.location_mm),
                format!("{:.1}", errors.ferguson_deg),
                numbers_text(&line.numbers, role),
            ]);
        }
    }
    format!("{}{}\n", table.text(), wrap(&patient_note(found), WIDTH, "  "))
}

fn patient_note(found: &LinesCompared) -> String {
    let mut note = "Numbers fitted: free multipliers + forces + position of a free line. A bend that is left out is predicted with the stiffness that the other bend gave.".to_owned();
    let left: Vec<String> = FilmRole::ALL
        .into_iter()
        .filter_map(|role| match found.counted(role) {
            (_, 0) => None,
            (all, left) => Some(format!("{left} of {all} ({role})")),
        })
        .collect();
    if !left.is_empty() {
        note.push_str(&format!(
            " Not compared, because a line has no result: {}.",
            left.join(", ")
        ));
    }
    if !found.same_data() {
        note.push_str(" The free line was fitted to whole shapes, the others to Ferguson angles: not the same data.");
    }
    note
}

fn numbers_text(numbers: &FreeNumbers, role: FilmRole) -> String {
    let FreeNumbers { multipliers, forces, line, per_predicted_film } = *numbers;
    match role {
        FilmRole::Fitted => {
            format!("{multipliers} + {forces} + {line} = {} fitted", numbers.fitted())
        }
        _ => format!("{per_predicted_film} per film"),
    }
}

/// A cohort: errors by line and kind of film, then every pair of lines.
pub fn cohort_text(cohort: &Cohort) -> String {
    let compared = &cohort.compared;
    if compared.family() == 0 {
        return "No two lines can be compared: that takes two patients with bending films.\n"
            .to_owned();
    }
    let mut text = errors_table(compared);
    text.push('\n');
    text.push_str(&tests_table(compared));
    let note = format!(
        "Intervals are over patients. Left out: films on which a line has no result. Numbers fitted: free multipliers + forces + position of a free line. A bend left out is predicted with the stiffness that the other bend gave. {}. {}.",
        compared.believe_words(),
        compared.family_words()
    );
    text.push_str(&wrap(&note, WIDTH, "  "));
    text
}

fn errors_table(compared: &LinesOverPatients) -> String {
    let mut table = Table::new([
        "Lines on the same films",
        "patients",
        "films",
        "left out",
        "location, mm (95 %)",
        "Ferguson, ° (95 %)",
        "numbers from films",
    ]);
    let mean = |values: &Clustered| with_interval(values.patients.mean, values.bootstrap, 1);
    for errors in compared.errors.iter().filter(|errors| errors.films > 0) {
        let numbers = compared.numbers.iter().find(|(kind, _)| *kind == errors.kind);
        table.row(vec![
            format!("{:15} {}", errors.kind.to_string(), errors.role),
            errors.location_mm.patients.n.to_string(),
            errors.films.to_string(),
            errors.left_out.to_string(),
            mean(&errors.location_mm),
            mean(&errors.ferguson_deg),
            numbers.map_or_else(String::new, |(_, n)| numbers_text(n, errors.role)),
        ]);
    }
    table.text()
}

fn tests_table(compared: &LinesOverPatients) -> String {
    let mut table = Table::new([
        "First minus second line",
        "error",
        "patients",
        "difference (95 %)",
        "effect d (95 %)",
        "sign-flip p",
        "Holm p",
        "pooled p",
    ]);
    let p = |p: Option<f64>| p.map_or_else(|| "-".to_owned(), |p| short(&probability(p)));
    for test in compared.tests.iter().filter(|test| test.holm_p.is_some()) {
        let c = &test.comparison;
        let effect = c.effect.map(|e| with_interval(e.d, Some(e.interval), 1));
        table.row(vec![
            test_name(test),
            match test.error {
                ErrorKind::Location => "location, mm",
                ErrorKind::Ferguson => "Ferguson, °",
            }
            .to_owned(),
            c.patients().to_string(),
            with_interval(c.mean_difference, c.bootstrap, 1),
            effect.unwrap_or_else(|| "-".to_owned()),
            p(c.sign_flip.map(|t| t.p_two_sided)),
            p(test.holm_p),
            p(c.pooled.map(|t| t.p_two_sided)),
        ]);
    }
    table.text()
}

fn test_name(test: &LinePairTest) -> String {
    let [first, second] = test.lines.map(|kind| kind.to_string().replace(" line", ""));
    format!("{:24} {}", format!("{first} - {second}"), test.role)
}

fn short(probability: &str) -> String {
    probability.trim_start_matches("= ").to_owned()
}

fn with_interval(mean: f64, ends: Option<[f64; 2]>, places: usize) -> String {
    let ends = ends
        .map_or_else(String::new, |[low, high]| format!(" ({low:.places$} to {high:.places$})"));
    format!("{mean:.places$}{ends}")
}
