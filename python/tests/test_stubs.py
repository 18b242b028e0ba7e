"""The stub names what the native module has, and every public item has a docstring."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import spineline as sl
from spineline import _native


def stub_names(tree: ast.Module) -> dict[str, set[str]]:
    """Names of the stub: of functions and constants with nothing, of classes with their members."""
    names: dict[str, set[str]] = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            names[node.name] = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = set()
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names[node.target.id] = set()
    return names


def test_the_stub_names_what_the_native_module_has() -> None:
    stub = Path(inspect.getfile(sl)).with_name("_native.pyi")
    stubbed = stub_names(ast.parse(stub.read_text()))
    found = {name for name in dir(_native) if not name.startswith("__")}
    assert set(stubbed) == found
    for name, members in stubbed.items():
        own = vars(getattr(_native, name)) if isinstance(getattr(_native, name), type) else {}
        public = {member for member in own if not member.startswith("__")}
        assert {member for member in members if not member.startswith("__")} == public, name
        assert all(hasattr(getattr(_native, name), member) for member in members), name


def test_every_public_item_has_a_docstring() -> None:
    missing = []
    for name in sl.__all__:
        item = getattr(sl, name)
        if name == "__version__":
            continue
        if not inspect.getdoc(item):
            missing.append(name)
        if inspect.isclass(item):
            for member, value in vars(item).items():
                is_item = inspect.isfunction(value) or isinstance(value, (property, classmethod))
                if is_item and not member.startswith("_") and not inspect.getdoc(value):
                    missing.append(f"{name}.{member}")
    assert not missing
