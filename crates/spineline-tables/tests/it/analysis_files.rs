//! The text of `analyze --csv`, `--chain` and `--cohort` and of `reliability --csv`, line by line beside the analysis.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::Posture;
use spineline::cohort::{Cohort, CohortPatient, ErrorKind};
use spineline::measure::FilmLandmarks;
use spineline::reliability::{
    BlandAltman, Design, DesignReliability, QuantityReliability, Statistic, StatisticEstimate,
    StatisticKind, Undefined,
};
use spineline_phantom::{Readers, Scenario, generate};
use spineline_tables::{chain_table, cohort_tests_table, errors_table, statistics_table};

fn case(subject: usize) -> Case {
    generate(subject, Scenario::Bend, &Readers::default(), 5).expect("a subject").case
}

fn analyzed(case: &Case) -> Analysis {
    analyze(case, &AnalysisOptions::default()).expect("a phantom")
}

/// A patient whose films lack a spacing, so that models are missing, and with a name that needs quotes.
fn in_pixels() -> Analysis {
    let mut case = Case { id: "a,b".to_owned(), ..case(3) };
    for film in &mut case.films {
        match &mut film.landmarks {
            FilmLandmarks::Corners { image, .. } => image.spacing = None,
            FilmLandmarks::Placements { .. } => panic!("phantoms have landmarks"),
        }
    }
    analyzed(&case)
}

#[test]
fn segments_of_every_chain() {
    let analyses = [analyzed(&case(2)), in_pixels()];
    let text = chain_table(&analyses).to_csv().expect("a table");
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some(
            "case_id,synthetic,posture,segment,a_mm,alpha_deg,d_mm,theta_deg,joint_y_mm,joint_z_mm,lengths,refused"
        )
    );
    for (analysis, name) in analyses.iter().zip(["phantom-bend-03", "\"a,b\""]) {
        for posture in &analysis.movement.films {
            let film = posture.outline.posture.key();
            for (segment, theta) in posture.pose.joint_angles.iter().enumerate() {
                let (length, joint) =
                    (analysis.movement.chain.segment_mm, posture.pose.joints[segment]);
                let expected = if name == "\"a,b\"" {
                    format!("{name},true,{film},{segment},,0,,{:.9},,,pixels,", theta.deg())
                } else {
                    format!(
                        "{name},true,{film},{segment},{length:.9},0,0,{:.9},{:.6},{:.6},patient,",
                        theta.deg(),
                        joint.y_mm,
                        joint.z_mm
                    )
                };
                assert_eq!(lines.next(), Some(&expected[..]));
            }
        }
    }
    assert_eq!(lines.next(), None);
}

const ERRORS_HEADING: &str = "case_id,synthetic,posture,level,measured_y_mm,measured_z_mm,measured_tilt_deg,\
    line,fitted,status,simulated_y_mm,simulated_z_mm,simulated_tilt_deg,location_error_mm,lengths,interpolated,refused";

#[test]
fn vertebrae_under_every_line() {
    let analysis = analyzed(&case(2));
    let text = errors_table(std::slice::from_ref(&analysis)).to_csv().expect("a table");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(ERRORS_HEADING));
    for posture in &analysis.movement.films {
        let film = posture.outline.posture;
        for (i, vertebra) in posture.outline.vertebrae.iter().enumerate() {
            let measured = format!(
                "phantom-bend-03,true,{},{},{:.4},{:.4},{:.4}",
                film.key(),
                vertebra.level,
                vertebra.location.y_mm,
                vertebra.location.z_mm,
                vertebra.tilt.deg()
            );
            if film == Posture::Erect {
                assert_eq!(lines.next(), Some(&format!("{measured},,,,,,,,patient,false,")[..]));
                continue;
            }
            for model in &analysis.models {
                let found = model.simulation(film).expect("every model has every film");
                let error = found.shape.location_error_mm(vertebra.level);
                let error = error.filter(|_| found.is_usable()).map(|error| format!("{error:.4}"));
                let expected = format!(
                    "{measured},{},{},{},{:.4},{:.4},{:.4},{},patient,false,",
                    model.kind.key(),
                    found.fitted,
                    found.status.key(),
                    found.shape.locations[i].y_mm,
                    found.shape.locations[i].z_mm,
                    found.tilts[i].deg(),
                    error.unwrap_or_default()
                );
                assert_eq!(lines.next(), Some(&expected[..]));
            }
        }
    }
    assert_eq!(lines.next(), None);
}

#[test]
fn vertebrae_in_pixels_have_no_lengths() {
    let analysis = in_pixels();
    let text = errors_table(std::slice::from_ref(&analysis)).to_csv().expect("a table");
    let first = &analysis.movement.films[0].outline;
    let expected = format!(
        "\"a,b\",true,{},{},,,{:.4},,,,,,,,pixels,false,",
        first.posture.key(),
        first.vertebrae[0].level,
        first.vertebrae[0].tilt.deg()
    );
    assert_eq!(text.lines().nth(1), Some(&expected[..]));
    assert_eq!(text.lines().count(), 1 + 15 * analysis.movement.films.len());
}

