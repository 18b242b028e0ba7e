"""Results that have a file."""

from __future__ import annotations

import errno
import hashlib
import os
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from ._errors import InputError
from ._run import write_whole

if TYPE_CHECKING:
    from typing_extensions import Self


class _Native(Protocol):
    """A native object with the text of its file."""

    @property
    def sources(self) -> list[str]: ...
    def to_json(self) -> str: ...


_N = TypeVar("_N", bound=_Native)
_E = TypeVar("_E", bound="_Exportable[Any]")


class _Exportable(Generic[_N]):
    """An object that does not change and has a file. Pickle keeps the file and the hashes of its inputs, equality compares files, and a
    copy is the object itself.
    """

    __slots__ = ("_native",)

    def __init__(self, native: _N) -> None:
        self._native = native

    def to_json(self) -> str:
        """The text of its file (``spineline schema`` explains every key)."""
        return self._native.to_json()

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes its file, whole or not at all; returns the path.

        Raises
        ------
        FileExistsError
            If the file exists and ``overwrite`` was not given.
        InputError
            If the file is one that this object was made from, such as the case, landmarks or a picture; also with ``overwrite``.
        OSError
            If it cannot be written.
        """
        return export(path, self.to_json(), overwrite=overwrite, sources=self._native.sources)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and self._native == other._native

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return (with_native, (type(self), self._native))

    def __deepcopy__(self, memo: object) -> Self:
        return self

    def __copy__(self) -> Self:
        return self


def with_native(kind: type[_E], native: Any) -> _E:
    """The object of this class with a native object."""
    made = kind.__new__(kind)
    made._native = native
    return made


def export(path: str | os.PathLike[str], text: str, *, overwrite: bool, sources: Collection[str]) -> Path:
    """Writes a text whole or not at all; returns the path.

    Raises
    ------
    FileExistsError, InputError, OSError
        As :func:`export_all`.
    """
    files = {Path(path).name: text.encode()}
    [written] = export_all(Path(path).parent, files, overwrite=overwrite, sources=sources)
    return written


def export_all(
    folder: str | os.PathLike[str], files: dict[str, bytes], *, overwrite: bool, sources: Collection[str]
) -> list[Path]:
    """Writes files into a folder, each whole or not at all; returns their paths.

    Parameters
    ----------
    folder, files, overwrite
        Folder, contents by name, and whether files that exist are replaced.
    sources
        SHA-256 of files that are never replaced.

    Raises
    ------
    FileExistsError
        If one of the files exists and ``overwrite`` was not given; then no file is written.
    InputError
        If one of the files is a source; then no file is written.
    OSError
        If a file cannot be written.
    """
    paths = [Path(folder, name) for name in files]
    for path in paths:
        if not overwrite and os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, "the file exists; give `overwrite=True`", str(path))
        if sources and path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() in sources:
            raise InputError(
                f"{path} is not written: it is an input of this result, which would be destroyed",
                help="name another file",
                file=str(path),
            )
    return [write_whole(path, content) for path, content in zip(paths, files.values(), strict=True)]
