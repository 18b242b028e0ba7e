"""Ctrl-C at random times in every command: a documented code, whole files."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from pathlib import Path

from disks import outputs
from program import parts, run, temporary

# Before any result, after a part of the replicates, or after the command ended.
CODES = {0, 4, 130}


def attack(program: Path, samples: Path, times: int, seed: int) -> Iterator[str]:
    """Faults over all commands, each interrupted several times within its duration."""
    rng = random.Random(f"{seed} signals")
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
                # Most commands take 0.1 s; the long ones are stopped within their first seconds.
                delay = rng.uniform(0.0, 3.0 if (kind, command) in long else 0.3)
                end = run(program, words, folder, interrupt_after_s=delay)
                end.left = parts(folder)
                count += 1
                codes[end.code] = codes.get(end.code, 0) + 1
                yield from (f"{fault} (Ctrl-C after {delay:.3f} s)" for fault in end.faults())
                if end.code not in CODES:
                    yield f"{' '.join(words)}: ended with {end.code} after Ctrl-C at {delay:.3f} s"
                if end.code == 130 and target.exists():
                    yield f"{' '.join(words)}: after Ctrl-C at {delay:.3f} s it says that nothing was written, but a file was"
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
