//! Every number of the paper beside ours, in sections.

use spineline::action::LineKind;
use spineline::analysis::FilmRole;
use spineline::cohort::{Claims, Cohort, PairedComparison, RoleErrors};
use spineline::evaluate::statistics::Summary;
use spineline::multibody::Support;
use spineline::number::interval;
use spineline::reliability::{
    Design, DesignReliability, QuantityReliability, StatisticKind, shown_coefficient,
};

use super::numbers::{
    Cell, PaperNumber, Part, TEST_LEGEND, beside, compared, ours, percent, ratio_legend,
    support_words, test_verdict,
};
use super::{Columns, Group, Reproduction, fair};
use crate::paper::{
    INFLECTION_ROTATION_DEG, NEAR_SHARES_PERCENT, PaperMean, fitted_location_error_mm,
    held_out_location_error_mm,
};

/// Every number: the movement once, the models for both supports.
#[must_use]
pub fn parts(reproduction: &Reproduction<'_>) -> Vec<Part> {
    let free = reproduction.columns(Support::Free);
    let mut parts = vec![readings(&free), chain(&free), movement(&free), table_2(&free)];
    for support in [Support::Free, Support::Frontal] {
        let columns = reproduction.columns(support);
        parts.push(models(&columns, support));
        parts.push(fair::part(&columns, support));
    }
    parts
}

/// A part for which the support does not matter.
fn of_movement(title: &str, rows: Vec<PaperNumber>, legend: &str, note: &str) -> Part {
    Part {
        title: title.to_owned(),
        support: None,
        rows,
        note: format!("{legend} {note}").trim().to_owned(),
    }
}

/// Pearson's coefficients of the tilts, within either observer and between their means.
fn readings(columns: &Columns<'_>) -> Part {
    let of = |find: &dyn Fn(&QuantityReliability) -> Option<&DesignReliability>| -> Vec<Cell> {
        let pearson = |group: &Group<'_>| {
            let tilts = group.readings.iter().find(|quantity| quantity.key == "tilt_as_paper")?;
            let design = find(tilts)?;
            let value = design.statistic(StatisticKind::Pearson).ok()?.value;
            Some(Cell::value(value, design.subjects, shown_coefficient(value)))
        };
        columns.of.groups.iter().map(|group| pearson(group).unwrap_or_else(Cell::missing)).collect()
    };
    let within = |observer: usize| {
        of(&move |tilts| {
            let is_within =
                |one: &&DesignReliability| matches!(one.design, Design::IntraObserver { .. });
            tilts.designs.iter().filter(is_within).nth(observer)
        })
    };
    let between =
        of(&|tilts| tilts.designs.iter().find(|one| one.design == Design::InterObserverMeans));
    let rows = vec![
        beside("within observer 1", "1", ("0.95 ± 0.03", f64::NAN), columns, within(0)),
        beside("within observer 2", "1", ("0.92 ± 0.02", f64::NAN), columns, within(1)),
        beside("between observers", "1", ("0.90", f64::NAN), columns, between),
    ];
    of_movement(
        "Reliability of the readings, Pearson's r of the tilts",
        rows,
        "",
        &columns.note(
            "The paper does not say of which measurements. A coefficient depends on the spread of the patients more than on the readers: `spineline reliability` has the errors in mm and degrees.",
            "The noise of the virtual readers gives the paper's residuals of curves; with it, the coefficients are far above the paper's.",
        ),
    )
}

fn chain(columns: &Columns<'_>) -> Part {
    let rows = vec![
        compared("segments n", "1", PaperMean::new(998.0, 3.0, 0), columns, |c| {
            Cell::of(&c.segments, 0)
        }),
        compared("segment length l (mm)", "mm", PaperMean::new(0.39, 0.05, 2), columns, |c| {
            Cell::of(&c.segment_mm, 2)
        }),
        compared(
            "curve residual, locations (mm)",
            "mm",
            PaperMean::new(0.19, 0.08, 2),
            columns,
            |c| Cell::of(&c.rmse_mm.pooled, 2),
        ),
        compared(
            "curve residual, tilts (°)",
            "deg",
            PaperMean::new(0.17, 0.07, 2),
            columns,
            |c| Cell::of(&c.rmse_deg.pooled, 2),
        ),
    ];
    of_movement(
        "Curves and chain",
        rows,
        &ratio_legend(),
        &columns.note(
            "n is limited to a window, which is our reading of the paper's problem (1).",
            "The lengths of the phantoms and the noise of the virtual readers were chosen to resemble the paper's patients and residuals.",
        ),
    )
}

