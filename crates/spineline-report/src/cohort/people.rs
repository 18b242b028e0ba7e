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
    section.table(Table::of("Cases that were refused", refused, |add| {
        add.words("Case", |one| one.case_id.clone().unwrap_or_else(none));
        add.words("File", |one| one.file.clone());
        add.words("Reason", |one| format!("{}: {}", one.step, one.reason));
    }));
}

/// Doubted films, which stay in and should be checked first.
fn doubted_table(cohort: &Cohort) -> Table {
    Table::of("Films that may be wrong", &cohort.doubted_films, |add| {
        add.words("Case", |film| film.case_id.clone());
        add.words("Film", |film| film.film());
        add.words("Reason", |film| film.reason.clone());
    })
}

/// Cases that do not reach the last step: which films they lack, and why they have no model.
fn incomplete_table(analyses: &[Analysis]) -> Table {
    let cases = analyses.iter().map(|analysis| {
        let all = Posture::ALL.into_iter();
        let missing = all.filter(|&posture| analysis.movement.film(posture).is_none());
        (analysis, missing.map(|posture| posture.to_string()).collect::<Vec<_>>().join(", "))
    });
    let cases = cases.filter(|(one, missing)| !missing.is_empty() || one.models.is_empty());
    Table::of("Cases without a model or without all five postures", cases, |add| {
        add.words("Case", |(one, _)| one.case_id.clone());
        add.words("Films that are missing", |(_, missing)| {
            if missing.is_empty() { none() } else { missing.clone() }
        });
        add.words("Reason for the missing model", |(one, _)| {
            if one.models.is_empty() { no_model_reason(one) } else { none() }
        });
    })
}

fn films_table(analyses: &[Analysis]) -> Table {
    let simulations = |posture: Posture| {
        let models = analyses.iter().flat_map(|one| &one.models);
        models.filter_map(move |model| model.simulation(posture))
    };
    let mut table = Table::of("Films and simulations by posture", Posture::ALL, |add| {
        add.words("Posture", |posture| posture.to_string());
        add.numbers("Films", |&posture| {
            analyses.iter().filter(|a| a.movement.film(posture).is_some()).count().to_string()
        });
        add.numbers("Simulations", |&posture| simulations(posture).count().to_string());
        add.numbers("without a result", |&posture| {
            simulations(posture).filter(|one| !one.is_usable()).count().to_string()
        });
    });
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
    let caption = "Descriptive data of the patients (table 1 of the paper)";
    let rows = patients.analyses.iter().zip(patients.subjects);
    section.table(Table::of(caption, rows, |add| {
        add.words("Case", |(one, _)| one.case_id.clone());
        add.words("Sex", |(_, subject)| subject.sex.map_or_else(none, |sex| sex.to_string()));
        add.numbers("Age (years)", |(_, subject)| {
            subject.age_years.map_or_else(none, |age| fixed(age, 0))
        });
        add.words("Lenke, recorded", |(_, subject)| subject.lenke.clone().unwrap_or_else(none));
        add.words("Lenke, frontal films", |(one, _)| lenke_number(one));
        add.numbers("Main Cobb angle (°)", |(one, _)| {
            one.movement.main_curve().map_or_else(none, curve_size)
        });
        add.numbers("Flexibility (%)", |(one, _)| {
            let flexibility = one.movement.main_curve().and_then(|curve| curve.flexibility);
            flexibility.map_or_else(none, |f| fixed(100.0 * f, 0))
        });
        add.numbers("Inflections", |(one, _)| one.movement.inflections.all.len().to_string());
        add.words("Chain", |(one, _)| {
            format!("{}-{}", one.movement.levels().base(), one.movement.levels().top())
        });
    }));
    section
}

/// The type from frontal films.
fn lenke_number(analysis: &Analysis) -> String {
    analysis.movement.lenke.map_or_else(none, |lenke| lenke.number.to_string())
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
    for (sex, n) in Sex::ALL.map(counted) {
        if n > 0 {
            let name = format!("Sex: {sex}");
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
    let caption = "Lenke types as far as frontal films determine them; none: a bending film, a pair of inflections or a vertebra beside the end of a curve is missing, or the curves match no type.";
    section.figure(Figure::new("lenke", caption, svg));
    section.table(recorded(patients));
    section
}

/// The recorded types beside the types from frontal films.
fn recorded(patients: &Patients<'_>) -> Table {
    let mut found: BTreeMap<(String, String), usize> = BTreeMap::new();
    for (analysis, subject) in patients.analyses.iter().zip(patients.subjects) {
        if let Some(recorded) = &subject.lenke {
            *found.entry((recorded.clone(), lenke_number(analysis))).or_default() += 1;
        }
    }
    Table::of("Recorded Lenke class and type from frontal films", found, |add| {
        add.words("Recorded", |((recorded, _), _)| recorded.clone());
        add.words("From frontal films", |((_, ours), _)| ours.clone());
        add.numbers("Patients", |(_, n)| n.to_string());
    })
}
