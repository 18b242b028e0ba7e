"""Monte Carlo replicates with perturbed landmarks: how landmark noise affects every number."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

from . import _native
from ._analysis import Analysis
from ._errors import InputError
from ._export import export
from ._html import html_table, marked
from ._progress import Progress, shown
from ._run import command, now_utc
from ._tables import Table
from ._values import LARGEST_SEED, MOST, whole


_SHOWN = 20
"""Numbers in a notebook."""


@dataclass(frozen=True)
class Spread:
    """Distribution of one number over the replicates, in its unit.

    Examples
    --------
    >>> import spineline as sl
    >>> a = sl.analyze(sl.phantom("rod", subject=1))
    >>> spread = sl.replicates(a, n=10, seed=1)["cobb.erect.main_thoracic"]
    >>> spread.unit, spread.count
    ('deg', 10)
    """

    unit: str
    """``"mm"``, ``"px"``, ``"deg"``, ``"segments"``, ``"N"``, ``"relative"`` (a force relative to the nominal stiffness) or ``"1"``."""
    value: float | None
    """Value in the case itself."""
    mean: float | None
    """Mean; None for a multiplier, whose logarithm has one."""
    sd: float | None
    """Standard deviation; None for a multiplier, and of a single replicate."""
    quantiles: tuple[float, float, float, float, float] | None
    """The 2.5, 25, 50, 75 and 97.5 % quantiles; None if fewer than 40 replicates have the number, where it or an end
    is at a bound of the fit, and for distances, absolute errors and counter-rotating joints, which any noise makes larger."""
    grows_with_noise: bool
    """Whether any noise makes the number larger, so that it has no interval: distances, absolute errors and counter-rotating joints."""
    at_bound: bool
    """Whether bounds of the fit determine the value or an end of its interval: the films do not identify it, and it has no interval."""
    replicates_at_bound: int
    """Replicates in which bounds of the fit determine it: its bound, or the bounds of all other multipliers."""
    count: int
    """Replicates that have the number."""


class Replicates(Mapping[str, Spread]):
    """Distributions of every number of an analysis by name, made by :func:`replicates`.

    A name is the kind of the number, then film, vertebra, region or group, end and line, if it has them, separated by
    dots: ``"cobb.erect.main_thoracic"``, ``"multiplier.main_thoracic"``. The line through the inflections is not named,
    other lines are: ``"multiplier.main_thoracic.iliac_line"``.

    Examples
    --------
    >>> import spineline as sl
    >>> found = sl.replicates(sl.analyze(sl.phantom("rod", subject=1)), n=100, seed=1)
    >>> low, high = found.interval("cobb.erect.main_thoracic")
    >>> low < high
    True
    """

    def __init__(self, native: _native.Replicates, analysis: Analysis) -> None:
        self._spreads = {
            name: {**one, "quantiles": None if (q := one["quantiles"]) is None else tuple(q)}
            for name, one in native.spreads().items()
        }
        self._json = native.to_json()
        self._sources = native.sources
        self._table: _native.Table | None = native.table()
        self.id: str = analysis.id
        """Identifier of the case."""
        self.synthetic: bool = analysis.synthetic
        """Whether the films are synthetic."""
        self.n: int = native.count
        """Replicates that were run."""
        self.failed: int = native.failed
        """Replicates whose analysis stopped with an error."""
        self.noise: tuple[str, ...] = tuple(native.noise)
        """The noise of the landmarks, in sentences."""

    def __getitem__(self, name: str) -> Spread:
        """The distribution of a number.

        Raises
        ------
        InputError
            If the name is unknown; the message has a similar one, if any.
        """
        found = self._spreads.get(name)
        if found is None:
            meant = _native.did_you_mean(name, list(self._spreads))
            raise UnknownNumberError(
                f"the number `{name}` is unknown{meant}",
                help="`list(replicates)` gives all names",
            )
        return Spread(**found)

    def __iter__(self) -> Iterator[str]:
        return iter(self._spreads)

    def __len__(self) -> int:
        return len(self._spreads)

    def interval(self, name: str) -> tuple[float, float]:
        """The central 95 % of a number over the replicates, in its unit: the 2.5 and 97.5 % quantiles.

        The interval of a multiplier is a 95 % interval only if the model is exact: ``interval_coverage`` in the JSON says how
        often it holds the true one.

        Raises
        ------
        InputError
            If the name is unknown, the number or an end is at a bound of the fit, fewer than 40 replicates have it, or it is a distance,
            an absolute error or a number of joints: any noise makes these larger, so an interval would be too high.
        """
        found = self[name]
        quantiles = found.quantiles
        if found.at_bound:
            raise InputError(
                f"`{name}` has no interval: it is at a bound of the fit in {found.replicates_at_bound} of {found.count} replicates, and the films do not identify it",
                help="look at `value` and `replicates_at_bound`",
            )
        if found.grows_with_noise:
            raise InputError(
                f"`{name}` has no interval: any noise makes this number larger",
                help="take its `mean` and `sd`, and compare them with its `value`",
            )
        fewest = _native.MIN_REPLICATES
        if quantiles is None:
            raise InputError(
                f"`{name}` has no interval: {found.count} replicates have it, and an interval needs {fewest}",
                help="give n=1000" if self.n < 1000 else "look at its `count`",
                value=found.count,
                limit=fewest,
            )
        return (quantiles[0], quantiles[4])

    @cached_property
    def table(self) -> Table:
        """The table ``uncertainty`` of ``spineline analyze --tables``: one row per number.

        Raises
        ------
        InputError
            If the replicates were unpickled.
        """
        if self._table is None:
            raise InputError(
                "unpickled replicates have no table",
                help="take the distributions by name, or run them again",
            )
        return Table(self._table, synthetic=self.synthetic)

    def to_json(self) -> str:
        """The text of the file of the analysis with all distributions."""
        return self._json

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the analysis with all distributions as JSON; whole or not at all. Returns the path.

        Raises
        ------
        InputError, OSError
            As :meth:`Analysis.save`.
        """
        return export(path, self._json, overwrite=overwrite, sources=self._sources)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Replicates) and self._spreads == other._spreads

    __hash__ = None  # type: ignore[assignment]

    def __copy__(self) -> Replicates:
        return self

    def __deepcopy__(self, memo: object) -> Replicates:
        return self

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in self.__dict__.items() if name != "table"}
        return {**kept, "_table": None}

    def __repr__(self) -> str:
        synthetic = ", SYNTHETIC" if self.synthetic else ""
        return f"<Replicates of {self.id}{synthetic}: {self.n}, of {len(self)} numbers>"

    def _repr_html_(self) -> str:
        shown = [(name, self[name]) for name in islice(self, _SHOWN)]
        rows = [
            (name, one.unit, one.value, one.sd, *(one.quantiles[::4] if one.quantiles else (None, None)))
            for name, one in shown
        ]
        more = f", the first {_SHOWN} here" if len(self) > _SHOWN else ""
        return html_table(
            f"{marked(self.id, synthetic=self.synthetic)}: {self.n} replicates of {len(self)} numbers{more}",
            ("number", "unit", "value", "SD", "2.5 %", "97.5 %"),
            rows,
        )


