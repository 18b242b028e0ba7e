"""MuJoCo: one body per vertebra with three hinges; `mj_kinematics` gives all axes and anchors."""

import mujoco
import numpy as np

NAME = "mujoco"
VERSION = mujoco.__version__
CANNOT = [
    "no static solver: an equilibrium is what a damped simulation settles to, or the user's own Newton (timed here)",
    "Jacobians, but no analytic derivative of a load's generalised force by q (mjd_inverseFD takes differences): the user's "
    "own formula",
    "no search for a force that reaches an amplitude, no derivatives by stiffness",
]


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


def quaternion(rotation):
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(rotation).ravel())
    return quat


def mjcf(spine):
    """The spine as MJCF: a vertebra's frame has its anatomical axes, so the hinges' axes are turned into it."""
    head = tail = ""
    for i in range(15):
        if i == 0:
            place, rotation, hinges = spine.midpoints[0], spine.axes[0], ""
        else:
            below, own = spine.axes[i - 1].T, spine.axes[i].T
            place, rotation = below @ (spine.midpoints[i] - spine.midpoints[i - 1]), below @ spine.axes[i]
            anchor = numbers(own @ (spine.centres[i - 1] - spine.midpoints[i]))
            axes = (own @ spine.axes[i - 1]).T
            stiffness = spine.true_stiffness[3 * i - 3 : 3 * i]
            hinges = "".join(
                f'<joint type="hinge" pos="{anchor}" axis="{numbers(axis)}" stiffness="{k!r}"/>'
                for axis, k in zip(axes, map(float, stiffness))
            )
        head += f'<body pos="{numbers(place)}" quat="{numbers(quaternion(rotation))}">{hinges}'
        head += '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
        tail += "</body>"
    return f'<mujoco><option gravity="0 0 0"/><worldbody>{head}{tail}</worldbody></mujoco>'


class Kinematics:
    def __init__(self, spine):
        self.model = mujoco.MjModel.from_xml_string(mjcf(spine))
        self.data = mujoco.MjData(self.model)
        # Views into the engine's memory.
        self.q, self.axes, self.anchors = self.data.qpos, self.data.xaxis, self.data.xanchor
        self.xpos, self.xmat = self.data.xpos, self.data.xmat
        self.screws = np.zeros((6, self.model.nv))

    def place(self, q):
        self.q[:] = q
        mujoco.mj_kinematics(self.model, self.data)
        axes, (x, y, z) = self.axes.T, self.anchors.T
        self.screws[:3] = axes
        self.screws[3] = y * axes[2] - z * axes[1]
        self.screws[4] = z * axes[0] - x * axes[2]
        self.screws[5] = x * axes[1] - y * axes[0]
        return self.screws

    def midpoints(self):
        return self.xpos[1:]

    def cranial(self):
        return self.xmat[1:, 2::3]
