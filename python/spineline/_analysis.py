"""Analyses: the results of all steps for one patient."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _native
from ._case import Case, Finding, read_case
from ._errors import InputError
from ._export import _Exportable, export
from ._method import MethodOptions, as_words
from ._run import command, now_utc, without_folders
from ._tables import Tables
from ._values import decoded, truth

if TYPE_CHECKING:
    import numpy as np
    import pandas
    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from ._model import Model
    from ._plot import Plot

    Floats = NDArray[np.float64]

LineName = Literal["inflection", "iliac", "estimated", "given"]


class Analysis(_Exportable[_native.Analysis]):
    """The results of all steps for one patient, made by :func:`analyze`. It does not change.

    Two analyses are equal if case, options and results are. Pickle holds the file of the analysis and repeats the computation
    when it is read; another version of Spineline is refused. A copy is the object itself.

    Examples
    --------
    >>> import spineline as sl
    >>> a = sl.analyze(sl.phantom("rod", subject=1))
    >>> a.lines
    ['inflection_line', 'iliac_line', 'estimated_line']
    >>> a.save("analysis.json", overwrite=True).name
    'analysis.json'
    """

    @classmethod
    def from_json(cls, text: str | bytes) -> Analysis:
        """Repeats an analysis from the text of its file, as ``spineline rerun`` does.

        Raises
        ------
        InputError
            If the text is not an analysis, or this version of Spineline finds other results.
        """
        return cls(_native.Analysis.repeat(decoded(text)))

    @property
    def id(self) -> str:
        """Identifier of the case."""
        return self._native.id

    @property
    def synthetic(self) -> bool:
        """Whether the films are synthetic."""
        return self._native.synthetic

    @property
    def case(self) -> Case:
        """The case that was analysed, with the file that it was read from. After :meth:`from_json` this file is not known."""
        return Case(self._native.case)

    @property
    def films(self) -> list[str]:
        """Postures that have a film, the erect one first."""
        return self._native.films

    @property
    def lines(self) -> list[str]:
        """Lines of action that have a model, such as ``"inflection_line"``."""
        return self._native.lines

    @property
    def is_usable(self) -> bool:
        """Whether the analysis has a model, its fits converged and its forces were found. Without a bending film or a scale it has
        no model; curves and angles are measured even so.
        """
        return self._native.is_usable

    @property
    def verdict(self) -> list[str]:
        """The conclusions, in sentences."""
        return self._native.verdict

    @property
    def warnings(self) -> list[Finding]:
        """Contradictions, warnings and notes, in the order of the steps."""
        return [Finding(**row) for row in self._native.warnings]

    @cached_property
    def tables(self) -> Tables:
        """Tidy tables by name, as ``spineline analyze --tables`` writes them: ``a.tables["vertebrae"].to_pandas()``."""
        # Another object: tables that held this one would be a cycle in memory.
        return Tables(Analysis(self._native))

    @cached_property
    def data(self) -> dict[str, Any]:
        """Every number, as in the file of the analysis (``spineline schema analysis`` explains every key). Changes of it change nothing
        else.
        """
        found: dict[str, Any] = json.loads(self.to_json())
        return found

    @cached_property
    def _own_data(self) -> dict[str, Any]:
        """The same for figures: callers may change :attr:`data`."""
        found: dict[str, Any] = json.loads(self.to_json())
        return found

    @property
    def held_out(self) -> FilmErrors:
        """Errors on held-out films. They are predictions.

        Raises
        ------
        InputError
            If the analysis has no model.
        """
        return FilmErrors(self, fitted=False)

    @property
    def fitted(self) -> FilmErrors:
        """Errors on fitted films. They are not predictions.

        Raises
        ------
        InputError
            If the analysis has no model.
        """
        return FilmErrors(self, fitted=True)

    def model(self, line: LineName | Literal["auto"] | str = "auto") -> Model:
        """The personalised model with a line of action: ``"inflection"``, ``"iliac"``, ``"estimated"`` or ``"given"``.

        ``"auto"``: the line that predicts held-out films with the smallest error, among lines whose model converged and that
        take one number from each film. If no line predicts a film: the first one with a result. :attr:`Model.line` says which.

        Raises
        ------
        InputError
            If the analysis has no model with this line, or no model at all.
        """
        from ._model import Model

        key = "auto" if line == "auto" else _line_key(self, line)
        return Model(_native.Model(self._native, key))

    @property
    def plot(self) -> Plot:
        """Figures: ``a.plot.lines()`` and ``a.plot.errors()`` with matplotlib, ``a.plot.model3d()`` with plotly."""
        from ._plot import Plot

        return Plot(self)

    def curve(self, film: str) -> Curve:
        """The fitted curve of a film, such as ``"erect"``.

        Raises
        ------
        InputError
            If the film is missing.
        """
        return Curve(self._native, film)

    def figure(self, name: Literal["overview", "rotations"] | str = "overview") -> str:
        """A figure as SVG text: ``"overview"``, ``"rotations"``, or a film for its measured and simulated shapes.

        Raises
        ------
        InputError
            If the film is missing, or the figure has nothing to show.
        """
        known = name in ("overview", "rotations")
        svg = self._native.figure(name) if known else self._native.figure("simulated", name)
        if svg is None:
            raise InputError(
                f"{self.id}: the figure `{name}` has nothing to show",
                help="it needs films other than the erect one, and a model",
            )
        return svg

    def summary(self) -> str:
        """The results in about a page of text, as ``spineline analyze`` prints them."""
        return self._native.summary()

    def report(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the report as one HTML file, as ``spineline report`` does; whole or not at all. Returns the path.

        Raises
        ------
        InputError, OSError
            As :meth:`save`.
        """
        return export(path, self._native.report_html(), overwrite=overwrite, sources=self._native.sources)

    def __repr__(self) -> str:
        synthetic = ", SYNTHETIC" if self.synthetic else ""
        lines = ", ".join(self.lines) or "no model"
        return f"<Analysis {self.id}{synthetic}: {len(self.films)} films; {lines}>"

    def _repr_html_(self) -> str:
        return self._native.overview_html()


