"""Attacks the program: damaged files, bombs, full disks, interruptions and kills. Every run must end as the guide says.

Usage: python attack.py --program path/to/spineline --seeds path/to/seeds --out folder
           [--copies 500] [--kills 40] [--interruptions 3] [--seed 1]
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import bombs
import clocks
import crowds
import disks
import kills
import mutations
import restores
import signals
from program import run
from small import write_small

LOAD = """{"format": "spineline-load", "version": 1, "loads": [{"kind": "force_on_line", "level": "T2", "force": [0, 10, 0], "point_mm": [0, 0, 300]}]}"""
READINGS = "\n".join(
    ["quantity,unit,subject,observer,repeat,value,synthetic"]
    + [f"tilt_T6,deg,P{s},{o},{r},{s + r / 10},true" for s in range(1, 6) for o in "AB" for r in (1, 2)]
)


def main() -> int:
    """0 if every run ended as expected, else 1."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="the spineline program")
    parser.add_argument("--seeds", type=Path, required=True, help="the program that writes the seeds of the fuzz targets")
    parser.add_argument("--out", type=Path, required=True, help="folder for samples")
    parser.add_argument("--copies", type=int, default=500, help="damaged copies of each kind")
    parser.add_argument("--kills", type=int, default=40, help="kills of the server")
    parser.add_argument("--interruptions", type=int, default=3, help="interruptions of each command")
    parser.add_argument("--seed", type=int, default=1, help="seed of all that is random")
    options = parser.parse_args()
    program, samples = options.program.resolve(), (options.out / "samples").resolve()
    make_samples(program, options.seeds.resolve(), samples)
    attacks = (
        mutations.attack(program, samples, options.copies, options.seed),
        bombs.attack(program),
        disks.attack(program, samples),
        signals.attack(program, samples, options.interruptions, options.seed),
        kills.attack(program, samples, options.kills, options.seed),
        clocks.attack(program, samples),
        crowds.attack(program, samples, options.seed),
        restores.attack(program, samples, options.kills, options.seed),
    )
    faults = []
    for attack in attacks:
        start = time.monotonic()
        faults.extend(attack)
        print(f"     {time.monotonic() - start:.0f} s", flush=True)
    for fault in faults:
        print(f"FAULT {fault}")
    print(f"attack: {len(faults)} faults")
    return 1 if faults else 0


def make_samples(program: Path, seeds: Path, samples: Path) -> None:
    """A valid file of every kind."""
    shutil.rmtree(samples, ignore_errors=True)
    samples.mkdir(parents=True)

    def make(*words: str) -> str:
        end = run(program, list(words), samples)
        if end.code:
            raise SystemExit(f"{' '.join(words)}: {end.code}\n{end.errors}")
        return end.output

    subprocess.run([seeds, samples / "seeds"], check=True)
    make("phantom", "--scenario", "rod", "--subject", "1", "--films", "--film-encoding", "jpeg-ls", "--out", "films")
    shutil.copy(samples / "films" / "phantom-rod-01-erect.dcm", samples / "jpeg-ls.dcm")
    make("phantom", "--scenario", "rod", "--subject", "1", "--out", "case")
    (samples / "case" / "phantom-rod-01.json").rename(samples / "case.json")
    make("analyze", "case.json", "--json", "analysis.json", "--model", "model.json")
    make("report", "case.json", "--out", "report.html")
    (samples / "stiffness.csv").write_text(make("stiffness"))
    (samples / "readings.csv").write_text(READINGS)
    (samples / "load.json").write_text(LOAD)
    write_small(samples / "case.json", samples / "landmarks")
    for name in ("csv", "slicer", "labelme", "coco"):
        one = ("--posture", "erect") if name in ("slicer", "labelme") else ()
        make("export", "landmarks/case.json", "--to", name, *one, "--out", f"landmarks/{name}")
    make("study", "create", "study.spineline")
    film = ("--film", "erect=1", "--patient-left", "image-left")
    make("import", "seeds/film/rle", "--case-id", "P07", "--out", "small", *film)
    make("study", "add", "study.spineline", "small/case.json")
    with zipfile.ZipFile(samples / "films.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(samples / "seeds" / "film" / "rle", "erect.dcm")


if __name__ == "__main__":
    sys.exit(main())
