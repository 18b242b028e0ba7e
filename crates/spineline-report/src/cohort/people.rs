//! Description of the patients, and of the cases that were excluded.

use std::collections::BTreeMap;

use spineline::analysis::{Analysis, Sex, Subject};
use spineline::anatomy::Posture;
use spineline::clinical::ClinicalCurve;
use spineline::cohort::{Cohort, RefusalStep, RefusedCase};
use spineline::evaluate::statistics::{Summary, quantile};
use spineline::number::{fixed, interval, with_sd};
use spineline::warning::WarningCode;

use super::Patients;
use crate::WarningCounts;
use crate::document::{Column, Figure, Section, Table};
use crate::figures::{self, FlowStep};
use crate::phrases::{no_model_reason, none};

/// The refused cases with their reasons, if there are any, and the findings of a cohort, one sentence each.
pub fn sentences(section: &mut Section, cohort: &Cohort, refused: &[RefusedCase]) {
    self::refused(section, refused, cohort.patients);
    for sentence in cohort.sentences() {
        section.paragraph(sentence);
    }
}

/// The findings of the cohort, and how many patients have which contradiction or warning.
pub fn verdict(patients: &Patients<'_>) -> Section {
    let mut section = Section::new("verdict", "Verdict, contradictions and warnings");
    sentences(&mut section, patients.together, patients.refused);
    let mut counts = WarningCounts::default();
    patients.analyses.iter().for_each(|analysis| counts.add(analysis));
    section.table(counts.table());
    section
}

/// Cases read, refused, analysed, modelled, and with each film.
pub fn flow(patients: &Patients<'_>) -> Section {
    let mut section = Section::new("flow", "Flow of cases and exclusions");
    let (analyses, refused) = (patients.analyses, patients.refused);
    let refusals = RefusalStep::ALL.map(|step| {
        let n = refused.iter().filter(|one| one.step == step).count();
        (step.to_string(), n)
    });
    let modelled: Vec<&Analysis> = analyses.iter().filter(|a| !a.models.is_empty()).collect();
    let without = |code: WarningCode| {
        analyses.iter().filter(|a| a.models.is_empty() && a.warnings.has(code)).count()
    };
    let (no_scale, no_bend) = (without(WarningCode::NoScale), without(WarningCode::NoBendingFilm));
    let other = analyses.len() - modelled.len() - no_scale - no_bend;
    let complete =
        |a: &&&Analysis| Posture::ALL.iter().all(|&posture| a.movement.film(posture).is_some());
    let missing = Posture::MOVED.map(|posture| {
        let n = modelled.iter().filter(|a| a.movement.film(posture).is_none()).count();
        (format!("no {posture} film"), n)
    });
    let some = |lost: Vec<(String, usize)>| lost.into_iter().filter(|(_, n)| *n > 0).collect();
    let step = |name: &str, cases: usize, lost: Vec<(String, usize)>| FlowStep {
        name: name.to_owned(),
        cases,
        lost: some(lost),
    };
    let no_model = [
        ("a film without a spacing", no_scale),
        ("no bending film", no_bend),
        ("no line of action on any bend", other),
    ];
    let no_model = no_model.map(|(why, n)| (why.to_owned(), n)).to_vec();
    let steps = [
        step("case files read", analyses.len() + refused.len(), refusals.to_vec()),
        step("analysed", analyses.len(), no_model),
        step("with a personalised model", modelled.len(), missing.to_vec()),
        step("with all five postures", modelled.iter().filter(complete).count(), Vec::new()),
    ];
    let svg = figures::exclusions(&steps, patients.together.synthetic);
    let caption = "Cases at every step. A missing film removes a case from the last step only: all its other films count.";
    section.figure(Figure::new("flow", caption, svg));
    section.table(doubted_table(patients.together));
    section.table(incomplete_table(analyses));
    section.table(films_table(analyses));
    section
}

/// Adds the refused cases, if any.
pub fn refused(section: &mut Section, refused: &[RefusedCase], analysed: usize) {
    let Some(sentence) = RefusedCase::sentence(refused, analysed) else { return };
    section.paragraph(sentence);
    let columns = vec![Column::words("Case"), Column::words("File"), Column::words("Reason")];
    let mut table = Table::new("Cases that were refused", columns);
    for one in refused {
        table.row(vec![
            one.case_id.clone().unwrap_or_else(none),
            one.file.clone(),
            format!("{}: {}", one.step, one.reason),
        ]);
    }
    section.table(table);
}

