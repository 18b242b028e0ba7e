"""The article for a journal, the fields of a maintainer, and the recipes of packages."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path
from typing import Any

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


RECIPES = {
    name: (ROOT / "packaging" / name).read_text() for name in ("Dockerfile", "conda/recipe.yaml", "github/release.yml")
}


@pytest.fixture
def commands(program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in, with `spineline` and `python` on the path as after an installation."""
    programs = tmp_path / "bin"
    programs.mkdir()
    shutil.copy(program, programs / program.name)
    (programs / "python").symlink_to(sys.executable)
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def recipe(name: str) -> Any:
    yaml = pytest.importorskip("yaml")
    return yaml.safe_load(RECIPES[name])


@pytest.mark.skipif(sys.platform == "win32", reason="a shell")
def test_the_conda_package_passes_its_own_test(commands: Path) -> None:
    [script] = [test["script"] for test in recipe("conda/recipe.yaml")["tests"] if "script" in test]
    assert len(script) > 3
    for command in script:
        done = subprocess.run(command, shell=True, capture_output=True, text=True, cwd=commands)
        assert done.returncode == 0, f"{command}\n{done.stderr}"


@pytest.mark.skipif(sys.platform == "win32", reason="a shell")
def test_the_archive_has_program_pages_licences_and_notices(program: Path, commands: Path) -> None:
    script = ROOT / "packaging/archive.sh"
    subprocess.run(["bash", script, program, "spineline-x"], check=True, cwd=commands)
    with tarfile.open(commands / "spineline-x.tar.gz") as archive:
        names = {name.removeprefix("spineline-x/") for name in archive.getnames()}
        notices = archive.extractfile("spineline-x/NOTICES.txt")
        assert notices is not None and b"Bitstream Vera" in notices.read()
    assert {"LICENSE-MIT", "LICENSE-APACHE", "NOTICES.txt", "CITATION.cff", program.name} <= names
    assert {"man/spineline.1", "man/spineline-analyze.1", "completions/spineline.bash"} <= names


def test_the_commands_of_the_image_are_commands_of_the_program(commands: Path) -> None:
    text = RECIPES["Dockerfile"]
    calls = re.findall(r"^#   docker run .* spineline (.+)$", text, re.MULTILINE)
    calls += re.findall(r"`((?:account|serve) [^`]+)`", text)
    assert len(calls) == 4
    for call in calls:
        name, *words = shlex.split(call)
        done = subprocess.run(["spineline", name, "--help"], capture_output=True, text=True)
        known = done.stdout
        if words and re.search(rf"^  {words[0]}\b", known, re.MULTILINE):
            done = subprocess.run(["spineline", name, words[0], "--help"], capture_output=True, text=True)
            known = done.stdout
        assert done.returncode == 0, call
        assert all(word in known for word in words if word.startswith("--")), call


@pytest.mark.parametrize("name", list(RECIPES))
def test_a_recipe_calls_what_is_there(name: str) -> None:
    text = RECIPES[name]
    usage = (ROOT / "xtask/src/main.rs").read_text()
    for command in re.findall(r"cargo xtask (\w+)", text):
        assert f'"{command}"' in usage, command
    scripts = json.loads((ROOT / "web/package.json").read_text())["scripts"]
    assert all(script in scripts for script in re.findall(r"npm (?:--prefix web )?run (\w+)", text))
    manifest = (ROOT / "crates/spineline-cli/Cargo.toml").read_text()
    for features in re.findall(r"--features (\S+)", text):
        assert all(re.search(rf"^{one} = \[", manifest, re.MULTILINE) for one in features.split(",")), features
    for path in re.findall(r"packaging/[\w.]+\.(?:py|sh)", text):
        assert (ROOT / path).is_file(), path
    assert not re.search(r"node:?(?:js)?[ :-]+(?:version: )?(?:1\d|20)\b", text), "Node 20 gets no more updates"


def test_the_sources_that_the_image_copies_exist() -> None:
    copied = re.findall(r"^COPY (?!--from)(.+) \S+$", RECIPES["Dockerfile"], re.MULTILINE)
    assert copied
    for path in " ".join(copied).split():
        assert (ROOT / path).exists(), path
    assert "ca-certificates" in RECIPES["Dockerfile"].split("FROM ")[-1], "https needs certificates"


def test_every_action_is_pinned_and_the_release_is_checked_and_published() -> None:
    text = RECIPES["github/release.yml"]
    used = re.findall(r"uses: (\S+)", text)
    assert used and all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", one) for one in used)
    jobs = recipe("github/release.yml")["jobs"]
    assert {"checks", "build", "draft", "publish"} == set(jobs)
    steps = " ".join(step.get("run", "") for step in jobs["checks"]["steps"])
    assert "cargo xtask advisories --required" in steps and "fields.py --check --filled" in steps
    runners = [one["runner"].split("-")[0] for one in jobs["build"]["strategy"]["matrix"]["include"]]
    assert {"ubuntu", "macos", "windows"} == set(runners)
    linux = [one for one in jobs["build"]["strategy"]["matrix"]["include"] if one["runner"].startswith("ubuntu")]
    assert all(one["glibc"] == "--glibc 2.28" for one in linux)
