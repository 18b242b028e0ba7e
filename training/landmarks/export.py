"""Writes the trained networks as one binary file of f16 values and a text file that lists the layers.

    python training/landmarks/export.py DIR
"""

import sys
from pathlib import Path

import numpy as np
import torch
from network import Network, film_plan, patch_plan

OUT = Path(__file__).resolve().parents[2] / "crates/spineline-weights/data"
HEAD = """# Weights of the landmark networks: layers in order. Made by training/landmarks/export.py; model card: README.md.
# A line: network, layer, kind, inputs, channels in, channels out, kernel, stride, relu after it, offset, count.
# offset and count: values in landmarks.bin (f16, little-endian): weights [out][in][row][column], then a bias per channel out.
# conv: zero padding of kernel/2, output i at input i x stride. pool: largest of 2 x 2. up: each value twice in x and y. add: sum of both inputs.
"""


def folded(network, name):
    """Weights and bias of a convolution with its normalisation."""
    conv = network.convs[name]
    weights = conv.weight.detach().double()
    if name not in network.norms:
        return weights, conv.bias.detach().double()
    norm = network.norms[name]
    gain = norm.weight.detach().double() / torch.sqrt(norm.running_var.double() + norm.eps)
    return weights * gain[:, None, None, None], norm.bias.detach().double() - norm.running_mean.double() * gain


def main():
    folder = Path(sys.argv[1])
    out = Path(sys.argv[2]) if len(sys.argv) > 2 else OUT
    out.mkdir(parents=True, exist_ok=True)
    values, lines = [], []
    for which, plan in (("film", film_plan()), ("patch", patch_plan())):
        network = Network(plan)
        network.load_state_dict(torch.load(folder / f"{which}.pt"))
        for name, kind, sources, inputs, outputs, kernel, stride, relu in plan:
            offset = sum(part.size for part in values)
            if kind == "conv":
                weights, bias = folded(network, name)
                values += [weights.numpy().astype("<f2").ravel(), bias.numpy().astype("<f2").ravel()]
            count = sum(part.size for part in values) - offset
            fields = [which, name, kind, ",".join(sources), inputs, outputs, kernel, stride, int(relu), offset, count]
            lines.append(" ".join(str(field) for field in fields))
    binary = np.concatenate(values)
    if not np.isfinite(binary).all():
        raise SystemExit("A weight is beyond f16.")
    (out / "landmarks.bin").write_bytes(binary.tobytes())
    (out / "landmarks.txt").write_text(HEAD + "\n".join(lines) + "\n", encoding="utf-8")
    print(f"{binary.size} values, {binary.nbytes / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
