//! Distributions of joint rotations: how they are learned, and that predictions from them are the most probable ones.

use nalgebra::{DMatrix, DVector};
use spineline::anatomy::{Level, Levels, Posture};
use spineline::evaluate::{
    Baseline, BaselinePrediction, BendRotations, PriorSource, RotationPrior, RotationPriorError,
    predict_from_prior,
};
use spineline::measure::{FilmLength, Outline};
use spineline::spatial::Angle;

use crate::common::{assert_near, exact_case, measured, turned};

fn degrees(values: &[f64]) -> Vec<Angle> {
    values.iter().map(|&deg| Angle::from_deg(deg)).collect()
}

/// A film on which the joints turn by these degrees and all lengths are multiplied.
fn film_after(erect: &Outline, joints_deg: &[f64], scale: f64, posture: Posture) -> Outline {
    let mut tilts = vec![0.0];
    for joint in degrees(joints_deg) {
        tilts.push(tilts[tilts.len() - 1] + joint.rad());
    }
    let mut film = erect.clone();
    film.posture = posture;
    film.length = FilmLength { prior_log_sd: 0.033, ..FilmLength::ERECT };
    for ((vertebra, location), tilt) in
        film.vertebrae.iter_mut().zip(turned(erect, &tilts)).zip(&tilts)
    {
        vertebra.location = location * scale;
        vertebra.tilt = vertebra.tilt + Angle::from_rad(*tilt);
    }
    film
}

/// Rotations that vary smoothly along the spine.
fn smooth_prior() -> RotationPrior {
    let mean = (0..14).map(|joint| Angle::from_deg(4.0 - 0.2 * f64::from(joint))).collect();
    let covariance = DMatrix::from_fn(14, 14, |i, j| {
        let apart = i.abs_diff(j) as f64;
        Angle::from_deg(1.5).rad().powi(2) * (-apart / 3.0).exp()
    });
    let source = PriorSource::Learned { patients: 20, bends: 40, shrinkage: 0.1 };
    RotationPrior::new(Levels::COMPLETE, mean, covariance, source).expect("a covariance")
}

/// Twice the negative logarithm of the probability of rotations and scale, with T2 as it was marked.
fn improbability(
    prior: &RotationPrior,
    (erect, film): (&Outline, &Outline),
    (rotations, log_scale): (&[f64], f64),
    knows_tilt: bool,
) -> f64 {
    let mut tilts = vec![0.0];
    for joint in rotations {
        tilts.push(tilts[tilts.len() - 1] + joint);
    }
    let top = turned(erect, &tilts)[14] * log_scale.exp();
    let off = top - film.vertebrae[14].location;
    let mut sum = (off.y_mm.powi(2) + off.z_mm.powi(2)) / film.top_sd_mm().powi(2);
    sum += (log_scale / film.length.prior_log_sd).powi(2);
    let centred = DVector::from_iterator(
        14,
        rotations.iter().zip(prior.mean()).map(|(one, mean)| one - mean.rad()),
    );
    let inverse = prior.covariance_rad2().clone().try_inverse().expect("positive definite");
    sum += (centred.transpose() * inverse * &centred)[0];
    if knows_tilt {
        let turn = (film.vertebrae[14].tilt - erect.vertebrae[14].tilt).rad();
        let variance = 2.0 * (film.noise.tilt.rad().powi(2) + erect.noise.tilt.rad().powi(2));
        sum += (tilts[14] - turn).powi(2) / variance;
    }
    sum
}

#[test]
fn a_prediction_is_the_most_probable_one() {
    let erect = measured(&exact_case(1).films[0]);
    let truth: Vec<f64> = (0..14).map(|joint| 6.0 - 0.5 * f64::from(joint)).collect();
    let film = film_after(&erect, &truth, 1.02, Posture::RightBending);
    let prior = smooth_prior();
    for baseline in [Baseline::RotationPrior, Baseline::RotationPriorWithTilt] {
        let found = predict_from_prior(baseline, &prior, &erect, &film);
        assert!(found.is_usable() && found.amount.is_none());
        let rotations: Vec<f64> = found.rotations.iter().map(|joint| joint.rad()).collect();
        let at = |rotations: &[f64], log: f64| {
            improbability(&prior, (&erect, &film), (rotations, log), baseline.knows_tilt())
        };
        let log = found.shape.scale.factor.ln();
        let least = at(&rotations, log);
        for joint in 0..14 {
            for step in [1e-4, -1e-4] {
                let mut moved = rotations.clone();
                moved[joint] += step;
                assert!(at(&moved, log) > least, "{baseline}, joint {joint}");
            }
        }
        for step in [1e-5, -1e-5] {
            assert!(at(&rotations, log + step) > least, "{baseline}, scale");
        }
    }
}

#[test]
fn a_learned_distribution_has_one_name_and_the_published_one_another() {
    let [location, tilt, published] =
        [Baseline::RotationPrior, Baseline::LearnedWithTilt, Baseline::RotationPriorWithTilt]
            .map(Baseline::long_name);
    assert_eq!(location, "distribution learned from other patients");
    assert_eq!(tilt, format!("{location} with tilt"));
    assert_eq!(published, "distribution of rotations with tilt");
}

