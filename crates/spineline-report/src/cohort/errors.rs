//! Errors of the models over a cohort, fitted and held out apart, and every test between the lines.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, probability};
use spineline::cohort::{Cohort, ErrorKind, ErrorStatistics, LinePairTest, LineStatistics};

use super::movement::tested;
use super::people::curve_size;
use super::with_interval;
use crate::document::{Column, Figure, Notice, NoticeKind, Section, Table};
use crate::figures::{self, LocationErrorSample};
use crate::phrases::{FITTED, HELD_OUT, none, numbers, sentence_case};

const NO_MODEL: &str = "No patient has a personalised model.";

/// Figure 8 of the paper and its numbers, once per kind of film.
pub fn fitted_and_held_out(cohort: &Cohort) -> Section {
    let mut section = Section::new("errors", "Errors of the models");
    if cohort.lines.is_empty() {
        section.paragraph(NO_MODEL);
        return section;
    }
    section.heading("Fitted films");
    section.paragraph(FITTED);
    kind_of_film(&mut section, cohort, "fitted", "bending films, fitted", |line| &line.fitted);
    section.heading("Held-out films");
    section.paragraph(HELD_OUT);
    let films = "neutral and traction films, held out";
    kind_of_film(&mut section, cohort, "held-out", films, |line| &line.held_out);
    section
}

fn kind_of_film(
    section: &mut Section,
    cohort: &Cohort,
    name: &str,
    films: &str,
    of: fn(&LineStatistics) -> &ErrorStatistics,
) {
    let group = if cohort.synthetic { "all patients (synthetic)" } else { "all patients" };
    let samples: Vec<LocationErrorSample> = cohort
        .lines
        .iter()
        .map(|line| LocationErrorSample {
            group: group.to_owned(),
            line: line.kind,
            errors_mm: of(line).location_mm.values(),
        })
        .collect();
    let svg = figures::location_errors(&samples, films, cohort.synthetic);
    let caption = format!(
        "Location errors on {films} (figure 8 of the paper). Boxes: quartiles and median; whiskers: last values within 1.5 IQR of the box; circles: values beyond; diamonds: means."
    );
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
    for line in &cohort.lines {
        let ErrorStatistics { ferguson_deg, location_mm, unusable } = of(line);
        let pooled = location_mm.pooled;
        table.row(vec![
            line.kind.to_string(),
            location_mm.patients.n.to_string(),
            pooled.n.to_string(),
            if pooled.n > 0 { format!("{:.2} ± {:.2}", pooled.mean, pooled.sd) } else { none() },
            with_interval(location_mm.patients.mean, location_mm.bootstrap, 2),
            with_interval(ferguson_deg.patients.mean, ferguson_deg.bootstrap, 2),
            unusable.to_string(),
        ]);
    }
    section.table(table);
}