/// Width of an interval, with its ends as text; missing without one.
fn interval_cell(ends: Option<[f64; 2]>, n: usize) -> Cell {
    ends.map_or_else(Cell::missing, |ends| Cell::value(ends[1] - ends[0], n, interval(ends, 4)))
}

/// How far the mean of some values lies below another mean, in percent of that.
fn below(less: Summary, more: Summary) -> Cell {
    let part = 100.0 * (1.0 - less.mean / more.mean);
    Cell::value(part, less.n, percent(part))
}

fn movement(columns: &Columns<'_>) -> Part {
    let mut rows = rotation_rows(columns);
    rows.extend(inflection_rows(columns));
    of_movement(
        "Movement of the segments",
        rows,
        &ratio_legend(),
        &columns.note(
            "A rotation is the small difference of two curvatures: landmark noise, and even the residual of a polynomial without noise, shifts its zero by many segments. Where a rotation changes sign, the least of 998 is almost zero. Segments of one spine are not independent: use the interval over patients.",
            "The amount of movement of a phantom is random, not fitted to the paper. The zero is shifted also in scenarios that leave the inflections at rest (try --noise 0).",
        ),
    )
}

fn rotation_rows(columns: &Columns<'_>) -> Vec<PaperNumber> {
    let interval = |c: &Cohort| {
        let pooled = &c.rotation_deg.pooled;
        interval_cell(Some(pooled.normal_interval()), pooled.n)
    };
    let patients = |c: &Cohort| interval_cell(c.rotation_deg.bootstrap, c.rotation_deg.patients.n);
    vec![
        compared("mean rotation r (°)", "deg", PaperMean::new(0.0418, 0.0353, 4), columns, |c| {
            Cell::of(&c.rotation_deg.pooled, 4)
        }),
        compared(
            "  95 % interval, by its width",
            "deg",
            ("0.0415 to 0.0421", 0.0006),
            columns,
            interval,
        ),
        ours("  95 % interval, patients resampled".to_owned(), "deg", columns.map(patients)),
        compared("least rotation (°)", "deg", PaperMean::new(0.0019, 0.0016, 4), columns, |c| {
            Cell::of(&c.least_rotation_deg.pooled, 4)
        }),
        compared("  below the mean rotation by", "%", ("96 %", 96.0), columns, |c| {
            below(c.least_rotation_deg.pooled, c.rotation_deg.pooled)
        }),
    ]
}

/// Rotations of the segments at the inflections, and their distance from the least-rotating ones.
fn inflection_rows(columns: &Columns<'_>) -> Vec<PaperNumber> {
    let share = |distance: usize| {
        move |c: &Cohort| {
            let share = 100.0 * c.inflection[0].shares()[distance];
            let n = c.inflection[0].distance_segments.pooled.n;
            Cell::value(share, n, percent(share))
        }
    };
    let mut rows = Vec::new();
    for (distance, paper) in NEAR_SHARES_PERCENT.into_iter().enumerate() {
        rows.push(compared(
            &format!("inflections {distance} segments off"),
            "%",
            (&*percent(paper), paper),
            columns,
            share(distance),
        ));
    }
    rows.push(compared("inflections farther off", "%", ("0 %", f64::NAN), columns, share(3)));
    rows.push(compared("  distance (mm)", "mm", PaperMean::new(0.36, 0.24, 2), columns, |c| {
        Cell::of(&c.inflection[0].distance_mm.pooled, 2)
    }));
    rows.push(compared(
        "rotation of inflections (°)",
        "deg",
        INFLECTION_ROTATION_DEG,
        columns,
        |c| Cell::of(&c.inflection[0].rotation_deg.pooled, 4),
    ));
    rows.push(compared("  below the mean rotation by", "%", ("93 %", 93.0), columns, |c| {
        below(c.inflection[0].rotation_deg.pooled, c.rotation_deg.pooled)
    }));
    rows.extend(third_points(columns));
    rows
}

