//! Every number of the paper, ours, and what to say of the two.

use spineline::action::LineKind;
use spineline::analysis::probability;
use spineline::cohort::{Clustered, Cohort, Comparison, ErrorStatistics, LineStatistics};
use spineline::evaluate::statistics::{PairedT, Summary};
use spineline::multibody::Support;

use super::{Run, fair, support_words};

/// Rows under one heading.
pub struct Section {
    pub title: String,
    /// `None` where the support does not matter.
    pub support: Option<Support>,
    pub rows: Vec<Row>,
    /// Why ours may differ.
    pub note: &'static str,
}

/// One number of the paper.
pub struct Row {
    pub quantity: String,
    pub unit: &'static str,
    pub paper: String,
    /// For rod, bend and pull.
    pub ours: [Cell; 3],
    /// Empty where the paper gives no such number.
    pub verdict: String,
}

/// One number of ours.
#[derive(Clone)]
pub struct Cell {
    pub text: String,
    pub mean: f64,
    pub sd: f64,
    pub n: usize,
    /// Of a test: first minus second mean.
    difference: f64,
}

impl Cell {
    pub fn of(summary: &Summary, places: usize) -> Self {
        let Summary { n, mean, sd } = *summary;
        let text =
            if n == 0 { "-".to_owned() } else { format!("{mean:.places$} ± {sd:.places$}") };
        Self { text, mean, sd, n, difference: f64::NAN }
    }

    pub fn value(value: f64, n: usize, text: String) -> Self {
        Self { text, mean: value, sd: f64::NAN, n, difference: f64::NAN }
    }

    fn p(test: Option<PairedT>, one_sided: bool) -> Self {
        match test {
            Some(t) => {
                let p = if one_sided { t.p_less } else { t.p_two_sided };
                let text = format!("p {}", probability(p));
                Self { difference: t.mean_difference, ..Self::value(p, t.n, text) }
            }
            None => Self::value(f64::NAN, 0, "-".to_owned()),
        }
    }
}

/// The truths in the order of the columns.
const TRUTHS: [&str; 3] = ["rod", "bend", "pull"];
/// Numbers within this factor of the paper's count as the same, on other patients.
const ALIKE: f64 = 1.5;

/// All sections: the movement once, the models for both supports.
pub fn sections(runs: &[Run]) -> Vec<Section> {
    let of = |support: Support| -> [&Cohort; 3] {
        let mut found = runs.iter().filter(|run| run.support == support).map(|run| &run.cohort);
        std::array::from_fn(|_| found.next().expect("one run per truth"))
    };
    let mut sections =
        vec![chain(of(Support::Free)), movement(of(Support::Free)), table_2(of(Support::Free))];
    for support in [Support::Free, Support::Frontal] {
        sections.push(models(of(support), support));
        sections.push(fair::section(of(support), support));
    }
    sections
}

fn section(title: &str, rows: Vec<Row>, note: &'static str) -> Section {
    Section { title: title.to_owned(), support: None, rows, note }
}

fn row(
    quantity: &str,
    unit: &'static str,
    paper: (&str, f64),
    cohorts: [&Cohort; 3],
    cell: impl Fn(&Cohort) -> Cell,
) -> Row {
    let ours = cohorts.map(cell);
    let verdict = verdict(paper.1, &ours);
    Row { quantity: quantity.to_owned(), unit, paper: paper.0.to_owned(), ours, verdict }
}

/// Which truths come out like the paper, and by how much the others differ.
fn verdict(paper: f64, ours: &[Cell; 3]) -> String {
    if !paper.is_finite() {
        return String::new();
    }
    let (mut alike, mut differs) = (Vec::new(), Vec::new());
    for (name, cell) in TRUTHS.iter().zip(ours) {
        let ratio = cell.mean / paper;
        match ratio {
            r if !r.is_finite() => differs.push(format!("no result for {name}")),
            r if r > ALIKE => differs.push(format!("{} times the paper's for {name}", short(r))),
            r if r >= 1.0 / ALIKE => alike.push(*name),
            r if r > 0.0 => differs.push(format!("1/{} of it for {name}", short(1.0 / r))),
            _ => differs.push(format!("none for {name}")),
        }
    }
    sentence(&alike, &differs)
}

