"""Progress of long calls."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Union

Progress = Union[bool, Callable[[int, int], None], None]
"""Whether a line on standard error counts finished parts, by default if it is a terminal; or a function, which is called with the
number of finished parts and of all parts."""


def shown(progress: Progress, counted: str) -> Callable[[int, int], None]:
    """The function that shows how many of these parts are finished."""
    if callable(progress):
        return progress
    stream = sys.stderr
    if stream is None or not (stream.isatty() if progress is None else progress):
        return lambda done, total: None

    def show(done: int, total: int) -> None:
        end = "\n" if done == total else ""
        stream.write(f"\ranalysed {done} of {total} {counted}{end}")
        stream.flush()

    return show
