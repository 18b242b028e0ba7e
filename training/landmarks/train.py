"""Trains both networks from scratch.

    python training/landmarks/train.py path/to/aasce --out DIR

Seeded. About 40 minutes on two free cores, two hours on busy ones. It calculates in bf16, and another processor gives other last digits.
"""

import argparse
import time
from pathlib import Path

import numpy as np
import torch
from augment import MIRRORED, canvas, contrast, photographs, without_spine
from data import COARSE_HEIGHT, COARSE_WIDTH, read_films
from network import CENTRE, CORNERS, LEVEL, Network, film_plan, patch_plan
from patches import MAP, PATCH, frames, patch, to_patch
from torch.nn import functional as F

HEIGHT, WIDTH = COARSE_HEIGHT // 4, COARSE_WIDTH // 4
UNIT = 16.0


class Draw(torch.utils.data.Dataset):
    """Item `index` of an endless sequence: depends on the seed and the index only, not on the number of workers."""

    def __init__(self, films, seed, count):
        self.films, self.seed, self.count = films, seed, count

    def __len__(self):
        return self.count

    def drawn(self, index):
        turn, place = divmod(index, len(self.films))
        order = np.random.default_rng([self.seed, turn]).permutation(len(self.films))
        return self.films[order[place]], np.random.default_rng([self.seed, index, 1])


