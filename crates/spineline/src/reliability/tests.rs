//! Tables whose statistics are known from elsewhere: published, by hand, or by an identity of algebra.

use super::*;
use crate::anatomy::{Level, Posture};
use crate::measure::{FilmReadings, Placement, ProgramNoise, Reading, ReadingId};
use crate::spatial::{Angle, Frontal};

/// Table 2 of [shrout-fleiss-1979]: six targets, four judges.
const SHROUT_FLEISS: [[f64; 4]; 6] = [
    [9.0, 2.0, 5.0, 8.0],
    [6.0, 1.0, 3.0, 2.0],
    [8.0, 4.0, 6.0, 8.0],
    [7.0, 1.0, 2.0, 6.0],
    [10.0, 5.0, 6.0, 9.0],
    [6.0, 2.0, 4.0, 7.0],
];

/// One reading by each observer, who are A, B, C….
fn table<const K: usize>(rows: &[[f64; K]]) -> RatedQuantity {
    let mut quantity = RatedQuantity::new("score", "points", "a table of a test");
    for (i, row) in rows.iter().enumerate() {
        for (j, value) in row.iter().enumerate() {
            let observer = char::from(b'A' + j as u8).to_string();
            assert!(quantity.insert(&format!("{i:03}"), &observer, 1, *value));
        }
    }
    quantity
}

/// The comparison between observers, which is the first.
fn between<const K: usize>(rows: &[[f64; K]]) -> DesignReliability {
    assess(&table(rows)).designs.swap_remove(0)
}

fn value(found: &DesignReliability, kind: StatisticKind) -> f64 {
    found.statistic(kind).expect("a value").value
}

fn interval(found: &DesignReliability, kind: StatisticKind) -> [f64; 2] {
    found.statistic(kind).expect("a value").interval.expect("an interval")
}

fn close(found: f64, right: f64, tolerance: f64) {
    assert!((found - right).abs() <= tolerance, "{found} should be {right}");
}

const ICC: [StatisticKind; 3] =
    [StatisticKind::IccAgreement, StatisticKind::IccConsistency, StatisticKind::IccAverage];
const SEM: [StatisticKind; 2] = [StatisticKind::SemAgreement, StatisticKind::SemConsistency];

#[test]
fn the_table_of_shrout_and_fleiss_has_its_published_values() {
    let found = between(&SHROUT_FLEISS);
    for (kind, published) in ICC.into_iter().zip([0.29, 0.71, 0.62]) {
        close(value(&found, kind), published, 0.005);
    }
    // Mean squares of the paper's table 3: 11.24 between targets, 32.49 between judges, 1.02 left.
    close(value(&found, SEM[1]), 1.02_f64.sqrt(), 0.003);
    close(value(&found, SEM[0]), (1.02 + (32.49 - 1.02) / 6.0_f64).sqrt(), 0.003);
    // Intervals as other packages print them for this table (irr, psych, pingouin).
    for (kind, printed) in ICC.into_iter().zip([[0.02, 0.76], [0.34, 0.95], [0.07, 0.93]]) {
        let [low, high] = interval(&found, kind);
        close(low, printed[0], 0.005);
        close(high, printed[1], 0.005);
    }
    assert_eq!((found.subjects, found.raters.len(), &found.repeats[..]), (6, 4, &[1, 1, 1, 1][..]));
}

#[test]
fn the_error_of_scatter_is_half_the_variance_of_differences() {
    // For every pair of raters, averaged over the pairs: an identity of the two-way table.
    let found = between(&SHROUT_FLEISS);
    let halves: Vec<f64> = found.bland_altman.iter().map(|pair| 0.5 * pair.sd.powi(2)).collect();
    assert_eq!(halves.len(), 6);
    close(value(&found, SEM[1]).powi(2), halves.iter().sum::<f64>() / 6.0, 1e-12);
    // And two readings differ by at most MDC95 in 19 of 20 cases.
    let mdc = value(&found, StatisticKind::Mdc95Consistency);
    close(mdc, 1.96 * 2.0_f64.sqrt() * value(&found, SEM[1]), 1e-4);
}

