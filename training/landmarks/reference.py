"""Writes what the exported networks give for a film made by a formula, so that a port can be checked against it.

    python training/landmarks/reference.py
"""

import json
from pathlib import Path

import numpy as np
import torch
from data import FINE_HEIGHT, FINE_WIDTH, coarse_input, reduced
from decode import SD_FACTOR, Peak, chain_of, corners_from_patches, peaks_of, read
from export import OUT
from kernel import Kernel
from patches import frames, patch

WIDTH, HEIGHT = 700, 1900
FILE = OUT.parent / "src/reference.json"


def film():
    """A drawn trunk: darker lungs with ribs, and 17 blocks with pedicles along a curve. Rounded to integers in 0..255."""
    x, y = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    aside = np.abs(x - WIDTH / 2)
    lung = np.exp(-(((y / HEIGHT - 0.33) / 0.16) ** 4))
    grey = 90 + 60 * y / HEIGHT - 80 * lung * (1 - np.exp(-((aside / 150) ** 4)))
    grey = grey + 25 * lung * np.clip(np.cos((y - 0.25 * aside) * 2 * np.pi / 90), 0, 1) * (aside > 70)
    for index in range(17):
        t = index / 16
        step = 1640 * (0.72 + 0.56 * t) / 16
        cx, cy = WIDTH / 2 + 70 * np.sin(4.2 * t), 110 + 1640 * (0.72 * t + 0.28 * t * t)
        tilt = np.arctan(70 * 4.2 * np.cos(4.2 * t) / (16 * step))
        high, wide = 0.73 * step / 2, 1.7 * 0.73 * step / 2
        u = (x - cx) * np.cos(tilt) - (y - cy) * np.sin(tilt)
        v = (x - cx) * np.sin(tilt) + (y - cy) * np.cos(tilt)
        out = np.maximum(np.abs(u) / wide, np.abs(v) / high)
        grey = grey + np.clip((1.1 - out) / 0.2, 0, 1) * (35 + 20 * np.clip((out - 0.75) * 4, 0, 1))
        for side in (-1, 1):
            ring = np.hypot((u - side * 0.72 * wide) / (0.16 * wide), (v + 0.1 * high) / (0.34 * high))
            grey = grey + 30 * np.exp(-(((ring - 1) / 0.35) ** 2))
    return np.floor(np.clip(grey, 0, 255) + 0.5).astype(np.uint8)


def made_peaks():
    """Peaks by a formula: 17 vertebrae of which the 8th has no peak, one of the neck, and two false ones. Checks the chain alone."""
    peaks = []
    for index in range(-1, 17):
        if index == 7:
            continue
        height = 11.0 + 0.5 * index
        middle = np.array([96 + 14 * np.sin(0.3 * index), 30 + 15 * index + 0.33 * index * index])
        levels = np.full(17, 0.2 / 15)
        levels[max(index, 0)] += 0.5
        levels[min(max(index + (1 if index % 3 else -1), 0), 16)] += 0.3
        peaks.append((middle, height, 0.3 + 0.02 * (index + 1), levels))
    for x, y in ((130.0, 120.0), (96.0, 200.0)):
        peaks.append((np.array([x, y]), 9.0, 0.2, np.full(17, 1 / 17)))
    quad = np.array([[-0.8, -0.5], [0.8, -0.5], [-0.8, 0.5], [0.8, 0.5]])
    return [Peak(middle, middle + quad * height, probability, levels) for middle, height, probability, levels in peaks]


def samples(values, count=48):
    """Sum, sum of absolute values, and `count` values at indices spread over the flattened array."""
    flat = np.asarray(values, np.float32).ravel()
    at = (np.arange(count) * 7919 + 13) * (flat.size // count | 1) % flat.size
    return {
        "shape": list(np.shape(values)), "sum": float(flat.sum(dtype=np.float64)), "absolute": float(np.abs(flat).sum(dtype=np.float64)),
        "indices": at.tolist(), "values": [round(float(flat[i]), 6) for i in at],
    }


def main():
    torch.set_num_threads(1)
    kernel = Kernel(OUT)
    grey = film()
    grid, left, top = coarse_input(grey)
    out = kernel.run("film", grid[None, None])[0]
    fine = reduced(grey, FINE_WIDTH, FINE_HEIGHT)
    # Patches at stated places, so that this part does not depend on the first network.
    centres = np.array([[fine.shape[1] / 2 + 20 * np.sin(k), 80.0 + 46 * k] for k in range(17)])
    down, lengths = frames(centres)
    pictures = np.array([patch(fine, *frame) for frame in zip(centres, down, lengths)])
    corners, spreads = corners_from_patches(kernel, fine, centres)
    peaks = peaks_of(out)
    chain, start, count = chain_of(peaks)
    reading = read(kernel, grey)
    made = made_peaks()
    made_chain, made_start, made_count = chain_of(made)
    result = {
        "made": {
            "peaks": [
                {"corners": p.corners.round(5).tolist(), "probability": round(p.probability, 5), "levels": p.levels.round(6).tolist()}
                for p in made
            ],
            "chain": [[*p.centre.round(4).tolist(), p.seen] for p in made_chain],
            "first_level": made_start,
            "count": made_count,
        },
        "film": {"width": WIDTH, "height": HEIGHT, **samples(grey)},
        "coarse": {"left": left, "top": top, **samples(grid)},
        "film_out": samples(out, 104),
        "fine": samples(fine),
        "patch_centres": centres.round(6).tolist(),
        "patches": samples(pictures),
        "patch_out": samples(kernel.run("patch", pictures[:, None]), 104),
        "patch_corners": corners.round(3).tolist(),
        "patch_spreads": spreads.round(4).tolist(),
        "peaks": [[*peak.centre.round(3).tolist(), round(peak.probability, 5)] for peak in peaks],
        "chain": [[*peak.centre.round(3).tolist(), peak.seen] for peak in chain],
        "first_level": start,
        "count": count,
        "sd_factor": SD_FACTOR,
        "reading": {
            "refused": reading.refused, "levels_doubtful": reading.levels_doubtful,
            "vertebrae": [
                {"level": v.level, "corners": v.corners.round(2).tolist(), "sd_px": v.sd_px.round(3).tolist(), "confidence": round(v.confidence, 4)}
                for v in reading.vertebrae
            ],
        },
    }
    FILE.parent.mkdir(parents=True, exist_ok=True)
    FILE.write_text(json.dumps(result), encoding="utf-8")
    print(f"{FILE.stat().st_size / 1e3:.0f} kB; {len(peaks)} peaks; {reading.refused or [v.level for v in reading.vertebrae]}")


if __name__ == "__main__":
    main()
