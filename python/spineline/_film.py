"""Films: one radiograph with its landmarks."""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from . import _native
from ._errors import InputError
from ._export import _Exportable, with_native
from ._inputs import landmark_source
from ._tables import Table
from ._values import decoded, path, plain, real, renamed, text, texts, truth, whole, wrong

if TYPE_CHECKING:
    from typing_extensions import Unpack

ImageSide = Literal["image-left", "image-right"]


class FilmOptions(TypedDict, total=False):
    """Facts about a film that its landmarks do not state.

    Examples
    --------
    >>> import spineline as sl
    >>> options: sl.FilmOptions = {"mm_per_px": 0.14, "plane": "detector"}
    >>> sl.Film(sl.phantom().film("erect").landmarks, **options).plane
    'detector'
    """

    film: str | None
    """Name of the film: its posture, such as ``"erect"``, or ``"lateral"``. By default as the landmarks state it."""
    mm_per_px: float | tuple[float, float] | None
    """Distance of pixel centres in mm, one number or (columns, rows). Without it, results have angles, but no lengths."""
    plane: Literal["patient", "detector", "unknown"]
    """The plane in which ``mm_per_px``, or the locations of a table in mm, are true. By default ``"unknown"``. Not for a lateral film."""
    patient_left: ImageSide
    """Side of the stored picture with the patient's left, by default ``"image-left"``. A wrong side is found and refused."""
    patient_anterior: ImageSide
    """Side of the stored picture with the patient's front. A lateral film needs it."""
    simultaneous: bool
    """Whether the lateral film was exposed together with the erect one. By default not."""
    size_px: tuple[int, int] | None
    """Columns and rows of the picture. By default as the file states them, or the smallest size that holds all landmarks."""
    picture: str | os.PathLike[str] | None
    """File of the picture. The case keeps its name and SHA-256, and not its folder: save the case beside it. Needs ``size_px`` if
    the landmarks do not state the size."""
    inverted: bool
    """Whether ``picture`` is shown with inverted grey levels. By default not."""
    columns: Mapping[str, str]
    """Columns of the table with other names than in the CSV format: ``{"level": "vertebra"}``."""
    ignore: Sequence[str]
    """Columns of the table that are skipped, such as remarks. Another unknown column with values is refused."""
    levels: Sequence[str] | None
    """Vertebrae of an array, such as ``["L4", "L3"]``. Files and tables name theirs."""


