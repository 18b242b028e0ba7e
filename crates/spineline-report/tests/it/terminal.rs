//! What a terminal shows holds every number and every word of the analysis, aligned and in lines that fit.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, FilmPredictor, FilmRole, analyze};
use spineline::anatomy::Level;
use spineline::hypothesis::{Hypothesis, HypothesisScores, Role, compare};
use spineline::measure::{FilmReadings, TiltRule};
use spineline::number::{fixed, signed};
use spineline::personalize::{
    FitStatus, FitTarget, Gauge, Identifiability, LogNormalPrior, StiffnessBound,
};
use spineline::reliability::{QuantityReliability, assess, film_quantities};
use spineline::uncertainty::{LandmarkNoise, MonteCarlo, QuantityKind, Uncertainty};
use spineline_phantom::Scenario;
use spineline_report::cohort::{self, PatientRow};
use spineline_report::document::{Block, NoticeKind, Table};
use spineline_report::patient::{self, Patient};
use spineline_report::{Document, reliability, terminal, warnings};

use crate::common::{GENERATOR, analyzed, case, cohort_of, rows, shown, words};

const WIDTH: usize = 110;
/// No line is broken below it.
const WIDE: usize = 1000;

fn summary(
    case: &Case,
    analysis: &Analysis,
    identifiability: Option<&[Option<Identifiability>]>,
    uncertainty: Option<&Uncertainty>,
) -> Document {
    let shown = shown(case, analysis, "");
    patient::full(&Patient { identifiability, uncertainty, ..shown })
}

/// All cells of a row, as a wide terminal shows them.
fn holds(text: &str, cells: &[String]) {
    let row = words(&cells.join(" "));
    assert!(words(text).contains(&row), "`{row}` is missing in\n{text}");
}

fn percent(part: f64) -> String {
    fixed(100.0 * part, 0)
}

#[test]
fn the_header_the_main_finding_and_the_curve_are_shown() {
    for (subject, scenario) in [(0, Scenario::Rod), (4, Scenario::Pull)] {
        let case = case(subject, scenario);
        let analysis = analyzed(&case);
        let text = terminal(&summary(&case, &analysis, None, None), WIDTH);
        let head = format!("{} · SYNTHETIC · films: {}", case.id, analysis.movement.films.len());
        assert!(text.lines().next().expect("a line").contains(&head), "{text}");
        let said = analysis.verdict();
        let curve = analysis.inflection_words();
        let chain = format!("Chain of {} segments of", analysis.movement.chain.segments);
        let said = said.into_iter().chain(curve.lines().map(str::to_owned));
        for sentence in said.chain([analysis.lenke_words(), chain]) {
            assert!(words(&text).contains(&words(&sentence)), "`{sentence}` is missing in\n{text}");
        }
        let segment = analysis.movement.scale().text(analysis.movement.chain.segment_mm, 4);
        for said in [segment.as_str(), analysis.gauge_words()] {
            assert!(words(&text).contains(said), "`{said}` is missing in\n{text}");
        }
    }
}

