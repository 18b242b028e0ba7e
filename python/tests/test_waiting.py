"""Long calls: Ctrl-C ends them, and other threads run beside them."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time

import pytest

import spineline as sl


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_ends_replicates() -> None:
    program = (
        "import spineline as sl\n"
        "a = sl.analyze(sl.phantom())\n"
        "print('ready', flush=True)\n"
        "try:\n"
        "    sl.replicates(a, n=1_000_000)\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', flush=True)\n"
    )
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None and child.stdout.readline() == "ready\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    out, _ = child.communicate(timeout=60)
    assert out == "interrupted\n" and child.returncode == 0


def test_other_threads_run_beside_a_long_call(analysis: sl.Analysis) -> None:
    ticks = 0
    ended = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not ended.is_set():
            ticks += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    sl.replicates(analysis, n=50)
    ended.set()
    thread.join()
    assert ticks > 20
