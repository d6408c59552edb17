"""Scripts that no test runs import only what the package has; the promises can be asked."""

from __future__ import annotations

import ast
import importlib
import os
from pathlib import Path

import pytest
from commands import python

REPOSITORY = Path(__file__).resolve().parents[2]
SCRIPTS = [
    path
    for folder in ("tests/benchmarks", "screenshots/scripts")
    for path in sorted((REPOSITORY / folder).rglob("*.py"))
]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_every_name_that_a_script_imports_from_the_package_exists(script: Path) -> None:
    missing = []
    for node in ast.walk(ast.parse(script.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("meshlab_spectral"):
            module = importlib.import_module(str(node.module))
            missing += [
                f"{node.module}.{a.name}" for a in node.names if not hasattr(module, a.name)
            ]
    assert not missing


def test_every_promise_is_listed_once() -> None:
    folders = (str(REPOSITORY / "tests" / name) for name in ("benchmarks", "python"))
    listed = python(
        "-m", "promises", "--list", "--large", check=True, PYTHONPATH=os.pathsep.join(folders)
    )
    rows = [line for line in listed.stdout.splitlines() if line.startswith("  ")]
    assert len(set(rows)) == len(rows) > 50
