"""Learns the shape of erect spines and writes the table that the library contains.

    python training/shape/train.py path/to/aasce

Needs numpy. The same data give the same bytes.
"""

import sys
from pathlib import Path

import shape
from landmarks import read_films

OUT = Path(__file__).resolve().parents[2] / "crates/spineline/src/measure/completion/erect_spines.txt"
HEAD = """# Shape of erect scoliotic spines on frontal X-rays: {films} films of {patients} patients, with their mirror images.
# Learned by training/shape/train.py from landmarks of AASCE 2019 [wu-boostnet-2017]; model card: training/shape/README.md.
# A line: name, mean, and covariances with the names before it and with itself. Angles in rad, lengths as logarithms."""


def rows(names, mean, covariance):
    for index, name in enumerate(names):
        values = [mean[index], *covariance[index, : index + 1]]
        yield " ".join([name, *(f"{value:.4g}" for value in values)])


def main():
    films = read_films(sys.argv[1])
    mean, angles, lengths = shape.learn(films)
    head = HEAD.format(films=len(films), patients=len({film.patient for film in films}))
    lines = [
        head,
        *rows(shape.ANGLES, [0.0] * len(shape.ANGLES), angles),
        *rows(shape.LENGTHS, mean, lengths),
    ]
    OUT.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{len(films)} films: {OUT.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
