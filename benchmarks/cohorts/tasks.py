"""What a worker of Dask does for one patient. It lies in a module of its own, so that workers can import it."""

import spineline as sl


def half_width_deg(path, count):
    """Replicates of a patient on one thread; gives back one number, half the interval of the Cobb angle."""
    replicates = sl.replicates(sl.analyze(sl.read_case(path)), n=count, seed=1, threads=1)
    name = next(name for name in replicates if name.startswith("cobb.erect"))
    low, high = replicates.interval(name)
    return 0.5 * (high - low)
