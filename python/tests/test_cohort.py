"""Cohorts: parts are whole, resumed, and the same on any executor."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest

import spineline as sl
from spineline import _cohort, _parts

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
    removed = runs[0].folder / "parts" / f"{runs[0].parts[1].name}.json"
    removed.unlink()
    again = cohort.analyze(out=tmp_path / "own", chunk=5)
    assert [part.was_there for part in again.parts] == [True, False, True, True]
    assert files(tmp_path / "own") == first
    other = cohort.analyze(out=tmp_path / "own", chunk=5, support="frontal")
    assert not {part.name for part in other.parts} & {part.name for part in again.parts}


def test_replicates_in_the_workers_are_as_in_the_program(
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


def test_a_worker_with_another_version_or_build_is_refused(tmp_path: Path) -> None:
    for version, build in (("0.0.9", _parts.build_identity()), (sl.__version__, "0" * 64)):
        request = _parts.Request(version, build, [], [], None)
        task = _parts.Task((), request, str(tmp_path), str(tmp_path))
        with pytest.raises(sl.InputError, match=rf"is from {version} \(build {build[:12]}\)"):
            _parts.analyze_part(task)


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


def stiffness_file(program: Path, path: Path, factor: float) -> None:
    """The default springs; the sixth joint's are multiplied."""
    printed = subprocess.run([program, "stiffness"], check=True, capture_output=True, text=True).stdout
    springs = json.loads(printed)
    springs["joints"][5]["lateral_nm_per_rad"] *= factor
    path.write_text(json.dumps(springs))


