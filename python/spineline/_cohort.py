"""Many patients on any executor: paths in, Parquet out."""

from __future__ import annotations

import glob
import json
import logging
import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from . import _native
from ._errors import InputError
from ._extras import extra
from ._html import html_table
from ._method import MethodOptions, as_words
from ._parts import CaseRead, Part, Request, Task, analyze_part, digest_of, table_file
from ._progress import Progress, shown
from ._run import build_identity, write_whole
from ._values import LARGEST_SEED, MOST, whole

if TYPE_CHECKING:
    import pyarrow
    from typing_extensions import Unpack

_SHOWN = 10
"""Files in a notebook."""

_LIST = "manifest.json"
"""File in the folder of a run that lists its inputs and its parts."""


@dataclass(frozen=True)
class CohortRun:
    """The result of :meth:`Cohort.analyze`.

    Examples
    --------
    >>> import spineline as sl
    >>> path = sl.phantom("rod", subject=1).save("case.json", overwrite=True)
    >>> run = sl.Cohort([path]).analyze(out="results", progress=False)
    >>> run.is_complete, run.parts[0].cases
    (True, 1)
    """

    folder: Path
    """Folder of this run alone, in the given one: ``TABLE/PART.parquet``, so that ``folder / "vertebrae"`` is one data
    set, and ``manifest.json``, which lists the inputs of the run and its parts."""
    parts: tuple[Part, ...]
    """All parts, in the order of the cases."""
    lost: tuple[tuple[tuple[str, ...], str], ...]
    """Paths of tasks that ended without an answer, for example on a killed worker, and why; another run repeats them."""

    @property
    def is_complete(self) -> bool:
        """Whether every case has a row."""
        return not self.lost

    @property
    def redone(self) -> tuple[str, ...]:
        """Why parts of an earlier run were made again, such as a missing table; empty if all were intact."""
        return tuple(part.redone for part in self.parts if part.redone is not None)

    def read(self, table: str) -> pyarrow.Table:
        """One table over all parts, such as ``"cases"`` or ``"vertebrae"``. Needs pyarrow.

        Raises
        ------
        InputError
            If the table is unknown, one of its files is missing or has lost rows, or all parts were lost.
        """
        with extra("pandas"):
            import pyarrow
            import pyarrow.parquet
        names = sorted({name for part in self.parts for name in part.rows})
        if not names:
            raise InputError("the run has no finished part", help="see `lost` for the reasons, and run the cohort again")
        if table not in names:
            meant = _native.did_you_mean(table, names)
            raise InputError(
                f"the table `{table}` is unknown{meant}", help=f"give one of {', '.join(names)}"
            )
        found = []
        for part in self.parts:
            if table not in part.rows:
                continue
            file = table_file(self.folder, table, part.name)
            one = pyarrow.parquet.read_table(file) if file.exists() else None
            if one is None or len(one) != part.rows[table]:
                raise InputError(
                    f"{file} is missing, or does not have its {part.rows[table]} rows",
                    help="run the cohort again: it makes only what is missing",
                    file=str(file),
                )
            found.append(one)
        return pyarrow.concat_tables(found)


