"""The OSIM export in OpenSim: the engine's kinematics, springs, prescribed force and inverse dynamics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import opensim

from cases import Load

opensim.Logger.setLevelString("error")
opensim.Logger.removeFileSink()


def to_opensim(vector: np.ndarray) -> list[float]:
    """Spineline's anterior, left, cranial in OpenSim's anterior, cranial, right."""
    x, y, z = (float(component) for component in vector)
    return [x, z, -y]


def from_opensim(vector: opensim.Vec3) -> list[float]:
    """The inverse."""
    return [vector[0], -vector[2], vector[1]]


class OpensimSpine:
    """A model with a load on T2. The load grows with time, so that time is its factor."""

    def __init__(self, path: Path, levels: list[str], load: Load) -> None:
        self.model = opensim.Model(str(path))
        self._add(load, levels[-1])
        self.state = self.model.initSystem()
        self.solver = opensim.InverseDynamicsSolver(self.model)
        coordinates = self.model.getCoordinateSet()
        every = [coordinates.get(i) for i in range(coordinates.getSize())]
        self.places = {c.getName(): self._place_in_state(c) for c in every}
        # Coordinates that the support locks are part of the structure.
        self.free = [self.places[c.getName()] for c in every if not c.getLocked(self.state)]
        self.dof = len(self.free)
        self.rest = opensim.Vector(len(every), 0.0)
        markers = self.model.getMarkerSet()
        self.markers = [markers.get(f"{level}_midpoint") for level in levels]

    def _add(self, load: Load, level: str) -> None:
        force = opensim.PrescribedForce("load", self.model.getBodySet().get(level))
        force.setForceIsInGlobalFrame(True)
        force.setPointIsInGlobalFrame(load.on_line)
        grows = [opensim.LinearFunction(f, 0.0) for f in to_opensim(load.force_n)]
        force.setForceFunctions(*grows)
        place = [opensim.Constant(p) for p in to_opensim(load.point_mm / 1000)]
        force.setPointFunctions(*place)
        # The model owns it; Python must not free it too.
        force.thisown = False
        self.model.addForce(force)

    def _place_in_state(self, coordinate: opensim.Coordinate) -> int:
        """The engine's index of a coordinate, found by moving it."""
        before = self.state.getQ().to_numpy().copy()
        locked = coordinate.getLocked(self.state)
        coordinate.setLocked(self.state, False)
        coordinate.setValue(self.state, 0.125, False)
        place = int(np.argmax(np.abs(self.state.getQ().to_numpy() - before)))
        coordinate.setValue(self.state, 0.0, False)
        coordinate.setLocked(self.state, locked)
        return place

    def unbalance(self, q: np.ndarray, factor: float) -> np.ndarray:
        """Inverse dynamics at rest gives the forces that would balance springs and load."""
        self._place(q)
        self.state.setTime(factor)
        held = self.solver.solve(self.state, self.rest).to_numpy()
        return -held[self.free]

    def midpoints_mm(self, q: np.ndarray) -> np.ndarray:
        """Markers are at the midpoints."""
        self._place(q)
        self.model.realizePosition(self.state)
        places = [from_opensim(marker.getLocationInGround(self.state)) for marker in self.markers]
        return 1000 * np.array(places)

    def _place(self, q: np.ndarray) -> None:
        angles = self.state.updQ()
        for place, angle in zip(self.free, q):
            angles.set(place, float(angle))
