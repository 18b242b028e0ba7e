"""From the networks' maps to named vertebrae with corners, confidences and warnings. Plain loops: this file is ported line by line."""

from dataclasses import dataclass, field

import numpy as np
from data import COARSE_HEIGHT, COARSE_WIDTH, FINE_HEIGHT, FINE_WIDTH, LEVELS, coarse_input, reduced, reduced_size
from patches import MAP, PATCH, frames, from_patch, patch

CELL, UNIT = 4.0, 16.0
LEAST_PEAK = 0.10
"""A centre's probability below which no vertebra is looked for."""
STEP_OVER_HEIGHT = 1.37
"""Distance between neighbouring centres over the vertebrae's height: geometric mean of the training films."""
STEP_SPREAD, TURN_SPREAD_RAD = 0.22, 0.30
"""Spread of the logarithm of a step, and of its direction, beyond which a neighbour is doubted: twice that of the training films."""
SKIP_COST = 0.4
"""Cost of a vertebra that no peak shows."""
WORST_LINK = 1.5
"""Cost of a step beyond which two peaks are not neighbours."""
LEVEL_FLOOR = 0.01
"""Least probability of a level: no single vertebra decides on the count."""
LEVEL_TEMPER = 4.0
"""Neighbouring vertebrae err together: their votes for a level count as much as a quarter of them."""
LEAST_SHARE = 0.90
LEAST_VERTEBRAE, LEAST_MEAN_PEAK = 11, 0.30
"""A film with fewer vertebrae, or with weaker ones, is refused."""
SD_FACTOR = 1.0
"""Stated over predicted standard deviation: calibrated on the validation films."""


@dataclass
class Peak:
    centre: np.ndarray
    corners: np.ndarray
    probability: float
    levels: np.ndarray
    seen: bool = True

    @property
    def axis(self):
        return (self.corners[2] + self.corners[3] - self.corners[0] - self.corners[1]) / 2

    @property
    def height(self):
        return max(float(np.hypot(*self.axis)), 1.0)


@dataclass
class Vertebra:
    level: str
    corners: np.ndarray
    """4 x (x, y) in px of the film: upper left, upper right, lower left, lower right as seen."""
    sd_px: np.ndarray
    """Standard deviation of each corner, per axis."""
    confidence: float
    seen: bool


@dataclass
class Reading:
    vertebrae: list = field(default_factory=list)
    refused: str = ""
    levels_doubtful: bool = False
    level_share: float = 0.0
    reasons: list = field(default_factory=list)


def sigmoid(x):
    return 1 / (1 + np.exp(-np.clip(x, -30, 30)))


def softmax(x):
    e = np.exp(x - x.max())
    return e / e.sum()


