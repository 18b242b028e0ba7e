"""From corners on films to the case, and from the analysis back to places on the films.

Nothing here needs Slicer, so that it is tested without it. The method is in the package ``spineline``; here are only the coordinates of
Slicer: RAS in mm, and IJK of a volume, whose first two numbers are column and row of the film.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
import spineline as sl
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

POSTURES = ("erect", "left_bending", "right_bending", "neutral", "traction")
"""Films of a case, in the order in which the panel shows them."""


@dataclass(frozen=True)
class FilmPoints:
    """A film with its corners, as a Markups node and a volume have them."""

    posture: str
    """One of :data:`POSTURES`."""
    labels: Sequence[str]
    """Names of the points, such as ``T12_superior_left`` or ``T12 SL``, by the patient's side; crests are ``iliac_crest_left`` and ``…_right``."""
    points_ras: ArrayLike
    """Their places in RAS, shape (n, 3)."""
    ras_to_ijk: ArrayLike
    """Matrix of the volume, shape (4, 4)."""
    spacing_mm: tuple[float, float]
    """Distance of columns and of rows."""
    size_px: tuple[int, int]
    """Columns and rows."""
    patient_left: str = "image-right"
    """Side of the film on which the patient's left is; a wrong one is refused, since corners then lie on the wrong sides."""


@dataclass(frozen=True)
class DrawnFilm:
    """What is drawn on a film, in RAS."""

    posture: str
    curve_ras: Floats
    """The fitted curve, the base first, shape (n, 3)."""
    inflections_ras: Floats
    """The inflections of the erect curve where they lie on this film, shape (2, 3), or (0, 3) without inflections."""
    lines_ras: dict[str, Floats] = field(default_factory=dict)
    """Two ends of every line of action that has a model, each of shape (2, 3)."""


def transformed(matrix: ArrayLike, points: ArrayLike) -> Floats:
    """Points after a homogeneous transform, shape (n, 3)."""
    matrix, points = np.asarray(matrix, float), np.asarray(points, float).reshape(-1, 3)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def case_of(films: Iterable[FilmPoints], *, case_id: str, plane: str = "unknown", synthetic: bool = False) -> sl.Case:
    """The case of some films; every result of synthetic ones says that they are.

    Raises
    ------
    spineline.InputError
        If a corner is missing, doubled or impossible: with film, vertebra and what to do.
    """
    found = [
        sl.Film(
            markups(film),
            film=film.posture,
            mm_per_px=film.spacing_mm,
            size_px=film.size_px,
            patient_left=film.patient_left,  # type: ignore[arg-type]
            plane=plane,  # type: ignore[arg-type]
        )
        for film in films
    ]
    if not found:
        raise sl.InputError("no film has points", help="choose a point list and a volume for the erect film at least")
    return sl.Case.from_films(found, case_id=case_id, synthetic=synthetic)


def markups(film: FilmPoints) -> str:
    """The point list in the frame of the film, as Slicer writes films that have no position in the patient."""
    ijk = transformed(film.ras_to_ijk, film.points_ras)
    column_mm, row_mm = film.spacing_mm
    about = {
        "spineline": 1,
        "film": film.posture,
        "observer": "A",
        "repeat": 1,
        "frame": "image",
        "spacing_mm": [column_mm, row_mm],
    }
    points = [
        {
            "label": label,
            "description": json.dumps(about),
            "position": [column_mm * column, row_mm * row, 0.0],
            "positionStatus": "defined",
        }
        for label, (column, row, _) in zip(film.labels, ijk.tolist(), strict=True)
    ]
    markup = {"type": "Fiducial", "name": film.posture, "coordinateSystem": "LPS", "coordinateUnits": "mm", "controlPoints": points}
    return json.dumps({"markups": [markup]})


def drawn(analysis: sl.Analysis, film: FilmPoints) -> DrawnFilm:
    """The curve, the inflections and the lines of action on a film that was analysed."""
    curve = analysis.curve(film.posture)
    ijk_to_ras = np.linalg.inv(np.asarray(film.ras_to_ijk, float))

    def on_film(points_mm: ArrayLike) -> Floats:
        points = np.asarray(points_mm, float).reshape(-1, 2)
        pixels = curve.to_pixels(points)
        return transformed(ijk_to_ras, np.column_stack([pixels, np.zeros(len(pixels))]))

    inflections = curve.inflections_mm
    # Long enough to cross the whole spine.
    reach_mm = float(np.ptp(curve.points_mm[:, 1]))
    lines = {}
    for name, model in analysis.data["models"].items():
        simulated = model["postures"].get(film.posture)
        if simulated is not None:
            point, direction = (np.array(simulated["line"][key]) for key in ("point_mm", "direction"))
            lines[name] = on_film([point - reach_mm * direction, point + reach_mm * direction])
    return DrawnFilm(
        film.posture,
        on_film(curve.points_mm),
        on_film(np.empty((0, 2)) if inflections is None else inflections),
        lines,
    )


def model_ras(model: sl.Model) -> Floats:
    """Midpoints of the erect model in RAS, shape (vertebrae, 3): its own axes are anterior, left and cranial."""
    anterior, left, cranial = model.midpoints_mm.T
    return np.column_stack([-left, anterior, cranial])
