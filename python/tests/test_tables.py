"""Tables in pandas, polars, pyarrow and DuckDB."""

from __future__ import annotations

import math
import pickle
import sys
import xml.etree.ElementTree
from collections.abc import Callable
from pathlib import Path

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


def test_every_predicted_vertebra_has_a_band(analysis: sl.Analysis) -> None:
    frame = analysis.tables["predictions"].to_pandas()
    assert set(frame.role) == {"left_out_bend", "held_out"}
    true_line = frame[frame.method == "inflection_line"]
    held = true_line.location_error_mm <= true_line.band_95_radius_mm
    assert len(held) == 4 * 14 and held.mean() >= 0.9


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


def test_vertebrae_are_in_the_order_of_the_spine_and_truths_are_boolean(analysis: sl.Analysis) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("polars")
    table = analysis.tables["vertebrae"]
    frame = table.to_pandas().sort_values("level")
    assert frame.level.dtype.ordered and (frame.level.iloc[0], frame.level.iloc[-1]) == ("L4", "T2")
    assert (frame.level < "T10").any() and frame.level.max() == "T2"
    assert frame.fitted.dtype == frame.synthetic.dtype == "boolean"
    assert frame.fitted.isna().sum() == table["fitted"].count(None)
    in_polars = table.to_polars().sort("level")
    assert (in_polars["level"][0], in_polars["level"][-1]) == ("L4", "T2")
    for name in ("inferior", "superior"):
        assert analysis.tables["joints"].to_pandas()[name].dtype.ordered


def test_the_rows_of_a_table_are_dictionaries(analysis: sl.Analysis) -> None:
    for table in analysis.tables.values():
        assert list(table) == table.to_pyarrow().to_pylist()


def test_an_unknown_column_is_named_with_a_similar_one(analysis: sl.Analysis) -> None:
    table = analysis.tables["vertebrae"]
    with pytest.raises(sl.InputError, match="no column `levl`; did you mean `level`") as caught:
        table["levl"]
    assert isinstance(caught.value, KeyError)
    with pytest.raises(TypeError, match="gives the rows"):
        table[0]


def test_pickles_of_tables_and_curves_hold_the_same(analysis: sl.Analysis) -> None:
    for table in analysis.tables.values():
        again = pickle.loads(pickle.dumps(table))
        assert again.to_csv() == table.to_csv() and again.meanings == table.meanings
    curve = analysis.curve("left_bending")
    again = pickle.loads(pickle.dumps(curve))
    assert again.film == curve.film and (again.points_mm == curve.points_mm).all()
    spread = sl.replicates(analysis, n=2).table
    with pytest.raises(sl.InputError, match="cannot be pickled"):
        pickle.dumps(spread)


def test_a_table_is_a_dataset_with_units(analysis: sl.Analysis) -> None:
    pytest.importorskip("xarray")
    table = analysis.tables["vertebrae"]
    rows = table.to_xarray()
    assert rows.sizes == {"row": len(table)}
    found = table.to_xarray("line", "posture", "level")
    errors = found.location_error_mm
    assert errors.attrs["units"] == "mm" and "location error" in errors.attrs["long_name"]
    assert list(found.level.values)[::14] == ["L4", "T2"]
    for row in table:
        value = errors.sel(line=row["line"], posture=row["posture"], level=row["level"]).item() if row["line"] else None
        expected = row["location_error_mm"]
        assert value is None or (math.isnan(value) if expected is None else value == expected)
    with pytest.raises(sl.InputError, match="several rows with the same line"):
        table.to_xarray("line")
    with pytest.raises(sl.InputError, match="no column"):
        table.to_xarray("lines")


def test_errors_of_held_out_films_are_a_data_frame(analysis: sl.Analysis) -> None:
    pytest.importorskip("pandas")
    errors = analysis.held_out
    frame = errors.to_pandas()
    assert list(frame.level) == errors.levels and list(frame.posture) == errors.films
    assert (frame.location_error_mm.to_numpy() == errors.location_error_mm).all()
    assert not frame.fitted.any() and set(frame.line) == {"inflection_line"}
    with pytest.raises(sl.InputError, match="did you mean `iliac_line`"):
        errors.of("iliak")
    with pytest.raises(sl.InputError, match="did you mean `iliac_line`"):
        analysis.model("iliak")


@pytest.mark.parametrize(
    ("module", "call", "packages"),
    [
        ("pandas", lambda a: a.tables["patients"].to_pandas(), "pandas pyarrow"),
        ("pandas", lambda a: a.case.check().to_pandas(), "pandas pyarrow"),
        ("pyarrow", lambda a: a.tables["patients"].to_pyarrow(), "pandas pyarrow"),
        ("polars", lambda a: a.tables["patients"].to_polars(), "polars"),
        ("xarray", lambda a: a.tables["patients"].to_xarray(), "xarray pandas pyarrow"),
        ("matplotlib.pyplot", lambda a: a.plot.lines(), "matplotlib"),
        ("plotly.graph_objects", lambda a: a.plot.model3d(), "plotly"),
    ],
)
def test_a_missing_package_is_named_with_its_command(
    module: str,
    call: Callable[[sl.Analysis], object],
    packages: str,
    analysis: sl.Analysis,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ModuleNotFoundError, match=f"pip install {packages}$"):
        call(analysis)


def test_a_notebook_shows_tables(analysis: sl.Analysis, tmp_path: Path) -> None:
    model = analysis.model()
    path = analysis.case.save(tmp_path / "<b>.json")
    shown = [
        (analysis.case, "left_bending"),
        (analysis.tables["vertebrae"], "the first 10 here"),
        (model, "line of action"),
        (model.simulate(sl.Pad("T9", towards="left", force=4.0)), "Cobb angle, main thoracic (°)"),
        (sl.replicates(analysis, n=3), "97.5 %"),
        (sl.Cohort([path]), "&lt;b&gt;.json"),
    ]
    for item, part in shown:
        text = item._repr_html_()
        assert part in text, type(item)
        # Well-formed: every element is closed.
        tree = xml.etree.ElementTree.fromstring(text)
        body = tree.find("tbody")
        assert tree.tag == "table" and body is not None and len(body)
    for item, _ in shown[:1] + shown[2:4]:
        assert "SYNTHETIC" in item._repr_html_()