#[test]
fn every_clinical_angle_and_every_fitted_curve_is_shown() {
    let case = case(0, Scenario::Rod);
    let analysis = analyzed(&case);
    let text = terminal(&summary(&case, &analysis, None, None), WIDE);
    assert!(!analysis.movement.clinical.is_empty());
    for curve in &analysis.movement.clinical {
        let sign = curve.erect_size().rad().signum();
        let mut cells = vec![
            curve.region.to_string(),
            curve.convex.expect("a curve has a side").to_string(),
            format!("{}–{}", curve.ends.superior, curve.ends.inferior),
            curve.apex.to_string(),
        ];
        cells.extend(curve.angles.iter().map(|(_, all)| fixed(all.size().deg() * sign, 1)));
        cells.push(percent(curve.flexibility.expect("it was bent")));
        holds(&text, &cells);
    }
    for p in &analysis.movement.films {
        let mut cells = vec![
            p.outline.posture.to_string(),
            p.outline.amplitude().leaning(),
            p.fit.order.to_string(),
            p.outline.scale.residual_text(p.fit.rmse_mm),
            fixed(p.fit.rmse_tilt.deg(), 2),
            p.outline.readings.to_string(),
        ];
        if let (Some(mean), Some([a, b])) = (p.mean_rotation(), p.inflection_estimates) {
            let distances = format!("{}, {}", a.distance_segments, b.distance_segments);
            cells.extend([fixed(mean.deg(), 4), distances]);
        }
        holds(&text, &cells);
        if let Some(line) = &p.best_fit_line {
            let [caudal, cranial] = &line.crossings;
            let tilt = line.line.lateral_tilt().leaning();
            let posture = p.outline.posture.to_string();
            holds(&text, &[posture, tilt, caudal.to_string(), cranial.to_string()]);
        }
    }
    holds(
        &text,
        &["p: through both inflections", "p: parallel to the iliac line"].map(str::to_owned),
    );
    let mut lines = analysis.movement.films.iter().filter_map(|p| p.best_fit_line.as_ref());
    let spread = percent(lines.next().expect("a line").joint_log_sd);
    assert!(text.contains(&format!("differ in stiffness by {spread} %")), "{text}");
}

#[test]
fn every_error_force_and_multiplier_is_shown() {
    let case = case(0, Scenario::Rod);
    let analysis = analyzed(&case);
    let compared = analysis.comparison();
    let text = terminal(&summary(&case, &analysis, None, None), WIDE);
    assert_eq!(analysis.models.len(), 3);
    for model in &analysis.models {
        for s in model.simulations.iter().filter(|s| s.is_usable()) {
            let largest = s.shape.location_errors_mm.iter().copied().fold(0.0, f64::max);
            let angles: Vec<String> =
                s.ferguson_difference.iter().map(|a| fixed(a.abs().deg(), 1)).collect();
            holds(
                &text,
                &[
                    model.kind.to_string(),
                    s.shape.posture.to_string(),
                    fixed(s.shape.mean_location_error_mm(), 2),
                    fixed(largest, 2),
                    angles.join(" / "),
                    fixed(s.force_n, 0),
                    format!("{} of {}", s.contradicted.len(), s.shape.location_errors_mm.len()),
                ],
            );
        }
    }
    let values: Vec<Vec<f64>> = analysis.models.iter().map(|m| m.multipliers().collect()).collect();
    let verdicts: Vec<_> = analysis.models.iter().map(|model| model.verdicts(&analysis)).collect();
    for (group, name) in analysis.models[0].groups.titles().enumerate() {
        let mut cells = vec![name];
        for (values, verdicts) in values.iter().zip(&verdicts) {
            cells.push(fixed(values[group], 2));
            let refusal = verdicts[group].ending.refusal();
            cells.extend(refusal.map(|text| format!("({text})")));
        }
        holds(&text, &cells);
    }
    let bands = analysis.bands();
    for (place, line) in compared.lines.iter().enumerate() {
        for role in FilmRole::ALL {
            let errors = compared.errors(place, role).expect("all films are there");
            let numbers = match role {
                FilmRole::Fitted => format!("= {} fitted", line.numbers.fitted()),
                _ => format!("{} per film", line.numbers.per_predicted_film),
            };
            let radius = bands.mean_radius_mm(FilmPredictor::Line(line.kind), role);
            let cells = [
                role.to_string(),
                line.kind.to_string(),
                format!("{} of {}", errors.films, compared.count(role)),
                fixed(errors.location_mm, 2),
                radius.map_or("–".to_owned(), |mm| fixed(mm, 1)),
                fixed(errors.ferguson_deg, 1),
            ];
            holds(&text, &cells);
            assert!(text.contains(&numbers), "{numbers} is missing in\n{text}");
        }
    }
}

