"""Fits the odds of a chain of vertebrae (decode.py) to labelled films by maximum likelihood, and judges the probability of levels.

    python training/landmarks/levels.py path/to/aasce

Fitted: training and validation films. The networks know the training films, so that the test films are judged alone.
"""

import argparse
from pathlib import Path

import numpy as np
import torch
from data import coarse_input, grey_of, grid_scale, read_films
from decode import (
    LEAST_SHARE,
    PEAK_COST,
    PEAK_GAIN,
    SKIP_COST,
    STEP_WEIGHT,
    VOTE_WEIGHT,
    best_of,
    counted,
    marginals,
    odds_of,
    peaks_of,
    steps_of,
)
from export import OUT
from kernel import Kernel
from scipy.optimize import minimize

NEAR = 0.6
"""A peak shows a labelled vertebra within this part of its height."""
SHARPER = 1.2
"""Factor on the fitted numbers, at which the probability of a whole film's levels is nearest to how often they are right."""


def prepared(kernel, film, folder):
    """Peaks of a film from above, its steps, and the label of every peak; -1 without one."""
    grey = grey_of(folder / film.name)
    grid, left, top = coarse_input(grey)
    peaks = sorted(peaks_of(kernel.run("film", grid[None, None])[0]), key=lambda peak: peak.centre[1])
    middles = film.corners.mean(axis=1) * grid_scale(grey) + [left, top]
    heights = np.hypot(*((film.corners[:, 2:] - film.corners[:, :2]).mean(axis=1) * grid_scale(grey)).T)
    away = [np.hypot(*(middles - peak.centre).T) for peak in peaks]
    nearest = [int(a.argmin()) for a in away]
    labels = [n if a[n] < NEAR * heights[n] else -1 for n, a in zip(nearest, away)]
    return peaks, steps_of(peaks), labels, nearest


def loss(numbers, films):
    """Mean over films of the negative log likelihood of their labels, peak by peak."""
    total = 0.0
    for peaks, steps, labels, _ in films:
        above, below, everything = marginals(*odds_of(peaks, steps, numbers))
        shares = above + below - everything
        for share, label in zip(shares, labels):
            none = np.log(max(1 - np.exp(np.logaddexp.reduce(share)), 2e-3))
            total -= (max(share[label], -6) if label >= 0 else none) / 17
    return total / len(films)


def judge(films, numbers):
    """How often levels are right, by their stated probability."""
    rows = []
    for peaks, steps, _, nearest in films:
        own, links = odds_of(peaks, steps, numbers)
        states = best_of(own, links)
        rows.append((counted(own, links, states)[0], all(nearest[peak] == level for peak, level in states)))
    stated, right = np.array(rows).T
    print(f"{len(rows)} films: stated {stated.mean():.2f}, right {right.mean():.2f}")
    for low, high in ((0, 0.6), (0.6, 0.8), (0.8, LEAST_SHARE), (LEAST_SHARE, 0.95), (0.95, 1.01)):
        these = (stated >= low) & (stated < high)
        if these.any():
            print(f"  {low:.2f} to {min(high, 1):.2f}: {these.sum()} films, right {right[these].mean():.2f}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("data", type=Path)
    data = parser.parse_args().data
    torch.set_num_threads(2)
    kernel = Kernel(OUT)
    of = lambda part: [prepared(kernel, film, data / "images_training") for film in read_films(data, parts=(part,))]
    fitted = of("train") + of("validation")
    now = (PEAK_GAIN, PEAK_COST, VOTE_WEIGHT, STEP_WEIGHT, SKIP_COST)
    limits = [(0, 20), (-5, 8), (0, 3), (0, 2), (-3, 10)]
    found = minimize(loss, now, args=(fitted,), method="L-BFGS-B", bounds=limits, options={"maxiter": 15, "eps": 1e-3})
    print("fitted, times", SHARPER, (SHARPER * found.x).round(3), "in use", now)
    judge(of("test"), now)


if __name__ == "__main__":
    main()
