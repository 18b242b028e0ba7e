//! Uncertainty of corners of a reading that a program found and no person placed, together and by vertebra.
//!
//! Completed corners share the shape that they were completed with, so that their errors are correlated over the spine: their
//! covariance comes from the completion by the landmarks that a person placed. Detected corners state their own standard
//! deviation. Fits weight residuals by the covariance of all vertebrae (module `shared_errors`); replicates of a
//! Monte Carlo draw all corners together.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::completion::{Clicks, CompletionError, complete};
use super::{
    CornerName, Corners, ImageGeometry, Origin, ProgramNoise, Reading, TiltRule, VertebraLandmarks,
};
use crate::anatomy::{Level, Posture};
use crate::spatial::{Angle, Frontal};

/// The corners of one reading that no person placed, and their covariance.
#[derive(Debug, Clone)]
pub(crate) struct ProgramCorners {
    corners: Vec<(Level, CornerName)>,
    /// Lower triangular factor of the covariance of their coordinates in the film's frontal frame.
    factor_mm: DMatrix<f64>,
}

impl ProgramCorners {
    /// `None` where a person placed all corners.
    ///
    /// # Errors
    /// [`CompletionError`] if corners have the origin `completed`, and the landmarks do not complete them.
    pub fn of(
        image: &ImageGeometry,
        posture: Option<Posture>,
        reading: &Reading<VertebraLandmarks>,
    ) -> Result<Option<Self>, CompletionError> {
        let unplaced = |(&level, landmark): (&Level, &VertebraLandmarks)| {
            let (origins, is_stated) = (landmark.origins, landmark.sd_share.is_some());
            // Detected corners without a stated deviation have the noise of clicks.
            let counts = move |origin: Origin| {
                !origin.is_placed() && (is_stated || origin != Origin::Detected)
            };
            let names = CornerName::ALL.into_iter();
            names.filter(move |name| counts(name.of(&origins))).map(move |name| (level, name))
        };
        let corners: Vec<(Level, CornerName)> =
            reading.vertebrae.iter().flat_map(unplaced).collect();
        if corners.is_empty() {
            return Ok(None);
        }
        let stated = |level: Level| reading.vertebrae[&level].sd_share;
        let completion = if corners.iter().any(|&(level, _)| stated(level).is_none()) {
            Some(complete(image, posture, &Clicks::of_readings(std::slice::from_ref(reading)))?)
        } else {
            None
        };
        let mut covariance = DMatrix::zeros(2 * corners.len(), 2 * corners.len());
        for (i, &(level, name)) in corners.iter().enumerate() {
            if let Some(share) = stated(level) {
                let body = reading.vertebrae[&level].corners.map(|corner| image.frontal(corner));
                let variance = (share * body.height_mm()).powi(2);
                (covariance[(2 * i, 2 * i)], covariance[(2 * i + 1, 2 * i + 1)]) =
                    (variance, variance);
                continue;
            }
            let Some(completion) = &completion else { continue };
            for (j, &(other, other_name)) in corners.iter().enumerate() {
                if stated(other).is_none() {
                    let block =
                        completion.corner_covariance_mm2((level, name), (other, other_name));
                    covariance.fixed_view_mut::<2, 2>(2 * i, 2 * j).copy_from(&block);
                }
            }
        }
        if let Some(completion) = &completion {
            // Later landmarks would complete the corners differently: the difference is an error of the corners too.
            let off = |(level, name): (Level, CornerName)| {
                let own = image.frontal(name.of(&reading.vertebrae[&level].corners));
                let off = own - name.of(&completion.corners(level));
                if stated(level).is_some() { Frontal::default() } else { off }
            };
            let off = corners.iter().flat_map(|&corner| [off(corner).y_mm, off(corner).z_mm]);
            let off = DVector::from_iterator(covariance.nrows(), off);
            covariance += &off * off.transpose();
        }
        // Corners that their marks determine exactly leave the covariance singular to rounding.
        let floor = 1e-18 + 1e-12 * covariance.trace() / covariance.nrows() as f64;
        (0..covariance.nrows()).for_each(|i| covariance[(i, i)] += floor);
        let iterations = completion.as_ref().map_or(0, super::completion::Completion::iterations);
        let factor = covariance.cholesky().ok_or(CompletionError::NotConverged { iterations })?;
        Ok(Some(Self { corners, factor_mm: factor.unpack() }))
    }

