//! Predictions without mechanics over patients: a patient's own films are not in the pattern for that patient, and the
//! loads that moved the spines beat such patterns.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, FilmRole, analyze};
use spineline::anatomy::{Posture, Side};
use spineline::cohort::{BaselinesOverPatients, Cohort, CohortPatient, ComparisonOutcome};
use spineline::evaluate::statistics::Summary;
use spineline::evaluate::{Baseline, joint_rotations, predict_baseline};
use spineline::hypothesis::{Hypothesis, LoadShape, Role};
use spineline::spatial::Angle;
use spineline_phantom::{Readers, Scenario, generate};

fn analyzed(subject: usize, scenario: Scenario) -> Analysis {
    let case = generate(subject, scenario, &Readers::default(), 1).expect("a phantom").case;
    analyze(&case, &AnalysisOptions::default()).expect("a sound case")
}

/// The mean of a patient's two bends, as if both were to the right.
fn mean_bend(patient: &Analysis) -> Vec<Angle> {
    let erect = &patient.movement.erect().outline;
    let bends: Vec<(f64, Vec<Angle>)> = patient
        .movement
        .films
        .iter()
        .filter_map(|posture| {
            let sign = if posture.outline.posture.bend()? == Side::Right { 1.0 } else { -1.0 };
            Some((sign, joint_rotations(erect, &posture.outline)))
        })
        .collect();
    assert_eq!(bends.len(), 2);
    (0..14)
        .map(|joint| bends.iter().map(move |(sign, bend)| bend[joint] * (0.5 * sign)))
        .map(|mut parts| parts.next().expect("a bend") + parts.next().expect("a bend"))
        .collect()
}

#[test]
fn a_patient_is_predicted_from_the_other_patients_alone() {
    let both = [analyzed(2, Scenario::Pull), analyzed(4, Scenario::Bend)];
    let cohort = Cohort::of(&both.each_ref().map(CohortPatient::of), 1);
    let of = |role: FilmRole, films: &[Posture]| {
        let mut errors = cohort.baselines.errors.iter();
        let errors =
            errors.find(|errors| errors.by == Baseline::OtherPatients && errors.role == role);
        let found = errors.expect("such films").location_mm;
        let expected = [0, 1].map(|patient: usize| {
            let (own, pattern) = (&both[patient], mean_bend(&both[1 - patient]));
            let predicted = |&film: &Posture| {
                let film = &own.movement.film(film).expect("a film").outline;
                let erect = &own.movement.erect().outline;
                predict_baseline(Baseline::OtherPatients, &pattern, erect, film)
                    .shape
                    .location_errors_mm
            };
            Summary::of(&films.iter().flat_map(predicted).collect::<Vec<f64>>())
        });
        let means = Summary::of(&expected.map(|own| own.mean));
        for (found, expected) in
            [(found.patients, means), (found.pooled, Summary::pooled(&expected))]
        {
            assert_eq!(found.n, expected.n);
            let off = (found.mean - expected.mean).abs().max((found.sd - expected.sd).abs());
            assert!(off < 1e-9, "{role}: {found:?} and {expected:?}");
        }
    };
    of(FilmRole::LeftOutBend, &[Posture::LeftBending, Posture::RightBending]);
    of(FilmRole::HeldOut, &[Posture::Neutral, Posture::Traction]);
}

