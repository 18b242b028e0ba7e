"""Many patients on any executor: paths in, Parquet out."""

from __future__ import annotations

import glob
import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._analysis import MethodOptions, as_words
from ._errors import InputError
from ._run import write_whole

if TYPE_CHECKING:
    import pyarrow
    from typing_extensions import Unpack

_Words = list[tuple[str, str]]
"""Options of the method as words."""
_Asked = tuple[int, str, int] | None
"""Number, noise and seed of the replicates of every case."""
_DONE = "done"
"""Folder of the small rows of finished parts: written last, so that a part without one is made again."""


@dataclass(frozen=True)
class Part:
    """What a task gives back: a small row, whatever the size of its cases."""

    name: str
    """Beginning of the names of its files: a hash of program, options, replicates and the bytes of its cases."""
    cases: int
    """Number of its cases."""
    failed: int
    """Cases without a result."""
    was_there: bool
    """Whether an earlier run had made it."""


@dataclass(frozen=True)
class CohortRun:
    """What :meth:`Cohort.analyze` has made."""

    folder: Path
    """Where the Parquet files are: ``TABLE/PART.parquet``."""
    parts: tuple[Part, ...]
    """All parts, in the order of the cases."""
    lost: tuple[tuple[tuple[str, ...], str], ...]
    """Paths of tasks that ended without an answer, such as those of a killed worker, and why; another run repeats them."""

    @property
    def is_complete(self) -> bool:
        """Whether every case has a row."""
        return not self.lost

    def read(self, table: str) -> pyarrow.Table:
        """One table over all parts, such as ``"cases"`` or ``"vertebrae"``. Needs pyarrow.

        Raises
        ------
        InputError
            If there is no such table.
        """
        import pyarrow
        import pyarrow.parquet

        files = [self.folder / table / f"{part.name}.parquet" for part in self.parts]
        found = [pyarrow.parquet.read_table(file) for file in files if file.exists()]
        if not found:
            names = sorted(entry.name for entry in self.folder.iterdir() if entry.is_dir() and entry.name != _DONE)
            meant = _native.did_you_mean(table, names)
            raise InputError(
                f"there is no table `{table}`{meant}", help=f"give one of {', '.join(names)}"
            )
        return pyarrow.concat_tables(found)


class Cohort(Sequence[Path]):
    """Case files of many patients."""

    __slots__ = ("_paths",)

    def __init__(self, paths: Iterable[str | os.PathLike[str]]) -> None:
        self._paths = tuple(Path(path) for path in paths)
        if not self._paths:
            raise InputError("the cohort has no case file", help="check the pattern")

    @classmethod
    def glob(cls, pattern: str) -> Cohort:
        """The case files of a pattern such as ``"cases/*/case.json"``, in the order of their names.

        True values of phantoms (``*.truth.json``) are passed over.

        Raises
        ------
        InputError
            If there is none.
        """
        found = sorted(glob.glob(pattern, recursive=True))
        return cls(path for path in found if not path.endswith(".truth.json"))

    def __len__(self) -> int:
        return len(self._paths)

    def __getitem__(self, index: Any) -> Any:
        found = self._paths[index]
        return Cohort(found) if isinstance(index, slice) else found

    def __iter__(self) -> Iterator[Path]:
        return iter(self._paths)

    def analyze(
        self,
        *,
        out: str | os.PathLike[str],
        executor: Executor | None = None,
        chunk: int = 50,
        replicates: int | None = None,
        noise: float | str = "measured",
        seed: int = 1,
        **options: Unpack[MethodOptions],
    ) -> CohortRun:
        """Analyses all cases, as many at once as the executor has workers, and writes the tables as Parquet.

        A task reads and analyses ``chunk`` cases, and writes one Parquet file per table, whole or not at all, named by a
        hash of program, options, replicates and the bytes of its cases: another run with the same cases and options makes
        only what is missing. A case that cannot be analysed is a row of the table ``cases`` with its status and error.

        Parameters
        ----------
        out
            Folder, made where it is missing; for workers on other machines, on a file system that they share.
        executor
            Any ``concurrent.futures.Executor``: a thread or process pool, Dask's ``client.get_executor()``, executorlib. By
            default threads, one per core. Dask waits for ever for a scheduler that was killed: interrupt the call, and
            run it again on another cluster.
        chunk
            Cases of a task: so many that it takes 10 to 60 s on a cluster; with 1000 replicates, a few.
        replicates
            Number of Monte Carlo replicates of every case, computed by the workers, one thread each: then there is a table
            ``uncertainty``, with the rows of ``spineline analyze --replicates``. By default none.
        noise, seed
            Of the replicates, as of :func:`replicates`. The noise of a case depends on the seed and its identifier, and not
            on its place in the cohort.
        **options
            Options of the method, as of :func:`analyze`.

        Raises
        ------
        InputError
            If an option is unknown, replicates or noise are out of range, or a worker has another version of Spineline.
        OSError
            If a file cannot be written, such as on a full disk; what is there is whole.
        """
        from . import __version__

        if chunk < 1:
            raise InputError(f"chunk is {chunk}", help="give 1 or more", value=float(chunk), limit=1.0)
        words = as_words(dict(options))
        asked = None if replicates is None else (replicates, str(noise), seed)
        _native.check_options(words, asked)
        folder = Path(out)
        folder.mkdir(parents=True, exist_ok=True)
        paths = [str(path) for path in self._paths]
        chunks = [tuple(paths[at : at + chunk]) for at in range(0, len(paths), chunk)]
        if executor is None:
            with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
                return _collect(pool, chunks, (words, asked, str(folder), __version__))
        return _collect(executor, chunks, (words, asked, str(folder), __version__))


