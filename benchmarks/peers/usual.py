"""The same tasks as a competent user of an engine ordinarily writes them.

Newton solves its full, unsymmetric tangent with `numpy.linalg.solve`, as it would have to under any other load. The fit
follows the method as published: within every evaluation each bend's force is matched to the measured lean, so that only
the multipliers are unknown, and it starts from nominal springs. Derivatives are analytic here too, through equilibrium
and amplitude.
"""

import numpy as np
from scipy.optimize import least_squares

from statics import NotFound, Observed, Statics, load_rate

MAX_STEP_RAD = 1.0  # of a hinge, in one step from a nearby shape: beyond, the search starts again from zero


class UsualStatics(Statics):
    @staticmethod
    def solve(tangent, right):
        try:
            return np.linalg.solve(tangent, right)
        except np.linalg.LinAlgError as reason:
            raise NotFound(str(reason)) from reason


class UsualFit:
    """Residuals of both bends with their amplitudes met, and their derivatives by the implicit function theorem.

    Unknown are the first two log-multipliers; the three sum to zero.
    """

    FREE = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]])

    def __init__(self, kinematics, spine):
        self.spine = spine
        self.statics = UsualStatics(kinematics, spine.nominal)
        self.observed = Observed(kinematics, spine)
        self.groups = self.FREE[spine.region]
        # Force and hinge angles of each bend: at the point last tried, and at the one that was last good enough to go on from.
        self.found = [None for _ in spine.bends]
        self.last = list(self.found)
        self.at = self.residual = None

    def evaluate(self, x):
        if self.at is not None and np.array_equal(x, self.at):
            return
        self.statics.stiffness = self.spine.stiffness(self.FREE @ x)
        self.at = x.copy()
        try:
            parts = [self.bend(i, bend) for i, bend in enumerate(self.spine.bends)]
        except NotFound:
            if self.residual is None:
                raise
            # Springs that cannot reach the lean: scipy answers with a shorter step.
            self.residual = np.full_like(self.residual, np.inf)
            return
        self.residual, self.jacobian = (np.concatenate(part) for part in zip(*parts))

    def matched(self, i, bend):
        """The force for the measured lean: bordered Newton from the last one, from zero where that does not lead back."""
        if self.last[i] is not None:
            force, q = self.last[i]
            try:
                found = self.statics.polish(bend.unit, load_rate(bend.unit), bend.lean, q, force)
                if found[0] > 0.0 and np.abs(found[1] - q).max() < MAX_STEP_RAD:
                    return found
            except NotFound:
                pass
        return self.statics.match(bend.unit, bend.lean)

    def bend(self, i, bend):
        force, q, screws, tangent = self.matched(i, bend)
        self.found[i] = force, q
        # Hinges by the multipliers at a given force, and by the force; then the force keeps the lean.
        right = np.zeros((len(q), 3))
        right[::3, :2] = -(self.statics.stiffness[::3] * q[::3])[:, None] * self.groups
        right[:, 2] = bend.unit @ screws
        rates = self.statics.solve(tangent, right)
        _, lean = self.statics.lean(screws)
        leans = lean @ rates
        rates = rates[:, :2] - np.outer(rates[:, 2], leans[:2] / leans[2])
        residual, jacobian = self.observed.compare(bend, screws, rates)
        return residual, jacobian.reshape(-1, 2)

    def residuals(self, x):
        self.evaluate(x)
        return self.residual

    def jacobians(self, x):
        self.evaluate(x)
        self.last = list(self.found)
        return self.jacobian


def personalise(kinematics, spine):
    """Multipliers and forces from both bends, from nominal springs."""
    fit = UsualFit(kinematics, spine)
    end = least_squares(fit.residuals, np.zeros(2), fit.jacobians)
    fit.evaluate(end.x)
    return np.exp(fit.FREE @ end.x), np.array([force for force, _ in fit.found])