#[test]
fn the_load_that_moved_the_spines_beats_patterns_without_mechanics() {
    let patients: Vec<Analysis> =
        [0, 2, 4, 6, 8, 10, 12, 14].map(|subject| analyzed(subject, Scenario::Pull)).into();
    let cohort = Cohort::of(&patients.iter().map(CohortPatient::of).collect::<Vec<_>>(), 1);
    let test = |line, baseline| {
        let mut tests = cohort.baselines.tests.iter();
        let found = tests.find(|test| {
            test.model == line && test.baseline == baseline && test.role == FilmRole::LeftOutBend
        });
        found.expect("eight patients with two bends")
    };
    let published = test(LineKind::Iliac, Baseline::PublishedMobility);
    assert_eq!((published.films, published.comparison.patients()), (16, 8));
    assert!(published.comparison.mean_difference < -0.5, "{published:?}");
    // The wrong line does not beat it.
    let wrong = test(LineKind::Inflection, Baseline::MirroredBend);
    assert!(!wrong.is_better(), "{wrong:?}");
    assert!(cohort.verdict().iter().any(|text| text.contains("without mechanics")));
}

#[test]
fn other_loads_are_tested_against_no_mechanics_by_one_difference_per_patient() {
    // Oracle: the mean over patients of each patient's difference, from predictions and baselines film by film.
    let hypotheses = [LoadShape::IliacLine, LoadShape::Couple].map(Hypothesis::of);
    let patients: Vec<Analysis> = [0, 2, 4, 8]
        .map(|subject| {
            let phantom =
                generate(subject, Scenario::Pull, &Readers::exact(), 1).expect("a phantom");
            let options =
                AnalysisOptions { hypotheses: hypotheses.to_vec(), ..AnalysisOptions::default() };
            analyze(&phantom.case, &options).expect("a sound case")
        })
        .into();
    let cohort = Cohort::of(&patients.iter().map(CohortPatient::of).collect::<Vec<_>>(), 1);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    // A load knows T2's tilt where the baseline does.
    let equal = [(Baseline::MirroredBend, Role::LeftOut), (Baseline::Cubic, Role::LeftOutWithTilt)];
    for (hypothesis, (baseline, role)) in
        hypotheses.into_iter().flat_map(|one| equal.map(|two| (one, two)))
    {
        let mut differences = Vec::new();
        for patient in &patients {
            let fit = patient.hypotheses.iter().find(|fit| fit.hypothesis == hypothesis);
            let compared = patient.comparison();
            let (mut of_load, mut without) = (Vec::new(), Vec::new());
            for film in compared.films.iter().filter(|film| film.role == FilmRole::LeftOutBend) {
                let mut predictions = fit.expect("it was asked for").of_role(role);
                let prediction = predictions.find(|one| one.shape.posture == film.posture);
                let (Some(load), Some(pattern)) = (prediction, film.baseline(baseline)) else {
                    continue;
                };
                of_load.extend_from_slice(&load.shape.location_errors_mm);
                without.extend_from_slice(&pattern.shape.location_errors_mm);
            }
            differences.push(mean(&of_load) - mean(&without));
        }
        let mut tests = cohort.baselines.hypothesis_tests.iter();
        let test = tests.find(|test| {
            test.model == hypothesis
                && test.baseline == baseline
                && test.role == FilmRole::LeftOutBend
        });
        let test = test.expect("four patients with two bends");
        assert!((test.comparison.mean_difference - mean(&differences)).abs() < 1e-12);
        // Four patients have no interval, and cannot reach 0.05: they are not tested.
        assert!(test.comparison.is_compared(), "{test:?}");
        assert_eq!((test.comparison.bootstrap, test.holm_p), (None, None), "{test:?}");
        assert_eq!(test.outcome(), ComparisonOutcome::NotTested);
    }
    let verdict = cohort.verdict();
    let starts = |start: &str| verdict.iter().any(|sentence| sentence.starts_with(start));
    assert!(starts("Too few patients to test the lines against"), "{verdict:?}");
    assert!(!starts("There the ") && !starts("Other loads and bases"), "{verdict:?}");
    // One patient has the same differences, without an interval.
    let one = BaselinesOverPatients::of_patient(&patients[0]);
    assert!(!one.hypothesis_tests.is_empty());
    for test in &one.hypothesis_tests {
        assert_eq!((test.comparison.bootstrap, test.holm_p), (None, None), "{test:?}");
    }
}