class Cohort(Sequence[Path]):
    """Case files of many patients.

    Parameters
    ----------
    paths
        Paths of the case files, in a list or another iterable.

    Raises
    ------
    InputError
        If paths are missing, or one path is given in place of a list.

    Examples
    --------
    >>> import spineline as sl
    >>> paths = [sl.phantom("rod", subject=n).save(f"rod-{n}.json", overwrite=True) for n in (1, 2)]
    >>> len(sl.Cohort.glob("rod-*.json"))
    2
    """

    __slots__ = ("_paths",)

    def __init__(self, paths: Iterable[str | os.PathLike[str]]) -> None:
        if isinstance(paths, (str, bytes, os.PathLike)):
            raise InputError(
                f"a cohort is made from a list of paths, not of one: {os.fsdecode(paths)}",
                help="give `[path]`, or a pattern to `Cohort.glob`",
            )
        self._paths = tuple(Path(path) for path in paths)
        if not self._paths:
            raise InputError("the cohort has no case file", help="check the pattern")

    @classmethod
    def glob(cls, pattern: str | os.PathLike[str]) -> Cohort:
        """The case files of a pattern such as ``"cases/*/case.json"``, in the order of their names.

        True values of phantoms (``*.truth.json``) are skipped.

        Raises
        ------
        InputError
            If no file matches.
        """
        found = sorted(glob.glob(os.fspath(pattern), recursive=True))
        return cls(path for path in found if not path.endswith(".truth.json"))

    def __len__(self) -> int:
        return len(self._paths)

    def __getitem__(self, index: Any) -> Any:
        found = self._paths[index]
        return Cohort(found) if isinstance(index, slice) else found

    def __iter__(self) -> Iterator[Path]:
        return iter(self._paths)

    def _repr_html_(self) -> str:
        more = f", the first {_SHOWN} here" if len(self) > _SHOWN else ""
        rows = [(path.name,) for path in self._paths[:_SHOWN]]
        return html_table(f"Cohort of {len(self)} case files{more}", ("file",), rows)

    def analyze(
        self,
        *,
        out: str | os.PathLike[str],
        executor: Executor | None = None,
        chunk: int = 50,
        replicates: int | None = None,
        noise: float | str = "measured",
        seed: int = 1,
        progress: Progress = None,
        **options: Unpack[MethodOptions],
    ) -> CohortRun:
        """Analyses all cases in parallel on the workers of the executor, and writes the tables as Parquet.

        Each run has its own folder in ``out``, named by a hash of all inputs: the code of Spineline, options and the bytes of the
        files that they name, replicates, and the bytes of the cases. A task reads and analyses ``chunk`` cases, and writes one
        Parquet file per table, whole or not at all. Another run makes only parts that no earlier run in ``out`` has made, or whose
        tables are missing or changed; :attr:`CohortRun.redone` says why. A case that cannot be analysed is a row of the table
        ``cases`` with its status and error.

        Ctrl-C ends the call within a second; workers stop at the end of their step. Another run continues from there.

        Parameters
        ----------
        out
            Folder, made if it is missing. Workers on other machines need a shared file system.
        executor
            Any ``concurrent.futures.Executor``: a thread or process pool, Dask's ``client.get_executor()``, executorlib. By
            default threads, one per core. Dask waits without end for a killed scheduler: interrupt the call, and
            run it again on another cluster.
        chunk
            Cases per task: a task should take 10 to 60 s on a cluster; with 1000 replicates, a few cases.
        replicates
            Number of Monte Carlo replicates of every case, computed by the workers, one thread each. They add the table
            ``uncertainty``, with the rows of ``spineline analyze --replicates``. By default none.
        noise, seed
            As in :func:`replicates`, for replicates only. The noise of a case depends on the seed and its identifier, and not on its
            place in the cohort.
        progress
            Whether a line on standard error counts the finished cases; by default if it is a terminal. Or a function, which is
            called with the number of finished cases and of all cases.
        **options
            Options of the method: see :class:`MethodOptions`. Identifiability is computed for one case alone, by :func:`analyze`.

        Raises
        ------
        InputError
            If an option is unknown, replicates or noise are out of range, two cases show one patient, a worker has
            another version of Spineline, or the file of an option changes meanwhile.
        OSError
            If a file cannot be written, such as on a full disk; existing files are whole.
        """
        if "identifiability" in options:
            raise InputError(
                "a cohort does not compute `identifiability`",
                help="analyse a case alone with `spineline.analyze(case, identifiability=True)`, or use "
                "`spineline analyze FOLDER --tables OUT --identifiability`",
            )
        chunk = whole("chunk", chunk, 1, MOST)
        if replicates is None and (str(noise), seed) != ("measured", 1):
            help = "give the number of replicates too, or leave them out"
            raise InputError("`noise` and `seed` are for `replicates`", help=help)
        count = None if replicates is None else whole("replicates", replicates, 2, MOST)
        asked = None if count is None else (count, str(noise), whole("seed", seed, 0, LARGEST_SEED))
        request = _request(as_words(dict(options)), asked)
        paths = [os.path.abspath(path) for path in self._paths]
        identities = _native.identify_cases(paths)
        cases = [CaseRead(path, identity) for path, identity in zip(paths, identities, strict=True)]
        with _Run(os.path.abspath(out), request, cases, chunk) as run:
            if executor is not None:
                return run.collect(executor, shown(progress, "cases"))
            with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
                return run.collect(pool, shown(progress, "cases"))


