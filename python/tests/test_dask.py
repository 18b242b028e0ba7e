"""A cohort on a real cluster: killed workers and schedulers, fatal cases, full disks, old wheels."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import spineline as sl

distributed = pytest.importorskip("distributed")

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="kills by signal"),
    pytest.mark.filterwarnings("ignore"),
]

POISON = """
import os
import spineline._parts as parts

class Poisoned:
    native = parts._native

    def __getattr__(self, name):
        return getattr(self.native, name)

    def analyze_paths(self, cases, *asked):
        if any(path.endswith("-rod-02.json") for path, _ in cases):
            os._exit(1)
        return self.native.analyze_paths(cases, *asked)

parts._native = Poisoned()
"""
"""Ends a worker at one case, every time."""

FULL = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (2_000, 2_000))
"""
"""Lets a worker write only the smallest files."""


SCRIPT = """
import sys
import distributed
import spineline as sl

if __name__ == "__main__":
    folder, out = sys.argv[1:]
    local = dict(host="127.0.0.1", dashboard_address=None, threads_per_worker=1)
    with distributed.LocalCluster(n_workers=2, **local) as workers, distributed.Client(workers) as client:
        cohort = sl.Cohort.glob(folder + "/*.json")
        cohort.analyze(executor=client.get_executor(), out=out, chunk=1)
"""
"""A process with its own cluster."""

INTERRUPTED = """
import os
import signal
import sys
import threading
import time
from pathlib import Path
import distributed
import spineline as sl

def interrupt():
    while not list(Path(sys.argv[2]).glob("run-*/.asking-*")):
        time.sleep(0.01)
    time.sleep(3)
    at.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)

if __name__ == "__main__":
    # A shell may start its background jobs with interrupts ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    at = []
    folder, out = sys.argv[1:]
    local = dict(host="127.0.0.1", dashboard_address=None, threads_per_worker=1)
    with distributed.LocalCluster(n_workers=2, **local) as workers, distributed.Client(workers) as client:
        cohort = sl.Cohort.glob(folder + "/*.json")
        threading.Thread(target=interrupt).start()
        try:
            cohort.analyze(executor=client.get_executor(), out=out, chunk=1, replicates=1_000_000)
        except KeyboardInterrupt:
            print(time.monotonic() - at[0], flush=True)
        # Workers have stopped their cases.
        print(client.submit(sum, [1, 2]).result(timeout=30))
"""
"""Interrupts a cohort on a cluster, prints after how many seconds it ended, and uses the cluster again."""


@contextmanager
def cluster(preload: Path | None = None) -> Iterator[Any]:
    """A client of two worker processes, which can run a file before any task."""
    with (
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
            preload=[str(preload)] if preload else [],
        ) as workers,
        distributed.Client(workers) as client,
    ):
        yield client


def wait_for_parts(folder: Path, number: int) -> None:
    """Waits until `number` parts are done."""
    while len(list(folder.glob("run-*/parts/*.json"))) < number:
        time.sleep(0.005)


def is_same(folder: Path, other: Path, parts: tuple[sl.Part, ...]) -> bool:
    """Whether both folders have the same bytes of all parts, and nothing else."""
    found = [{path.stem for path in one.rglob("*.parquet")} for one in (folder, other)]
    names = {part.name for part in parts}
    (folder,) = folder.glob("run-*")
    files = [f"{table}/{name}.parquet" for table in ("cases", "vertebrae") for name in names]
    same = all((folder / file).read_bytes() == (other / file).read_bytes() for file in files)
    return same and found == [names, names]


@pytest.fixture(scope="module")
def cohort(folder_of_cases: Path) -> sl.Cohort:
    return sl.Cohort.glob(str(folder_of_cases / "*.json"))


@pytest.fixture(scope="module")
def alone(cohort: sl.Cohort, tmp_path_factory: pytest.TempPathFactory) -> sl.CohortRun:
    """The same without a cluster."""
    return cohort.analyze(out=tmp_path_factory.mktemp("alone"), chunk=1)


