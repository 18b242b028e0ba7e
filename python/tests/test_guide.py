"""Every Python example of the guide, run as a reader would: from top to bottom, in one folder."""

from __future__ import annotations

import doctest
import inspect
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


@pytest.mark.parametrize("name", [None, *(name for name in sl.__all__ if name != "__version__")])
def test_every_public_name_has_an_example_that_runs(
    name: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib").use("agg")
    monkeypatch.chdir(tmp_path)
    item = sl if name is None else getattr(sl, name)
    text = inspect.getdoc(item)
    assert text
    test = doctest.DocTestParser().get_doctest(text, {}, name or "spineline", None, None)
    assert test.examples
    assert doctest.DocTestRunner().run(test).failed == 0