#[test]
fn limits_of_agreement_equal_the_textbooks() {
    // Differences 1, 2, 3: bias 2, deviation 1, t(0.975, 2) = 4.302653.
    let found = between(&[[0.0, 1.0], [5.0, 7.0], [8.0, 11.0]]);
    let pair = &found.bland_altman[0];
    assert_eq!((pair.bias, pair.sd), (2.0, 1.0));
    close(pair.limits[0], 2.0 - 1.959964, 1e-6);
    let half = 4.302_653 / 3.0_f64.sqrt();
    close(pair.bias_interval.expect("spread")[1], 2.0 + half, 1e-6);
    let upper = pair.limit_intervals.expect("spread")[1];
    close(upper[0], pair.limits[1] - 3.0_f64.sqrt() * half, 1e-6);
    assert_eq!(pair.points[1], [6.0, 2.0]);
}

#[test]
fn a_constant_added_to_all_readings_changes_no_coefficient_and_no_error() {
    let (plain, moved) =
        (between(&SHROUT_FLEISS), between(&SHROUT_FLEISS.map(|row| row.map(|x| 2.0 * x + 40.0))));
    for kind in StatisticKind::ALL {
        let factor = if kind.has_unit() { 2.0 } else { 1.0 };
        close(value(&moved, kind), factor * value(&plain, kind), 1e-12);
    }
}

#[test]
fn one_observer_and_one_repeat_are_reasons_and_no_numbers() {
    // F27.
    let found = assess(&table(&[[1.0], [2.0], [4.0]]));
    assert_eq!(found.designs.len(), 2);
    for (design, reason) in found.designs.iter().zip([Undefined::OneObserver, Undefined::OneRepeat])
    {
        assert!(design.statistics.iter().all(|statistic| statistic.outcome == Err(reason)));
        assert!(design.bland_altman.is_empty() && design.remarks.is_empty());
    }
}

#[test]
fn subjects_with_a_gap_are_left_out_and_counted() {
    // F27, F50: the table without the gappy subject is the one of Shrout and Fleiss.
    let mut quantity = table(&SHROUT_FLEISS);
    assert!(quantity.insert("999", "A", 1, 1e6));
    let found = &assess(&quantity).designs[0];
    assert_eq!((found.subjects, found.dropped), (6, 1));
    let dropped = Remark::Dropped { dropped: 1, subjects: 7, first: vec!["999".to_owned()] };
    assert!(dropped.to_string().ends_with("and are left out: 999"), "{dropped}");
    assert_eq!(found.remarks, [dropped]);
    let whole = between(&SHROUT_FLEISS);
    assert_eq!(found.statistics, whole.statistics);
    // No subject that all have read.
    let mut apart = RatedQuantity::new("score", "points", "");
    assert!(apart.insert("1", "A", 1, 1.0) && apart.insert("2", "B", 1, 2.0));
    let reason = Undefined::MissingCells { complete: 0, subjects: 2 };
    assert!(assess(&apart).designs[0].statistics.iter().all(|s| s.outcome == Err(reason)));
}

#[test]
fn a_cell_that_is_filled_keeps_its_first_value() {
    let mut quantity = table(&SHROUT_FLEISS);
    assert!(!quantity.insert("000", "A", 1, 77.0));
    assert_eq!(quantity, table(&SHROUT_FLEISS));
}

#[test]
fn ties_everywhere_have_no_coefficient_and_no_error() {
    // F27, F50. Not representable exactly, so that rounding would show.
    let found = between(&[[0.1, 0.1, 0.1]; 7]);
    for kind in ICC.into_iter().chain([StatisticKind::Pearson]) {
        assert_eq!(found.statistic(kind), Err(Undefined::ZeroVariance), "{kind:?}");
    }
    for kind in SEM {
        let sem = found.statistic(kind).expect("a value");
        assert_eq!((sem.value, sem.interval), (0.0, Err(Undefined::ZeroVariance)));
    }
    assert_eq!(found.remarks, [Remark::PerfectAgreement]);
}

#[test]
fn perfect_agreement_is_one_and_says_that_the_error_is_unknown() {
    // F50. Thirds are not representable either.
    let found = between(&[1.0, 2.0, 4.0, 7.0].map(|x: f64| [x / 3.0; 3]));
    for kind in ICC {
        assert_eq!((value(&found, kind), interval(&found, kind)), (1.0, [1.0, 1.0]));
    }
    close(value(&found, StatisticKind::Pearson), 1.0, 1e-15);
    assert!(found.remarks.contains(&Remark::PerfectAgreement));
}

