"""Patches around vertebrae, turned along the spine: the input of the second network."""

import numpy as np

PATCH, MAP = 64, 32
"""Samples along a side of the patch, and cells along a side of the map."""
SIDE = 2.5
"""Side of a patch over the distance between neighbouring centres."""


def frames(centres):
    """For ordered centres (x, y): unit vectors along the spine, downwards, and distances between neighbours."""
    steps = np.diff(centres, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    before, after = np.vstack([steps[:1], steps]), np.vstack([steps, steps[-1:]])
    down = before + after
    down /= np.maximum(np.hypot(down[:, 0], down[:, 1]), 1e-9)[:, None]
    return down, (np.append(lengths[0], lengths) + np.append(lengths, lengths[-1])) / 2


def axes(centre, down, length):
    """The patch's origin, and its x and y axis per sample, so that point = origin + (i + 0.5) x + (j + 0.5) y."""
    sample = SIDE * length / PATCH
    x_axis, y_axis = sample * np.array([down[1], -down[0]]), sample * down
    return centre - PATCH / 2 * (x_axis + y_axis), x_axis, y_axis


def bilinear(fine, points):
    """Grey values at points (x, y), where (0.5, 0.5) is the middle of the first pixel; the edge's beyond the film."""
    height, width = fine.shape
    x = np.clip(points[..., 0] - 0.5, 0, width - 1)
    y = np.clip(points[..., 1] - 0.5, 0, height - 1)
    left, top = np.minimum(x.astype(int), max(width - 2, 0)), np.minimum(y.astype(int), max(height - 2, 0))
    right, below = np.minimum(left + 1, width - 1), np.minimum(top + 1, height - 1)
    u, v = x - left, y - top
    upper = fine[top, left] * (1 - u) + fine[top, right] * u
    lower = fine[below, left] * (1 - u) + fine[below, right] * u
    return upper * (1 - v) + lower * v


def patch(fine, centre, down, length):
    """64 x 64 grey values with mean 0 and standard deviation 1, cut at +-3."""
    origin, x_axis, y_axis = axes(centre, down, length)
    steps = np.arange(PATCH) + 0.5
    points = origin + steps[None, :, None] * x_axis + steps[:, None, None] * y_axis
    grey = bilinear(fine, points)
    return np.clip((grey - grey.mean()) / (grey.std() + 1e-3), -3, 3).astype(np.float32)


def to_patch(points, centre, down, length):
    """Points of the film in samples of the patch."""
    origin, x_axis, y_axis = axes(centre, down, length)
    relative = points - origin
    square = (x_axis**2).sum()
    return np.stack([relative @ x_axis, relative @ y_axis], axis=-1) / square


def from_patch(points, centre, down, length):
    """Samples of the patch as points of the film."""
    origin, x_axis, y_axis = axes(centre, down, length)
    return origin + points[..., :1] * x_axis + points[..., 1:] * y_axis
