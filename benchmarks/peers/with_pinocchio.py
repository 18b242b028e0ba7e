"""Pinocchio: three revolute joints per vertebra; `computeJointJacobians` leaves the screws in `data.J`."""

import numpy as np
import pinocchio as pin

NAME = "pinocchio"
VERSION = pin.__version__
CANNOT = [
    "URDF has no springs and Pinocchio no static solver: springs and Newton are the user's own",
    "computeStaticTorqueDerivatives takes forces fixed in the joints' frames; for a line fixed in space the load's "
    "stiffness (unsymmetric) is the user's own formula from data.J",
    "no search for a force that reaches an amplitude, no derivatives by stiffness",
]


def build(spine):
    """The model, and the frames at the midpoints of L3…T2."""
    centre, rise, rest = spine.relative_poses()
    model, frames = pin.Model(), []
    parent, onto = 0, pin.SE3(spine.axes[0], spine.midpoints[0])
    for j in range(14):
        placement = onto * pin.SE3(np.eye(3), centre[j])
        for axis, joint in zip("xyz", (pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRZ())):
            parent = model.addJoint(parent, joint, placement, f"{j}{axis}")
            placement = pin.SE3.Identity()
        onto = pin.SE3(rest[j], rise[j])
        frames.append(model.addFrame(pin.Frame(f"vertebra{j + 1}", parent, onto, pin.FrameType.OP_FRAME)))
    return model, frames


class Kinematics:
    def __init__(self, spine):
        self.model, self.frames = build(spine)
        self.data = self.model.createData()
        self.first = spine.midpoints[:1], spine.axes[:1, :, 2]
        self.screws = np.zeros((6, self.model.nv))
        self.updated = False  # whether the frames are where the joints are

    def place(self, q):
        jacobian = pin.computeJointJacobians(self.model, self.data, q)
        # Pinocchio has linear before angular.
        self.screws[:3], self.screws[3:] = jacobian[3:], jacobian[:3]
        self.updated = False
        return self.screws

    def update(self):
        if not self.updated:
            pin.updateFramePlacements(self.model, self.data)
            self.updated = True

    def midpoints(self):
        self.update()
        return np.vstack([self.first[0], [self.data.oMf[frame].translation for frame in self.frames]])

    def cranial(self):
        self.update()
        return np.vstack([self.first[1], [self.data.oMf[frame].rotation[:, 2] for frame in self.frames]])
