"""Changed copies of films: mirrored, turned, scaled, shifted, bent, cut, with other contrast; and pictures without a spine."""

from pathlib import Path

import numpy as np
import torch
from data import COARSE_HEIGHT, COARSE_WIDTH, FINE_HEIGHT, percentile
from torch.nn import functional as F

MIRRORED = [1, 0, 3, 2]


class Warp:
    """From the fine pixels of a film to the pixels of the canvas: mirror, bend, then rotation with scale, then shift.

    The bend maps a canvas point back by x' = x + f(y), y' = y - f'(y) x: near to a rotation by atan f' at each height, so that
    endplates turn with the spine.
    """

    def __init__(self, random, centre, half_height, mirror, turn_deg, scale, shift, bend_deg):
        self.centre, self.half, self.mirror, self.scale = centre, half_height, mirror, scale
        angle = np.radians(turn_deg)
        self.turn = scale * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        self.shift = shift
        self.slope = np.tan(np.radians(bend_deg) / 2) * random.uniform(-1, 1)
        self.wave = np.tan(np.radians(bend_deg) / 3) * random.uniform(-1, 1)
        self.phase, self.pitch = random.uniform(0, 2 * np.pi), random.uniform(1.5, 3.5)

    def bend(self, y):
        """f and f' at heights over the centre."""
        t = y / self.half
        wave = self.wave / self.pitch * self.half
        return (
            self.slope * self.half / 2 * t**2 + wave * (np.sin(self.pitch * t + self.phase) - np.sin(self.phase)),
            self.slope * t + self.wave * np.cos(self.pitch * t + self.phase),
        )

    def back(self, points):
        """From canvas to film."""
        q = (points - self.shift) @ np.linalg.inv(self.turn).T
        f, slope = self.bend(q[..., 1])
        q = np.stack([q[..., 0] + f, q[..., 1] - slope * q[..., 0]], axis=-1)
        return q * [-1 if self.mirror else 1, 1] + self.centre

    def forth(self, points):
        """From film to canvas, by iteration."""
        p = (points - self.centre) * [-1 if self.mirror else 1, 1]
        q = p.copy()
        for _ in range(30):
            f, slope = self.bend(q[..., 1])
            q = np.stack([p[..., 0] - f, p[..., 1] + slope * q[..., 0]], axis=-1)
        return q @ self.turn.T + self.shift


def sampled(fine, points):
    """Bilinear grey values of a film at points (x, y) in fine pixels, where (0, 0) is the corner of the first pixel."""
    height, width = fine.shape
    grid = torch.from_numpy((points / [width, height] * 2 - 1).astype(np.float32))[None]
    image = torch.from_numpy(fine)[None, None]
    return F.grid_sample(image, grid, mode="bilinear", padding_mode="border", align_corners=False)[0, 0]


def half_size(fine):
    return F.avg_pool2d(torch.from_numpy(fine.astype(np.float32))[None, None], 2)[0, 0].numpy()


