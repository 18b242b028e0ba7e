"""The two networks as lists of plain layers. The same lists are exported, so that a port interprets them line by line.

A layer is (name, kind, inputs, channels in, channels out, kernel, stride, relu). Kinds: conv (zero padding of kernel // 2),
pool (largest of 2 x 2), up (every value twice in x and y), add (sum of two inputs).
"""

import torch
from torch import nn
from torch.nn import functional as F


class Plan(list):
    """Builds a list of layers."""

    def conv(self, name, source, inputs, outputs, kernel=3, stride=1, relu=True):
        self.append((name, "conv", [source], inputs, outputs, kernel, stride, relu))
        return name

    def add(self, name, first, second, channels, relu=False):
        self.append((name, "add", [first, second], channels, channels, 0, 1, relu))
        return name

    def plain(self, name, kind, source, channels):
        self.append((name, kind, [source], channels, channels, 2, 2, False))
        return name

    def block(self, name, source, inputs, outputs):
        """A convolution and a second one whose result is added to the first one's."""
        first = self.conv(f"{name}a", source, inputs, outputs)
        second = self.conv(f"{name}b", first, outputs, outputs, relu=False)
        return self.add(f"{name}c", first, second, outputs, relu=True)

    def down(self, name, source, inputs, outputs):
        return self.block(name, self.plain(f"{name}p", "pool", source, inputs), inputs, outputs)

    def merge(self, name, deep, deep_channels, side, channels, outputs):
        """The deep map at twice its size plus the map of that size, then a convolution."""
        narrow = self.conv(f"{name}n", deep, deep_channels, channels, kernel=1, relu=False)
        wide = self.plain(f"{name}u", "up", narrow, channels)
        return self.conv(f"{name}m", self.add(f"{name}s", wide, side, channels, relu=True), channels, outputs)


CENTRE, CORNERS, LEVEL = slice(0, 1), slice(1, 9), slice(9, 26)
"""Channels of the first network's output: logit of a centre; offsets of 4 corners in units of 16 coarse pixels; logits of 17 levels."""


def film_plan():
    """384 x 192 film to 96 x 48 map of 26 channels."""
    p = Plan()
    x = p.conv("f1", "film", 1, 16, stride=2)
    x = p.conv("f2", x, 16, 32, stride=2)
    a = p.block("fa", x, 32, 32)
    b = p.down("fb", a, 32, 64)
    c = p.down("fc", b, 64, 128)
    d = p.down("fd", c, 128, 160)
    e = p.down("fe", d, 160, 160)
    x = p.merge("fh", e, 160, d, 160, 160)
    x = p.merge("fi", x, 160, c, 128, 128)
    x = p.merge("fj", x, 128, b, 64, 64)
    x = p.merge("fk", x, 64, a, 32, 64)
    p.conv("fout", x, 64, 26, kernel=1, relu=False)
    return p


def patch_plan():
    """64 x 64 patch to 32 x 32 map of 4 channels: logits of the corners."""
    p = Plan()
    x = p.conv("p1", "patch", 1, 16)
    a = p.conv("p2", x, 16, 32, stride=2)
    b = p.down("pb", a, 32, 48)
    c = p.down("pc", b, 48, 80)
    d = p.down("pd", c, 80, 128)
    x = p.merge("pi", d, 128, c, 80, 80)
    x = p.merge("pj", x, 80, b, 48, 48)
    x = p.merge("pk", x, 48, a, 32, 48)
    p.conv("pout", x, 48, 4, kernel=1, relu=False)
    return p


class Network(nn.Module):
    """A plan with weights. Every convolution but the last has a normalisation that export.py folds into it."""

    def __init__(self, plan):
        super().__init__()
        self.plan = plan
        self.convs, self.norms = nn.ModuleDict(), nn.ModuleDict()
        for name, kind, _, inputs, outputs, kernel, stride, _ in plan:
            if kind == "conv":
                last = name.endswith("out")
                self.convs[name] = nn.Conv2d(inputs, outputs, kernel, stride, kernel // 2, bias=last)
                if not last:
                    self.norms[name] = nn.BatchNorm2d(outputs)

    def forward(self, x):
        values = {self.plan[0][2][0]: x}
        for name, kind, sources, _, _, _, _, relu in self.plan:
            x = values[sources[0]]
            if kind == "conv":
                x = self.convs[name](x)
                x = self.norms[name](x) if name in self.norms else x
            elif kind == "pool":
                x = F.max_pool2d(x, 2)
            elif kind == "up":
                x = F.interpolate(x, scale_factor=2, mode="nearest")
            else:
                x = x + values[sources[1]]
            values[name] = torch.relu(x) if relu else x
        return values[self.plan[-1][0]]


def cost(plan, height, width):
    """Parameters, and multiplications per run."""
    sizes, parameters, work = {plan[0][2][0]: (height, width)}, 0, 0
    for name, kind, sources, inputs, outputs, kernel, stride, _ in plan:
        h, w = sizes[sources[0]]
        if kind in ("conv", "pool"):
            h, w = -(-h // stride), -(-w // stride)
        elif kind == "up":
            h, w = 2 * h, 2 * w
        if kind == "conv":
            parameters += outputs * (inputs * kernel**2 + 1)
            work += h * w * outputs * inputs * kernel**2
        sizes[name] = (h, w)
    return parameters, work
