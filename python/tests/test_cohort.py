"""Cohorts: parts that are whole, resumed, and the same on any executor."""

from __future__ import annotations

import os
import subprocess
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest

import spineline as sl
from spineline import _cohort

pytest.importorskip("pyarrow")


def files(folder: Path) -> dict[str, bytes]:
    """Every Parquet file below a folder."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*.parquet")}


def test_any_executor_gives_the_same_bytes_and_another_run_resumes(
    folder_of_cases: Path, tmp_path: Path
) -> None:
    cohort = sl.Cohort.glob(str(folder_of_cases / "*.json"))
    assert len(cohort) == 18
    runs = []
    with (
        ThreadPoolExecutor(2) as threads,
        ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes,
    ):
        for name, executor in (("own", None), ("threads", threads), ("processes", processes)):
            runs.append(cohort.analyze(executor=executor, out=tmp_path / name, chunk=5))
    assert len(runs[0].parts) == 4 and all(run.is_complete for run in runs)
    first = files(tmp_path / "own")
    assert first and first == files(tmp_path / "threads") == files(tmp_path / "processes")
    table = runs[0].read("cases")
    assert table["status"].to_pylist() == ["ok"] * 18
    assert table["case_id"].to_pylist() == sorted(table["case_id"].to_pylist())
    removed = tmp_path / "own" / "done" / f"{runs[0].parts[1].name}.json"
    removed.unlink()
    again = cohort.analyze(out=tmp_path / "own", chunk=5)
    assert [part.was_there for part in again.parts] == [True, False, True, True]
    assert files(tmp_path / "own") == first
    other = cohort.analyze(out=tmp_path / "own", chunk=5, support="frontal")
    assert not {part.name for part in other.parts} & {part.name for part in again.parts}


def test_replicates_in_the_workers_are_those_of_the_program(
    program: Path, folder_of_cases: Path, tmp_path: Path
) -> None:
    import pyarrow.parquet

    cohort = sl.Cohort.glob(str(folder_of_cases / "*-0[1-4].json"))
    asked: dict[str, Any] = {"replicates": 5, "noise": "measured", "seed": 3}
    runs = []
    with (
        ThreadPoolExecutor(2) as threads,
        ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes,
    ):
        for name, executor in (("own", None), ("threads", threads), ("processes", processes)):
            run = cohort.analyze(executor=executor, out=tmp_path / name, chunk=2, **asked)
            runs.append(run)
    first = files(tmp_path / "own")
    assert first == files(tmp_path / "threads") == files(tmp_path / "processes")
    subprocess.run(
        [program, "analyze", *cohort, "--replicates", "5", "--seed", "3"]
        + ["--tables", tmp_path / "program", "--tables-format", "parquet"],
        check=True,
        capture_output=True,
    )
    for table in ("uncertainty", "vertebrae"):
        expected = pyarrow.parquet.read_table(tmp_path / "program" / f"{table}.parquet")
        found = runs[0].read(table).replace_schema_metadata(expected.schema.metadata)
        assert found.equals(expected) and len(found) > 500, table
    # One patient alone has the same replicates as in the cohort.
    alone = sl.replicates(sl.analyze(sl.read_case(cohort[2])), n=5, seed=3).table.to_pyarrow()
    rows = runs[0].read("uncertainty").filter(pyarrow.compute.field("case_id") == sl.read_case(cohort[2]).id)
    assert rows.to_pylist() == alone.to_pylist()


def test_replicates_are_part_of_the_name_and_bad_ones_are_errors(
    folder_of_cases: Path, tmp_path: Path
) -> None:
    cohort = sl.Cohort.glob(str(folder_of_cases / "*-01.json"))
    names = [
        cohort.analyze(out=tmp_path / "out", **asked).parts[0].name
        for asked in ({}, {"replicates": 2}, {"replicates": 3}, {"replicates": 2, "seed": 2}, {"replicates": 2, "noise": 3})
    ]
    assert len(set(names)) == len(names)
    for wrong in ({"replicates": 1}, {"replicates": 2, "noise": "loud"}):
        with pytest.raises(sl.InputError):
            cohort.analyze(out=tmp_path / "wrong", **wrong)
    assert not (tmp_path / "wrong").exists()


def test_a_case_whose_noise_does_not_apply_is_a_row_with_its_error(
    folder_of_cases: Path, tmp_path: Path
) -> None:
    page = (Path(__file__).resolve().parents[2] / "docs/guide/src/case.md").read_text()
    locations = tmp_path / "locations.json"
    locations.write_text(page.split("```json\n")[1].split("```")[0])
    good = next(folder_of_cases.glob("*-01.json"))
    run = sl.Cohort([locations, good]).analyze(out=tmp_path / "out", replicates=2, noise=3)
    rows = run.read("cases").to_pylist()
    assert [row["status"] for row in rows] == ["error", "ok"] and "pixels" in rows[0]["error"]
    assert len(set(run.read("uncertainty")["case_id"].to_pylist())) == 1


def test_an_executor_of_executorlib_gives_the_same_bytes(
    folder_of_cases: Path, tmp_path: Path
) -> None:
    executorlib = pytest.importorskip("executorlib")
    cohort = sl.Cohort.glob(str(folder_of_cases / "*-0[1-4].json"))
    with executorlib.SingleNodeExecutor(max_workers=2) as executor:
        run = cohort.analyze(executor=executor, out=tmp_path / "executorlib", chunk=2)
        bad = sl.Cohort([*cohort[:1], tmp_path / "missing.json"])
        rows = bad.analyze(executor=executor, out=tmp_path / "bad").read("cases")
    assert run.is_complete and rows["status"].to_pylist() == ["ok", "error"]
    cohort.analyze(out=tmp_path / "own", chunk=2)
    assert files(tmp_path / "executorlib") == files(tmp_path / "own")


def test_a_bad_patient_is_a_row_with_its_error(folder_of_cases: Path, tmp_path: Path) -> None:
    good = next(folder_of_cases.glob("phantom-rod-01.json"))
    bad = tmp_path / "bad.json"
    bad.write_text("{")
    run = sl.Cohort([bad, good, tmp_path / "missing.json"]).analyze(out=tmp_path / "out")
    rows = run.read("cases").to_pylist()
    assert [row["status"] for row in rows] == ["error", "ok", "error"]
    assert "not JSON" in rows[0]["error"] and rows[0]["help"] and rows[2]["sha256"] is None
    assert run.parts[0].failed == 2
    assert set(run.read("vertebrae")["case_id"].to_pylist()) == {"phantom-rod-01"}


def test_a_worker_with_another_version_is_refused(folder_of_cases: Path, tmp_path: Path) -> None:
    paths = [str(next(folder_of_cases.glob("phantom-rod-01.json")))]
    with pytest.raises(sl.InputError, match="0.0.9 asks it"):
        _cohort.analyze_chunk(paths, [], None, str(tmp_path), "0.0.9")


class Losing(Executor):
    """Loses the second task, as a cluster loses one with its worker."""

    def __init__(self) -> None:
        self.count = 0

    def submit(self, task: Any, /, *arguments: Any, **named: Any) -> Future[Any]:
        self.count += 1
        future: Future[Any] = Future()
        if self.count == 2:
            future.set_exception(ConnectionError("the worker was killed"))
        else:
            future.set_result(task(*arguments, **named))
        return future


def test_a_lost_task_is_named_and_another_run_repeats_it(
    folder_of_cases: Path, tmp_path: Path
) -> None:
    cohort = sl.Cohort.glob(str(folder_of_cases / "*.json"))[:6]
    run = cohort.analyze(executor=Losing(), out=tmp_path, chunk=2)
    assert not run.is_complete and len(run.lost) == 1 and "killed" in run.lost[0][1]
    assert run.lost[0][0] == tuple(str(path) for path in cohort[2:4])
    again = cohort.analyze(out=tmp_path, chunk=2)
    assert again.is_complete and [part.was_there for part in again.parts] == [True, False, True]


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root writes anywhere")
def test_a_folder_that_cannot_be_written_is_an_error(folder_of_cases: Path, tmp_path: Path) -> None:
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o500)
    with pytest.raises(PermissionError):
        sl.Cohort.glob(str(folder_of_cases / "*-01.json")).analyze(out=closed)


def test_a_file_is_whole_or_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from spineline._run import write_whole

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OSError, match="No space left"):
        write_whole(tmp_path / "a.parquet", b"x" * 1000)
    assert list(tmp_path.iterdir()) == []


def test_an_empty_cohort_and_wrong_options_are_errors(folder_of_cases: Path, tmp_path: Path) -> None:
    with pytest.raises(sl.InputError, match="no case file"):
        sl.Cohort.glob(str(tmp_path / "*.json"))
    cohort = sl.Cohort.glob(str(folder_of_cases / "*-01.json"))
    with pytest.raises(sl.InputError, match="did you mean `support`"):
        cohort.analyze(out=tmp_path, suport="frontal")  # type: ignore[call-arg]
    assert list(tmp_path.iterdir()) == []
