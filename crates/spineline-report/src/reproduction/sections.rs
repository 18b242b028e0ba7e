//! Every number of the paper beside ours, in sections.

use spineline::action::LineKind;
use spineline::cohort::{Clustered, Cohort, ErrorStatistics, LineStatistics, PairedComparison};
use spineline::multibody::Support;
use spineline::number::interval;

use super::numbers::{
    Cell, PaperNumber, Part, TEST_LEGEND, compared, ours, percent, ratio_legend, support_words,
    test_verdict,
};
use super::{Columns, Scenarios, fair};
use crate::paper::{
    INFLECTION_ROTATION_DEG, NEAR_SHARES_PERCENT, PaperMean, fitted_location_error_mm,
    held_out_location_error_mm,
};

/// Every number: the movement once, the models for both supports.
#[must_use]
pub fn parts(scenarios: &Scenarios<'_>) -> Vec<Part> {
    let names = scenarios.each_ref().map(|one| one.name);
    let free = Columns { names, cohorts: scenarios.each_ref().map(|one| one.free) };
    let frontal = Columns { names, cohorts: scenarios.each_ref().map(|one| one.frontal) };
    let mut parts = vec![chain(&free), movement(&free), table_2(&free)];
    for (columns, support) in [(free, Support::Free), (frontal, Support::Frontal)] {
        parts.push(models(&columns, support));
        parts.push(fair::part(&columns, support));
    }
    parts
}

/// A part for which the support does not matter.
fn of_movement(title: &str, rows: Vec<PaperNumber>, legend: &str, note: &str) -> Part {
    Part { title: title.to_owned(), support: None, rows, note: format!("{legend} {note}") }
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
        "n is limited to a window, which is our reading of the paper's problem (1). The lengths of the phantoms and the noise of the virtual readers were chosen to resemble the paper's patients and residuals.",
    )
}

/// Width of an interval, with its ends as text.
fn interval_cell(ends: [f64; 2], n: usize) -> Cell {
    Cell::value(ends[1] - ends[0], n, interval(ends, 4))
}

/// How far the rotation of the inflections lies below the mean rotation.
fn below_mean(cohort: &Cohort) -> Cell {
    let inflections = &cohort.inflection[0].rotation_deg.pooled;
    let part = 100.0 * (1.0 - inflections.mean / cohort.rotation_deg.pooled.mean);
    Cell::value(part, inflections.n, percent(part))
}

fn movement(columns: &Columns<'_>) -> Part {
    let mut rows = rotation_rows(columns);
    rows.extend(inflection_rows(columns));
    of_movement(
        "Movement of the segments",
        rows,
        &ratio_legend(),
        "The amount of movement of a phantom is random, not fitted to the paper. A rotation is the small difference of two curvatures: landmark noise, and even the residual of a polynomial without noise (try --noise 0), shifts its zero by many segments, also in scenarios that leave the inflections at rest. Where a rotation changes sign, the least of 998 is almost zero. Segments of one spine are not independent: use the interval over patients.",
    )
}

/// Rotations of all segments.
fn rotation_rows(columns: &Columns<'_>) -> Vec<PaperNumber> {
    let interval = |c: &Cohort| {
        let pooled = &c.rotation_deg.pooled;
        interval_cell(pooled.normal_interval(), pooled.n)
    };
    let patients = |c: &Cohort| {
        let ends = c.rotation_deg.bootstrap.unwrap_or([f64::NAN; 2]);
        interval_cell(ends, c.rotation_deg.patients.n)
    };
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
    rows.push(compared("  below the mean rotation by", "%", ("93 %", 93.0), columns, below_mean));
    rows
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
    found: [Cell; 3],
) -> PaperNumber {
    let verdict = test_verdict(paper_rejects, columns.names, &found);
    PaperNumber { paper: Some(paper.to_owned()), verdict, ..ours(name.to_owned(), "p", found) }
}

/// What the paper does not give: the same test with one mean per patient.
fn by_patient(found: [Cell; 3]) -> PaperNumber {
    ours("  one mean per patient".to_owned(), "p", found)
}

