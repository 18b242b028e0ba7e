//! Statics of the spines that are neither chains of equal segments nor the model: a continuous elastica, and rigid
//! bodies with hinges that may stiffen.
//!
//! # Equations
//! Above a place, forces have the resultant `F` and the moment `M` about the origin. An elastica with the unstressed
//! curvature `κ` and the bending stiffness `B` follows, by its length `s`,
//!
//! ```text
//! p' = (-sin θ, cos θ),    θ' = κ + (M - p × F) / B
//! ```
//!
//! which fourth-order Runge-Kutta steps integrate. A hinge at `h` turns until its spring carries `M - h × F`:
//! `k φ (1 + φ²/φ₁²)`. The base wrench is found by Newton's method, so that nothing is left above the top.

mod anatomy;
mod movements;
#[cfg(test)]
mod tests;

pub(crate) use anatomy::Anatomy;
pub(crate) use movements::postures;

use nalgebra::{SMatrix, SVector};
use spineline::spatial::{Angle, Frontal};

/// Place and tilt of a station: a vertebra's or an inflection's.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Place {
    point: Frontal,
    tilt_rad: f64,
}

/// Resultant of all forces above a place.
#[derive(Debug, Clone, Copy, Default)]
struct Wrench {
    force: Frontal,
    /// Moment about the origin.
    moment_nmm: f64,
}

impl Wrench {
    fn moment_about_nmm(&self, point: Frontal) -> f64 {
        self.moment_nmm - point.cross(self.force)
    }
}

/// A force and a couple on the body of a station; the force keeps its direction.
#[derive(Debug, Clone, Copy)]
struct Acting {
    station: usize,
    force: Frontal,
    couple_nmm: f64,
}

/// A spring at a hinge.
#[derive(Debug, Clone, Copy)]
struct Spring {
    nmm_per_rad: f64,
    /// Turn at which it carries twice the moment of a linear spring; infinite for a linear one.
    stiffening_rad: f64,
}

impl Spring {
    /// The turn that carries a moment: the real root of the cubic, by hyperbolic functions.
    fn turn_rad(&self, moment_nmm: f64) -> f64 {
        let linear = moment_nmm / self.nmm_per_rad;
        if self.stiffening_rad.is_infinite() {
            return linear;
        }
        let root3 = 3.0_f64.sqrt();
        let third = (1.5 * root3 * linear / self.stiffening_rad).asinh() / 3.0;
        2.0 * self.stiffening_rad / root3 * third.sinh()
    }
}

/// What lies between a station and the next one.
#[derive(Debug, Clone)]
enum Link {
    /// A part of the elastica.
    Elastic {
        length_mm: f64,
        /// Unstressed curvature and compliance per length, at the ends and middles of equal steps.
        samples: Vec<ElasticSample>,
    },
    /// The bone of one body.
    Rigid { to_next: Frontal, turn_rad: f64 },
    /// A hinge between two bodies, from the lower station in its frame and to the upper one in the frame of that.
    Hinge { to_hinge: Frontal, to_next: Frontal, turn_rad: f64, spring: Spring },
}

#[derive(Debug, Clone, Copy)]
struct ElasticSample {
    curvature_per_mm: f64,
    per_nmm2: f64,
}

impl Link {
    fn next(&self, from: Place, above: &Wrench) -> Place {
        let in_frame = |v: Frontal, tilt_rad: f64| v.rotated(Angle::from_rad(tilt_rad));
        match self {
            Self::Elastic { length_mm, samples } => integrate(from, above, *length_mm, samples),
            Self::Rigid { to_next, turn_rad } => Place {
                point: from.point + in_frame(*to_next, from.tilt_rad),
                tilt_rad: from.tilt_rad + turn_rad,
            },
            Self::Hinge { to_hinge, to_next, turn_rad, spring } => {
                let hinge = from.point + in_frame(*to_hinge, from.tilt_rad);
                let turn_rad = turn_rad + spring.turn_rad(above.moment_about_nmm(hinge));
                let tilt_rad = from.tilt_rad + turn_rad;
                Place { point: hinge + in_frame(*to_next, tilt_rad), tilt_rad }
            }
        }
    }
}

