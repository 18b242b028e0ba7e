//! Every number of the paper, ours, and what to say of the two.

use spineline::action::LineKind;
use spineline::analysis::probability;
use spineline::cohort::{Clustered, Cohort, ErrorStatistics, LineStatistics};
use spineline::evaluate::statistics::{PairedT, Summary};
use spineline::multibody::Support;

use super::{Run, support_name};

/// Rows under one heading.
pub struct Section {
    pub title: String,
    /// `None` where the support does not matter.
    pub support: Option<Support>,
    pub rows: Vec<Row>,
}

/// One number of the paper.
pub struct Row {
    pub quantity: String,
    pub unit: &'static str,
    pub paper: String,
    /// For rod, bend and pull.
    pub ours: [Cell; 3],
    pub verdict: String,
}

/// One number of ours.
#[derive(Clone)]
pub struct Cell {
    pub text: String,
    pub mean: f64,
    pub sd: f64,
    pub n: usize,
}

impl Cell {
    fn of(summary: &Summary, places: usize) -> Self {
        let Summary { n, mean, sd } = *summary;
        let text =
            if n == 0 { "-".to_owned() } else { format!("{mean:.places$} ± {sd:.places$}") };
        Self { text, mean, sd, n }
    }

    fn value(value: f64, n: usize, text: String) -> Self {
        Self { text, mean: value, sd: f64::NAN, n }
    }