class UnknownNumberError(InputError, KeyError):
    """A number that an analysis does not have."""


def replicates(
    analysis: Analysis,
    n: int = 1000,
    *,
    noise: float | str = "measured",
    seed: int = 1,
    threads: int = 0,
    progress: Progress = None,
) -> Replicates:
    """Analyses the case again n times with perturbed landmarks. Ctrl-C ends it.

    Parameters
    ----------
    analysis
        The analysis that gives case and options.
    n
        Number of replicates: 1000 for intervals, 10000 for stable ends of intervals.
    noise
        Standard deviation of one reading: ``"measured"`` between the readings of the case (assumed if it has one), or
        in pixels of the film.
    seed
        Seed; the same seed gives the same numbers on any machine and with any number of threads.
    threads
        Number of threads; 0 for all cores.
    progress
        Whether a line on standard error counts the finished replicates; by default if it is a terminal. Or a function, which is
        called with the number of finished and of all replicates; an exception from it ends the call.

    Raises
    ------
    InputError
        If the noise does not apply to this case, or n, seed or threads are out of range.

    Examples
    --------
    >>> import spineline as sl
    >>> found = sl.replicates(sl.analyze(sl.phantom("rod", subject=1)), n=10, noise=0.5, seed=1)
    >>> found.n, found.failed
    (10, 0)
    """
    n = whole("n", n, 2, MOST)
    seed = whole("seed", seed, 0, LARGEST_SEED)
    threads = whole("threads", threads, 0, 65535)
    words = command("replicates", [("n", n), ("noise", noise), ("seed", seed)])
    show = shown(progress, "replicates")
    found = _native.Replicates(
        analysis._native, n, str(noise), seed, threads, words, now_utc(), lambda done: show(done, n)
    )
    return Replicates(found, analysis)
