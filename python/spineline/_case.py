"""Cases: the films of one patient with their landmarks."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from . import _native
from ._export import _Exportable
from ._extras import extra
from ._html import html_table, marked

if TYPE_CHECKING:
    import pandas


class Case(_Exportable[_native.Case]):
    """The films of one patient with their landmarks. It does not change.

    Made by :func:`read_case`, :meth:`Case.from_landmarks`, :meth:`Case.from_json` or :func:`phantom`. Two cases are equal
    if their files are.

    Examples
    --------
    >>> import spineline as sl
    >>> case = sl.phantom("rod", subject=1)
    >>> case.id, case.synthetic, case.films[0]
    ('phantom-rod-01', True, 'erect')
    """

    __slots__ = ()

    @classmethod
    def from_json(cls, text: str | bytes) -> Case:
        """Reads a case from the text of its file (``spineline schema case`` explains every key).

        Raises
        ------
        InputError
            If the text is not a case; it says where.
        """
        return cls(_native.parse_case(text.decode() if isinstance(text, bytes) else text))

    @classmethod
    def from_landmarks(
        cls,
        landmarks: Any,
        *,
        film: str | None = None,
        mm_per_px: float | tuple[float, float] | None = None,
        patient_left: Literal["image-left", "image-right"] = "image-left",
        size_px: tuple[int, int] | None = None,
        plane: Literal["patient", "detector", "unknown"] = "unknown",
        case_id: str = "case",
        synthetic: bool = False,
    ) -> Case:
        """Makes a case from a table of landmarks, one row per vertebra.

        Parameters
        ----------
        landmarks
            A DataFrame of pandas or polars, anything with ``to_csv`` or ``write_csv``, a mapping from names of columns to
            values, or the text of a landmark file that ``spineline import`` reads (CSV, 3D Slicer, labelme, COCO). Columns,
            as in the CSV format: ``vertebra``, and column and row of the four corners in pixels, named by the patient's
            sides: ``superior_left_column_px``, ``superior_left_row_px``, and so on for ``superior_right``,
            ``inferior_left``, ``inferior_right``. Optional: ``posture``, ``observer``, ``repeat``, ``axis_clockwise_deg``
            and confidences. A row whose vertebra is ``iliac_crests`` has the tips in the superior columns. Locations in mm
            (``location_left_mm``, ``location_cranial_mm``, ``tilt_right_deg``) may replace corners.
        film
            Posture of the film, such as ``"erect"``, if the table has no column ``posture``.
        mm_per_px
            Distance of pixel centres in mm, one number or (columns, rows); without it, results have angles, but no lengths.
        patient_left
            Side of the stored picture that shows the patient's left. A wrong side is found and refused.
        size_px
            Columns and rows of the pictures; by default the smallest size that holds all landmarks.
        plane
            The plane in which ``mm_per_px`` is true.
        case_id
            Identifier, without any name: 1 to 64 letters, digits, ``.``, ``-`` and ``_``.
        synthetic
            Whether the landmarks are synthetic.

        Raises
        ------
        InputError
            If a landmark is missing, doubled or impossible: with film, vertebra, value and limit.
        """
        spacing = (mm_per_px, mm_per_px) if isinstance(mm_per_px, (int, float)) else mm_per_px
        return cls(
            _native.case_from_landmarks(
                _csv_text(landmarks), case_id, film, spacing, patient_left, size_px, plane, synthetic
            )
        )

    @property
    def id(self) -> str:
        """Identifier, without any name."""
        return self._native.id

    @property
    def synthetic(self) -> bool:
        """Whether the films are synthetic; every result then says so."""
        return self._native.synthetic

    @property
    def films(self) -> list[str]:
        """Postures that have a film, such as ``"erect"`` or ``"left_bending"``."""
        return self._native.films

    def check(self) -> Check:
        """Errors and warnings about the films, before any result. Jupyter shows it as a table.

        An error that stops the analysis is a row too; nothing is raised.
        """
        return Check(*self._native.check())

    def __repr__(self) -> str:
        synthetic = ", SYNTHETIC" if self.synthetic else ""
        return f"<Case {self.id}{synthetic}: {', '.join(self.films)}>"

    def _repr_html_(self) -> str:
        found = self.check()
        rows = [
            (film, *(sum(one.film == film and one.severity == kind for one in found) for kind in ("error", "warning")))
            for film in self.films
        ]
        return html_table(f"Case {marked(self.id, synthetic=self.synthetic)}", ("film", "errors", "warnings"), rows)


@dataclass(frozen=True)
class Finding:
    """An error or a warning about a film.

    Examples
    --------
    >>> import spineline as sl
    >>> [(one.severity, one.film) for one in sl.phantom("rod", subject=1).check() if one.severity == "error"]
    []
    """

    severity: Literal["error", "contradiction", "warning", "note"]
    """How much it matters; an error stops the analysis."""
    code: str
    """Its stable name."""
    step: str
    """The step of the method."""
    film: str | None
    """The film by its posture, or ``"lateral"``."""
    level: str | None
    """The vertebra."""
    text: str
    """What happened and what to do."""


class Check:
    """Errors and warnings about the films of a case: a sequence of :class:`Finding`.

    Examples
    --------
    >>> import spineline as sl
    >>> sl.phantom("rod", subject=1).check().ok
    True
    """

    __slots__ = ("_html", "_text", "findings")

    def __init__(self, rows: list[dict[str, Any]], text: str, html: str) -> None:
        self.findings: tuple[Finding, ...] = tuple(Finding(**row) for row in rows)
        self._text = text
        self._html = html

    @property
    def ok(self) -> bool:
        """Whether no error stops an analysis."""
        return not any(finding.severity == "error" for finding in self.findings)

    def __len__(self) -> int:
        return len(self.findings)

    def __getitem__(self, index: int) -> Finding:
        return self.findings[index]

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    def to_pandas(self) -> pandas.DataFrame:
        """The findings as a pandas DataFrame, one row each. Needs pandas."""
        with extra("pandas"):
            import pandas
        names = list(Finding.__dataclass_fields__)
        rows = [[getattr(finding, name) for name in names] for finding in self.findings]
        return pandas.DataFrame(rows, columns=names)

    def __repr__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        return self._html


def read_case(path: str | os.PathLike[str]) -> Case:
    """Reads a case file, or the case within a file of an analysis.

    Raises
    ------
    InputError
        If the file cannot be read or is not a case; it says where, and names the nearest known key.

    Examples
    --------
    >>> import spineline as sl
    >>> path = sl.phantom("rod", subject=1).save("case.json", overwrite=True)
    >>> sl.read_case(path).id
    'phantom-rod-01'
    """
    return Case(_native.read_case(os.fspath(path)))


def phantom(
    scenario: str = "rod", *, subject: int = 1, seed: int = 1, noise: float = 1.0
) -> Case:
    """Makes a synthetic patient with five films, the same as ``spineline phantom``.

    Parameters
    ----------
    scenario
        Loading scenario, such as ``"rod"``, ``"bend"`` or ``"pull"``.
    subject
        Row of the paper's Table 1, from 1 to 18.
    seed
        Seed of the virtual readers.
    noise
        Factor on the readers' noise, from 0 to 10; 0 for one reader without error.

    Raises
    ------
    InputError
        If the scenario or subject is unknown.

    Examples
    --------
    >>> import spineline as sl
    >>> sl.phantom("pull", subject=3, noise=0.0).id
    'phantom-pull-03'
    """
    return Case(_native.phantom(scenario, subject, seed, noise))


def _csv_text(landmarks: Any) -> str:
    """The text of a landmark file; a table as CSV with commas."""
    if isinstance(landmarks, str):
        return landmarks
    if hasattr(landmarks, "write_csv"):
        return str(landmarks.write_csv())
    if hasattr(landmarks, "to_csv"):
        return str(landmarks.to_csv(index=False))
    if isinstance(landmarks, Mapping):
        import csv
        import io

        text = io.StringIO()
        writer = csv.writer(text)
        writer.writerow(landmarks)
        writer.writerows(zip(*landmarks.values(), strict=True))
        return text.getvalue()
    raise TypeError(
        f"landmarks must be a DataFrame, a mapping of columns or the text of a landmark file, not {type(landmarks).__name__}"
    )
