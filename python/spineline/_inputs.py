"""Files and tables from callers, in the form that the native module reads: a path, or the bytes of a file."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Mapping, Sequence
from typing import Any

from . import _native
from ._errors import InputError
from ._extras import extra
from ._tables import Table


_NUMBERS = "iufOSU"
"""Kinds of numpy types with real numbers: whole, decimal, objects, and texts."""


def file_name(file: Any) -> str:
    """The name of an open file, without folders; empty without a name."""
    name = getattr(file, "name", None) or getattr(file, "path", None)
    return os.path.basename(name) if isinstance(name, str) else ""


def file_content(file: Any) -> bytes:
    """The bytes of an open file, or of an object that opens one, such as ``zipfile.Path`` and the objects of fsspec.

    Raises
    ------
    InputError
        If the file is larger than 64 MB.
    TypeError
        If the object is not a file.
    """
    if hasattr(file, "read"):
        content = file.read(_native.MAX_FILE_BYTES + 1)
    elif hasattr(file, "read_bytes"):
        with file.open("rb") as opened:
            content = opened.read(_native.MAX_FILE_BYTES + 1)
    elif hasattr(file, "__enter__"):
        with file as opened:
            content = opened.read(_native.MAX_FILE_BYTES + 1)
    else:
        raise TypeError(f"a path or a file is needed, not {type(file).__name__}")
    content = content.encode() if isinstance(content, str) else bytes(content)
    if len(content) > _native.MAX_FILE_BYTES:
        name, limit = file_name(file) or "the file", _native.MAX_FILE_BYTES >> 20
        raise InputError(f"{name} has more than {limit} MB", help="give the file of one patient", limit=limit)
    return content


def landmark_source(landmarks: Any, levels: Sequence[str] | None, *, lateral: bool) -> tuple[str | bytes, bool]:
    """The path of a landmark file, its bytes, or a table as CSV; and whether it is a table.

    Raises
    ------
    InputError
        If columns differ in length, an array differs in shape from its levels, or it does not hold real numbers.
    TypeError
        If it is neither file, table nor array.
    """
    import numpy as np

    if levels is not None or isinstance(landmarks, np.ndarray):
        sides = ("anterior", "posterior") if lateral else ("left", "right")
        return _csv_of(_columns_of(landmarks, levels, sides)), True
    if isinstance(landmarks, str):
        is_text = "\n" in landmarks or landmarks.lstrip().startswith("{")
        return landmarks.encode() if is_text else landmarks, False
    if isinstance(landmarks, bytes):
        return landmarks, False
    if isinstance(landmarks, os.PathLike):
        return str(os.fspath(landmarks)), False
    if isinstance(landmarks, Mapping):
        return _csv_of(landmarks), True
    text = _csv_of_table(landmarks)
    return (file_content(landmarks), False) if text is None else (text, True)


def _csv_of_table(table: Any) -> bytes | None:
    """A table as CSV; None for another object."""
    library = type(table).__module__.partition(".")[0]
    if library == "polars":
        frame = table.collect() if hasattr(table, "collect") else table
        return str(frame.write_csv()).encode()
    if library == "pandas":
        return str(table.to_csv(index=False)).encode()
    if isinstance(table, Table):
        return table.to_csv().encode()
    if hasattr(table, "__arrow_c_stream__") or hasattr(table, "__arrow_c_array__"):
        with extra("pandas"):
            import pyarrow
        return _csv_of(pyarrow.table(table).to_pydict())
    return None


def _csv_of(columns: Mapping[str, Sequence[Any]]) -> bytes:
    rows = {name: len(values) for name, values in columns.items()}
    if len(set(rows.values())) > 1:
        words = ", ".join(f"`{name}` {count}" for name, count in rows.items())
        raise InputError(f"the columns have different numbers of rows: {words}", help="give a value for every row")
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return text.getvalue().encode()


def _columns_of(array: Any, levels: Sequence[str] | None, sides: tuple[str, str]) -> dict[str, Sequence[Any]]:
    """The columns of the CSV format from an array."""
    import numpy as np

    corners = [f"{endplate}_{side}" for endplate in ("superior", "inferior") for side in sides]
    given = np.ma.asarray(array)
    try:
        values = np.asarray(given, dtype=np.float64) if given.dtype.kind in _NUMBERS else None
    except (TypeError, ValueError):
        values = None
    if values is None:
        raise InputError(
            f"the array holds values of the type {given.dtype}, which are not numbers of pixels",
            help="give whole or decimal numbers; NaN, or a mask, where a landmark was not placed. `levels` are for arrays alone",
        )
    # A masked value was not placed.
    points = np.where(np.ma.getmaskarray(given), np.nan, values)
    if levels is None or points.shape != (len(levels), 4, 2):
        named = "no `levels`" if levels is None else f"{len(levels)} `levels`"
        raise InputError(
            f"the array has the shape {points.shape} and {named}",
            help=f"give the names of n vertebrae as `levels`, and an array of the shape (n, 4, 2): {', '.join(corners)}, each "
            "with column and row in pixels",
        )
    columns: dict[str, Sequence[Any]] = {"vertebra": levels}
    for place, corner in enumerate(corners):
        for axis, name in enumerate(("column", "row")):
            columns[f"{corner}_{name}_px"] = points[:, place, axis].tolist()
    return columns