#[test]
fn a_fit_that_found_no_value_says_so() {
    let case = case(0, Scenario::Rod);
    let mut analysis = analyzed(&case);
    for model in &mut analysis.models {
        model.fit.bounds.fill(StiffnessBound::Inside);
    }
    analysis.models[0].fit.status = FitStatus::IterationLimit;
    analysis.models[1].fit.bounds[2] = StiffnessBound::Upper;
    let text = terminal(&summary(&case, &analysis, None, None), WIDE);
    assert!(text.contains("Warning: inflection line: the fit is NOT CONVERGED ("), "{text}");
    assert_eq!(text.matches("(no value: at its bound)").count(), 2, "page one and table: {text}");
    assert_eq!(text.matches("(no value: not converged)").count(), 3, "{text}");
}

#[test]
fn requested_loads_and_bases_are_shown() {
    let case = Case { id: "P".repeat(60), ..case(0, Scenario::Rod) };
    let hypotheses = Hypothesis::compared();
    let options = AnalysisOptions { hypotheses, ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a phantom is sound");
    let document = summary(&case, &analysis, None, None);
    assert_fits(&document);
    let text = terminal(&document, WIDE);
    assert!(text.contains("Loads and bases compared (synthetic)"), "{text}");
    // One patient has no interval and no test.
    let caption = "Loads and bases less predictions without mechanics, bends left out (mm)\n";
    assert!(text.contains(caption) && !text.contains("Better: significantly"), "{text}");
    let blocks = compare(&[&HypothesisScores::all(&analysis.hypotheses)[..]]);
    let [block] = &blocks[..] else { panic!("one block") };
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| fixed(value, 1));
    for one in &block.hypotheses {
        let at = |role: Role| Role::ALL.iter().position(|r| *r == role).expect("one of all");
        let mm = |role| number(one.location_mm[at(role)]);
        let deg = |role| number(one.rotation_deg[at(role)]);
        holds(
            &text,
            &[
                one.hypothesis.to_string(),
                one.free.to_string(),
                mm(Role::Fitted),
                mm(Role::LeftOut),
                mm(Role::LeftOutWithPrior),
                mm(Role::LeftOutWithTilt),
                mm(Role::LeftOutLoadFitted),
                mm(Role::HeldOut),
                deg(Role::Fitted),
                deg(Role::LeftOut),
                number(one.against),
                format!("{} {}", signed(one.aicc_difference, 0), signed(one.bic_difference, 0)),
                format!("{} / {} {}", one.best_left_out, one.best_aicc, one.lost),
            ],
        );
    }
}

