"""Learns the shape of erect spines and writes their table.

    python training/shape/train.py path/to/aasce
    python training/shape/train.py path/to/aasce --split train --out FILE

The second form leaves out the validation and test patients of training/landmarks/split.py, so that the shape can be judged on
them. Needs numpy. The same data give the same bytes.
"""

import argparse
from pathlib import Path

import shape
from landmarks import read_films
from split import part_of

OUT = Path(__file__).resolve().parents[2] / "crates/spineline-weights/data/erect_spines.txt"
HEAD = """# Shape of erect scoliotic spines on frontal X-rays: {films} films of at least {patients} patients, with their mirror images.
# The licence of the data is known second-hand only: see the model card before this table is published.
# Learned by training/shape/train.py from landmarks of AASCE 2019 [wu-boostnet-2017]; model card: README.md.
# A line: name, mean, and covariances with the names before it and with itself. Angles in rad, lengths as logarithms."""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("data")
    parser.add_argument("--split", choices=["all", "train"], default="all")
    parser.add_argument("--out", type=Path, help="file to write; needed with --split train")
    options = parser.parse_args()
    films = read_films(options.data)
    if options.split == "train":
        if options.out is None:
            parser.error("--split train needs --out FILE: the library's table is of all films")
        films = [film for film in films if part_of(film.name) == "train"]
    out = options.out or OUT
    head = HEAD.format(films=len(films), patients=len({film.patient for film in films}))
    out.write_text("\n".join([head, *shape.table(films)]) + "\n", encoding="utf-8")
    print(f"{len(films)} films: {out.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
