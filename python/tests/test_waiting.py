"""Long calls: Ctrl-C ends them, and other threads run meanwhile."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import spineline as sl


PROGRAM = """
import json
import os
import signal
import threading
import time
from pathlib import Path

import spineline as sl

def working():
    return [name for name in Path("/proc/self/task").glob("*/comm") if name.read_text() == "spineline\\n"]

def moved(one, k):
    # Equal readings would count as one.
    def place(mark):
        return [mark[0] + k / 40, mark[1]] if isinstance(mark, list) else mark

    marks = {{level: {{key: place(mark) for key, mark in body.items()}} for level, body in one["vertebrae"].items()}}
    return one | {{"repeat": one["repeat"] + 3 * k, "vertebrae": marks}}

case = sl.phantom()
data = json.loads(case.to_json())
for film in data["films"]:
    readings = film["readings"]
    film["readings"] = [moved(one, k) for k in range(500) for one in readings]
read_often = sl.Case.from_json(json.dumps(data))
a = sl.analyze(case)
compared = sl.analyze(case, compare_models="all")
at = []

def interrupt():
    at.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)

threading.Timer(0.3, interrupt).start()
try:
    {call}
    print("not interrupted")
except KeyboardInterrupt:
    print(time.monotonic() - at[0], flush=True)
print(sl.analyze(case) == a, flush=True)
while working():
    time.sleep(0.1)
"""
"""Interrupts a running call, prints after how many seconds it ended, analyses again, and waits for the threads of the library."""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="names of threads")
@pytest.mark.parametrize(
    "call",
    [
        "sl.replicates(a, n=1_000_000)",
        # Steps take seconds: the exception does not wait for them.
        "sl.replicates(compared, n=1_000_000)",
        "sl.analyze(case, compare_models='all')",
        "sl.analyze(case, compare_models='all', multipliers='per-joint', identifiability=True)",
        "read_often.check()",
    ],
)
def test_ctrl_c_ends_a_long_call_within_a_second(call: str) -> None:
    program = PROGRAM.format(call=call)
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
    seconds, is_equal = ended.stdout.split()
    assert float(seconds) < 1.0 and is_equal == "True", ended.stderr
    assert ended.returncode == 0


def ticks_beside(call: Callable[[], object]) -> int:
    """How often another thread wakes up during a call, about once per millisecond."""
    ticks = 0
    ended = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not ended.is_set():
            ticks += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    before = ticks
    call()
    during = ticks - before
    ended.set()
    thread.join()
    return during


def test_other_threads_run_beside_a_long_call(analysis: sl.Analysis) -> None:
    assert ticks_beside(lambda: sl.replicates(analysis, n=50)) > 20


@pytest.mark.parametrize("name", ["warnings", "verdict"])
def test_other_threads_run_beside_the_comparison_of_lines(case: sl.Case, name: str) -> None:
    # The first use compares the lines. A call that blocks the interpreter allows one tick, before or after it.
    fresh = [sl.analyze(case) for _ in range(5)]
    assert sum(ticks_beside(lambda: getattr(one, name)) for one in fresh) > 2 * len(fresh)


COHORT = """
import os
import signal
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import nullcontext
from multiprocessing import get_context
from pathlib import Path

import spineline as sl

EXECUTORS = {
    "own": nullcontext,
    "threads": lambda: ThreadPoolExecutor(2),
    "processes": lambda: ProcessPoolExecutor(2, mp_context=get_context("spawn")),
}

if __name__ == "__main__":
    folder, kind = Path(sys.argv[1]), sys.argv[2]
    for subject in (1, 2, 3, 4):
        sl.phantom("rod", subject=subject).save(folder / f"{subject}.json")
    at = []

    def interrupt():
        while not list(folder.glob("out/run-*/.asking-*")):
            time.sleep(0.01)
        # All processes have started, and are in the middle of a case.
        time.sleep(4 if kind == "processes" else 1)
        at.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    cohort = sl.Cohort.glob(str(folder / "*.json"))
    try:
        with EXECUTORS[kind]() as executor:
            cohort.analyze(out=folder / "out", executor=executor, replicates=1_000_000, chunk=1)
        print("not interrupted")
    except KeyboardInterrupt:
        print(time.monotonic() - at[0], flush=True)
"""
"""Interrupts a cohort, and prints after how many seconds it and its executor ended."""


@pytest.mark.skipif(sys.platform == "win32", reason="interrupts by signal")
@pytest.mark.parametrize("kind", ["own", "threads", "processes"])
def test_ctrl_c_ends_a_cohort_within_a_second(kind: str, tmp_path: Path) -> None:
    script = tmp_path / "run.py"
    script.write_text(COHORT)
    command = [sys.executable, str(script), str(tmp_path), kind]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert ended.returncode == 0, ended.stderr
    assert float(ended.stdout) < 1.0, ended.stderr
    # No unfinished file counts as a part.
    (manifest,) = tmp_path.glob("out/run-*/manifest.json")
    found = json.loads(manifest.read_text())
    assert not found["complete"] and found["parts"] == []
    assert not list(tmp_path.glob("out/run-*/parts/*")) and not list(tmp_path.rglob("*.parquet"))
    assert not list(tmp_path.glob("out/run-*/.asking-*"))


def test_progress_counts_the_replicates(analysis: sl.Analysis, capsys: pytest.CaptureFixture[str]) -> None:
    seen: list[tuple[int, int]] = []
    found = sl.replicates(analysis, n=40, seed=3, progress=lambda done, total: seen.append((done, total)))
    assert seen[0] == (0, 40) and seen[-1] == (40, 40) and seen == sorted(set(seen))
    assert found == sl.replicates(analysis, n=40, seed=3, progress=False) and not capsys.readouterr().err
    sl.replicates(analysis, n=3, progress=True)
    assert capsys.readouterr().err.endswith("analysed 3 of 3 replicates\n")


def test_an_exception_of_a_progress_function_ends_the_replicates(analysis: sl.Analysis) -> None:
    def stop(done: int, total: int) -> None:
        raise LookupError(f"{done} of {total}")

    with pytest.raises(LookupError, match="0 of 100000"):
        sl.replicates(analysis, n=100_000, progress=stop)
