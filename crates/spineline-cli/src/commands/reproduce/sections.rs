//! Every number of the paper beside ours, in sections.

use spineline::action::LineKind;
use spineline::cohort::{Clustered, Cohort, ErrorStatistics, LineStatistics, PairedComparison};
use spineline::multibody::Support;

use super::fair;
use super::row::{Cell, Row, Section, row, test_verdict};
use super::runs::{Run, support_words};

/// All sections: the movement once, the models for both supports.
pub fn sections(runs: &[Run]) -> Vec<Section> {
    let of = |support: Support| -> [&Cohort; 3] {
        let mut found = runs.iter().filter(|run| run.support == support).map(|run| &run.cohort);
        std::array::from_fn(|_| found.next().expect("one run per scenario"))
    };
    let mut sections =
        vec![chain(of(Support::Free)), movement(of(Support::Free)), table_2(of(Support::Free))];
    for support in [Support::Free, Support::Frontal] {
        sections.push(models(of(support), support));
        sections.push(fair::section(of(support), support));
    }
    sections
}

fn chain(cohorts: [&Cohort; 3]) -> Section {
    let rows = vec![
        row("segments n", "1", ("998 ± 3", 998.0), cohorts, |c| Cell::of(&c.segments, 0)),
        row("segment length l (mm)", "mm", ("0.39 ± 0.05", 0.39), cohorts, |c| {
            Cell::of(&c.segment_mm, 2)
        }),
        row("curve residual, locations (mm)", "mm", ("0.19 ± 0.08", 0.19), cohorts, |c| {
            Cell::of(&c.rmse_mm.pooled, 2)
        }),
        row("curve residual, tilts (°)", "deg", ("0.17 ± 0.07", 0.17), cohorts, |c| {
            Cell::of(&c.rmse_deg.pooled, 2)
        }),
    ];
    Section::new(
        "Curves and chain",
        rows,
        "n is limited to a window, which is our reading of the paper's problem (1). The lengths of the phantoms and the noise of the virtual readers were chosen to resemble the paper's patients and residuals.",
    )
}

/// Width of an interval, with its ends as text.
fn interval_cell([low, high]: [f64; 2], n: usize) -> Cell {
    Cell::value(high - low, n, format!("{low:.4} to {high:.4}"))
}

/// How far the rotation of the inflections lies below the mean rotation.
fn below_mean(cohort: &Cohort) -> Cell {
    let inflections = &cohort.inflection[0].rotation_deg.pooled;
    let part = 100.0 * (1.0 - inflections.mean / cohort.rotation_deg.pooled.mean);
    Cell::value(part, inflections.n, format!("{part:.0} %"))
}

fn movement(cohorts: [&Cohort; 3]) -> Section {
    let mut rows = rotation_rows(cohorts);
    rows.extend(inflection_rows(cohorts));
    Section::new(
        "Movement of the segments",
        rows,
        "The amount of movement of a phantom is random, not fitted to the paper. A rotation is the small difference of two curvatures: landmark noise, and even the residual of a polynomial without noise (try --noise 0), shifts its zero by many segments, also in scenarios that leave the inflections at rest. Where a rotation changes sign, the least of 998 is almost zero. Segments of one spine are not independent: use the interval over patients.",
    )
}

/// Rotations of all segments.
fn rotation_rows(cohorts: [&Cohort; 3]) -> Vec<Row> {
    let interval = |c: &Cohort| {
        let pooled = &c.rotation_deg.pooled;
        interval_cell(pooled.normal_interval(), pooled.n)
    };
    let patients = |c: &Cohort| {
        let ends = c.rotation_deg.bootstrap.unwrap_or([f64::NAN; 2]);
        interval_cell(ends, c.rotation_deg.patients.n)
    };
    vec![
        row("mean rotation r (°)", "deg", ("0.0418 ± 0.0353", 0.0418), cohorts, |c| {
            Cell::of(&c.rotation_deg.pooled, 4)
        }),
        row(
            "  95 % interval, by its width",
            "deg",
            ("0.0415 to 0.0421", 0.0006),
            cohorts,
            interval,
        ),
        row("  95 % interval, patients resampled", "deg", NOT_GIVEN, cohorts, patients),
        row("least rotation (°)", "deg", ("0.0019 ± 0.0016", 0.0019), cohorts, |c| {
            Cell::of(&c.least_rotation_deg.pooled, 4)
        }),
    ]
}

