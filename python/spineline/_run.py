"""How files record a call from Python, and how they are written."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from datetime import datetime, timezone
from functools import cache
from pathlib import Path
from typing import Any
from uuid import uuid4

from . import _native
from ._errors import InputError


@cache
def build_identity() -> str:
    """SHA-256 of the sources of the native module and of this package: it changes with the code, even within a version."""
    digest = hashlib.sha256(_native.BUILD.encode())
    for file in sorted(Path(__file__).parent.glob("*.py")):
        content = file.read_bytes()
        digest.update(f"\0{file.name}\0{len(content)}\0".encode())
        digest.update(content)
    return digest.hexdigest()


def now_utc() -> str:
    """The time of this call as RFC 3339, or the one that ``SOURCE_DATE_EPOCH`` names."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        moment = (
            datetime.now(timezone.utc)
            if given is None
            else datetime.fromtimestamp(int(given), timezone.utc)
        )
    except (ValueError, OverflowError, OSError):
        raise InputError(
            f"SOURCE_DATE_EPOCH is `{given}`", help="give whole seconds since 1970"
        ) from None
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def command(function: str, options: Iterable[tuple[str, Any]]) -> list[str]:
    """The words that record a call in place of the program's command line."""
    return [f"spineline.{function}", *(f"{name}={value}" for name, value in options)]


def without_folders(words: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Options with the names of files in place of their paths, which differ from machine to machine and may contain names of persons."""
    return [(name, os.path.basename(value) if _native.names_a_file(name, value) else value) for name, value in words]


def write_whole(
    path: str | os.PathLike[str], data: bytes, unfinished: Path | None = None
) -> Path:
    """Writes a file whole or not at all, over an existing one.

    Parameters
    ----------
    path, data
        The file and its bytes.
    unfinished
        Folder on the same file system for the unfinished file; by default the folder of the file.

    Raises
    ------
    OSError
        If it cannot be written; then an existing file stays as it is.
    """
    target = Path(path)
    part = (unfinished or target.parent) / f".{target.name}.{uuid4().hex}.part"
    try:
        with part.open("xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, target)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
    return target
