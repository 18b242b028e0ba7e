use spineline::analysis::{Analysis, Sex, Subject};
use spineline::curve::Inflection;
use spineline::spatial::Angle;
use spineline::warning::Severity;

use crate::Patient;
use crate::define::{Column, Row, Unit, count, keyed, number, refused, text, truth};
use crate::table::Table;

type PatientRow<'a> = Row<'a, &'a Subject>;

/// One row per patient.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows: Vec<PatientRow<'_>> =
        patients.iter().map(|patient| patient.row(patient.subject)).collect();
    keyed(
        "patients",
        "patient",
        [subject(), curve(), inflections(), findings(), balance(), options(), vec![refused()]],
    )
    .fill(&rows)
}

fn subject<'a>() -> Vec<Column<PatientRow<'a>>> {
    vec![
        text("sex", "`female`, `male` or `other`, as stated in the case", |row| {
            row.item.sex.map(|sex| {
                match sex {
                    Sex::Female => "female",
                    Sex::Male => "male",
                    Sex::Other => "other",
                }
                .to_owned()
            })
        }),
        number("age", Unit::Years, "age at the time of the films, as stated in the case", |row| {
            row.item.age_years
        }),
        text("lenke_recorded", "Lenke class recorded by clinicians", |row| row.item.lenke.clone()),
    ]
}

fn doubted_films(analysis: &Analysis) -> Option<String> {
    let mut films: Vec<&str> = Vec::new();
    for warning in analysis.film_doubts() {
        let film = warning.posture.map_or("lateral", |posture| posture.key());
        if !films.contains(&film) {
            films.push(film);
        }
    }
    (!films.is_empty()).then(|| films.join(" "))
}

fn inflection(row: &PatientRow<'_>, end: usize) -> Option<Inflection> {
    row.analysis.movement.inflections.pair.map(|pair| pair[end])
}

fn inflection_mm(row: &PatientRow<'_>, end: usize) -> Option<[f64; 2]> {
    let place = inflection(row, end)?.erect;
    let scale = row.analysis.movement.scale();
    Some([scale.mm(place.y_mm)?, scale.mm(place.z_mm)?])
}

/// End of the 95 % interval of an inflection along the erect curve.
fn interval_mm(row: &PatientRow<'_>, inflection: usize, end: usize) -> Option<f64> {
    let found = row.analysis.movement.inflection_intervals?.each[inflection]?;
    row.analysis.movement.scale().mm(found.along_mm[end])
}

fn between(row: &PatientRow<'_>, end: usize) -> Option<String> {
    inflection(row, end).map(|found| format!("{}/{}", found.between.0, found.between.1))
}

fn curve<'a>() -> Vec<Column<PatientRow<'a>>> {
    vec![
        count("films", "number of frontal films", |row| {
            Some(row.analysis.movement.films.len() as i64)
        }),
        text(
            "doubted",
            "doubted films, in the order of the warnings, with spaces between them; empty without any",
            |row| doubted_films(row.analysis),
        ),
        text("chain_base", "lowest vertebra of the model, which is fixed", |row| {
            Some(row.analysis.movement.levels().base().to_string())
        }),
        text("chain_top", "highest vertebra of the model, which carries the force", |row| {
            Some(row.analysis.movement.levels().top().to_string())
        }),
        text(
            "lengths",
            "plane of the lengths of the erect film: `patient`, `detector`, `unknown`, or `pixels` without a spacing",
            |row| Some(row.analysis.movement.scale().plane.key().to_owned()),
        ),
        count("chain_segments", "number of segments of the erect chain (n)", |row| {
            Some(row.analysis.movement.chain.segments as i64)
        }),
        number("segment", Unit::Millimetres, "length of a segment of the chain (l)", |row| {
            row.analysis.movement.scale().mm(row.analysis.movement.chain.segment_mm)
        }),
    ]
}

fn inflections<'a>() -> Vec<Column<PatientRow<'a>>> {
    vec![
        count("inflections", "number of inflections of the erect curve", |row| {
            Some(row.analysis.movement.inflections.all.len() as i64)
        }),
        text("inflection_caudal_between", "vertebrae around the caudal inflection", |row| {
            between(row, 0)
        }),
        number(
            "inflection_caudal_y",
            Unit::Millimetres,
            "lateral coordinate of this inflection, positive to the patient's left",
            |row| inflection_mm(row, 0).map(|place| place[0]),
        ),
        number("inflection_caudal_z", Unit::Millimetres, "its height", |row| {
            inflection_mm(row, 0).map(|place| place[1])
        }),
        number(
            "inflection_caudal_interval_95_low",
            Unit::Millimetres,
            "caudal end of its 95 % interval along the erect curve from the base, by landmark noise and the unknown form of the curve",
            |row| interval_mm(row, 0, 0),
        ),
        number(
            "inflection_caudal_interval_95_high",
            Unit::Millimetres,
            "cranial end of this interval",
            |row| interval_mm(row, 0, 1),
        ),
        text("inflection_cranial_between", "vertebrae around the cranial inflection", |row| {
            between(row, 1)
        }),
        number(
            "inflection_cranial_y",
            Unit::Millimetres,
            "lateral coordinate of this inflection, positive to the patient's left",
            |row| inflection_mm(row, 1).map(|place| place[0]),
        ),
        number("inflection_cranial_z", Unit::Millimetres, "its height", |row| {
            inflection_mm(row, 1).map(|place| place[1])
        }),
        number(
            "inflection_cranial_interval_95_low",
            Unit::Millimetres,
            "caudal end of its 95 % interval along the erect curve from the base, by landmark noise and the unknown form of the curve",
            |row| interval_mm(row, 1, 0),
        ),
        number(
            "inflection_cranial_interval_95_high",
            Unit::Millimetres,
            "cranial end of this interval",
            |row| interval_mm(row, 1, 1),
        ),
    ]
}