class Canvases(Draw):
    photographs = photographs()

    def __getitem__(self, index):
        film, random = self.drawn(index)
        heat = np.zeros((HEIGHT, WIDTH), np.float32)
        offsets = np.zeros((8, HEIGHT, WIDTH), np.float32)
        level = np.full((HEIGHT, WIDTH), -1, np.int64)
        if random.random() < 0.12:
            return without_spine(random, self.films, self.photographs)[None], heat, offsets, level
        grey, inside, corners = canvas(random, film.fine, film.corners * film.scale)
        grey = contrast(random, grey, inside)
        v, u = np.meshgrid(np.arange(HEIGHT) * 4 + 2.0, np.arange(WIDTH) * 4 + 2.0, indexing="ij")
        nearest = np.full((HEIGHT, WIDTH), np.inf)
        for index, quad in enumerate(corners):
            x, y = quad.mean(axis=0)
            if not (0 <= x < COARSE_WIDTH and 0 <= y < COARSE_HEIGHT and inside[int(y), int(x)]):
                continue
            size = np.hypot(*(quad[2:].mean(axis=0) - quad[:2].mean(axis=0)))
            square = (u - x) ** 2 + (v - y) ** 2
            heat = np.maximum(heat, np.exp(-square / (2 * max(3.0, 0.22 * size) ** 2)))
            heat[int(y) // 4, int(x) // 4] = 1
            here = (np.abs(u - x) < 6.01) & (np.abs(v - y) < 6.01) & (square < nearest)
            nearest[here] = square[here]
            level[here] = index
            for k in range(4):
                offsets[2 * k][here] = (quad[k, 0] - u[here]) / UNIT
                offsets[2 * k + 1][here] = (quad[k, 1] - v[here]) / UNIT
        return grey[None], heat.astype(np.float32), offsets, level


def film_loss(out, heat, offsets, level):
    out = out.float()
    logit = out[:, CENTRE][:, 0]
    p = torch.sigmoid(logit)
    peak = heat > 0.999
    count = peak.sum().clamp(min=1)
    found = -(F.logsigmoid(logit) * (1 - p) ** 2)[peak].sum() / count
    empty = -(F.logsigmoid(-logit) * p**2 * (1 - heat) ** 4)[~peak].sum() / count
    near = level >= 0
    if not near.any():
        return found + empty, (0, 0)
    corner = (out[:, CORNERS] - offsets).abs().mean(dim=1)[near].mean()
    named = F.cross_entropy(out[:, LEVEL].permute(0, 2, 3, 1)[near], level[near])
    return found + empty + corner + 0.5 * named, (corner.item() * UNIT, named.item())


class Patches(Draw):
    def __getitem__(self, index):
        film, random = self.drawn(index)
        fine, corners = film.fine.astype(np.float32), film.corners * film.scale
        if random.random() < 0.5:
            fine = fine[:, ::-1]
            corners = (corners * [-1, 1] + [fine.shape[1], 0])[:, MIRRORED]
        x = (fine / 255) ** np.exp(random.uniform(-0.5, 0.5))
        x = -x if random.random() < 0.3 else x
        centres = corners.mean(axis=1)
        _, lengths = frames(centres)
        noise = random.uniform(0, 0.12) * lengths[:, None] * random.standard_normal((17, 2))
        down, lengths = frames(centres + noise)
        inputs, targets = [], []
        for k in range(17):
            turn = np.radians(random.normal(0, 4))
            axis = down[k] @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
            length = lengths[k] * np.exp(random.normal(0, 0.08))
            picture = patch(x, centres[k] + noise[k], axis, length)
            picture += np.float32(random.uniform(0, 0.2)) * random.standard_normal(picture.shape, dtype=np.float32)
            inputs.append(picture[None])
            targets.append(to_patch(corners[k], centres[k] + noise[k], axis, length) * (MAP / PATCH))
        return np.array(inputs), np.array(targets, np.float32)


def expected(logits):
    """Mean position (x, y) in cells, and distribution, of each of the 4 corners."""
    share = F.softmax(logits.flatten(2), dim=2).view_as(logits)
    cells = torch.arange(MAP) + 0.5
    return torch.stack([(share.sum(dim=2) * cells).sum(dim=2), (share.sum(dim=3) * cells).sum(dim=2)], dim=2), share


def patch_loss(out, targets):
    out, targets = out.float(), targets.flatten(0, 1)
    cells = torch.arange(MAP) + 0.5
    near = lambda t: torch.exp(-((cells - t[..., None].clamp(0.5, MAP - 0.5)) ** 2) / (2 * 0.7**2))
    aim = near(targets[..., 1])[..., :, None] * near(targets[..., 0])[..., None, :]
    aim = aim / aim.sum(dim=(2, 3), keepdim=True)
    entropy = -(aim * F.log_softmax(out.flatten(2), dim=2).view_as(out)).sum(dim=(2, 3)).mean()
    distance = (expected(out)[0] - targets).abs().mean()
    return entropy + distance, (distance.item(), entropy.item())


def fit(network, data, batch, rate, loss, log, workers):
    """One cycle of the rate, in bf16 where the processor has it."""
    optimiser = torch.optim.AdamW(network.parameters(), lr=rate, weight_decay=0.01)
    steps = len(data) // batch
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, rate, total_steps=steps, pct_start=0.1)
    loader = torch.utils.data.DataLoader(data, batch, num_workers=workers, drop_last=True, prefetch_factor=4)
    network.train().to(memory_format=torch.channels_last)
    start, sums = time.time(), []
    for step, (x, *targets) in enumerate(loader):
        x = x.flatten(0, 1) if x.dim() == 5 else x
        x = x.contiguous(memory_format=torch.channels_last)
        with torch.autocast("cpu", torch.bfloat16):
            out = network(x)
        value, parts = loss(out, *targets)
        optimiser.zero_grad()
        value.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        optimiser.step()
        schedule.step()
        sums.append([value.item(), *parts])
        if (step + 1) % 25 == 0:
            print(log, step + 1, steps, np.mean(sums, axis=0).round(3), f"{time.time() - start:.0f} s", flush=True)
            sums = []


STAGES = {
    "film": [(1500, 3e-3, 21), (1900, 2e-3, 22), (550, 1.5e-3, 23), (900, 1.5e-3, 24)],
    "patch": [(800, 3e-3, 21), (1400, 2e-3, 22), (900, 1.5e-3, 23)],
}
"""Steps, largest rate and seed of each stage. A stage goes on from the weights of the one before."""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("data")
    parser.add_argument("--out", required=True, type=Path)
    parser.add_argument("--network", choices=["film", "patch", "both"], default="both")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1, help="more than one wastes time on a busy machine")
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    options.out.mkdir(parents=True, exist_ok=True)
    films = read_films(options.data, parts=("train",))
    for name, plan, kind, batch, loss in (
        ("film", film_plan, Canvases, 8, film_loss),
        ("patch", patch_plan, Patches, 4, patch_loss),
    ):
        if options.network not in (name, "both"):
            continue
        torch.manual_seed(STAGES[name][0][2])
        network = Network(plan())
        for steps, rate, seed in STAGES[name]:
            fit(network, kind(films, seed, steps * batch), batch, rate, loss, name, options.workers)
            torch.save(network.state_dict(), options.out / f"{name}.pt")


if __name__ == "__main__":
    main()