const TESTS_HEADING: &str = "first_line,second_line,synthetic,films,error,unit,patients,films_compared,\
    films_not_compared,mean_difference,interval_95_low,interval_95_high,effect_d,effect_95_low,\
    effect_95_high,sign_flip_p,holm_p,patient_t_p,pooled_t_p,predicts_better";

#[test]
fn tests_of_a_cohort() {
    let analyses = [1, 2, 3].map(|subject| analyzed(&case(subject)));
    let cohort = Cohort::of(&analyses.iter().map(CohortPatient::of).collect::<Vec<_>>(), 1);
    let text = cohort_tests_table(&cohort).to_csv().expect("a table");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(TESTS_HEADING));
    let shown = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for test in &cohort.compared.tests {
        let found = &test.comparison;
        let numbers = [
            Some(found.mean_difference).filter(|mean| mean.is_finite()),
            found.bootstrap.map(|ends| ends[0]),
            found.bootstrap.map(|ends| ends[1]),
            found.effect.map(|effect| effect.d),
            found.effect.map(|effect| effect.interval[0]).filter(|end| end.is_finite()),
            found.effect.map(|effect| effect.interval[1]).filter(|end| end.is_finite()),
            found.sign_flip.map(|test| test.p_two_sided),
            test.holm_p,
            found.patients.map(|test| test.p_two_sided),
            found.pooled.map(|test| test.p_two_sided),
        ];
        let expected = format!(
            "{},{},true,{},{},{},{},{},{},{},{}",
            test.lines[0].key(),
            test.lines[1].key(),
            test.role.key(),
            test.error.key(),
            if test.error == ErrorKind::Location { "mm" } else { "deg" },
            found.patients(),
            test.films,
            test.without_result,
            numbers.map(shown).join(","),
            test.predicts_better().map_or("", LineKind::key)
        );
        assert_eq!(lines.next(), Some(&expected[..]));
    }
    assert!(!cohort.baselines.tests.is_empty());
    for test in &cohort.baselines.tests {
        let found = &test.comparison;
        let start = format!(
            "{},{},true,{},location_mm,mm,{},{},,{},",
            test.predictor().key(),
            test.baseline.key(),
            test.role.key(),
            found.patients(),
            test.films,
            found.mean_difference
        );
        let line = lines.next().expect("a line against a prediction without mechanics");
        assert!(line.starts_with(&start), "{line} and {start}");
        // Three patients cannot reach 0.05.
        assert!(line.ends_with(','), "{line}");
    }
    assert_eq!(lines.next(), None);
}

#[test]
fn statistics_of_readings() {
    let statistic = |kind, outcome| Statistic { kind, outcome };
    let estimate = |value, sd, interval| StatisticEstimate { value, sd, interval };
    let pair = BlandAltman {
        raters: ["A".to_owned(), "B, junior".to_owned()],
        points: Vec::new(),
        bias: 0.5,
        sd: 0.25,
        limits: [0.01, 0.99],
        bias_interval: Ok([-0.5, 1.5]),
        limit_intervals: Err(Undefined::NoInterval),
    };
    let between = DesignReliability {
        design: Design::InterObserverMeans,
        raters: pair.raters.to_vec(),
        subjects: 12,
        dropped: 1,
        repeats: vec![3, 2],
        statistics: vec![
            statistic(StatisticKind::SemAgreement, Ok(estimate(1.5e-7, None, Ok([0.125, 2.0])))),
            statistic(
                StatisticKind::IccAgreement,
                Ok(estimate(0.75, Some(0.0625), Err(Undefined::NoInterval))),
            ),
        ],
        bland_altman: vec![pair],
        remarks: Vec::new(),
    };
    let within = DesignReliability {
        design: Design::IntraObserver { observer: "A".to_owned() },
        raters: vec!["repeat 1".to_owned()],
        repeats: vec![1],
        statistics: vec![statistic(StatisticKind::Pearson, Err(Undefined::OneRepeat))],
        bland_altman: Vec::new(),
        ..between.clone()
    };
    let found = QuantityReliability {
        key: "tilt".to_owned(),
        unit: "deg".to_owned(),
        meaning: String::new(),
        designs: vec![between, within],
    };
    let start = "false,tilt,inter_observer_means,,2,3 2,12,1";
    let icc = StatisticKind::IccAgreement;
    let expected = format!(
        "synthetic,quantity,design,observer,raters,repeats,subjects,dropped,statistic,name,value,sd,\
         ci95_low,ci95_high,unit,undefined\n\
         {start},sem_agreement,\"SEM, agreement\",0.00000015,,0.125,2,deg,\n\
         {start},icc_2_1,\"{icc}\",0.75,0.0625,,,,\n\
         {start},bland_altman_bias,\"B, junior minus A\",0.5,0.25,-0.5,1.5,deg,\n\
         {start},bland_altman_lower_limit,\"B, junior minus A\",0.01,,,,deg,\n\
         {start},bland_altman_upper_limit,\"B, junior minus A\",0.99,,,,deg,\n\
         false,tilt,intra_observer,A,1,1,12,1,pearson,\"{}\",,,,,,one_repeat\n",
        StatisticKind::Pearson
    );
    assert_eq!(statistics_table(&[found], false).to_csv().expect("a table"), expected);
}
