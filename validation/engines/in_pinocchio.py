"""The URDF export in Pinocchio: the engine's kinematics and inverse dynamics; springs from the file's extension."""

from __future__ import annotations

import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np
import pinocchio as pin

from cases import Load


class PinocchioSpine:
    """A model with a load on T2."""

    def __init__(self, path: Path, levels: list[str], load: Load) -> None:
        self.model = pin.buildModelFromUrdf(str(path))
        self.model.gravity.setZero()
        self.data = self.model.createData()
        self.dof = self.model.nv
        self.load = load
        self.frames = [self.model.getFrameId(level) for level in levels]
        self.top = self.model.frames[self.frames[-1]].parentJoint
        self.stiffness, self.rest = self._springs(path)

    def _springs(self, path: Path) -> tuple[np.ndarray, np.ndarray]:
        stiffness, rest = np.full(self.dof, np.nan), np.full(self.dof, np.nan)
        for element in xml.parse(path).getroot().iter("gazebo"):
            joint = self.model.getJointId(element.attrib["reference"])
            place = self.model.joints[joint].idx_q
            stiffness[place] = float(element.findtext("springStiffness", "nan"))
            rest[place] = float(element.findtext("springReference", "nan"))
        if not np.isfinite(stiffness + rest).all():
            raise ValueError(f"{path}: a hinge has no spring")
        return stiffness, rest

    def unbalance(self, q: np.ndarray, factor: float) -> np.ndarray:
        """Inverse dynamics at rest gives the forces that would balance the load."""
        self._place(q)
        if self.load.on_line:
            point_m = self.load.point_mm / 1000
        else:
            point_m = self.data.oMf[self.frames[-1]].act(self.load.point_mm / 1000)
        force = factor * self.load.force_n
        wrench = pin.Force(force, np.cross(point_m, force))
        outside = pin.StdVec_Force()
        for joint in range(self.model.njoints):
            own = self.data.oMi[joint].actInv(wrench) if joint == self.top else pin.Force.Zero()
            outside.append(own)
        rest = np.zeros(self.dof)
        held = pin.rnea(self.model, self.data, q, rest, rest, outside)
        return -self.stiffness * (q - self.rest) - held

    def midpoints_mm(self, q: np.ndarray) -> np.ndarray:
        """Links are at the midpoints."""
        self._place(q)
        return 1000 * np.array([self.data.oMf[frame].translation for frame in self.frames])

    def _place(self, q: np.ndarray) -> None:
        pin.framesForwardKinematics(self.model, self.data, q)
