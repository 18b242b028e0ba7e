"""OpenSim: one body per vertebra on a CustomJoint of three rotations, in SI; T2's frame Jacobian has all screws."""

import numpy as np
import opensim

NAME = "opensim"
VERSION = opensim.GetVersion().split("-")[0]
CANNOT = [
    "no static solver for springs and a wrench: a forward simulation that settles, or the user's own Newton (timed here)",
    "no analytic derivative of forces by coordinates: the load's stiffness is the user's own formula",
    "no search for a force that reaches an amplitude, no derivatives by stiffness",
]
MM = 1e-3


def vec3(values):
    return opensim.Vec3(*(float(value) for value in values))


def euler(rotation):
    """Body-fixed x, y, z angles, which OpenSim's offsets are given in."""
    matrix = opensim.Mat33(*(float(value) for value in rotation.ravel()))
    return opensim.Rotation(matrix).convertRotationToBodyFixedXYZ()


def build(spine):
    centre, rise, rest = spine.relative_poses()
    model = opensim.Model()
    model.setGravity(vec3((0, 0, 0)))
    parent, place, turn = model.getGround(), spine.midpoints[0] + spine.axes[0] @ centre[0], spine.axes[0]
    bodies = []
    for j in range(14):
        body = opensim.Body(f"vertebra{j + 1}", 1.0, vec3((0, 0, 0)), opensim.Inertia(1e-3, 1e-3, 1e-3))
        model.addBody(body)
        transform = opensim.SpatialTransform()
        rotations = [transform.updTransformAxis(i) for i in range(3)]
        for name, rotation, axis in zip("xyz", rotations, np.eye(3)):
            rotation.setCoordinateNames(opensim.ArrayStr(f"{j}{name}", 1))
            rotation.setAxis(vec3(axis))
            rotation.set_function(opensim.LinearFunction(1.0, 0.0))
        # The joint's frame has the inferior vertebra's axes on both sides; the body has its own vertebra's axes.
        own = rest[j].T
        joint = opensim.CustomJoint(
            f"joint{j}", parent, vec3(place * MM), euler(turn), body, vec3(own @ -rise[j] * MM), euler(own), transform
        )
        model.addJoint(joint)
        bodies.append(body)
        if j < 13:
            parent, place, turn = body, centre[j + 1], np.eye(3)
    return model, bodies


class Kinematics:
    def __init__(self, spine):
        self.model, self.bodies = build(spine)
        self.state = self.model.initSystem()
        self.matter = self.model.getMatterSubsystem()
        self.top = self.bodies[-1].getMobilizedBodyIndex()
        self.first = spine.midpoints[:1], spine.axes[:1, :, 2]
        self.jacobian = opensim.Matrix()
        self.origin = opensim.Vec3(0.0)
        self.screws = np.zeros((6, 42))

    def place(self, q):
        self.state.setQ(opensim.Vector.createFromMat(q))
        self.model.realizePosition(self.state)
        self.matter.calcFrameJacobian(self.state, self.top, self.origin, self.jacobian)
        jacobian = self.jacobian.to_numpy()
        axes = jacobian[:3]
        x, y, z = self.bodies[-1].getPositionInGround(self.state).to_numpy() / MM
        # From T2's midpoint to the global origin.
        self.screws[:3] = axes
        self.screws[3] = jacobian[3] / MM + y * axes[2] - z * axes[1]
        self.screws[4] = jacobian[4] / MM + z * axes[0] - x * axes[2]
        self.screws[5] = jacobian[5] / MM + x * axes[1] - y * axes[0]
        return self.screws

    def midpoints(self):
        places = [body.getPositionInGround(self.state).to_numpy() / MM for body in self.bodies]
        return np.vstack([self.first[0], places])

    def cranial(self):
        up = opensim.Vec3(0.0, 0.0, 1.0)
        axes = [body.expressVectorInGround(self.state, up).to_numpy() for body in self.bodies]
        return np.vstack([self.first[1], axes])
