"""Evaluates completed and detected landmarks on films of patients that are new to both models.

Usage: python compare.py --data path/to/aasce --program path/to/spineline --complete path/to/examples/complete --out folder

The films show the test patients of training/landmarks/split.py. The shape is learned anew without them; the networks were
trained without them. The films have no scale: millimetres assume 370 mm from L4 to T2.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

TRAINING = Path(__file__).resolve().parents[2] / "training"
sys.path[:0] = [str(TRAINING / "shape"), str(TRAINING / "landmarks")]
import shape  # noqa: E402
from landmarks import LEVELS, read_films  # noqa: E402
from split import part_of  # noqa: E402

CORNERS = ["superior_left", "superior_right", "inferior_left", "inferior_right"]
LENGTH_MM, CLICK_MM = 370.0, 0.7
SEED = 1


def per_mm(corners):
    """Pixels per millimetre, from the length of the line through the centres from L4 to T2."""
    centres = corners.mean(axis=1)[1:16]
    return np.hypot(*np.diff(centres, axis=0).T).sum() / LENGTH_MM


def clicks_of(corners, scheme):
    """Exact clicks of a scheme on one film: level, mark, place."""
    wall = {"left_wall": (0, 2), "right_wall": (1, 3)}
    every = range(17)
    if scheme == "corners":
        return [(k, CORNERS[c], corners[k, c]) for k in every for c in range(4)]
    if scheme == "walls":
        return [(k, mark, corners[k, list(of)].mean(axis=0)) for k in every for mark, of in wall.items()]
    if scheme == "superior endplate":
        return [(k, CORNERS[c], corners[k, c]) for k in every for c in range(2)]
    if scheme == "centres":
        return [(k, "centre", corners[k].mean(axis=0)) for k in every]
    if scheme == "midline":
        ends = [(k, CORNERS[c], corners[k, c]) for k in (0, 16) for c in range(4)]
        return ends + [(0, "midline", corners[k].mean(axis=0)) for k in range(2, 14)]
    chosen = {"every second": range(0, 17, 2), "five": (0, 4, 8, 12, 16), "two": (0, 16), "one": (8,)}[scheme]
    return [(k, CORNERS[c], corners[k, c]) for k in chosen for c in range(4)]


SCHEMES = ["corners", "walls", "superior endplate", "every second", "five", "midline", "centres", "two", "one"]


def tilts_deg(corners):
    """Mean tilt of the two endplates of every vertebra, as in the data's angles."""
    lines = corners[:, [0, 2]] - corners[:, [1, 3]]
    return np.degrees(np.arctan2(lines[..., 1], lines[..., 0])).mean(axis=1)


def cobb_deg(corners):
    """The main angle by the challenge's definition: the range of tilts from T1 to L5."""
    tilts = tilts_deg(corners)
    return tilts.max() - tilts.min()


def errors(found, true):
    """Errors of one film: corners in % of its mean vertebral height, tilts and main Cobb angle in degrees."""
    height = np.hypot(*(true[:, :2].mean(axis=1) - true[:, 2:].mean(axis=1)).T).mean()
    corner = 100 * np.hypot(*np.moveaxis(found - true, -1, 0)) / height
    tilt = tilts_deg(found) - tilts_deg(true)
    return corner, tilt, cobb_deg(found) - cobb_deg(true)


def completed(options, films, scheme, text, noise):
    """Corners and deviations of every film that a scheme's clicks complete, and the number of clicks."""
    random = np.random.default_rng([SEED, SCHEMES.index(scheme)])
    wanted = []
    for film in films:
        sd = noise * per_mm(film.corners)
        places = [
            (LEVELS[k], mark, *(place * [1, -1] + sd * random.standard_normal(2)))
            for k, mark, place in clicks_of(film.corners, scheme)
        ]
        wanted.append({"columns": 4000, "rows": 8000, "clicks": places})
    request = json.dumps({"table": text, "films": wanted})
    done = subprocess.run([options.complete], input=request, capture_output=True, text=True, check=True)
    found = []
    for film, done_film in zip(films, json.loads(done.stdout)):
        if done_film is not None:
            corners = np.array([done_film[level]["corners"] for level in LEVELS]) * [1, -1]
            found.append((film, corners, np.array([done_film[level]["sd"] for level in LEVELS])))
    return found, len(wanted[0]["clicks"])


