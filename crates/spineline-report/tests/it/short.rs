//! The first screen answers which line, how sure, how stiff and what next.

use spineline::action::LineKind;
use spineline::analysis::{
    Analysis, AnalysisOptions, FilmPredictor, FilmRole, Grouping, MultiplierEnding,
    MultiplierVerdict, Reference, analyze,
};
use spineline::anatomy::Posture;
use spineline::cohort::{
    BaselineTest, BaselinesOverPatients, Clustered, Cohort, ErrorKind, LinePairTest,
    PairedComparison, PredictionErrors,
};
use spineline::evaluate::Baseline;
use spineline::evaluate::paired::SignFlip;
use spineline::evaluate::statistics::Summary;
use spineline::number::fixed;
use spineline::personalize::{IntervalVerdict, MultiplierInformation};
use spineline::warning::WarningCode;
use spineline_phantom::Scenario;
use spineline_report::cohort::{self, PatientRow};
use spineline_report::patient::{self, Patient};
use spineline_report::{Document, WarningCounts, terminal};

use crate::common::{analyzed, case, cohort_of, rod_with_films, rows, shown, words as one_line};
use crate::terminal::tables;

const WIDTH: usize = terminal::WIDTH;
/// Lines of a patient whose stiffness values have intervals, or reasons why several have none.
const WITH_REASONS: usize = 27;

fn first_screen(document: &Document, most_lines: usize) -> String {
    let text = terminal(document, WIDTH);
    let lines = text.lines().count();
    assert!(lines <= most_lines, "{lines} lines:\n{text}");
    for line in text.lines() {
        assert!(line.chars().count() <= WIDTH, "{line}\n{text}");
    }
    text
}

#[test]
fn a_patient_fits_on_one_screen() {
    for truth in [Scenario::Rod, Scenario::Bend, Scenario::Pull] {
        for subject in 0..3 {
            let case = case(subject, truth);
            let analysis = analyzed(&case);
            let text = first_screen(&patient::summary(&shown(&case, &analysis, "")), 25);
            let questions =
                ["Which curve?", "Which line?", "How sure?", "How stiff?", "What next?"];
            let places = questions.map(|question| text.find(question).expect(question));
            assert!(places.is_sorted(), "{text}");
        }
    }
}

#[test]
fn a_row_has_the_test_and_the_errors_of_its_line() {
    let case = case(0, Scenario::Pull);
    let analysis = analyzed(&case);
    let document = patient::summary(&shown(&case, &analysis, ""));
    let table = tables(&document)[0].clone();
    let (compared, bands) = (analysis.comparison(), analysis.bands());
    for line in &compared.lines {
        let name = line.kind.to_string();
        let row = table.rows.iter().find(|row| row[0].to_lowercase().starts_with(&name));
        let row = row.expect("a row per line");
        let model = analysis.model(line.kind).expect("a model");
        let outcome = match line.kind {
            LineKind::Estimated => "not tested".to_owned(),
            _ => analysis.compatibility(model).outcome().to_string(),
        };
        assert_eq!(row[1], outcome);
        let shown = |mm: Option<f64>| mm.map_or("–".to_owned(), |mm| fixed(mm, 1));
        let (location, tilt) =
            (FilmPredictor::Line(line.kind), FilmPredictor::LineWithTilt(line.kind));
        for (cell, by, role) in [
            (2, location, FilmRole::LeftOutBend),
            (4, tilt, FilmRole::LeftOutBend),
            (6, location, FilmRole::HeldOut),
        ] {
            assert_eq!(row[cell], shown(compared.error_mm(by, role)));
            assert_eq!(row[cell + 1], shown(bands.mean_radius_mm(by, role)));
        }
    }
    assert!(table.rows.iter().any(|row| row[0].starts_with("* ")), "a row without mechanics");
    // Without a file of other patients, the distribution is the published one.
    let names: Vec<&str> = table.rows.iter().map(|row| row[0].as_str()).collect();
    assert!(names.contains(&"* distribution of rotations"), "{names:?}");
    assert!(!names.iter().any(|name| name.contains("learned")), "{names:?}");
}

