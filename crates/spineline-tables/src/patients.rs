use spineline::analysis::{Analysis, Sex, Subject};
use spineline::curve::Inflection;
use spineline::spatial::Angle;
use spineline::warning::Severity;

use crate::Patient;
use crate::define::{Columns, Row, keyed, rows};
use crate::table::Table;

type PatientRow<'a> = Row<'a, &'a Subject>;

/// One row per patient.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| [patient.subject]);
    keyed("patients", "patient", &rows, |add| {
        subject(add);
        curve(add);
        inflections(add);
        findings(add);
        balance(add);
        options(add);
        add.refused();
    })
}

fn subject(add: &mut Columns<'_, PatientRow<'_>>) {
    add.text("sex", "`female`, `male` or `other`, as stated in the case", |row| {
        row.sex.map(Sex::key)
    });
    add.number("age_years", "age at the time of the films, as stated in the case", |row| {
        row.age_years
    });
    add.text("lenke_recorded", "Lenke class recorded by clinicians", |row| row.lenke.clone());
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

fn curve(add: &mut Columns<'_, PatientRow<'_>>) {
    add.count("films", "number of frontal films", |row| row.analysis.movement.films.len());
    add.text(
        "doubted",
        "doubted films, in the order of the warnings, with spaces between them; empty without any",
        |row| doubted_films(row.analysis),
    );
    add.text("chain_base", "lowest vertebra of the model, which is fixed", |row| {
        row.analysis.movement.levels().base().to_string()
    });
    add.text("chain_top", "highest vertebra of the model, which carries the force", |row| {
        row.analysis.movement.levels().top().to_string()
    });
    add.text(
        "lengths",
        "plane of the lengths of the erect film: `patient`, `detector`, `unknown`, or `pixels` without a spacing",
        |row| row.analysis.movement.scale().plane.key(),
    );
    add.count("chain_segments", "number of segments of the erect chain (n)", |row| {
        row.analysis.movement.chain.segments
    });
    add.number("segment_mm", "length of a segment of the chain (l)", |row| {
        row.analysis.movement.scale().mm(row.analysis.movement.chain.segment_mm)
    });
}

fn inflections(add: &mut Columns<'_, PatientRow<'_>>) {
    add.count("inflections", "number of inflections of the erect curve", |row| {
        row.analysis.movement.inflections.all.len()
    });
    let of_end = [
        (
            "caudal",
            "vertebrae around the caudal inflection, or the vertebra with the midpoint at which it was put",
        ),
        (
            "cranial",
            "vertebrae around the cranial inflection, or the vertebra with the midpoint at which it was put",
        ),
    ];
    for (end, (name, meaning)) in of_end.into_iter().enumerate() {
        let name = |part: &str| format!("inflection_{name}_{part}");
        add.text(&name("between"), meaning, |row| inflection(row, end).map(|found| found.place()));
        add.number(
            &name("y_mm"),
            "lateral coordinate of this inflection, positive to the patient's left",
            |row| row.analysis.movement.scale().mm(inflection(row, end)?.erect.y_mm),
        );
        add.number(&name("z_mm"), "its height", |row| {
            row.analysis.movement.scale().mm(inflection(row, end)?.erect.z_mm)
        });
        add.interval(
            [&name("interval_95_low_mm"), &name("interval_95_high_mm")],
            [
                "caudal end of its 95 % interval along the erect curve from the base, by landmark noise and the unknown form of the curve",
                "cranial end of this interval",
            ],
            |row| {
                let found = row.analysis.movement.inflection_intervals?.each[end]?;
                Some(found.along_mm.map(|mm| row.analysis.movement.scale().mm(mm)))
            },
        );
    }
}

fn findings(add: &mut Columns<'_, PatientRow<'_>>) {
    add.count("lenke_type", "Lenke's curve type as far as frontal films determine it", |row| {
        row.analysis.movement.lenke.map(|lenke| usize::from(lenke.number))
    });
    add.text("sagittal_profile", "`measured` on the lateral film, or of a `population`", |row| {
        if row.analysis.movement.space.is_some() { "measured" } else { "population" }
    });
    add.truth("converged", "whether every fit and every search for a force converged", |row| {
        row.analysis.is_converged()
    });
    add.count("warnings", "number of warnings, notes and contradictions", |row| {
        row.analysis.all_warnings().count()
    });
    add.count(
        "contradictions",
        "number of contradictions: the data contradict the model, or a number is not a result",
        |row| {
            let all = row.analysis.all_warnings();
            all.filter(|w| w.code.severity() == Severity::Contradiction).count()
        },
    );
}

fn options(add: &mut Columns<'_, PatientRow<'_>>) {
    add.text("order_rule", "`leave_one_out`, `two_inflections`, `paper`, or an order", |row| {
        row.analysis.options.order_rule.key()
    });
    add.text(
        "gauge",
        "scale constraint: the condition that fixes the overall level of stiffness and force",
        |row| row.analysis.options.gauge.key(),
    );
    add.text(
        "support",
        "`free`, or `frontal` where flexion and axial rotation are locked",
        |row| row.analysis.options.support.key(),
    );
    add.text("fit", "fitted data: `shape`, or `ferguson` angles", |row| {
        row.analysis.options.target.key()
    });
    add.text("grouping", "multipliers are `regional`, `fixed_regions` or `per_joint`", |row| {
        row.analysis.options.grouping.key()
    });
    add.number("prior_log_sd", "prior standard deviation of ln multiplier", |row| {
        row.analysis.options.prior.map(|prior| prior.log_sd)
    });
}

/// The balance of the spine over the pelvis; empty where the erect film's vertical is not known.
fn balance(add: &mut Columns<'_, PatientRow<'_>>) {
    add.text(
        "sacral_reference",
        "landmark of the central sacral vertical line: `iliac_crests`, `l5` or `base`",
        |row| Some(row.analysis.movement.balance.as_ref()?.reference.key()),
    );
    add.text("plumb_level", "vertebra from which the plumb line falls", |row| {
        Some(row.analysis.movement.balance.as_ref()?.plumb_level.to_string())
    });
    add.number(
        "coronal_balance_mm",
        "distance of the plumb line from the central sacral vertical line, positive to the patient's left",
        |row| {
                let balance = row.analysis.movement.balance.as_ref()?;
                row.analysis.movement.scale().mm(balance.coronal_balance_mm)
            },
    );
    add.number(
        "t1_tilt_deg",
        "tilt of the superior endplate of T1 against the horizontal; positive where its normal is tilted to the patient's right",
        |row| row.analysis.movement.balance.as_ref()?.t1_tilt.map(Angle::deg),
    );
    add.number("l4_tilt_deg", "the same of L4", |row| {
        row.analysis.movement.balance.as_ref()?.l4_tilt.map(Angle::deg)
    });
    add.number(
        "pelvic_obliquity_deg",
        "tilt of the iliac line against the horizontal; positive where the patient's left crest is higher",
        |row| row.analysis.movement.balance.as_ref()?.pelvic_obliquity.map(Angle::deg),
    );
    add.text(
        "stable_vertebra",
        "vertebra below the apex of the main thoracic curve that is nearest to the central sacral vertical line",
        |row| Some(row.analysis.movement.balance.as_ref()?.stable.to_string()),
    );
}