#[test]
fn a_constant_offset_leaves_consistency_whole_and_costs_agreement() {
    let rows = [1.0, 2.0, 4.0, 8.0].map(|x| [x, x + 2.0]);
    let found = between(&rows);
    close(value(&found, ICC[1]), 1.0, 1e-15);
    close(value(&found, StatisticKind::Pearson), 1.0, 1e-15);
    // Subjects' variance 9.5833 and raters' variance 2, by hand.
    let subjects = [1.0, 2.0, 4.0, 8.0].iter().map(|x| (x - 3.75_f64).powi(2)).sum::<f64>() / 3.0;
    close(value(&found, ICC[0]), subjects / (subjects + 2.0), 1e-14);
    close(value(&found, SEM[0]), 2.0_f64.sqrt(), 1e-14);
    assert_eq!(value(&found, SEM[1]), 0.0);
}

#[test]
fn agreement_is_never_better_than_consistency() {
    // Readers without an offset: MSC 0.004, MSE 3.3965, by hand.
    let found = between(&[[32.5, 34.9], [44.2, 46.5], [39.8, 38.6], [42.0, 42.5], [53.2, 49.4]]);
    close(value(&found, SEM[0]), 3.3965_f64.sqrt(), 1e-9);
    close(value(&found, StatisticKind::Mdc95Agreement), 5.11, 0.005);
    assert_eq!(found.statistic(SEM[0]), found.statistic(SEM[1]), "interval too");
    assert!(found.remarks.contains(&Remark::NoRaterVariance));
    // The published formula, which other programs print: 0.9388994.
    close(value(&found, ICC[0]), 0.938_899_4, 1e-7);
    // Exchanging two readings leaves both means alike.
    let same_means = between(&[[1.0, 2.0], [4.0, 3.0], [5.0, 5.5], [9.0, 8.5]]);
    for found in [found, same_means, between(&SHROUT_FLEISS)] {
        for [agreement, consistency] in
            [SEM, [StatisticKind::Mdc95Agreement, StatisticKind::Mdc95Consistency]]
        {
            assert!(value(&found, agreement) >= value(&found, consistency));
        }
    }
    assert!(!between(&SHROUT_FLEISS).remarks.contains(&Remark::NoRaterVariance));
}

#[test]
fn names_that_differ_by_capitals_are_observers_with_a_remark() {
    let mut quantity = RatedQuantity::new("score", "points", "");
    for i in 0..4 {
        for (observer, repeat) in [("A", 1), ("B", 1), ("b", 1)] {
            assert!(quantity.insert(&i.to_string(), observer, repeat, f64::from(i) + 0.1));
        }
    }
    let found = assess(&quantity);
    let alike = Remark::AlikeNames { names: vec!["B".to_owned(), "b".to_owned()] };
    assert_eq!(found.designs[0].raters, ["A", "B", "b"]);
    assert!(found.designs[0].remarks.contains(&alike));
    assert!(alike.to_string().contains("`B` and `b` count as 2 observers"), "{alike}");
    assert!(!found.designs[1].remarks.contains(&alike), "within A");
    assert!(!between(&SHROUT_FLEISS).remarks.iter().any(|r| r.key() == "observers_alike"));
}

#[test]
fn names_that_differ_by_capitals_are_subjects_with_a_remark() {
    let mut quantity = RatedQuantity::new("score", "points", "");
    for (subject, observer) in [("s1", "A"), ("S1", "B"), ("s2", "A"), ("s2", "B")] {
        assert!(quantity.insert(subject, observer, 1, 1.0));
    }
    let remarks = &assess(&quantity).designs[0].remarks;
    let alike = remarks.iter().find(|remark| remark.key() == "subjects_alike").expect("alike");
    assert!(alike.to_string().contains("marks alone: S1 and s1;"), "{alike}");
    let first = vec!["S1".to_owned(), "s1".to_owned()];
    assert!(remarks.contains(&Remark::Dropped { dropped: 2, subjects: 3, first }), "{remarks:?}");
}