def judge_completion(options, films, text):
    """A row per scheme."""
    print(f"\nCompletion: {len(films)} films of {len({film.patient for film in films})} test patients, clicks with {CLICK_MM} mm\n")
    print(
        "| clicked | clicks | corner, median (% of height) | tilt, mean absolute / rms (°) | main Cobb, mean absolute (°) | "
        "within 1 / 2 stated sd (%) | films without result |"
    )
    print("|---|---|---|---|---|---|---|")
    for scheme in SCHEMES:
        found, clicks = completed(options, films, scheme, text, CLICK_MM)
        each = [errors(corners, film.corners) for film, corners, _ in found]
        corner = np.concatenate([one[0].ravel() for one in each])
        tilt = np.concatenate([one[1] for one in each])
        cobb = np.array([one[2] for one in each])
        within = [
            100 * np.mean([np.abs(corners - film.corners) < k * sd[:, None, None] for film, corners, sd in found]) for k in (1, 2)
        ]
        print(
            f"| {scheme} | {clicks} | {np.median(corner):.1f} | {np.abs(tilt).mean():.1f} / {np.sqrt(np.mean(tilt**2)):.1f} | "
            f"{np.abs(cobb).mean():.1f} | {within[0]:.0f} / {within[1]:.0f} | {len(films) - len(found)} |"
        )


def judge_repeats(options, films):
    """Completion of a film from five vertebrae with two clicks each, without and with another film of the patient as the erect one."""
    pairs = [(a, b) for a in films for b in films if a is not b and a.patient == b.patient]
    random = np.random.default_rng(SEED)

    def clicks(film, marked):
        sd = CLICK_MM * per_mm(film.corners)
        exact = [one for one in clicks_of(film.corners, marked[0]) if one[0] in marked[1]]
        return [(LEVELS[k], mark, *(place * [1, -1] + sd * random.standard_normal(2))) for k, mark, place in exact]

    asked = [LEVELS.index(level) for level in ("L4", "L1", "T9", "T5", "T2")]
    own = [clicks(film, ("walls", asked)) for _, film in pairs]
    erect = [clicks(film, ("corners", range(1, 16))) for film, _ in pairs]
    print(f"\nRepeated films: {len(pairs)} pairs of {len({film.patient for film, _ in pairs})} test patients, 10 clicks with {CLICK_MM} mm\n")
    print("| prior | corner, median (% of height) | 90 % | within a tenth (%) | tilt, mean absolute (°) |")
    print("|---|---|---|---|---|")
    hidden = [k for k in range(1, 16) if k not in asked]
    for name, priors in (("other patients", [None] * len(pairs)), ("the patient's other film", erect)):
        wanted = [{"columns": 4000, "rows": 8000, "clicks": a, "erect": b, "is_bend": True} for a, b in zip(own, priors)]
        done = subprocess.run([options.complete], input=json.dumps({"films": wanted}), capture_output=True, text=True, check=True)
        corner, tilt = [], []
        for (_, film), found in zip(pairs, json.loads(done.stdout)):
            places = np.array([found[level]["corners"] for level in LEVELS]) * [1, -1]
            of_film = errors(places, film.corners)
            corner.append(of_film[0][hidden].ravel())
            tilt.append(np.abs(of_film[1][hidden]))
        corner, tilt = np.concatenate(corner), np.concatenate(tilt)
        print(f"| {name} | {np.median(corner):.1f} | {np.quantile(corner, 0.9):.1f} | {100 * np.mean(corner < 10):.0f} | {tilt.mean():.1f} |")