fn sentence(alike: &[&str], differs: &[String]) -> String {
    match (alike.is_empty(), differs.is_empty()) {
        (false, true) => "same for all truths".to_owned(),
        (true, _) => format!("differs: {}", differs.join(", ")),
        (false, false) => format!("same for {}; {}", alike.join(" and "), differs.join(", ")),
    }
}

fn short(ratio: f64) -> String {
    if ratio < 10.0 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}

/// The verdict of a probability: whether it falls on the paper's side of 0.05.
fn test_verdict(paper_rejects: bool, ours: &[Cell; 3]) -> String {
    let (mut alike, mut differs) = (Vec::new(), Vec::new());
    for (name, cell) in TRUTHS.iter().zip(ours) {
        // The paper rejected where its first mean was the smaller one.
        if paper_rejects && cell.mean < 0.05 && cell.difference > 0.0 {
            differs.push(format!("rejected the other way round for {name}"));
        } else if (cell.mean < 0.05) == paper_rejects && cell.mean.is_finite() {
            alike.push(*name);
        } else {
            differs.push(format!(
                "{} for {name}",
                if paper_rejects { "not rejected" } else { "rejected" }
            ));
        }
    }
    sentence(&alike, &differs)
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
    section(
        "Curves and chain",
        rows,
        "n is held in a window, which is our reading of the paper's problem (1). The phantoms' lengths and the virtual readers' deviations were chosen to be like the paper's patients and residuals.",
    )
}

fn movement(cohorts: [&Cohort; 3]) -> Section {
    let interval = |c: &Cohort| {
        let [low, high] = c.rotation_deg.pooled.normal_interval();
        Cell::value(high - low, c.rotation_deg.pooled.n, format!("{low:.4} to {high:.4}"))
    };
    let patients = |c: &Cohort| {
        let [low, high] = c.rotation_deg.bootstrap.unwrap_or([f64::NAN; 2]);
        Cell::value(high - low, c.rotation_deg.patients.n, format!("{low:.4} to {high:.4}"))
    };
    let share = |distance: usize| {
        move |c: &Cohort| {
            let shares = c.inflection[0].shares();
            let n = c.inflection[0].distance_segments.pooled.n;
            Cell::value(100.0 * shares[distance], n, format!("{:.0} %", 100.0 * shares[distance]))
        }
    };
    let below = |c: &Cohort| {
        let inflections = &c.inflection[0].rotation_deg.pooled;
        let part = 100.0 * (1.0 - inflections.mean / c.rotation_deg.pooled.mean);
        Cell::value(part, inflections.n, format!("{part:.0} %"))
    };
    let none = ("not given", f64::NAN);
    let mut rows = vec![
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
        row("  95 % interval, patients resampled", "deg", none, cohorts, patients),
        row("least rotation (°)", "deg", ("0.0019 ± 0.0016", 0.0019), cohorts, |c| {
            Cell::of(&c.least_rotation_deg.pooled, 4)
        }),
    ];
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
    rows.push(row("  below the mean rotation by", "%", ("93 %", 93.0), cohorts, below));
    section(
        "Movement of the segments",
        rows,
        "How far a phantom moves is drawn, not fitted to the paper. A rotation is the small difference of two curvatures: landmark noise, and even what a polynomial leaves without any noise (try --noise 0), shifts its zero by many segments, also where the truth leaves the inflections at rest. Where a rotation changes its sign, the least of 998 is almost zero. Segments of one spine are not independent, and the interval over patients is the honest one.",
    )
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
    section(
        "Inflections against MMS_Mean (Table 2; two-sided paired t)",
        rows,
        "A p-value of the paper's cannot come back without its patients; what can is the side of 0.05. Where the paper rejects, its inflections were the nearer ones; `the other way round` means that MMS_Mean is. Figure 10 shows both.",
    )
}

