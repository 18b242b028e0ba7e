"""Writes what the exported networks give for a film made by a formula, so that a port can be checked against it.

    python training/landmarks/reference.py
"""

import json
from pathlib import Path

import numpy as np
import torch
from data import FINE_HEIGHT, FINE_WIDTH, coarse_input, reduced
from decode import SD_FACTOR, chain_of, corners_from_patches, counted, peaks_of, read
from export import OUT
from kernel import Kernel
from patches import frames, patch

WIDTH, HEIGHT = 700, 1900
FILE = OUT.parent / "tests/reference.json"


def film():
    """A drawn spine: 17 bright blocks along a curve, on a grey ground. Integers in 0..255, by integer rounding of a formula."""
    x, y = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    grey = 60 + 40 * y / HEIGHT + 25 * np.cos((x - WIDTH / 2) / 160)
    for index in range(17):
        t = index / 16
        cx, cy = WIDTH / 2 + 60 * np.sin(4.2 * t), 120 + 1640 * (0.72 * t + 0.28 * t * t)
        tilt = np.arctan(60 * 4.2 * np.cos(4.2 * t) / (1640 * (0.72 + 0.56 * t)))
        half_height, half_width = 28 + 19 * t, 50 + 38 * t
        u = (x - cx) * np.cos(tilt) - (y - cy) * np.sin(tilt)
        v = (x - cx) * np.sin(tilt) + (y - cy) * np.cos(tilt)
        inside = np.maximum(np.abs(u) / half_width, np.abs(v) / half_height)
        edge = np.clip((1.08 - inside) / 0.16, 0, 1)
        grey = grey + edge * (70 + 25 * np.clip((inside - 0.75) * 4, 0, 1))
    return np.floor(np.clip(grey, 0, 255) + 0.5).astype(np.uint8)


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
    chain, start = chain_of(peaks)
    reading = read(kernel, grey)
    result = {
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
        "count": counted(peaks, chain, start),
        "sd_factor": SD_FACTOR,
        "reading": {
            "refused": reading.refused, "levels_doubtful": reading.levels_doubtful, "level_share": reading.level_share,
            "reasons": reading.reasons,
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