def _request(words: list[tuple[str, str]], asked: tuple[int, str, int] | None) -> Request:
    """The request for every case, with absolute paths: a worker may have another working directory."""
    from . import __version__

    words = [
        (name, os.path.abspath(value) if _native.names_a_file(name, value) else value)
        for name, value in words
    ]
    option_files = _native.check_options(words, asked)
    return Request(__version__, build_identity(), words, option_files, asked)


class _Run:
    """A run of a cohort in its folder; leaving the context stops its workers."""

    def __init__(self, out: str, request: Request, cases: Sequence[CaseRead], chunk: int) -> None:
        chunks = [tuple(cases[at : at + chunk]) for at in range(0, len(cases), chunk)]
        # The name of a part depends on the request and its cases alone.
        names = [Task(of, request, "", "").name for of in chunks]
        self.folder = Path(out) / f"run-{digest_of(names)[:16]}"
        self.asking = self.folder / f".asking-{uuid4().hex}"
        self.request = request
        self.cases = len(cases)
        self.tasks = [Task(of, request, str(self.folder), str(self.asking)) for of in chunks]

    def __enter__(self) -> _Run:
        self.asking.mkdir(parents=True)
        return self

    def __exit__(self, *_: object) -> None:
        # Renamed at once: workers look for it and write into it.
        ended = self.asking.with_name(f"{self.asking.name}.ended")
        try:
            self.asking.rename(ended)
        except OSError:
            # It is gone, or an open file of a worker keeps it on this system.
            ended = self.asking
        shutil.rmtree(ended, ignore_errors=True)

    def collect(self, executor: Executor, progress: Callable[[int, int], None]) -> CohortRun:
        """Runs all tasks; notes a task that is lost with its worker, and raises other errors."""
        self._write_list({}, {})
        done: dict[int, Part] = {}
        lost: dict[int, str] = {}
        tasks: dict[Future[Part], int] = {}
        finished = 0
        try:
            for number, task in enumerate(self.tasks):
                try:
                    tasks[executor.submit(analyze_part, task)] = number
                except RuntimeError as error:
                    # A pool with a killed process takes no more tasks.
                    lost[number] = str(error)
            progress(0, self.cases)
            for future in as_completed(tasks):
                number = tasks[future]
                why = _loss(future)
                if why is None:
                    done[number] = future.result()
                    finished += done[number].cases
                    progress(finished, self.cases)
                else:
                    lost[number] = why
        except BaseException:
            # Workers stop where the folder is gone.
            self.__exit__()
            for future in tasks:
                future.cancel()
            raise
        self._write_list(done, lost)
        parts = tuple(done[number] for number in sorted(done))
        found = CohortRun(self.folder, parts, tuple((self._paths(n), lost[n]) for n in sorted(lost)))
        for why in found.redone:
            logging.getLogger("spineline").warning("a part was made again: %s", why)
        return found

    def _paths(self, number: int) -> tuple[str, ...]:
        return tuple(case.path for case in self.tasks[number].cases)

    def _write_list(self, done: dict[int, Part], lost: dict[int, str]) -> None:
        """Writes the inputs and the parts so far; file names without folders, which may contain names of persons."""
        cases = [
            {"file": os.path.basename(one.path), "sha256": one.sha256} for task in self.tasks for one in task.cases
        ]
        content = {
            "format": "spineline-cohort-run",
            "version": 1,
            **self.request.record(),
            "cases": cases,
            "complete": len(done) == len(self.tasks),
            "parts": [
                {"name": done[n].name, "cases": done[n].cases, "failed": done[n].failed, "rows": dict(done[n].rows)}
                for n in sorted(done)
            ],
            "lost": [
                {"files": [os.path.basename(path) for path in self._paths(n)], "why": lost[n]}
                for n in sorted(lost)
            ],
        }
        text = json.dumps(content, indent=1, ensure_ascii=False)
        write_whole(self.folder / _LIST, text.encode(), self.asking)


def _loss(task: Future[Part]) -> str | None:
    """Why a finished task has no answer; None if it has an answer.

    Raises
    ------
    InputError, OSError
        If the task raised it: other tasks would raise it too.
    """
    if task.cancelled():
        return "the cluster cancelled it"
    fault = task.exception()
    is_of_files = isinstance(fault, OSError) and not isinstance(fault, ConnectionError)
    if fault is not None and (is_of_files or isinstance(fault, InputError)):
        raise fault
    return None if fault is None else f"{type(fault).__name__}: {fault}"