/// Films on which the inflection line meets the spine a third time, and the rotation there.
fn third_points(columns: &Columns<'_>) -> [PaperNumber; 2] {
    let claims = |cell: fn(&Claims) -> Cell| -> Vec<Cell> {
        columns.of.groups.iter().map(|group| cell(&group.claims)).collect()
    };
    let films = claims(|claims| {
        let [met, films] = claims.third_points;
        let share = 100.0 * met as f64 / films as f64;
        Cell::value(share, films, format!("{met} of {films}"))
    });
    let rotation = claims(|claims| Cell::of(&claims.third_points_deg, 4));
    let (name, paper) =
        ("films on which the line meets the lumbar spine again", ("11 of 72", 100.0 * 11.0 / 72.0));
    let below = PaperMean::new(0.0020, 0.0015, 4);
    [
        beside(name, "%", paper, columns, films),
        beside("  rotation there (°)", "deg", below, columns, rotation),
    ]
}

fn table_2(columns: &Columns<'_>) -> Part {
    let tests = [
        ("distance, bends", "p = 0.8939", false),
        ("distance, neutral and traction", "p = 0.0111", true),
        ("rotation, bends", "p = 0.1567", false),
        ("rotation, neutral and traction", "p = 0.0001", true),
    ];
    let mut rows = Vec::new();
    for (i, (name, paper, rejects)) in tests.into_iter().enumerate() {
        let found = columns.map(|c| Cell::p(c.table_2[i].pooled, false));
        rows.push(tested(columns, name, paper, rejects, found));
        rows.push(by_patient(columns.map(|c| Cell::p(c.table_2[i].patients, false))));
    }
    of_movement(
        "Inflections compared with MMS_Mean (Table 2; two-sided paired t)",
        rows,
        TEST_LEGEND,
        "The paper's p-values cannot be reproduced without its patients; the side of 0.05 can. Where the paper rejects, its inflections were nearer; `in the other direction` means that MMS_Mean is nearer. Figure 10 shows both.",
    )
}

/// A test of the paper with its verdict.
fn tested(
    columns: &Columns<'_>,
    name: &str,
    paper: &str,
    paper_rejects: bool,
    found: Vec<Cell>,
) -> PaperNumber {
    let verdict = test_verdict(paper_rejects, &columns.of.names(), &found);
    PaperNumber { paper: Some(paper.to_owned()), verdict, ..ours(name.to_owned(), "p", found) }
}

/// What the paper does not give: the same test with one mean per patient.
fn by_patient(found: Vec<Cell>) -> PaperNumber {
    ours("  one mean per patient".to_owned(), "p", found)
}

/// Errors of the models, with each line, on fitted bends and on held-out films.
fn error_rows(columns: &Columns<'_>) -> Vec<PaperNumber> {
    use FilmRole::{Fitted, HeldOut};
    use LineKind::{Estimated, Iliac, Inflection};
    type Row = (&'static str, &'static str, Option<PaperMean>, LineKind, FilmRole);
    let paper = |mean, sd| Some(PaperMean::new(mean, sd, 2));
    let (place, held_out) = (fitted_location_error_mm, held_out_location_error_mm(Inflection));
    let rows: [Row; 12] = [
        ("Ferguson error, bends, Model-1 (°)", "deg", paper(1.34, 1.51), Inflection, Fitted),
        ("Ferguson error, bends, Model-2 (°)", "deg", paper(2.07, 2.20), Iliac, Fitted),
        ("  estimated line", "deg", None, Estimated, Fitted),
        ("location error, bends, Model-1 (mm)", "mm", place(Inflection), Inflection, Fitted),
        ("location error, bends, Model-2 (mm)", "mm", place(Iliac), Iliac, Fitted),
        ("  estimated line", "mm", None, Estimated, Fitted),
        ("HELD OUT Ferguson error, Model-1 (°)", "deg", paper(1.63, 1.98), Inflection, HeldOut),
        ("  Model-2", "deg", None, Iliac, HeldOut),
        ("  estimated line", "deg", None, Estimated, HeldOut),
        ("HELD OUT location error, Model-1 (mm)", "mm", held_out, Inflection, HeldOut),
        ("  Model-2", "mm", None, Iliac, HeldOut),
        ("  estimated line", "mm", None, Estimated, HeldOut),
    ];
    let row = |(name, unit, paper, kind, role): Row| {
        let of_cohort = |cohort: &Cohort| {
            let cell = |errors: &RoleErrors| {
                let values = if unit == "deg" { &errors.ferguson_deg } else { &errors.location_mm };
                Cell::of(&values.pooled, 2).without(cohort.compared.unusable(kind, role))
            };
            cohort.compared.of_line(kind, role).map_or_else(Cell::missing, cell)
        };
        match paper {
            Some(paper) => compared(name, unit, paper, columns, of_cohort),
            None => ours(name.to_owned(), unit, columns.map(of_cohort)),
        }
    };
    rows.map(row).into()
}

