"""Fixtures: pymeshlab with the plugin, its sample meshes, the real meshes next to the project."""

from __future__ import annotations

import functools
import os
import runpy
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

# Before NumPy is loaded: with as many threads as cores, the many medium-sized eigenproblems of the
# tests take ten times as long as soon as another program uses a core.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import meshlab_spectral
import numpy as np
import pymeshlab
import pytest
from commands import PRECIOUS
from hypothesis import HealthCheck, settings
from numpy.typing import NDArray
from small_pictures import draw_small

SAMPLES = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
SAMPLE_NAMES = ("bunny.obj", "cow.obj")  # with a boundary, and closed
DATA_VARIABLE = "MESHLAB_SPECTRAL_DATA"

# The same examples in every run; and a busy machine is not a failure.
settings.register_profile(
    "seeded", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("seeded")

BEGIN = time.monotonic()
Arrays = tuple[NDArray[Any], NDArray[Any]]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--seconds", type=float, help="skip the tests that would begin later than this"
    )
    parser.addoption(
        "--without-posix",
        action="store_true",
        help="refuse the package the modules that only POSIX systems have",
    )


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--without-posix"):
        folder = Path(__file__).parent / "without_posix"
        runpy.run_path(str(folder / "sitecustomize.py"))
        paths = [str(folder), *filter(None, [os.environ.get("PYTHONPATH")])]
        os.environ["PYTHONPATH"] = os.pathsep.join(paths)


def pytest_runtest_setup(item: pytest.Item) -> None:
    seconds = item.config.getoption("--seconds")
    if seconds is not None and time.monotonic() - BEGIN > seconds:
        pytest.skip(f"the {seconds:g} seconds are over: see `make test`")


@pytest.fixture(scope="session", autouse=True)
def _plugin_loaded() -> None:
    meshlab_spectral.load()
    draw_small()


@pytest.fixture
def record_property(record_property: Callable[[str, Any], None]) -> Callable[[str, Any], None]:
    """Record plain numbers, which alone pass between the processes of pytest-xdist."""
    return lambda name, value: record_property(name, np.asarray(value).tolist())


@pytest.fixture(scope="session")
def samples() -> Path:
    """Folder of the meshes that come with pymeshlab."""
    return SAMPLES


@pytest.fixture(params=SAMPLE_NAMES)
def sample_name(request: pytest.FixtureRequest) -> str:
    """Name of one of pymeshlab's meshes: every test that asks for it runs for each."""
    return str(request.param)


@functools.cache
def _decimated(name: str, faces: int) -> Arrays:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(SAMPLES / name))
    mesh_set.meshing_decimation_quadric_edge_collapse(
        targetfacenum=faces, qualitythr=0.5, preservetopology=True
    )
    mesh = mesh_set.current_mesh()
    V, F = mesh.vertex_matrix(), mesh.face_matrix()
    V.flags.writeable = F.flags.writeable = False  # shared between tests
    return V, F


@pytest.fixture(scope="session")
def decimated() -> Callable[..., Arrays]:
    """Return n x 3 coordinates and triangles of a decimated sample: decimated("cow.obj", 2000)."""

    def get(name: str, faces: int = 1200) -> Arrays:
        return _decimated(name, faces)

    return get


@pytest.fixture
def shared_mesh() -> Callable[[str], Path]:
    """Return the path of a mesh of the project's collection; skip the test if it is absent."""
    repository = Path(__file__).resolve().parents[2]
    folder = Path(os.environ.get(DATA_VARIABLE) or repository.parent / "shared" / "data")

    def get(name: str) -> Path:
        path = folder / name
        if not path.is_file():
            pytest.skip(f"no {name} in the collection of meshes (set {DATA_VARIABLE})")
        return path

    return get


@pytest.fixture
def cow(samples: Path) -> Path:
    return samples / "cow.obj"


@pytest.fixture
def existing(tmp_path: Path) -> Iterator[Path]:
    """An output that was there before; it must be the only file left, byte for byte."""
    folder = tmp_path / "out"
    folder.mkdir()
    target = folder / "result.ply"
    target.write_bytes(PRECIOUS)
    yield target
    assert target.read_bytes() == PRECIOUS
    assert list(folder.iterdir()) == [target]
