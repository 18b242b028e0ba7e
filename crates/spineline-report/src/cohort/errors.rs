//! Errors of the models over a cohort, by kind of film, and every test between the lines.

use spineline::analysis::FilmRole;
use spineline::cohort::{Cohort, ErrorKind, LinePairTest, MissingResult, RoleErrors};
use spineline::number::{p_value, with_sd};

use super::movement::tested;

use crate::document::{Column, Figure, Notice, NoticeKind, Section, Table};
use crate::figures::{self, LocationErrorSample};
use crate::phrases::{FITTED, HELD_OUT, LEFT_OUT, line_in_short, none, numbers, with_interval};

const NO_MODEL: &str = "No patient has a personalised model.";

/// Figure 8 of the paper and its numbers, once per kind of film.
pub fn by_kind_of_film(cohort: &Cohort) -> Section {
    let mut section = Section::new("errors", "Errors of the models");
    if cohort.compared.errors.is_empty() {
        section.paragraph(NO_MODEL);
        return section;
    }
    section.heading("Fitted films");
    section.paragraph(FITTED);
    kind_of_film(&mut section, cohort, "fitted", "bending films, fitted", FilmRole::Fitted);
    section.heading("Bends left out of the fit in turn");
    section.paragraph(LEFT_OUT);
    let films = "bending films, left out";
    kind_of_film(&mut section, cohort, "left-out", films, FilmRole::LeftOutBend);
    section.heading("Held-out films");
    section.paragraph(HELD_OUT);
    let films = "neutral and traction films, held out";
    kind_of_film(&mut section, cohort, "held-out", films, FilmRole::HeldOut);
    section
}

fn kind_of_film(section: &mut Section, cohort: &Cohort, name: &str, films: &str, role: FilmRole) {
    let group = if cohort.synthetic { "all patients (synthetic)" } else { "all patients" };
    let samples: Vec<LocationErrorSample> = cohort
        .compared
        .of_role(role)
        .map(|errors| LocationErrorSample {
            group: group.to_owned(),
            line: errors.kind,
            errors_mm: errors.all_location_mm.clone(),
            paper: None,
        })
        .collect();
    let Some(svg) = figures::location_errors(&samples, films, cohort.synthetic) else {
        section.paragraph("These films have no result.");
        return;
    };
    let caption = format!("Location errors on {films} (figure 8 of the paper).");
    section.figure(Figure::new(format!("errors-{name}"), caption, svg));
    let columns = vec![
        Column::words("Line of action"),
        Column::numbers("Patients"),
        Column::numbers("Vertebrae"),
        Column::numbers("Location error, pooled mean ± sd (mm)"),
        Column::words("Over patients (mm, 95 %)"),
        Column::words("Ferguson error over patients (°, 95 %)"),
        Column::numbers("Films without a result"),
    ];
    let mut table = Table::new(format!("Errors on {films}"), columns);
    for errors in cohort.compared.of_role(role) {
        let RoleErrors { location_mm, ferguson_deg, .. } = errors;
        let pooled = location_mm.pooled;
        let without = match role {
            FilmRole::LeftOutBend => errors.without_result,
            FilmRole::Fitted | FilmRole::HeldOut => cohort.compared.unusable(errors.kind, role),
        };
        table.row(vec![
            errors.kind.to_string(),
            location_mm.patients.n.to_string(),
            pooled.n.to_string(),
            if pooled.n > 0 { with_sd(pooled.mean, pooled.sd, 2) } else { none() },
            with_interval(location_mm.patients.mean, location_mm.bootstrap, 2),
            with_interval(ferguson_deg.patients.mean, ferguson_deg.bootstrap, 2),
            without.to_string(),
        ]);
    }
    section.table(table);
}

