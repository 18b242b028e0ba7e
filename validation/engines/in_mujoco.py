"""The MJCF export in MuJoCo: the engine's kinematics, springs and force."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from cases import Load
from statics import NoEquilibrium

# Simulated time in which the load grows, and in which the motion must end, in s.
GROWS_S = 1.0
ENDS_S = 30.0
# Slower than this is rest.
REST_RAD_PER_S = 1e-11


class MujocoSpine:
    """A model with a load on T2."""

    def __init__(self, path: Path, levels: list[str], load: Load) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.data = mujoco.MjData(self.model)
        self.dof = self.model.nv
        self.load = load
        self.top = self.model.body(levels[-1]).id
        self.sites = [self.model.site(f"{level}_midpoint").id for level in levels]

    def unbalance(self, q: np.ndarray, factor: float) -> np.ndarray:
        """At rest, MuJoCo's passive forces are the springs."""
        self._place(q)
        return self.data.qfrc_passive + self._applied(factor)

    def settle(self) -> np.ndarray:
        """Simulates under the load until the model is at rest, as a user would."""
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_forward(self.model, self.data)
        while self.data.time < ENDS_S:
            self.data.qfrc_applied[:] = self._applied(min(1.0, self.data.time / GROWS_S))
            mujoco.mj_step(self.model, self.data)
            if self.data.time > GROWS_S and np.abs(self.data.qvel).max() < REST_RAD_PER_S:
                return self.data.qpos.copy()
        raise NoEquilibrium(f"turns by {np.abs(self.data.qvel).max():.1e} rad/s after {ENDS_S:g} s")

    def _applied(self, factor: float) -> np.ndarray:
        if self.load.on_line:
            point_m = self.load.point_mm / 1000
        else:
            axes = self.data.xmat[self.top].reshape(3, 3)
            point_m = self.data.xpos[self.top] + axes @ self.load.point_mm / 1000
        applied = np.zeros(self.dof)
        force, no_torque = factor * self.load.force_n, np.zeros(3)
        mujoco.mj_applyFT(
            self.model, self.data, force, no_torque, point_m, self.top, applied
        )
        return applied

    def midpoints_mm(self, q: np.ndarray) -> np.ndarray:
        """Sites are at the midpoints."""
        self._place(q)
        return 1000 * self.data.site_xpos[self.sites]

    def _place(self, q: np.ndarray) -> None:
        self.data.qpos[:] = q
        self.data.qvel[:] = 0
        mujoco.mj_forward(self.model, self.data)
