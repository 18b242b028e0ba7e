//! Predictions without mechanics, which a model must beat to be worth its parameters.
//!
//! A film is predicted from a pattern of joint rotations that needs no force and no stiffness. As for every model, T2 alone
//! says how large the rotations are, and the scale of the film.

use nalgebra::DVector;

use crate::anatomy::{Level, Posture, named};
use crate::least_squares::{FitStatus, System, minimize};
use crate::measure::{FilmScale, MeasuredVertebra, Outline};
use crate::spatial::{Angle, Frontal};

/// A pattern of joint rotations that is known before a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Baseline {
    /// The rotations of the patient's other bend, to the other side.
    MirroredBend,
    /// Published lateral bending of healthy joints ([`crate::evaluate::published_lateral_bending`]).
    PublishedMobility,
    /// Mean rotations of the bends of other patients.
    OtherPatients,
}

impl Baseline {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::MirroredBend, Self::PublishedMobility, Self::OtherPatients];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::MirroredBend => "mirrored_bend",
            Self::PublishedMobility => "published_mobility",
            Self::OtherPatients => "other_patients",
        }
    }
}

impl std::fmt::Display for Baseline {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::MirroredBend => "other bend, mirrored",
            Self::PublishedMobility => "published mobility of the joints",
            Self::OtherPatients => "mean rotations of other patients",
        })
    }
}

named!(Baseline);

/// A film as a baseline predicts it, beside what was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct BaselinePrediction {
    /// The posture.
    pub posture: Posture,
    /// The pattern of rotations.
    pub baseline: Baseline,
    /// How the fit to T2 ended.
    pub status: FitStatus,
    /// By how much the pattern is multiplied.
    pub amount: f64,
    /// The film's scale against the erect film, from T2.
    pub scale: FilmScale,
    /// Predicted locations on the outline of the film, from L4 (the base) upwards.
    pub locations: Vec<Frontal>,
    /// The vertebrae above the base that the film shows, caudal first.
    pub compared: Vec<Level>,
    /// Distance between predicted and measured location of each of them: E_LOC.
    pub location_errors_mm: Vec<f64>,
}

impl BaselinePrediction {
    /// Mean of the location errors.
    #[must_use]
    pub fn mean_location_error_mm(&self) -> f64 {
        self.location_errors_mm.iter().sum::<f64>() / self.location_errors_mm.len() as f64
    }

    /// Whether the fit to T2 converged.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        self.status == FitStatus::Converged
    }
}

/// Rotation of every joint from the erect film, caudal first; positive to the patient's right.
#[must_use]
pub fn joint_rotations(erect: &Outline, film: &Outline) -> Vec<Angle> {
    let turn = |i: usize| film.vertebrae[i].tilt - erect.vertebrae[i].tilt;
    (1..film.vertebrae.len()).map(|i| (turn(i) - turn(i - 1)).wrapped()).collect()
}

/// Predicts a film from the erect one, a pattern of joint rotations, and T2.
///
/// # Definition
/// Vertebra `i` turns by `a Σ_{j≤i} w_j` from the erect film, with the pattern `w` of the joints below it, and every link
/// turns with its two vertebrae, half with each. The amount `a` and the film's scale bring T2 to where it was marked, with
/// the prior of the scale ([`crate::measure::FilmLength`]). A pattern's size and sign make no difference.
///
/// # Panics
/// If the pattern has not one rotation per joint.
#[must_use]
pub fn predict_baseline(
    baseline: Baseline,
    pattern: &[Angle],
    erect: &Outline,
    film: &Outline,
) -> BaselinePrediction {
    assert_eq!(pattern.len() + 1, erect.vertebrae.len(), "one rotation per joint");
    let links = Links::of(erect, pattern);
    let last = film.vertebrae.len() - 1;
    let top = film.vertebrae[last].location * film.length.scale.factor;
    let weight = 1.0 / film.top_sd_mm();
    let prior = if film.length.is_free() { 1.0 / film.length.prior_log_sd } else { 0.0 };
    let scaled = usize::from(film.length.is_free());
    let free = DVector::from_element(1 + scaled, f64::INFINITY);
    let start = DVector::zeros(1 + scaled);
    let end = minimize(start, &-&free, &free, 3, |x, system: &mut System| {
        let log = if scaled == 1 { x[1] } else { 0.0 };
        let [location, rate] = links.carried(x[0])[last];
        let (simulated, rate) = (location * log.exp(), rate * log.exp());
        let off = simulated - top;
        for (row, (off, [by_amount, by_log])) in
            [(off.y_mm, [rate.y_mm, simulated.y_mm]), (off.z_mm, [rate.z_mm, simulated.z_mm])]
                .into_iter()
                .enumerate()
        {
            system.residuals[row] = weight * off;
            system.jacobian[(row, 0)] = weight * by_amount;
            if scaled == 1 {
                system.jacobian[(row, 1)] = weight * by_log;
            }
        }
        system.residuals[2] = prior * log;
        if scaled == 1 {
            system.jacobian[(2, 1)] = prior;
        }
        true
    });
    let carried = links.carried(end.x[0]);
    let locations: Vec<Frontal> = carried.iter().map(|[location, _]| *location).collect();
    let scale = if scaled == 1 {
        FilmScale {
            factor: end.x[1].exp(),
            ..film.length.from_top(locations[last], top, film.top_sd_mm())
        }
    } else {
        film.length.scale
    };
    let factor = scale.factor / film.length.scale.factor;
    let locations: Vec<Frontal> = locations.iter().map(|&location| location * factor).collect();
    let (compared, location_errors_mm) = film
        .measured()
        .skip(1)
        .map(|(i, vertebra)| (vertebra.level, locations[i].distance_mm(vertebra.location)))
        .unzip();
    BaselinePrediction {
        posture: film.posture,
        baseline,
        status: end.status,
        amount: end.x[0],
        scale,
        locations,
        compared,
        location_errors_mm,
    }
}

/// The links of the erect spine, and how far both vertebrae of each turn per amount.
struct Links(Vec<(Frontal, [f64; 2])>);

impl Links {
    fn of(erect: &Outline, pattern: &[Angle]) -> Self {
        let mut turned = 0.0;
        let vertebrae = erect.vertebrae.windows(2).zip(pattern);
        let link = |(pair, joint): (&[MeasuredVertebra], &Angle)| {
            let before = turned;
            turned += joint.rad();
            (pair[1].location - pair[0].location, [before, turned])
        };
        Self(vertebrae.map(link).collect())
    }

    /// Locations from the base upwards, each with its derivative by the amount.
    fn carried(&self, amount: f64) -> Vec<[Frontal; 2]> {
        let mut end = [Frontal::default(); 2];
        let mut all = vec![end];
        for (link, turns) in &self.0 {
            for turn in turns {
                let half = link.rotated(Angle::from_rad(amount * turn)) * 0.5;
                let quarter_turn = Frontal::new(-half.z_mm, half.y_mm);
                end = [end[0] + half, end[1] + quarter_turn * *turn];
            }
            all.push(end);
        }
        all
    }
}
