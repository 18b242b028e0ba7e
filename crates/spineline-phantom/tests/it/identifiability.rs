//! Identifiability of multipliers that were put into the model itself, with noise of a known size on its shapes.

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use spineline::action::LineKind;
use spineline::analysis::{AnalysisOptions, analyze};
use spineline::anatomy::{Levels, Posture};
use spineline::measure::{Noise, Outline};
use spineline::multibody::{JointGroups, Support};
use spineline::personalize::{
    FitSettings, Gauge, Identifiability, LogNormalPrior, Personalization, ProfileEnd, identify,
};
use spineline::spatial::{Angle, Frontal};
use spineline_phantom::{Readers, Scenario, generate};

use crate::exact_model::Patient;

fn patient() -> Patient {
    crate::exact_model::patient(0)
}

/// Request for a fit.
struct Asked {
    groups: JointGroups,
    logs: Vec<f64>,
    support: Support,
    prior: Option<LogNormalPrior>,
    /// Noise on locations and tilts, in the deviations by which they are weighted.
    noise: f64,
    seed: u64,
}

impl Asked {
    fn regional(patient: &Patient) -> Self {
        let logs = vec![0.4, -0.6, 0.2];
        let groups = JointGroups::regional(&patient.regions);
        Self { groups, logs, support: Support::Frontal, prior: None, noise: 1.0, seed: 1 }
    }
}

impl Patient {
    /// A film as a reader with independent normal errors marks it.
    fn read(&self, exact: Outline, asked: &Asked) -> Outline {
        let mut rng = ChaCha12Rng::seed_from_u64(asked.seed);
        rng.set_stream(exact.posture as u64);
        let mut normal = || asked.noise * Distribution::<f64>::sample(&StandardNormal, &mut rng);
        let mut film = exact;
        film.vertebrae[0] = self.erect.vertebrae[0];
        let noise = film.noise;
        for vertebra in film.vertebrae.iter_mut().skip(1) {
            let off = Frontal::new(normal(), normal()) * noise.location_mm;
            vertebra.location = vertebra.location + off;
            vertebra.tilt = vertebra.tilt + noise.tilt * normal();
        }
        film
    }

    fn ask(&self, asked: &Asked) -> (Personalization, Identifiability) {
        let films = self.films(&asked.groups, &asked.logs, asked.support);
        let films = films.map(|film| self.read(film, asked));
        // The model is exact: its film has no errors.
        let exact = Noise { location_mm: 0.0, tilt: Angle::ZERO, tilt_degrees_of_freedom: None };
        let erect = Outline { noise: exact, ..self.erect.clone() };
        let settings =
            FitSettings { support: asked.support, prior: asked.prior, ..self.settings() };
        self.fitted(&films, &erect, &asked.groups, &settings, |springs, films, fit| {
            let found = identify(springs, films, &settings, &fit).expect("the fit converged");
            (fit, found)
        })
    }
}

#[test]
fn the_films_identify_ratios_and_not_the_level() {
    // Oracle: if only lateral springs turn, scaling all springs and all forces by one number does not change shapes.
    let patient = patient();
    let (_, found) = patient.ask(&Asked::regional(&patient));
    let [level, other, ..] = &found.directions[..] else { panic!("three directions") };
    assert!(level.gauge_share > 1.0 - 1e-6, "{}", level.gauge_share);
    assert!(level.log_sd > 1e4 * other.log_sd, "{} and {}", level.log_sd, other.log_sd);
    assert!(other.log_sd < 0.2 && other.gauge_share < 1e-6, "{other:?}");
}

#[test]
fn a_profile_equals_the_parabola_of_the_curvature() {
    // Oracle: the linear theory; the profile fits anew at every point, the deviation is one matrix.
    let patient = patient();
    let (fit, found) = patient.ask(&Asked::regional(&patient));
    for (group, one) in found.multipliers.iter().enumerate() {
        let best = fit.log_multipliers[group];
        assert!(!one.profile.improves());
        for (end, side) in [(one.profile.lower, -1.0), (one.profile.upper, 1.0)] {
            let ProfileEnd::At(end) = end else { panic!("an end") };
            let expected = best + side * 1.96 * one.log_sd;
            assert!((end - expected).abs() < 0.1 * one.log_sd, "{group}: {end}, {expected}");
        }
        for point in one.profile.points.iter().filter(|point| point.rise > 0.1) {
            let theory = ((point.log_multiplier - best) / one.log_sd).powi(2);
            assert!((point.rise / theory - 1.0).abs() < 0.1, "{group}: {point:?}, {theory}");
        }
    }
}

