"""The compared cases: models of phantoms, their exports, loads on T2, and Spineline's own shapes."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

FORMATS = ("mjcf", "osim", "sto", "urdf")


@dataclass(frozen=True)
class Subject:
    """A model to make, and the largest multiple of its fitted forces."""

    scenario: str
    number: int
    line: str
    support: str
    beyond: float

    @property
    def name(self) -> str:
        return f"{self.scenario}-{self.number:02}-{self.line}-{self.support}"


# Lines through the inflections are fixed in space; the iliac line's force stays at T2's midpoint.
SUBJECTS = (
    Subject("rod", 3, "inflection", "free", 1.5),
    Subject("pull", 5, "inflection", "free", 3.0),
    Subject("bend", 11, "iliac", "free", 5.0),
    Subject("pull", 5, "iliac", "free", 5.0),
    Subject("rod", 5, "inflection", "frontal", 2.0),
)
BENDS = {"left_bending": "left", "right_bending": "right"}


@dataclass(frozen=True)
class Load:
    """A force on T2 of constant direction: along a line fixed in space, or at a point of the vertebra."""

    on_line: bool
    force_n: np.ndarray
    point_mm: np.ndarray

    def times(self, factor: float) -> Load:
        """The same, stronger."""
        return Load(self.on_line, factor * self.force_n, self.point_mm)

    def file(self) -> dict:
        """The load file of `spineline simulate`."""
        kind, point = "force_at_point", "point_in_vertebra_mm"
        if self.on_line:
            kind, point = "force_on_line", "point_mm"
        load = {"kind": kind, "level": "T2", "force": list(self.force_n)}
        load[point] = list(self.point_mm)
        return {"format": "spineline-load", "version": 1, "loads": [load]}


# Without any symmetry: forwards, sideways and down, beside the midpoint.
OBLIQUE = {
    "oblique, line": Load(True, np.array([45.0, -30.0, -80.0]), np.array([30.0, 25.0, 300.0])),
    "oblique, point": Load(False, np.array([30.0, 40.0, -60.0]), np.array([12.0, -20.0, 6.0])),
}


@dataclass(frozen=True)
class Case:
    """One load on one model."""

    name: str
    exports: dict[str, Path]
    levels: list[str]
    load: Load
    # Spineline's midpoints, erect and unloaded.
    erect_mm: np.ndarray
    # Spineline's midpoints under the load, one row per level.
    midpoints_mm: np.ndarray


class Spineline:
    """The program under test, and a folder for its output."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.program = program.resolve()
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def run(self, *arguments: str, codes: tuple[int, ...] = (0,)) -> None:
        """Runs a command that must end with one of these codes; ignores warnings."""
        command = [str(self.program), *arguments]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        if done.returncode not in codes:
            told = done.stderr.strip()
            raise SystemExit(f"`spineline {' '.join(arguments)}` ended with {done.returncode}:\n{told}")

    def cases(self) -> list[Case]:
        """All cases."""
        found = []
        for subject in SUBJECTS:
            model, exports = self.model(subject)
            levels = [vertebra["level"] for vertebra in model["vertebrae"]]
            erect = np.array([vertebra["midpoint_mm"] for vertebra in model["vertebrae"]])
            for label, load in loads(model, subject):
                name = f"{subject.name}, {label}"
                shape = self.simulate(subject.name, load, levels, len(found))
                found.append(Case(name, exports, levels, load, erect, shape))
        return found

    def model(self, subject: Subject) -> tuple[dict, dict[str, Path]]:
        """A personalised model of a noise-free phantom, and its exports."""
        number, stem = str(subject.number), subject.name
        self.run("phantom", "--scenario", subject.scenario, "--subject", number, "--noise", "0", "--out", "phantoms")
        film = f"phantoms/phantom-{subject.scenario}-{subject.number:02}.json"
        options = ["--model-line", subject.line, "--support", subject.support]
        # Another line of the same analysis may fail; only the model of this one is needed.
        self.run("analyze", film, "--model", f"{stem}.json", *options, codes=(0, 4))
        for form in FORMATS:
            self.run("export", f"{stem}.json", "--to", form, "--out", f"{stem}.{form}")
        model = json.loads((self.folder / f"{stem}.json").read_text(encoding="utf-8"))
        return model, {form: self.folder / f"{stem}.{form}" for form in FORMATS}

    def simulate(self, stem: str, load: Load, levels: list[str], number: int) -> np.ndarray:
        """Spineline's own equilibrium."""
        given = f"load-{number:02}.json"
        (self.folder / given).write_text(json.dumps(load.file(), indent=2), encoding="utf-8")
        return self.shape(f"shape-{number:02}.json", levels, f"{stem}.json", "--load", given)

    def films(self, stem: str) -> tuple[list[str], dict[str, np.ndarray]]:
        """The vertebrae of a model, and Spineline's equilibrium for every film."""
        model = json.loads((self.folder / f"{stem}.json").read_text(encoding="utf-8"))
        levels = [vertebra["level"] for vertebra in model["vertebrae"]]
        postures = [load["posture"] for load in model["loads"]]
        told = {posture: f"{stem}-{posture}.json" for posture in postures}
        shapes = {p: self.shape(told[p], levels, f"{stem}.json", "--posture", p) for p in postures}
        return levels, shapes

    def shape(self, told: str, levels: list[str], *arguments: str) -> np.ndarray:
        """The midpoints of a simulation."""
        # An extreme shape may be beyond human range, but it is an equilibrium of the model.
        self.run("simulate", *arguments, "--json", told, codes=(0, 4))
        shape = json.loads((self.folder / told).read_text(encoding="utf-8"))
        if shape["status"] not in ("converged", "beyond_human_range"):
            raise SystemExit(f"{told}: Spineline's own equilibrium is `{shape['status']}`")
        midpoints = shape["equilibria"][0]["midpoints_mm"]
        return np.array([midpoints[level] for level in levels])


def loads(model: dict, subject: Subject) -> list[tuple[str, Load]]:
    """Fractions and multiples of the bends' forces; on the first subject, oblique forces as well."""
    named = []
    for record in model["loads"]:
        side = BENDS.get(record["posture"])
        if side is None:
            continue
        fitted = load_of(record)
        steps = (("mild", 0.3), ("fitted", 1.0), ("extreme", subject.beyond))
        named += [(f"{side}, {word}", fitted.times(factor)) for word, factor in steps]
    if subject == SUBJECTS[0]:
        named += list(OBLIQUE.items())
    return named


def load_of(record: dict) -> Load:
    """A posture's load in a model file."""
    force_n = record["force"] * np.array(record["direction"])
    if record["application"] == "fixed":
        return Load(True, force_n, np.array(record["point_mm"]))
    return Load(False, force_n, np.zeros(3))
