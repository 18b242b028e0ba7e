"""Corners of vertebrae as angles and logarithms of lengths that do not depend on how a film lies or how large it is.

The same parameters as in `crates/spineline/src/measure/completion/shape.rs`.
"""

import numpy as np
from landmarks import LEVELS

STEPS = [f"{upper}-{lower}" for lower, upper in zip(LEVELS, LEVELS[1:])]
ANGLES = [
    *(f"rotation {step}" for step in STEPS),
    *(f"offset {step}" for step in STEPS),
    *(f"wedge {level}" for level in LEVELS),
    *(f"shear {level}" for level in LEVELS),
]
LENGTHS = [
    *(f"step {step}" for step in STEPS),
    *(f"height {level}" for level in LEVELS),
    *(f"superior {level}" for level in LEVELS),
    *(f"inferior {level}" for level in LEVELS),
]


def angle(vectors):
    return np.arctan2(vectors[..., 1], vectors[..., 0])


def wrapped(angles):
    return (angles + np.pi) % (2 * np.pi) - np.pi


def parameters(corners):
    """Angles in rad, and logarithms of lengths over the geometric mean of the steps between centres."""
    left_above, right_above, left_below, right_below = (corners[:, k] for k in range(4))
    superior, inferior = left_above - right_above, left_below - right_below
    above, below = (left_above + right_above) / 2, (left_below + right_below) / 2
    centre, axis = (above + below) / 2, above - below
    wedge = wrapped(angle(superior) - angle(inferior))
    direction = angle(inferior) + wedge / 2
    shear = wrapped(angle(axis) - np.pi / 2 - direction)
    step = np.diff(centre, axis=0)
    rotation = wrapped(np.diff(direction))
    offset = wrapped(angle(step) - np.pi / 2 - direction[:-1] - rotation / 2)
    length = lambda vectors: np.log(np.hypot(vectors[..., 0], vectors[..., 1]))
    lengths = np.concatenate([length(step), length(axis), length(superior), length(inferior)])
    return np.concatenate([rotation, offset, wedge, shear]), lengths - length(step).mean()


def learn(films, shrinkage=0.05):
    """Mean of the lengths, and covariances of angles and of lengths, over films and their mirror images.

    A mirror image has the opposite angles and the same lengths: angles have the mean zero, and none is correlated with a length.
    Off-diagonal elements are shrunk by a twentieth.
    """
    pairs = [parameters(film.corners) for film in films]
    angles = np.array([pair[0] for pair in pairs])
    lengths = np.array([pair[1] for pair in pairs])
    mean = lengths.mean(axis=0)
    shrunk = lambda matrix: (1 - shrinkage) * matrix + shrinkage * np.diag(np.diag(matrix))
    return mean, shrunk(angles.T @ angles / len(films)), shrunk(np.cov(lengths.T))


def table(films):
    """The lines of the library's table: name, mean, and covariances with the names before it and with itself."""
    mean, angles, lengths = learn(films)
    for names, means, covariance in ((ANGLES, [0.0] * len(ANGLES), angles), (LENGTHS, mean, lengths)):
        for index, name in enumerate(names):
            values = [means[index], *covariance[index, : index + 1]]
            yield " ".join([name, *(f"{value:.4g}" for value in values)])