#[test]
fn the_tilt_of_t2_separates_rotation_from_scale() {
    let erect = measured(&exact_case(1).films[0]);
    // Less rotation than usual on a film that is shorter than usual.
    let truth: Vec<f64> = (0..14).map(|joint| 2.0 - 0.1 * f64::from(joint)).collect();
    let film = film_after(&erect, &truth, 0.95, Posture::RightBending);
    let of = |baseline| predict_from_prior(baseline, &smooth_prior(), &erect, &film);
    let turn = |found: &BaselinePrediction| found.rotations.iter().map(|r| r.deg()).sum::<f64>();
    let (without, with) = (of(Baseline::RotationPrior), of(Baseline::RotationPriorWithTilt));
    let expected: f64 = truth.iter().sum();
    let [off_with, off_without] = [&with, &without].map(|one| (turn(one) - expected).abs());
    assert!(off_with < 0.25 * off_without, "{off_with} and {off_without} degrees");
    assert!(with.shape.mean_location_error_mm() < without.shape.mean_location_error_mm());
}

#[test]
fn learned_means_are_mirrored_for_a_bend_to_the_left() {
    let erect = measured(&exact_case(1).films[0]);
    let joints: Vec<f64> = smooth_prior().mean().iter().map(|joint| -joint.deg()).collect();
    let film = film_after(&erect, &joints, 1.0, Posture::LeftBending);
    let found = predict_from_prior(Baseline::RotationPrior, &smooth_prior(), &erect, &film);
    for (found, expected) in found.rotations.iter().zip(&joints) {
        assert_near(found.deg(), *expected, 1e-6, "rotation in degrees");
    }
    assert_near(found.shape.scale.factor, 1.0, 1e-9, "scale");
}

#[test]
fn mean_covariance_and_shrinkage_follow_from_the_bends() {
    let levels = Levels::between(Level::L4, Level::L1).expect("four vertebrae");
    let bends = [
        [1.0, 2.0, 0.5],
        [2.0, 2.5, 1.5],
        [0.5, 1.0, -0.5],
        [3.0, 2.0, 1.0],
        [1.5, 3.5, 0.0],
        [2.5, 3.0, 2.0],
    ];
    // Straight on the erect film.
    let bend =
        |bend: &[f64; 3]| BendRotations { rotations: degrees(bend), erect: vec![Angle::ZERO; 3] };
    let mut patients: Vec<Vec<BendRotations>> =
        bends[..4].iter().map(|one| vec![bend(one)]).collect();
    patients.push(bends[4..].iter().map(bend).collect());
    patients.push(Vec::new());
    let prior = RotationPrior::learned(levels, &patients).expect("five patients");
    let PriorSource::Learned { patients: with_bend, bends: films, shrinkage } = prior.source()
    else {
        panic!("learned")
    };
    assert_eq!((with_bend, films), (5, 6));
    // From the definition, in Python.
    assert_near(shrinkage, 0.486_457_601_852_878_6, 1e-12, "shrinkage");
    for (mean, expected) in prior.mean().iter().zip([1.75, 7.0 / 3.0, 0.75]) {
        assert_near(mean.deg(), expected, 1e-12, "mean in degrees");
    }
    let square = Angle::from_deg(1.0).rad().powi(2);
    let deg2 = |i: usize, j: usize| prior.covariance_rad2()[(i, j)] / square;
    assert_near(deg2(0, 0), 0.875 + 0.25, 1e-9, "variance of a joint and of two tilts");
    assert_near(deg2(0, 1), 0.35 * (1.0 - shrinkage), 1e-9, "reduced covariance");
    assert_near(deg2(1, 0), deg2(0, 1), 0.0, "symmetry");

    let shrinkage_of = |repeats: usize| {
        let patients: Vec<_> = bends.iter().map(|one| vec![bend(one); repeats]).collect();
        match RotationPrior::learned(levels, &patients).expect("six patients").source() {
            PriorSource::Learned { shrinkage, .. } => shrinkage,
            PriorSource::Published => panic!("learned"),
        }
    };
    // The bends as of six patients, from the definition; a second bend that repeats the first one is not more evidence.
    assert_near(shrinkage_of(1), 0.597_642_015_005_359_2, 1e-12, "shrinkage");
    assert_near(shrinkage_of(2), shrinkage_of(1), 1e-12, "shrinkage with repeated bends");

    let too_few = RotationPrior::learned(levels, &patients[..4]).expect_err("four patients");
    assert_eq!(too_few, RotationPriorError::TooFewPatients { patients: 4, needed: 5 });
}

#[test]
fn fewer_vertebrae_have_the_part_of_the_distribution_that_is_theirs() {
    let whole = smooth_prior();
    let levels = Levels::between(Level::L2, Level::T5).expect("a part");
    let part = whole.of(levels).expect("within L4 to T2");
    assert_eq!(part.mean(), &whole.mean()[2..11]);
    let rows = whole.covariance_rad2().view((2, 2), (9, 9)).into_owned();
    assert_eq!(*part.covariance_rad2(), rows);
    assert_eq!(part.of(Levels::COMPLETE), None);
}

#[test]
fn numbers_that_are_not_a_distribution_are_refused() {
    let source = PriorSource::Published;
    let new = |joints, covariance| {
        RotationPrior::new(Levels::COMPLETE, vec![Angle::ZERO; joints], covariance, source)
    };
    let refused = new(13, DMatrix::identity(14, 14)).expect_err("13 joints");
    assert!(matches!(refused, RotationPriorError::Shape { joints: 14, mean: 13, .. }));
    let refused = new(14, DMatrix::from_element(14, 14, 1.0)).expect_err("it is singular");
    assert_eq!(refused, RotationPriorError::NoCovariance);
    let mut skewed = DMatrix::identity(14, 14);
    skewed[(0, 1)] = 0.1;
    assert_eq!(new(14, skewed).expect_err("not symmetric"), RotationPriorError::NoCovariance);
}
