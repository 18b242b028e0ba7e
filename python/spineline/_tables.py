"""Tables of results, which pandas, polars, pyarrow and duckdb read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice
from typing import TYPE_CHECKING, Any

from . import _native
from ._errors import InputError
from ._extras import extra
from ._html import html_table

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow
    import xarray

    from ._analysis import Analysis

LEVELS: tuple[str, ...] = ("S1", *(f"L{n}" for n in range(5, 0, -1)), *(f"T{n}" for n in range(12, 0, -1)), "C7")
"""Names of vertebrae in the order of the tables: the lowest one first."""

_OF_LEVELS = ("level", "vertebra", "inferior", "superior", "plumb_level", "stable_vertebra")
"""Columns that hold names of vertebrae."""

_SHOWN = 10
"""Rows of a table in a notebook."""


class Table:
    """A table: columns of the same length; names of columns end with units.

    Iteration gives the rows. Pickle holds the analysis or the case, and computes the table again.

    It has the Arrow PyCapsule interface (``__arrow_c_stream__``), so that ``polars.DataFrame(table)``,
    ``pyarrow.table(table)`` and duckdb take it without a copy of the values.

    Examples
    --------
    >>> import spineline as sl
    >>> table = sl.analyze(sl.phantom("rod", subject=1)).tables["multipliers"]
    >>> table.units["multiplier"], table["line"][0]
    ('1', 'inflection_line')
    """

    __slots__ = ("_made_by", "_native", "synthetic")

    def __init__(self, native: _native.Table, made_by: tuple[Any, ...] | None = None, *, synthetic: bool) -> None:
        self._native = native
        self.synthetic = synthetic
        """Whether it is of synthetic films."""
        self._made_by = made_by
        """A function and its arguments that compute the table again."""

    @property
    def name(self) -> str:
        """Name, as in the files of ``spineline analyze --tables``."""
        return self._native.name

    @property
    def row(self) -> str:
        """The meaning of one row."""
        return self._native.row

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return self._native.columns

    @property
    def units(self) -> dict[str, str]:
        """Unit of every column that has one."""
        return self._native.units

    @property
    def meanings(self) -> dict[str, str]:
        """Meaning of every column."""
        return self._native.meanings

    def __len__(self) -> int:
        return len(self._native)

    def __getitem__(self, column: str) -> Any:
        """One column: numbers as a read-only float64 array of shape (rows,) with NaN for missing values, others as a list
        with None.

        Raises
        ------
        InputError
            If the column is unknown; the message has a similar one, if any. It is a ``KeyError`` too.
        """
        if not isinstance(column, str):
            raise TypeError(f"a column has a name, not {column!r}; `list(table)` gives the rows")
        values = self._native.column(column)
        if values is None:
            meant = _native.did_you_mean(column, self.columns)
            text = f"the table `{self.name}` has no column `{column}`{meant}"
            raise UnknownColumnError(text, help=f"give one of {', '.join(self.columns)}")
        return values

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """The rows as dictionaries by column, with None for missing values."""
        names = self.columns
        for row in zip(*(self[name] for name in names), strict=True):
            values = (value.item() if hasattr(value, "item") else value for value in row)
            yield {name: None if value != value else value for name, value in zip(names, values, strict=True)}

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The table as a stream of the Arrow C data interface."""
        return self._native.__arrow_c_stream__(requested_schema)

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a pandas DataFrame. Needs pandas and pyarrow (the extra ``pandas``).

        Vertebrae are ordered categories, the lowest one first; truth values have the type ``boolean``, with ``<NA>`` where
        missing.
        """
        with extra("pandas"):
            import pandas
        table = self.to_pyarrow()
        truths = {field.name: "boolean" for field in table.schema if str(field.type) == "bool"}
        frame: pandas.DataFrame = table.to_pandas().astype(truths)
        ordered = self._levels().items()
        return frame.astype({name: pandas.CategoricalDtype(list(levels), ordered=True) for name, levels in ordered})

    def to_polars(self) -> polars.DataFrame:
        """The table as a polars DataFrame. Needs polars (the extra ``polars``).

        Vertebrae are an ``Enum``, the lowest one first.
        """
        with extra("polars"):
            import polars
        return polars.DataFrame(self).with_columns(
            polars.col(name).cast(polars.Enum(levels)) for name, levels in self._levels().items()
        )

    def to_xarray(self, *index: str) -> xarray.Dataset:
        """The table as a Dataset of xarray, with units and meanings as attributes. Needs xarray (the extra ``xarray``).

        Parameters
        ----------
        *index
            Columns whose values become dimensions, such as ``"line", "posture", "level"``; together they must name a row.
            By default the rows are one dimension, ``row``.

        Raises
        ------
        InputError
            If a column is unknown, or two rows have the same index.
        """
        with extra("xarray"):
            import xarray
        frame = self.to_pandas()
        for name in index:
            self[name]
        if index and frame.duplicated(list(index)).any():
            raise InputError(
                f"the table `{self.name}` has several rows with the same {', '.join(index)}",
                help="give more columns as index",
            )
        frame = frame.set_index(list(index)) if index else frame.rename_axis("row")
        found = xarray.Dataset.from_dataframe(frame)
        for name in self.columns:
            values = found[name]
            if values.dtype.kind not in "fiu":
                # Types of pandas have no counterpart in numpy and in files.
                values = xarray.DataArray(values.to_numpy().astype(object), dims=values.dims)
            found[name] = values.assign_attrs(long_name=self.meanings[name])
            if name in self.units:
                found[name].attrs["units"] = self.units[name]
        return found

    def to_pyarrow(self) -> pyarrow.Table:
        """The table as a pyarrow Table, with units and meanings as metadata of its fields. Needs pyarrow."""
        with extra("pandas"):
            import pyarrow
        return pyarrow.table(self)

    def to_csv(self) -> str:
        """The text of the CSV file that ``spineline analyze --tables`` writes."""
        return self._native.to_csv()

    def _levels(self) -> dict[str, tuple[str, ...]]:
        """The order of the values of every column with vertebrae alone; landmarks have the iliac crests among them."""
        found = {name: LEVELS for name in self.columns if name in _OF_LEVELS}
        if "vertebra" in found:
            found["vertebra"] = ("iliac_crests", *LEVELS)
        return {name: levels for name, levels in found.items() if set(self[name]) <= {None, *levels}}

    def __reduce__(self) -> tuple[Any, ...]:
        if self._made_by is None:
            raise InputError(
                f"the table `{self.name}` cannot be pickled", help="pickle its data: `to_pyarrow()`"
            )
        return self._made_by

    def __repr__(self) -> str:
        return f"<Table {self.name}: {len(self)} rows, {len(self.columns)} columns>"

    def _repr_html_(self) -> str:
        rows = [list(row.values()) for row in islice(self, _SHOWN)]
        hidden = len(self) - len(rows)
        more = f", the first {_SHOWN} here" if hidden else ""
        return html_table(f"{self.name}: {len(self)} rows{more}; {self.row}", self.columns, rows)


class Tables(Mapping[str, Table]):
    """All tables of an analysis by name, as ``spineline analyze --tables`` writes them.

    Examples
    --------
    >>> import spineline as sl
    >>> tables = sl.analyze(sl.phantom("rod", subject=1)).tables
    >>> "vertebrae" in tables, len(tables["patients"])
    (True, 1)
    """

    __slots__ = ("_all",)

    def __init__(self, analysis: Analysis) -> None:
        tables = analysis._native.tables()
        self._all = {
            table.name: Table(table, (_table_of, (analysis, table.name)), synthetic=analysis.synthetic) for table in tables
        }

    def __getitem__(self, name: str) -> Table:
        """One table.

        Raises
        ------
        InputError
            If the table is unknown.
        """
        try:
            return self._all[name]
        except KeyError:
            names = ", ".join(self._all)
            text = f"the table `{name}` is unknown{_native.did_you_mean(name, list(self._all))}"
            raise UnknownTableError(text, help=f"give one of {names}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def __repr__(self) -> str:
        return f"<Tables {', '.join(self._all)}>"


class UnknownTableError(InputError, KeyError):
    """A table that an analysis does not have."""


class UnknownColumnError(InputError, KeyError):
    """A column that a table does not have."""


def _table_of(analysis: Analysis, name: str) -> Table:
    """A table that is computed again from the pickled analysis."""
    return analysis.tables[name]
