"""Runs exported networks in f32, layer by layer as landmarks.txt lists them."""

from pathlib import Path

import numpy as np
import torch
from torch.nn import functional as F


class Kernel:
    def __init__(self, folder):
        folder = Path(folder)
        self.values = np.fromfile(folder / "landmarks.bin", dtype="<f2").astype(np.float32)
        lines = (folder / "landmarks.txt").read_text(encoding="utf-8").splitlines()
        self.layers = [line.split() for line in lines if not line.startswith("#")]

    def run(self, which, x):
        """`x`: pictures x 1 x rows x columns. Returns pictures x channels x rows x columns."""
        with torch.inference_mode():
            maps = {which: torch.from_numpy(np.ascontiguousarray(x, np.float32))}
            for network, name, kind, sources, *numbers in self.layers:
                if network != which:
                    continue
                inputs, outputs, size, stride, relu, offset, count = map(int, numbers)
                sources = sources.split(",")
                y = maps[sources[0]]
                if kind == "conv":
                    values = torch.from_numpy(self.values[offset : offset + count])
                    weights = values[:-outputs].view(outputs, inputs, size, size)
                    y = F.conv2d(y, weights, values[-outputs:], stride, size // 2)
                elif kind == "pool":
                    y = F.max_pool2d(y, 2)
                elif kind == "up":
                    y = F.interpolate(y, scale_factor=2, mode="nearest")
                else:
                    y = y + maps[sources[1]]
                maps[name] = torch.relu(y) if relu else y
            return maps[name if network == which else self.last(which)].numpy()

    def last(self, which):
        return [layer[1] for layer in self.layers if layer[0] == which][-1]