    fn p(test: Option<PairedT>, one_sided: bool) -> Self {
        match test {
            Some(t) => {
                let p = if one_sided { t.p_less } else { t.p_two_sided };
                Self::value(p, t.n, format!("p {}", probability(p)))
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
    }
    sections
}

fn section(title: &str, rows: Vec<Row>) -> Section {
    Section { title: title.to_owned(), support: None, rows }
}

fn row(
    quantity: &str,
    unit: &'static str,
    paper: (&str, f64),
    cohorts: [&Cohort; 3],
    cell: impl Fn(&Cohort) -> Cell,
    why: &str,
) -> Row {
    let ours = cohorts.map(cell);
    let verdict = verdict(paper.1, &ours, why);
    Row { quantity: quantity.to_owned(), unit, paper: paper.0.to_owned(), ours, verdict }
}

/// Which truths come out like the paper, which do not, and why.
fn verdict(paper: f64, ours: &[Cell; 3], why: &str) -> String {
    let (mut alike, mut higher, mut lower) = (Vec::new(), Vec::new(), Vec::new());
    for (name, cell) in TRUTHS.iter().zip(ours) {
        let ratio = cell.mean / paper;
        if !ratio.is_finite() {
            continue;
        }
        if ratio > ALIKE {
            higher.push(format!("{} times higher for {name}", short(ratio)));
        } else if ratio < 1.0 / ALIKE {
            let ratio = if ratio > 0.0 {
                format!("{} times lower", short(1.0 / ratio))
            } else {
                "zero".to_owned()
            };
            lower.push(format!("{ratio} for {name}"));
        } else {
            alike.push(*name);
        }
    }
    let differs: Vec<String> = higher.into_iter().chain(lower).collect();
    match (alike.is_empty(), differs.is_empty()) {
        (true, true) => format!("not reproducible without its patients; {why}"),
        (false, true) => format!("same ({})", alike.join(", ")),
        (true, false) => format!("differs, {}, because {why}", differs.join(", ")),
        (false, false) => {
            format!("same for {}; {}, because {why}", alike.join(", "), differs.join(", "))
        }
    }
}

fn short(ratio: f64) -> String {
    if ratio < 10.0 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}

/// The verdict of a probability: on which side of 0.05.
fn test_verdict(paper: &str, paper_rejects: bool, ours: &[Cell; 3], why: &str) -> String {
    let agree = |cell: &Cell| (cell.mean < 0.05) == paper_rejects;
    let names = |wanted: bool| -> Vec<&str> {
        TRUTHS
            .iter()
            .zip(ours)
            .filter(|(_, c)| c.mean.is_finite() && agree(c) == wanted)
            .map(|(n, _)| *n)
            .collect()
    };
    let (same, other) = (names(true), names(false));
    match (same.is_empty(), other.is_empty()) {
        (_, true) if !same.is_empty() => format!("same ({paper}) for {}", same.join(", ")),
        (true, false) => format!("differs for {}, because {why}", other.join(", ")),
        (false, false) => {
            format!("same for {}; differs for {}, because {why}", same.join(", "), other.join(", "))
        }
        _ => format!("not reproducible without its patients; {why}"),
    }
}

fn chain(cohorts: [&Cohort; 3]) -> Section {
    let rows = vec![
        row(
            "segments n",
            "1",
            ("998 ± 3", 998.0),
            cohorts,
            |c| Cell::of(&c.segments, 0),
            "the window 993 to 1003 is our reading of its problem (1)",
        ),
        row(
            "segment length l (mm)",
            "mm",
            ("0.39 ± 0.05", 0.39),
            cohorts,
            |c| Cell::of(&c.segment_mm, 2),
            "the phantoms' lengths were drawn to match",
        ),
        row(
            "curve residual, locations (mm)",
            "mm",
            ("0.19 ± 0.08", 0.19),
            cohorts,
            |c| Cell::of(&c.rmse_mm.pooled, 2),
            "the virtual readers' deviations and the order rule decide it",
        ),
        row(
            "curve residual, tilts (°)",
            "deg",
            ("0.17 ± 0.07", 0.17),
            cohorts,
            |c| Cell::of(&c.rmse_deg.pooled, 2),
            "the virtual readers' deviations and the order rule decide it",
        ),
    ];
    section("Curves and chain", rows)
}

fn movement(cohorts: [&Cohort; 3]) -> Section {
    let noise = "landmark noise moves the least-rotating segment by many segments and lifts the least rotation";
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
    let mut rows = vec![
        row(
            "mean rotation r (°)",
            "deg",
            ("0.0418 ± 0.0353", 0.0418),
            cohorts,
            |c| Cell::of(&c.rotation_deg.pooled, 4),
            "how far a phantom moves is drawn: 42° in sum for the largest rod, published flexibility for bend, 15 to 25° of amplitude for pull",
        ),
        row(
            "  95 % interval, segments as independent",
            "deg",
            ("0.0415 to 0.0421", 0.0006),
            cohorts,
            interval,
            "its width follows the spread of r",
        ),
        row(
            "  95 % interval over patients",
            "deg",
            ("not given", f64::NAN),
            cohorts,
            patients,
            "segments of one spine are not independent: the honest interval is many times wider",
        ),
        row(
            "least rotation (°)",
            "deg",
            ("0.0019 ± 0.0016", 0.0019),
            cohorts,
            |c| Cell::of(&c.least_rotation_deg.pooled, 4),
            noise,
        ),
    ];
    for (distance, paper) in
        [("20 %", 20.0), ("62 %", 62.0), ("18 %", 18.0)].into_iter().enumerate()
    {
        rows.push(row(
            &format!("inflection {distance} segments off"),
            "%",
            paper,
            cohorts,
            share(distance),
            noise,
        ));
    }
    rows.push(row("inflection farther off", "%", ("0 %", f64::NAN), cohorts, share(3), noise));
    rows.push(row(
        "  distance (mm)",
        "mm",
        ("0.36 ± 0.24", 0.36),
        cohorts,
        |c| Cell::of(&c.inflection[0].distance_mm.pooled, 2),
        noise,
    ));
    rows.push(row(
        "rotation of inflections (°)",
        "deg",
        ("0.0028 ± 0.0021", 0.0028),
        cohorts,
        |c| Cell::of(&c.inflection[0].rotation_deg.pooled, 4),
        "an inflection at rest needs a truth that leaves it at rest, and landmarks without noise",
    ));
    rows.push(row(
        "  below the mean rotation by",
        "%",
        ("93 %", 93.0),
        cohorts,
        |c| {
            let part = 100.0
                * (1.0 - c.inflection[0].rotation_deg.pooled.mean / c.rotation_deg.pooled.mean);
            Cell::value(part, c.inflection[0].rotation_deg.pooled.n, format!("{part:.0} %"))
        },
        "see above",
    ));
    section("Movement of the segments", rows)
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
        let verdict = test_verdict(
            paper,
            rejects,
            &ours,
            "the order of the two guesses depends on the truth and on noise",
        );
        rows.push(Row {
            quantity: name.to_owned(),
            unit: "p",
            paper: paper.to_owned(),
            ours,
            verdict,
        });
        let ours = cohorts.map(|c| Cell::p(c.table_2[i].patients, false));
        let verdict =
            test_verdict(paper, rejects, &ours, "18 patients carry less evidence than 72 pairs");
        rows.push(Row {
            quantity: "  one mean per patient".to_owned(),
            unit: "p",
            paper: "not given".to_owned(),
            ours,
            verdict,
        });
    }
    section("Inflections against MMS_Mean (Table 2)", rows)
}

fn models(cohorts: [&Cohort; 3], support: Support) -> Section {
    let title = format!("Models, support {}", support_name(support));
    let truth = "the truth decides which line wins";
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
                    cell.text.push_str(&format!(" ({}!)", errors.unusable));
                }
                cell
            })
        };
        rows.push(row(name, unit, paper, cohorts, cell, truth));
    };
    let none = ("not given", f64::NAN);
    error(
        "Ferguson error, Model-1, bends (°)",
        "deg",
        ("1.34 ± 1.51", 1.34),
        LineKind::Inflection,
        true,
        true,
    );
    error(
        "Ferguson error, Model-2, bends (°)",
        "deg",
        ("2.07 ± 2.20", 2.07),
        LineKind::Iliac,
        true,
        true,
    );
    error(
        "Ferguson error, estimated line, bends (°)",
        "deg",
        none,
        LineKind::Estimated,
        true,
        true,
    );
    error(
        "location error, Model-1, bends (mm)",
        "mm",
        ("0.51 ± 0.41", 0.51),
        LineKind::Inflection,
        true,
        false,
    );
    error(
        "location error, Model-2, bends (mm)",
        "mm",
        ("1.41 ± 1.09", 1.41),
        LineKind::Iliac,
        true,
        false,
    );
    error(
        "location error, estimated line, bends (mm)",
        "mm",
        none,
        LineKind::Estimated,
        true,
        false,
    );
    error(
        "HELD OUT Ferguson error, Model-1 (°)",
        "deg",
        ("1.63 ± 1.98", 1.63),
        LineKind::Inflection,
        false,
        true,
    );
    error("HELD OUT Ferguson error, Model-2 (°)", "deg", none, LineKind::Iliac, false, true);
    error(
        "HELD OUT location error, Model-1 (mm)",
        "mm",
        ("0.78 ± 0.65", 0.78),
        LineKind::Inflection,
        false,
        false,
    );
    error("HELD OUT location error, Model-2 (mm)", "mm", none, LineKind::Iliac, false, false);
    error(
        "HELD OUT location error, estimated line (mm)",
        "mm",
        none,
        LineKind::Estimated,
        false,
        false,
    );
    rows.extend(test_rows(cohorts));
    let against =
        |c: &Cohort| line(c, LineKind::Inflection, &|l| Cell::of(&l.contradicted.pooled, 1));
    rows.push(row(
        "joints per bend against Model-1's force",
        "1",
        none,
        cohorts,
        against,
        "the paper does not count them: no positive stiffness explains them",
    ));
    Section { title, support: Some(support), rows }
}

