"""Stores beside foreign logs, and killed backups and restorations: no store is destroyed or blocked."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

from kills import Server, begun, click
from program import parts, run, temporary

# Commands that open a store; one that refuses must not change a file.
OPENINGS = (
    ["study", "list", "STORE"],
    ["study", "verify", "STORE"],
    ["study", "add", "STORE", "FILMS"],
    ["study", "backup", "STORE", "other.spineline"],
    ["serve", "STORE", "--port", "0"],
)


def attack(program: Path, samples: Path, kills: int, seed: int) -> Iterator[str]:
    """Faults over all foreign logs, and over `kills` kills of each copying command."""
    rng = random.Random(f"{seed} restores")
    with temporary() as place:
        folder = Path(place)
        films = samples / "films" / "phantom-rod-01.json"
        for words in (["create", "s.spineline"], ["add", "s.spineline", str(films)], ["backup", "s.spineline", "b.spineline"]):
            end = run(program, ["study", *words], folder)
            if end.code:
                yield f"no store: {end.errors}"
                return
        marked(program, folder / "s.spineline", rng)
        yield from foreign_logs(program, folder, films)
        yield from killed_copies(program, folder, kills, rng)


def marked(program: Path, store: Path, rng: random.Random) -> None:
    """Clicks of a server that is killed at once, so that only the log beside the store has them."""
    server = Server(program, store)
    reading, places, revision = begun(server)
    for _ in range(20):
        event = click(rng, places)
        body = {"expected_revision": revision, "events": [event]}
        preview, _ = server.answer("POST", f"/api/readings/{reading}/events", body)
        revision = preview["reading"]["revision"]
        places[event["level"], event["corner"]] = [event["column_px"], event["row_px"]]
    server.kill()


def foreign_logs(program: Path, folder: Path, films: Path) -> Iterator[str]:
    """Stores beside a log of another store, of a later version, or a file that is not a log."""
    log = (folder / "s.spineline-wal").read_bytes()
    run(program, ["study", "create", "new.spineline"], folder)
    torn = bytearray(log)
    torn[len(log) // 3] ^= 0x55
    count = 0
    for name, main, beside in (
        ("backup", "b.spineline", log),
        ("another store", "new.spineline", log),
        ("a torn log", "s.spineline", bytes(torn)),
        ("no log", "b.spineline", b"\xa5" * 40_000),
    ):
        for words in OPENINGS:
            with temporary() as place:
                store = Path(place) / "x.spineline"
                shutil.copy(folder / main, store)
                (store.parent / "x.spineline-wal").write_bytes(beside)
                before = files(store)
                end = run(program, [{"STORE": store.name, "FILMS": str(films)}.get(w, w) for w in words], store.parent)
                count += 1
                yield from end.faults()
                if end.code != 3 or "x.spineline-wal" not in end.errors:
                    yield f"{name}: {' '.join(words)} ended with {end.code} and does not name the log"
                if files(store) != before:
                    yield f"{name}: {' '.join(words)} changed the store or the log"
    print(f"{count:4} stores beside foreign logs, refused and unchanged unless listed below")


def killed_copies(program: Path, folder: Path, kills: int, rng: random.Random) -> Iterator[str]:
    """Killed backups and restorations: a whole store has the name, and the next command succeeds."""
    states = {head(program, folder, "s.spineline"), head(program, folder, "b.spineline")}
    cut = 0
    for number in range(kills):
        with temporary() as place:
            here = Path(place)
            for end in ("", "-wal", "-head"):
                shutil.copy(folder / f"s.spineline{end}", here / f"s.spineline{end}")
            shutil.copy(folder / "b.spineline", here / "b.spineline")
            for words in (["study", "backup", "s.spineline", "c.spineline"], ["study", "restore", "b.spineline", "s.spineline"]):
                child = subprocess.Popen([program, *words], cwd=here, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                time.sleep(rng.uniform(0.0, 0.3))
                os.kill(child.pid, signal.SIGKILL)
                cut += child.wait() != 0
                if head(program, here, "s.spineline") not in states:
                    yield f"kill {number} of {words[1]}: the store is not the earlier one, and not the backup"
                again = run(program, words, here)
                exists = words[1] == "backup" and again.code == 3 and head(program, here, "c.spineline") in states
                if again.code and not exists:
                    yield f"kill {number}: the next {words[1]} ended with {again.code}: {again.errors}"
            if left := parts(here):
                yield f"kill {number}: left {left}"
    print(f"{2 * kills:4} backups and restorations, {cut} of them killed; the next ones succeeded unless listed below")


def files(store: Path) -> list[bytes]:
    """The store and the log beside it."""
    return [store.read_bytes(), Path(f"{store}-wal").read_bytes()]


def head(program: Path, folder: Path, store: str) -> str | None:
    """The last hash of the log of a valid store."""
    end = run(program, ["study", "verify", store], folder)
    words = [word for word in end.output.split() if len(word) > 64]
    return words[0] if end.code == 0 and words else None