/// What the paper does not give: the same test with one mean per patient.
fn patient_row(ours: [Cell; 3]) -> Row {
    let (quantity, paper) = ("  one mean per patient".to_owned(), "not given".to_owned());
    Row { quantity, unit: "p", paper, ours, verdict: String::new() }
}

fn models(cohorts: [&Cohort; 3], support: Support) -> Section {
    let title = format!("Models with {}", support_words(support));
    let line = |c: &Cohort, kind, of: &dyn Fn(&LineStatistics) -> Cell| {
        c.line(kind).map_or_else(|| Cell::value(f64::NAN, 0, "-".to_owned()), of)
    };
    let mut rows = Vec::new();
    let mut error = |name: &str, unit, paper: (&str, f64), kind, fitted: bool, angle: bool| {
        let cell = |c: &Cohort| {
            line(c, kind, &|l: &LineStatistics| {
                let errors: &ErrorStatistics = if fitted { &l.fitted } else { &l.held_out };
                let values: &Clustered =
                    if angle { &errors.ferguson_deg } else { &errors.location_mm };
                let mut cell = Cell::of(&values.pooled, 2);
                if errors.unusable > 0 {
                    cell.text = format!("[{} without] {}", errors.unusable, cell.text);
                }
                cell
            })
        };
        rows.push(row(name, unit, paper, cohorts, cell));
    };
    let none = ("not given", f64::NAN);
    use LineKind::{Estimated, Iliac, Inflection};
    error(
        "Ferguson error, bends, Model-1 (°)",
        "deg",
        ("1.34 ± 1.51", 1.34),
        Inflection,
        true,
        true,
    );
    error("Ferguson error, bends, Model-2 (°)", "deg", ("2.07 ± 2.20", 2.07), Iliac, true, true);
    error("  estimated line", "deg", none, Estimated, true, true);
    error(
        "location error, bends, Model-1 (mm)",
        "mm",
        ("0.51 ± 0.41", 0.51),
        Inflection,
        true,
        false,
    );
    error("location error, bends, Model-2 (mm)", "mm", ("1.41 ± 1.09", 1.41), Iliac, true, false);
    error("  estimated line", "mm", none, Estimated, true, false);
    error(
        "HELD OUT Ferguson error, Model-1 (°)",
        "deg",
        ("1.63 ± 1.98", 1.63),
        Inflection,
        false,
        true,
    );
    error("  Model-2", "deg", none, Iliac, false, true);
    error("  estimated line", "deg", none, Estimated, false, true);
    error(
        "HELD OUT location error, Model-1 (mm)",
        "mm",
        ("0.78 ± 0.65", 0.78),
        Inflection,
        false,
        false,
    );
    error("  Model-2", "mm", none, Iliac, false, false);
    error("  estimated line", "mm", none, Estimated, false, false);
    rows.extend(test_rows(cohorts));
    let against = |c: &Cohort| line(c, Inflection, &|l| Cell::of(&l.contradicted.pooled, 1));
    rows.push(row("joints of 14 against Model-1's force", "1", none, cohorts, against));
    let note = "Model-1 has the inflection line, Model-2 the iliac line. `rod` has the paper's line built in, `pull` Petit's, `bend` neither, and that decides which model wins. Held-out films are neutral and traction; no stiffness was fitted to them. `[1 without]`: films for which no force gave a result.";
    Section { title, support: Some(support), rows, note }
}

/// The paper's one-sided tests on pooled values, and the same on one mean per patient.
fn test_rows(cohorts: [&Cohort; 3]) -> Vec<Row> {
    let mut rows = Vec::new();
    type Test = fn(&Cohort) -> Comparison;
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