#[test]
fn bends_that_mirror_each_other_are_not_held_against_mechanics() {
    let words = "The bends mirror each other: no test of mechanics.";
    for (truth, is_mirrored) in [(Scenario::Pull, true), (Scenario::Bend, false)] {
        let case = case(0, truth);
        let analysis = analyzed(&case);
        let ranking = analysis.comparison().ranking().expect("predicted bends");
        let (best, without_mm) = ranking.baseline.expect("predicted without mechanics");
        assert!(ranking.best().1 >= without_mm, "no line is better");
        assert_eq!(best == Baseline::MirroredBend, is_mirrored);
        assert_eq!(analysis.headline(None).prediction.expect("words").contains(words), is_mirrored);
        assert_eq!(analysis.verdict().join(" ").contains(words), is_mirrored);
    }
}

#[test]
fn the_best_line_is_the_best_of_those_that_take_as_few_numbers_from_a_film() {
    // The estimated line takes three numbers, and on many films it has a smaller error.
    let analysis = analyzed(&case(0, Scenario::Rod));
    let ranking = analysis.comparison().ranking().expect("predicted bends");
    assert!(ranking.lines.iter().all(|(kind, _)| *kind != LineKind::Estimated));
    let words = analysis.headline(None).prediction.expect("words");
    let (kind, mm) = ranking.best();
    let begin = format!(
        "Of the lines with one number per film, the {kind} has the smallest error on bends left out of the fit: {} mm (not tested);",
        fixed(mm, 1)
    );
    assert!(words.starts_with(&begin), "{words}");
    // A line alone has no smallest error.
    let mut alone = analyzed(&case(0, Scenario::Rod));
    alone.models.retain(|model| model.kind == LineKind::Inflection);
    let words = alone.headline(None).prediction.expect("words");
    let begin = format!(
        "The inflection line predicts bends left out of the fit with an error of {} mm",
        fixed(mm, 1)
    );
    assert!(kind == LineKind::Inflection && words.starts_with(&begin), "{words}");
}

#[test]
fn stiffness_is_identified_only_where_this_was_tested() {
    // Oracle: the verdicts on the multipliers themselves.
    let mut open = 0;
    for truth in [Scenario::Rod, Scenario::Pull, Scenario::Bend] {
        let case = case(0, truth);
        let analysis = analyzed(&case);
        let fitted = analysis.headline(None);
        assert!(fitted.stiffness.is_some_and(|text| !text.contains("the films identify ")));
        let tested: Vec<_> =
            analysis.models.iter().map(|model| analysis.identifiability(model)).collect();
        let headline = analysis.headline(Some(&tested));
        let place = analysis.models.iter().position(|model| Some(model.kind) == headline.kind);
        let place = place.expect("a model");
        let verdicts = analysis.models[place].verdicts(&analysis);
        let all = &tested[place].as_ref().expect("a converged fit").multipliers;
        let identified = |(fit, one): (&MultiplierVerdict, &MultiplierInformation)| {
            fit.has_value() && one.verdict() == IntervalVerdict::Interval
        };
        let count = verdicts.iter().zip(all).filter(|pair| identified(*pair)).count();
        let words = match count {
            0 => "identify no stiffness value.".to_owned(),
            n if n == all.len() => format!("identify {n} of {n} stiffness values."),
            n => format!("identify {n} of {} stiffness values; not identified: ", all.len()),
        };
        let text = headline.stiffness.expect("words");
        assert!(text.contains(&words), "{text}, not {words}");
        // An interval of the mean of the joints is not the interval of a value that disagrees with it.
        let patient = Patient { identifiability: Some(&tested), ..shown(&case, &analysis, "") };
        let text = one_line(&first_screen(&patient::summary(&patient), WITH_REASONS));
        let model = &analysis.models[place];
        let values = model.groups.titles().zip(model.multipliers()).zip(verdicts.iter().zip(all));
        for ((name, value), (fit, one)) in values {
            let is_open = fit.has_value() && one.verdict() != IntervalVerdict::Interval;
            let note = format!("{name} {} (not identified)", fixed(value, 2));
            assert_eq!(text.contains(&note), is_open, "{note}\n{text}");
            open += usize::from(is_open);
        }
    }
    assert!(open > 0, "the fit of prescribed rotations disagrees with the mean of the joints");
}

