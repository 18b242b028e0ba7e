"""From the networks' maps to named vertebrae with corners, confidences and warnings. Plain loops: this file is ported line by line.

The program adds the votes of marked iliac crests, which the films here do not have.
"""

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
PEAK_GAIN, PEAK_COST = 6.1, 1.1
"""Logarithm of the odds of a vertebra: the first times the peak's probability, less the second."""
VOTE_WEIGHT, VOTE_FLOOR = 0.07, 0.01
"""Weight of the logarithm of a level's probability, and the least one: no single vertebra decides on the count."""
STEP_WEIGHT = 0.06
"""Weight of the squared deviation of a step."""
SKIP_COST = 2.35
"""Cost of a vertebra that no peak shows. These numbers are fitted by levels.py."""
WORST_DEVIATION = (10.0, 8.0)
"""Squared deviation beyond which two peaks are not neighbours, or have no vertebra between."""
LEAST_SHARE = 0.90
"""Probability of the levels below which they are doubtful."""
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
    count: tuple = (0.0, 1, 0.0)


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


def deviation(upper, lower, steps):
    """Squared deviation of `lower` being the next vertebra but `steps - 1` below `upper`."""
    way = lower.centre - upper.centre
    length = float(np.hypot(*way))
    along = upper.axis / upper.height + lower.axis / lower.height
    turn = abs(np.arctan2(along[0] * way[1] - along[1] * way[0], along[0] * way[0] + along[1] * way[1]))
    ratio = np.log(max(length, 1e-6) / (steps * STEP_OVER_HEIGHT * (upper.height + lower.height) / 2))
    return (ratio / STEP_SPREAD) ** 2 + (turn / TURN_SPREAD_RAD) ** 2


def steps_of(peaks):
    """All steps between peaks, which are sorted from above: upper, lower, levels, squared deviation; by the lower one."""
    pairs = [(i, j, levels) for j in range(len(peaks)) for i in range(j) for levels in (1, 2)]
    steps = [(i, j, levels, deviation(peaks[i], peaks[j], levels)) for i, j, levels in pairs]
    return [step for step in steps if step[3] < WORST_DEVIATION[step[2] - 1]]


def odds_of(peaks, steps, numbers):
    """Logarithms of the odds of every peak as every level, and of every step."""
    gain, cost, vote, step_weight, skip = numbers
    own = np.array([gain * p.probability - cost + vote * np.log(np.maximum(p.levels, VOTE_FLOOR)) for p in peaks])
    links = [(i, j, levels, -step_weight * squared - skip * (levels - 1)) for i, j, levels, squared in steps]
    return own, links


def best_of(own, links):
    """The most probable chain as peaks with levels, from above."""
    total, before = own.copy(), {}
    for i, j, levels, odds in links:
        for level in range(levels, 17):
            value = total[i, level - levels] + odds + own[j, level]
            if value > total[j, level]:
                total[j, level], before[j, level] = value, (i, level - levels)
    state = tuple(int(k) for k in np.unravel_index(int(np.argmax(total)), total.shape))
    states = []
    while state is not None:
        states.append(state)
        state = before.get(state)
    return states[::-1]


def marginals(own, links):
    """Logarithms of the sums over all chains: those that end at a peak as a level, what follows it, all."""
    above, below = own.copy(), np.zeros_like(own)
    for i, j, levels, odds in links:
        above[j, levels:] = np.logaddexp(above[j, levels:], above[i, :-levels] + odds + own[j, levels:])
    for i, j, levels, odds in reversed(links):
        below[i, :-levels] = np.logaddexp(below[i, :-levels], odds + own[j, levels:] + below[j, levels:])
    return above, below, np.logaddexp.reduce(above, axis=None)


def counted(own, links, states):
    """Probability of the levels of a chain (geometric mean over its vertebrae); the most probable other shift, and its probability."""
    above, below, everything = marginals(own, links)
    shares = above + below - everything
    logs = [shares[state] for state in states]
    odds_of_gap = {(i, j): odds for i, j, levels, odds in links if levels == 2}
    for (i, upper), (j, lower) in zip(states, states[1:]):
        if lower - upper == 2:
            logs.append(above[i, upper] + odds_of_gap[i, j] + own[j, lower] + below[j, lower] - everything)
    at = lambda peak, level: np.exp(shares[peak, level]) if 0 <= level < 17 else 0.0
    others = {shift: float(np.mean([at(peak, level + shift) for peak, level in states])) for shift in (-1, 1, -2, 2, -3, 3)}
    other = max(others, key=others.get)
    return float(np.exp(np.mean(logs))), other, others[other]


def chain_of(peaks):
    """The most probable chain of peaks, from above: its vertebrae, the level of the first one, and how sure the levels are.

    A state is a peak as a level, from T1 (0) to L5 (16). The next peak is the next level, or the next but one: then a vertebra
    that no peak shows is put between.
    """
    peaks = sorted(peaks, key=lambda peak: peak.centre[1])
    if not peaks:
        return [], 0, (0.0, 1, 0.0)
    own, links = odds_of(peaks, steps_of(peaks), (PEAK_GAIN, PEAK_COST, VOTE_WEIGHT, STEP_WEIGHT, SKIP_COST))
    states, chain = best_of(own, links), []
    for place, (peak, level) in enumerate(states):
        lower = peaks[peak]
        if place and level - states[place - 1][1] == 2:
            upper = peaks[states[place - 1][0]]
            middle, corners = (upper.centre + lower.centre) / 2, (upper.corners + lower.corners) / 2
            chain.append(Peak(middle, corners, 0.0, np.full(17, 1 / 17), seen=False))
        chain.append(lower)
    return chain, states[0][1], counted(own, links, states)


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
    chain, start, count = chain_of(peaks)
    reading = Reading()
    seen = [peak.probability for peak in chain if peak.seen]
    if len(seen) < LEAST_VERTEBRAE or np.mean(seen) < LEAST_MEAN_PEAK or start + len(chain) - 1 < LEAST_LAST:
        reading.refused = f"no frontal spine found: {len(seen)} vertebrae in a row"
        return reading
    reading.count = count
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
    reading.levels_doubtful = count[0] < LEAST_SHARE
    return reading