fn test_rows(cohorts: [&Cohort; 3]) -> Vec<Row> {
    let why = "the truth decides which line wins";
    let mut rows = Vec::new();
    let mut push = |quantity: &str, paper: &str, ours: [Cell; 3], why: &str| {
        let verdict = test_verdict(paper, true, &ours, why);
        let paper = if quantity.starts_with("  ") { "not given" } else { paper }.to_owned();
        rows.push(Row { quantity: quantity.to_owned(), unit: "p", paper, ours, verdict });
    };
    push(
        "Ferguson: Model-1 below Model-2, one-sided",
        "p = 0.0005",
        cohorts.map(|c| Cell::p(c.ferguson_test.pooled, true)),
        why,
    );
    push(
        "  two-sided",
        "p = 0.0005",
        cohorts.map(|c| Cell::p(c.ferguson_test.pooled, false)),
        "either model may be the better one",
    );
    push(
        "  one mean per patient, one-sided",
        "p = 0.0005",
        cohorts.map(|c| Cell::p(c.ferguson_test.patients, true)),
        why,
    );
    push(
        "location: Model-1 below Model-2, one-sided",
        "p = 0.0000",
        cohorts.map(|c| Cell::p(c.location_test.pooled, true)),
        why,
    );
    push(
        "  two-sided",
        "p = 0.0000",
        cohorts.map(|c| Cell::p(c.location_test.pooled, false)),
        "either model may be the better one",
    );
    push(
        "  one mean per patient, one-sided",
        "p = 0.0000",
        cohorts.map(|c| Cell::p(c.location_test.patients, true)),
        why,
    );
    rows
}
