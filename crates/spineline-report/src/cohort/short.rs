//! The first screen of a cohort: which line, how sure, what next.

use spineline::analysis::FilmRole;
use spineline::cohort::{
    BaselineTest, Cohort, ErrorKind, LineOutcomes, LinePairTest, PairedComparison, too_few_words,
};
use spineline::evaluate::statistics::Resampling;
use spineline::warning::counted;

use super::by_patient::{PatientRow, outcomes};
use crate::document::{Section, Table};
use crate::phrases::{difference_words, holm_p};

/// Patients in the table of a terminal.
const MOST_PATIENTS: usize = 20;

/// The answers, the verdict of every patient, and one row per comparison.
pub fn short(patients: &[PatientRow], cohort: &Cohort, most: usize) -> Section {
    let mut section = Section::new("short", "In short");
    section.paragraph(format!("Which line? {}", line(cohort)));
    section.paragraph(format!("How sure? {}", sure(cohort)));
    section.table(outcomes(patients, most));
    section.table(comparisons(cohort));
    section
}

/// The same for a terminal: without a heading, and with the options and commands that follow.
pub fn on_terminal(patients: &[PatientRow], cohort: &Cohort) -> Section {
    let mut section = short(patients, cohort, MOST_PATIENTS);
    section.title = String::new();
    section.paragraph("What next? All tables: --full. All warnings: --warnings. Tables for other programs: --tables DIR. Pictures: spineline report CASES.");
    section
}

/// How many patients reject each line, and which lines no patient tests.
fn line(cohort: &Cohort) -> String {
    let words = |kind: &LineOutcomes| {
        let tested = counted(kind.patients.tested(), "tested patient");
        format!("the {} in {} of {tested}", kind.kind, kind.patients.rejected)
    };
    let (tested, untested): (Vec<&LineOutcomes>, Vec<&LineOutcomes>) =
        cohort.outcomes.iter().partition(|kind| kind.patients.tested() > 0);
    let rejected = tested.iter().map(|kind| words(kind)).collect::<Vec<_>>().join(", ");
    let rejected =
        (!tested.is_empty()).then(|| format!("The bends reject a single force along {rejected}."));
    let names = untested.iter().map(|kind| format!("the {}", kind.kind)).collect::<Vec<_>>();
    let names = (!names.is_empty()).then(|| format!("Not tested: {}.", names.join(", ")));
    let all = [rejected, names].into_iter().flatten().collect::<Vec<_>>();
    if all.is_empty() {
        "No patient has a bending film with a model.".to_owned()
    } else {
        all.join(" ")
    }
}

/// Whether any line predicts better, and better than without mechanics.
fn sure(cohort: &Cohort) -> String {
    let compared = &cohort.compared;
    if compared.family() == 0 {
        return "The lines are not compared: two patients with films that two lines predict are necessary.".to_owned();
    }
    let predicted = compared.tests.iter().filter(|test| {
        test.error == ErrorKind::Location && test.role != FilmRole::Fitted && test.is_fair()
    });
    let compared: Vec<&LinePairTest> =
        predicted.filter(|test| test.comparison.is_compared()).collect();
    let better: Vec<String> = compared
        .iter()
        .filter_map(|test| {
            let better = test.predicts_better()?;
            let other = test.lines.into_iter().find(|&kind| kind != better)?;
            let films = test.role.films_words();
            Some(format!("the {better} predicts {films} better than the {other}"))
        })
        .collect();
    let lines = match (compared.is_empty(), better.is_empty()) {
        (true, _) => "No two lines with equally many numbers from each film are tested on films that were not fitted.".to_owned(),
        (false, true) if compared.iter().all(|test| test.holm_p.is_none()) => {
            let comparisons = compared.iter().map(|test| &test.comparison);
            too_few("which line predicts better", cohort.compared.family(), comparisons)
        }
        (false, true) => "Lines with equally many numbers from each film do not differ significantly on films that were not fitted.".to_owned(),
        (false, false) => format!("With equally many numbers from each film, {}.", better.join("; ")),
    };
    let against: Vec<&BaselineTest> =
        FilmRole::PREDICTED.into_iter().flat_map(|role| against_best(cohort, role)).collect();
    let better: Vec<String> = against
        .iter()
        .filter(|test| test.is_better() && test.is_fair())
        .map(|test| format!("the {} on {}", test.predictor().long_name(), test.role.films_words()))
        .collect();
    let baselines = match (against.is_empty(), better.is_empty()) {
        (true, _) => String::new(),
        (false, true) if against.iter().all(|test| test.holm_p.is_none()) => {
            let family = cohort.baselines.family();
            let comparisons = against.iter().map(|test| &test.comparison);
            let question = "lines against predictions without mechanics";
            format!(" {}", too_few(question, family, comparisons))
        }
        (false, true) => {
            " No line is significantly better than the best prediction without mechanics from as many numbers."
                .to_owned()
        }
        (false, false) => {
            let better = better.join(", ");
            format!(" Better than the best tested prediction without mechanics: {better}.")
        }
    };
    let untested = |role| cohort.baselines.untested_sentence(role);
    let untested = FilmRole::PREDICTED.into_iter().filter_map(untested);
    [format!("{lines}{baselines}")].into_iter().chain(untested).collect::<Vec<_>>().join(" ")
}