fn integrate(from: Place, above: &Wrench, length_mm: f64, samples: &[ElasticSample]) -> Place {
    let steps = (samples.len() - 1) / 2;
    let step_mm = length_mm / steps as f64;
    let slope = |at: Place, sample: ElasticSample| Place {
        point: Frontal::leaning(Angle::from_rad(at.tilt_rad)),
        tilt_rad: sample.curvature_per_mm + above.moment_about_nmm(at.point) * sample.per_nmm2,
    };
    let moved = |at: Place, by: Place, part: f64| Place {
        point: at.point + by.point * (part * step_mm),
        tilt_rad: at.tilt_rad + by.tilt_rad * (part * step_mm),
    };
    (0..steps).fold(from, |at, step| {
        let [start, middle, end] = [0, 1, 2].map(|i| samples[2 * step + i]);
        let a = slope(at, start);
        let b = slope(moved(at, a, 0.5), middle);
        let c = slope(moved(at, b, 0.5), middle);
        let d = slope(moved(at, c, 1.0), end);
        [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)]
            .into_iter()
            .fold(at, |sum, (slope, weight)| moved(sum, slope, weight / 6.0))
    })
}

/// A spine: stations from L4 to T2 and what lies between them.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    links: Vec<Link>,
    /// Stations of the vertebrae.
    vertebrae: Vec<usize>,
    /// Stations of the two erect inflections.
    inflections: [usize; 2],
}

/// A posture of a column.
#[derive(Debug, Clone, PartialEq)]
struct Shape {
    places: Vec<Place>,
    /// What is left above the top; zero in equilibrium.
    left_nmm: f64,
}

impl Column {
    /// The shape above a base wrench, from which the loads on the stations are taken away one by one.
    fn march(&self, base: Wrench, acting: &[Acting]) -> Shape {
        let mut above = base;
        let mut places = vec![Place::default()];
        for (station, link) in (1..).zip(&self.links) {
            let next = link.next(places[station - 1], &above);
            for one in acting.iter().filter(|one| one.station == station) {
                above.force = above.force - one.force;
                above.moment_nmm -= next.point.cross(one.force) + one.couple_nmm;
            }
            places.push(next);
        }
        Shape { places, left_nmm: above.moment_nmm }
    }

    fn erect(&self) -> Shape {
        self.march(Wrench::default(), &[])
    }

    /// Equilibrium under loads on the bodies. The moment at the base is the start and receives the solution.
    fn bend(&self, acting: &[Acting], base_nmm: &mut f64) -> Option<Shape> {
        let force = acting.iter().fold(Frontal::default(), |sum, one| sum + one.force);
        let shape = |moment_nmm: f64| self.march(Wrench { force, moment_nmm }, acting);
        let start = SVector::<f64, 1>::new(*base_nmm);
        let found = newton(start, SVector::<f64, 1>::new(1.0), |base| {
            SVector::<f64, 1>::new(shape(base[0]).left_nmm)
        })?;
        *base_nmm = found[0];
        Some(shape(found[0]))
    }

    /// Equilibrium under a force along the line through both inflections, which carry no moment. The force's lateral tilt and
    /// the base's moment are the start and receive the solution.
    fn bend_through_inflections(&self, force_n: f64, base: &mut [f64; 2]) -> Option<Shape> {
        let wrench = |[tilt_rad, moment_nmm]: [f64; 2]| Wrench {
            force: Frontal::leaning(Angle::from_rad(tilt_rad)) * force_n,
            moment_nmm,
        };
        let found = newton(SVector::from(*base), SVector::from([1e-6, 1.0]), |base| {
            let wrench = wrench((*base).into());
            let shape = self.march(wrench, &[]);
            let moments = self
                .inflections
                .map(|station| wrench.moment_about_nmm(shape.places[station].point));
            SVector::from(moments)
        })?;
        *base = found.into();
        Some(self.march(wrench(*base), &[]))
    }

    /// Sum of the sizes of the joints' turns from another shape.
    fn turns_from(&self, shape: &Shape, other: &Shape) -> Angle {
        let turn =
            |of: &Shape, pair: &[usize]| of.places[pair[1]].tilt_rad - of.places[pair[0]].tilt_rad;
        let pairs = self.vertebrae.windows(2);
        Angle::from_rad(pairs.map(|pair| (turn(shape, pair) - turn(other, pair)).abs()).sum())
    }
}

/// Newton's method on moments in N·mm, with forward differences of given steps; `None` if it does not converge.
fn newton<const N: usize>(
    mut at: SVector<f64, N>,
    steps: SVector<f64, N>,
    miss: impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
) -> Option<SVector<f64, N>> {
    for _ in 0..40 {
        let off = miss(&at);
        if off.amax() < 1e-6 {
            return Some(at);
        }
        let mut slopes = SMatrix::<f64, N, N>::zeros();
        for i in 0..N {
            let mut beside = at;
            beside[i] += steps[i];
            slopes.set_column(i, &((miss(&beside) - off) / steps[i]));
        }
        at -= slopes.try_inverse()? * off;
        if !at.iter().all(|value| value.is_finite()) {
            return None;
        }
    }
    None
}