#[test]
fn one_and_two_subjects_say_what_is_missing() {
    // F50.
    let one = between(&[[1.0, 2.0]]);
    let few = Undefined::TooFewSubjects { n: 1, least: 2 };
    assert!(one.statistics.iter().all(|statistic| statistic.outcome == Err(few)));
    let two = between(&[[1.0, 2.0], [5.0, 5.5]]);
    let few = Undefined::TooFewSubjects { n: 2, least: 3 };
    assert_eq!(two.statistic(StatisticKind::Pearson), Err(few), "two points lie on a line");
    // (MSR - MSE)/(MSR + MSE) with row means 1.5, 5.25 and differences 1, 0.5: MSR 14.0625, MSE 0.0625.
    close(value(&two, ICC[1]), 14.0 / 14.125, 1e-14);
    assert_eq!(two.remarks, [Remark::TwoSubjects]);
}

#[test]
fn negative_coefficients_are_shown_as_they_are_and_nonsense_is_not() {
    let found = between(&[[1.0, 9.0], [9.0, 2.0], [2.0, 8.0], [8.0, 1.5]]);
    assert!(value(&found, ICC[1]) < -0.9);
    assert!(found.remarks.contains(&Remark::NegativeIcc));
    // MSR + (MSC - MSE)/n is below zero: the formula would give a coefficient above one.
    assert_eq!(found.statistic(ICC[2]), Err(Undefined::VarianceNotPositive));
    // Exchanged readings: no variance between subjects or raters at all.
    let exchanged = between(&[[1.0, 2.0], [2.0, 1.0]]);
    assert_eq!(exchanged.statistic(ICC[0]), Err(Undefined::VarianceNotPositive));
    close(value(&exchanged, ICC[1]), -1.0, 1e-15);
}

#[test]
fn numbers_that_cannot_be_squared_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let found = between(&[[1.0, 2.0], [bad, 3.0], [4.0, 4.0]]);
        for statistic in &found.statistics {
            assert!(statistic.outcome.is_err(), "{:?} of {bad}", statistic.kind);
        }
        assert!(found.bland_altman.is_empty(), "{bad}");
    }
}

#[test]
fn observers_are_compared_by_their_means_and_by_their_first_reading() {
    let mut quantity = RatedQuantity::new("score", "points", "");
    let values = [[1.0, 3.0, 2.0, 4.0], [5.0, 5.0, 6.0, 8.0], [9.0, 7.0, 8.0, 8.0]];
    for (i, [a1, a2, b1, b2]) in values.into_iter().enumerate() {
        for (observer, repeat, value) in [("A", 1, a1), ("A", 2, a2), ("B", 1, b1), ("B", 2, b2)] {
            assert!(quantity.insert(&i.to_string(), observer, repeat, value));
        }
    }
    let found = assess(&quantity);
    let keys: Vec<&str> = found.designs.iter().map(|design| design.design.key()).collect();
    let [means, single, intra] =
        ["inter_observer_means", "inter_observer_single", "intra_observer"];
    assert_eq!(keys, [means, single, intra, intra]);
    assert_eq!(found.designs[0].bland_altman[0].points[0], [2.5, 1.0]);
    assert_eq!(found.designs[0].repeats, [2, 2]);
    assert!(found.designs[0].remarks.contains(&Remark::MeansAreSteadier));
    assert_eq!(found.designs[1].bland_altman[0].points[0], [1.5, 1.0]);
    assert_eq!(found.designs[2].raters, ["A, repeat 1", "A, repeat 2"]);
    assert_eq!(found.designs[2].bland_altman[0].points[2], [8.0, -2.0]);
    // Pearson by hand: A's repeats 1, 5, 9 and 3, 5, 7 lie on a line.
    close(value(&found.designs[2], StatisticKind::Pearson), 1.0, 1e-15);
}

#[test]
fn an_observer_with_fewer_repeats_is_compared_and_remarked() {
    // F50, unbalanced.
    let mut quantity = RatedQuantity::new("score", "points", "");
    for i in 0..5 {
        let x = f64::from(i);
        let subject = i.to_string();
        assert!(quantity.insert(&subject, "A", 1, x) && quantity.insert(&subject, "A", 2, x + 0.2));
        assert!(quantity.insert(&subject, "B", 2, x + 0.1 + 0.05 * x * x));
    }
    let found = assess(&quantity);
    assert!(found.designs[0].remarks.contains(&Remark::UnequalRepeats { repeats: [1, 2] }));
    assert_eq!(found.designs[1].design, Design::InterObserverSingle { repeat: 2 });
    assert_eq!(found.designs[1].subjects, 5);
    assert_eq!(found.designs[3].statistic(ICC[0]), Err(Undefined::OneRepeat));
}

