"""Disks that are full at every output of every command: the target is whole, as it was, or absent."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from program import parts, run, temporary

# Largest file in bytes: zero, a part of a page, a page, and less than the larger outputs.
LIMITS = (0, 100, 4096, 40_000)


def outputs(samples: Path) -> list[tuple[str, list[str]]]:
    """Commands with one output each; OUT stands for it."""
    case, model, analysis = (str(samples / f"{name}.json") for name in ("case", "model", "analysis"))
    with_films = str(samples / "films" / "phantom-rod-01.json")
    return [
        ("json", ["analyze", case, "--json", "OUT"]),
        ("csv", ["analyze", case, "--csv", "OUT"]),
        ("csv", ["analyze", case, "--chain", "OUT"]),
        ("csv", ["analyze", case, "--cohort", "OUT"]),
        ("json", ["analyze", case, "--model", "OUT"]),
        ("folder", ["analyze", case, "--figures", "OUT"]),
        ("folder", ["analyze", case, "--tables", "OUT"]),
        ("folder", ["analyze", case, "--tables", "OUT", "--tables-format", "parquet"]),
        ("html", ["report", case, "--out", "OUT"]),
        ("md", ["report", case, "--to", "md", "--out", "OUT"]),
        ("folder", ["report", case, "--out", str(Path("report.html")), "--figures", "OUT"]),
        ("json", ["rerun", analysis, "--json", "OUT"]),
        ("folder", ["rerun", analysis, "--figures", "OUT"]),
        ("json", ["simulate", model, "--push", "left", "--force", "10", "--json", "OUT"]),
        ("csv", ["simulate", model, "--push", "left", "--force", "10", "--csv", "OUT"]),
        ("svg", ["simulate", model, "--push", "left", "--force", "10", "--svg", "OUT"]),
        ("xml", ["export", model, "--to", "mjcf", "--out", "OUT"]),
        ("osim", ["export", model, "--to", "osim", "--out", "OUT"]),
        ("urdf", ["export", model, "--to", "urdf", "--out", "OUT"]),
        ("csv", ["export", case, "--to", "csv", "--out", "OUT"]),
        ("json", ["export", case, "--to", "slicer", "--posture", "erect", "--out", "OUT"]),
        ("folder", ["export", with_films, "--to", "dicom-sr", "--out", "OUT"]),
        ("json", ["reliability", str(samples / "readings.csv"), "--json", "OUT"]),
        ("csv", ["reliability", str(samples / "readings.csv"), "--csv", "OUT"]),
        ("folder", ["reliability", str(samples / "readings.csv"), "--figures", "OUT"]),
        ("folder", ["phantom", "--scenario", "rod", "--subject", "1", "--out", "OUT"]),
        ("folder", ["phantom", "--scenario", "rod", "--subject", "1", "--films", "--out", "OUT"]),
        ("png", ["film", str(samples / "jpeg-ls.dcm"), "--png", "OUT"]),
        ("spineline", ["study", "create", "OUT"]),
        ("spineline", ["study", "backup", str(samples / "study.spineline"), "OUT"]),
    ]


def attack(program: Path, samples: Path) -> Iterator[str]:
    """Faults over all outputs and limits."""
    count = refused = 0
    for kind, command in outputs(samples):
        with temporary() as place:
            end = run(program, [f"out.{kind}" if word == "OUT" else word for word in command], Path(place))
            if end.code:
                yield f"{' '.join(command)}: refused with {end.code} on a disk with room: {end.errors.strip()}"
        for limit in LIMITS:
            with temporary() as place:
                folder = Path(place)
                target = folder / f"out.{kind}" if kind != "folder" else folder / "out"
                words = [target.name if word == "OUT" else word for word in command]
                end = run(program, words, folder, largest_file=limit)
                end.left = parts(folder)
                count += 1
                refused += end.code == 3
                yield from (f"{fault} (files of {limit} bytes at most)" for fault in end.faults())
                if end.code not in (0, 3):
                    yield f"{' '.join(words)}: ended with {end.code} on a disk that takes {limit} bytes"
                if end.code == 3 and target.exists():
                    yield f"{' '.join(words)}: left a torn target on a disk that takes {limit} bytes"
    print(f"{count:4} outputs on full disks, {refused} of them refused, all others were small enough")
