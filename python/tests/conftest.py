"""Fixtures: a synthetic patient, its analysis, and the program."""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest

import spineline as sl


@pytest.fixture(scope="session")
def case() -> sl.Case:
    """A synthetic patient with five films."""
    return sl.phantom("rod", subject=1)


@pytest.fixture(scope="session")
def analysis(case: sl.Case) -> sl.Analysis:
    """Its analysis."""
    return sl.analyze(case)


@pytest.fixture(scope="session")
def program() -> Path:
    """The program of the wheel, or the one that SPINELINE_PROGRAM names."""
    given = os.environ.get("SPINELINE_PROGRAM")
    installed = Path(sysconfig.get_path("scripts")) / ("spineline.exe" if os.name == "nt" else "spineline")
    found = given or (str(installed) if installed.exists() else shutil.which("spineline"))
    if found is None:
        pytest.skip("no program `spineline`")
    return Path(found)


@pytest.fixture(scope="session")
def folder_of_cases(program: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Case files of 18 synthetic patients, which the program wrote."""
    folder = tmp_path_factory.mktemp("cases")
    subprocess.run([program, "phantom", "--scenario", "rod", "--out", folder], check=True, capture_output=True)
    return folder