/// Doubted films, which stay in and should be checked first.
fn doubted_table(cohort: &Cohort) -> Table {
    let columns = vec![Column::words("Case"), Column::words("Film"), Column::words("Reason")];
    let mut table = Table::new("Films that may be wrong", columns);
    for film in &cohort.doubted_films {
        table.row(vec![film.case_id.clone(), film.film(), film.why.clone()]);
    }
    table
}

/// Cases that do not reach the last step: which films they lack, and why they have no model.
fn incomplete_table(analyses: &[Analysis]) -> Table {
    let columns = vec![
        Column::words("Case"),
        Column::words("Films that are missing"),
        Column::words("Reason for the missing model"),
    ];
    let mut table = Table::new("Cases without a model or without all five postures", columns);
    for analysis in analyses {
        let missing =
            Posture::ALL.iter().filter(|&&posture| analysis.movement.film(posture).is_none());
        let missing: Vec<String> = missing.map(ToString::to_string).collect();
        if missing.is_empty() && !analysis.models.is_empty() {
            continue;
        }
        table.row(vec![
            analysis.case_id.clone(),
            if missing.is_empty() { none() } else { missing.join(", ") },
            if analysis.models.is_empty() { no_model_reason(analysis) } else { none() },
        ]);
    }
    table
}

fn films_table(analyses: &[Analysis]) -> Table {
    let columns = vec![
        Column::words("Posture"),
        Column::numbers("Films"),
        Column::numbers("Simulations"),
        Column::numbers("without a result"),
    ];
    let mut table = Table::new("Films and simulations by posture", columns);
    for posture in Posture::ALL {
        let films = analyses.iter().filter(|a| a.movement.film(posture).is_some()).count();
        let all = || {
            let models = analyses.iter().flat_map(|a| &a.models);
            models.filter_map(|model| model.simulation(posture))
        };
        let lost = all().filter(|simulation| !simulation.is_usable()).count();
        table.row(vec![
            posture.to_string(),
            films.to_string(),
            all().count().to_string(),
            lost.to_string(),
        ]);
    }
    table.note = "One simulation per line of action and film.".to_owned();
    table
}

/// Size of an erect curve in degrees; a tilt range is named as such.
pub fn curve_size(curve: &ClinicalCurve) -> String {
    let name = if curve.has_cobb() { "" } else { " (tilt range)" };
    format!("{}{name}", fixed(curve.erect_size().abs().deg(), 0))
}

/// Table 1 of the paper, with the sizes of the chain.
pub fn table_1(patients: &Patients<'_>) -> Section {
    let mut section = Section::new("patients", "Patients");
    section.table(summary(patients));
    let columns = vec![
        Column::words("Case"),
        Column::words("Sex"),
        Column::numbers("Age (years)"),
        Column::words("Lenke, recorded"),
        Column::words("Lenke, frontal films"),
        Column::numbers("Main Cobb angle (°)"),
        Column::numbers("Flexibility (%)"),
        Column::numbers("Inflections"),
        Column::words("Chain"),
    ];
    let mut table = Table::new("Descriptive data of the patients (table 1 of the paper)", columns);
    for (analysis, subject) in patients.analyses.iter().zip(patients.subjects) {
        let main = analysis.movement.main_curve();
        let flexibility = main.and_then(|curve| curve.flexibility);
        table.row(vec![
            analysis.case_id.clone(),
            subject.sex.map_or_else(none, |sex| sex_words(sex).to_owned()),
            subject.age_years.map_or_else(none, |age| fixed(age, 0)),
            subject.lenke.clone().unwrap_or_else(none),
            analysis.movement.lenke.map_or_else(none, |lenke| lenke.number.to_string()),
            main.map_or_else(none, curve_size),
            flexibility.map_or_else(none, |f| fixed(100.0 * f, 0)),
            analysis.movement.inflections.all.len().to_string(),
            format!("{}-{}", analysis.movement.levels().base(), analysis.movement.levels().top()),
        ]);
    }
    section.table(table);
    section
}

