"""Repeats the fields of fields.toml in every file that needs them.

Without an option it writes the files. `--check` fails if one differs, `--filled` if a field is not filled in.
"""

from __future__ import annotations

import json
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
ADDRESSES = {"repository": "Source", "documentation": "Documentation", "issues": "Issues"}

UNKNOWN = "To be filled in"
"""Beginning of an affiliation that is not filled in."""

Fields = dict[str, Any]


def name(author: dict[str, str]) -> str:
    return author.get("name") or f"{author['given']} {author['family']}"


def between(text: str, start: str, end: str, content: str) -> str:
    """Replaces the text from a line that starts a block to a line that starts the next one."""
    found, count = re.subn(rf"(?ms)^{start}.*?(?=^{end})", lambda _: content, text, count=1)
    if count != 1:
        raise SystemExit(f"no block from `{start}` to `{end}`")
    return found


def citation(text: str, fields: Fields) -> str:
    lines = ["authors:"]
    for one in fields["authors"]:
        parts = {"name": one.get("name"), "family-names": one.get("family"), "given-names": one.get("given")}
        place = "" if one["affiliation"].startswith(UNKNOWN) else one["affiliation"]
        parts |= {"affiliation": place, "orcid": one.get("orcid")}
        said = [f"{key}: {json.dumps(value, ensure_ascii=False)}" for key, value in parts.items() if value]
        lines += [f"  - {said[0]}", *(f"    {line}" for line in said[1:])]
    lines.append(f"date-released: {fields['released']}")
    keys = {"repository": "repository-code", "documentation": "url"}
    lines += [f"{key}: {fields[field]}" for field, key in keys.items() if fields[field]]
    return between(text, "authors:", "version:", "\n".join(lines) + "\n")


def codemeta(text: str, fields: Fields) -> str:
    found = json.loads(text)
    found["author"] = [
        {"@type": "Organization" if "name" in one else "Person", "name": name(one)}
        | ({"@id": one["orcid"]} if one.get("orcid") else {})
        for one in fields["authors"]
    ]
    found["datePublished"] = str(fields["released"])
    keys = {"repository": "codeRepository", "documentation": "softwareHelp", "issues": "issueTracker"}
    for field, key in keys.items():
        found.pop(key, None)
        if fields[field]:
            found[key] = fields[field]
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def paper(text: str, fields: Fields) -> str:
    places = list(dict.fromkeys(one["affiliation"] for one in fields["authors"]))
    lines = ["authors:"]
    for one in fields["authors"]:
        lines += [f"  - name: {name(one)}", f"    affiliation: {places.index(one['affiliation']) + 1}"]
        # The journal wants the number alone.
        lines += [f"    orcid: {one['orcid'].rsplit('/')[-1]}"] if one.get("orcid") else []
    lines.append("affiliations:")
    for number, place in enumerate(places, start=1):
        lines += [f"  - name: {place}", f"    index: {number}"]
    lines.append(f"date: {fields['released'].day} {fields['released']:%B %Y}")
    return between(text, "authors:", "bibliography:", "\n".join(lines) + "\n")


def cargo(text: str, fields: Fields) -> str:
    address = fields["repository"] or "https://example.org/spineline"
    return between(text, "repository = ", "publish", f"repository = {json.dumps(address)}\n")


def pyproject(text: str, fields: Fields) -> str:
    people = ", ".join(f"{{ name = {json.dumps(name(one), ensure_ascii=False)} }}" for one in fields["authors"])
    text = between(text, "authors = ", "keywords = ", f"authors = [{people}]\n")
    urls = [f"{word} = {json.dumps(fields[field])}" for field, word in ADDRESSES.items() if fields[field]]
    return between(text, r"\[project.urls\]", r"\[tool.maturin\]", "\n".join(["[project.urls]", *urls, "", ""]))


FILES = {
    "CITATION.cff": citation,
    "codemeta.json": codemeta,
    "docs/paper/paper.md": paper,
    "Cargo.toml": cargo,
    "python/pyproject.toml": pyproject,
}


def empty(fields: Fields) -> list[str]:
    found = [field for field in ADDRESSES if not fields[field]]
    return found + [
        f"affiliation of {name(one)}" for one in fields["authors"] if one["affiliation"].startswith(UNKNOWN)
    ]


def main(options: list[str]) -> int:
    fields = tomllib.loads((ROOT / "packaging/fields.toml").read_text())
    if "--filled" in options and (missing := empty(fields)):
        print(f"packaging/fields.toml: not filled in: {', '.join(missing)}", file=sys.stderr)
        return 1
    for file, write in FILES.items():
        had = (ROOT / file).read_text()
        now = write(had, fields)
        if "--check" in options and now != had:
            print(f"{file} differs from packaging/fields.toml: run python3 packaging/fields.py", file=sys.stderr)
            return 1
        if now != had and "--check" not in options:
            (ROOT / file).write_text(now)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