def judge_detection(options, films):
    """Corner errors, Cobb errors and level slips of `spineline detect` by severity."""
    paths = [str(options.data / "images_training" / film.name) for film in films]
    out = options.out / "detected"
    command = [options.program, "detect", *paths, "--posture", "erect", "--patient-left", "image-right", "--out", str(out), "--overwrite"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    flagged = {}
    for line in done.stdout.splitlines():
        if line.startswith("  check the levels"):
            flagged[name] = True
        elif not line.startswith(" "):
            name = Path(line.split(".json")[0]).name
    found = []
    for number, film in enumerate(films, 1):
        path = out / f"detected-{number:02}.json"
        if path.exists():
            marks = json.loads(path.read_text())["films"][0]["readings"][0]["vertebrae"]
            found.append((film, marks, flagged.get(path.stem, False)))
    print(f"\nDetection without a click: {len(films)} films, {len(films) - len(found)} refused\n")
    print("| main Cobb angle | films | corner, median (% of height) | main Cobb, mean absolute (°) | levels shifted, of them flagged | flagged, not shifted |")
    print("|---|---|---|---|---|---|")
    for low, high in ((0, 25), (25, 46), (46, 180), (0, 180)):
        own = [one for one in found if low <= cobb_deg(one[0].corners) < high]
        if not own:
            continue
        corners, cobbs, true, slips, alarms = [], [], [], [], 0
        for film, marks, is_flagged in own:
            places = {level: np.array([marks[level][c] for c in CORNERS]) * [1, -1] for level in LEVELS if level in marks}
            shift = shift_of(places, film.corners)
            slips += [is_flagged] if shift else []
            alarms += is_flagged and not shift
            shared = [k for k in range(17) if 0 <= k + shift < 17 and LEVELS[k + shift] in places]
            quads = np.array([places[LEVELS[k + shift]] for k in shared])
            height = np.hypot(*(film.corners[:, :2].mean(axis=1) - film.corners[:, 2:].mean(axis=1)).T).mean()
            corners.append(100 * np.hypot(*np.moveaxis(quads - film.corners[shared], -1, 0)).ravel() / height)
            cobbs.append(cobb_deg(np.array(list(places.values()))))
            true.append(cobb_deg(film.corners))
        cobbs, true = np.array(cobbs), np.array(true)
        name = "all" if high - low == 180 else f"{low} to {high}°" if high < 180 else f"{low}° and more"
        print(
            f"| {name} | {len(own)} | {np.median(np.concatenate(corners)):.1f} | {np.abs(cobbs - true).mean():.1f} | "
            f"{len(slips)}, {sum(slips)} | {alarms} |"
        )


def shift_of(places, true):
    """By how many levels the names are shifted: the shift with the nearest centres."""
    def distance(shift):
        pairs = [(places[LEVELS[k + shift]], true[k]) for k in range(17) if 0 <= k + shift < 17 and LEVELS[k + shift] in places]
        return np.median([np.hypot(*(a.mean(axis=0) - b.mean(axis=0))) for a, b in pairs]) if pairs else np.inf
    return min(range(-3, 4), key=lambda shift: (distance(shift), abs(shift)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder of the AASCE data")
    parser.add_argument("--program", required=True, help="the spineline program")
    parser.add_argument("--complete", required=True, help="the example `complete` of spineline-landmarks")
    parser.add_argument("--out", type=Path, required=True, help="folder for results")
    options = parser.parse_args()
    films = read_films(options.data)
    test = [film for film in films if part_of(film.name) == "test"]
    text = "\n".join(shape.table([film for film in films if part_of(film.name) == "train"]))
    judge_completion(options, test, text)
    judge_repeats(options, test)
    judge_detection(options, test)


if __name__ == "__main__":
    main()
