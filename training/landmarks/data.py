"""Reads films and corners of AASCE, and reduces films to the two grids that the networks see."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image
from split import part_of, patient_of

LEVELS = [*(f"T{number}" for number in range(1, 13)), *(f"L{number}" for number in range(1, 6))]
COARSE_HEIGHT, COARSE_WIDTH = 384, 192
"""Grid of the first network, in pixels."""
FINE_HEIGHT, FINE_WIDTH = 896, 512
"""Largest size of the film that the second network's patches are taken from."""


@dataclass
class Film:
    name: str
    patient: int
    part: str
    width_px: int
    height_px: int
    fine: np.ndarray
    """Grey values, reduced to at most 896 x 512 px, as uint8."""
    scale: float
    """Fine pixels per pixel of the film."""
    corners: np.ndarray
    """17 vertebrae (T1 to L5) x 4 corners (upper left, upper right, lower left, lower right as seen) x (x, y) in px of the film."""
    angles_deg: np.ndarray
    """The three Cobb angles of angles.csv."""


def area_weights(size, reduced):
    """Rows: pixels of the reduced axis; columns: share of each pixel of the full axis. Every row sums to one."""
    edges = np.arange(reduced + 1) * (size / reduced)
    low = np.maximum(edges[:-1, None], np.arange(size)[None])
    high = np.minimum(edges[1:, None], np.arange(size)[None] + 1)
    weights = np.maximum(high - low, 0)
    return (weights / weights.sum(axis=1, keepdims=True)).astype(np.float32)


def reduced_size(shape, most_width, most_height):
    """Width and height of a film as large as fits, with the same shape to a pixel. Small films are enlarged."""
    height, width = shape
    scale = min(most_height / height, most_width / width)
    return tuple(min(max(1, int(size * scale + 0.5)), most) for size, most in ((width, most_width), (height, most_height)))


def reduced(grey, most_width, most_height):
    """Area mean of a film on a grid of at most this size."""
    height, width = grey.shape
    reduced_width, reduced_height = reduced_size(grey.shape, most_width, most_height)
    return area_weights(height, reduced_height) @ grey.astype(np.float32) @ area_weights(width, reduced_width).T


def percentile(values, share):
    """The value at rank floor(share x (count - 1) + 0.5) of the sorted values: no interpolation, so that ports agree."""
    ordered = np.sort(values, axis=None)
    return float(ordered[int(share * (ordered.size - 1) + 0.5)])


def normalised(grey):
    """Grey values so that percentile 1 is -1 and percentile 99 is +1, cut at +-1."""
    low, high = percentile(grey, 0.01), percentile(grey, 0.99)
    return np.clip((grey - low) / max(high - low, 1e-6) * 2 - 1, -1, 1).astype(np.float32)


def coarse_input(grey):
    """The input of the first network, 384 x 192, with the film in the middle of zeros; x and y of the film's corner in it."""
    film = normalised(reduced(grey, COARSE_WIDTH, COARSE_HEIGHT))
    height, width = film.shape
    left, top = (COARSE_WIDTH - width) // 2, (COARSE_HEIGHT - height) // 2
    grid = np.zeros((COARSE_HEIGHT, COARSE_WIDTH), np.float32)
    grid[top : top + height, left : left + width] = film
    return grid, left, top


def grid_scale(grey):
    """Coarse pixels per pixel in x and y."""
    width, height = reduced_size(grey.shape, COARSE_WIDTH, COARSE_HEIGHT)
    return np.array([width / grey.shape[1], height / grey.shape[0]])


def grey_of(path):
    return np.asarray(Image.open(path).convert("L"))


def read_films(data, parts=("train", "validation", "test"), faulty_too=False):
    """Films with corners of the named parts, without those that row_flags.csv lists."""
    data = Path(data)
    rows = lambda name: list(csv.reader((data / "labels/training" / name).open(encoding="utf-8")))
    flags = csv.DictReader((data / "row_flags.csv").open(encoding="utf-8"))
    faulty = {int(row["row_index_0based"]) for row in flags if row["split"] == "training"}
    films = []
    table = zip(rows("filenames.csv"), rows("landmarks.csv"), rows("angles.csv"))
    for index, (name, landmarks, angles) in enumerate(table):
        name = name[0]
        if part_of(name) not in parts or (index in faulty and not faulty_too):
            continue
        grey = grey_of(data / "images_training" / name)
        height, width = grey.shape
        values = np.array([float(value) for value in landmarks])
        corners = np.stack([values[:68] * width, values[68:] * height], axis=1).reshape(17, 4, 2)
        fine = np.clip(reduced(grey, FINE_WIDTH, FINE_HEIGHT) + 0.5, 0, 255).astype(np.uint8)
        films.append(
            Film(name, patient_of(name), part_of(name), width, height, fine, fine.shape[0] / height, corners,
                 np.array([float(value) for value in angles]))
        )
    return films
