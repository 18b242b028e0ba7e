"""Tables of readings with and without faults, the same on every machine."""

from __future__ import annotations

import numpy as np


def tables(seed: int = 20) -> dict[str, np.ndarray]:
    """Subjects × raters by name; NaN is a missing reading."""
    rng = np.random.default_rng(seed)
    made = {f"random-{i:03}": random(rng) for i in range(190)}
    spread = rng.normal(size=9)
    made |= {
        "two-subjects-1": np.array([[1.0, 2.0], [5.0, 5.5]]),
        "two-subjects-2": rng.normal(size=(2, 4)),
        "exchanged": np.array([[1.0, 2.0], [2.0, 1.0]]),
        "opposed": np.array([[1.0, 9.0], [9.0, 2.0], [2.0, 8.0], [8.0, 1.5]]),
        "perfect": np.repeat(spread[:, None] / 3.0, 3, axis=1),
        "ties": np.full((7, 3), 0.1),
        "rounded": np.round(spread[:, None] + 0.3 * rng.normal(size=(9, 3))),
        "far-off": 1e5 + spread[:, None] + 0.1 * rng.normal(size=(9, 2)),
        "gaps": gappy(rng),
    }
    return made


def random(rng: np.random.Generator) -> np.ndarray:
    """Two-way random effects of widely different sizes."""
    subjects, raters = rng.integers(2, 61), rng.integers(2, 7)
    error, offset = 10.0 ** rng.uniform(-3.0, 1.0), 10.0 ** rng.uniform(-3.0, 1.0)
    # In a third of the tables subjects are equal: coefficients are about zero, and often negative.
    between = 0.0 if rng.random() < 1.0 / 3.0 else 1.0
    table = between * rng.normal(size=(subjects, 1)) + offset * rng.normal(size=(1, raters))
    return table + error * rng.normal(size=(subjects, raters))


def gappy(rng: np.random.Generator) -> np.ndarray:
    """Some readings are missing; every rater has at least one."""
    table = rng.normal(size=(20, 1)) + 0.3 * rng.normal(size=(20, 3))
    table[[2, 5, 5], [0, 1, 2]] = np.nan
    return table