const MODELS_NOTE: &str = "Model-1 has the inflection line, Model-2 the iliac line. Held-out films are neutral and traction; no stiffness was fitted to them. `[1 without]`: number of films without a result for any force. – marks a number that the paper does not give.";

fn models(columns: &Columns<'_>, support: Support) -> Part {
    let title = format!("Models with {}", support_words(support));
    let mut rows = error_rows(columns);
    rows.extend(reductions(columns));
    rows.extend(test_rows(columns));
    let contradicted = |cohort: &Cohort| {
        let joints = cohort.contradicted_by_inflection_line.as_ref();
        joints.map_or_else(Cell::missing, |joints| Cell::of(joints, 1))
    };
    let name = "counter-rotating joints of 14, Model-1".to_owned();
    rows.push(ours(name, "1", columns.map(contradicted)));
    let against = columns.of.groups.iter().map(|group| Cell::of(&group.claims.against_force, 1));
    rows.push(beside(
        "vertebrae of 14 that move against the iliac force",
        "1",
        PaperMean::new(4.0, 1.0, 0),
        columns,
        against.collect(),
    ));
    let of_phantoms = "`rod` has the paper's line built in, `pull` has Petit's, `bend` has no line; this decides which model has the smaller error.";
    let note = columns.note(MODELS_NOTE, of_phantoms);
    let note = format!("{} {TEST_LEGEND} {note}", ratio_legend());
    Part { title, support: Some(support), rows, note }
}

/// How far the errors of Model-1 lie below the errors of Model-2 on the bends.
fn reductions(columns: &Columns<'_>) -> Vec<PaperNumber> {
    use FilmRole::{Fitted, HeldOut};
    use LineKind::{Iliac, Inflection};
    type Errors = fn(&RoleErrors) -> Summary;
    let angle: Errors = |errors| errors.ferguson_deg.pooled;
    let place: Errors = |errors| errors.location_mm.pooled;
    let rows: [(&str, &str, f64, FilmRole, Errors); 4] = [
        ("Ferguson error, bends, Model-1 below Model-2 by", "35 %", 35.0, Fitted, angle),
        ("location error, bends, Model-1 below Model-2 by", "64 %", 64.0, Fitted, place),
        ("Ferguson error, held out, below Model-2 on bends by", "21 %", 21.0, HeldOut, angle),
        ("location error, held out, below Model-2 on bends by", "45 %", 45.0, HeldOut, place),
    ];
    let row = |(name, text, percent, role, errors): (&str, &str, f64, FilmRole, Errors)| {
        compared(name, "%", (text, percent), columns, |cohort| {
            let of = |kind, role| cohort.compared.of_line(kind, role).map(errors);
            let both = of(Inflection, role).zip(of(Iliac, Fitted));
            both.map_or_else(Cell::missing, |(first, second)| below(first, second))
        })
    };
    rows.map(row).into()
}

/// The paper's one-sided tests on pooled values, and the same on one mean per patient.
fn test_rows(columns: &Columns<'_>) -> Vec<PaperNumber> {
    let mut rows = Vec::new();
    type Test = fn(&Cohort) -> PairedComparison;
    let tests: [(&str, &str, Test); 2] = [
        ("Ferguson: Model-1 below Model-2", "p = 0.0005", |c| c.ferguson_test),
        ("location: Model-1 below Model-2", "p = 0.0000", |c| c.location_test),
    ];
    for (name, paper, test) in tests {
        let found = columns.map(|c| Cell::p(test(c).pooled, true));
        rows.push(tested(columns, name, paper, true, found));
        let two_sided = columns.map(|c| Cell::p(test(c).pooled, false));
        rows.push(ours("  two-sided".to_owned(), "p", two_sided));
        rows.push(by_patient(columns.map(|c| Cell::p(test(c).patients, true))));
    }
    rows
}