/// A question that a family of tests of as many patients cannot answer, whatever the differences are.
fn too_few<'a>(
    question: &str,
    tests: usize,
    untested: impl Iterator<Item = &'a PairedComparison>,
) -> String {
    format!("Too few patients to test {question}: {}.", too_few_words(tests, untested))
}

/// The tests of every line against the best predictions without mechanics on films of this role, without and with the tilt of the top.
fn against_best(cohort: &Cohort, role: FilmRole) -> impl Iterator<Item = &BaselineTest> {
    let best = [false, true].into_iter().filter_map(move |tilt| cohort.baselines.best(role, tilt));
    best.flat_map(|best| cohort.baselines.tests_against(best))
        .filter(|test| test.comparison.is_compared())
}

/// A prediction compared with another one on films that were not fitted.
struct Compared<'a> {
    role: FilmRole,
    what: String,
    test: &'a PairedComparison,
    holm_p: Option<f64>,
}

/// Location errors on films that were not fitted: every pair of lines, and every line against the best prediction without mechanics.
fn comparisons(cohort: &Cohort) -> Table {
    let mut tests: Vec<Compared<'_>> = Vec::new();
    for role in FilmRole::PREDICTED {
        let pairs = cohort.compared.tests.iter().filter(|test| {
            test.role == role && test.error == ErrorKind::Location && test.comparison.is_compared()
        });
        for test in pairs {
            let [first, second] = test.lines;
            let dagger = if test.is_fair() { "" } else { " †" };
            let what = format!("{first} – {second}{dagger}");
            tests.push(Compared { role, what, test: &test.comparison, holm_p: test.holm_p });
        }
        // One screen has room for the tilt on bends.
        let is_shown =
            |test: &&BaselineTest| role == FilmRole::LeftOutBend || !test.baseline.knows_tilt();
        for test in against_best(cohort, role).filter(is_shown) {
            let dagger = if test.is_fair() { "" } else { " †" };
            let what = format!("{} – {} *{dagger}", test.model, test.baseline.long_name());
            tests.push(Compared { role, what, test: &test.comparison, holm_p: test.holm_p });
        }
    }
    let mut table = Table::of("Comparisons over patients", tests, |add| {
        add.words("Films not fitted", |row| row.role.to_string());
        add.words("Location error of", |row| row.what.clone());
        add.numbers("Patients", |row| row.test.patients().to_string());
        add.words("Difference (mm, 95 %)", |row| difference_words(row.test));
        add.numbers("Holm p", |row| holm_p(row.holm_p));
    });
    table.note = format!(
        "Negative: the first one has the smaller error; an interval needs {} patients. * the best tested prediction without mechanics. With tilt: both know the tilt of the top vertebra. † not fair: the estimated line takes two numbers more from each film.",
        Resampling::FEWEST
    );
    table
}
