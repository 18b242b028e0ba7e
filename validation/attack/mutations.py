"""Damaged files of every kind that the program reads: each run ends with a code of the guide, without a panic, in bounded memory, and
without a control character on the terminal. Every sample is accepted before it is damaged."""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from damage import damaged
from program import Run, parts, run, temporary


# Finished, with or without convergence.
ACCEPTED = (0, 4)


@dataclass
class Kind:
    """A kind of file, and the command that reads it."""

    name: str
    seed: Path
    # The command; FILE stands for the damaged files.
    command: list[str]
    # How many files one run reads.
    batch: int = 1
    # The refusal of the valid sample after it was read; empty if it is accepted.
    known_refusal: str = ""
    results: list[Run] = field(default_factory=list)


def kinds(samples: Path) -> list[Kind]:
    """Every kind, with its sample."""
    model, case, film = samples / "model.json", samples / "case.json", samples / "seeds" / "film"
    small, landmarks = samples / "landmarks", samples / "seeds" / "landmarks"
    into = ["import", str(small / "erect.png"), "--case-id", "P07", "--out", "out", "--film", "erect=1"]
    into += ["--patient-left", "image-left", "--spacing", "erect=1,1,patient", "--landmarks", "FILE"]
    return [
        Kind("case", case, ["check", "FILE"], batch=25),
        Kind("case, analysed", case, ["analyze", "FILE", "--json", "-"]),
        Kind("analysis", samples / "analysis.json", ["rerun", "FILE"]),
        Kind("report", samples / "report.html", ["rerun", "FILE"]),
        Kind("model", model, ["simulate", "FILE", "--push", "left", "--force", "10"]),
        Kind("model, exported", model, ["export", "FILE", "--to", "mjcf", "--out", "-"]),
        Kind("load", samples / "load.json", ["simulate", str(model), "--load", "FILE"]),
        Kind("stiffness table", samples / "stiffness.csv", ["analyze", str(case), "--stiffness", "FILE"]),
        Kind("readings table", samples / "readings.csv", ["reliability", "FILE"]),
        *(Kind(f"film, {seed}", film / seed, ["film", "FILE"], batch=50) for seed in ("jpegls", "rle", "plain")),
        Kind("film, png", small / "erect.png", ["film", "FILE"], batch=50),
        *(Kind(f"landmarks, {name}", small / name, into) for name in ("csv", "slicer", "labelme", "coco")),
        # Files of other programs that no command writes. They are read, but their vertebrae do not fit this film.
        Kind("landmarks, mat", landmarks / "mat", into, known_refusal="lies outside of the"),
        Kind("landmarks, report", landmarks / "report", into, known_refusal="lies outside of the"),
        Kind("landmarks, midlines", landmarks / "midlines", ["import", "FILE", "--midlines", "--case-id", "P07", "--out", "out"]),
        Kind("store", samples / "study.spineline", ["study", "verify", "FILE"]),
        Kind("archive", samples / "films.zip", ["import", "FILE", "--list"]),
    ]


def attack(program: Path, samples: Path, copies: int, seed: int) -> Iterator[str]:
    """Faults over all kinds; prints the counts of each."""
    for kind in kinds(samples):
        yield from refusals(program, kind)
        rng = random.Random(f"{seed} {kind.name}")
        with temporary() as folder, ThreadPoolExecutor(2) as pool:
            batches = list(files(kind, Path(folder), copies, rng))
            ends = list(pool.map(lambda batch: run_on(program, kind, batch), batches))
        codes = sorted({end.code for end in ends})
        largest = max(end.resident_mb for end in ends)
        print(f"{copies:4} damaged: {kind.name:16} codes {codes}, at most {largest:.0f} MB")
        for end in ends:
            yield from end.faults()


def refusals(program: Path, kind: Kind) -> Iterator[str]:
    """A fault if the sample itself is refused: its damaged copies would test nothing."""
    with temporary() as folder:
        place = Path(folder) / "sound"
        place.mkdir()
        sample = place / f"sample{kind.seed.suffix}"
        sample.write_bytes(kind.seed.read_bytes())
        end = run_on(program, kind, [sample])
    yield from end.faults()
    is_read = end.code in ACCEPTED if not kind.known_refusal else kind.known_refusal in end.errors
    if not is_read:
        yield f"{kind.name}: the sample is refused with {end.code}: {end.errors.strip()}"


def files(kind: Kind, folder: Path, copies: int, rng: random.Random) -> Iterator[list[Path]]:
    """Folders of damaged copies, one per run."""
    data = kind.seed.read_bytes()
    for start in range(0, copies, kind.batch):
        place = folder / f"{start:04}"
        place.mkdir()
        batch = []
        for number in range(start, min(copies, start + kind.batch)):
            path = place / f"{number:04}{kind.seed.suffix}"
            path.write_bytes(damaged(data, rng))
            batch.append(path)
        yield batch


def run_on(program: Path, kind: Kind, batch: list[Path]) -> Run:
    """One run over a batch, which is removed after it."""
    words: list[str] = []
    for word in kind.command:
        words.extend([path.name for path in batch] if word == "FILE" else [word])
    folder = batch[0].parent
    end = run(program, words, folder)
    end.left = parts(folder)
    shutil.rmtree(folder)
    return end
