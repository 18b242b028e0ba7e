"""Options of the method."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypedDict

from ._values import numbers, plain


class MethodOptions(TypedDict, total=False):
    """Options of the method, with the names and values of ``spineline analyze --help``.

    Examples
    --------
    >>> import spineline as sl
    >>> options: sl.MethodOptions = {"support": "frontal", "fit": "shape"}
    >>> sl.analyze(sl.phantom("rod", subject=1), **options).is_usable
    True
    """

    method: Literal["default", "paper"]
    """Method; every other option that is given replaces one of its choices."""
    order_rule: str | int
    """Order of the curves: ``"leave-one-out"``, ``"two-inflections"``, ``"paper"``, or 4 to 12."""
    gauge: str
    """Scale constraint: ``"geometric-mean"``, ``"frozen-force"`` or ``"known-force:POSTURE=NEWTON"``."""
    support: Literal["free", "frontal"]
    """Support of the patient."""
    reference: str
    """``"unloaded"``, or ``"loaded:50"``: the springs carry the trunk of a body of 50 kg on the erect film alone."""
    fit: Literal["shape", "ferguson"]
    """Quantity that the stiffness is fitted to."""
    tilt: Literal["endplates", "axis"]
    """Landmarks from which the tilt of a vertebra is measured."""
    amplitude: Literal["l4-t2", "t1-l5"]
    """Vertebrae between which the amplitude of a film is measured."""
    film_lengths: str | float
    """``"per-film"``, ``"as-marked"``, or a standard deviation in percent."""
    end_vertebrae: str
    """``"erect"``, ``"each-film"``, or such as ``"main-thoracic=T12/T5"``."""
    multipliers: Literal["regional", "fixed-regions", "per-joint"]
    """Joints that share a stiffness multiplier."""
    prior: str | float
    """``"none"``, ``"in-vivo"``, or a standard deviation of ln."""
    rotation_prior: str | os.PathLike[str]
    """File of ``spineline learn-prior``: joint rotations of other patients, for predictions without mechanics or with the tilt of T2."""
    stiffness: str | os.PathLike[str]
    """Table to start from: ``"motion-segments"``, ``"in-vitro"``, ``"intact-chest"``, ``"scoliotic-in-vivo"``, ``"coupled"``, or a file."""
    inflections: str | Sequence[str]
    """Inflections set by hand, caudal first, such as ``("L1/T12", "T6")``."""
    min_curve: float
    """Minimum angle of a curve between inflections, in degrees."""
    given_line: Mapping[str, Sequence[float]]
    """Lines of action by posture: y and z of a point in mm, and the lateral tilt in degrees, positive to the right."""
    compare_models: str | Sequence[str]
    """Other loads and bases to compare: ``"all"``, or names."""


def as_words(options: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Options in the words of the command line."""
    return [pair for name, value in options.items() for pair in _as_text(name, value)]


def _as_text(name: str, value: Any) -> list[tuple[str, str]]:
    value = plain(value)
    if isinstance(value, Mapping):
        return [
            (name, f"{key}={','.join(map(repr, numbers(name, parts)))}")
            for key, parts in value.items()
        ]
    if isinstance(value, (list, tuple)):
        return [(name, ",".join(str(part) for part in value))]
    return [(name, os.fspath(value) if isinstance(value, os.PathLike) else str(value))]
