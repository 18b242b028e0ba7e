"""A cohort on a real cluster of processes, one of which is killed in the middle."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from pathlib import Path

import pytest

import spineline as sl

distributed = pytest.importorskip("distributed")


@pytest.mark.skipif(sys.platform == "win32", reason="kills by signal")
@pytest.mark.filterwarnings("ignore")
def test_a_killed_worker_costs_no_case(folder_of_cases: Path, tmp_path: Path) -> None:
    cohort = sl.Cohort.glob(str(folder_of_cases / "*.json"))
    alone = cohort.analyze(out=tmp_path / "alone", chunk=1)
    with (
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        pids = list(client.run(os.getpid).values())
        done = tmp_path / "cluster" / "done"

        def kill() -> None:
            while not (done.exists() and len(list(done.iterdir())) >= 3):
                time.sleep(0.005)
            os.kill(pids[0], signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        run = cohort.analyze(executor=client.get_executor(), out=tmp_path / "cluster", chunk=1)
        killer.join()
    assert run.is_complete and [part.name for part in run.parts] == [p.name for p in alone.parts]
    for part in alone.parts:
        for table in ("cases", "vertebrae"):
            name = f"{table}/{part.name}.parquet"
            ours = (tmp_path / "cluster" / name).read_bytes()
            assert ours == (tmp_path / "alone" / name).read_bytes(), name
    found = {path.stem for path in (tmp_path / "cluster").rglob("*.parquet")}
    assert found == {part.name for part in alone.parts}, "what was half written has no name of a part"
