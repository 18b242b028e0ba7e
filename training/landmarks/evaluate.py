"""Judges exported weights on films that they were not trained on.

    python training/landmarks/evaluate.py path/to/aasce --part test --dicom path/to/dicom-samples
"""

import argparse
import json
from pathlib import Path

import numpy as np
import torch
from augment import TEST_PHOTOGRAPHS
from data import LEVELS, grey_of, read_films
from decode import read
from export import OUT
from kernel import Kernel


def tilts(corners):
    """Tilt of the line between the middles of the lateral walls, in degrees: the challenge's definition."""
    way = (corners[:, 1] + corners[:, 3] - corners[:, 0] - corners[:, 2]) / 2
    return np.degrees(np.arctan2(way[:, 1], way[:, 0]))


def s_shaped(corners):
    """The challenge's test: middles of vertebrae on both sides of the line from first to last."""
    x, y = corners.mean(axis=1).T
    side = (y[:-2] - y[-1]) / (y[0] - y[-1]) * (x[0] - x[-1]) - (x[:-2] - x[-1])
    return (side > 1e-9).any() and (side < -1e-9).any()


def cobb_angles(corners, height):
    """Main, and two other angles, by the challenge's program. Reproduces angles.csv within 1 deg: 100 %, 98 %, 95 % of films."""
    t = tilts(corners)
    difference = np.abs(t[:, None] - t[None])
    upper, lower = sorted(np.unravel_index(difference.argmax(), difference.shape))
    main = difference[upper, lower]
    if not s_shaped(corners):
        return np.array([main, difference[0, upper], difference[-1, lower]])
    over = difference[upper, : upper + 1]
    middles = corners.mean(axis=1)[:, 1]
    if middles[upper] + middles[lower] < height:
        return np.array([main, over.max(), difference[lower, lower:].max()])
    next_upper = over.argmax()
    return np.array([main, over.max(), difference[next_upper, : next_upper + 1].max()])


def judge(kernel, film, grey, passes=1):
    """Figures of one film."""
    reading = read(kernel, grey, passes)
    row = {"name": film.name, "refused": bool(reading.refused), "cobb_deg": float(film.angles_deg[0])}
    if reading.refused:
        return row
    heights = np.hypot(*(film.corners[:, 2:].mean(axis=1) - film.corners[:, :2].mean(axis=1)).T)
    middles = film.corners.mean(axis=1)
    found = {LEVELS.index(v.level): v for v in reading.vertebrae}
    # The shift of levels: which true vertebra is nearest to each found one.
    shifts = [
        np.hypot(*(middles - v.corners.mean(axis=0)).T).argmin() - level for level, v in found.items()
    ]
    shift = int(np.median(shifts))
    by_name, by_place, ratios = [], [], []
    for level, v in found.items():
        by_name.append(np.hypot(*(v.corners - film.corners[level]).T))
        if 0 <= level + shift < 17:
            error = v.corners - film.corners[level + shift]
            by_place.append(np.hypot(*error.T))
            ratios.append(np.abs(error) / v.sd_px[:, None])
    row.update(
        shift=shift, mixed=int(np.ptp(shifts)), doubtful=reading.levels_doubtful, share=reading.count[0], found=len(found),
        error_height=(np.array(by_name) / heights.mean() * 100).ravel().tolist(),
        error_width=(np.array(by_name) / film.width_px * 100).ravel().tolist(),
        error_place=(np.array(by_place) / heights.mean() * 100).ravel().tolist(),
        ratios=np.array(ratios).ravel().tolist(), other=reading.count[1],
        confidence=[v.confidence for v in found.values()],
        vertebra_error=[float(np.hypot(*(v.corners - film.corners[l]).T).mean() / heights.mean() * 100) for l, v in found.items()],
    )
    corners = np.array([v.corners for v in reading.vertebrae])
    angles = cobb_angles(corners, film.height_px)
    row["cobb_error"] = abs(float(angles[0] - film.angles_deg[0]))
    row["smape"] = [float(np.abs(angles - film.angles_deg).sum()), float((angles + film.angles_deg).sum())]
    return row


