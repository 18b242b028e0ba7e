"""Cases: the films of one patient with their landmarks."""

from __future__ import annotations

import hashlib
import logging
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _native
from ._errors import InputError
from ._export import _Exportable, export_all, with_native
from ._extras import extra
from ._film import Film, FilmOptions, films_of
from ._html import html_table, marked
from ._inputs import file_content, file_name
from ._run import now_utc
from ._tables import LEVELS, Table
from ._values import LARGEST_SEED, decoded, number, text, truth, whole

if TYPE_CHECKING:
    import pandas
    from typing_extensions import Unpack


class Case(_Exportable[_native.Case]):
    """The films of one patient with their landmarks. It does not change.

    Made by :func:`read_case`, :meth:`Case.from_films`, :meth:`Case.from_landmarks`, :meth:`Case.from_json` or :func:`phantom`. Two
    cases are equal if their files are.

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
        return cls(_native.parse_case(decoded(text)))

    @classmethod
    def from_films(cls, films: Iterable[Film], *, case_id: str = "case", synthetic: bool = False) -> Case:
        """Makes a case from films, each with its own picture and scale. Films have no data of the patient, such as sex and age.

        Parameters
        ----------
        films
            Films of one patient, each posture once, at most one lateral film.
        case_id
            Identifier, without any name: 1 to 64 letters, digits, ``.``, ``-`` and ``_``.
        synthetic
            Whether the landmarks are synthetic; also if one of the films is.

        Raises
        ------
        InputError
            If a film is given twice, two films have the same landmarks or picture, or the identifier is not valid.
        TypeError
            If an object is not a film.

        Examples
        --------
        >>> import spineline as sl
        >>> case = sl.phantom("rod", subject=1)
        >>> sl.Case.from_films([case.film("erect"), case.film("traction")], case_id="P07").films
        ['erect', 'traction']
        """
        given = list(films)
        other = next((film for film in given if not isinstance(film, Film)), None)
        if other is not None:
            raise TypeError(f"a case is made from films, not {type(other).__name__}: give objects of `Film`")
        return cls(_case_of([film._native for film in given], case_id, synthetic))

    @classmethod
    def from_landmarks(
        cls, landmarks: Any, *, case_id: str = "case", synthetic: bool = False, **options: Unpack[FilmOptions]
    ) -> Case:
        """Makes a case from landmarks of one film, or of all films in one table with the column ``posture``.

        Parameters
        ----------
        landmarks, **options
            As for :class:`Film`; every film has the same options.
        case_id, synthetic
            As for :meth:`from_films`.

        Raises
        ------
        InputError
            As :class:`Film` and :meth:`from_films`.

        Examples
        --------
        >>> import spineline as sl
        >>> landmarks = sl.phantom("rod", subject=1).landmarks
        >>> sl.Case.from_landmarks(landmarks, mm_per_px=0.14, case_id="P07", synthetic=True).films[0]
        'erect'
        """
        return cls(_case_of(films_of(landmarks, dict(options)), case_id, synthetic))

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
        """Postures that have a film, such as ``"erect"`` or ``"left_bending"``; a lateral film has no posture."""
        return self._native.films

    def film(self, name: str) -> Film:
        """One film, by its posture or ``"lateral"``.

        Raises
        ------
        InputError
            If the film is missing.
        """
        return with_native(Film, _native.film_of(self._native, name))

    @property
    def landmarks(self) -> Table:
        """The landmarks of all frontal films: one row per vertebra and reading, with the columns of the CSV format. The lateral film
        has its own table, ``case.film("lateral").landmarks``.

        Raises
        ------
        InputError
            If some films have corners and some have locations; take ``case.film(NAME).landmarks``.
        """
        table = _native.landmark_table(self._native, False)
        return Table(table, (getattr, (self, "landmarks")), synthetic=self.synthetic)

    def to_csv(self, folder: str | os.PathLike[str], *, film: str | None = None, overwrite: bool = False) -> list[Path]:
        """Writes the landmarks as ``landmarks.csv`` into a folder, which is made if it is missing.

        Parameters
        ----------
        folder
            Folder. The names of the files have no data of the patient.
        film
            Posture of one film; by default all frontal films.
        overwrite
            Whether files that exist are replaced.

        Returns
        -------
        list of Path
            The files. Each is written whole or not at all. The log (``logging``, ``spineline``) names parts of the case for which the
            format has no place.

        Raises
        ------
        InputError
            If the film is missing, the format cannot hold it, or a file is one that the case was made from; then no file is written.
        FileExistsError
            If a file exists and ``overwrite`` was not given; then no file is written.
        OSError
            If a file cannot be written.
        """
        return self._write("csv", folder, film, overwrite)

    def to_slicer(self, folder: str | os.PathLike[str], *, film: str | None = None, overwrite: bool = False) -> list[Path]:
        """Writes point lists for 3D Slicer, such as ``erect.mrk.json``, one per film. Else as :meth:`to_csv`."""
        return self._write("slicer", folder, film, overwrite)

    def to_labelme(self, folder: str | os.PathLike[str], *, film: str | None = None, overwrite: bool = False) -> list[Path]:
        """Writes files of labelme, such as ``erect-1.json``, one per reading. Else as :meth:`to_csv`."""
        return self._write("labelme", folder, film, overwrite)

    def to_coco(self, folder: str | os.PathLike[str], *, film: str | None = None, overwrite: bool = False) -> list[Path]:
        """Writes key points of COCO as ``landmarks.coco.json``. Else as :meth:`to_csv`."""
        return self._write("coco", folder, film, overwrite)

    def to_dicom_sr(
        self,
        folder: str | os.PathLike[str],
        *,
        dicom: Mapping[str, str | os.PathLike[str] | bytes],
        film: str | None = None,
        overwrite: bool = False,
    ) -> list[Path]:
        """Writes DICOM reports, such as ``erect-1.dcm``, one per reading, with Cobb angles. Else as :meth:`to_csv`.

        Parameters
        ----------
        folder, film, overwrite
            As for :meth:`to_csv`.
        dicom
            The DICOM file of every film, by its posture. Reports contain the patient's name and number from these files.

        Raises
        ------
        InputError, FileExistsError
            As :meth:`to_csv`, and if a DICOM file is missing or is not the film with the landmarks: where the case states another
            SHA-256 or another size.
        """
        return self._write("dicom-sr", folder, film, overwrite, dicom)

    def _write(
        self,
        target: str,
        folder: str | os.PathLike[str],
        film: str | None,
        overwrite: bool,
        dicom: Mapping[str, str | os.PathLike[str] | bytes] = {},
    ) -> list[Path]:
        moment = [part.replace(mark, "") for part, mark in zip(now_utc().rstrip("Z").split("T"), "-:", strict=True)]
        files, notes = _native.landmark_files(self._native, target, film, dict(dicom), moment)
        for note in notes:
            logging.getLogger("spineline").warning("%s: %s", self.id, note)
        Path(folder).mkdir(parents=True, exist_ok=True)
        sources = [*self._native.sources, *(_sha256(source) for source in dicom.values())]
        return export_all(folder, dict(files), overwrite=overwrite, sources=sources)

    def check(self) -> Check:
        """Errors and warnings about the films, before any result. Jupyter shows it as a table.

        An error that stops the analysis is a row too; nothing is raised.
        """
        return Check(*self._native.check())

    def __repr__(self) -> str:
        synthetic = ", SYNTHETIC" if self.synthetic else ""
        return f"<Case {self.id}{synthetic}: {', '.join(self._native.views)}>"

    def _repr_html_(self) -> str:
        found = [(one.film, one.severity == "error") for one in self.check() if one.severity != "note"]
        films = dict.fromkeys([*self._native.views, *(film for film, _ in found)])
        rows = [(film or "no film", found.count((film, True)), found.count((film, False))) for film in films]
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
    """The film by its posture, or ``"lateral"``. None if it is about several films or the case; a warning about the lateral film names
    it in the text.
    """
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
        """The findings as a pandas DataFrame, one row each. Vertebrae are ordered categories, the lowest one first. Needs pandas."""
        with extra("pandas"):
            import pandas
        names = list(Finding.__dataclass_fields__)
        rows = [[getattr(finding, name) for name in names] for finding in self.findings]
        levels = pandas.CategoricalDtype(list(LEVELS), ordered=True)
        return pandas.DataFrame(rows, columns=names).astype({"level": levels})

    def __repr__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        return self._html


def _case_of(films: list[_native.Case], case_id: str, synthetic: bool) -> _native.Case:
    """The case of some films.

    Raises
    ------
    InputError
        As :meth:`Case.from_films`.
    """
    return _native.case_of_films(films, text("case_id", case_id), truth("synthetic", synthetic))


def _sha256(source: str | os.PathLike[str] | bytes) -> str:
    """SHA-256 of a file or of its bytes."""
    return hashlib.sha256(source if isinstance(source, bytes) else Path(source).read_bytes()).hexdigest()


def read_case(file: str | os.PathLike[str] | Any) -> Case:
    """Reads a case file, or the case within a file of an analysis.

    Parameters
    ----------
    file
        Path, or an open file, ``zipfile.Path`` or an object of fsspec. Results record its name, without folders, and its SHA-256.

    Raises
    ------
    InputError
        If the file cannot be read or is not a case; it says where, and names the nearest known key.
    TypeError
        If it is neither path nor file.

    Examples
    --------
    >>> import spineline as sl
    >>> path = sl.phantom("rod", subject=1).save("case.json", overwrite=True)
    >>> sl.read_case(path).id
    'phantom-rod-01'
    """
    if isinstance(file, str) and file.lstrip().startswith("{") and not os.path.exists(file):
        raise InputError(
            "a path is needed, not the text of a file", help="`Case.from_json(text)` reads the text of a case"
        )
    if isinstance(file, (str, os.PathLike)):
        return Case(_native.read_case(os.fspath(file)))
    return Case(_native.read_case(file_name(file) or "case.json", file_content(file)))


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
        If the scenario or subject is unknown, or seed or noise are out of range.

    Examples
    --------
    >>> import spineline as sl
    >>> sl.phantom("pull", subject=3, noise=0.0).id
    'phantom-pull-03'
    """
    whose = whole("subject", subject, 1, 18)
    made = text("scenario", scenario), whose, whole("seed", seed, 0, LARGEST_SEED), number("noise", noise, 0.0, 10.0)
    return Case(_native.phantom(*made))