def peaks_of(out):
    """Local maxima of the centres' map, strongest first; of two on one vertebra the stronger one. In coarse pixels."""
    heat = sigmoid(out[0])
    rows, columns = heat.shape
    found = []
    for row in range(rows):
        for column in range(columns):
            value = heat[row, column]
            around = heat[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
            if value < LEAST_PEAK or value < around.max():
                continue
            middle = np.array([column + 0.5, row + 0.5]) * CELL
            corners = middle + UNIT * out[1:9, row, column].reshape(4, 2)
            found.append(Peak(corners.mean(axis=0), corners, float(value), softmax(out[9:26, row, column])))
    found.sort(key=lambda peak: -peak.probability)
    kept = []
    for peak in found:
        if all(np.hypot(*(peak.centre - other.centre)) > 0.5 * (peak.height + other.height) / 2 for other in kept):
            kept.append(peak)
    return kept


def link_cost(upper, lower, steps):
    """Cost of `lower` being the next vertebra but `steps - 1` below `upper`."""
    way = lower.centre - upper.centre
    length = float(np.hypot(*way))
    along = upper.axis / upper.height + lower.axis / lower.height
    turn = abs(np.arctan2(along[0] * way[1] - along[1] * way[0], along[0] * way[0] + along[1] * way[1]))
    ratio = np.log(max(length, 1e-6) / (steps * STEP_OVER_HEIGHT * (upper.height + lower.height) / 2))
    return 0.25 * ((ratio / STEP_SPREAD) ** 2 + (turn / TURN_SPREAD_RAD) ** 2) + SKIP_COST * (steps - 1)


def chain_of(peaks):
    """The chain of peaks, from above, with the largest sum of probabilities less costs. A missing vertebra is put between."""
    peaks = sorted(peaks, key=lambda peak: peak.centre[1])
    total, before = [], []
    for j, lower in enumerate(peaks):
        best, link = lower.probability, None
        for i in range(j):
            for steps in (1, 2):
                cost = link_cost(peaks[i], lower, steps)
                if cost < WORST_LINK and total[i] - cost + lower.probability > best:
                    best, link = total[i] - cost + lower.probability, (i, steps)
        total.append(best)
        before.append(link)
    if not peaks:
        return []
    j, chain = int(np.argmax(total)), []
    while True:
        chain.append(peaks[j])
        if before[j] is None:
            break
        i, steps = before[j]
        if steps == 2:
            upper, lower = peaks[i], peaks[j]
            chain.append(Peak((upper.centre + lower.centre) / 2, (upper.corners + lower.corners) / 2, 0.0, np.full(17, 1 / 17), seen=False))
        j = i
    return chain[::-1]


def shares_of_levels(chain, temper):
    """Probability of every level of the chain's first vertebra, from -(n - 1) to 16."""
    first = np.arange(-(len(chain) - 1), 17)
    scores = np.zeros(len(first))
    for index, level in enumerate(first):
        for place, peak in enumerate(chain):
            if peak.seen:
                here = level + place
                scores[index] += np.log(max(peak.levels[here], LEVEL_FLOOR) if 0 <= here < 17 else LEVEL_FLOOR / 2)
    return first, softmax(scores / temper)


def counted(chain):
    """The level of the chain's first vertebra, its probability, and why it is doubtful."""
    first, shares = shares_of_levels(chain, LEVEL_TEMPER)
    best = int(np.argmax(shares))
    third = max(len(chain) // 3, 1)
    reasons = []
    above = shares_of_levels(chain[:third], 1.0)
    below = shares_of_levels(chain[-third:], 1.0)
    if above[0][int(np.argmax(above[1]))] != first[best]:
        reasons.append("the count from above disagrees")
    if below[0][int(np.argmax(below[1]))] - (len(chain) - third) != first[best]:
        reasons.append("the count from below disagrees")
    if shares[best] < LEAST_SHARE:
        reasons.append("another count is likely as well")
    return int(first[best]), float(shares[best]), reasons


def corners_from_patches(kernel, fine, centres):
    """Corners in fine pixels, and standard deviation per axis, of each vertebra."""
    down, lengths = frames(centres)
    pictures = [patch(fine, centre, axis, length) for centre, axis, length in zip(centres, down, lengths)]
    logits = kernel.run("patch", np.array(pictures)[:, None])
    corners, spreads = [], []
    cells = np.arange(MAP) + 0.5
    for index in range(len(centres)):
        for k in range(4):
            share = softmax(logits[index, k].astype(np.float64))
            x, y = (share.sum(axis=0) * cells).sum(), (share.sum(axis=1) * cells).sum()
            variance = (share.sum(axis=0) * (cells - x) ** 2).sum() + (share.sum(axis=1) * (cells - y) ** 2).sum()
            point = np.array([x, y]) * (PATCH / MAP)
            corners.append(from_patch(point, centres[index], down[index], lengths[index]))
            spreads.append(np.sqrt(variance / 2) * 2.5 * lengths[index] / MAP)
    return np.array(corners).reshape(-1, 4, 2), np.array(spreads).reshape(-1, 4)


def read(kernel, grey, passes=1):
    """Reads a film. `grey`: rows x columns of any unit, bones bright or dark."""
    grid, left, top = coarse_input(grey)
    out = kernel.run("film", grid[None, None])[0]
    chain = chain_of(peaks_of(out))
    reading = Reading()
    seen = [peak.probability for peak in chain if peak.seen]
    if len(seen) < LEAST_VERTEBRAE or np.mean(seen) < LEAST_MEAN_PEAK:
        reading.refused = f"no frontal spine found: {len(seen)} vertebrae in a row"
        return reading
    start, reading.level_share, reading.reasons = counted(chain)
    kept = [(start + place, peak) for place, peak in enumerate(chain) if 0 <= start + place < 17]
    if len(kept) < LEAST_VERTEBRAE:
        reading.refused = f"no frontal spine found: {len(kept)} vertebrae between T1 and L5"
        return reading
    fine = reduced(grey, FINE_WIDTH, FINE_HEIGHT)
    coarse = grid_scale(grey)
    to_film = lambda points: (points - [left, top]) / coarse
    fine_scale = np.array([fine.shape[1] / grey.shape[1], fine.shape[0] / grey.shape[0]])
    centres = to_film(np.array([peak.centre for _, peak in kept])) * fine_scale
    for _ in range(passes):
        corners, spreads = corners_from_patches(kernel, fine, centres)
        centres = corners.mean(axis=1)
    heights = np.hypot(*(corners[:, 2:].mean(axis=1) - corners[:, :2].mean(axis=1)).T)
    for (level, peak), quad, spread, height in zip(kept, corners / fine_scale, spreads * SD_FACTOR, heights):
        confidence = peak.probability * float(np.exp(-((spread.mean() / height) / 0.25) ** 2))
        reading.vertebrae.append(Vertebra(LEVELS[level], quad, spread / fine_scale.mean(), confidence, peak.seen))
    if len(kept) < 17:
        reading.reasons.append(f"{len(kept)} vertebrae of 17")
    if any(not peak.seen for _, peak in kept):
        reading.reasons.append("a vertebra is filled in between two others")
    reading.levels_doubtful = bool(reading.reasons)
    return reading


def grid_scale(grey):
    """Coarse pixels per pixel in x and y."""
    width, height = reduced_size(grey.shape, COARSE_WIDTH, COARSE_HEIGHT)
    return np.array([width / grey.shape[1], height / grey.shape[0]])
