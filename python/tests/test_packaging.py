"""The article for a journal, the fields of a maintainer, and the recipes of packages."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAPER = (ROOT / "docs/paper/paper.md").read_text()
SECTIONS = [
    "Summary",
    "Statement of need",
    "State of the field",
    "Software design",
    "Research impact statement",
    "AI usage disclosure",
    "Acknowledgements",
    "References",
]
"""Sections that the Journal of Open Source Software asks for, in its order."""


def test_the_article_has_the_sections_length_and_figure_of_the_journal() -> None:
    text = PAPER.split("---\n", 2)[2]
    headings = re.findall(r"^# (.*)$", text, re.MULTILINE)
    assert [one for one in headings if one in SECTIONS] == SECTIONS
    assert 750 <= len(re.sub(r"```.*?```", "", text, flags=re.DOTALL).split()) <= 1750
    figures = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text)
    assert figures and all((ROOT / "docs/paper" / figure).is_file() for figure in figures)


def test_every_reference_of_the_article_has_a_doi() -> None:
    entries = re.findall(r"^@\w+\{([^,]+),\n(.*?)^\}", (ROOT / "docs/references.bib").read_text(), re.M | re.S)
    with_doi = {key for key, body in entries if re.search(r"^  doi +=", body, re.MULTILINE)}
    cited = set(re.findall(r"@([a-z0-9-]+)", PAPER.split("---\n", 2)[2]))
    assert cited and cited <= with_doi, cited - with_doi


@pytest.mark.skipif(sys.version_info < (3, 11), reason="tomllib")
def test_every_file_repeats_the_fields_of_the_maintainer() -> None:
    script = ROOT / "packaging/fields.py"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
