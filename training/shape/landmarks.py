"""Reads the AASCE landmarks: corners of 17 vertebrae per film, in pixels, in the patient's order."""

import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "landmarks"))
from split import patient_of  # noqa: E402

LEVELS = ["L5", "L4", "L3", "L2", "L1", *(f"T{number}" for number in range(12, 0, -1))]


@dataclass(frozen=True)
class Film:
    """A film of the training split."""

    name: str
    patient: int
    corners: np.ndarray
    """17 vertebrae (L5 to T1) x 4 corners (superior left, superior right, inferior left, inferior right: the patient's) x 2:
    to the patient's left, and cranial, in pixels."""


def read_films(data):
    """All films of the training split that are not listed as faulty."""
    data = Path(data)
    rows = lambda name: csv.reader((data / "labels/training" / name).open(encoding="utf-8"))
    tables = lambda name: csv.DictReader((data / name).open(encoding="utf-8"))
    names = [row[0] for row in rows("filenames.csv")]
    sizes = {
        row["filename"]: (float(row["width_px"]), float(row["height_px"]))
        for row in tables("image_sizes.csv")
        if row["split"] == "training"
    }
    faulty = {int(row["row_index_0based"]) for row in tables("row_flags.csv") if row["split"] == "training"}
    films = []
    for index, (name, row) in enumerate(zip(names, rows("landmarks.csv"))):
        if index in faulty:
            continue
        width, height = sizes[name]
        values = np.array([float(value) for value in row])
        # T1 first; upper left, upper right, lower left, lower right as seen. The patient's left is the right of the picture.
        seen = np.stack([values[:68] * width, -values[68:] * height], axis=1).reshape(17, 4, 2)
        films.append(Film(name, patient_of(name), seen[::-1][:, [1, 0, 3, 2]]))
    return films
