"""Fixtures: the screen, and the real MeshLab with the plugin as a user installs it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import meshlab_spectral
import pymeshlab
import pytest
import shown
from desktop import Desktop, save_picture
from filter_dialog import FilterDialog
from fractional import HEAD, MENU, WEIGHT, save_shape
from meshlab import MeshLab

ROOT_VARIABLE = "MESHLAB_SPECTRAL_GUI_ROOT"
PICTURES = Path(__file__).resolve().parents[2] / "build" / "gui"


@pytest.fixture(scope="session", autouse=True)
def _plugin_loaded() -> None:
    meshlab_spectral.load()


@pytest.fixture(scope="session")
def desktop() -> Iterator[Desktop]:
    root = os.environ.get(ROOT_VARIABLE)
    if root is None:
        pytest.exit(f"{ROOT_VARIABLE} is not set: start these tests by `make gui-test`", 2)
    desktop = Desktop(Path(root))
    yield desktop
    desktop.close()


@pytest.fixture
def home(desktop: Desktop) -> Path:
    """Folder of a new user, in the Debian system."""
    # A short name: it is part of the names of sockets, which may have 107 characters.
    return Path(tempfile.mkdtemp(prefix="", dir=desktop.scratch))


@pytest.fixture(scope="session")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The home of a user who has installed the plugin by the command."""
    home = tmp_path_factory.mktemp("installed")
    environment = {k: v for k, v in os.environ.items() if k != "XDG_DATA_HOME"}
    subprocess.run(
        [sys.executable, "-m", "meshlab_spectral.cli", "install"],
        env={**environment, "HOME": str(home)},
        check=True,
    )
    return home


@pytest.fixture
def install(home: Path, installed: Path) -> Callable[[], None]:
    """Install the plugin for the new user."""
    return lambda: shutil.copytree(installed, home, dirs_exist_ok=True) and None


@pytest.fixture
def bunny(home: Path) -> Path:
    """The bunny of 28,088 vertices, with coordinates that both precisions represent exactly."""
    return save_shape(shown.bunny(), home / "bunny.ply")


@pytest.fixture
def noisy_bunny(home: Path) -> Path:
    """The bunny with noise of a fifth of an edge along every axis, as a scanner leaves it."""
    return save_shape(shown.noisy_bunny(), home / "scan.ply")


@pytest.fixture
def start(
    desktop: Desktop, home: Path, request: pytest.FixtureRequest
) -> Iterator[Callable[..., MeshLab]]:
    """Start MeshLab with a mesh; after the test a picture is taken, and MeshLab is ended."""
    running: list[MeshLab] = []

    def run(mesh: Path, **environment: str) -> MeshLab:
        running.append(MeshLab(desktop, home, mesh, **environment))
        return running[-1]

    yield run
    save_picture(desktop.picture(), PICTURES / f"{request.node.name}.png")
    for meshlab in running:
        meshlab.close()


@pytest.fixture
def meshlab(install: Callable[[], None], start: Callable[[Path], MeshLab], bunny: Path) -> MeshLab:
    """A MeshLab in which the plugin was installed, with the bunny."""
    install()
    return start(bunny)


@pytest.fixture
def with_selection(
    install: Callable[[], None], start: Callable[[Path], MeshLab], bunny: Path
) -> MeshLab:
    """A MeshLab with the bunny, weights as its quality, and the head selected by a filter."""
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(bunny))
    mesh_set.compute_scalar_by_function_per_vertex(q=WEIGHT)
    mesh_set.save_current_mesh(str(bunny), save_vertex_color=False, save_vertex_normal=False)
    install()
    meshlab = start(bunny)
    condition = meshlab.open_filter("Selection", "Conditional Face Selection")
    condition.set_value(condition.rows()[0], HEAD)
    condition.apply()
    condition.close()
    return meshlab


@pytest.fixture
def dialog(meshlab: MeshLab) -> FilterDialog:
    """The dialog of the fractional filter."""
    return meshlab.open_filter(*MENU)
