"""Values of options from callers: a wrong one is an :class:`InputError` that names option and value. Numbers and arrays of numpy become
plain ones.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any

from ._errors import InputError

_SHOWN = 60
"""Letters of a value in an error."""

LARGEST_SEED = 2**64 - 1
"""Largest seed."""

MOST = 10_000_000
"""Largest number of replicates, and of cases per task."""


def wrong(name: str, value: Any, help: str, *, limit: float | None = None) -> InputError:
    """The error for a value that an option does not take."""
    words = repr(value)
    words = words if len(words) <= _SHOWN else f"{words[:_SHOWN]}…"
    return InputError(f"`{name}` is {words}", help=help, value=_real(value), limit=limit)


def decoded(content: str | bytes) -> str:
    """The text of a file.

    Raises
    ------
    InputError
        If the bytes are not UTF-8.
    """
    try:
        return content.decode("utf-8-sig") if isinstance(content, bytes) else content
    except UnicodeDecodeError as error:
        raise InputError(f"the text is not UTF-8: byte {error.start + 1}", help="give the text of a file of Spineline") from None


def plain(value: Any) -> Any:
    """A number or an array of numpy as a number or a list; other values as they are."""
    return value.tolist() if hasattr(value, "tolist") else value


def real(name: str, value: Any) -> float:
    """A number, which may be NaN or infinite."""
    found = _real(value)
    if found is None:
        raise wrong(name, value, "give a number")
    return found


def number(name: str, value: Any, lowest: float = -math.inf, highest: float = math.inf) -> float:
    """A finite number in these limits."""
    found = _real(value)
    if found is None or not math.isfinite(found):
        raise wrong(name, value, "give a finite number")
    _check_limits(name, found, lowest, highest, f"give a number from {lowest:g} to {highest:g}")
    return found


def numbers(name: str, values: Any, count: int | None = None) -> list[float]:
    """Finite numbers."""
    found = _list(values)
    if found is None or count not in (None, len(found)):
        raise wrong(name, values, "give a list of numbers" if count is None else f"give {count} numbers")
    return [number(name, value) for value in found]


def whole(name: str, value: Any, lowest: int, highest: int) -> int:
    """A whole number in these limits."""
    found, help = plain(value), f"give a whole number from {lowest} to {highest}"
    if isinstance(found, bool) or not isinstance(found, int):
        raise wrong(name, value, help)
    _check_limits(name, found, lowest, highest, help)
    return found


def text(name: str, value: Any, help: str = "give a text") -> str:
    """A text."""
    if not isinstance(value, str):
        raise wrong(name, value, help)
    return value


def texts(name: str, values: Any) -> list[str]:
    """Texts."""
    found = _list(values)
    if found is None:
        raise wrong(name, values, "give a list of texts")
    return [text(name, value, "give a list of texts") for value in found]


def truth(name: str, value: Any) -> bool:
    """True or false."""
    found = plain(value)
    if not isinstance(found, bool):
        raise wrong(name, value, "give True or False")
    return found


def path(name: str, value: Any) -> str:
    """A path."""
    if not isinstance(value, (str, os.PathLike)):
        raise wrong(name, value, "give a path")
    return str(os.fspath(value))


def renamed(name: str, value: Any) -> dict[str, str]:
    """New names by old ones."""
    if not isinstance(value, Mapping):
        raise wrong(name, value, "give a mapping of texts")
    return dict(zip(texts(name, list(value)), texts(name, list(value.values())), strict=True))


def _check_limits(name: str, found: float, lowest: float, highest: float, help: str) -> None:
    """Refuses a number outside of its limits."""
    if not lowest <= found <= highest:
        raise wrong(name, found, help, limit=float(lowest if found < lowest else highest))


def _real(value: Any) -> float | None:
    """A real number; None for another value."""
    if isinstance(value, (str, bytes, bool)):
        return None
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return None


def _list(values: Any) -> list[Any] | None:
    """The values of a sequence; None for one text and for a value that is not a sequence."""
    found = plain(values)
    try:
        return None if isinstance(found, (str, bytes, Mapping)) else list(found)
    except TypeError:
        return None
