"""The stub has the names and parameters of the native module, and every public item has a docstring."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path

import pytest

import spineline as sl
from spineline import _native


def stub_names(tree: ast.Module) -> dict[str, set[str]]:
    """Names of the stub; classes have their members, functions and constants an empty set."""
    names: dict[str, set[str]] = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            names[node.name] = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = set()
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names[node.target.id] = set()
    return names


def stub() -> ast.Module:
    return ast.parse(Path(inspect.getfile(sl)).with_name("_native.pyi").read_text())


Parameters = list[tuple[str, bool]]
"""Names, and whether they have a default."""


def is_property(node: ast.FunctionDef) -> bool:
    return any(isinstance(one, ast.Name) and one.id == "property" for one in node.decorator_list)


def stub_parameters(node: ast.FunctionDef) -> Parameters:
    names = [one.arg for one in node.args.args if one.arg != "self"]
    without = len(names) - len(node.args.defaults)
    return [(name, place >= without) for place, name in enumerate(names)]


def native_parameters(item: object) -> Parameters:
    parameters = inspect.signature(item).parameters.values()  # type: ignore[arg-type]
    return [(one.name, one.default is not one.empty) for one in parameters if one.name != "self"]


def stubbed_calls(tree: ast.Module) -> Iterator[tuple[str, object, ast.FunctionDef]]:
    """Every function, method and constructor of the stub with the native one, by name."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, getattr(_native, node.name), node
        for part in node.body if isinstance(node, ast.ClassDef) else []:
            if isinstance(part, ast.FunctionDef) and not is_property(part):
                native = getattr(_native, node.name)
                if part.name == "__init__":
                    yield node.name, native, part
                elif not part.name.startswith("__") or part.name == "__arrow_c_stream__":
                    yield f"{node.name}.{part.name}", getattr(native, part.name), part


@pytest.mark.parametrize(("name", "native", "node"), list(stubbed_calls(stub())))
def test_the_stub_has_the_parameters_of_the_native_module(
    name: str, native: object, node: ast.FunctionDef
) -> None:
    assert native_parameters(native) == stub_parameters(node), name


def test_a_property_of_the_stub_is_one_of_the_native_module() -> None:
    classes = [node for node in stub().body if isinstance(node, ast.ClassDef)]
    for node in classes:
        for part in (part for part in node.body if isinstance(part, ast.FunctionDef)):
            native = inspect.getattr_static(getattr(_native, node.name), part.name)
            assert inspect.isdatadescriptor(native) is is_property(part), f"{node.name}.{part.name}"


def test_the_stub_has_the_names_of_the_native_module() -> None:
    stubbed = stub_names(stub())
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