/// The paper's pooled tests, tests over patients, and the lines on the same films.
pub fn tests(cohort: &Cohort) -> Section {
    let mut section = Section::new("tests", "Hypothesis tests");
    if cohort.compared.errors.is_empty() {
        section.paragraph(NO_MODEL);
        return section;
    }
    let columns = vec![
        Column::words("Inflection line minus iliac line"),
        Column::words("The paper's pooled test"),
        Column::words("Over patients"),
    ];
    let mut table = Table::new("The paper's tests on fitted films", columns);
    table.row(tested("location error (mm)", &cohort.location_test, "mm"));
    table.row(tested("Ferguson error (°)", &cohort.ferguson_test, "°"));
    section.table(table);
    compared(&mut section, cohort, usize::MAX);
    section
}

/// Lists the films on which a line lacks a result, with the lines. Films of a patient with the same lines share a row. `most` bounds
/// the number of patients.
fn films_without_result(cohort: &Cohort, most: usize) -> Table {
    let columns = vec![
        Column::words("Case"),
        Column::words("Kind of film"),
        Column::words("Films"),
        Column::words("Lines without a result"),
        Column::words("Reason"),
    ];
    let mut table = Table::new("Films on which a line has no result", columns);
    // Per row: case, kind of films, reason, lines; the films.
    let mut rows: Vec<([String; 4], Vec<String>)> = Vec::new();
    let missing = &cohort.compared.missing;
    let by_patient = || missing.chunk_by(|a, b| a.case_id == b.case_id);
    let patients = by_patient().count();
    if most < patients {
        table.note = format!(
            "The first {most} of {patients} patients with such a film; --cohort writes all."
        );
    }
    let same_film = |a: &MissingResult, b: &MissingResult| {
        (&a.case_id, a.role, a.posture, a.reason) == (&b.case_id, b.role, b.posture, b.reason)
    };
    for film in by_patient().take(most).flat_map(|films| films.chunk_by(same_film)) {
        let lines: Vec<String> = film.iter().map(|one| one.kind.to_string()).collect();
        let one = &film[0];
        let row =
            [one.case_id.clone(), one.role.to_string(), one.reason.to_string(), lines.join(", ")];
        match rows.iter_mut().find(|(known, _)| *known == row) {
            Some((_, films)) => films.push(one.posture.to_string()),
            None => rows.push((row, vec![one.posture.to_string()])),
        }
    }
    for ([case, role, reason, lines], films) in rows {
        table.row(vec![case, role, films.join(", "), lines, reason]);
    }
    table
}

/// Shows the lines on the same films, the test of every pair, and the films that are left out. `most` bounds the number of patients.
pub fn compared(section: &mut Section, cohort: &Cohort, most: usize) {
    pairs(section, cohort);
    section.table(films_without_result(cohort, most));
}

fn pairs(section: &mut Section, cohort: &Cohort) {
    let compared = &cohort.compared;
    if compared.family() == 0 {
        section.paragraph(
            "No two lines can be compared over patients: that takes two patients with bending films.",
        );
    }
    section.table(by_line(cohort));
    if compared.family() == 0 {
        return;
    }
    section.table(family(cohort));
    section.table(baselines(cohort));
    section.table(against_baselines(cohort));
    for words in [compared.believe_words().to_owned(), compared.family_words()] {
        section.notice(Notice::new(NoticeKind::Note, format!("{words}.")));
    }
}

fn by_line(cohort: &Cohort) -> Table {
    let columns = vec![
        Column::words("Line of action"),
        Column::words("Films"),
        Column::numbers("Patients"),
        Column::numbers("Films with a result"),
        Column::numbers("Without"),
        Column::words("Location error (mm, 95 %)"),
        Column::words("Ferguson error (°, 95 %)"),
        Column::words("Numbers from the films"),
    ];
    let mut table = Table::new("Every line on the films with a result", columns);
    let compared = &cohort.compared;
    for errors in compared.errors.iter().filter(|errors| errors.films > 0) {
        let free = compared.numbers.iter().find(|(kind, _)| *kind == errors.kind);
        table.row(vec![
            errors.kind.to_string(),
            errors.role.to_string(),
            errors.location_mm.patients.n.to_string(),
            errors.films.to_string(),
            errors.without_result.to_string(),
            with_interval(errors.location_mm.patients.mean, errors.location_mm.bootstrap, 1),
            with_interval(errors.ferguson_deg.patients.mean, errors.ferguson_deg.bootstrap, 1),
            free.map_or_else(String::new, |(_, free)| numbers(free, errors.role)),
        ]);
    }
    table.note = "Intervals are over patients. Lines may have results on different films: only the tests below compare them, on the films that both predict. Numbers fitted: free multipliers + forces + parameters of a free line. A bend left out is predicted with the stiffness fitted to the other bend.".to_owned();
    table
}