#[test]
fn intervals_cover_the_true_multipliers() {
    // Oracle: the true values. 95 % of 200 films × 3 multipliers are expected; chance allows 90 to 99 %, with ratios
    // that depend on one another.
    const FILMS: u64 = 200;
    let patient = patient();
    let mut asked = Asked::regional(&patient);
    let mut covered = 0;
    for seed in 0..FILMS {
        asked.seed = seed;
        let (_, found) = patient.ask(&asked);
        for (one, truth) in found.multipliers.iter().zip(&asked.logs) {
            let (ProfileEnd::At(lower), ProfileEnd::At(upper)) =
                (one.profile.lower, one.profile.upper)
            else {
                panic!("two ends")
            };
            covered += usize::from((lower..=upper).contains(truth));
        }
    }
    let share = covered as f64 / (3 * FILMS) as f64;
    assert!((0.90..0.99).contains(&share), "{share}");
}

#[test]
fn noisy_films_widen_the_intervals_by_the_residuals() {
    // Oracle: residuals scale with the noise, and deviations with them.
    let patient = patient();
    let mut asked = Asked::regional(&patient);
    let (_, fine) = patient.ask(&asked);
    asked.noise = 3.0;
    let (_, rough) = patient.ask(&asked);
    assert!((4.0..16.0).contains(&rough.variance_factor), "{}", rough.variance_factor);
    let ratio = rough.multipliers[1].log_sd / fine.multipliers[1].log_sd;
    assert!((2.0..4.0).contains(&ratio), "{ratio}");
}

#[test]
fn a_prior_decides_unidentified_parameters_only() {
    // Oracle: a prior alone has the deviation sd √(1 - 1/n) under the mean's gauge, and information adds up.
    let patient = patient();
    let prior = LogNormalPrior::IN_VIVO;
    let mut asked = Asked {
        groups: JointGroups::per_joint(Levels::COMPLETE),
        logs: vec![0.0; 14],
        prior: Some(prior),
        ..Asked::regional(&patient)
    };
    let (fit, found) = patient.ask(&asked);
    let gauge = Gauge::GeometricMean;
    let alone = prior.log_sd * f64::sqrt(1.0 - 1.0 / 14.0);
    for (one, log) in found.multipliers.iter().zip(&fit.log_multipliers) {
        let with = one.log_sd_with_prior.expect("there is a prior");
        assert!(with <= one.log_sd.min(alone) * (1.0 + 1e-9), "{with}, {}, {alone}", one.log_sd);
        assert!(log.abs() < 4.0 * alone, "{log}");
        let share = one.film_share(prior.log_sd, 14, gauge).expect("there is a prior");
        assert!((share - (1.0 - (with / alone).powi(2))).abs() < 1e-9, "{share}");
    }
    asked.prior = Some(LogNormalPrior { log_sd: 1e-4 });
    let (fit, found) = patient.ask(&asked);
    let mut shares = found.multipliers.iter().map(|one| one.film_share(1e-4, 14, gauge));
    let is_nothing = |share: Option<f64>| share.is_some_and(|share| share < 1e-3);
    assert!(shares.all(is_nothing), "a prior that is certain leaves nothing to films");
    assert!(fit.log_multipliers.iter().all(|log| log.abs() < 1e-3), "{:?}", fit.log_multipliers);
}

#[test]
fn the_mean_of_the_joints_takes_all_films_and_the_multiplier_the_bends() {
    let whole = generate(0, Scenario::Pull, &Readers::scaled(1.0), 1).expect("a subject").case;
    let mut bends = whole.clone();
    bends.films.retain(|film| film.posture == Posture::Erect || film.posture.bend().is_some());
    let found = [whole, bends].map(|case| {
        let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom is sound");
        let model = analysis.model(LineKind::Iliac).expect("a model");
        analysis.identifiability(model).expect("a converged fit").multipliers
    });
    let [whole, bends] = found;
    for (a, b) in whole.iter().zip(&bends) {
        assert!((a.log_multiplier - b.log_multiplier).abs() < 1e-9);
        assert!((a.log_sd - b.log_sd).abs() < 1e-9 * a.log_sd);
        let [mean, of_bends] = [a, b].map(|one| one.stiffness.expect("rotations determine it"));
        assert!((mean.log_mean - of_bends.log_mean).abs() > 1e-3, "{mean:?} {of_bends:?}");
    }
}
