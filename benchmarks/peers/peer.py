"""Times one engine on one case, and prints JSON: `OMP_NUM_THREADS=1 python peer.py ENGINE CASES NAME`."""

import importlib
import json
import sys
from statistics import median
from time import process_time

import numpy as np

import spine as spines
import usual
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
    """A row of the answer; it has the reason if nothing was found."""
    row = {"task": task, "method": method}
    try:
        return row | work()
    except NotFound as reason:
        return row | {"failed": str(reason)}


def equilibria(statics, spine, near):
    """Both bends, from the erect spine or from the equilibrium at 95 % of the force."""
    kinematics = statics.kinematics
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


def amplitude(statics, spine):
    def work():
        return [statics.match(bend.unit, bend.lean)[0] for bend in spine.bends]

    return {"forces_n": work(), "seconds": timed(work) / 2}


def personalisation(work):
    multipliers, forces = work()
    seconds = timed(work, seconds=2.0)
    return {"multipliers": multipliers.tolist(), "forces_n": forces.tolist(), "seconds": seconds}


def main(engine, path, name):
    module = importlib.import_module(f"with_{engine}")
    spine = spines.read(path, name)
    kinematics = module.Kinematics(spine)
    rows = []
    ways = (("usual", "dense solve", usual.UsualStatics), ("tuned", "triangular solve", Statics))
    for way, solve, kind in ways:
        statics = kind(kinematics, spine.true_stiffness)
        for task, near in (("equilibrium", False), ("equilibrium_near", True)):
            rows.append(attempt(task, f"{way}: Newton, {solve}", lambda: equilibria(statics, spine, near)))
        method = f"{way}: continuation, bordered Newton, {solve}"
        rows.append(attempt("amplitude", method, lambda: amplitude(statics, spine)))
    method = "usual: amplitudes met in every evaluation; nominal start"
    rows.append(attempt("personalisation", method, lambda: personalisation(lambda: usual.personalise(kinematics, spine))))
    for start in spine.starts:
        method = f"tuned: multipliers and forces together; {start.replace('_', '-')} start"
        work = lambda: personalise(kinematics, spine, start)
        rows.append(attempt("personalisation", method, lambda: personalisation(work)))
    said = {"engine": module.NAME, "version": module.VERSION, "case": name, "cannot": module.CANNOT, "rows": rows}
    print(json.dumps(said))


if __name__ == "__main__":
    main(*sys.argv[1:])
