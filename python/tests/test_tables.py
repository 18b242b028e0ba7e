"""Tables in pandas, polars, pyarrow and DuckDB."""

from __future__ import annotations

import math

import numpy as np
import pytest

import spineline as sl

pyarrow = pytest.importorskip("pyarrow")


def test_every_library_reads_the_same_values(analysis: sl.Analysis) -> None:
    pandas = pytest.importorskip("pandas")
    polars = pytest.importorskip("polars")
    for name, table in analysis.tables.items():
        arrow = table.to_pyarrow()
        frames = table.to_pandas(), table.to_polars()
        assert isinstance(frames[0], pandas.DataFrame) and isinstance(frames[1], polars.DataFrame)
        assert list(frames[0].columns) == frames[1].columns == table.columns == arrow.column_names
        for column in table.columns:
            ours = [None if v is None or v != v else v for v in table[column]]
            assert arrow[column].to_pylist() == ours == frames[1][column].to_list(), (name, column)
            seen = [None if pandas.isna(v) else v for v in frames[0][column]]
            assert seen == ours, (name, column)


def test_duckdb_reads_the_same_values(analysis: sl.Analysis) -> None:
    duckdb = pytest.importorskip("duckdb")
    for name, rows in analysis.tables.items():
        # DuckDB finds the variable `rows` by its name, and reads its stream.
        found = duckdb.sql("select * from rows")
        assert found.columns == rows.columns
        assert found.fetchall() == [tuple(row.values()) for row in rows.to_pyarrow().to_pylist()], name
    vertebrae = analysis.tables["vertebrae"]
    query = "select avg(location_error_mm) from vertebrae where line = 'inflection_line' and not fitted"
    [(mean,)] = duckdb.sql(query).fetchall()
    assert len(vertebrae) and mean == pytest.approx(analysis.held_out.location_error_mm.mean())


def test_units_and_meanings_go_with_the_columns(analysis: sl.Analysis) -> None:
    table = analysis.tables["vertebrae"]
    field = table.to_pyarrow().schema.field("location_error_mm")
    assert field.metadata[b"unit"] == b"mm" == table.units["location_error_mm"].encode()
    assert b"E_LOC" in field.metadata[b"meaning"]
    assert table.row and "location error" in table.meanings["location_error_mm"]


def test_a_stream_can_be_taken_twice_and_dropped(analysis: sl.Analysis) -> None:
    table = analysis.tables["patients"]
    for _ in range(3):
        table.__arrow_c_stream__()
        assert table.to_pyarrow().num_rows == len(table) == 1


def test_a_column_of_numbers_is_an_array(analysis: sl.Analysis) -> None:
    table = analysis.tables["vertebrae"]
    errors = table["location_error_mm"]
    assert errors.dtype == np.float64 and errors.shape == (len(table),)
    assert any(math.isnan(error) for error in errors)
    with pytest.raises(KeyError):
        table["location_error"]
