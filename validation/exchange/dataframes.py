"""The tidy tables, read by pyarrow and pandas, and compared with the analysis of the same run."""

from __future__ import annotations

import json
import math

import pandas
import pyarrow.parquet
from cases import Exported

TYPES = {"text": "string", "number": "double", "integer": "int64", "boolean": "bool"}


def compare(exported: Exported) -> int:
    """Number of values that agree: CSV with Parquet, types and units with the dictionary, errors with the analysis."""
    meanings = pandas.read_csv(exported.tables / "dictionary.csv", keep_default_na=False)
    values = 0
    for name, columns in meanings.groupby("table", sort=False):
        file = pyarrow.parquet.read_table(exported.tables / f"{name}.parquet")
        assert list(columns.column) == file.column_names, name
        assert [TYPES[kind] for kind in columns["type"]] == [str(field.type) for field in file.schema], name
        metadata = {key.decode(): value.decode() for key, value in file.schema.metadata.items()}
        assert json.loads(metadata["spineline.units"]) == dict(zip(columns.column, columns.unit)), name
        assert json.loads(metadata["spineline.provenance"])["films"] == "synthetic", name
        values += same(pandas.read_csv(exported.tables / f"{name}.csv", float_precision="round_trip"), file)
    errors(exported)
    return values


def same(text: pandas.DataFrame, file: pyarrow.Table) -> int:
    """Number of values that are the same in both."""
    binary = file.to_pandas()
    assert text.shape == binary.shape
    for column in binary.columns:
        there = binary[column].notna()
        assert (text[column].notna() == there).all(), column
        for mine, other in zip(text[column][there], binary[column][there]):
            assert mine == other or str(mine).lower() == str(other).lower(), (column, mine, other)
    return text.size


def errors(exported: Exported) -> None:
    """Location errors are equal in table and analysis, which has ten significant digits."""
    vertebrae = pandas.read_parquet(exported.tables / "vertebrae.parquet")
    kept = vertebrae.dropna(subset=["line"]).set_index(["line", "posture", "level"])
    assert kept.index.is_unique
    for line, model in exported.analysis["models"].items():
        for posture, simulation in model["postures"].items():
            found = simulation["location_error_mm"]
            for level, error in (found or {"levels": {}})["levels"].items():
                there = kept.location_error_mm[line, posture, level]
                assert math.isclose(there, error, rel_tol=1e-9), (line, posture, level, there, error)
