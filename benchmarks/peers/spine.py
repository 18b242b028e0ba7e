"""The cases as arrays, in mm, N, N·mm/rad and rad."""

import json
from dataclasses import dataclass

import numpy as np


@dataclass
class Bend:
    """A force on T2 along a line fixed in space, and the shape that it makes."""

    unit: np.ndarray  # wrench of 1 N: moment about the origin, then force
    force: float
    lean: float
    locations: np.ndarray  # (15, 2): y, z
    tilts: np.ndarray  # (15,)

    @property
    def wrench(self):
        return self.force * self.unit


@dataclass
class Spine:
    """One case: vertebra 0 is L4 and fixed; joint j has hinges x, y, z in the axes of vertebra j."""

    name: str
    midpoints: np.ndarray  # (15, 3)
    axes: np.ndarray  # (15, 3, 3): columns are a vertebra's axes
    centres: np.ndarray  # (14, 3)
    nominal: np.ndarray  # (42,): stiffness of hinges x, y, z of joint 0, then of joint 1, …
    region: np.ndarray  # (14,)
    multipliers: np.ndarray  # (3,): true ones
    location_sd: float
    tilt_sd: float
    bends: list
    starts: dict  # name: (three log-multipliers, two forces)

    def stiffness(self, log_multipliers):
        """Stiffness of all hinges: a region's multiplier acts on its lateral (x) hinges."""
        stiffness = self.nominal.copy()
        stiffness[::3] *= np.exp(log_multipliers)[self.region]
        return stiffness

    @property
    def true_stiffness(self):
        return self.stiffness(np.log(self.multipliers))

    def relative_poses(self):
        """Per joint, in the inferior vertebra's axes: centre from its midpoint, superior midpoint from the centre, and
        the superior vertebra's axes."""
        inferior = self.axes[:-1].transpose(0, 2, 1)
        into = lambda vectors: np.einsum("jab,jb->ja", inferior, vectors)
        centre = into(self.centres - self.midpoints[:-1])
        rise = into(self.midpoints[1:] - self.centres)
        return centre, rise, inferior @ self.axes[1:]


def read(path, name):
    """One case of the file."""
    with open(path, encoding="utf-8") as file:
        case = next(case for case in json.load(file)["cases"] if case["name"] == name)
    vertebrae, joints = case["vertebrae"], case["joints"]
    return Spine(
        name=name,
        midpoints=np.array([v["midpoint_mm"] for v in vertebrae]),
        axes=np.array([v["axes"] for v in vertebrae]),
        centres=np.array([j["centre_mm"] for j in joints]),
        nominal=np.array([j["stiffness_nmm_per_rad"] for j in joints]).ravel(),
        region=np.array([j["region"] for j in joints]),
        multipliers=np.array(case["multipliers"]),
        location_sd=case["noise"]["location_mm"],
        tilt_sd=case["noise"]["tilt_rad"],
        bends=[_bend(bend) for bend in case["bends"]],
        starts={
            start: (np.array(given["log_multipliers"]), np.array(given["forces_n"]))
            for start, given in case["starts"].items()
        },
    )


def _bend(bend):
    point, direction = np.array(bend["point_mm"]), np.array(bend["direction"])
    return Bend(
        unit=np.concatenate([np.cross(point, direction), direction]),
        force=bend["force_n"],
        lean=bend["lean_rad"],
        locations=np.array(bend["locations_mm"]),
        tilts=np.array(bend["tilts_rad"]),
    )
