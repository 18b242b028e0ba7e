//! The load that brings T2 nearest to a place (decision 0008): of the minima of T2's distance, the one with the smallest load whose
//! distance is within [`T2_TOLERANCE_MM`] of the least.
//!
//! A load of one component is followed from zero, as [`match_t2`] follows a force. With several components
//! many paths are possible; minima are found by least squares from several starts.

use nalgebra::{DMatrix, DVector};

use super::matching::{ForceMatch, ForceSign, OneComponent, Path, line_force};
use super::target::{NearestT2Target, T2_TOLERANCE_MM};
use super::{FilmUnderLoad, Load, Solution, Statics};
use crate::least_squares::{FitStatus, System, minimize};
use crate::spatial::Frontal;

/// Weight of the load's squared size, in mm²/rad²: negligible, so that it decides only between loads that bring T2 equally near.
const SIZE_WEIGHT: f64 = 1e-2;
/// Residuals are minimised in µm: a search ends at a decrease that is small beside the whole share of the load's size, which alone
/// decides where T2's two coordinates leave a component free.
const RESIDUAL_PER_MM: f64 = 1e3;
/// Sizes of load, in rad, from which minima are sought.
const START_SIZES: [f64; 4] = [0.1, 0.2, 0.4, 0.8];

/// Of minima of T2's distance the one that counts; the first of equals. `of` gives the distance in mm and the size of the load.
fn smallest_near_t2<T>(minima: Vec<T>, least_mm: f64, of: impl Fn(&T) -> [f64; 2]) -> Option<T> {
    let near = minima.into_iter().filter(|found| of(found)[0] <= least_mm + T2_TOLERANCE_MM);
    near.min_by(|a, b| of(a)[1].total_cmp(&of(b)[1]))
}

/// Finds the force of the given signs that brings T2 nearest to a place.
///
/// The distance may have several minima along the path, and an implausible shape far along it may touch the place by
/// chance. The smallest force counts whose distance is within a millimetre of the least. Where the path ends before the
/// distance has a minimum, its nearest shape comes back as [`PathEnding::Unreachable`](super::PathEnding::Unreachable).
#[must_use]
pub fn match_t2(
    statics: &Statics<'_>,
    load: &Load,
    signs: &[ForceSign],
    place: Frontal,
) -> ForceMatch {
    nearest_on_path(line_force(statics, load), signs, place)
}

/// The amount of a load of one component that brings T2 nearest to a place.
///
/// Where the path ends before the distance has a minimum, its nearest shape comes back as
/// [`PathEnding::Unreachable`](super::PathEnding::Unreachable).
pub(crate) fn nearest_on_path(
    load: OneComponent<impl FnMut(f64, &mut Solution)>,
    signs: &[ForceSign],
    place: Frontal,
) -> ForceMatch {
    let mut path = Path::new(load, NearestT2Target(place));
    for &sign in signs {
        path.follow(sign, usize::MAX);
    }
    path.found.retain(ForceMatch::is_usable);
    let minima = std::mem::take(&mut path.found);
    let least_mm = path.least_residual();
    let of = |found: &ForceMatch| {
        [found.residual.distance_mm().unwrap_or(f64::INFINITY), found.force_n.abs()]
    };
    match smallest_near_t2(minima, least_mm, of) {
        Some(found) => ForceMatch { other_mm: path.least_elsewhere(found.force_n), ..found },
        None => path.first_or_nearest(),
    }
}

/// T2 under a load of several components.
pub(crate) trait SeveralComponents {
    /// Forgets the last shape, from which the next one is sought.
    fn restart(&mut self);

    /// T2's location and its derivative by every component; `None` where no equilibrium was found.
    fn t2(&mut self, components: &[f64]) -> Option<(Frontal, Vec<Frontal>)>;
}

/// The components that bring T2 nearest to a place, sought from no load and from each of the first `started` components by
/// itself, both ways and in several sizes. The size of a load is `|size · components|`, in rad.
pub(crate) fn nearest_from_starts(
    load: &mut impl SeveralComponents,
    size: &DMatrix<f64>,
    started: usize,
    place: Frontal,
) -> Option<DVector<f64>> {
    // Distance in mm and size, and components.
    let mut minima: Vec<([f64; 2], DVector<f64>)> = Vec::new();
    for start in starts_of_sizes(size, started) {
        let Some(components) = minimum_from(load, size, place, start) else { continue };
        // From the unloaded spine, as the shape is computed that is shown.
        load.restart();
        if let Some((t2, _)) = load.t2(components.as_slice()) {
            minima.push(([t2.distance_mm(place), (size * &components).norm()], components));
        }
    }
    let least_mm = minima.iter().map(|(of, _)| of[0]).fold(f64::INFINITY, f64::min);
    smallest_near_t2(minima, least_mm, |(of, _)| *of).map(|(_, components)| components)
}