/// An error of the models with one line.
struct ErrorRow {
    name: &'static str,
    unit: &'static str,
    paper: Option<PaperMean>,
    kind: LineKind,
    /// Whether the films are fitted.
    is_fitted: bool,
}

impl ErrorRow {
    const fn new(
        name: &'static str,
        unit: &'static str,
        paper: Option<PaperMean>,
        kind: LineKind,
        is_fitted: bool,
    ) -> Self {
        Self { name, unit, paper, kind, is_fitted }
    }

    fn number(&self, columns: &Columns<'_>) -> PaperNumber {
        let cell = |line: &LineStatistics| {
            let errors: &ErrorStatistics =
                if self.is_fitted { &line.fitted } else { &line.held_out };
            let values: &Clustered =
                if self.unit == "deg" { &errors.ferguson_deg } else { &errors.location_mm };
            Cell::of(&values.pooled, 2).without(errors.unusable)
        };
        let of_cohort = |cohort: &Cohort| of_line(cohort, self.kind, cell);
        match self.paper {
            Some(paper) => compared(self.name, self.unit, paper, columns, of_cohort),
            None => ours(self.name.to_owned(), self.unit, columns.map(of_cohort)),
        }
    }
}

const ERRORS: [ErrorRow; 12] = {
    use LineKind::{Estimated, Iliac, Inflection};
    let (model_1, model_2) =
        ("Ferguson error, bends, Model-1 (°)", "Ferguson error, bends, Model-2 (°)");
    let (place_1, place_2) =
        ("location error, bends, Model-1 (mm)", "location error, bends, Model-2 (mm)");
    let (angle, place) =
        ("HELD OUT Ferguson error, Model-1 (°)", "HELD OUT location error, Model-1 (mm)");
    [
        ErrorRow::new(model_1, "deg", Some(PaperMean::new(1.34, 1.51, 2)), Inflection, true),
        ErrorRow::new(model_2, "deg", Some(PaperMean::new(2.07, 2.20, 2)), Iliac, true),
        ErrorRow::new("  estimated line", "deg", None, Estimated, true),
        ErrorRow::new(place_1, "mm", fitted_location_error_mm(Inflection), Inflection, true),
        ErrorRow::new(place_2, "mm", fitted_location_error_mm(Iliac), Iliac, true),
        ErrorRow::new("  estimated line", "mm", None, Estimated, true),
        ErrorRow::new(angle, "deg", Some(PaperMean::new(1.63, 1.98, 2)), Inflection, false),
        ErrorRow::new("  Model-2", "deg", None, Iliac, false),
        ErrorRow::new("  estimated line", "deg", None, Estimated, false),
        ErrorRow::new(place, "mm", held_out_location_error_mm(Inflection), Inflection, false),
        ErrorRow::new("  Model-2", "mm", None, Iliac, false),
        ErrorRow::new("  estimated line", "mm", None, Estimated, false),
    ]
};

/// A number of the models with one line of action.
fn of_line(cohort: &Cohort, kind: LineKind, cell: impl Fn(&LineStatistics) -> Cell) -> Cell {
    cohort.line(kind).map_or_else(Cell::missing, cell)
}

const MODELS_NOTE: &str = "Model-1 has the inflection line, Model-2 the iliac line. `rod` has the paper's line built in, `pull` Petit's, `bend` neither; this decides which model has the smaller error. Held-out films are neutral and traction; no stiffness was fitted to them. `[1 without]`: number of films without a result for any force. – marks a number that the paper does not give.";

fn models(columns: &Columns<'_>, support: Support) -> Part {
    let title = format!("Models with {}", support_words(support));
    let mut rows: Vec<PaperNumber> = ERRORS.iter().map(|row| row.number(columns)).collect();
    rows.extend(test_rows(columns));
    let contradicted = |cohort: &Cohort| {
        of_line(cohort, LineKind::Inflection, |line| Cell::of(&line.contradicted.pooled, 1))
    };
    let name = "counter-rotating joints of 14, Model-1".to_owned();
    rows.push(ours(name, "1", columns.map(contradicted)));
    let note = format!("{} {TEST_LEGEND} {MODELS_NOTE}", ratio_legend());
    Part { title, support: Some(support), rows, note }
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
