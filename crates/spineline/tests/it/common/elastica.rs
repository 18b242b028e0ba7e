//! Euler's elastica under an end load, by elliptic integrals.

#![expect(clippy::disallowed_methods, reason = "the oracle has its own formulas")]

use std::f64::consts::{FRAC_PI_2, PI};

/// A cantilever of length one and stiffness one under a force at its end.
#[derive(Debug, Clone, Copy)]
pub struct Elastica {
    /// The force.
    pub force: f64,
    /// Where the end lies: across the clamped axis towards the force, and along it.
    pub across: f64,
    pub along: f64,
}

/// The elastica whose end has turned by an angle, under a force at an angle from the clamped axis.
///
/// With ψ the angle from the tangent to the force, ψ″ = F sin ψ, ψ = β where clamped and ψ' = 0 at the end. With
/// k = cos(ψ₁/2) and cos(ψ/2) = k sin φ, arc length becomes dφ / √(1 - k² sin² φ), so that √F = K(k) - F(φ₀, k), the end
/// lies 1 - 2 (E(k) - E(φ₀, k)) / √F along the force and 2 k cos φ₀ / √F across it [bisshopp-drucker-1945]. A force that
/// turns with the end is a dead one whose angle is known after the fact [timoshenko-gere-1961].
pub fn elastica(force_angle: f64, end_turn: f64) -> Elastica {
    let k = (0.5 * (force_angle - end_turn)).cos();
    let start = ((0.5 * force_angle).cos() / k).asin();
    let root = |phi: f64| (1.0 - (k * phi.sin()).powi(2)).sqrt();
    let root_of_force = integral(start, FRAC_PI_2, |phi| 1.0 / root(phi));
    let second_kind = integral(start, FRAC_PI_2, root);
    let with_force = 1.0 - 2.0 * second_kind / root_of_force;
    let across_force = 2.0 * k * start.cos() / root_of_force;
    let (s, c) = force_angle.sin_cos();
    Elastica {
        force: root_of_force * root_of_force,
        across: with_force * s - across_force * c,
        along: with_force * c + across_force * s,
    }
}

/// Gauss-Legendre with five points in 64 panels: rounding only, for integrands without poles nearby.
fn integral(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    const PANELS: usize = 64;
    let (inner, outer) = ((10.0_f64 / 7.0).sqrt() * 2.0, 70.0_f64.sqrt() * 13.0);
    let nodes = [0.0, (5.0 - inner).sqrt() / 3.0, (5.0 + inner).sqrt() / 3.0];
    let weights = [128.0 / 225.0, (322.0 + outer) / 900.0, (322.0 - outer) / 900.0];
    let half = 0.5 * (to - from) / PANELS as f64;
    let panel = |number: usize| {
        let middle = from + half * (2 * number + 1) as f64;
        let pair =
            |i: usize| function(middle - half * nodes[i]) + function(middle + half * nodes[i]);
        half * (weights[0] * function(middle) + weights[1] * pair(1) + weights[2] * pair(2))
    };
    (0..PANELS).map(panel).sum()
}

#[test]
fn the_integrals_equal_tabulated_values() {
    // Oracle: K and E of k² = 1/2, by Γ(1/4): K = Γ(1/4)² / (4 √π), E = K/2 + π / (4 K).
    let gamma_quarter = 3.625_609_908_221_908_f64;
    let first = gamma_quarter.powi(2) / (4.0 * PI.sqrt());
    let second = 0.5 * first + PI / (4.0 * first);
    let root = |phi: f64| (1.0 - 0.5 * phi.sin().powi(2)).sqrt();
    assert!((integral(0.0, FRAC_PI_2, |phi| 1.0 / root(phi)) - first).abs() < 1e-14);
    assert!((integral(0.0, FRAC_PI_2, root) - second).abs() < 1e-14);
}

#[test]
fn a_small_end_load_gives_beam_deflection() {
    // Oracle: the beam of small deflections, across = F / 3, end turn = F / 2; the next term is smaller by the turn squared.
    let small = elastica(FRAC_PI_2, 1e-3);
    assert!((small.force / 2e-3 - 1.0).abs() < 1e-6);
    assert!((small.across / (small.force / 3.0) - 1.0).abs() < 1e-6);
}