class Curve:
    """The fitted curve of a film, with the points on it. Arrays are read-only.

    Examples
    --------
    >>> import spineline as sl
    >>> curve = sl.analyze(sl.phantom("rod", subject=1)).curve("erect")
    >>> curve.levels[0], curve.locations_mm.shape
    ('L4', (15, 2))
    """

    __slots__ = ("_native", "film")

    def __init__(self, native: _native.Analysis, film: str) -> None:
        self._native = native
        self.film = native.film_name(film)

    @property
    def points_mm(self) -> Floats:
        """Points of the curve from the lowest vertebra upwards at equal distances, shape (n, 2), float64.

        Columns: y to the patient's left, z cranial, in mm from the midpoint of the lowest vertebra (L4), in the frame of its
        axis, and in the film's plane.

        Raises
        ------
        InputError
            If the film has no spacing.
        """
        return self._native.curve_points(self.film)

    @property
    def locations_mm(self) -> Floats:
        """Measured midpoints of the vertebrae, lowest first, shape (vertebrae, 2), in the frame of :attr:`points_mm`.

        Raises
        ------
        InputError
            If the film has no spacing.
        """
        return self._native.locations(self.film)[1]

    @property
    def levels(self) -> list[str]:
        """Names of the vertebrae of :attr:`locations_mm`."""
        return self._native.locations(self.film)[0]

    @property
    def inflections_mm(self) -> Floats | None:
        """Places of the two inflections of the erect curve on this film, the caudal one first, shape (2, 2), in the frame of
        :attr:`points_mm`; None where the erect curve does not have both.

        Raises
        ------
        InputError
            If the film has no spacing.
        """
        return self._native.inflections(self.film)

    def to_pixels(self, points_mm: Any) -> Floats:
        """Places of points on the picture of the film, shape (n, 2), read-only: column and row in pixels.

        Parameters
        ----------
        points_mm
            Points in the frame of :attr:`points_mm`, shape (n, 2), such as the curve itself or points of a line of action.

        Raises
        ------
        InputError
            If the film has no spacing, or no picture: its locations came from another program.
        """
        pixels = self._native.to_pixels(self.film, [(float(y), float(z)) for y, z in points_mm])
        if pixels is None:
            raise InputError(
                f"the {self.film} film has no picture",
                help="only films with corners in pixels have one",
                film=self.film,
            )
        return pixels

    def __reduce__(self) -> tuple[Any, ...]:
        return (Analysis.curve, (Analysis(self._native), self.film))

    def __repr__(self) -> str:
        return f"<Curve of the {self.film} film>"


