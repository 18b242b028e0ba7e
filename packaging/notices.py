"""Writes the notices of all other software in program, browser app and Python module: `notices.py FILE`.

Licences come from the sources of the crates, with the fonts that some hold, and from the npm packages of the browser app
(`npm ci` in `web` comes first). A text that several packages have alike stands once.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("spineline-cli", "spineline-py")
"""The crates that people are given."""
NAMES = ("license", "licence", "copying", "notice", "copyright", "ofl", "unlicense")
"""Beginnings of the names of files that hold a licence."""


def texts(folder: Path) -> list[str]:
    """Texts of the licence files directly in a folder, or in its folder of licences."""
    found = []
    for path in sorted(folder.iterdir()):
        if not path.name.lower().startswith(NAMES):
            continue
        files = sorted(path.iterdir()) if path.is_dir() else [path]
        found += [file.read_text(errors="replace").strip() for file in files if file.is_file()]
    return found


def crates() -> dict[str, tuple[str, Path]]:
    """Licence and folder of every crate that is compiled into a program or module, by name and version."""
    host = subprocess.run(["rustc", "--print", "host-tuple"], check=True, capture_output=True, text=True, cwd=ROOT)
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", host.stdout.strip()]
    command += ["--features", "spineline-cli/pdf,spineline-cli/https"]
    read = subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT)
    found: dict[str, Any] = json.loads(read.stdout)
    packages = {one["id"]: one for one in found["packages"]}
    below = {
        node["id"]: [
            one["pkg"] for one in node["deps"] if any(kind["kind"] is None for kind in one["dep_kinds"])
        ]
        for node in found["resolve"]["nodes"]
    }
    waiting = [key for key, one in packages.items() if one["name"] in PACKAGES]
    seen: set[str] = set()
    while waiting:
        key = waiting.pop()
        if key not in seen:
            seen.add(key)
            waiting += below[key]
    others = [packages[key] for key in seen if packages[key]["source"] is not None]
    return {
        f"crate {one['name']} {one['version']}": (one["license"] or "", Path(one["manifest_path"]).parent)
        for one in others
    }


def npm() -> dict[str, tuple[str, Path]]:
    """Licence and folder of every npm package that is not for development alone, by name and version."""
    web = ROOT / "web"
    if not (web / "node_modules").is_dir():
        print("web/node_modules is missing: no notices of a browser app", file=sys.stderr)
        return {}
    lock = json.loads((web / "package-lock.json").read_text())["packages"]
    kept = {place: one for place, one in lock.items() if place and not one.get("dev") and not one.get("optional")}
    return {
        f"npm {place.rpartition('node_modules/')[2]} {one['version']}": (one.get("license", ""), web / place)
        for place, one in kept.items()
    }


def main(target: str) -> None:
    packages = crates() | npm()
    users: dict[str, list[str]] = {}
    for name, (licence, folder) in packages.items():
        if not folder.is_dir():
            raise SystemExit(f"{name}: {folder} is missing: run `npm ci` in web, or cargo fetch")
        # Some packages give no text; their field names a licence of the list, whose text others give.
        for text in texts(folder) or [f"Licence: {licence}"]:
            users.setdefault(text, []).append(name)
    lines = ["Spineline contains the packages below, with fonts that they hold. Each has the licence that follows it.", ""]
    for text, names in sorted(users.items(), key=lambda one: sorted(one[1])):
        lines += ["=" * 80, *sorted(names), "-" * 80, text, ""]
    Path(target).write_text("\n".join(lines))
    print(f"notices of {len(packages)} packages, {len(users)} texts: {target}")


if __name__ == "__main__":
    main(*sys.argv[1:])