#[test]
fn requested_identifiability_and_prior_are_shown() {
    let case = case(1, Scenario::Rod);
    let prior = LogNormalPrior::IN_VIVO;
    let options = AnalysisOptions { prior: Some(prior), ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a phantom is sound");
    let found: Vec<Option<Identifiability>> =
        analysis.models.iter().map(|model| analysis.identifiability(model)).collect();
    let text = terminal(&summary(&case, &analysis, Some(&found), None), WIDE);
    assert!(text.contains("Identifiability of the multipliers"), "{text}");
    holds(&text, &["sd of ln with prior (1)", "share from films (%)"].map(str::to_owned));
    let deviation = |sd: f64| if sd < 100.0 { fixed(sd, 2) } else { "unlimited".to_owned() };
    for (model, found) in analysis.models.iter().zip(&found) {
        let Some(found) = found else { continue };
        let rows = model.groups.titles().zip(model.multipliers()).zip(&found.multipliers);
        for ((name, value), one) in rows {
            let row = format!("{} {} {}", model.kind, name, fixed(value, 2));
            holds(&text, &[row]);
            let with_prior = one.log_sd_with_prior.expect("there is a prior");
            let share = one.film_share(prior.log_sd, found.multipliers.len(), Gauge::GeometricMean);
            let cells = [
                deviation(one.log_sd),
                one.verdict().to_string(),
                deviation(with_prior),
                share.map_or("–".to_owned(), percent),
            ];
            holds(&text, &cells);
        }
        if found.variance_factor > 1.0 {
            let times = format!("the fit leaves {} times", fixed(found.variance_factor.sqrt(), 1));
            assert!(text.contains(&times), "{times} is missing in\n{text}");
        }
        let weakest = found.directions.first().expect("a direction");
        let least = format!("(sd of ln {})", deviation(weakest.log_sd));
        assert!(text.contains("Least known") && text.contains(&least), "{text}");
    }
}

#[test]
fn a_fit_of_ferguson_angles_is_not_measured_by_the_noise_of_the_films() {
    let case = case(1, Scenario::Rod);
    let options = AnalysisOptions { target: FitTarget::Ferguson, ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a phantom is sound");
    let found: Vec<_> = analysis.models.iter().map(|one| analysis.identifiability(one)).collect();
    let text = terminal(&summary(&case, &analysis, Some(&found), None), WIDE);
    let both =
        analysis.models.iter().zip(&found).filter_map(|(m, found)| Some((m, found.as_ref()?)));
    let widened: Vec<_> = both.filter(|(_, found)| found.variance_factor > 1.0).collect();
    for (model, found) in &widened {
        // The estimated line is fitted to whole shapes.
        let is_shape = model.kind == LineKind::Estimated;
        let unit = if is_shape { " times what noise explains" } else { "° where 1° is assumed" };
        let left = fixed(found.variance_factor.sqrt(), 1);
        let said = format!("{}: the fit leaves {left}{unit}", model.kind);
        assert!(text.contains(&said), "{said} is missing in\n{text}");
    }
    assert!(widened.len() > 1, "a wrong line leaves more than 1°");
}

#[test]
fn requested_numbers_of_replicates_are_shown() {
    let case = case(0, Scenario::Rod);
    let analysis = analyzed(&case);
    let monte_carlo =
        MonteCarlo::new(&case, &analysis, LandmarkNoise::Measured, 7).expect("readings repeat");
    let mut tally = monte_carlo.tally();
    (0..4).for_each(|index| tally.add(&monte_carlo.replicate(index)));
    let found = tally.finish(5);
    let text = terminal(&summary(&case, &analysis, None, Some(&found)), WIDE);
    let head = format!("4 replicates, seed 7; {} of them failed", found.failed);
    assert!(text.contains(&head), "{text}");
    assert!(text.contains("Interrupted: requested were 5 replicates."), "{text}");
    let few = found.few_words().expect("4 replicates");
    let usable = found.done - found.failed;
    assert_eq!(few, format!("A 95 % interval needs 40 replicates; with a result: {usable}."));
    let said = found.noise_words().into_iter().chain(found.failure_words()).chain([few]);
    for sentence in said.chain([Uncertainty::CAVEAT.to_owned()]) {
        assert!(words(&text).contains(&words(&sentence)), "`{sentence}` is missing in\n{text}");
    }
    for spread in found.quantities.iter().filter(|spread| spread.quantity.is_reported()) {
        let sd = spread.spread.and_then(|s| s.sd).map_or("–".to_owned(), |sd| fixed(sd, 2));
        let label = words(&spread.quantity.label(&analysis));
        let rows = text.lines().map(words);
        let mut rows = rows.filter(|row| row.starts_with(&label)).peekable();
        assert!(rows.peek().is_some(), "{label} is missing in\n{text}");
        assert!(rows.any(|row| row.contains(&sd)), "{label}: {sd} is missing in\n{text}");
    }
    for posture in analysis.movement.films.iter().map(|p| p.outline.posture) {
        let tilt = QuantityKind::Tilt.on(posture);
        let of = |level: Level| found.spread(tilt.at(level)).and_then(|s| s.sd);
        let sds = || Level::MODEL[1..].iter().filter_map(|&level| of(level));
        let largest = format!("{} (", fixed(sds().fold(0.0, f64::max), 2));
        let mean = format!("{} ", fixed(sds().sum::<f64>() / sds().count() as f64, 2));
        let row = words(&[mean, largest].concat());
        assert!(words(&text).contains(&row), "{posture}: {row} is missing in\n{text}");
    }
}

#[test]
fn every_warning_names_case_place_and_code() {
    let mut case = case(0, Scenario::Rod);
    case.films.truncate(1);
    let analysis = analyzed(&case);
    let notices = warnings(&analysis);
    assert!(!notices.is_empty() && notices.len() == analysis.warnings.all().len());
    for (notice, warning) in notices.iter().zip(analysis.warnings.all()) {
        let line = terminal::notice(notice, usize::MAX);
        let begin = format!("{}: {}", NoticeKind::from(warning.code.severity()).word(), case.id);
        assert!(line.starts_with(&begin) && line.lines().count() == 1, "{line}");
        assert!(line.contains(&words(&warning.text())), "{line}");
        assert!(line.ends_with(&format!("[{}]\n", warning.code.key())), "{line}");
        let film = warning.posture.map(|posture| format!(", {posture} film"));
        assert!(film.is_none_or(|film| line.contains(&film)), "{line}");
    }
}

pub fn tables(document: &Document) -> Vec<&Table> {
    let blocks = document.sections.iter().flat_map(|section| &section.blocks);
    let tables = blocks.filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    });
    tables.collect()
}