/// The paper's pooled tests, those over patients, and the lines on the same films.
pub fn tests(cohort: &Cohort) -> Section {
    let mut section = Section::new("tests", "Hypothesis tests");
    if cohort.lines.is_empty() {
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
    compared(&mut section, cohort);
    section
}

/// The lines on the same films, and the test of every pair of them.
pub fn compared(section: &mut Section, cohort: &Cohort) {
    let compared = &cohort.compared;
    if compared.family() == 0 {
        section.paragraph(
            "No two lines can be compared over patients: that takes two patients with bending films.",
        );
        return;
    }
    section.table(same_films(cohort));
    section.table(family(cohort));
    for words in [compared.believe_words().to_owned(), compared.family_words()] {
        section.notice(Notice::new(NoticeKind::Note, format!("{words}.")));
    }
}

fn same_films(cohort: &Cohort) -> Table {
    let columns = vec![
        Column::words("Line of action"),
        Column::words("Films"),
        Column::numbers("Patients"),
        Column::numbers("Films compared"),
        Column::numbers("Left out"),
        Column::words("Location error (mm, 95 %)"),
        Column::words("Ferguson error (°, 95 %)"),
        Column::words("Numbers from the films"),
    ];
    let mut table = Table::new("All lines on the same films", columns);
    let compared = &cohort.compared;
    for errors in compared.errors.iter().filter(|errors| errors.films > 0) {
        let free = compared.numbers.iter().find(|(kind, _)| *kind == errors.kind);
        table.row(vec![
            errors.kind.to_string(),
            errors.role.to_string(),
            errors.location_mm.patients.n.to_string(),
            errors.films.to_string(),
            errors.left_out.to_string(),
            with_interval(errors.location_mm.patients.mean, errors.location_mm.bootstrap, 1),
            with_interval(errors.ferguson_deg.patients.mean, errors.ferguson_deg.bootstrap, 1),
            free.map_or_else(String::new, |(_, free)| numbers(free, errors.role)),
        ]);
    }
    table.note = "Intervals are over patients. Left out: films on which at least one line has no result. Numbers fitted: free multipliers + forces + parameters of a free line. A bend left out is predicted with the stiffness fitted to the other bend.".to_owned();
    table
}

fn family(cohort: &Cohort) -> Table {
    let columns = vec![
        Column::words("First minus second line"),
        Column::words("Films"),
        Column::words("Error"),
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

fn test_row(test: &LinePairTest) -> Vec<String> {
    let c = &test.comparison;
    let p = |p: Option<f64>| {
        p.map_or_else(none, |p| probability(p).trim_start_matches("= ").to_owned())
    };
    let [first, second] = test.lines.map(|kind| kind.to_string().replace(" line", ""));
    vec![
        format!("{first} – {second}"),
        test.role.to_string(),
        match test.error {
            ErrorKind::Location => "location (mm)",
            ErrorKind::Ferguson => "Ferguson (°)",
        }
        .to_owned(),
        c.patients().to_string(),
        with_interval(c.mean_difference, c.bootstrap, 1),
        c.effect.map_or_else(none, |effect| with_interval(effect.d, Some(effect.interval), 1)),
        p(c.sign_flip.map(|t| t.p_two_sided)),
        p(test.holm_p),
        p(c.pooled.map(|t| t.p_two_sided)),
    ]
}

/// How many columns a table may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// As many as a terminal has room for.
    Summary,
    /// One per number.
    Full,
}

/// One row per patient.
pub fn by_patient(analyses: &[Analysis], detail: Detail) -> Section {
    let mut section = Section::new("by-patient", "Patient by patient");
    let kinds = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated];
    let mut columns = vec![
        Column::words("Case"),
        Column::numbers("Main Cobb angle (°)"),
        Column::numbers("Inflections"),
    ];
    for kind in kinds {
        let name = sentence_case(&kind.to_string());
        match detail {
            Detail::Summary => columns.push(Column::words(format!("{name} (mm)"))),
            Detail::Full => {
                columns.push(Column::numbers(format!("{name}: fitted (mm)")));
                columns.push(Column::numbers(format!("{name}: held out (mm)")));
            }
        }
    }
    columns.push(Column::numbers("Counter-rotating joints"));
    columns.push(Column::numbers("Contradictions, warnings, notes"));
    let mut table = Table::new("Mean location errors of every patient", columns);
    for analysis in analyses {
        table.row(patient_row(analysis, kinds, detail));
    }
    let columns = match detail {
        Detail::Summary => "Location errors: fitted bends / held-out films. ",
        Detail::Full => "",
    };
    table.note = format!(
        "{columns}Counter-rotating joints: joints of each fitted bend that turn against the force along the {}.",
        kinds[0]
    );
    section.table(table);
    section
}

fn patient_row(analysis: &Analysis, kinds: [LineKind; 3], detail: Detail) -> Vec<String> {
    let main = analysis.main_curve();
    let mut row = vec![
        analysis.case_id.clone(),
        main.map_or_else(none, curve_size),
        analysis.inflections.all.len().to_string(),
    ];
    for kind in kinds {
        let model = analysis.models.iter().find(|model| model.kind == kind);
        let errors = [true, false].map(|fitted| {
            let error = model.and_then(|model| model.mean_location_error_mm(fitted));
            error.map_or_else(none, |error| format!("{error:.1}"))
        });
        match detail {
            Detail::Summary => row.push(errors.join(" / ")),
            Detail::Full => row.extend(errors),
        }
    }
    let inflection = analysis.models.iter().find(|model| model.kind == kinds[0]);
    let against = inflection.map(|model| {
        let fitted = model.postures.iter().filter(|s| s.fitted);
        fitted.map(|s| s.contradicted.len().to_string()).collect::<Vec<_>>().join(", ")
    });
    row.push(against.unwrap_or_else(none));
    let count = |kind: NoticeKind| {
        let all = analysis.warnings.all().iter();
        all.filter(|warning| NoticeKind::from(warning.severity()) == kind).count().to_string()
    };
    let kinds = [NoticeKind::Contradiction, NoticeKind::Warning, NoticeKind::Note];
    row.push(kinds.map(count).join(", "));
    row
}
