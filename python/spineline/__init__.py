"""Patient-specific multibody models of scoliotic spines from frontal radiographs.

Research software, not a medical device: no result is meant for the care of a patient.

Lengths are in mm, angles in degrees, forces in newtons where a force is known and else relative. ``y`` is to the patient's
left and ``z`` cranial, from the midpoint of the lowest vertebra (L4); a positive tilt is to the patient's right.

Examples
--------
>>> import spineline as sl
>>> a = sl.analyze(sl.phantom("rod", subject=1))
>>> round(float(a.held_out.location_error_mm.mean()), 1) < 10
True
"""

from __future__ import annotations

from ._analysis import Analysis, Curve, FilmErrors, analyze
from ._case import Case, Check, Finding, phantom, read_case
from ._cohort import Cohort, CohortRun
from ._errors import InputError, NotAResultError
from ._film import Film, FilmOptions
from ._loads import Force, Gravity, Pad, Rod
from ._method import MethodOptions
from ._model import Model, Simulation
from ._native import VERSION as __version__
from ._parts import Part
from ._plot import Plot
from ._replicates import Replicates, Spread, replicates
from ._tables import Table, Tables

__all__ = [
    "Analysis",
    "Case",
    "Check",
    "Cohort",
    "CohortRun",
    "Curve",
    "Film",
    "FilmErrors",
    "FilmOptions",
    "Finding",
    "Force",
    "Gravity",
    "InputError",
    "MethodOptions",
    "Model",
    "NotAResultError",
    "Pad",
    "Part",
    "Plot",
    "Replicates",
    "Rod",
    "Simulation",
    "Spread",
    "Table",
    "Tables",
    "__version__",
    "analyze",
    "phantom",
    "read_case",
    "replicates",
]