/// One vertebra after the other, read by two observers with the same values.
fn film(program: Option<ProgramNoise>) -> FilmReadings {
    let readings = ["A", "B"].map(|observer| {
        let vertebrae = Level::MODEL.into_iter().enumerate().map(|(i, level)| {
            let location = Frontal::new((i * i) as f64, 25.0 * i as f64);
            (level, Placement { program, ..Placement::new(location, Angle::from_deg(i as f64)) })
        });
        Reading { id: ReadingId::new(observer, 1), vertebrae: vertebrae.collect() }
    });
    let (posture, length_unit) = (Posture::Erect, "mm".to_owned());
    FilmReadings { posture, length_unit, readings: readings.to_vec(), copied: Vec::new() }
}

#[test]
fn films_in_pixels_count_in_angles_and_not_beside_millimetres() {
    let of =
        |posture, unit: &str| FilmReadings { posture, length_unit: unit.to_owned(), ..film(None) };
    let (erect, bend) = (of(Posture::Erect, "mm"), of(Posture::LeftBending, "pixels"));
    let assessed = |films: &[FilmReadings]| {
        let found = film_quantities(&[("P1", films)]).iter().map(assess).collect::<Vec<_>>();
        ["spacing", "tilt_step"].map(|key| {
            let one = found.iter().find(|one| one.key == key).expect("a quantity").clone();
            (one.unit, one.designs[0].subjects, one.designs[0].remarks.clone())
        })
    };
    let in_pixels = Remark::InPixels { films: vec!["P1 (left bending)".to_owned()] };
    let [(unit, subjects, remarks), (_, tilts, of_tilts)] = assessed(&[erect, bend.clone()]);
    assert_eq!((&unit[..], subjects, tilts), ("mm", 14, 28));
    assert!(remarks.contains(&in_pixels) && !of_tilts.contains(&in_pixels));
    let text = in_pixels.to_string();
    assert_eq!(text, "1 film in pixels left out of lengths: P1 (left bending)");
    let [(unit, subjects, remarks), _] = assessed(&[bend]);
    assert_eq!((&unit[..], subjects), ("pixels", 14));
    assert!(!remarks.iter().any(|remark| matches!(remark, Remark::InPixels { .. })));
}

#[test]
fn copied_readings_are_named_and_left_out() {
    let mut one = film(None);
    one.readings.truncate(1);
    one.copied = vec![ReadingId::new("B", 1)];
    // A case that is given twice names its copies once.
    let films = [one];
    let found = film_quantities(&[("P1", &films), ("P1", &films)]);
    for quantity in found.iter().map(assess) {
        for design in &quantity.designs {
            let copied = Remark::Copied { readings: vec!["P1 (erect), B (repeat 1)".to_owned()] };
            assert!(design.remarks.contains(&copied), "{:?}", design.remarks);
            assert!(design.statistics.iter().all(|one| one.outcome.is_err()));
        }
    }
}

#[test]
fn unreviewed_corners_of_a_program_are_not_agreement() {
    let noise = ProgramNoise {
        location_mm: 1.0,
        tilt: Angle::from_deg(1.0),
        placed_share: 0.0,
        placed_tilt_share: 0.0,
        is_reviewed: false,
    };
    let assessed = |film: FilmReadings| {
        film_quantities(&[("P1", &[film])]).iter().map(assess).collect::<Vec<_>>()
    };
    for quantity in assessed(film(Some(noise))) {
        for design in quantity.designs {
            assert_eq!(design.subjects, 0);
            assert!(design.remarks.contains(&Remark::NotReviewed { readings: 30 }));
        }
    }
    let accepted = ProgramNoise { is_reviewed: true, ..noise };
    for quantity in assessed(film(Some(accepted))) {
        assert!(quantity.designs[0].subjects > 0);
        assert!(quantity.designs[0].remarks.contains(&Remark::Accepted { readings: 30 }));
    }
    for quantity in assessed(film(None)) {
        let told = |remark: &Remark| {
            matches!(remark, Remark::Accepted { .. } | Remark::NotReviewed { .. })
        };
        assert!(!quantity.designs.iter().any(|design| design.remarks.iter().any(told)));
    }
}