#[test]
fn fits_of_single_joints_outside_of_their_intervals_are_counted() {
    let case = case(0, Scenario::Rod);
    let grouping = Grouping::PerJoint;
    let options = AnalysisOptions { grouping, ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a phantom is sound");
    let tested: Vec<_> =
        analysis.models.iter().map(|model| analysis.identifiability(model)).collect();
    let kind = analysis.headline(Some(&tested)).kind;
    let place = analysis.models.iter().position(|model| Some(model.kind) == kind);
    let place = place.expect("a model");
    let verdicts = analysis.models[place].verdicts(&analysis);
    let all = &tested[place].as_ref().expect("a converged fit").multipliers;
    let valued = verdicts.iter().zip(all).filter(|(fit, _)| fit.has_value());
    let outside: Vec<bool> = valued.map(|(_, one)| one.is_outside()).collect();
    let count = outside.iter().filter(|outside| **outside).count();
    let patient = Patient { identifiability: Some(&tested), ..shown(&case, &analysis, "") };
    let text = one_line(&first_screen(&patient::summary(&patient), WITH_REASONS));
    let words = format!("; {count} of {} fits lie outside of their 95 % intervals.", outside.len());
    assert_eq!(text.contains(&words), count > 0, "{words}\n{text}");
}

#[test]
fn a_stiffness_without_a_value_says_why() {
    // With this weight, most joints of two regions turn against the force of the line that predicts best.
    let case = case(2, Scenario::Rod);
    let reference = Reference::Loaded { body_mass_kg: 50.0 };
    let options = AnalysisOptions { reference, ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a phantom is sound");
    let document = patient::summary(&shown(&case, &analysis, ""));
    let text = one_line(&first_screen(&document, WITH_REASONS));
    let kind = analysis.headline(None).kind.expect("a model");
    let model = analysis.model(kind).expect("a model");
    let endings = model.verdicts(&analysis).into_iter().map(|verdict| verdict.ending);
    let endings: Vec<MultiplierEnding> = endings.collect();
    assert!(endings.contains(&MultiplierEnding::Contradicted), "{endings:?}");
    for ((name, value), ending) in model.groups.titles().zip(model.multipliers()).zip(endings) {
        let value = format!("{name} {}", fixed(value, 2));
        let refused = format!("{value} (no value: most joints turn against the force)");
        assert!(text.contains(&value), "{value} is missing in\n{text}");
        assert_eq!(text.contains(&refused), ending == MultiplierEnding::Contradicted, "{text}");
    }
}

#[test]
fn a_line_that_the_bends_reject_gives_the_stiffness_only_where_no_other_can() {
    // Oracle: the force of this scenario is parallel to the iliac line. One bend predicts no film.
    let mut case = case(0, Scenario::Pull);
    case.films.retain(|film| [Posture::Erect, Posture::LeftBending].contains(&film.posture));
    let mut analysis = analyzed(&case);
    let choice = analysis.choose_model().expect("a model");
    assert_eq!(choice.kind, LineKind::Iliac);
    assert!(choice.words.ends_with("and which is not rejected."), "{}", choice.words);
    // A single bend is named.
    let line = analysis.headline(None).line;
    assert_eq!(
        line,
        "The left bend rejects a single force along the inflection line, and keeps one along the iliac line."
    );
    let kept = "A single force along the iliac line is kept by the left bend: ";
    assert!(analysis.verdict().iter().any(|text| text.starts_with(kept)), "{kept}");
    let inflection = analysis.model(LineKind::Inflection).expect("a model");
    let doubts = analysis.personalised_model(inflection).doubts;
    assert!(
        doubts[0].starts_with("the left bend rejects a single force along the inflection line")
    );
    let stiffness = |analysis: &Analysis| analysis.headline(None).stiffness.expect("words");
    assert!(stiffness(&analysis).starts_with("With the iliac line, "), "{}", stiffness(&analysis));
    // Without a model of another line, the answer says that the bend rejects this one.
    analysis.models.retain(|model| model.kind == LineKind::Inflection);
    let choice = analysis.choose_model().expect("a model");
    assert_eq!(choice.kind, LineKind::Inflection);
    assert!(choice.words.ends_with(" The left bend rejects this line."), "{}", choice.words);
    let begin = "With the inflection line, which the left bend rejects, ";
    assert!(stiffness(&analysis).starts_with(begin), "{}", stiffness(&analysis));
}

#[test]
fn one_bend_and_no_other_film_leave_no_errors_to_explain() {
    let case = rod_with_films(0, &[Posture::Erect, Posture::LeftBending]);
    let analysis = analyzed(&case);
    let document = patient::summary(&shown(&case, &analysis, ""));
    let text = first_screen(&document, 25);
    assert!(text.contains("How sure? No film was left to test a prediction."), "{text}");
    let table = tables(&document)[0];
    let heads: Vec<&str> = table.columns.iter().map(|column| column.head.as_str()).collect();
    assert_eq!(heads, ["Line", "Bends"]);
    assert_eq!(table.caption, "Lines tested by the bend");
    assert_eq!(table.note, "† two more numbers per film.");
}

#[test]
fn an_erect_film_alone_says_what_to_add() {
    let mut case = case(0, Scenario::Rod);
    case.films.truncate(1);
    let analysis = analyzed(&case);
    let text = first_screen(&patient::summary(&shown(&case, &analysis, "")), 25);
    assert!(text.contains("no bending film"), "{text}");
    assert!(!text.contains("How stiff?"), "{text}");
}

#[test]
fn a_cohort_shows_the_test_of_every_patient_and_one_row_per_comparison() {
    let analyses: Vec<Analysis> =
        (0..4).map(|subject| analyzed(&case(subject, Scenario::Pull))).collect();
    let together = cohort_of(&analyses);
    let patients: Vec<PatientRow> = analyses.iter().map(PatientRow::of).collect();
    let document = cohort::summary(&rows(&patients, &together));
    first_screen(&document, 45);
    let all = tables(&document);
    assert_eq!(all[0].rows.len(), analyses.len());
    for (row, analysis) in all[0].rows.iter().zip(&analyses) {
        let outcome = |kind| {
            let model = analysis.model(kind)?;
            Some(analysis.compatibility(model).outcome().to_string())
        };
        assert_eq!(Some(row[2].clone()), outcome(LineKind::Inflection));
        assert_eq!(Some(row[3].clone()), outcome(LineKind::Iliac));
    }
    let pairs = together.compared.tests.iter().filter(|test| {
        test.role != FilmRole::Fitted
            && test.error == ErrorKind::Location
            && test.comparison.is_compared()
    });
    let without_mechanics = all[1].rows.iter().filter(|row| row[1].contains(" *"));
    assert_eq!(all[1].rows.len(), pairs.count() + without_mechanics.count());
}

/// A cohort of one shown patient whose comparisons say that the first model has the smaller error; with T2's tilt, the mean errors on bends
/// left out are 12.0 mm by the published distribution, 3.5 mm by the iliac line, and `learned_mm` by the learned distribution.
fn constructed(analysis: &Analysis, learned_mm: f64) -> Cohort {
    let comparison = PairedComparison {
        pooled: None,
        patients: None,
        sign_flip: Some(SignFlip { n: 20, p_two_sided: 0.001, exact: true }),
        bootstrap: Some([-9.2, -7.8]),
        effect: None,
        mean_difference: -8.5,
    };
    let (line, role, films) = (LineKind::Iliac, FilmRole::LeftOutBend, 40);
    let error = |mm: f64| {
        let one = Summary::of(&[mm]);
        Clustered { pooled: one, patients: one, bootstrap: None }
    };
    let without = |by, mm| PredictionErrors { by, role, films, location_mm: error(mm) };
    let published = Baseline::RotationPriorWithTilt;
    let mut cohort = cohort_of(std::slice::from_ref(analysis));
    cohort.baselines = BaselinesOverPatients {
        errors: vec![without(published, 12.0), without(Baseline::LearnedWithTilt, learned_mm)],
        lines_with_tilt: vec![PredictionErrors { by: line, role, films, location_mm: error(3.5) }],
        tests: vec![BaselineTest {
            model: line,
            baseline: published,
            role,
            films,
            comparison,
            holm_p: Some(0.001),
        }],
        hypothesis_tests: Vec::new(),
    };
    cohort.compared.tests = vec![LinePairTest {
        lines: [LineKind::Inflection, line],
        role: FilmRole::HeldOut,
        error: ErrorKind::Location,
        films,
        without_result: 0,
        comparison,
        holm_p: Some(0.001),
        per_predicted_film: [1, 1],
    }];
    cohort
}

#[test]
fn a_difference_is_written_in_the_direction_of_its_sentence() {
    let analysis = analyzed(&case(0, Scenario::Pull));
    let cohort = constructed(&analysis, 5.0);
    let line = "There the iliac line is better than distribution of rotations with tilt: its error is smaller by 8.5 mm (95 % interval over 20 patients 7.8 to 9.2 mm; p ";
    let pair = "On neutral and traction films the error of the inflection line is smaller than the error of the iliac line by 8.5 mm (95 % interval over 20 patients 7.8 to 9.2 mm; p ";
    let verdict = cohort.verdict();
    for start in [line, pair] {
        assert!(verdict.iter().any(|text| text.starts_with(start)), "{start}: {verdict:?}");
    }
    let rows_of = [PatientRow::of(&analysis)];
    let text = one_line(&terminal(&cohort::summary(&rows(&rows_of, &cohort)), WIDTH));
    let films =
        "the inflection line predicts neutral and traction films better than the iliac line.";
    assert!(text.contains(films), "{text}");
}

#[test]
fn a_smaller_error_that_is_not_tested_is_named_beside_the_better_line() {
    let analysis = analyzed(&case(0, Scenario::Pull));
    let better = "Better than the best tested prediction without mechanics: the iliac line with tilt on bends left out of the fit.";
    let smaller = "The distribution learned from other patients with tilt has a smaller mean error on bends left out of the fit than such a line, 1.0 mm; no line is tested against it, because it knows more.";
    for (learned_mm, is_named) in [(1.0, true), (5.0, false)] {
        let cohort = constructed(&analysis, learned_mm);
        let patients = [PatientRow::of(&analysis)];
        let text = one_line(&terminal(&cohort::summary(&rows(&patients, &cohort)), WIDTH));
        assert!(text.contains(better), "{text}");
        assert_eq!(text.contains(&format!("{better} {smaller}")), is_named, "{text}");
        assert_eq!(cohort.verdict().iter().any(|one| one == smaller), is_named, "{learned_mm}");
    }
}

#[test]
fn warnings_are_one_line_per_code() {
    let analyses: Vec<Analysis> =
        (0..3).map(|subject| analyzed(&case(subject, Scenario::Bend))).collect();
    let mut counts = WarningCounts::default();
    analyses.iter().for_each(|analysis| counts.add(analysis));
    let lines = counts.lines("--warnings");
    assert!((2..=10).contains(&lines.len()), "{lines:?}");
    for line in lines.iter().filter(|line| !line.code.is_empty()) {
        let code: WarningCode = line.code.parse().expect("a code");
        let patients = analyses.iter().filter(|analysis| analysis.warnings.has(code)).count();
        assert!(line.text.starts_with(&format!("{patients} patient")), "{}", line.text);
        let all = analyses.iter().flat_map(|analysis| analysis.warnings.all());
        for kind in all.filter(|one| one.code == code).filter_map(|one| one.line) {
            assert!(line.text.contains(&kind.to_string()), "{}", line.text);
        }
    }
}

#[test]
fn an_empty_cohort_says_so() {
    let document = cohort::summary(&rows(&[], &cohort_of(&[])));
    assert!(terminal(&document, terminal::WIDTH).contains("No case could be analysed."));
}

#[test]
fn a_single_film_has_no_models_and_no_empty_sections() {
    let mut alone = case(0, Scenario::Rod);
    alone.films.truncate(1);
    let document = patient::full(&shown(&alone, &analyzed(&alone), ""));
    let ids: Vec<&str> = document.sections.iter().map(|section| section.id).collect();
    assert_eq!(ids, ["short", "verdict", "films"]);
    assert!(document.sections.iter().all(|section| !section.blocks.is_empty()));
}
