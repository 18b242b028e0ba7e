//! The length of an outline against the erect one.

use super::{FilmLength, FilmLengthRule, FilmScale, Measured, MeasuredVertebra, Outline};
use crate::spatial::Frontal;

impl FilmLength {
    /// A scale with a larger stated standard deviation counts as unknown.
    const MAX_LOG_SD: f64 = 0.5;

    /// Compares the length of a film, as it is marked, with the erect film's.
    ///
    /// # Definition
    /// The length of the polygon through the midpoints is compared with the length of the erect polygon after every vertebra turns as
    /// on the film, half of each link with either neighbour:
    /// `Σ |d_i| cos((δ_{i+1} - δ_i) / 2)`, with the erect links `d_i` and the changes of tilt `δ_i`. The posterior of
    /// `ln factor` is normal: the measured value and zero, weighted by their inverse variances.
    #[must_use]
    pub fn of(erect: &Outline, film: &Outline, rule: FilmLengthRule) -> Self {
        let measured = measured_scale(erect, film);
        let has_scale = have_millimetres([erect, film]);
        // Coordinates near the limits of numbers do not have a finite length.
        let has_length = [measured.factor.ln(), measured.log_sd].iter().all(|one| one.is_finite());
        let prior_log_sd = match rule {
            FilmLengthRule::PerFilm { relative_sd } if has_scale && has_length => {
                let stated = erect.scale.relative_sd.zip(film.scale.relative_sd);
                let sd = stated.map_or(relative_sd, |(erect, film)| erect.hypot(film));
                sd.min(Self::MAX_LOG_SD)
            }
            _ => 0.0,
        };
        let scale = if prior_log_sd > 0.0 {
            let (own, prior) = (measured.log_sd.powi(2), prior_log_sd.powi(2));
            let log = measured.factor.ln() * prior / (prior + own);
            FilmScale { factor: log.exp(), log_sd: (prior * own / (prior + own)).sqrt() }
        } else {
            FilmScale::ONE
        };
        Self { measured, prior_log_sd, scale }
    }
}

/// Whether spacings say how the lengths of two films compare.
fn have_millimetres(films: [&Outline; 2]) -> bool {
    films.iter().all(|one| one.scale.has_millimetres())
}

fn measured_scale(erect: &Outline, film: &Outline) -> FilmScale {
    let turn = |i: usize| film.vertebrae[i].tilt - erect.vertebrae[i].tilt;
    let links = erect.vertebrae.windows(2).enumerate();
    let carried_mm: f64 = links
        .map(|(i, pair)| {
            let half = (turn(i + 1) - turn(i)).wrapped().rad() / 2.0;
            pair[0].location.distance_mm(pair[1].location) * half.cos()
        })
        .sum();
    let variance: f64 = [erect, film].iter().map(|one| log_length_variance(one)).sum();
    FilmScale { factor: film.polygon_mm() / carried_mm, log_sd: variance.sqrt() }
}

/// Variance of the logarithm of the polygon's length by the noise of its points.
fn log_length_variance(outline: &Outline) -> f64 {
    let vertebrae = &outline.vertebrae;
    let unit = |i: usize| {
        let link = vertebrae[i + 1].location - vertebrae[i].location;
        link * (1.0 / link.norm_mm())
    };
    let last = vertebrae.len() - 1;
    let rate = |i: usize| {
        let below = if i > 0 { unit(i - 1) } else { Frontal::default() };
        let above = if i < last { unit(i) } else { Frontal::default() };
        below - above
    };
    if outline.has_shared_errors() {
        let rates = (0..=last).flat_map(|i| {
            let Frontal { y_mm, z_mm } = rate(i);
            [(i, Measured::Left, y_mm), (i, Measured::Cranial, z_mm)]
        });
        return outline.variance_of(&rates.collect::<Vec<_>>()) / outline.polygon_mm().powi(2);
    }
    let variance_mm2 = |(i, vertebra): (usize, &MeasuredVertebra)| {
        let sd_mm = vertebra
            .interpolated
            .map_or_else(|| outline.noise_of(vertebra).location_mm, |i| i.location_sd_mm);
        let rate = rate(i);
        rate.dot(rate) * sd_mm.powi(2)
    };
    let sum_mm2: f64 = vertebrae.iter().enumerate().map(variance_mm2).sum();
    sum_mm2 / outline.polygon_mm().powi(2)
}

impl Outline {
    /// The same film with its locations divided by another scale than now.
    ///
    /// Standard deviations of the landmarks do not change: the difference is far below their own uncertainty.
    #[must_use]
    pub fn at_scale(&self, scale: FilmScale) -> Self {
        let factor = self.length.scale.factor / scale.factor;
        let mut scaled = self.clone();
        scaled.multiply_places(factor);
        scaled.length.scale = scale;
        scaled
    }

    /// Multiplies the places of vertebrae and crests, in the frame of the base.
    fn multiply_places(&mut self, factor: f64) {
        for vertebra in self.vertebrae.iter_mut().chain(&mut self.others) {
            vertebra.location = vertebra.location * factor;
        }
        self.iliac_middle = self.iliac_middle.map(|middle| middle * factor);
    }

    /// The same film in internal millimetres that give its spine the length of the erect one, where one of the two films is in pixels.
    ///
    /// A length in pixels says nothing about the length of the spine, and rotations compare two curves at equal lengths from L4.
    pub(crate) fn in_millimetres_of(mut self, erect: &Outline) -> Self {
        if have_millimetres([erect, &self]) {
            return self;
        }
        let factor = measured_scale(erect, &self).factor;
        if !factor.ln().is_finite() {
            return self;
        }
        let share = 1.0 / factor;
        self.multiply_places(share);
        for vertebra in self.vertebrae.iter_mut().chain(&mut self.others) {
            if let Some(program) = &mut vertebra.program {
                program.location_mm *= share;
            }
            if let Some(interpolated) = &mut vertebra.interpolated {
                interpolated.location_sd_mm *= share;
            }
        }
        self.l4_midpoint_on_film = self.l4_midpoint_on_film * share;
        self.noise.location_mm *= share;
        self.shared_errors = self.shared_errors.map(|shared| shared.with_lengths_times(share));
        self.scale.units_per_mm *= factor;
        self
    }

    pub(crate) fn at_erect_length(mut self, erect: &Outline, rule: FilmLengthRule) -> Self {
        let length = FilmLength::of(erect, &self, rule);
        self.length = FilmLength { scale: FilmScale::ONE, ..length };
        if length.is_free() { self.at_scale(length.scale) } else { self }
    }

    /// Standard deviation of a coordinate of the top relative to the base.
    #[must_use]
    pub fn top_sd_mm(&self) -> f64 {
        if !self.has_shared_errors() {
            return self.noise_of_ends().location_mm * f64::sqrt(2.0);
        }
        let top = self.vertebrae.len() - 1;
        let of = |measured| self.variance_of(&[(top, measured, 1.0), (0, measured, -1.0)]);
        (0.5 * (of(Measured::Left) + of(Measured::Cranial))).sqrt()
    }
}