    /// Noise that they add to a vertebra; `None` for a vertebra without them.
    pub fn noise(
        &self,
        image: &ImageGeometry,
        level: Level,
        landmark: &VertebraLandmarks,
        rule: TiltRule,
    ) -> Option<ProgramNoise> {
        let spread = self.spread(image, level, landmark, rule)?;
        let own = self.corners.iter().filter(|(of, _)| *of == level).count();
        let variance = |row: usize| spread.row(row).norm_squared();
        let by_hand = landmark.axis_clockwise.is_some();
        let placed_share = 1.0 - own as f64 / CornerName::ALL.len() as f64;
        Some(ProgramNoise {
            location_mm: (0.5 * (variance(0) + variance(1))).sqrt(),
            tilt: Angle::from_rad(variance(2).sqrt()),
            placed_share,
            placed_tilt_share: if by_hand { 1.0 } else { placed_share },
            is_reviewed: landmark.is_reviewed(),
        })
    }

    /// Errors of location (two coordinates) and tilt of a vertebra per independent standard deviate, in the film's frontal frame;
    /// `None` for a vertebra without these corners. An axis set by hand does not depend on them.
    pub fn spread(
        &self,
        image: &ImageGeometry,
        level: Level,
        landmark: &VertebraLandmarks,
        rule: TiltRule,
    ) -> Option<DMatrix<f64>> {
        let own: Vec<(usize, CornerName)> = (self.corners.iter().enumerate())
            .filter(|(_, (of, _))| *of == level)
            .map(|(i, &(_, name))| (i, name))
            .collect();
        if own.is_empty() {
            return None;
        }
        let body = landmark.corners.map(|corner| image.frontal(corner));
        let rates = rates_of(&body, rule);
        let mut spread = DMatrix::zeros(3, self.deviates());
        for &(i, name) in &own {
            let rate = rates.fixed_columns::<2>(2 * name as usize);
            spread += rate * self.factor_mm.rows(2 * i, 2);
        }
        if landmark.axis_clockwise.is_some() {
            spread.row_mut(2).fill(0.0);
        }
        Some(spread)
    }

    /// Independent standard deviates that the errors of all corners are made of.
    pub fn deviates(&self) -> usize {
        self.factor_mm.ncols()
    }

    /// The corners.
    pub fn corners(&self) -> &[(Level, CornerName)] {
        &self.corners
    }

    /// The corners of a reading, moved together by independent standard deviates, two per corner.
    pub fn move_by(
        &self,
        image: &ImageGeometry,
        deviates: &[[f64; 2]],
        vertebrae: &mut BTreeMap<Level, VertebraLandmarks>,
    ) {
        let deviates =
            DVector::from_iterator(2 * deviates.len(), deviates.iter().copied().flatten());
        let moved_mm = &self.factor_mm * deviates;
        for (i, (level, name)) in self.corners.iter().enumerate() {
            let Some(landmark) = vertebrae.get_mut(level) else { continue };
            let corner = name.of_mut(&mut landmark.corners);
            let off = Frontal::new(moved_mm[2 * i], moved_mm[2 * i + 1]);
            *corner = image.pixel(image.frontal(*corner) + off);
        }
    }
}

/// Derivatives of location and tilt by the coordinates of the corners, in the order of [`CornerName::ALL`]; by differences.
fn rates_of(body: &Corners<Frontal>, rule: TiltRule) -> SMatrix<f64, 3, 8> {
    let step_mm = 1e-4 * body.height_mm();
    let mut rates = SMatrix::<f64, 3, 8>::zeros();
    for name in CornerName::ALL {
        for (axis, step) in
            [Frontal::new(step_mm, 0.0), Frontal::new(0.0, step_mm)].into_iter().enumerate()
        {
            let at = |step: Frontal| {
                let mut moved = *body;
                let corner = name.of_mut(&mut moved);
                *corner = *corner + step;
                (moved.measure_location().unwrap_or_default(), rule.tilt_of(&moved))
            };
            let ((ahead, tilt_ahead), (behind, tilt_behind)) = (at(step), at(step * -1.0));
            let location = (ahead - behind) * (0.5 / step_mm);
            let tilt = (tilt_ahead - tilt_behind).wrapped().rad() * (0.5 / step_mm);
            let rate = SVector::from([location.y_mm, location.z_mm, tilt]);
            rates.set_column(2 * name as usize + axis, &rate);
        }
    }
    rates
}

#[cfg(test)]
mod tests;
