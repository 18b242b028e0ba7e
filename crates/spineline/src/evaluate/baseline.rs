//! Predictions without mechanics, which a model must beat to be worth its parameters.
//!
//! A film is predicted from a pattern of joint rotations, without forces and stiffness. As for every model, the location of T2 gives
//! the size of the rotations and the scale of the film; some of these predictions take T2's tilt too.

use nalgebra::{DMatrix, DVector};

use super::bend_rotations::joint_angles;
use super::film_shape::{FilmShape, ShownVertebra};
use super::rotation_prior::RotationPrior;
use crate::anatomy::{Level, Posture, named};
use crate::least_squares::{FitStatus, Minimum, System, minimize};
use crate::measure::{FilmLength, FilmScale, Outline};
use crate::spatial::{Angle, Frontal};

named! {
    /// A source of joint rotations before a film.
    pub enum Baseline {
        /// The rotations of the patient's other bend, to the other side.
        MirroredBend = "mirrored_bend" as "other bend, mirrored",
        /// Published lateral bending of healthy joints.
        PublishedMobility = "published_mobility" as "published mobility of the joints",
        /// Mean rotations of the bends of other patients.
        OtherPatients = "other_patients" as "mean rotations of other patients",
        /// The distribution of joint rotations over the bends of other patients.
        RotationPrior = "rotation_prior" as "distribution learned from other patients",
        /// The published or the given distribution of joint rotations, and the tilt of T2 on the film.
        RotationPriorWithTilt = "rotation_prior_with_tilt" as "distribution of rotations",
        /// The distribution of joint rotations over the bends of other patients of a cohort, and the tilt of T2 on the film.
        LearnedWithTilt = "learned_with_tilt" as "distribution learned from other patients",
        /// No spine: a cubic from L4 to T2 with the tilts of both, each vertebra at its part of the length on the erect film.
        Cubic = "cubic" as "cubic curve",
    }
}

impl Baseline {
    /// Whether it takes the tilt of T2 from the film beside its location. It is compared with predictions that know as much of T2.
    #[must_use]
    pub const fn knows_tilt(self) -> bool {
        matches!(self, Self::RotationPriorWithTilt | Self::LearnedWithTilt | Self::Cubic)
    }

    /// Whether lines and loads are tested against it. With T2's tilt these take the published or the given distribution of rotations,
    /// so that a distribution of other patients knows more.
    #[must_use]
    pub const fn is_tested(self) -> bool {
        !matches!(self, Self::LearnedWithTilt)
    }

    /// Its name, which says whether T2's tilt is known.
    #[must_use]
    pub fn long_name(self) -> String {
        let tilt = if self.knows_tilt() { " with tilt" } else { "" };
        format!("{self}{tilt}")
    }
}

/// A film as a baseline predicts it, beside what was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct BaselinePrediction {
    /// The shape, beside the film.
    pub shape: FilmShape,
    /// The source of the rotations.
    pub baseline: Baseline,
    /// How the fit to T2 ended.
    pub status: FitStatus,
    /// Factor on a pattern of rotations; `None` for a distribution.
    pub amount: Option<f64>,
    /// Predicted rotation of every joint from the erect film, caudal first; positive to the patient's right.
    pub rotations: Vec<Angle>,
}

impl BaselinePrediction {
    /// Whether the fit to T2 converged.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        self.status == FitStatus::Converged
    }
}

/// Joint rotations before a film: `mean + basis x`, where `x` are either free or standard normal.
struct Rotations {
    mean: DVector<f64>,
    basis: DMatrix<f64>,
    is_free: bool,
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
    FilmFromTop::of(erect, film).by_pattern(baseline, pattern, &Links::of(erect))
}

