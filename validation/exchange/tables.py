"""The table of landmarks, read by Python."""

from __future__ import annotations

import csv

from cases import CORNERS, Exported


def compare(exported: Exported) -> int:
    """Number of rows that agree with the case."""
    wanted = {}
    for film in exported.case["films"]:
        for reading in film["readings"]:
            for level, vertebra in reading["vertebrae"].items():
                wanted[film["posture"], reading["observer"], str(reading["repeat"]), level] = vertebra
    rows = 0
    with exported.table.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["vertebra"] == "iliac_crests":
                continue
            vertebra = wanted.pop((row["posture"], row["observer"], row["repeat"], row["vertebra"]))
            for corner in CORNERS:
                place = [float(row[f"{corner}_{axis}_px"]) for axis in ("column", "row")]
                assert place == vertebra[corner], row
            assert row["axis_clockwise_deg"] == "" or float(row["axis_clockwise_deg"]) == vertebra["axis_deg"]
            rows += 1
    assert not wanted, f"not in the table: {sorted(wanted)}"
    return rows
