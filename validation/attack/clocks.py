"""Wrong clocks: before 1970, far ahead, and corrected in the middle of a plan."""

from __future__ import annotations

import datetime
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

from kills import Server
from program import run, temporary

# Gives a program another time of day; all other clocks stay.
SHIM = """
#define _GNU_SOURCE
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>
int clock_gettime(clockid_t clock, struct timespec *now) {
    int failed = syscall(SYS_clock_gettime, clock, now);
    if (clock == CLOCK_REALTIME) now->tv_sec += atoll(getenv("ATTACK_CLOCK_S"));
    return failed;
}
"""
YEARS = (1900, 1968, 1971, 2046, 9999, 12000)
OBSERVER = "attacker"


def attack(program: Path, samples: Path) -> Iterator[str]:
    """Faults of commands and of the server under each clock, and of a plan with a corrected clock."""
    if not shutil.which("cc"):
        print("   0 clocks: the C compiler `cc` is missing")
        return
    with temporary() as place:
        source = Path(place) / "clock.c"
        source.write_text(SHIM)
        shim = source.with_suffix(".so")
        subprocess.run(["cc", "-shared", "-fPIC", "-o", shim, source], check=True)
        for year in YEARS:
            yield from commands(program, samples, Path(place) / str(year), shim, year)
        yield from plan(program, samples, Path(place) / "plan", clock(shim, datetime.date.today().year + 20))
    print(f"{len(YEARS):4} clocks, and a plan that was read in the future")


def clock(shim: Path, year: int) -> dict[str, str]:
    """Environment in which a program sees this year."""
    days = 365.2425 * (year - datetime.date.today().year)
    return {"LD_PRELOAD": str(shim), "ATTACK_CLOCK_S": str(round(86_400 * days))}


def commands(program: Path, samples: Path, folder: Path, shim: Path, year: int) -> Iterator[str]:
    """Commands that write or read a time; the server refuses years without an HTTP date."""
    when = clock(shim, year)
    folder.mkdir()
    case = str(samples / "case.json")
    for words in (
        ["study", "create", "s.spineline"],
        ["study", "add", "s.spineline", str(samples / "small" / "case.json")],
        ["study", "plan", "s.spineline", "P07", "--observers", "A,B", "--repeats", "2"],
        ["study", "next", "s.spineline", "P07", "--observer", "A"],
        ["study", "log", "s.spineline"],
        ["study", "verify", "s.spineline"],
        ["study", "backup", "s.spineline", "backup.spineline"],
        ["analyze", case, "--json", "analysis.json", "--tables", "tables"],
        ["report", case, "--out", "report.html"],
    ):
        end = run(program, words, folder, environment=when)
        yield from (f"{fault} (clock {when['ATTACK_CLOCK_S']} s): {end.errors[:200]}" for fault in end.faults())
        if end.code and words[0] == "study":
            yield f"{' '.join(words)} ended with {end.code} (clock {when['ATTACK_CLOCK_S']} s): {end.errors[:200]}"
    if not 1970 <= year <= 9999:
        end = run(program, ["serve", "s.spineline", "--port", "0"], folder, environment=when)
        yield from end.faults()
        if not end.code:
            yield f"serve started in {year}"
        return
    server = Server(program, folder / "s.spineline", environment=when)
    for path in ("/api/session", "/api/studies", "/api/studies/P07"):
        server.answer("GET", path)
    server.kill()
    if "panicked" in "".join(server.errors):
        yield f"serve panicked (clock {when['ATTACK_CLOCK_S']} s): {''.join(server.errors)[:300]}"


def plan(program: Path, samples: Path, folder: Path, ahead: dict[str, str]) -> Iterator[str]:
    """Readings by a clock that is ahead lock the plan until a release; sessions of the future are refused."""
    folder.mkdir()
    store = folder / "s.spineline"
    release = ["study", "release", store.name, "P07", "--by", "lead"]
    for words in (
        ["study", "create", store.name],
        ["study", "add", store.name, str(samples / "small" / "case.json")],
        ["study", "plan", store.name, "P07", "--observers", OBSERVER, "--repeats", "2"],
    ):
        if (end := run(program, words, folder)).code:
            yield f"{' '.join(words)}: {end.errors}"
            return
    if not run(program, release, folder).code:
        yield "a plan without readings was released"
    early = Server(program, store, environment=ahead)
    read_next(early)
    early.kill()
    server = Server(program, store, port=early.port)
    fresh, server.headers = server.headers, early.headers
    try:
        server.answer("GET", "/api/session")
        yield "a session of the future is still valid"
    except RuntimeError as refused:
        if " 401 " not in str(refused):
            yield f"a session of the future: {refused}"
    server.headers = fresh
    if (found := step(server)["kind"]) != "wait":
        yield f"the next film after a reading in the future: {found}"
    released = run(program, release, folder)
    log = run(program, ["study", "log", store.name], folder).output
    if released.code or " release " not in log or "lead" not in log:
        yield f"release ended with {released.code}: {released.errors}"
    else:
        read_next(server)
        if "reveal_" not in run(program, ["study", "log", store.name], folder).output:
            yield "the log of a complete plan does not show its secret"
    server.kill()


def step(server: Server) -> dict[str, object]:
    """The observer's next step."""
    study, _ = server.answer("GET", "/api/studies/P07")
    return study["plan"]["next"]


def read_next(server: Server) -> None:
    """Reads the next film: one vertebra in the middle of the picture."""
    view, _ = server.answer("POST", f"/api/codes/{step(server)['code']}/readings")
    image, path = view["image"], f"/api/readings/{view['reading']}"
    left = -1 if image["patient_left"] == "image_left" else 1
    events = [
        {
            "kind": "place_corner",
            "level": "L4",
            "corner": f"{end}_{side}",
            "column_px": image["columns"] * (0.5 + 0.1 * across),
            "row_px": image["rows"] * (0.5 + 0.03 * down),
        }
        for end, down in (("superior", -1), ("inferior", 1))
        for side, across in (("left", left), ("right", -left))
    ]
    server.answer("POST", f"{path}/events", {"expected_revision": 0, "events": events})
    server.answer("POST", f"{path}/finish", {"expected_revision": len(events)})
