"""Times one engine on one case, and prints JSON: `OMP_NUM_THREADS=1 python peer.py ENGINE CASES NAME`."""

import importlib
import json
import sys
from statistics import median
from time import process_time

import numpy as np

import spine as spines
from statics import NotFound, Statics, personalise


def timed(work, seconds=1.0, most=400):
    """Median processor time of a call, so that what else runs does not count: at least five calls."""
    work()
    times = []
    while len(times) < 5 or (sum(times) < seconds and len(times) < most):
        start = process_time()
        work()
        times.append(process_time() - start)
    return median(times)


def attempt(task, method, work):
    """A row of the answer; what was not found is told in it."""
    row = {"task": task, "method": method}
    try:
        return row | work()
    except NotFound as reason:
        return row | {"failed": str(reason)}


def equilibria(kinematics, spine, near):
    """Both bends, from the erect spine or from the equilibrium at 95 % of the force."""
    statics = Statics(kinematics, spine.true_stiffness)
    starts, shapes = [], []
    for bend in spine.bends:
        erect = np.zeros_like(spine.nominal)
        starts.append(statics.equilibrium(0.95 * bend.wrench, erect)[0] if near else erect)
        kinematics.place(statics.equilibrium(bend.wrench, starts[-1])[0])
        shapes.append(kinematics.midpoints().tolist())

    def work():
        for bend, start in zip(spine.bends, starts):
            statics.equilibrium(bend.wrench, start)

    return {"midpoints_mm": shapes, "seconds": timed(work) / 2}


def amplitude(kinematics, spine):
    statics = Statics(kinematics, spine.true_stiffness)

    def work():
        return [statics.match(bend.unit, bend.lean) for bend in spine.bends]

    return {"forces_n": work(), "seconds": timed(work) / 2}


def personalisation(kinematics, spine, start):
    multipliers, forces = personalise(kinematics, spine, start)
    seconds = timed(lambda: personalise(kinematics, spine, start), seconds=2.0)
    return {"multipliers": multipliers.tolist(), "forces_n": forces.tolist(), "seconds": seconds}


def main(engine, path, name):
    module = importlib.import_module(f"with_{engine}")
    spine = spines.read(path, name)
    kinematics = module.Kinematics(spine)
    rows = [
        attempt("equilibrium", "Newton", lambda: equilibria(kinematics, spine, near=False)),
        attempt("equilibrium_near", "Newton", lambda: equilibria(kinematics, spine, near=True)),
        attempt("amplitude", "continuation, bordered Newton", lambda: amplitude(kinematics, spine)),
    ]
    for start in spine.starts:
        method = f"Newton, implicit derivatives, MINPACK; {start.replace('_', '-')} start"
        rows.append(attempt("personalisation", method, lambda: personalisation(kinematics, spine, start)))
    said = {"engine": module.NAME, "version": module.VERSION, "case": name, "cannot": module.CANNOT, "rows": rows}
    print(json.dumps(said))


if __name__ == "__main__":
    main(*sys.argv[1:])