def test_a_changed_stiffness_file_gives_new_numbers(
    program: Path, folder_of_cases: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cohort = sl.Cohort.glob(str(folder_of_cases / "*-0[12].json"))
    path = tmp_path / "doe" / "own.json"
    path.parent.mkdir()
    springs = []
    for factor in (1.0, 5.0, 1.0):
        stiffness_file(program, path, factor)
        run = cohort.analyze(out=tmp_path / "out", stiffness=path)
        springs.append((run.folder, run.read("springs").to_pylist()))
    assert springs[0][1] != springs[1][1]
    assert springs[0] == springs[2] and run.parts[0].was_there
    alone = sl.analyze(sl.read_case(cohort[0]), stiffness=path).tables["springs"].to_pyarrow()
    ids = {row["case_id"] for row in alone.to_pylist()}
    assert [row for row in springs[2][1] if row["case_id"] in ids] == alone.to_pylist()
    # The file is named by its bytes, without its folder.
    import pyarrow.parquet

    metadata = pyarrow.parquet.read_schema(next(run.folder.glob("springs/*.parquet"))).metadata
    sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
    assert json.loads(metadata[b"spineline.option_files"]) == [
        {"option": "stiffness", "name": "own.json", "sha256": sha256}
    ]
    assert json.loads(metadata[b"spineline.options"]) == [["stiffness", "own.json"]]
    assert len(metadata[b"spineline.build"]) == 64
    assert not any(b"doe" in value for value in metadata.values())
    assert "doe" not in (run.folder / "manifest.json").read_text()
    # A relative path is the same file, wherever a worker is.
    monkeypatch.chdir(path.parent)
    assert cohort.analyze(out=tmp_path / "out", stiffness="own.json").folder == run.folder


def test_a_changed_program_reuses_no_part(
    folder_of_cases: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cohort = sl.Cohort.glob(str(folder_of_cases / "*-01.json"))
    before = cohort.analyze(out=tmp_path)
    for module in (_cohort, _parts):
        monkeypatch.setattr(module, "build_identity", lambda: "f" * 64)
    after = cohort.analyze(out=tmp_path)
    assert before.folder != after.folder and not after.parts[0].was_there
    assert cohort.analyze(out=tmp_path).parts[0].was_there


@pytest.mark.parametrize("change", ["deleted", "truncated", "altered", "empty record", "cut record", "altered record"])
def test_a_part_that_is_not_whole_is_made_again_and_named(
    folder_of_cases: Path, tmp_path: Path, change: str, caplog: pytest.LogCaptureFixture
) -> None:
    cohort = sl.Cohort.glob(str(folder_of_cases / "*-0[1-4].json"))
    run = cohort.analyze(out=tmp_path, chunk=2)
    before = files(tmp_path)
    assert run.redone == ()
    name = run.parts[1].name
    table, record = run.folder / "vertebrae" / f"{name}.parquet", run.folder / "parts" / f"{name}.json"
    content = table.read_bytes()
    if change == "deleted":
        table.unlink()
        with pytest.raises(sl.InputError, match="is missing, or does not have"):
            run.read("vertebrae")
    elif change == "truncated":
        table.write_bytes(content[:-100])
    elif change == "altered":
        table.write_bytes(content[:50] + bytes([content[50] ^ 1]) + content[51:])
    elif change == "empty record":
        record.write_text("")
    elif change == "cut record":
        record.write_text(record.read_text()[:40])
    else:
        found = json.loads(record.read_text())
        del found["tables"]["vertebrae"]
        record.write_text(json.dumps(found))
    again = cohort.analyze(out=tmp_path, chunk=2)
    assert [part.was_there for part in again.parts] == [True, False]
    assert len(again.redone) == 1 and name in again.redone[0] and name in caplog.text
    assert files(tmp_path) == before
    assert again.read("vertebrae").num_rows == run.read("vertebrae").num_rows > 0
    assert cohort.analyze(out=tmp_path, chunk=2).redone == ()


def test_the_folder_of_a_run_holds_one_data_set(folder_of_cases: Path, tmp_path: Path) -> None:
    import pyarrow.dataset

    cohort = sl.Cohort.glob(str(folder_of_cases / "*-0[1-6].json"))
    runs = [
        cohort.analyze(out=tmp_path, chunk=2),
        cohort.analyze(out=tmp_path, chunk=2, support="free"),
        cohort[:4].analyze(out=tmp_path, chunk=2),
        cohort.analyze(out=tmp_path, chunk=3),
    ]
    assert len({run.folder for run in runs}) == 4
    # Parts of another run with the same cases are reused.
    assert all(part.was_there for part in runs[2].parts)
    for run, cases in zip(runs, (6, 6, 4, 6), strict=True):
        rows = pyarrow.dataset.dataset(run.folder / "patients").to_table()
        assert len(rows) == len(set(rows["case_id"].to_pylist())) == cases
        found = json.loads((run.folder / "manifest.json").read_text())
        assert found["complete"] and len(found["cases"]) == cases
        assert [part["name"] for part in found["parts"]] == [part.name for part in run.parts]
        assert {path.stem for path in run.folder.glob("*/*.parquet")} == {part.name for part in run.parts}
    assert not list(tmp_path.rglob(".*"))


def test_a_changed_case_is_analysed_again(folder_of_cases: Path, tmp_path: Path) -> None:
    path = tmp_path / "case.json"
    kept = sorted(folder_of_cases.glob("*-0[12].json"))
    path.write_bytes(kept[0].read_bytes())
    first = sl.Cohort([path]).analyze(out=tmp_path / "out")
    path.write_bytes(kept[1].read_bytes())
    second = sl.Cohort([path]).analyze(out=tmp_path / "out")
    assert first.folder != second.folder
    assert first.read("cases")["case_id"].to_pylist() != second.read("cases")["case_id"].to_pylist()


def test_two_cases_with_one_identifier_are_refused(folder_of_cases: Path, tmp_path: Path) -> None:
    first = next(folder_of_cases.glob("*-01.json"))
    copy = tmp_path / "copy.json"
    copy.write_bytes(first.read_bytes())
    for paths in ([first, copy], [first, first]):
        with pytest.raises(sl.InputError, match="phantom-rod-01 was given already") as caught:
            sl.Cohort(paths).analyze(out=tmp_path / "out", chunk=1)
        assert "case_id" in caught.value.help
    # Another name, and one film less: the same readings.
    data = json.loads(first.read_bytes())
    data["case_id"] = "other"
    del data["films"][-1]
    copy.write_text(json.dumps(data))
    with pytest.raises(sl.InputError, match="has the landmarks of a film of the case phantom-rod-01"):
        sl.Cohort([first, copy]).analyze(out=tmp_path / "out", chunk=1)
    assert not (tmp_path / "out").exists()


def test_a_case_with_the_name_of_a_person_is_refused(case: sl.Case, tmp_path: Path) -> None:
    data = json.loads(case.to_json())
    for name in ("Doe^Jane", "Doe, Jane", "Jane Doe", "Müller", "", "x" * 65):
        data["case_id"] = name
        with pytest.raises(sl.InputError, match="`case_id` is"):
            sl.Case.from_json(json.dumps(data))
        (tmp_path / "bad.json").write_text(json.dumps(data))
        with pytest.raises(sl.InputError, match="`case_id` is"):
            sl.read_case(tmp_path / "bad.json")
        rows = sl.Cohort([tmp_path / "bad.json"]).analyze(out=tmp_path / "out").read("cases").to_pylist()
        assert rows[0]["status"] == "error" and "`case_id` is" in rows[0]["error"]
    data["case_id"] = "P-07_a.2"
    assert sl.Case.from_json(json.dumps(data)).id == "P-07_a.2"


def test_relative_paths_start_where_the_call_is_made(
    program: Path, folder_of_cases: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(next(folder_of_cases.glob("*-01.json")), tmp_path / "case.json")
    stiffness_file(program, tmp_path / "own.json", 2.0)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(tmp_path)
    with ProcessPoolExecutor(
        1, mp_context=get_context("spawn"), initializer=os.chdir, initargs=(str(elsewhere),)
    ) as workers:
        run = sl.Cohort(["case.json"]).analyze(out="out", executor=workers, stiffness="own.json")
    assert run.is_complete and run.folder.parent == tmp_path / "out"
    assert run.read("cases")["status"].to_pylist() == ["ok"]
    assert list(elsewhere.iterdir()) == []


def test_a_file_that_changes_during_the_run_is_refused(
    program: Path, folder_of_cases: Path, tmp_path: Path
) -> None:
    path, springs = tmp_path / "case.json", tmp_path / "own.json"
    shutil.copy(next(folder_of_cases.glob("*-01.json")), path)
    stiffness_file(program, springs, 2.0)

    class Changing(Executor):
        """Changes a file before the task runs."""

        def __init__(self, file: Path) -> None:
            self.file = file

        def submit(self, task: Any, /, *arguments: Any, **named: Any) -> Future[Any]:
            self.file.write_text(self.file.read_text() + "\n")
            future: Future[Any] = Future()
            try:
                future.set_result(task(*arguments, **named))
            except Exception as error:
                future.set_exception(error)
            return future

    run = sl.Cohort([path]).analyze(out=tmp_path / "out", executor=Changing(path))
    assert not run.is_complete and "case.json has changed" in run.lost[0][1]
    assert not json.loads((run.folder / "manifest.json").read_text())["complete"]
    with pytest.raises(sl.InputError, match="`stiffness`: its file has changed"):
        sl.Cohort([path]).analyze(out=tmp_path / "out", executor=Changing(springs), stiffness=springs)


def test_progress_counts_the_cases(
    folder_of_cases: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cohort = sl.Cohort.glob(str(folder_of_cases / "*-0[1-4].json"))
    seen: list[tuple[int, int]] = []
    cohort.analyze(out=tmp_path, chunk=2, progress=lambda done, cases: seen.append((done, cases)))
    assert seen == [(0, 4), (2, 4), (4, 4)]
    # Standard error is not a terminal here.
    cohort.analyze(out=tmp_path, chunk=2)
    assert capsys.readouterr().err == ""
    cohort.analyze(out=tmp_path, chunk=2, progress=True)
    assert capsys.readouterr().err.endswith("analysed 4 of 4 cases\n")


def test_patients_of_the_learned_prior_are_not_predicted(
    program: Path, folder_of_cases: Path, tmp_path: Path
) -> None:
    names = list(sl.Cohort.glob(str(folder_of_cases / "*.json")))[:6]
    prior = tmp_path / "prior.json"
    learn = [program, "learn-prior", *names[:5], "--out", prior]
    subprocess.run(learn, check=True, capture_output=True)
    known, other = sl.read_case(names[0]), sl.read_case(names[5])
    assert sl.analyze(other, rotation_prior=prior).is_usable
    with pytest.raises(sl.InputError, match=f"was learned from the case {known.id}"):
        sl.analyze(known, rotation_prior=prior)
    with pytest.raises(sl.InputError, match="learned with tilts by `endplates`"):
        sl.analyze(other, rotation_prior=prior, tilt="axis")
    cohort = sl.Cohort([names[0], names[5]])
    run = cohort.analyze(out=tmp_path / "out", rotation_prior=prior)
    assert run.read("cases")["status"].to_pylist() == ["error", "ok"]


def test_a_number_of_a_cohort_out_of_range_is_refused(tmp_path: Path) -> None:
    cohort = sl.Cohort([sl.phantom("rod", subject=1).save(tmp_path / "case.json")])
    for given in ({"chunk": 0}, {"chunk": 1.5}, {"replicates": 1}, {"replicates": 2, "seed": -1}):
        *_, (name, value) = given.items()
        with pytest.raises(sl.InputError, match=f"`{name}` is {value}") as caught:
            cohort.analyze(out=tmp_path / "out", **given)  # type: ignore[arg-type]
        assert caught.value.value == value and "whole number from" in caught.value.help
    assert not (tmp_path / "out").exists()


def test_one_path_is_not_a_cohort(tmp_path: Path) -> None:
    path = sl.phantom("rod", subject=1).save(tmp_path / "case.json")
    for one in (path, str(path), b"case.json"):
        with pytest.raises(sl.InputError, match="list of paths, not of one: .*case.json") as caught:
            sl.Cohort(one)  # type: ignore[arg-type]
        assert "[path]" in caught.value.help
    assert list(sl.Cohort([path])) == [path]


def test_options_that_a_cohort_does_not_use_are_refused_with_the_way_to_them(tmp_path: Path) -> None:
    cohort = sl.Cohort([sl.phantom("rod", subject=1).save(tmp_path / "case.json")])
    for given in ({"noise": 0.5}, {"seed": 2}):
        with pytest.raises(sl.InputError, match="are for `replicates`"):
            cohort.analyze(out=tmp_path / "out", **given)  # type: ignore[arg-type]
    with pytest.raises(sl.InputError, match="does not compute `identifiability`") as caught:
        cohort.analyze(out=tmp_path / "out", identifiability=True)  # type: ignore[call-arg]
    assert "analyze(case, identifiability=True)" in caught.value.help
    with pytest.raises(sl.InputError, match="did you mean `support`") as caught:
        cohort.analyze(out=tmp_path / "out", suport="free")  # type: ignore[call-arg]
    assert "min_curve" in caught.value.help and "rotation_prior" in caught.value.help
