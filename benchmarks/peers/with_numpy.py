"""numpy alone: the kinematics written by hand, over all joints at once where they allow it."""

import numpy as np

NAME = "numpy"
VERSION = np.__version__
CANNOT = ["nothing is given: kinematics, Jacobian and load stiffness are the user's own formulas"]


class Kinematics:
    def __init__(self, spine):
        self.centre, self.rise, self.rest = spine.relative_poses()
        self.poses = np.zeros((15, 4, 4))
        self.poses[0, :3, :3], self.poses[0, :3, 3], self.poses[:, 3, 3] = spine.axes[0], spine.midpoints[0], 1.0
        self.steps = np.zeros((14, 4, 4))
        self.steps[:, 3, 3] = 1.0
        self.local = np.zeros((14, 3, 3))
        self.local[:, 0, 0] = 1.0  # the x hinge
        self.turned = np.zeros((14, 3, 3))
        self.screws = np.zeros((6, 42))

    def place(self, q):
        (sa, sb, sc), (ca, cb, cc) = np.sin(q).reshape(14, 3).T, np.cos(q).reshape(14, 3).T
        turned, local, poses = self.turned, self.local, self.poses
        # Rx Ry Rz, column by column.
        turned[:, 0, 0], turned[:, 1, 0], turned[:, 2, 0] = cb * cc, ca * sc + sa * sb * cc, sa * sc - ca * sb * cc
        turned[:, 0, 1], turned[:, 1, 1], turned[:, 2, 1] = -cb * sc, ca * cc - sa * sb * sc, sa * cc + ca * sb * sc
        turned[:, 0, 2], turned[:, 1, 2], turned[:, 2, 2] = sb, -sa * cb, ca * cb
        self.steps[:, :3, :3] = turned @ self.rest
        self.steps[:, :3, 3] = self.centre + (turned @ self.rise[:, :, None])[:, :, 0]
        for j in range(14):
            np.matmul(poses[j], self.steps[j], out=poses[j + 1])
        # The y hinge after Rx, the z hinge after Rx Ry.
        local[:, 1, 1], local[:, 2, 1] = ca, sa
        local[:, :, 2] = turned[:, :, 2]
        below = poses[:-1, :3, :3]
        axes = (below @ local).transpose(1, 0, 2)
        x, y, z = (poses[:-1, :3, 3] + (below @ self.centre[:, :, None])[:, :, 0]).T[:, :, None]
        screws = self.screws.reshape(6, 14, 3)
        screws[:3] = axes
        screws[3] = y * axes[2] - z * axes[1]
        screws[4] = z * axes[0] - x * axes[2]
        screws[5] = x * axes[1] - y * axes[0]
        return self.screws

    def midpoints(self):
        return self.poses[:, :3, 3]

    def cranial(self):
        return self.poses[:, :3, 2]