def canvas(random, fine, corners):
    """A changed copy on the coarse grid, and corners on it in coarse pixels. `corners` are in fine pixels, or None."""
    half = half_size(fine)
    height, width = half.shape
    corners = None if corners is None else corners / 2
    whole = corners is not None and random.random() < 0.65
    middle = corners.reshape(-1, 2).mean(axis=0) if corners is not None else np.array([width, height]) / 2
    size = np.array([COARSE_WIDTH, COARSE_HEIGHT])
    bend = random.uniform(0, 30) if random.random() < 0.5 else 0.0
    scale = random.uniform(0.66, 1.1) if whole else random.uniform(0.6, 1.4)
    scale *= COARSE_HEIGHT / (FINE_HEIGHT / 2)
    warp = Warp(random, middle, height / 2, random.random() < 0.5, random.uniform(-12, 12), scale, np.zeros(2), bend)
    if corners is None:
        warp.shift = size / 2 + random.uniform(-0.3, 0.3, 2) * size
    else:
        moved = warp.forth(corners.reshape(-1, 2))
        low, high = moved.min(axis=0), moved.max(axis=0)
        slack = np.maximum((size - (high - low)) / 2 - 4, 0) if whole else np.array([0.3, 0.35]) * size
        warp.shift = size / 2 - (low + high) / 2 + random.uniform(-1, 1, 2) * slack
    # The map is smooth: every 8th point is enough.
    x, y = np.meshgrid(np.linspace(0.5, size[0] - 0.5, size[0] // 8 + 1), np.linspace(0.5, size[1] - 0.5, size[1] // 8 + 1))
    few = torch.from_numpy(warp.back(np.stack([x, y], axis=-1)).astype(np.float32))
    back = F.interpolate(few.permute(2, 0, 1)[None], (COARSE_HEIGHT, COARSE_WIDTH), mode="bilinear", align_corners=True)
    back = back[0].permute(1, 2, 0).numpy()
    grey = sampled(half, back).numpy()
    inside = (back >= 0).all(axis=-1) & (back[..., 0] < width) & (back[..., 1] < height)
    # Another crop of the film, so that its borders do not give the levels away.
    low, high = np.array([0, 0]), size
    if random.random() < 0.5:
        if corners is not None and (whole or random.random() < 0.5):
            points = warp.forth(corners.reshape(-1, 2))
            low = np.floor((points.min(axis=0) - 3) * random.uniform(0, 1, 2)).astype(int)
            high = np.ceil(size - (size - points.max(axis=0) - 3) * random.uniform(0, 1, 2)).astype(int)
        else:
            low = (size * [0.25, 0.2] * random.random(2)).astype(int)
            high = (size - size * [0.25, 0.2] * random.random(2)).astype(int)
    low, high = np.maximum(low, 0), np.minimum(high, size)
    cut = np.zeros_like(inside)
    cut[low[1] : high[1], low[0] : high[0]] = True
    inside &= cut
    points = None
    if corners is not None:
        points = warp.forth(corners.reshape(-1, 2)).reshape(-1, 4, 2)
        points = points[:, MIRRORED] if warp.mirror else points
    return grey, inside, points


def contrast(random, grey, inside):
    """Normalised grey values with other contrast, borders, noise and blur."""
    values = grey[inside] if inside.sum() > 2000 else grey.ravel()
    low, high = percentile(values[::7], 0.01), percentile(values[::7], 0.99)
    x = np.clip((grey - low) / max(high - low, 1e-6), 0, 1).astype(np.float32)
    x = x ** np.exp(random.uniform(-0.6, 0.6))
    if random.random() < 0.3:
        x = 1 - x
    height, width = x.shape
    if random.random() < 0.4:
        v, u = np.meshgrid(np.linspace(-1, 1, height), np.linspace(-1, 1, width), indexing="ij")
        x = x + random.normal(0, 0.15) * u + random.normal(0, 0.15) * v
    if random.random() < 0.2:
        x = F.avg_pool2d(torch.from_numpy(x.astype(np.float32))[None, None], 3, 1, 1)[0, 0].numpy()
    x = x * random.uniform(1.4, 2.2) - 1 + random.normal(0, 0.1)
    if random.random() < 0.4:
        x = x + random.uniform(0, 0.12) * random.standard_normal(x.shape, dtype=np.float32)
    for _ in range(random.integers(0, 3)):
        top, left = random.integers(0, height - 8), random.integers(0, width - 8)
        x[top : top + random.integers(2, 16), left : left + random.integers(2, 30)] = random.uniform(-1, 1)
    kind = random.random()
    border = 0.0 if kind < 0.5 else random.uniform(-1, 1) if kind < 0.8 else random.choice([-1.0, 1.0])
    x = np.where(inside, x, border + (random.normal(0, 0.1, x.shape) if random.random() < 0.2 else 0))
    if random.random() < 0.3:
        # A port cannot know where a film has black borders: they are a part of its percentiles.
        low, high = percentile(x[::3, ::3], 0.01), percentile(x[::3, ::3], 0.99)
        x = (x - low) / max(high - low, 1e-6) * 2 - 1
    return np.clip(x, -1, 1).astype(np.float32)


def without_spine(random, films, photographs):
    """A picture without a frontal spine."""
    kind = random.integers(0, 7)
    height, width = COARSE_HEIGHT, COARSE_WIDTH
    everything = np.ones((height, width), bool)
    if kind == 0:
        blank = np.full((height, width), random.uniform(-1, 1)) + random.normal(0, random.uniform(0, 0.8), (height, width))
        return np.clip(blank, -1, 1).astype(np.float32)
    if kind == 1:
        coarse = torch.from_numpy(random.random((1, 1, random.integers(3, 40), random.integers(3, 24))).astype(np.float32))
        smooth = F.interpolate(coarse, (height, width), mode="bilinear", align_corners=False)[0, 0].numpy()
        return contrast(random, smooth, everything)
    if kind <= 4:
        picture = photographs[random.integers(len(photographs))]
        grey, inside, _ = canvas(random, picture, None)
        return contrast(random, grey, inside if kind == 4 else everything)
    film = films[random.integers(len(films))]
    if kind == 5:
        # Lying, or upside down.
        fine = np.rot90(film.fine, random.integers(1, 4))
        grey, inside, _ = canvas(random, np.ascontiguousarray(fine), None)
        return contrast(random, grey, inside)
    # Beside the spine: the film without the band of the spine, its halves pushed together.
    corners = film.corners * film.scale
    left, right = int(corners[..., 0].min()) - 6, int(corners[..., 0].max()) + 6
    sides = np.concatenate([film.fine[:, : max(left, 1)], film.fine[:, min(right, film.fine.shape[1] - 1) :]], axis=1)
    if sides.shape[1] < 60:
        sides = np.tile(sides, (1, 60 // sides.shape[1] + 1))
    grey, inside, _ = canvas(random, sides, None)
    return contrast(random, grey, inside)


def photographs():
    """Pictures that scikit-image ships, without those that evaluate.py keeps for its test of refusals."""
    import skimage
    from PIL import Image

    folder = Path(skimage.__file__).parent / "data"
    names = ["brick", "cell", "chelsea", "clock_motion", "coins", "grass", "gravel", "horse", "ihc", "motorcycle_left", "page", "phantom"]
    pictures = [np.asarray(Image.open(folder / f"{name}.png").convert("L")) for name in names]
    return [picture if min(picture.shape) > 250 else np.kron(picture, np.ones((2, 2), np.uint8)) for picture in pictures]


TEST_PHOTOGRAPHS = ["astronaut.png", "camera.png", "coffee.png", "moon.png", "retina.jpg", "rocket.jpg", "hubble_deep_field.jpg", "microaneurysms.png"]