fn family(cohort: &Cohort) -> Table {
    let columns = vec![
        Column::words("First minus second line"),
        Column::words("Films"),
        Column::words("Error"),
        Column::numbers("Films of both"),
        Column::numbers("Patients"),
        Column::words("Difference (95 %)"),
        Column::words("Effect d (95 %)"),
        Column::numbers("Sign-flip p"),
        Column::numbers("Holm p"),
        Column::numbers("Pooled p (the paper's)"),
    ];
    let mut table = Table::new("Every pair of lines, tested", columns);
    for test in cohort.compared.tests.iter().filter(|test| test.holm_p.is_some()) {
        table.row(test_row(test));
    }
    table
}

/// Errors of the predictions without mechanics.
fn baselines(cohort: &Cohort) -> Table {
    let columns = vec![
        Column::words("Joint rotations without mechanics"),
        Column::words("Films"),
        Column::numbers("Patients"),
        Column::numbers("Films predicted"),
        Column::words("Location error (mm, 95 %)"),
    ];
    let mut table = Table::new("Predictions without mechanics", columns);
    for errors in &cohort.baselines.errors {
        table.row(vec![
            errors.baseline.to_string(),
            errors.role.to_string(),
            errors.location_mm.patients.n.to_string(),
            errors.films.to_string(),
            with_interval(errors.location_mm.patients.mean, errors.location_mm.bootstrap, 1),
        ]);
    }
    table.note = "The rotations and the scale of the film are fitted to the top vertebra: to its location, as every line is, and in one row to its tilt too. A model with a smaller error is worth its parameters.".to_owned();
    table
}

fn against_baselines(cohort: &Cohort) -> Table {
    let columns = vec![
        Column::words("Line minus rotations without mechanics"),
        Column::words("Films"),
        Column::numbers("Patients"),
        Column::words("Difference (mm, 95 %)"),
        Column::numbers("Sign-flip p"),
        Column::numbers("Holm p"),
        Column::words("The line is"),
    ];
    let mut table = Table::new("Lines against predictions without mechanics", columns);
    for test in cohort.baselines.tests.iter().filter(|test| test.holm_p.is_some()) {
        let c = &test.comparison;
        let line = line_in_short(test.model);
        table.row(vec![
            format!("{line} – {}", test.baseline),
            test.role.to_string(),
            c.patients().to_string(),
            with_interval(c.mean_difference, c.bootstrap, 1),
            p_value(c.sign_flip.map(|t| t.p_two_sided)),
            p_value(test.holm_p),
            test.outcome().to_string(),
        ]);
    }
    table.note = "Location errors on the films that both predict. Better: a smaller error, significant after Holm's correction over these tests; worse: a larger one, significant likewise or with a whole interval above zero. The estimated line takes two numbers more from each film, so its comparison is not fair.".to_owned();
    table
}

fn test_row(test: &LinePairTest) -> Vec<String> {
    let c = &test.comparison;
    let [first, second] = test.lines.map(line_in_short);
    vec![
        format!("{first} – {second}"),
        test.role.to_string(),
        match test.error {
            ErrorKind::Location => "location (mm)",
            ErrorKind::Ferguson => "Ferguson (°)",
        }
        .to_owned(),
        test.films.to_string(),
        c.patients().to_string(),
        with_interval(c.mean_difference, c.bootstrap, 1),
        c.effect.map_or_else(none, |effect| with_interval(effect.d, Some(effect.interval), 1)),
        p_value(c.sign_flip.map(|t| t.p_two_sided)),
        p_value(test.holm_p),
        p_value(c.pooled.map(|t| t.p_two_sided)),
    ]
}