/// `size² = |factor · x|²` for the components of a load on an unloaded film, and for the angles of a base that may turn; `None` where the
/// components do not differ.
pub(crate) fn size_factor(unloaded: &impl FilmUnderLoad, base: usize) -> Option<DMatrix<f64>> {
    let components = unloaded.components();
    let rates = |i| unloaded.solution().joint_rates(unloaded.first_component() + i);
    let mut squares = DMatrix::<f64>::identity(components + base, components + base);
    for a in 0..components {
        for b in 0..components {
            squares[(a, b)] = rates(a).zip(rates(b)).map(|(a, b)| a.dot(&b)).sum();
        }
    }
    Some(squares.cholesky()?.l().transpose())
}

/// No load, and each of the first `started` components by itself, both ways and in several sizes.
pub(crate) fn starts_of_sizes(size: &DMatrix<f64>, started: usize) -> Vec<DVector<f64>> {
    let none = DVector::zeros(size.ncols());
    let mut starts = vec![none.clone()];
    for i in 0..started {
        let unit = size.column(i).norm();
        for size in START_SIZES.into_iter().flat_map(|size| [size, -size]) {
            let mut start = none.clone();
            start[i] = size / unit;
            starts.push(start);
        }
    }
    starts
}

/// The minimum of `|T2 - place|² + w · size²` near a start.
fn minimum_from(
    load: &mut impl SeveralComponents,
    size: &DMatrix<f64>,
    place: Frontal,
    start: DVector<f64>,
) -> Option<DVector<f64>> {
    let count = start.len();
    let free = DVector::from_element(count, f64::INFINITY);
    let weighted = size * (SIZE_WEIGHT.sqrt() * RESIDUAL_PER_MM);
    load.restart();
    let end = minimize(start, &-&free, &free, 2 + count, |x, system: &mut System| {
        let Some((t2, rates)) = load.t2(x.as_slice()) else { return false };
        let off = (t2 - place) * RESIDUAL_PER_MM;
        system.residuals[0] = off.y_mm;
        system.residuals[1] = off.z_mm;
        for (i, rate) in rates.iter().enumerate() {
            system.jacobian[(0, i)] = rate.y_mm * RESIDUAL_PER_MM;
            system.jacobian[(1, i)] = rate.z_mm * RESIDUAL_PER_MM;
        }
        system.residuals.rows_mut(2, count).copy_from(&(&weighted * x));
        system.jacobian.rows_mut(2, count).copy_from(&weighted);
        true
    });
    (end.status == FitStatus::Converged).then_some(end.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARM_MM: f64 = 300.0;
    const BEND_MM: f64 = 150.0;

    /// T2 under three components: the second and the third both lift it, the third more and more.
    struct TwoLift;

    impl SeveralComponents for TwoLift {
        fn restart(&mut self) {}

        fn t2(&mut self, components: &[f64]) -> Option<(Frontal, Vec<Frontal>)> {
            let &[aside, even, bent] = components else { return None };
            let height_mm = ARM_MM * (even + bent) + BEND_MM * bent * bent;
            let rates = vec![
                Frontal::new(ARM_MM, 0.0),
                Frontal::new(0.0, ARM_MM),
                Frontal::new(0.0, ARM_MM + 2.0 * BEND_MM * bent),
            ];
            Some((Frontal::new(ARM_MM * aside, height_mm), rates))
        }
    }

    #[test]
    fn of_the_loads_that_bring_t2_to_its_place_the_smallest_is_found() {
        // Oracle: along the loads that keep T2 at its place, the square of their size has the slope zero.
        for place in [Frontal::new(-30.0, 90.0), Frontal::new(40.0, -60.0)] {
            let found = nearest_from_starts(&mut TwoLift, &DMatrix::identity(3, 3), 3, place)
                .expect("a load reaches every place");
            let (t2, rates) = TwoLift.t2(found.as_slice()).expect("three components");
            assert!(t2.distance_mm(place) < 1e-4, "{t2:?}");
            let slope = found[2] - found[1] * rates[2].z_mm / ARM_MM;
            assert!(slope.abs() < 1e-4, "{slope}: {found}");
        }
    }
}
