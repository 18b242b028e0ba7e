"""What every user of a rigid-body engine has to write beside it: Newton, the search for a force, the fit.

An engine gives its kinematics as an object with three methods:

- `place(q)`: puts the 42 hinge angles in, and returns the hinges' screws as a (6, 42) array: rows 0-2 are the axes in
  global axes, rows 3-5 the velocities that the hinges give to the point at the global origin;
- `midpoints()`: (15, 3), and `cranial()`: (15, 3), the vertebrae's third axes, both as `place` has left them.

A force along a line fixed in space is a constant spatial wrench `w`, so the generalised load is `Sᵀw`. A hinge moves all
screws above it: `dS_i/dq_k = S_k × S_i` for `k < i`. Hence `d(Sᵀw)/dq` is the strictly lower triangle of `Sᵀ X S`, with a
6 × 6 matrix `X` of the wrench alone, and the tangent is lower triangular, which LAPACK's `trtrs` makes use of.

What is here is the tuned way; `usual.py` has the usual one.
"""

import numpy as np
from scipy.linalg.lapack import dtrtrs
from scipy.optimize import least_squares

LAST_STEP_RAD = 1e-7  # Newton converges quadratically: what is left after such a step is rounding
MAX_TURN_RAD = 0.25  # of a hinge, from one force to the next
MAX_STEPS = 60


class NotFound(Exception):
    """A search ended without result."""


def skew(v):
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def load_rate(wrench):
    """The 6 × 6 matrix `X` with `(S_k × S_i)·w = S_iᵀ X S_k`."""
    moment, force = skew(wrench[:3]), skew(wrench[3:])
    return np.block([[moment, force], [force, np.zeros((3, 3))]])


class Statics:
    """Springs on the hinges of an engine's spine."""

    def __init__(self, kinematics, stiffness):
        self.kinematics = kinematics
        self.stiffness = stiffness
        self.below = np.tri(len(stiffness), k=-1)
        self.diagonal = np.diag_indices(len(stiffness))

    @staticmethod
    def solve(tangent, right):
        """The tangent is lower triangular under a wrench fixed in space."""
        return dtrtrs(tangent, right, lower=1)[0]

    def system(self, q, wrench, rate):
        """Screws, residual and tangent at hinge angles `q`; `rate` is `load_rate(wrench)`."""
        screws = self.kinematics.place(q)
        residual = self.stiffness * q - wrench @ screws
        tangent = (screws.T @ rate @ screws) * -self.below
        tangent[self.diagonal] = self.stiffness
        return screws, residual, tangent

    def equilibrium(self, wrench, q):
        """Newton from `q`; returns hinge angles, and screws and tangent of the last step."""
        rate = load_rate(wrench)
        for _ in range(MAX_STEPS):
            screws, residual, tangent = self.system(q, wrench, rate)
            step = self.solve(tangent, residual)
            q = q - step
            if np.abs(step).max() < LAST_STEP_RAD:
                return q, screws, tangent
        raise NotFound("Newton did not converge")

    def lean(self, screws):
        """Lean of the line L4→T2, right positive, and its derivative by the hinges."""
        x, y, z = self.kinematics.midpoints()[-1]
        wx, wy, wz, _, vy, vz = screws
        rate = (y * (vz + wx * y - wy * x) - z * (vy + wz * x - wx * z)) / (y * y + z * z)
        return np.arctan2(-y, z), rate

    def match(self, unit, lean):
        """The first force, from zero upwards, at which the line L4→T2 has a given lean; with it what `polish` returns."""
        unit_rate = load_rate(unit)
        q, force = np.zeros_like(self.stiffness), 0.0
        before = None
        for _ in range(MAX_STEPS):
            q, screws, tangent = self.equilibrium(force * unit, q)
            by_force = self.solve(tangent, unit @ screws)
            now, rate = self.lean(screws)
            miss, slope = now - lean, rate @ by_force
            if before is not None and miss * before < 0.0:
                return self.polish(unit, unit_rate, lean, q, force)
            longest = MAX_TURN_RAD / np.abs(by_force).max()
            newton = -miss / slope
            if 0.0 < newton < longest:
                try:
                    return self.polish(unit, unit_rate, lean, q + by_force * newton, force + newton)
                except NotFound:
                    pass  # the lean turns back before it: on with the path
            q, force, before = q + by_force * longest, force + longest, miss
        raise NotFound("the amplitude is not reached")

    def polish(self, unit, unit_rate, lean, q, force):
        """Newton for hinges and force together: equilibrium bordered by the amplitude, solved by blocks.

        Returns force and hinge angles, and screws and tangent of the last step.
        """
        for _ in range(MAX_STEPS):
            screws, residual, tangent = self.system(q, force * unit, force * unit_rate)
            both = self.solve(tangent, np.column_stack([residual, unit @ screws]))
            now, rate = self.lean(screws)
            more = (rate @ both[:, 0] - (now - lean)) / (rate @ both[:, 1])
            step = more * both[:, 1] - both[:, 0]
            q, force = q + step, force + more
            if np.abs(step).max() < LAST_STEP_RAD:
                return force, q, screws, tangent
        raise NotFound("the amplitude is not met")