/// Predicts a film from the erect one, a distribution of joint rotations, and T2.
///
/// # Definition
/// As [`predict_baseline`], with the most probable rotations and scale: the minimum of the squared distances, each over its
/// variance, of T2 from where it was marked, of the rotations from their mean at these erect angles, of the scale from one and, where the baseline
/// knows it, of the tilt of T2. Learned means are mirrored for a bend to the left.
///
/// # Panics
/// If the prior has not one rotation per joint.
#[must_use]
pub fn predict_from_prior(
    baseline: Baseline,
    prior: &RotationPrior,
    erect: &Outline,
    film: &Outline,
) -> BaselinePrediction {
    FilmFromTop::of(erect, film).by_prior(baseline, prior, &Links::of(erect))
}

/// How far T2 turned from the erect film against the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TurnOfTop {
    pub angle: Angle,
    /// Its standard deviation by the noise of both films' tilts.
    pub sd: Angle,
}

impl TurnOfTop {
    pub fn of(erect: &Outline, film: &Outline) -> Self {
        let last = film.vertebrae.len() - 1;
        // A tilt against L4 has the noise of two.
        let [film_sd, erect_sd] = [film, erect].map(|outline| outline.noise_of_ends().tilt.rad());
        Self {
            angle: (film.vertebrae[last].tilt - erect.vertebrae[last].tilt).wrapped(),
            sd: Angle::from_rad(f64::sqrt(2.0) * film_sd.hypot(erect_sd)),
        }
    }
}

/// The data of a film for a prediction from T2 and its comparison: the film itself need not be kept.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FilmFromTop {
    pub posture: Posture,
    /// Its scale against the erect film.
    pub length: FilmLength,
    /// T2 as it was marked.
    pub top: Frontal,
    /// Standard deviation of a coordinate of it relative to the base.
    pub top_sd_mm: f64,
    pub turn: TurnOfTop,
    /// Places and levels of the vertebrae above the base, caudal first.
    pub shown: Box<[(u8, Level)]>,
    /// Their locations on the outline of the film.
    pub locations: Box<[Frontal]>,
}

impl FilmFromTop {
    pub fn of(erect: &Outline, film: &Outline) -> Self {
        let last = film.vertebrae.len() - 1;
        let shown = || ShownVertebra::all_of(film);
        Self {
            posture: film.posture,
            length: film.length,
            top: film.vertebrae[last].location * film.length.scale.factor,
            top_sd_mm: film.top_sd_mm(),
            turn: TurnOfTop::of(erect, film),
            shown: shown().map(|one| (one.place, one.level)).collect(),
            locations: shown().map(|one| one.location).collect(),
        }
    }

    /// As [`predict_baseline`].
    pub fn by_pattern(
        &self,
        baseline: Baseline,
        pattern: &[Angle],
        erect: &Links,
    ) -> BaselinePrediction {
        let joints = pattern.iter().map(|joint| joint.rad());
        let basis = DMatrix::from_iterator(pattern.len(), 1, joints);
        let rotations = Rotations { mean: DVector::zeros(pattern.len()), basis, is_free: true };
        self.by_rotations(baseline, &rotations, erect)
    }

    /// As [`predict_from_prior`].
    pub fn by_prior(
        &self,
        baseline: Baseline,
        prior: &RotationPrior,
        erect: &Links,
    ) -> BaselinePrediction {
        self.by_rotations(baseline, &self.rotations_by(prior, erect), erect)
    }

    fn rotations_by(&self, prior: &RotationPrior, erect: &Links) -> Rotations {
        let joints = prior.mean_of(self.posture, &erect.joint_angles).into_iter().map(Angle::rad);
        let mean = DVector::from_iterator(prior.mean().len(), joints);
        Rotations { mean, basis: prior.root().clone(), is_free: false }
    }

