"""The subpackages of `meshlab_spectral` import one another in one direction, without a circle."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import meshlab_spectral

NAME = "meshlab_spectral"
SOURCE = Path(meshlab_spectral.__file__).parent
# A room imports only from rooms of lower levels; the package itself may import from all of them.
LEVELS = {
    "errors": 0,
    "extras": 1,
    "documents": 2,
    "plugin": 2,
    "filters": 3,
    "files": 4,
    "process": 5,
    "figures": 6,
    "batch": 6,
    "cli": 7,
    "": 8,
}


def module_of(path: Path) -> str:
    """Dotted name below the package; "" for the package itself."""
    parts = path.relative_to(SOURCE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_of(path): path for path in SOURCE.rglob("*.py")}


def room_of(module: str) -> str:
    return module.partition(".")[0]


def imports(source: str) -> Iterator[tuple[int, str]]:
    """Line and module of every import from the package, those within functions included."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            for alias in node.names:
                package, _, module = alias.name.partition(".")
                if package == NAME:
                    yield node.lineno, module
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"line {node.lineno}: write imports from {NAME} in full"
            package, _, module = (node.module or "").partition(".")
            if package == NAME:
                for alias in node.names:
                    submodule = f"{module}.{alias.name}".lstrip(".")
                    yield node.lineno, submodule if submodule in MODULES else module


def against_the_arrows(module: str, source: str) -> list[str]:
    """Imports of a module that its room does not allow."""
    room = room_of(module)
    return [
        f"{module or NAME}, line {line}: {room} must not import {found or NAME}"
        for line, found in imports(source)
        if room_of(found) != room and LEVELS[room_of(found)] >= LEVELS[room]
    ]


def test_every_module_is_in_a_room() -> None:
    assert {room_of(module) for module in MODULES} == LEVELS.keys()


def test_rooms_import_only_from_rooms_below() -> None:
    offending = [
        line
        for module, path in MODULES.items()
        for line in against_the_arrows(module, path.read_text(encoding="utf-8"))
    ]
    assert offending == []


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph = {
        module: {found for _, found in imports(path.read_text(encoding="utf-8"))}
        for module, path in MODULES.items()
    }
    TopologicalSorter(graph).prepare()  # names the circle


def test_an_import_against_the_arrows_is_named() -> None:
    source = "def late():\n    from meshlab_spectral.batch import plan\n"
    assert against_the_arrows("files.meshes", source) == [
        "files.meshes, line 2: files must not import batch.plan"
    ]
    assert against_the_arrows("figures.sheet", source) != []
    assert against_the_arrows("cli.batch", source) == []
