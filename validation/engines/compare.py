"""Loads exported models into their engines and compares the shapes under load with Spineline's.

Usage: python compare.py --program path/to/spineline --out folder
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Callable
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import numpy as np

import examples
from cases import Case, Spineline
from films import films
from in_mujoco import MujocoSpine
from in_opensim import OpensimSpine
from in_pinocchio import PinocchioSpine
from statics import NoEquilibrium, Spine, equilibrium

# Engine, format, how its equilibrium is found, and the tolerance in mm.
ENGINES = (
    ("mujoco", "mjcf", MujocoSpine, equilibrium, 1e-6),
    ("mujoco, in time", "mjcf", MujocoSpine, MujocoSpine.settle, 1e-6),
    ("pinocchio", "urdf", PinocchioSpine, equilibrium, 1e-6),
    ("opensim", "osim", OpensimSpine, equilibrium, 1e-6),
)


@dataclass(frozen=True)
class Row:
    """One case in one engine."""

    case: str
    engine: str
    force_n: float
    moved_mm: float
    largest_hinge_rad: float
    erect_difference_mm: float
    difference_mm: float
    tolerance_mm: float
    verdict: str


def main() -> int:
    """0 if every shape agrees, else 1."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="the spineline program")
    parser.add_argument("--out", type=Path, required=True, help="folder for models and results")
    options = parser.parse_args()
    spineline = Spineline(options.program, options.out)
    cases = spineline.cases()
    rows = [compared(case, *engine) for case in cases for engine in ENGINES]
    show(rows)
    write(rows, options.out / "results.csv")
    bad = [row for row in rows if row.verdict != "same"]
    for name, _, _, _, tolerance_mm in ENGINES:
        worst = max(row.difference_mm for row in rows if row.engine == name)
        print(f"{name}: at most {worst:.1e} mm in {len(cases)} cases (allowed {tolerance_mm:g})")
    shown = films(spineline)
    print(*shown, sep="\n")
    examples.run(spineline)
    return 1 if bad or not all(film.good for film in shown) else 0


def compared(
    case: Case,
    engine: str,
    form: str,
    spine_of: type,
    find: Callable[[Spine], np.ndarray],
    tolerance_mm: float,
) -> Row:
    """One case in one engine."""
    spine = spine_of(case.exports[form], case.levels, case.load)
    erect = spine.midpoints_mm(np.zeros(spine.dof))
    verdict, difference, hinge = "no equilibrium", float("inf"), float("nan")
    try:
        q = find(spine)
        difference, hinge = apart(spine.midpoints_mm(q), case.midpoints_mm), np.abs(q).max()
        verdict = "same" if difference <= tolerance_mm else "DIFFERS"
    except NoEquilibrium as reason:
        print(f"{case.name}, {engine}: {reason}", file=sys.stderr)
    return Row(
        case=case.name,
        engine=engine,
        force_n=float(np.linalg.norm(case.load.force_n)),
        moved_mm=apart(erect[-1:], case.midpoints_mm[-1:]),
        largest_hinge_rad=float(hinge),
        erect_difference_mm=apart(erect, case.erect_mm),
        difference_mm=difference,
        tolerance_mm=tolerance_mm,
        verdict=verdict,
    )


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """The largest distance between two midpoints of one vertebra."""
    return float(np.linalg.norm(one - other, axis=1).max())


def show(rows: list[Row]) -> None:
    """Prints a table."""
    wide = max(len(row.case) for row in rows)
    print(f"{'case':{wide}}  engine           force (N)  T2 moves (mm)  hinge (rad)  difference (mm)")
    for row in rows:
        numbers = f"{row.force_n:9.1f}  {row.moved_mm:13.1f}  {row.largest_hinge_rad:11.2f}"
        print(f"{row.case:{wide}}  {row.engine:15}  {numbers}  {row.difference_mm:15.1e}  {row.verdict}")


def write(rows: list[Row], path: Path) -> None:
    """The table as CSV."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(field.name for field in fields(Row))
        table.writerows(astuple(row) for row in rows)


if __name__ == "__main__":
    sys.exit(main())