/// No line is longer than outside of a terminal.
fn assert_fits(document: &Document) {
    let text = terminal(document, terminal::WIDTH);
    let long: Vec<&str> =
        text.lines().filter(|line| line.chars().count() > terminal::WIDTH).collect();
    assert!(long.is_empty(), "{long:#?}");
}

/// Every word of every cell is in the text, and no line is longer than the width.
fn assert_whole(document: &Document) {
    let text = terminal(document, WIDTH);
    assert_eq!(document.figures().count(), 0);
    for line in text.lines() {
        assert!(line.chars().count() <= WIDTH, "{line}\n{text}");
        assert_eq!(line, line.trim_end(), "blanks at the end");
    }
    assert_fits(document);
    for table in tables(document) {
        let shown = terminal::table(table, WIDTH);
        assert!(text.contains(&shown), "{}", table.caption);
        for word in table.rows.iter().flatten().flat_map(|cell| cell.split_whitespace()) {
            assert!(shown.contains(word), "{word} is missing in\n{shown}");
        }
        let wide = terminal::table(table, WIDE);
        let rows = table.rows.len() + 3 + usize::from(!table.note.is_empty());
        assert_eq!(wide.lines().count(), rows, "one line per row:\n{wide}");
    }
}

#[test]
fn a_patient_fits_the_terminal_width_and_two_pages() {
    for scenario in [Scenario::Rod, Scenario::Pull] {
        let case = case(2, scenario);
        let document = summary(&case, &analyzed(&case), None, None);
        assert_whole(&document);
        let lines = terminal(&document, WIDTH).lines().count();
        assert!(lines < 150, "{lines} lines");
    }
}

