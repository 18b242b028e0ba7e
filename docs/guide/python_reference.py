"""Writes the page of the book that explains every name of the Python package, from its docstrings: `python_reference.py PACKAGE PAGE`."""

import re
import sys
from pathlib import Path

import griffe
from griffe2md import render_object_docs

CONFIG = {
    "docstring_style": "numpy",
    "heading_level": 1,
    "show_root_full_path": False,
    "show_object_full_path": False,
    "show_root_members_full_path": False,
    "show_bases": False,
    "show_if_no_docstring": False,
    "show_signature_annotations": True,
    "signature_crossrefs": False,
    "separate_signature": True,
    "docstring_section_style": "list",
    "summary": False,
    "filters": ["!^_"],
}


def main() -> None:
    """Reads the sources only; nothing is imported."""
    package, page = Path(sys.argv[1]), Path(sys.argv[2])
    module = griffe.load(package.name, search_paths=[package.parent], docstring_parser="numpy", resolve_aliases=True)
    text = render_object_docs(module, CONFIG)
    # Roles of Sphinx, which the docstrings have for editors.
    text = re.sub(r":(?:class|func|meth|attr|mod):`([^`]+)`", r"`\1`", text)
    # Classes that only other calls create are shown without a constructor.
    text = re.sub(r"```python\n[A-Z]\w*\((?:native|analysis|rows|folder|name|tables)\b[^`]*```\n", "", text)
    text = re.sub(r"\[\*\*(\w+)\*\*\]\(#[^)]*\)", r"**\1**", text)
    # Types link to what has no heading here, such as `float`.
    text = re.sub(r"<code>.*?</code>", without_links, text)
    page.write_text(text.replace("# `spineline`\n", "# Python reference\n", 1))


def without_links(code: re.Match[str]) -> str:
    """A type in plain text."""
    return re.sub(r"\[(\w+)\]\(#[^)]*\)", r"\1", code[0])


main()
