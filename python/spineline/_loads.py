"""Loads of a model."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from . import _native
from ._errors import InputError
from ._values import number, numbers, plain, text

Direction = Literal["left", "right", "cranial", "caudal", "anterior", "posterior"]
Timing = Literal["growing", "held"]


@dataclass(frozen=True)
class Force:
    """A force of fixed direction at the midpoint of a vertebra.

    Examples
    --------
    >>> import spineline as sl
    >>> sl.Force("T2", towards="left", force=8.0).as_load()["force"]
    [0.0, 8.0, 0.0]
    """

    level: str
    """Vertebra, such as ``"T9"``."""
    towards: Direction
    """Direction in the patient's terms."""
    force: float
    """Size: newtons where the model is absolute, because a force was measured; else relative to the nominal stiffness."""
    timing: Timing = "growing"
    """``"held"``: constant, applied first; ``"growing"``: proportional, varied."""

    def as_load(self) -> dict[str, Any]:
        """The load as files have it."""
        force = list(_native.force_vector(text("towards", self.towards), number("force", self.force)))
        return {
            "kind": "force_at_point",
            "level": self.level,
            "force": force,
            "timing": self.timing,
        }


@dataclass(frozen=True)
class Pad:
    """A frictionless pad that pushes a vertebra: with a given force, or as a spring that is advanced.

    Give either ``force``, or ``force_per_mm`` and ``advance_mm``. With ``force`` it pushes with this force wherever the
    vertebra goes. As a spring it touches the erect spine without force, is then advanced, and gives way with its stiffness.

    Examples
    --------
    >>> import spineline as sl
    >>> sl.Pad("T9", towards="right", force_per_mm=0.5, advance_mm=10.0).as_load()["direction"]
    [0.0, -1.0, 0.0]
    """

    level: str
    """Vertebra, such as ``"T9"``."""
    towards: Direction
    """Direction of the push, in the patient's terms."""
    force: float | None = None
    """Force: newtons where the model is absolute, because a force was measured; else relative to the nominal stiffness."""
    force_per_mm: float | None = None
    """Stiffness, in the unit of forces per mm."""
    advance_mm: float | None = None
    """Displacement of the pad."""
    timing: Timing = "growing"
    """``"held"``: constant, applied first; ``"growing"``: proportional, varied."""

    def as_load(self) -> dict[str, Any]:
        """The load as files have it.

        Raises
        ------
        InputError
            If not exactly one of force and spring is given, or a value is not a number.
        """
        if self.force is not None and self.force_per_mm is None and self.advance_mm is None:
            return Force(self.level, self.towards, self.force, self.timing).as_load()
        if self.force is None and self.force_per_mm is not None and self.advance_mm is not None:
            return {
                "kind": "pad",
                "level": self.level,
                "direction": list(_native.force_vector(text("towards", self.towards), 1.0)),
                "force_per_mm": number("force_per_mm", self.force_per_mm),
                "advance_mm": number("advance_mm", self.advance_mm),
                "timing": self.timing,
            }
        raise InputError(
            f"the pad on {self.level} has neither a force nor a spring, or both",
            help="give `force`, or `force_per_mm` and `advance_mm`",
            level=self.level,
        )


@dataclass(frozen=True)
class Rod:
    """A stiff rod between two vertebrae, which keeps their erect pose relative to each other, or prescribes another.

    With frontal support it prescribes the tilt and the lateral place of the upper vertebra alone: the first number of ``turn_deg`` and
    the second one of ``shift_mm``; the others must be zero.

    Examples
    --------
    >>> import spineline as sl
    >>> sl.Rod("L1", "T5", timing="held").as_load()["superior"]
    'T5'
    """

    inferior: str
    """Lower vertebra."""
    superior: str
    """Upper vertebra; where the rod moves it, at least three joints above, with frontal support two."""
    shift_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Displacement of the upper vertebra from its erect pose, in the lower one's axes: anterior, left, cranial."""
    turn_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Rotation vector from its erect pose about these axes."""
    timing: Timing = "growing"
    """``"held"``: constant, applied first; ``"growing"``: proportional, varied."""

    def as_load(self) -> dict[str, Any]:
        """The load as files have it."""
        return {
            "kind": "rod",
            "inferior": self.inferior,
            "superior": self.superior,
            "shift_mm": numbers("shift_mm", self.shift_mm, 3),
            "turn_deg": numbers("turn_deg", self.turn_deg, 3),
            "timing": self.timing,
        }


@dataclass(frozen=True)
class Gravity:
    """The weight of trunk, head and arms, at the midpoints of the vertebrae above the base.

    Examples
    --------
    >>> import spineline as sl
    >>> sl.Gravity(body_weight=500.0).as_load()
    {'kind': 'gravity', 'body_weight': 500.0, 'timing': 'held'}
    """

    body_weight: float
    """Weight of the whole patient, in the unit of forces of the model."""
    timing: Timing = "held"
    """``"held"``: constant, applied first; ``"growing"``: proportional, varied."""

    def as_load(self) -> dict[str, Any]:
        """The load as files have it."""
        return {"kind": "gravity", "body_weight": number("body_weight", self.body_weight), "timing": self.timing}


Load = Force | Pad | Rod | Gravity | dict[str, Any]


def load_file(loads: Iterable[Load]) -> str:
    """The text of the load file with these loads.

    Raises
    ------
    InputError
        If a load has a value that a file cannot hold.
    TypeError
        If an object is not a load.
    """
    given = []
    for load in loads:
        if not isinstance(load, (dict, Force, Pad, Rod, Gravity)):
            raise TypeError(f"a load is a Force, Pad, Rod, Gravity or dictionary, not {type(load).__name__}")
        given.append(load if isinstance(load, dict) else load.as_load())
    try:
        return json.dumps({"format": "spineline-load", "version": 1, "loads": given}, default=_plain, allow_nan=False)
    except ValueError as error:
        raise InputError(f"a load cannot be written: {error}", help="give finite numbers") from None


def _plain(value: Any) -> Any:
    """A value of numpy as one of JSON."""
    found = plain(value)
    if found is value:
        raise InputError(
            f"a load has a value of the type {type(value).__name__}", help="give numbers, texts, lists and dictionaries"
        )
    return found