    /// Covariance of the locations of all vertebrae, in mm², and of their tilts, in rad², about the most probable rotations and scale.
    pub fn covariances(
        &self,
        prior: &RotationPrior,
        erect: &Links,
        knows_tilt: bool,
    ) -> Option<[DMatrix<f64>; 2]> {
        let rotations = self.rotations_by(prior, erect);
        let fit = TopFit::new(self, &rotations, erect, knows_tilt);
        let end = fit.minimum();
        let unknowns = fit.unknowns();
        let covariance = end.system.jacobian.tr_mul(&end.system.jacobian).cholesky()?.inverse();
        let (factor, joints) =
            (fit.scale(&end.x).factor / self.length.scale.factor, rotations.mean.len());
        let carried = erect.carried(&fit.rotations_at(&end.x));
        let mut locations = DMatrix::zeros(2 * (joints + 1), unknowns);
        let mut tilts = DMatrix::zeros(joints + 1, unknowns);
        for vertebra in 1..=joints {
            let rates = carried.rates_of(vertebra) * &rotations.basis * factor;
            locations.view_mut((2 * vertebra, 0), rates.shape()).copy_from(&rates);
            if fit.scaled() {
                let own = carried.locations[vertebra] * factor;
                locations[(2 * vertebra, unknowns - 1)] = own.y_mm;
                locations[(2 * vertebra + 1, unknowns - 1)] = own.z_mm;
            }
            let turned =
                tilts.row(vertebra - 1).columns(0, joints) + rotations.basis.row(vertebra - 1);
            tilts.view_mut((vertebra, 0), (1, joints)).copy_from(&turned);
        }
        let of = |rates: DMatrix<f64>| &rates * &covariance * rates.transpose();
        Some([of(locations), of(tilts)])
    }

    fn by_rotations(
        &self,
        baseline: Baseline,
        rotations: &Rotations,
        erect: &Links,
    ) -> BaselinePrediction {
        assert_eq!(rotations.mean.len(), erect.links.len(), "one rotation per joint");
        let fit = TopFit::new(self, rotations, erect, baseline.knows_tilt());
        let end = fit.minimum();
        let scale = fit.scale(&end.x);
        let factor = scale.factor / self.length.scale.factor;
        let found = fit.rotations_at(&end.x);
        let carried = erect.carried(&found).locations;
        let locations = carried.into_iter().map(|location| location * factor).collect();
        let shown = self.shown.iter().zip(&self.locations);
        let shown =
            shown.map(|(&(place, level), &location)| ShownVertebra { place, level, location });
        BaselinePrediction {
            shape: FilmShape::beside(self.posture, scale, locations, shown),
            baseline,
            status: end.status,
            amount: rotations.is_free.then(|| end.x[0]),
            rotations: found.iter().map(|&rad| Angle::from_rad(rad)).collect(),
        }
    }
}

/// The fit of rotations and scale to T2 on the film.
struct TopFit<'a> {
    links: &'a Links,
    rotations: &'a Rotations,
    film: &'a FilmFromTop,
    /// How far T2 turned, where it is known.
    turn: Option<TurnOfTop>,
}

impl<'a> TopFit<'a> {
    fn new(
        film: &'a FilmFromTop,
        rotations: &'a Rotations,
        links: &'a Links,
        knows_tilt: bool,
    ) -> Self {
        Self { links, rotations, film, turn: knows_tilt.then_some(film.turn) }
    }

    fn minimum(&self) -> Minimum {
        let unknowns = self.unknowns();
        let free = DVector::from_element(unknowns, f64::INFINITY);
        minimize(DVector::zeros(unknowns), &-&free, &free, self.rows(), |x, system| {
            self.evaluate(x, system);
            true
        })
    }

    fn scaled(&self) -> bool {
        self.film.length.is_free()
    }

    fn unknowns(&self) -> usize {
        self.rotations.basis.ncols() + usize::from(self.scaled())
    }

    /// Two for the location of T2, one for the scale, one for the tilt, and one for each coordinate with a prior.
    fn rows(&self) -> usize {
        let priors = if self.rotations.is_free { 0 } else { self.rotations.basis.ncols() };
        3 + usize::from(self.turn.is_some()) + priors
    }

    fn rotations_at(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.rotations.mean + &self.rotations.basis * x.rows(0, self.rotations.basis.ncols())
    }