class Film(_Exportable[_native.Case]):
    """One radiograph with its landmarks. It does not change.

    Made from landmarks, or by :meth:`Case.film`. :meth:`Case.from_films` makes a case from films. Two films are equal if their
    files are: case files with this film alone.

    Parameters
    ----------
    landmarks
        One of these. Landmarks that were not placed are NaN, None, masked or empty. Left and right are the patient's.

        - Path or open file of landmarks: CSV, 3D Slicer, labelme, COCO, a DICOM report of Spineline, AASCE. Also ``zipfile.Path``,
          objects of fsspec, bytes, and the text of a file.
        - Table with one row per vertebra and reading: pandas, polars (also lazy), pyarrow and other Arrow tables, or a mapping
          from names of columns to values. Columns as in the CSV format: ``vertebra``, and column and row of four corners in pixels,
          ``superior_left_column_px``, ``superior_left_row_px``, and so on for ``superior_right``, ``inferior_left`` and
          ``inferior_right``, of a lateral film ``superior_anterior`` and so on. Optional: ``posture``, ``observer``, ``repeat``,
          ``axis_clockwise_deg``, confidences. In the row of the vertebra ``iliac_crests``, the superior columns have the tips.
          ``location_left_mm``, ``location_cranial_mm`` and ``tilt_right_deg`` may replace all corners.
        - Array of the shape (n, 4, 2) with ``levels``: superior left, superior right, inferior left, inferior right, each with column
          and row in pixels; of a lateral film, anterior in place of left.
    **options
        Facts about the film: see :class:`FilmOptions`.

    Raises
    ------
    InputError
        If a landmark is missing, doubled or impossible (with film, vertebra, value and limit), an option is unknown, or its value
        does not fit, or the landmarks are of several films.

    Examples
    --------
    >>> import numpy as np
    >>> import spineline as sl
    >>> top = 1500.0 - 100.0 * np.arange(15)
    >>> corners = [[(400, y), (500, y + 2), (400, y + 70), (500, y + 72)] for y in top]
    >>> levels = ["L4", "L3", "L2", "L1", *(f"T{n}" for n in range(12, 1, -1))]
    >>> film = sl.Film(np.array(corners), film="erect", levels=levels, mm_per_px=0.4)
    >>> film.name, film.mm_per_px, film.landmarks["vertebra"][0]
    ('erect', (0.4, 0.4), 'L4')
    """

    __slots__ = ()

    def __init__(self, landmarks: Any, **options: Unpack[FilmOptions]) -> None:
        found = films_of(landmarks, dict(options))
        if len(found) > 1:
            names = ", ".join(one.films[0] for one in found)
            raise InputError(
                f"the landmarks are of {len(found)} films: {names}",
                help="give one of them as `film`, or make a case of all with `Case.from_landmarks`",
            )
        super().__init__(found[0])

    @classmethod
    def from_json(cls, text: str | bytes) -> Film:
        """Reads a film from the text of a case file with one film.

        Raises
        ------
        InputError
            If the text is not a case, or does not have one film.
        """
        native = _native.parse_case(decoded(text))
        if len(native.views) != 1:
            raise InputError(
                f"the case has {len(native.views)} films", help="read it as a case, and take `case.film(NAME)`"
            )
        return with_native(cls, _native.film_of(native, native.views[0]))

    @property
    def name(self) -> str:
        """Posture of the film, such as ``"erect"``, or ``"lateral"``."""
        return self._native.views[0]

    @property
    def synthetic(self) -> bool:
        """Whether it is a film of a synthetic case, or made from the table of one."""
        return self._native.synthetic

    @property
    def size_px(self) -> tuple[int, int] | None:
        """Columns and rows of the picture; None for locations in mm."""
        image = self._image()
        return (image["columns"], image["rows"]) if image else None

    @property
    def mm_per_px(self) -> tuple[float, float] | None:
        """Distance of columns and of rows in mm, in the plane :attr:`plane`; None if unknown."""
        image = self._image()
        return (image["column_spacing_mm"], image["row_spacing_mm"]) if "column_spacing_mm" in image else None

    @property
    def plane(self) -> str | None:
        """The plane in which millimetres were measured: ``"patient"``, ``"detector"`` or ``"unknown"``; ``"pixels"`` without a
        scale. None for a lateral film, whose scale is found beside the erect film.
        """
        return _native.plane_of(self._native)

    @property
    def patient_left(self) -> str | None:
        """Side of the picture with the patient's left; None for a lateral film and for locations in mm."""
        return _side(self._image().get("patient_left"))

    @property
    def patient_anterior(self) -> str | None:
        """Side of the picture with the patient's front; None for a frontal film."""
        return _side(self._image().get("patient_anterior"))

    @property
    def picture(self) -> str | None:
        """Name of the file of the picture, without folder; None if it is not known."""
        found: str | None = self._image().get("file")
        return found

    @property
    def landmarks(self) -> Table:
        """The landmarks: one row per vertebra and reading, with the columns of the CSV format."""
        table = _native.landmark_table(self._native, self.name == "lateral")
        return Table(table, (getattr, (self, "landmarks")), synthetic=self.synthetic)

    def _image(self) -> dict[str, Any]:
        """The picture as in a case file; empty for locations in mm."""
        case = json.loads(self.to_json())
        [film] = case["films"] or [case["lateral"]]
        found: dict[str, Any] = film.get("image", {})
        return found

    def __repr__(self) -> str:
        scale = "no scale" if self.mm_per_px is None else f"{self.mm_per_px[0]:g} × {self.mm_per_px[1]:g} mm per pixel"
        synthetic = ", SYNTHETIC" if self.synthetic else ""
        return f"<Film {self.name}{synthetic}: {scale}, {len(self.landmarks)} rows of landmarks>"


def films_of(landmarks: Any, options: dict[str, Any]) -> list[_native.Case]:
    """The films of some landmarks, each as a case of one film.

    Raises
    ------
    InputError
        As :class:`Film`.
    """
    known = list(_CHECKS)
    for name in options:
        if name not in known:
            meant = _native.did_you_mean(name, known)
            raise InputError(f"unknown option `{name}`{meant}", help=f"give one of {', '.join(known)}")
    given = {name: _CHECKS[name](name, value) for name, value in options.items() if value is not None}
    lateral = given.get("film") == "lateral"
    source, is_table = landmark_source(landmarks, given.pop("levels", None), lateral=lateral)
    films, remarks = _native.films_of_landmarks(source, {"film": None, "is_table": is_table, **given})
    for remark in remarks:
        logging.getLogger("spineline").warning("landmarks %s", remark)
    if isinstance(landmarks, Table) and landmarks.synthetic:
        return [_native.case_of_films([film], film.id, True) for film in films]
    return films


def _per_pixel(name: str, value: Any) -> float | tuple[float, ...]:
    """One distance, or two. The film refuses one that is not above zero."""
    found = plain(value)
    if not isinstance(found, (list, tuple)):
        return real(name, found)
    if len(found) != 2:
        raise wrong(name, value, "give one number, or one for columns and one for rows")
    return tuple(real(name, one) for one in found)


def _size(name: str, value: Any) -> tuple[int, ...]:
    """Columns and rows."""
    found = plain(value)
    if not isinstance(found, (list, tuple)) or len(found) != 2:
        raise wrong(name, value, "give columns and rows, such as (3000, 4000)")
    return tuple(whole(name, one, 1, 2**32 - 1) for one in found)


_CHECKS: dict[str, Callable[[str, Any], Any]] = {
    "film": text,
    "mm_per_px": _per_pixel,
    "plane": text,
    "patient_left": text,
    "patient_anterior": text,
    "simultaneous": truth,
    "size_px": _size,
    "picture": path,
    "inverted": truth,
    "columns": renamed,
    "ignore": texts,
    "levels": texts,
}
"""What reads the value of every option."""


def _side(found: str | None) -> str | None:
    return None if found is None else found.replace("_", "-")