/// Rotations of the segments at the inflections, and their distance from the least-rotating ones.
fn inflection_rows(cohorts: [&Cohort; 3]) -> Vec<Row> {
    let share = |distance: usize| {
        move |c: &Cohort| {
            let share = 100.0 * c.inflection[0].shares()[distance];
            let n = c.inflection[0].distance_segments.pooled.n;
            Cell::value(share, n, format!("{share:.0} %"))
        }
    };
    let mut rows = Vec::new();
    for (distance, paper) in
        [("20 %", 20.0), ("62 %", 62.0), ("18 %", 18.0)].into_iter().enumerate()
    {
        rows.push(row(
            &format!("inflections {distance} segments off"),
            "%",
            paper,
            cohorts,
            share(distance),
        ));
    }
    rows.push(row("inflections farther off", "%", ("0 %", f64::NAN), cohorts, share(3)));
    rows.push(row("  distance (mm)", "mm", ("0.36 ± 0.24", 0.36), cohorts, |c| {
        Cell::of(&c.inflection[0].distance_mm.pooled, 2)
    }));
    rows.push(row(
        "rotation of inflections (°)",
        "deg",
        ("0.0028 ± 0.0021", 0.0028),
        cohorts,
        |c| Cell::of(&c.inflection[0].rotation_deg.pooled, 4),
    ));
    rows.push(row("  below the mean rotation by", "%", ("93 %", 93.0), cohorts, below_mean));
    rows
}

fn table_2(cohorts: [&Cohort; 3]) -> Section {
    let tests = [
        ("distance, bends", "p = 0.8939", false),
        ("distance, neutral and traction", "p = 0.0111", true),
        ("rotation, bends", "p = 0.1567", false),
        ("rotation, neutral and traction", "p = 0.0001", true),
    ];
    let mut rows = Vec::new();
    for (i, (name, paper, rejects)) in tests.into_iter().enumerate() {
        let ours = cohorts.map(|c| Cell::p(c.table_2[i].pooled, false));
        let verdict = test_verdict(rejects, &ours);
        rows.push(Row {
            quantity: name.to_owned(),
            unit: "p",
            paper: paper.to_owned(),
            ours,
            verdict,
        });
        rows.push(patient_row(cohorts.map(|c| Cell::p(c.table_2[i].patients, false))));
    }
    Section::new(
        "Inflections compared with MMS_Mean (Table 2; two-sided paired t)",
        rows,
        "The paper's p-values cannot be reproduced without its patients; the side of 0.05 can. Where the paper rejects, its inflections were nearer; `in the other direction` means that MMS_Mean is nearer. Figure 10 shows both.",
    )
}

/// What the paper does not give: the same test with one mean per patient.
fn patient_row(ours: [Cell; 3]) -> Row {
    let (quantity, paper) = ("  one mean per patient".to_owned(), "not given".to_owned());
    Row { quantity, unit: "p", paper, ours, verdict: String::new() }
}

