"""Static equilibrium of any engine: Newton on the generalized forces that the engine itself reports."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

# Step of central differences in rad: truncation and rounding both below 1e-9 of a spring.
DIFFERENCE_RAD = 1e-5
# A smaller full Newton step is rounding.
ROUNDING_RAD = 1e-12
# Load steps on the way to the full load.
LOAD_STEPS = 10
MOST_ITERATIONS = 40

Unbalance = Callable[[np.ndarray], np.ndarray]


class Spine(Protocol):
    """An exported model in an engine, with its load."""

    dof: int

    def unbalance(self, q: np.ndarray, factor: float) -> np.ndarray:
        """Generalized forces of springs and of the load times a factor, in N m."""

    def midpoints_mm(self, q: np.ndarray) -> np.ndarray:
        """Midpoints of all vertebrae in Spineline's frame."""


class NoEquilibrium(Exception):
    """Newton's method did not converge."""


def equilibrium(spine: Spine) -> np.ndarray:
    """Hinge angles in rad at which springs balance the full load, found stepwise from the erect posture."""
    q = np.zeros(spine.dof)
    for factor in np.linspace(1 / LOAD_STEPS, 1.0, LOAD_STEPS):
        q = newton(lambda angles: spine.unbalance(angles, factor), q)
    return q


def newton(unbalance: Unbalance, q: np.ndarray) -> np.ndarray:
    """Newton's method; halves steps that do not help, and ends when only rounding is left."""
    force = unbalance(q)
    for _ in range(MOST_ITERATIONS):
        step = np.linalg.solve(jacobian(unbalance, q), -force)
        if np.abs(step).max() < ROUNDING_RAD:
            return q + step
        share = 1.0
        while True:
            tried = unbalance(q + share * step)
            if np.linalg.norm(tried) < np.linalg.norm(force):
                break
            share /= 2
            if share < 1e-6:
                # No step helps: accepted if the step itself is almost zero.
                if np.abs(step).max() < 1e3 * ROUNDING_RAD:
                    return q
                raise NoEquilibrium(f"unbalanced by {np.abs(force).max():.1e} N m")
        q, force = q + share * step, tried
    raise NoEquilibrium(f"unbalanced by {np.abs(force).max():.1e} N m")


def jacobian(unbalance: Unbalance, q: np.ndarray) -> np.ndarray:
    """Central differences, a column per hinge."""
    columns = []
    for i in range(len(q)):
        move = np.zeros(len(q))
        move[i] = DIFFERENCE_RAD
        columns.append((unbalance(q + move) - unbalance(q - move)) / (2 * DIFFERENCE_RAD))
    return np.array(columns).T