def summary(rows):
    read_rows = [row for row in rows if not row["refused"]]
    if not read_rows:
        return {"films": len(rows), "refused": len(rows)}
    joined = lambda key: np.concatenate([row[key] for row in read_rows])
    sure = [row for row in read_rows if not row["doubtful"]]
    slipped = [row for row in read_rows if row["shift"] != 0 or row["mixed"] > 0]
    errors = [row["cobb_error"] for row in read_rows]
    return {
        "films": len(rows), "refused": len(rows) - len(read_rows),
        "corner median % height": np.median(joined("error_height")), "mean": joined("error_height").mean(),
        "corner median % width": np.median(joined("error_width")), "mean ": joined("error_width").mean(),
        "corner median % height, levels set right": np.median(joined("error_place")), "mean  ": joined("error_place").mean(),
        "Cobb mean deg": np.mean(errors), "Cobb median deg": np.median(errors), "Cobb 90 %": np.quantile(errors, 0.9),
        "Cobb mean of sure films": np.mean([row["cobb_error"] for row in sure]) if sure else None,
        "SMAPE %": 100 * np.mean([row["smape"][0] / row["smape"][1] for row in read_rows]),
        "slips": len(slipped), "slips flagged": sum(row["doubtful"] for row in slipped),
        "flagged": sum(row["doubtful"] for row in read_rows), "17 found": sum(row["found"] == 17 for row in read_rows),
        "within 1 sd": (joined("ratios") < 1).mean(), "within 2 sd": (joined("ratios") < 2).mean(),
        "sd factor for 68.3 %": np.quantile(joined("ratios"), 0.683),
    }


def negatives(dicom):
    """Pictures that do not show a frontal spine, by name."""
    import skimage

    random = np.random.default_rng(5)
    yield "blank", np.full((1200, 800), 100.0)
    yield "noise", random.random((1600, 900))
    yield "coarse noise", np.kron(random.random((40, 20)), np.ones((40, 40)))
    yield "slope", np.add.outer(np.arange(1500.0), np.arange(700.0))
    for name in TEST_PHOTOGRAPHS:
        yield name, grey_of(Path(skimage.__file__).parent / "data" / name).astype(float)
    if dicom:
        import pydicom

        for path in sorted(Path(dicom).rglob("*.dcm")):
            try:
                dataset = pydicom.dcmread(path, force=True)
                if "TransferSyntaxUID" not in dataset.file_meta:
                    dataset.file_meta.TransferSyntaxUID = pydicom.uid.ImplicitVRLittleEndian
                pixels = dataset.pixel_array.astype(float)
            except Exception as error:  # pydicom has no decoder, or the file is damaged
                print(path.name, "not decoded:", type(error).__name__)
                continue
            pixels = pixels[0] if pixels.ndim == 3 and pixels.shape[-1] > 4 else pixels
            pixels = pixels.mean(axis=-1) if pixels.ndim == 3 else pixels
            yield str(path.relative_to(dicom)), pixels


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("data", type=Path)
    parser.add_argument("--part", default="validation")
    parser.add_argument("--weights", type=Path, default=OUT)
    parser.add_argument("--dicom", type=Path)
    parser.add_argument("--passes", type=int, default=1)
    parser.add_argument("--rows", type=Path)
    options = parser.parse_args()
    torch.set_num_threads(2)
    kernel = Kernel(options.weights)
    rows = []
    for film in read_films(options.data, parts=(options.part,)):
        rows.append(judge(kernel, film, grey_of(options.data / "images_training" / film.name), options.passes))
    groups = {"all": rows}
    for low, high in ((0, 25), (25, 46), (46, 200)):
        groups[f"{low} to {high} deg"] = [row for row in rows if low <= row["cobb_deg"] < high]
    for name, group in groups.items():
        print(name, {key: round(float(v), 3) if v is not None else None for key, v in summary(group).items()})
    for row in rows:
        if row["refused"] or row["shift"] or row["mixed"]:
            print(row["name"], {key: row.get(key) for key in ("refused", "shift", "mixed", "doubtful", "share", "found", "other")})
    if options.dicom:
        for name, grey in negatives(options.dicom):
            reading = read(kernel, grey)
            print(name, reading.refused or f"READ: {len(reading.vertebrae)} vertebrae, doubtful {reading.levels_doubtful}")
    if options.rows:
        options.rows.write_text(json.dumps(rows))


if __name__ == "__main__":
    main()
