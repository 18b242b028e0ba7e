"""The examples of the guide, each in its engine: each compares a film in the engine with Spineline's own shape."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

from cases import FORMATS, Spineline

PAGE = Path(__file__).resolve().parents[2] / "docs/guide/src/engines.md"


def run(spineline: Spineline) -> None:
    """Runs every Python example of the page on a model of a phantom, in the folder of the results."""
    spineline.run("phantom", "--scenario", "rod", "--subject", "1", "--out", "phantoms")
    spineline.run("analyze", "phantoms/phantom-rod-01.json", "--model", "model.json", codes=(0, 4))
    for form in FORMATS:
        spineline.run("export", "model.json", "--to", form, "--out", f"model.{form}")
    spineline.run("export", "model.json", "--to", "sto", "--out", "films.sto")
    spineline.run("export", "model.json", "--to", "loads", "--out", "films.loads.xml")
    spineline.run("simulate", "model.json", "--posture", "left_bending", "--json", "film.json")
    os.chdir(spineline.folder)
    examples = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
    for number, text in enumerate(examples, start=1):
        began = time.perf_counter()
        exec(compile(text, f"{PAGE.name}, example {number}", "exec"), {})
        print(f"{PAGE.name}, example {number}: {time.perf_counter() - began:.1f} s")