const fn sex_words(sex: Sex) -> &'static str {
    match sex {
        Sex::Female => "female",
        Sex::Male => "male",
        Sex::Other => "other",
    }
}

fn summary(patients: &Patients<'_>) -> Table {
    let columns = vec![
        Column::words("Quantity"),
        Column::numbers("n"),
        Column::numbers("Mean ± sd"),
        Column::numbers("Median"),
        Column::numbers("Range"),
    ];
    let mut table = Table::new("The patients in numbers", columns);
    let counted = |sex: Sex| {
        let is = |subject: &&Subject| subject.sex == Some(sex);
        (sex, patients.subjects.iter().filter(is).count())
    };
    for (sex, n) in [Sex::Female, Sex::Male, Sex::Other].map(counted) {
        if n > 0 {
            let name = format!("Sex: {}", sex_words(sex));
            table.row(vec![name, n.to_string(), none(), none(), none()]);
        }
    }
    let ages = patients.subjects.iter().filter_map(|subject| subject.age_years).collect();
    let main = patients.analyses.iter().filter_map(|one| one.movement.main_curve());
    let cobb = main.filter_map(|curve| Some(curve.cobb_in(Posture::Erect)?.abs().deg())).collect();
    let segments =
        patients.analyses.iter().map(|a| f64::from(a.movement.chain.segments as u32)).collect();
    let lengths = patients
        .analyses
        .iter()
        .filter_map(|a| a.movement.scale().mm(a.movement.chain.segment_mm))
        .collect();
    table.rows.extend(described("Age (years)", ages, 0));
    table.rows.extend(described("Main Cobb angle (°)", cobb, 0));
    table.rows.extend(described("Segments of the chain: n (1)", segments, 0));
    table.rows.extend(described("Length of a segment: l (mm)", lengths, 4));
    table
}

fn described(name: &str, mut values: Vec<f64>, places: usize) -> Option<Vec<String>> {
    values.sort_by(f64::total_cmp);
    let (first, last) = (values.first()?, values.last()?);
    let Summary { n, mean, sd } = Summary::of(&values);
    Some(vec![
        name.to_owned(),
        n.to_string(),
        with_sd(mean, sd, places.max(1)),
        fixed(quantile(&values, 0.5), places),
        interval([*first, *last], places),
    ])
}

/// Number of patients per type.
pub fn lenke(patients: &Patients<'_>) -> Section {
    let mut section = Section::new("lenke", "Lenke types");
    let mut counts: Vec<(String, usize)> = (1..=6)
        .map(|number| {
            let is = |a: &&Analysis| a.movement.lenke.is_some_and(|lenke| lenke.number == number);
            (number.to_string(), patients.analyses.iter().filter(is).count())
        })
        .collect();
    let without = patients.analyses.iter().filter(|a| a.movement.lenke.is_none()).count();
    counts.push(("none".to_owned(), without));
    let Some(svg) = figures::lenke_types(&counts, patients.together.synthetic) else {
        section.paragraph("The cohort has no patients.");
        return section;
    };
    let caption = "Lenke types as far as frontal films determine them; none: a bending film or a pair of inflections is missing, or the curves match no type.";
    section.figure(Figure::new("lenke", caption, svg));
    section.table(recorded(patients));
    section
}

/// The recorded types beside the types from frontal films.
fn recorded(patients: &Patients<'_>) -> Table {
    let mut found: BTreeMap<(String, String), usize> = BTreeMap::new();
    for (analysis, subject) in patients.analyses.iter().zip(patients.subjects) {
        if let Some(recorded) = &subject.lenke {
            let ours = analysis.movement.lenke.map_or_else(none, |lenke| lenke.number.to_string());
            *found.entry((recorded.clone(), ours)).or_default() += 1;
        }
    }
    let columns = vec![
        Column::words("Recorded"),
        Column::words("From frontal films"),
        Column::numbers("Patients"),
    ];
    let mut table = Table::new("Recorded Lenke class and type from frontal films", columns);
    for ((recorded, ours), n) in found {
        table.row(vec![recorded, ours, n.to_string()]);
    }
    table
}