def _collect(
    executor: Executor, chunks: list[tuple[str, ...]], asked: tuple[_Words, _Asked, str, str]
) -> CohortRun:
    """Runs all chunks; one that is lost with its worker is noted, other errors are raised."""
    tasks: dict[Future[Part], int] = {}
    lost: dict[int, str] = {}
    done: dict[int, Part] = {}
    for number, paths in enumerate(chunks):
        try:
            task = executor.submit(analyze_chunk, paths, *asked)
        except RuntimeError as error:
            # A pool whose process was killed takes no more tasks.
            lost[number] = str(error)
            continue
        tasks[task] = number
    try:
        for task in as_completed(tasks):
            if task.cancelled():
                lost[tasks[task]] = "the cluster cancelled it"
                continue
            fault = task.exception()
            is_of_files = isinstance(fault, OSError) and not isinstance(fault, ConnectionError)
            if fault is not None and (is_of_files or isinstance(fault, InputError)):
                raise fault
            if fault is not None:
                lost[tasks[task]] = f"{type(fault).__name__}: {fault}"
            else:
                done[tasks[task]] = task.result()
    except BaseException:
        for task in tasks:
            task.cancel()
        raise
    parts = tuple(done[number] for number in sorted(done))
    return CohortRun(Path(asked[2]), parts, tuple((chunks[n], lost[n]) for n in sorted(lost)))


def analyze_chunk(
    paths: Sequence[str], words: _Words, replicates: _Asked, out: str, version: str
) -> Part:
    """A task of :meth:`Cohort.analyze`: analyses cases and writes their tables.

    Raises
    ------
    InputError
        If this worker has another version of Spineline than who asks.
    OSError
        If a file cannot be written.
    """
    from . import __version__

    if version != __version__:
        raise InputError(
            f"a worker has Spineline {__version__}, and {version} asks it",
            help="install the same version on every worker",
        )
    digest = hashlib.sha256(json.dumps([version, sorted(words), replicates]).encode())
    for path in paths:
        try:
            content = Path(path).read_bytes()
        except OSError:
            content = b""
        digest.update(json.dumps([Path(path).name, len(content)]).encode())
        digest.update(content)
    name = f"part-{digest.hexdigest()[:24]}"
    folder = Path(out)
    done = folder / _DONE / f"{name}.json"
    if done.exists():
        return Part(**{**json.loads(done.read_text()), "was_there": True})
    tables, failed = _native.analyze_paths(list(paths), words, replicates)
    for table, content in tables:
        (folder / table).mkdir(exist_ok=True)
        write_whole(folder / table / f"{name}.parquet", content)
    part = Part(name, len(paths), failed, was_there=False)
    (folder / _DONE).mkdir(exist_ok=True)
    write_whole(done, json.dumps(asdict(part)).encode())
    return part
