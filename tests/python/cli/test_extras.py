"""Commands without the packages of the extras: most work, the others say what to install."""

from __future__ import annotations

import os
from importlib.metadata import metadata
from pathlib import Path

import pytest
from commands import assert_fails, command, succeeded
from meshlab_spectral.extras import _PACKAGES

# What the extras bring, as if it were not installed.
WITHOUT_EXTRAS = """
import sys
sys.modules.update(dict.fromkeys(["dask", "distributed", "matplotlib", "pyvista"]))
"""


@pytest.fixture(autouse=True)
def _plain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "sitecustomize.py").write_text(WITHOUT_EXTRAS)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")


@pytest.mark.parametrize(
    "arguments",
    [
        ["info", "COW"],
        ["filter", "COW", "out.ply"],
        ["denoise", "COW", "out.ply"],
        ["basis", "COW", "-k", "10", "--output", "out.npz"],
        ["spectrum", "COW", "--json"],
        ["batch", "COW", "--output", "out"],
        ["spectra", "COW"],
        ["install", "--dry-run"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_command_on_this_machine_needs_no_extra(arguments: list[str], cow: Path) -> None:
    files = [str(cow) if argument == "COW" else argument for argument in arguments]
    succeeded(*files)


@pytest.mark.parametrize(
    ("arguments", "extras"),
    [
        (["batch", "COW", "--output", "out", "--scheduler", "host:8786"], "cluster"),
        (["spectra", "COW", "--scheduler", "host:8786"], "cluster"),
        (["filter", "COW", "out.obj", "--scheduler", "host:8786"], "cluster"),
        (["spectrum", "COW"], "plots"),
        (["basis", "COW", "--pictures", "out.png"], "plots,render"),
    ],
    ids=lambda value: value if isinstance(value, str) else "-".join(value[:2]),
)
def test_a_missing_extra_is_named_before_anything_is_done(
    arguments: list[str], extras: str, cow: Path, tmp_path: Path
) -> None:
    files = [str(cow) if argument == "COW" else argument for argument in arguments]
    done = command(*files)
    assert_fails(done, 1, f"pip install 'meshlab-spectral[{extras}]'")
    assert not list((tmp_path / "work").iterdir())


def test_the_extras_of_the_messages_are_those_of_the_package() -> None:
    assert set(metadata("meshlab-spectral").get_all("Provides-Extra")) == {*_PACKAGES, "pictures"}
