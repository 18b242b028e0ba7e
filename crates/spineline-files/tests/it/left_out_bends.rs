//! Bends of real patients that were left out, on public spine lines: the published numbers hold, and a distribution of joint
//! rotations predicts patients that it was not learned from better than any line does.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, FilmRole, LinesCompared, analyze};
use spineline::cohort::{Cohort, CohortPatient, learn_rotation_prior};
use spineline::evaluate::Baseline;
use spineline::number;

use crate::public_cases::cases;

/// Differences from `validation/lines.md` and `docs/decisions/0034` that are worth a correction there.
const PUBLISHED_TO_MM: f64 = 0.2;

fn analyzed(case: &Case, options: &AnalysisOptions) -> Analysis {
    analyze(case, options).expect("a sound case")
}

fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    number::mean(values).expect("predicted bends")
}

/// Mean error of a line on the left-out bends of a patient that it predicts; `None` without one.
fn line_error_mm(compared: &LinesCompared, kind: LineKind) -> Option<f64> {
    let place = compared.lines.iter().position(|line| line.kind == kind)?;
    let films = compared.films.iter().filter(|film| film.role == FilmRole::LeftOutBend);
    number::mean(
        films.filter_map(|film| {
            Some(film.simulations[place].as_ref()?.shape.mean_location_error_mm())
        }),
    )
}

#[test]
fn left_out_bends_of_real_patients_have_the_errors_that_are_published() {
    let Some(cases) = cases() else { return };
    let analyses: Vec<Analysis> =
        cases.iter().map(|case| analyzed(case, &AnalysisOptions::default())).collect();
    let patients: Vec<CohortPatient> = analyses.iter().map(CohortPatient::of).collect();
    let cohort = Cohort::of(&patients, 1);
    let near = |what: &str, mm: f64, published_mm: f64| {
        println!("{what}: {mm:.2} mm");
        assert!((mm - published_mm).abs() <= PUBLISHED_TO_MM, "{what}: {mm}, not {published_mm}");
    };
    for (baseline, published_mm) in [
        (Baseline::MirroredBend, 6.4),
        (Baseline::PublishedMobility, 5.5),
        (Baseline::OtherPatients, 3.2),
        (Baseline::RotationPrior, 2.9),
        (Baseline::LearnedWithTilt, 1.6),
        (Baseline::RotationPriorWithTilt, 2.4),
        (Baseline::Cubic, 2.6),
    ] {
        let mut errors = cohort.baselines.errors.iter();
        let found = errors.find(|one| one.by == baseline && one.role == FilmRole::LeftOutBend);
        near(baseline.key(), found.expect("predicted").mean_mm(), published_mm);
    }
    for (kind, published_mm) in [(LineKind::Iliac, 4.7), (LineKind::Estimated, 2.5)] {
        let mut errors = cohort.baselines.lines_with_tilt.iter();
        let found = errors.find(|one| one.by == kind && one.role == FilmRole::LeftOutBend);
        near(kind.key(), found.expect("predicted").mean_mm(), published_mm);
    }
    for (kind, published_mm) in [(LineKind::Iliac, 4.6), (LineKind::Estimated, 1.6)] {
        let errors = analyses.iter().filter_map(|one| line_error_mm(one.comparison(), kind));
        near(kind.key(), mean(errors), published_mm);
    }
}

#[test]
fn rotations_of_half_of_the_patients_predict_the_others_better_than_lines_do() {
    let Some(cases) = cases() else { return };
    let (known, unseen) = cases.split_at(cases.len().div_ceil(2));
    let known: Vec<CohortPatient> = known
        .iter()
        .map(|case| CohortPatient::of(&analyzed(case, &AnalysisOptions::default())))
        .collect();
    let learned = learn_rotation_prior(&known, 1).expect("patients with bends");
    let options = AnalysisOptions { rotation_prior: Some(learned.prior), ..Default::default() };
    let compared: Vec<LinesCompared> =
        unseen.iter().map(|case| analyzed(case, &options).comparison().clone()).collect();
    // On the bends that a line predicts with the tilt of T2, too: one mean per patient.
    let errors = |kind: LineKind| -> Vec<[f64; 2]> {
        let of_patient = |found: &LinesCompared| {
            let place = found
                .lines
                .iter()
                .position(|line| line.kind == kind && line.numbers.per_predicted_film == 1)?;
            let films = found.films.iter().filter(|film| film.role == FilmRole::LeftOutBend);
            let both: Vec<[f64; 2]> = films
                .filter_map(|film| {
                    let line = film.with_tilt[place].as_ref()?.mean_location_error_mm();
                    let without = film.baseline(Baseline::RotationPriorWithTilt)?;
                    Some([line, without.shape.mean_location_error_mm()])
                })
                .collect();
            let both_means = [0, 1].map(|i| mean(both.iter().map(|pair| pair[i])));
            (!both.is_empty()).then_some(both_means)
        };
        compared.iter().filter_map(of_patient).collect()
    };
    let mut lines = 0;
    for kind in LineKind::ALL {
        let found = errors(kind);
        if found.is_empty() {
            continue;
        }
        let [line, without] = [0, 1].map(|i| mean(found.iter().map(|pair| pair[i])));
        println!(
            "{kind}, {} patients: {line:.2} mm, without mechanics {without:.2} mm",
            found.len()
        );
        assert!(without < line, "{kind}: {line} mm, without mechanics {without} mm");
        lines += 1;
    }
    assert!(lines > 0, "no line predicts a bend");
    let all = compared.iter().flat_map(|found| &found.films);
    let all = all.filter_map(|film| film.baseline(Baseline::RotationPriorWithTilt));
    let mm = mean(all.map(|found| found.shape.mean_location_error_mm()));
    println!("without mechanics, on {} unseen patients: {mm:.2} mm", unseen.len());
    assert!(mm < 2.5, "{mm}");
}