    fn evaluate(&self, x: &DVector<f64>, system: &mut System) {
        let coordinates = self.rotations.basis.ncols();
        let log = if self.scaled() { x[coordinates] } else { 0.0 };
        let rotations = self.rotations_at(x);
        let carried = self.links.carried(&rotations);
        let simulated = carried.top() * log.exp();
        let top = carried.upper_halves.len();
        let rates = carried.rates_of(top) * log.exp() * &self.rotations.basis;
        let weight = 1.0 / self.film.top_sd_mm;
        let off = simulated - self.film.top;
        for (row, (off, by_log)) in
            [(off.y_mm, simulated.y_mm), (off.z_mm, simulated.z_mm)].into_iter().enumerate()
        {
            system.residuals[row] = weight * off;
            for i in 0..coordinates {
                system.jacobian[(row, i)] = weight * rates[(row, i)];
            }
            if self.scaled() {
                system.jacobian[(row, coordinates)] = weight * by_log;
            }
        }
        let prior = if self.scaled() { 1.0 / self.film.length.prior_log_sd } else { 0.0 };
        system.residuals[2] = prior * log;
        if self.scaled() {
            system.jacobian[(2, coordinates)] = prior;
        }
        if let Some(TurnOfTop { angle, sd }) = self.turn {
            let sd = sd.rad();
            system.residuals[3] = (rotations.sum() - angle.rad()) / sd;
            for i in 0..coordinates {
                system.jacobian[(3, i)] = self.rotations.basis.column(i).sum() / sd;
            }
        }
        if !self.rotations.is_free {
            let first = self.rows() - coordinates;
            for i in 0..coordinates {
                system.residuals[first + i] = x[i];
                system.jacobian[(first + i, i)] = 1.0;
            }
        }
    }

    /// The film's scale with its interval, for the shape as it was found.
    fn scale(&self, x: &DVector<f64>) -> FilmScale {
        let length = &self.film.length;
        if !self.scaled() {
            return length.scale;
        }
        let simulated = self.links.carried(&self.rotations_at(x)).top();
        FilmScale {
            factor: x[self.rotations.basis.ncols()].exp(),
            ..length.from_top(simulated, self.film.top, self.film.top_sd_mm)
        }
    }
}

/// The erect spine, caudal first.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Links {
    /// From every vertebra to the next.
    pub links: Vec<Frontal>,
    /// Angle of every joint.
    pub joint_angles: Vec<Angle>,
}

impl Links {
    pub fn of(erect: &Outline) -> Self {
        let pairs = erect.vertebrae.windows(2);
        Self {
            links: pairs.map(|pair| pair[1].location - pair[0].location).collect(),
            joint_angles: joint_angles(erect),
        }
    }

    /// The spine after every joint turns.
    fn carried(&self, rotations: &DVector<f64>) -> Carried {
        let (mut end, mut turned, mut before) = (Frontal::default(), 0.0, (0.0, 1.0));
        let mut carried = Carried { locations: vec![end], upper_halves: Vec::new() };
        for (link, joint) in self.links.iter().zip(rotations.iter()) {
            turned += joint;
            let after = f64::sin_cos(turned);
            let upper_half = link.rotated_by(after) * 0.5;
            end = end + link.rotated_by(before) * 0.5 + upper_half;
            before = after;
            carried.locations.push(end);
            carried.upper_halves.push(upper_half);
        }
        carried
    }
}

/// The erect spine with turned joints.
struct Carried {
    /// From the base upwards.
    locations: Vec<Frontal>,
    /// The upper half of every link: it turns with the vertebra above.
    upper_halves: Vec<Frontal>,
}

impl Carried {
    fn top(&self) -> Frontal {
        self.locations.last().copied().unwrap_or_default()
    }

    /// How a vertebra moves with every joint: two rows, `y` and `z`.
    fn rates_of(&self, vertebra: usize) -> DMatrix<f64> {
        let place = self.locations[vertebra];
        let mut rates = DMatrix::zeros(2, self.upper_halves.len());
        for (joint, upper_half) in self.upper_halves[..vertebra].iter().enumerate() {
            // A joint turns everything above the middle of its link.
            let arm = place - self.locations[joint + 1] + *upper_half;
            rates[(0, joint)] = -arm.z_mm;
            rates[(1, joint)] = arm.y_mm;
        }
        rates
    }
}
