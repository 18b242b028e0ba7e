"""What the wheel brings beside the module: the program, with typeset reports."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

import spineline as sl


@pytest.mark.skipif("SPINELINE_PROGRAM" in os.environ, reason="the program is not that of the wheel")
def test_the_program_of_the_wheel_writes_pdf(program: Path, case: sl.Case, tmp_path: Path) -> None:
    file, report = tmp_path / "case.json", tmp_path / "report.pdf"
    file.write_text(case.to_json())
    subprocess.run([program, "report", file, "--to", "pdf", "--out", report], check=True, capture_output=True)
    assert report.read_bytes().startswith(b"%PDF-")
