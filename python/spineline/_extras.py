"""Packages that only some functions need."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal

_PACKAGES = {
    "pandas": "pandas pyarrow",
    "polars": "polars",
    "plot": "matplotlib",
    "model3d": "plotly",
    "xarray": "xarray pandas pyarrow",
}
"""What the extras of the package install."""


@contextmanager
def extra(name: Literal["pandas", "polars", "plot", "model3d", "xarray"]) -> Iterator[None]:
    """Imports within it need an extra.

    Raises
    ------
    ModuleNotFoundError
        If a package is missing; the message has the command that installs it.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        text = f"{error.name} is missing (the extra `{name}`): pip install {_PACKAGES[name]}"
        raise ModuleNotFoundError(text, name=error.name) from error