class FilmErrors:
    """Errors of a model on its fitted films, or on films that were held out; one entry per vertebra and film.

    By default of the line through the inflections, or, without its model, of the first line of :attr:`Analysis.lines`; :meth:`of`
    gives another line.

    Examples
    --------
    >>> import spineline as sl
    >>> errors = sl.analyze(sl.phantom("rod", subject=1)).held_out
    >>> bool(errors.location_error_mm.mean() < errors.of("iliac").location_error_mm.mean())
    True
    """

    __slots__ = ("_analysis", "_rows", "is_fitted", "line")

    def __init__(self, analysis: Analysis, *, fitted: bool, line: str | None = None) -> None:
        if line is None:
            check_models(analysis)
            names = analysis.lines
            line = "inflection_line" if "inflection_line" in names else names[0]
        key = _line_key(analysis, line)
        self._analysis = analysis
        self.line = key
        self.is_fitted = fitted
        table = analysis.tables["vertebrae"]
        rows = zip(table["line"], table["fitted"], table["location_error_mm"], strict=True)
        self._rows = [
            row
            for row, (own, is_fitted, error) in enumerate(rows)
            if own == key and is_fitted is fitted and error == error
        ]

    def of(self, line: LineName | str) -> FilmErrors:
        """The same for another line: ``"inflection"``, ``"iliac"``, ``"estimated"`` or ``"given"``.

        Raises
        ------
        InputError
            If the analysis has no model with this line.
        """
        return FilmErrors(self._analysis, fitted=self.is_fitted, line=line)

    @property
    def location_error_mm(self) -> Floats:
        """Distances of simulated from measured midpoints in mm, shape (n,), read-only: without the fixed base,
        without interpolated vertebrae, and without films whose force was not found.
        """
        errors: Floats = self._analysis.tables["vertebrae"]["location_error_mm"][self._rows]
        errors.flags.writeable = False
        return errors

    @property
    def films(self) -> list[str]:
        """The film of every entry."""
        films = self._analysis.tables["vertebrae"]["posture"]
        return [films[row] for row in self._rows]

    @property
    def levels(self) -> list[str]:
        """The vertebra of every entry."""
        levels = self._analysis.tables["vertebrae"]["level"]
        return [levels[row] for row in self._rows]

    def to_pandas(self) -> pandas.DataFrame:
        """The rows of the table ``vertebrae`` for these entries, as a pandas DataFrame. Needs the extra ``pandas``."""
        return self._analysis.tables["vertebrae"].to_pandas().iloc[self._rows].reset_index(drop=True)

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        kind = "fitted" if self.is_fitted else "held out"
        films = ", ".join(dict.fromkeys(self.films)) or "no film"
        return f"<FilmErrors of the {self.line}, {kind}: {films}>"


def analyze(
    case: Case | str | os.PathLike[str] | Any, *, identifiability: bool = False, **options: Unpack[MethodOptions]
) -> Analysis:
    """Runs all steps of the method. Other Python threads run meanwhile.

    Ctrl-C ends the call at once. A computation of seconds may run on in the background; its result is dropped.

    Parameters
    ----------
    case
        The films, or a case file as :func:`read_case` reads it.
    identifiability
        Whether to compute which multipliers the films identify: 95 % intervals of the mean stiffness of their joints, from the
        joint rotations of all films (``interval_coverage`` in the JSON says how often they hold the true one), and profile
        likelihoods from the bends.
    **options
        Options of the method by their names on the command line, with ``_``: see :class:`MethodOptions`.

    Raises
    ------
    InputError
        If an option or its value is unknown (the help has a similar name, or all values), or the case cannot be analysed: with
        film, vertebra, value and limit.

    Examples
    --------
    >>> import spineline as sl
    >>> a = sl.analyze(sl.phantom("rod", subject=1), support="frontal")
    >>> a.is_usable, len(a.films)
    (True, 5)
    """
    if not isinstance(case, Case):
        case = read_case(case)
    words = as_words(dict(options))
    recorded: list[tuple[str, Any]] = [*without_folders(words)]
    if truth("identifiability", identifiability):
        recorded.append(("identifiability", True))
    call = command("analyze", recorded)
    return Analysis(_native.Analysis(case._native, words, identifiability, call, now_utc()))


def _line_key(analysis: Analysis, line: str) -> str:
    """The name in files of a line that has a model.

    Raises
    ------
    InputError
        If the analysis has no model, or none with this line; the message has a similar one, if any.
    """
    check_models(analysis)
    key, names = line if line.endswith("_line") else f"{line}_line", analysis.lines
    if key not in names:
        raise InputError(
            f"{analysis.id}: the analysis has no model with the line `{key}`{_native.did_you_mean(key, names)}",
            help=f"give one of {', '.join(names)}",
        )
    return key


def check_models(analysis: Analysis) -> None:
    """Refuses an analysis without a model.

    Raises
    ------
    InputError
        If the analysis has no model.
    """
    if not analysis.lines:
        raise InputError(
            f"{analysis.id}: the analysis has no model",
            help="a model needs a bending film with a line of action, and the scale of every film",
        )