def test_a_killed_worker_loses_no_case(
    cohort: sl.Cohort, alone: sl.CohortRun, tmp_path: Path
) -> None:
    with cluster() as client:
        pids = list(client.run(os.getpid).values())

        def kill() -> None:
            wait_for_parts(tmp_path, 3)
            os.kill(pids[0], signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        run = cohort.analyze(executor=client.get_executor(retries=2), out=tmp_path, chunk=1)
        killer.join()
    assert run.is_complete and [part.name for part in run.parts] == [p.name for p in alone.parts]
    assert is_same(tmp_path, alone.folder, alone.parts)


def test_a_case_that_kills_its_worker_is_named_and_the_others_go_on(
    cohort: sl.Cohort, alone: sl.CohortRun, tmp_path: Path
) -> None:
    preload = tmp_path / "poison.py"
    preload.write_text(POISON)
    out = tmp_path / "out"
    with cluster(preload) as client:
        run = cohort.analyze(executor=client.get_executor(), out=out, chunk=1)
    lost = [path for paths, _ in run.lost for path in paths]
    assert "phantom-rod-02.json" in [Path(path).name for path in lost]
    # Cases that waited at the killed workers are lost too; some of their files may exist.
    assert len(lost) < len(cohort) / 2 and all("KilledWorker" in why for _, why in run.lost)
    again = cohort.analyze(out=out, chunk=1)
    assert again.is_complete
    assert 1 <= sum(not part.was_there for part in again.parts) <= len(lost)
    assert is_same(out, alone.folder, alone.parts)


def test_a_killed_scheduler_loses_unfinished_cases_and_another_run_resumes(
    cohort: sl.Cohort, alone: sl.CohortRun, folder_of_cases: Path, tmp_path: Path
) -> None:
    # The scheduler of a local cluster runs in the calling process.
    out = tmp_path / "out"
    script = tmp_path / "run.py"
    script.write_text(SCRIPT)
    asking = subprocess.Popen([sys.executable, str(script), str(folder_of_cases), str(out)])
    try:
        wait_for_parts(out, 3)
    finally:
        asking.kill()
        asking.wait()
    again = cohort.analyze(out=out, chunk=1)
    assert again.is_complete and sum(part.was_there for part in again.parts) >= 3
    assert is_same(out, alone.folder, alone.parts)


def test_a_full_disk_is_an_error_and_leaves_whole_files(
    cohort: sl.Cohort, alone: sl.CohortRun, tmp_path: Path
) -> None:
    preload = tmp_path / "full.py"
    preload.write_text(FULL)
    out = tmp_path / "out"
    with cluster(preload) as client, pytest.raises(OSError, match="File too large"):
        cohort.analyze(executor=client.get_executor(), out=out, chunk=1)
    assert not list(out.rglob("parts/*.json")) and not list(out.rglob(".*"))
    assert cohort.analyze(out=out, chunk=1).is_complete
    assert is_same(out, alone.folder, alone.parts)


def test_an_old_version_on_one_worker_is_refused(cohort: sl.Cohort, tmp_path: Path) -> None:
    def age() -> None:
        import spineline

        spineline.__version__ = "0.0.9"

    with cluster() as client:
        workers = list(client.scheduler_info()["workers"])
        client.run(age, workers=workers[:1])
        with pytest.raises(sl.InputError, match="a worker has Spineline 0.0.9"):
            cohort.analyze(executor=client.get_executor(), out=tmp_path, chunk=1)


def test_ctrl_c_ends_a_cohort_on_a_cluster_within_a_second(
    folder_of_cases: Path, tmp_path: Path
) -> None:
    script = tmp_path / "run.py"
    script.write_text(INTERRUPTED)
    out = tmp_path / "out"
    command = [sys.executable, str(script), str(folder_of_cases), str(out)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=120)
    seconds, goes_on = ended.stdout.split()
    assert float(seconds) < 1.0 and goes_on == "3", ended.stderr
    assert not list(out.rglob("*.parquet")) and not list(out.glob("run-*/.asking-*"))
