"""Ctrl-C at random times in every command: a documented code, nothing torn."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from pathlib import Path

from disks import outputs
from program import parts, run, temporary

# Before any result, or after a part of the replicates; or the command was quicker.
CODES = {0, 4, 130}


def attack(program: Path, samples: Path, times: int, seed: int) -> Iterator[str]:
    """Faults over all commands, each interrupted so many times within its own duration."""
    dice = random.Random(f"{seed} signals")
    case = str(samples / "case.json")
    long = [
        ("json", ["analyze", case, "--replicates", "2000", "--json", "OUT"]),
        ("html", ["report", case, "--replicates", "2000", "--out", "OUT"]),
        ("folder", ["reproduce", "--out", "OUT"]),
        ("folder", ["noise-study", "--phantoms", "6", "--out", "OUT"]),
    ]
    count, codes = 0, {}
    for kind, command in [*long, *outputs(samples)]:
        for _ in range(times):
            with temporary() as place:
                folder = Path(place)
                target = folder / f"out.{kind}" if kind != "folder" else folder / "out"
                words = [target.name if word == "OUT" else word for word in command]
                # Most commands take a tenth of a second; the long ones are stopped within their first seconds.
                delay = dice.uniform(0.0, 3.0 if (kind, command) in long else 0.3)
                end = run(program, words, folder, interrupt_after_s=delay)
                end.left = parts(folder)
                count += 1
                codes[end.code] = codes.get(end.code, 0) + 1
                yield from (f"{fault} (Ctrl-C after {delay:.3f} s)" for fault in end.faults())
                if end.code not in CODES:
                    yield f"{' '.join(words)}: ended with {end.code} after Ctrl-C at {delay:.3f} s"
                if end.code == 130 and target.exists():
                    yield f"{' '.join(words)}: says that nothing was written, after Ctrl-C at {delay:.3f} s, and something is"
                if kind == "json" and target.exists() and not is_json(target):
                    yield f"{' '.join(words)}: torn JSON after Ctrl-C at {delay:.3f} s"
    print(f"{count:4} interruptions, codes {dict(sorted(codes.items()))}")


def is_json(path: Path) -> bool:
    """Whether a file is whole."""
    try:
        json.loads(path.read_text())
    except ValueError:
        return False
    return True