class Observed:
    """Residuals of a bend's locations and tilts, and their derivatives, in standard deviations."""

    def __init__(self, kinematics, spine):
        self.kinematics = kinematics
        self.scale = np.array([spine.location_sd, spine.location_sd, spine.tilt_sd])[:, None]

    def compare(self, bend, screws, rates):
        """(42,) and (3, 14, n), of the shape as last placed, whose hinges turn by the columns of `rates`."""
        # Twists of the vertebrae per unit of each unknown: sums over the hinges below.
        hinges = screws[:, :, None] * rates
        twists = hinges.reshape(6, 14, 3, -1).sum(axis=2).cumsum(axis=1)
        wx, wy, wz, _, vy, vz = twists
        place, cranial = self.kinematics.midpoints()[1:], self.kinematics.cranial()[1:]
        x, y, z = place.T[:, :, None]
        cx, cy, cz = cranial.T[:, :, None]
        turn = (cy * (wx * cy - wy * cx) - cz * (wz * cx - wx * cz)) / (cy * cy + cz * cz)
        jacobian = np.array([vy + wz * x - wx * z, vz + wx * y - wy * x, turn])
        tilt = np.arctan2(-cranial[:, 1], cranial[:, 2])
        residual = np.array(
            [place[:, 1] - bend.locations[1:, 0], place[:, 2] - bend.locations[1:, 1], tilt - bend.tilts[1:]]
        )
        return (residual / self.scale).ravel(), jacobian / self.scale[:, :, None]


class Fit:
    """Residuals of locations and tilts of both bends, and their derivatives by the implicit function theorem.

    Unknown are the first two log-multipliers (the three sum to zero) and the two forces.
    """

    FREE = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]])

    def __init__(self, kinematics, spine):
        self.spine = spine
        self.statics = Statics(kinematics, spine.nominal)
        self.observed = Observed(kinematics, spine)
        self.groups = self.FREE[spine.region]
        self.shapes = [np.zeros_like(spine.nominal) for _ in spine.bends]
        self.at = None

    def evaluate(self, x):
        if self.at is not None and np.array_equal(x, self.at):
            return
        self.statics.stiffness = self.spine.stiffness(self.FREE @ x[:2])
        rows, columns = [], []
        for i, bend in enumerate(self.spine.bends):
            residual, jacobian = self.bend(i, bend, x[2 + i])
            rows.append(residual)
            columns.append(jacobian)
        self.at = x.copy()
        self.residual, self.jacobian = np.concatenate(rows), np.concatenate(columns)

    def bend(self, i, bend, force):
        """Equilibrium from the last one of this bend, and all derivatives with one more triangular solve."""
        q, screws, tangent = self.statics.equilibrium(force * bend.unit, self.shapes[i])
        self.shapes[i] = q
        right = np.zeros((len(q), 3))
        right[::3, :2] = -(self.statics.stiffness[::3] * q[::3])[:, None] * self.groups
        right[:, 2] = bend.unit @ screws
        residual, rates = self.observed.compare(bend, screws, self.statics.solve(tangent, right))
        jacobian = np.zeros((3, 14, 4))
        jacobian[:, :, [0, 1, 2 + i]] = rates
        return residual, jacobian.reshape(-1, 4)

    def residuals(self, x):
        self.evaluate(x)
        return self.residual

    def jacobians(self, x):
        self.evaluate(x)
        return self.jacobian


def personalise(kinematics, spine, start):
    """Multipliers and forces from both bends: MINPACK's Levenberg-Marquardt."""
    logs, forces = spine.starts[start]
    fit = Fit(kinematics, spine)
    x = np.concatenate([logs[:2] - logs.mean(), forces])
    end = least_squares(fit.residuals, x, fit.jacobians, method="lm", x_scale="jac")
    return np.exp(fit.FREE @ end.x[:2]), end.x[2:]
