"""Personalised models, and their shapes under loads."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _native
from ._errors import InputError, NotAResultError
from ._export import _Exportable, export
from ._html import html_table, marked
from ._loads import Load, load_file
from ._values import decoded, number, text, wrong

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


_Format = Literal["mjcf", "osim", "sto", "loads", "urdf", "vtp", "gltf"]
"""Formats of other programs."""


class Model(_Exportable[_native.Model]):
    """A personalised model: vertebrae, joints, springs, and the loads that were found. It does not change.

    Made by :meth:`Analysis.model` or :meth:`Model.from_json`. Two models are equal if their files are.

    Examples
    --------
    >>> import spineline as sl
    >>> model = sl.analyze(sl.phantom("rod", subject=1)).model("inflection")
    >>> model.line, model.absolute, model.midpoints_mm.shape
    ('inflection_line', False, (15, 3))
    >>> model.to_mujoco("spine.xml", overwrite=True).name
    'spine.xml'
    """

    @classmethod
    def from_json(cls, text: str | bytes) -> Model:
        """Reads a model from the text of its file (``spineline analyze CASE --model FILE``).

        Raises
        ------
        InputError
            If the text is not a model; it says where.
        """
        return cls(_native.parse_model_text(decoded(text)))

    @property
    def id(self) -> str:
        """Identifier of the case."""
        return self._native.id

    @property
    def synthetic(self) -> bool:
        """Whether the films are synthetic."""
        return self._native.synthetic

    @property
    def line(self) -> str:
        """The line of action with which it was fitted."""
        return self._native.line

    @property
    def absolute(self) -> bool:
        """Whether forces and springs are in newtons; else only their ratios have a meaning."""
        return self._native.absolute

    @property
    def levels(self) -> list[str]:
        """Names of the vertebrae, the fixed one first."""
        return self._native.levels

    @property
    def midpoints_mm(self) -> Floats:
        """Midpoints of the erect, unloaded vertebrae, shape (vertebrae, 3), read-only: x anterior, y to the patient's left,
        z cranial, in mm from the midpoint of the lowest one.
        """
        return self._native.midpoints()

    @cached_property
    def data(self) -> dict[str, Any]:
        """Every number, as in its file (``spineline schema model`` explains every key)."""
        found: dict[str, Any] = json.loads(self.to_json())
        return found

    def simulate(
        self,
        *loads: Load,
        amplitude_deg: float | None = None,
        towards: Literal["left", "right"] | None = None,
        largest_factor: float | None = None,
        support: Literal["free", "frontal"] | None = None,
        allow_unusable: bool = False,
    ) -> Simulation:
        """Finds the shape of the model under loads, as ``spineline simulate`` does. Ctrl-C ends it.

        Parameters
        ----------
        *loads
            :class:`Force`, :class:`Pad`, :class:`Rod`, :class:`Gravity`, or a load as a dictionary of a load file.
        amplitude_deg, towards
            A lateral tilt of the line from the lowest to the highest vertebra against the axis of the lowest, in degrees from 0 to
            90, and its side: the proportional loads then get the factor that gives this tilt. Without them, the loads have their full
            size.
        largest_factor
            The largest factor of the proportional loads that is tried.
        support
            Support of the patient; by default as in the model.
        allow_unusable
            Whether shape and angles of a search without a result may be read; they are then of the nearest shape.

        Raises
        ------
        InputError
            If a load cannot be applied to this model, or the tilt, its side, the largest factor or the support is out of range.
        TypeError
            If an object is not a load.
        """
        tilt = _tilt_right_deg(amplitude_deg, towards)
        factor = None if largest_factor is None else number("largest_factor", largest_factor)
        on = None if support is None else text("support", support, 'give "free" or "frontal"')
        return Simulation(self, (load_file(loads), tilt, factor, on), allow_unusable=allow_unusable)

    def _export(self, format: _Format, path: str | os.PathLike[str], *, overwrite: bool) -> Path:
        """Writes the model in the format of another program."""
        return export(path, self._native.export(format), overwrite=overwrite, sources=self._native.sources)

    def to_mujoco(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the model for MuJoCo (MJCF), in m, N and rad, with a keyframe and a force per film; whole or not at all. Returns the
        path.

        Raises
        ------
        InputError, OSError
            As :meth:`save`, and if the format has no place for the model, such as for coupled springs.
        """
        return self._export("mjcf", path, overwrite=overwrite)

    def to_opensim_films(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes pose and force of every film as a motion (`.sto`) of the model from :meth:`to_opensim`, in rad, N and m; whole or
        not at all. Returns the path.

        Raises
        ------
        InputError, OSError
            As :meth:`to_mujoco`.
        """
        return self._export("sto", path, overwrite=overwrite)

    def to_opensim_loads(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes OpenSim's ExternalLoads with the forces of the films, which it reads from the motion of :meth:`to_opensim_films` as
        `films.sto` in the same folder; whole or not at all. Returns the path.

        Raises
        ------
        InputError, OSError
            As :meth:`to_mujoco`.
        """
        return self._export("loads", path, overwrite=overwrite)

    def to_opensim(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the model for OpenSim 4, in m, N and rad, with a force per film; whole or not at all. Returns the path.

        Raises
        ------
        InputError, OSError
            As :meth:`to_mujoco`.
        """
        return self._export("osim", path, overwrite=overwrite)

    def to_urdf(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the model as URDF, in m, N and rad; whole or not at all. Returns the path.

        Raises
        ------
        InputError, OSError
            As :meth:`to_mujoco`.
        """
        return self._export("urdf", path, overwrite=overwrite)

    def to_vtk(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the vertebral bodies with their angles as VTK PolyData (`.vtp`), in mm, in the frame of 3D Slicer's files (LPS).

        Whole or not at all. Returns the path.

        Raises
        ------
        InputError, OSError
            As :meth:`to_mujoco`.
        """
        return self._export("vtp", path, overwrite=overwrite)

    def to_gltf(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the vertebral bodies as glTF 2.0 (`.gltf`), in m, with x left, y cranial, z anterior.

        Whole or not at all. Returns the path.

        Raises
        ------
        InputError, OSError
            As :meth:`to_mujoco`.
        """
        return self._export("gltf", path, overwrite=overwrite)

    def __repr__(self) -> str:
        unit = "forces in newtons" if self.absolute else "relative forces"
        synthetic = ", SYNTHETIC" if self.synthetic else ""
        return f"<Model {self.id}{synthetic}: {self.line}, {unit}>"

    def _repr_html_(self) -> str:
        unit = "newtons" if self.absolute else "relative"
        rows = [("line of action", self.line), ("forces", unit), ("vertebrae", f"{self.levels[0]} to {self.levels[-1]}")]
        return html_table(f"Model {marked(self.id, synthetic=self.synthetic)}", (), rows)


def _tilt_right_deg(amplitude_deg: float | None, towards: str | None) -> float | None:
    """The lateral tilt to the patient's right in degrees.

    Raises
    ------
    InputError
        If only one of both is given, the side is unknown, or the amplitude is not from 0 to 90.
    """
    if (amplitude_deg is None) != (towards is None):
        raise InputError("`amplitude_deg` and `towards` belong together", help="give both, or neither")
    if amplitude_deg is None:
        return None
    if towards not in ("left", "right"):
        raise wrong("towards", towards, 'give "left" or "right", the patient\'s side')
    amplitude = number("amplitude_deg", amplitude_deg, 0.0, 90.0)
    return -amplitude if towards == "left" else amplitude


_Asked = tuple[str, float | None, float | None, str | None]
"""Input of a simulation: text of the load file, tilt to the right in degrees, largest factor, support."""


class Simulation(_Exportable[_native.Simulation]):
    """The shape of a model under loads, made by :meth:`Model.simulate`. It does not change.

    Two simulations are equal if their models and their files are. Pickle holds these files and the input, and repeats the
    computation when it is read; a version of Spineline that finds another result is refused.

    Examples
    --------
    >>> import spineline as sl
    >>> model = sl.analyze(sl.phantom("rod", subject=1)).model("inflection")
    >>> r = model.simulate(sl.Force("T2", towards="right", force=1.0), amplitude_deg=5, towards="right")
    >>> r.status, round(r.lateral_tilt_deg, 3)
    ('converged', 5.0)
    """

    __slots__ = ("_allow_unusable", "_asked", "_model", "levels")

    def __init__(self, model: Model, asked: _Asked, *, allow_unusable: bool) -> None:
        super().__init__(model._native.simulate(*asked))
        self._model = model
        self._asked = asked
        self._allow_unusable = allow_unusable
        self.levels = model.levels
        """Names of the vertebrae, the fixed one first."""

    @property
    def status(self) -> str:
        """How the search ended: ``"converged"``, ``"several_equilibria"``, ``"limit_point"``, ``"branch_point"``,
        ``"beyond_human_range"``, ``"unreachable"`` or ``"not_converged"``. Only the first two have a result.
        """
        return self._native.status

    @property
    def is_usable(self) -> bool:
        """Whether the search has a result."""
        return self._native.is_usable

    @property
    def warnings(self) -> list[tuple[str, str]]:
        """Code and text of every warning."""
        return self._native.warnings

    @property
    def midpoints_mm(self) -> Floats:
        """Midpoints of the loaded vertebrae, shape (vertebrae, 3), read-only, in the frame of :attr:`Model.midpoints_mm`.

        Raises
        ------
        NotAResultError
            If the search ended without a result and ``allow_unusable`` was not given.
        """
        self._check()
        points = self._native.midpoints()
        if points is None:
            raise self._no_shape()
        return points

    @property
    def cobb_deg(self) -> dict[str, float]:
        """Cobb angle by region in degrees, positive where convex to the patient's left; empty where endplates are not known.

        Raises
        ------
        NotAResultError
            If the search ended without a result and ``allow_unusable`` was not given.
        """
        return self._angles("cobb")

    @property
    def tilt_range_deg(self) -> dict[str, float]:
        """Tilt of the upper minus tilt of the lower end vertebra by region in degrees, positive where convex to the left.

        Raises
        ------
        NotAResultError
            As :attr:`cobb_deg`.
        """
        return self._angles("tilt_range")

    @property
    def ferguson_deg(self) -> dict[str, float]:
        """Ferguson angle by region in degrees, positive where convex to the patient's left.

        Raises
        ------
        NotAResultError
            As :attr:`cobb_deg`.
        """
        return self._angles("ferguson")

    @property
    def lateral_tilt_deg(self) -> float:
        """Lateral tilt of the line from the lowest to the highest vertebra against the axis of the lowest, in degrees.

        Positive to the patient's right.

        Raises
        ------
        NotAResultError
            As :attr:`cobb_deg`.
        """
        tilt: float = self._all_angles()["lateral_tilt"]
        return tilt

    def _angles(self, name: str) -> dict[str, float]:
        found: dict[str, float] = self._all_angles()[name]
        return found

    def _all_angles(self) -> dict[str, Any]:
        self._check()
        angles = self._native.angles()
        if angles is None:
            raise self._no_shape()
        return angles

    def _no_shape(self) -> NotAResultError:
        return NotAResultError("no shape could be computed", status=self.status)

    def _check(self) -> None:
        if not (self.is_usable or self._allow_unusable):
            raise NotAResultError(
                f"the search ended without a result: {self._native.meaning}; "
                "`simulate(…, allow_unusable=True)` gives the nearest shape",
                status=self.status,
            )

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Simulation)
            and self._model == other._model
            and self.to_json() == other.to_json()
        )

    __hash__ = None

    def __reduce__(self) -> tuple[Any, ...]:
        return (_repeated, (self._model, self._asked, self._allow_unusable, self.to_json()))

    def __repr__(self) -> str:
        synthetic = ", SYNTHETIC" if self._model.synthetic else ""
        return f"<Simulation of {self._model.id}{synthetic}: {self.status}>"

    def _repr_html_(self) -> str:
        rows: list[tuple[str, str | float]] = [("status", self.status)]
        if self.is_usable:
            rows.append(("lateral tilt (°)", self.lateral_tilt_deg))
            rows += [(f"Cobb angle, {region.replace('_', ' ')} (°)", angle) for region, angle in self.cobb_deg.items()]
        rows += [("warning", text) for _, text in self.warnings]
        return html_table(f"Simulation {marked(self._model.id, synthetic=self._model.synthetic)}", (), rows)


def _repeated(model: Model, asked: _Asked, allow_unusable: bool, text: str) -> Simulation:
    """A simulation that is computed again, and must give the same result.

    Raises
    ------
    InputError
        If this version of Spineline finds another result.
    """
    found = Simulation(model, asked, allow_unusable=allow_unusable)
    then, now = (json.loads(one) | {"generator": None} for one in (text, found.to_json()))
    if then != now:
        raise InputError(
            f"{model.id}: this version of Spineline finds another result than the pickled one",
            help="install the same version everywhere",
        )
    return found