#[test]
fn a_cohort_shows_every_patient_line_and_test() {
    let cases: Vec<Case> = (0..4).map(|subject| case(subject, Scenario::Pull)).collect();
    let analyses: Vec<Analysis> = cases.iter().map(analyzed).collect();
    let together = cohort_of(&analyses);
    let patients: Vec<PatientRow> = analyses.iter().map(PatientRow::of).collect();
    let document = cohort::full(&rows(&patients, &together));
    assert_whole(&document);
    let text = terminal(&document, WIDE);
    assert!(text.starts_with("Cohort: 4 patients · SYNTHETIC"), "{text}");
    for sentence in together.sentences() {
        assert!(words(&text).contains(&words(&sentence)), "`{sentence}` is missing in\n{text}");
    }
    for analysis in &analyses {
        let cobb = analysis.movement.clinical.iter().map(|curve| curve.erect_size().abs().deg());
        let mut cells = vec![
            analysis.case_id.clone(),
            fixed(cobb.fold(0.0, f64::max), 0),
            analysis.movement.inflections.all.len().to_string(),
        ];
        for kind in [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated] {
            let place =
                analysis.models.iter().position(|model| model.kind == kind).expect("a model");
            let [fitted, held_out] =
                [true, false].map(|fitted| analysis.models[place].mean_location_error_mm(fitted));
            let left_out = analysis.comparison().errors(place, FilmRole::LeftOutBend);
            let errors = [fitted, left_out.map(|errors| errors.location_mm), held_out]
                .map(|e| e.map_or("–".to_owned(), |e| fixed(e, 1)));
            cells.push(errors.join(" / "));
        }
        holds(&text, &cells);
    }
    let compared = &together.compared;
    assert!(compared.family() > 0);
    let heads = ["First minus second line", "Films", "Error"];
    holds(&text, &heads.map(str::to_owned));
    holds(&text, &["Sign-flip p", "Holm p", "Pooled p (the paper's)"].map(str::to_owned));
    holds(&text, &["inflection – iliac".to_owned()]);
    for errors in compared.errors.iter().filter(|errors| errors.films > 0) {
        let cells = [
            errors.kind.to_string(),
            errors.role.to_string(),
            errors.location_mm.patients.n.to_string(),
            errors.films.to_string(),
            errors.without_result.to_string(),
            fixed(errors.location_mm.patients.mean, 1),
        ];
        holds(&text, &cells);
    }
    let rows =
        tables(&document).iter().find(|t| t.caption.contains("pair")).expect("tests").rows.len();
    assert_eq!(rows, compared.family());
    for said in [compared.believe_words().to_owned(), compared.family_words()] {
        assert!(words(&text).contains(&words(&said)), "{said}");
    }
}

#[test]
fn every_statistic_of_readings_is_shown_with_interval_and_limits_of_agreement() {
    let case = case(0, Scenario::Rod);
    let measure = |film| FilmReadings::measure(film, TiltRule::default()).expect("sound");
    let films: Vec<FilmReadings> = case.films.iter().map(measure).collect();
    let found: Vec<QuantityReliability> =
        film_quantities(&[(&case.id, &films)]).iter().map(assess).collect();
    let document = reliability::full(&found, true, GENERATOR);
    assert_whole(&document);
    let text = terminal(&document, WIDE);
    assert!(text.lines().next().is_some_and(|line| line.contains("SYNTHETIC")), "{text}");
    for quantity in &found {
        assert!(text.contains(&format!("{}: {}", quantity.key, quantity.meaning)), "{text}");
        for design in quantity.designs.iter().filter(|design| !design.bland_altman.is_empty()) {
            for statistic in &design.statistics {
                let (value, interval) = statistic.shown();
                let value = value.unwrap_or_else(|| "–".to_owned());
                holds(&text, &[statistic.kind.to_string(), value, interval]);
            }
            for pair in &design.bland_altman {
                let [first, second] = &pair.raters;
                let bias = spineline::reliability::shown_measure(pair.bias);
                holds(&text, &[format!("Bland-Altman bias, {second} minus {first} {bias}")]);
            }
            for remark in &design.remarks {
                assert!(words(&text).contains(&words(&remark.to_string())), "{remark}");
            }
        }
    }
}

#[test]
fn control_characters_in_a_name_are_removed() {
    let hostile = "\u{1b}[2J\u{1b}]0;x\u{7}\u{202e}P07\r\u{9b}31m";
    let case = Case { id: hostile.to_owned(), ..case(0, Scenario::Rod) };
    let analysis = analyzed(&case);
    let mut text = terminal(&summary(&case, &analysis, None, None), WIDTH);
    text.extend(warnings(&analysis).iter().map(|notice| terminal::notice(notice, WIDTH)));
    assert!(text.chars().all(|c| c == '\n' || !(c.is_control() || c == '\u{202e}')), "{text:?}");
    assert!(text.starts_with("Patient: [2J]0;xP07"), "{text}");
}
