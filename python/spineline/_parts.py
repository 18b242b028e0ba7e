"""Parts of a cohort: the tables that a worker makes from some cases, and whether they are intact."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import _native
from ._errors import InputError
from ._run import build_identity, without_folders, write_whole

_RECORDS = "parts"
"""Folder of the records of finished parts in the folder of a run: a record is written after all tables of its part."""


@dataclass(frozen=True)
class CaseRead:
    """A case file as it was when the cohort was requested."""

    path: str
    """Absolute path."""
    identity: str
    """SHA-256 of its bytes, or why it cannot be read."""

    @property
    def sha256(self) -> str | None:
        """SHA-256 of its bytes; None where it cannot be read."""
        return self.identity if len(self.identity) == 64 and self.identity.isalnum() else None


@dataclass(frozen=True)
class Request:
    """The request for every case."""

    version: str
    """Version of Spineline of the request."""
    build: str
    """Identity of its code."""
    words: list[tuple[str, str]]
    """Options of the method as words; files by absolute paths."""
    option_files: list[tuple[str, str, str]]
    """Option, name and SHA-256 of every file that an option names."""
    replicates: tuple[int, str, int] | None
    """Number, noise and seed of the replicates of every case."""

    def record(self) -> dict[str, Any]:
        """Everything that numbers depend on except the cases, for JSON."""
        return {
            "program": f"spineline {self.version}",
            "build": self.build,
            "options": sorted(without_folders(self.words)),
            "option_files": sorted(self.option_files),
            "replicates": self.replicates,
        }


@dataclass(frozen=True)
class Task:
    """Some cases for a worker."""

    cases: tuple[CaseRead, ...]
    request: Request
    run: str
    """Absolute path of the folder of the run."""
    asking: str
    """Absolute path of a folder for unfinished files, which exists while a caller waits for the part."""

    @property
    def name(self) -> str:
        """Beginning of the names of its files: a hash of build, options and their files, replicates and the bytes of its cases."""
        cases = [(os.path.basename(case.path), case.identity) for case in self.cases]
        return f"part-{digest_of([self.request.record(), cases])[:24]}"


@dataclass(frozen=True)
class Part:
    """The answer of a task: a small row, whatever the size of its cases.

    Examples
    --------
    >>> import spineline as sl
    >>> path = sl.phantom("rod", subject=1).save("case.json", overwrite=True)
    >>> [part] = sl.Cohort([path]).analyze(out="results", progress=False).parts
    >>> part.cases, part.failed, part.rows["cases"]
    (1, 0, 1)
    """

    name: str
    """Beginning of the names of its files: a hash of build, options and their files, replicates and the bytes of its cases."""
    cases: int
    """Number of its cases."""
    failed: int
    """Cases without a result."""
    was_there: bool
    """Whether an earlier run had made it."""
    rows: Mapping[str, int] = field(default_factory=dict, hash=False)
    """Rows of every table."""
    redone: str | None = None
    """Why it was made again although an earlier run had made it, such as a missing table; else None."""


class _NotWholeError(Exception):
    """A part that was changed or has lost a file."""


def digest_of(value: Any) -> str:
    """SHA-256 of a value as JSON."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


def analyze_part(task: Task) -> Part:
    """A task of :meth:`Cohort.analyze`: analyses cases and writes their tables.

    Raises
    ------
    InputError
        If this worker has another version of Spineline than the request, or the file of an option has changed.
    OSError
        If a file cannot be written.
    RuntimeError
        If a case file has changed since the request, or no caller waits for the part.
    """
    from . import __version__

    request, name, folder = task.request, task.name, Path(task.run)
    if (request.version, request.build) != (__version__, build_identity()):
        raise InputError(
            f"a worker has Spineline {__version__} (build {build_identity()[:12]}), and the request is from "
            f"{request.version} (build {request.build[:12]})",
            help="install the same version on every worker",
        )
    redone = None
    try:
        kept = _whole_tables(folder, name, len(task.cases))
    except _NotWholeError as error:
        kept, redone = None, str(error)
    if kept is not None:
        record, _ = kept
        return _part(record, was_there=True)
    kept = _of_another_run(folder, name, len(task.cases))
    if kept is not None:
        _write(task, *kept)
        return _part(kept[0], was_there=True, redone=redone)
    cases = [(case.path, case.identity) for case in task.cases]
    made, failed = _native.analyze_paths(
        cases, request.words, request.replicates, request.option_files, request.build, task.asking
    )
    tables = {table: content for table, _, content in made}
    record = {
        "name": name,
        "cases": len(cases),
        "failed": failed,
        "tables": {
            table: {"rows": rows, "sha256": hashlib.sha256(content).hexdigest()}
            for table, rows, content in made
        },
    }
    record["sha256"] = digest_of(record)
    _write(task, record, tables)
    return _part(record, was_there=False, redone=redone)


def table_file(run: Path, table: str, part: str) -> Path:
    """The file of a table of a part."""
    return run / table / f"{part}.parquet"


def _part(record: dict[str, Any], *, was_there: bool, redone: str | None = None) -> Part:
    rows = {table: one["rows"] for table, one in record["tables"].items()}
    return Part(record["name"], record["cases"], record["failed"], was_there, rows, redone)


def _whole_tables(
    run: Path, name: str, cases: int
) -> tuple[dict[str, Any], dict[str, bytes]] | None:
    """The record and the tables of an unchanged part; None if it was not made yet.

    Raises
    ------
    _NotWholeError
        If it was changed or has lost a file.
    """
    path = run / _RECORDS / f"{name}.json"
    try:
        record = json.loads(path.read_bytes())
        facts = {key: value for key, value in record.items() if key != "sha256"}
        is_its_own = record["name"] == name and record["cases"] == cases
        if not is_its_own or digest_of(facts) != record["sha256"]:
            raise _NotWholeError(f"{_RECORDS}/{path.name} has changed")
    except FileNotFoundError:
        return None
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        raise _NotWholeError(f"{_RECORDS}/{path.name} has changed") from None
    tables = {}
    for table, one in record["tables"].items():
        try:
            content = table_file(run, table, name).read_bytes()
        except OSError:
            raise _NotWholeError(f"{table}/{name}.parquet is missing") from None
        if hashlib.sha256(content).hexdigest() != one["sha256"]:
            raise _NotWholeError(f"{table}/{name}.parquet has changed")
        tables[table] = content
    return record, tables


def _of_another_run(
    run: Path, name: str, cases: int
) -> tuple[dict[str, Any], dict[str, bytes]] | None:
    """The same part from another run in the same folder, if it is intact."""
    for record in sorted(run.parent.glob(f"run-*/{_RECORDS}/{name}.json")):
        other = record.parent.parent
        try:
            found = _whole_tables(other, name, cases) if other != run else None
        except _NotWholeError:
            continue
        if found is not None:
            return found
    return None


def _write(task: Task, record: dict[str, Any], tables: Mapping[str, bytes]) -> None:
    """Writes tables, and their record last: a part without one is made again."""
    run, unfinished = Path(task.run), Path(task.asking)
    name = record["name"]
    for table, content in tables.items():
        (run / table).mkdir(exist_ok=True)
        write_whole(table_file(run, table, name), content, unfinished)
    (run / _RECORDS).mkdir(exist_ok=True)
    write_whole(run / _RECORDS / f"{name}.json", json.dumps(record, indent=1).encode(), unfinished)
