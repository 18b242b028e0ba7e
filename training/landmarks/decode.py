"""From the networks' maps to named vertebrae with corners, confidences and warnings. Plain loops: this file is ported line by line."""

from dataclasses import dataclass, field

import numpy as np
from data import FINE_HEIGHT, FINE_WIDTH, LEVELS, coarse_input, grid_scale, reduced
from patches import MAP, PATCH, frames, from_patch, patch

CELL, UNIT = 4.0, 16.0
LEAST_PEAK = 0.10
"""A centre's probability below which no vertebra is looked for."""
STEP_OVER_HEIGHT = 1.37
"""Distance between neighbouring centres over the vertebrae's height: geometric mean of the training films."""
STEP_SPREAD, TURN_SPREAD_RAD = 0.15, 0.30
"""Spread of the logarithm of a step, and of its direction, beyond which a neighbour is doubted. Labels of the training films: 0.11 and 0.05."""
SKIP_COST = 0.5
"""Cost of a vertebra that no peak shows."""
WORST_LINK = 2.5
"""Cost of a step beyond which two peaks are not neighbours."""
LEVEL_WEIGHT, LEVEL_GAIN = 0.08, 2.0
"""Weight of the logarithm of a level's probability beside a peak's; a level of probability exp(-2) neither gains nor loses."""
LEVEL_FLOOR = 0.01
"""Least probability of a level: no single vertebra decides on the count."""
LEVEL_TEMPER = 4.0
"""Neighbouring vertebrae err together: their votes for a level count as much as a quarter of them."""
LEAST_SHARE = 0.90
"""Probability of the count below which levels are doubtful."""
BEYOND_PEAK, END_PEAK = 0.50, 0.35
"""Levels are doubtful where a stronger peak than the first follows T1 or L5, or where T1 or L5 is weaker than the second."""
LEAST_VERTEBRAE, LEAST_MEAN_PEAK, LEAST_LAST = 12, 0.30, 13
"""A film with fewer vertebrae, with weaker ones, or without L2 is refused: a chest film shows a part of the spine as well."""
SD_FACTOR = 1.0
"""Stated over predicted standard deviation. The validation films give 0.97 for 68.3 % within one: left at 1."""


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
    """The chain of peaks, from above, with the largest sum of probabilities and agreement of levels, less costs of steps.

    A state is a peak as a level, from T1 (0) to L5 (16). The next peak is the next level, or the next but one: then a vertebra
    that no peak shows is put between. Returns the chain and the level of its first vertebra.
    """
    peaks = sorted(peaks, key=lambda peak: peak.centre[1])
    if not peaks:
        return [], 0
    total = np.zeros((len(peaks), 17))
    before = {}
    for j, lower in enumerate(peaks):
        own = lower.probability + LEVEL_WEIGHT * (np.log(np.maximum(lower.levels, LEVEL_FLOOR)) + LEVEL_GAIN)
        total[j] = own
        for i in range(j):
            for steps in (1, 2):
                cost = link_cost(peaks[i], lower, steps)
                if cost > WORST_LINK:
                    continue
                for level in range(steps, 17):
                    value = total[i, level - steps] - cost + own[level]
                    if value > total[j, level]:
                        total[j, level] = value
                        before[j, level] = (i, level - steps)
    j, level = np.unravel_index(int(np.argmax(total)), total.shape)
    state, chain = (int(j), int(level)), []
    while True:
        chain.append(peaks[state[0]])
        last = before.get(state)
        if last is None:
            return chain[::-1], state[1]
        if state[1] - last[1] == 2:
            upper, lower = peaks[last[0]], peaks[state[0]]
            middle, corners = (upper.centre + lower.centre) / 2, (upper.corners + lower.corners) / 2
            chain.append(Peak(middle, corners, 0.0, np.full(17, 1 / 17), seen=False))
        state = last


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


def beyond(peaks, chain):
    """The strongest peaks that could be the next vertebra above and below the chain."""
    above, below = 0.0, 0.0
    for peak in peaks:
        if peak.centre[1] < chain[0].centre[1] and link_cost(peak, chain[0], 1) < 1.0:
            above = max(above, peak.probability)
        if peak.centre[1] > chain[-1].centre[1] and link_cost(chain[-1], peak, 1) < 1.0:
            below = max(below, peak.probability)
    return above, below


def counted(peaks, chain, start):
    """The probability of `start` as the level of the chain's first vertebra, and why it is doubtful."""
    first, shares = shares_of_levels(chain, LEVEL_TEMPER)
    best = start + len(chain) - 1
    third = max(len(chain) // 3, 1)
    reasons = []
    from_above = shares_of_levels(chain[:third], 1.0)
    from_below = shares_of_levels(chain[-third:], 1.0)
    if from_above[0][int(np.argmax(from_above[1]))] != start:
        reasons.append("the count from above disagrees")
    if from_below[0][int(np.argmax(from_below[1]))] - (len(chain) - third) != start:
        reasons.append("the count from below disagrees")
    if shares[best] < LEAST_SHARE:
        reasons.append("another count is likely as well")
    above, below = beyond(peaks, chain)
    if above > BEYOND_PEAK:
        reasons.append("a vertebra may follow above")
    if below > BEYOND_PEAK:
        reasons.append("a vertebra may follow below")
    if min(chain[0].probability, chain[-1].probability) < END_PEAK:
        reasons.append("the first or last vertebra is weak")
    if len(chain) < 17:
        reasons.append(f"{len(chain)} vertebrae of 17")
    if not all(peak.seen for peak in chain):
        reasons.append("a vertebra is filled in between two others")
    return float(shares[best]), reasons


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
    peaks = peaks_of(out)
    chain, start = chain_of(peaks)
    reading = Reading()
    seen = [peak.probability for peak in chain if peak.seen]
    if len(seen) < LEAST_VERTEBRAE or np.mean(seen) < LEAST_MEAN_PEAK or start + len(chain) - 1 < LEAST_LAST:
        reading.refused = f"no frontal spine found: {len(seen)} vertebrae in a row"
        return reading
    reading.level_share, reading.reasons = counted(peaks, chain, start)
    kept = [(start + place, peak) for place, peak in enumerate(chain)]
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
    reading.levels_doubtful = bool(reading.reasons)
    return reading
