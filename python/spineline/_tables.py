"""Tables of results, which pandas, polars, pyarrow and duckdb read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from . import _native
from ._errors import InputError

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


class Table:
    """A table: columns of the same length; names of columns end with units.

    It has the Arrow PyCapsule interface (``__arrow_c_stream__``), so that ``polars.DataFrame(table)``,
    ``pyarrow.table(table)`` and duckdb take it without a copy of the values.

    Examples
    --------
    >>> import spineline as sl
    >>> table = sl.analyze(sl.phantom("rod", subject=1)).tables["multipliers"]
    >>> table.units["multiplier"], table["line"][0]
    ('1', 'inflection_line')
    """

    __slots__ = ("_native",)

    def __init__(self, native: _native.Table) -> None:
        self._native = native

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
        KeyError
            If the column is unknown.
        """
        values = self._native.column(column)
        if values is None:
            raise KeyError(column)
        return values

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The table as a stream of the Arrow C data interface."""
        return self._native.__arrow_c_stream__(requested_schema)

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a pandas DataFrame. Needs pandas and pyarrow (the extra ``pandas``)."""
        frame: pandas.DataFrame = self.to_pyarrow().to_pandas()
        return frame

    def to_polars(self) -> polars.DataFrame:
        """The table as a polars DataFrame. Needs polars (the extra ``polars``)."""
        import polars

        return polars.DataFrame(self)

    def to_pyarrow(self) -> pyarrow.Table:
        """The table as a pyarrow Table, with units and meanings as metadata of its fields. Needs pyarrow."""
        import pyarrow

        return pyarrow.table(self)

    def to_csv(self) -> str:
        """The text of the CSV file that ``spineline analyze --tables`` writes."""
        return self._native.to_csv()

    def __repr__(self) -> str:
        return f"<Table {self.name}: {len(self)} rows, {len(self.columns)} columns>"


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

    def __init__(self, tables: list[_native.Table]) -> None:
        self._all = {table.name: Table(table) for table in tables}

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
