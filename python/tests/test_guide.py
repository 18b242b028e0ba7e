"""Every Python example of the guide, run as a reader would: from top to bottom, in one folder."""

from __future__ import annotations

import doctest
import os
import re
from pathlib import Path

import pytest

import spineline as sl

ROOT = Path(__file__).resolve().parents[2]


def examples(page: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["docs/guide/src/python.md", "python/README.md", "docs/paper/paper.md"])
def test_every_example_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("matplotlib").use("agg")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    found = examples(ROOT / page)
    assert found
    for number, text in enumerate(found):
        exec(compile(text, f"{page}, example {number + 1}", "exec"), names)
    assert os.getcwd() == str(tmp_path)


def test_the_example_of_the_package_runs() -> None:
    assert doctest.testmod(sl).attempted > 0 and doctest.testmod(sl).failed == 0
