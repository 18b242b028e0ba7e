"""The films of exported models: the pose in the file, and the motion from the erect posture under the force in the file."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import opensim

from cases import SUBJECTS, Spineline
from in_opensim import from_opensim

# Tolerance of a pose, which has the digits of the file, and of the end of a motion.
POSE_MM = 1e-6
END_MM = 0.1
# Simulated time, and how often a motion is compared, in s.
ENDS_S = 4.0
OFTEN_S = 0.1

Distance = Callable[[np.ndarray], float]


@dataclass(frozen=True)
class Film:
    """One film in one engine."""

    name: str
    engine: str
    pose_mm: float
    end_mm: float
    # Simulated time after which the motion stays within the tolerance, and time of computation.
    reached_s: float
    wall_s: float

    @property
    def good(self) -> bool:
        return self.pose_mm < POSE_MM and self.end_mm < END_MM

    def __str__(self) -> str:
        return (
            f"{self.name}, {self.engine}: pose {self.pose_mm:.1e} mm, after {ENDS_S:g} s {self.end_mm:.1e} mm, "
            f"within {END_MM:g} mm after {self.reached_s:.1f} s, computed in {self.wall_s:.1f} s"
        )


def films(spineline: Spineline) -> list[Film]:
    """Every film in MuJoCo; the bends to the left in OpenSim, whose steps take longer."""
    found = []
    for subject in SUBJECTS:
        levels, shapes = spineline.films(subject.name)
        assert shapes, f"{subject.name} has no film"
        for posture, film_mm in shapes.items():
            apart = lambda midpoints, film_mm=film_mm: float(np.linalg.norm(midpoints - film_mm, axis=1).max())
            name = f"{subject.name}, {posture}"
            path = spineline.folder / subject.name
            found.append(in_mujoco(name, path.with_suffix(".mjcf"), posture, levels, apart))
            if posture == "left_bending":
                found.append(in_opensim(name, path, posture, levels, list(shapes), apart))
    return found


def moved(apart: Callable[[float], float]) -> tuple[float, float, float]:
    """Distance at the end of a motion, the time after which it stays within the tolerance, and the time of computation."""
    began, reached = time.perf_counter(), float("inf")
    for instant in np.arange(OFTEN_S, ENDS_S + OFTEN_S / 2, OFTEN_S):
        end_mm = apart(float(instant))
        reached = min(reached, float(instant)) if end_mm < END_MM else float("inf")
    return end_mm, reached, time.perf_counter() - began


def in_mujoco(name: str, path: Path, posture: str, levels: list[str], apart: Distance) -> Film:
    """The keyframe, and the motion under the force at its site."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    sites = [model.site(f"{level}_midpoint").id for level in levels]
    top, force = model.body(levels[-1]).id, model.numeric(f"{posture}_force").data

    def midpoints() -> np.ndarray:
        mujoco.mj_forward(model, data)
        return 1000 * data.site_xpos[sites]

    def step_to(instant: float) -> float:
        while data.time < instant:
            arm = data.site(f"{posture}_load").xpos - data.xipos[top]
            data.xfrc_applied[top] = [*force, *np.cross(arm, force)]
            mujoco.mj_step(model, data)
        return apart(midpoints())

    mujoco.mj_resetDataKeyframe(model, data, model.key(posture).id)
    pose_mm = apart(midpoints())
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    return Film(name, "mujoco", pose_mm, *moved(step_to))


def in_opensim(
    name: str, path: Path, posture: str, levels: list[str], postures: list[str], apart: Distance
) -> Film:
    """The row of the motion, and the motion under the force of the model, by the default integrator."""
    model = opensim.Model(str(path.with_suffix(".osim")))
    model.updForceSet().get(f"{posture}_load").set_appliesForce(True)
    state = model.initSystem()
    markers = [model.getMarkerSet().get(f"{level}_midpoint") for level in levels]

    def midpoints(state: opensim.State) -> np.ndarray:
        model.realizePosition(state)
        return 1000 * np.array([from_opensim(marker.getLocationInGround(state)) for marker in markers])

    manager = opensim.Manager(model)
    manager.initialize(state)
    end = moved(lambda instant: apart(midpoints(manager.integrate(instant))))
    poses, state = opensim.TimeSeriesTable(str(path.with_suffix(".sto"))), model.initSystem()
    for coordinate in model.getCoordinateSet():
        angle = poses.getDependentColumn(coordinate.getName())[1 + postures.index(posture)]
        coordinate.setValue(state, angle, False)
    return Film(name, "opensim", apart(midpoints(state)), *end)
