"""Prints the time of an import, and the overhead of a call. It is not a test."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

import spineline as sl
from spineline import _native
from spineline._run import command, now_utc


def import_ms() -> float:
    """Median time of `import spineline` in a new interpreter, without its start."""
    code = (
        "import time; start = time.perf_counter(); import spineline; "
        "print(1e3 * (time.perf_counter() - start)); "
        "import sys; assert 'pandas' not in sys.modules and 'numpy' not in sys.modules"
    )
    times = [
        float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True).stdout)
        for _ in range(7)
    ]
    return statistics.median(times)


def seconds(call: object, count: int) -> float:
    """Median time of a call."""
    times = []
    for _ in range(count):
        start = time.perf_counter()
        call()  # type: ignore[operator]
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def main() -> None:
    case = sl.phantom("rod", subject=1)
    calls, inner = [], []
    for _ in range(41):
        # One after the other, so that both see the same machine.
        inner.append(_native.time_analysis(case._native))
        calls.append(seconds(lambda: sl.analyze(case), 1))
    whole, inside = statistics.median(calls), statistics.median(inner)
    build = "development" if _native.IS_DEVELOPMENT else "release"
    print(f"import spineline: {import_ms():.1f} ms, without numpy and pandas")
    print(
        f"analyze: {1e3 * whole:.2f} ms, of which {1e3 * inside:.2f} ms in the library "
        f"({100.0 * (whole / inside - 1.0):.2f} % overhead, {build} build)"
    )
    words = seconds(lambda: command("analyze", {}) and now_utc(), 101)
    print(f"Python's own part: {1e6 * words:.0f} µs")


if __name__ == "__main__":
    main()