fn findings<'a>() -> Vec<Column<PatientRow<'a>>> {
    vec![
        count("lenke_type", "Lenke's curve type as far as frontal films determine it", |row| {
            row.analysis.movement.lenke.map(|lenke| i64::from(lenke.number))
        }),
        text("sagittal_profile", "`measured` on the lateral film, or of a `population`", |row| {
            let measured = row.analysis.movement.space.is_some();
            Some(if measured { "measured" } else { "population" }.to_owned())
        }),
        truth("converged", "whether every fit and every search for a force converged", |row| {
            Some(row.analysis.is_converged())
        }),
        count("warnings", "number of warnings, notes and contradictions", |row| {
            Some(row.analysis.warnings.all().len() as i64)
        }),
        count(
            "contradictions",
            "number of contradictions: the data contradict the model, or a number is not a result",
            |row| {
                let all = row.analysis.warnings.all().iter();
                Some(all.filter(|w| w.code.severity() == Severity::Contradiction).count() as i64)
            },
        ),
    ]
}

fn options<'a>() -> Vec<Column<PatientRow<'a>>> {
    vec![
        text("order_rule", "`leave_one_out`, `two_inflections`, `paper`, or an order", |row| {
            Some(row.analysis.options.order_rule.key())
        }),
        text(
            "gauge",
            "scale constraint: the condition that fixes the overall level of stiffness and force",
            |row| Some(row.analysis.options.gauge.key().to_owned()),
        ),
        text(
            "support",
            "`free`, or `frontal` where flexion and axial rotation are locked",
            |row| Some(row.analysis.options.support.key().to_owned()),
        ),
        text("fit", "fitted data: `shape`, or `ferguson` angles", |row| {
            Some(row.analysis.options.target.key().to_owned())
        }),
        text("grouping", "multipliers are `regional`, `fixed_regions` or `per_joint`", |row| {
            Some(row.analysis.options.grouping.key().to_owned())
        }),
        number("prior_log_sd", Unit::One, "prior standard deviation of ln multiplier", |row| {
            row.analysis.options.prior.map(|prior| prior.log_sd)
        }),
    ]
}

/// The balance of the spine over the pelvis; empty where the erect film's vertical is not known.
fn balance<'a>() -> Vec<Column<PatientRow<'a>>> {
    vec![
        text(
            "sacral_reference",
            "landmark of the central sacral vertical line: `iliac_crests`, `l5` or `base`",
            |row| Some(row.analysis.movement.balance.as_ref()?.reference.key().to_owned()),
        ),
        text("plumb_level", "vertebra from which the plumb line falls", |row| {
            Some(row.analysis.movement.balance.as_ref()?.plumb_level.to_string())
        }),
        number(
            "coronal_balance",
            Unit::Millimetres,
            "distance of the plumb line from the central sacral vertical line, positive to the patient's left",
            |row| {
                let balance = row.analysis.movement.balance.as_ref()?;
                row.analysis.movement.scale().mm(balance.coronal_balance_mm)
            },
        ),
        number(
            "t1_tilt",
            Unit::Degrees,
            "tilt of the superior endplate of T1 against the horizontal; positive where its normal is tilted to the patient's right",
            |row| row.analysis.movement.balance.as_ref()?.t1_tilt.map(Angle::deg),
        ),
        number("l4_tilt", Unit::Degrees, "the same of L4", |row| {
            row.analysis.movement.balance.as_ref()?.l4_tilt.map(Angle::deg)
        }),
        number(
            "pelvic_obliquity",
            Unit::Degrees,
            "tilt of the iliac line against the horizontal; positive where the patient's left crest is higher",
            |row| row.analysis.movement.balance.as_ref()?.pelvic_obliquity.map(Angle::deg),
        ),
        text(
            "stable_vertebra",
            "vertebra below the apex of the main thoracic curve that is nearest to the central sacral vertical line",
            |row| Some(row.analysis.movement.balance.as_ref()?.stable.to_string()),
        ),
    ]
}
