"""The wheel of the package ``spineline``, which is in no public index: anything of that name there is another program.

Nothing here needs Slicer or the package.
"""

from __future__ import annotations

import zipfile
from pathlib import Path


def wheel_fault(path: str) -> str | None:
    """Why a file is not a wheel of Spineline, and what to do; None where it is a wheel."""
    name = Path(path).name
    if not (name.startswith("spineline-") and name.endswith(".whl")):
        return f"`{name}` is not a wheel of Spineline: choose a file `spineline-….whl`, which `cargo xtask wheel` builds"
    try:
        with zipfile.ZipFile(path) as wheel:
            members = wheel.namelist()
    except (OSError, zipfile.BadZipFile) as error:
        return f"`{name}` cannot be read ({error}): copy or build it again"
    if any(member.startswith("spineline/_native.") for member in members):
        return None
    return f"`{name}` has no native module of Spineline: build it with `cargo xtask wheel`"


def install_arguments(path: str) -> list[str]:
    """Arguments of ``pip install`` for a wheel: no index is asked, since Slicer has numpy, the only dependency."""
    return ["--no-index", path]
