//! Errors of the models over a cohort, by kind of film, and every test between the lines.

use spineline::analysis::FilmRole;
use spineline::cohort::{Cohort, ErrorKind, MissingResult, enough_words};
use spineline::number::{p_value, with_sd};

use super::movement::table_of_tests;
use crate::document::{Column, Figure, Notice, NoticeKind, Section, Table};
use crate::figures::{self, LocationErrorSample};
use crate::phrases::{
    FITTED, HELD_OUT, LEFT_OUT, difference_words, holm_p, line_in_short, mean_words, none, numbers,
    with_interval,
};

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
    let errors = cohort.compared.of_role(role);
    section.table(Table::of(format!("Errors on {films}"), errors, |add| {
        add.words("Line of action", |errors| errors.kind.to_string());
        add.numbers("Patients", |errors| errors.location_mm.patients.n.to_string());
        add.numbers("Vertebrae", |errors| errors.location_mm.pooled.n.to_string());
        add.numbers("Location error, pooled mean ± sd (mm)", |errors| {
            let pooled = errors.location_mm.pooled;
            if pooled.n > 0 { with_sd(pooled.mean, pooled.sd, 2) } else { none() }
        });
        add.words("Over patients (mm, 95 %)", |errors| mean_words(&errors.location_mm, 2));
        add.words("Ferguson error over patients (°, 95 %)", |errors| {
            mean_words(&errors.ferguson_deg, 2)
        });
        add.numbers("Films without a result", |errors| {
            let without = match role {
                FilmRole::LeftOutBend => errors.without_result,
                FilmRole::Fitted | FilmRole::HeldOut => cohort.compared.unusable(errors.kind, role),
            };
            without.to_string()
        });
    }));
}

/// The paper's pooled tests, tests over patients, and the lines on the same films.
pub fn tests(cohort: &Cohort) -> Section {
    let mut section = Section::new("tests", "Hypothesis tests");
    if cohort.compared.errors.is_empty() {
        section.paragraph(NO_MODEL);
        return section;
    }
    let tests = [
        ("location error", &cohort.location_test, "mm"),
        ("Ferguson error", &cohort.ferguson_test, "°"),
    ];
    let caption = "The paper's tests on fitted films";
    section.table(table_of_tests(caption, "Inflection line minus iliac line", tests));
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
    let compared = &cohort.compared;
    let with_films = compared.errors.iter().filter(|errors| errors.films > 0);
    let mut table = Table::of("Every line on the films with a result", with_films, |add| {
        add.words("Line of action", |errors| errors.kind.to_string());
        add.words("Films", |errors| errors.role.to_string());
        add.numbers("Patients", |errors| errors.location_mm.patients.n.to_string());
        add.numbers("Films with a result", |errors| errors.films.to_string());
        add.numbers("Without", |errors| errors.without_result.to_string());
        add.words("Location error (mm, 95 %)", |errors| mean_words(&errors.location_mm, 1));
        add.words("Ferguson error (°, 95 %)", |errors| mean_words(&errors.ferguson_deg, 1));
        add.words("Numbers from the films", |errors| {
            let free = compared.numbers.iter().find(|(kind, _)| *kind == errors.kind);
            free.map_or_else(String::new, |(_, free)| numbers(free, errors.role))
        });
    });
    table.note = "Intervals are over patients. Lines may have results on different films: only the tests below compare them, on the films that both predict. Numbers fitted: free multipliers + forces + parameters of a free line. A bend left out is predicted with the stiffness fitted to the other bend.".to_owned();
    table
}

fn family(cohort: &Cohort) -> Table {
    let tests = cohort.compared.tests.iter().filter(|test| test.comparison.is_compared());
    Table::of("Every pair of lines, compared", tests, |add| {
        add.words("First minus second line", |test| test.lines.map(line_in_short).join(" – "));
        add.words("Films", |test| test.role.to_string());
        add.words("Error", |test| match test.error {
            ErrorKind::Location => "location (mm)",
            ErrorKind::Ferguson => "Ferguson (°)",
        });
        add.numbers("Films of both", |test| test.films.to_string());
        add.numbers("Patients", |test| test.comparison.patients().to_string());
        add.words("Difference (95 %)", |test| difference_words(&test.comparison));
        add.words("Effect d (95 %)", |test| {
            let effect = test.comparison.effect;
            effect.map_or_else(none, |effect| with_interval(effect.d, Some(effect.interval), 1))
        });
        add.numbers("Sign-flip p", |test| {
            p_value(test.comparison.sign_flip.map(|t| t.p_two_sided))
        });
        add.numbers("Holm p", |test| holm_p(test.holm_p));
        add.numbers("Pooled p (the paper's)", |test| {
            p_value(test.comparison.pooled.map(|t| t.p_two_sided))
        });
    })
}

/// Errors of the predictions without mechanics, and of lines that know as much of a film as some of these.
fn baselines(cohort: &Cohort) -> Table {
    let found = &cohort.baselines;
    let baselines = found.errors.iter().map(|errors| {
        let tilt = errors.by.knows_tilt();
        (errors.by.to_string(), tilt, errors.role, errors.films, &errors.location_mm)
    });
    let lines = found.lines_with_tilt.iter().map(|errors| {
        (errors.by.to_string(), true, errors.role, errors.films, &errors.location_mm)
    });
    let title = "Predictions without mechanics, and lines with the tilt of the top vertebra";
    let mut table = Table::of(title, baselines.chain(lines), |add| {
        add.words("Prediction", |(name, ..)| name.clone());
        add.words("Known of the top", |(_, tilt, ..)| {
            if *tilt { "location, tilt" } else { "location" }.to_owned()
        });
        add.words("Films", |(.., role, _, _)| role.to_string());
        add.numbers("Patients", |(.., errors)| errors.patients.n.to_string());
        add.numbers("Films predicted", |(.., films, _)| films.to_string());
        add.words("Location error (mm, 95 %)", |(.., errors)| mean_words(errors, 1));
    });
    table.note = "Each prediction and the scale of the film are fitted to the top vertebra. Lines that know its location alone stand in other tables; with its tilt they take the published or the given distribution of rotations. A model with a smaller error is worth its parameters.".to_owned();
    table
}

fn against_baselines(cohort: &Cohort) -> Table {
    let tests = cohort.baselines.tests.iter().filter(|test| test.comparison.is_compared());
    let mut table = Table::of("Lines against predictions without mechanics", tests, |add| {
        add.words("Line minus prediction without mechanics", |test| {
            format!("{} – {}", line_in_short(test.model), test.baseline.long_name())
        });
        add.words("Films", |test| test.role.to_string());
        add.numbers("Patients", |test| test.comparison.patients().to_string());
        add.words("Difference (mm, 95 %)", |test| difference_words(&test.comparison));
        add.numbers("Sign-flip p", |test| {
            p_value(test.comparison.sign_flip.map(|t| t.p_two_sided))
        });
        add.numbers("Holm p", |test| holm_p(test.holm_p));
        add.words("The line is", |test| test.outcome().to_string());
    });
    table.note = format!(
        "Location errors on the films that both predict. Better: a smaller error, significant after Holm's correction over these tests; worse: a larger one, significant likewise; not tested: too few patients ({}). With tilt: both know the tilt of the top vertebra. Without it the estimated line takes two numbers more from each film, so its comparison is not fair.",
        enough_words(cohort.baselines.family())
    );
    table
}