/// Name, unit, the paper's number, line of action, whether the films are fitted, and whether the error is that of angles.
type ErrorRow = (&'static str, &'static str, (&'static str, f64), LineKind, bool, bool);

const NOT_GIVEN: (&str, f64) = ("not given", f64::NAN);
const ERRORS: [ErrorRow; 12] = [
    (
        "Ferguson error, bends, Model-1 (°)",
        "deg",
        ("1.34 ± 1.51", 1.34),
        LineKind::Inflection,
        true,
        true,
    ),
    (
        "Ferguson error, bends, Model-2 (°)",
        "deg",
        ("2.07 ± 2.20", 2.07),
        LineKind::Iliac,
        true,
        true,
    ),
    ("  estimated line", "deg", NOT_GIVEN, LineKind::Estimated, true, true),
    (
        "location error, bends, Model-1 (mm)",
        "mm",
        ("0.51 ± 0.41", 0.51),
        LineKind::Inflection,
        true,
        false,
    ),
    (
        "location error, bends, Model-2 (mm)",
        "mm",
        ("1.41 ± 1.09", 1.41),
        LineKind::Iliac,
        true,
        false,
    ),
    ("  estimated line", "mm", NOT_GIVEN, LineKind::Estimated, true, false),
    (
        "HELD OUT Ferguson error, Model-1 (°)",
        "deg",
        ("1.63 ± 1.98", 1.63),
        LineKind::Inflection,
        false,
        true,
    ),
    ("  Model-2", "deg", NOT_GIVEN, LineKind::Iliac, false, true),
    ("  estimated line", "deg", NOT_GIVEN, LineKind::Estimated, false, true),
    (
        "HELD OUT location error, Model-1 (mm)",
        "mm",
        ("0.78 ± 0.65", 0.78),
        LineKind::Inflection,
        false,
        false,
    ),
    ("  Model-2", "mm", NOT_GIVEN, LineKind::Iliac, false, false),
    ("  estimated line", "mm", NOT_GIVEN, LineKind::Estimated, false, false),
];

/// A number of the models with one line of action.
fn of_line(cohort: &Cohort, kind: LineKind, cell: impl Fn(&LineStatistics) -> Cell) -> Cell {
    let missing = || Cell::value(f64::NAN, 0, "-".to_owned());
    cohort.line(kind).map_or_else(missing, cell)
}

fn error_row(cohorts: [&Cohort; 3], (name, unit, paper, kind, fitted, angle): ErrorRow) -> Row {
    let cell = |line: &LineStatistics| {
        let errors: &ErrorStatistics = if fitted { &line.fitted } else { &line.held_out };
        let values: &Clustered = if angle { &errors.ferguson_deg } else { &errors.location_mm };
        let mut cell = Cell::of(&values.pooled, 2);
        if errors.unusable > 0 {
            cell.text = format!("[{} without] {}", errors.unusable, cell.text);
        }
        cell
    };
    row(name, unit, paper, cohorts, |cohort| of_line(cohort, kind, cell))
}

fn models(cohorts: [&Cohort; 3], support: Support) -> Section {
    let title = format!("Models with {}", support_words(support));
    let mut rows: Vec<Row> = ERRORS.into_iter().map(|of| error_row(cohorts, of)).collect();
    rows.extend(test_rows(cohorts));
    let contradicted = |cohort: &Cohort| {
        of_line(cohort, LineKind::Inflection, |line| Cell::of(&line.contradicted.pooled, 1))
    };
    let name = "counter-rotating joints of 14, Model-1";
    rows.push(row(name, "1", NOT_GIVEN, cohorts, contradicted));
    let note = "Model-1 has the inflection line, Model-2 the iliac line. `rod` has the paper's line built in, `pull` Petit's, `bend` neither; this decides which model has the smaller error. Held-out films are neutral and traction; no stiffness was fitted to them. `[1 without]`: number of films without a result for any force.";
    Section { title, support: Some(support), rows, note }
}

/// The paper's one-sided tests on pooled values, and the same on one mean per patient.
fn test_rows(cohorts: [&Cohort; 3]) -> Vec<Row> {
    let mut rows = Vec::new();
    type Test = fn(&Cohort) -> PairedComparison;
    let tests: [(&str, &str, Test); 2] = [
        ("Ferguson: Model-1 below Model-2", "p = 0.0005", |c| c.ferguson_test),
        ("location: Model-1 below Model-2", "p = 0.0000", |c| c.location_test),
    ];
    for (quantity, paper, test) in tests {
        let ours = cohorts.map(|c| Cell::p(test(c).pooled, true));
        let verdict = test_verdict(true, &ours);
        rows.push(Row {
            quantity: quantity.to_owned(),
            unit: "p",
            paper: paper.to_owned(),
            ours,
            verdict,
        });
        let two_sided = cohorts.map(|c| Cell::p(test(c).pooled, false));
        rows.push(Row { quantity: "  two-sided".to_owned(), ..patient_row(two_sided) });
        rows.push(patient_row(cohorts.map(|c| Cell::p(test(c).patients, true))));
    }
    rows
}
