"""A mesh that needs more memory than there is is refused before the memory is taken."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from helpers import loaded, refusal
from meshlab_spectral import (
    FilterError,
    FilterOptions,
    OptionError,
    denoise_mesh,
    filter_colors,
    filter_mesh,
    filter_scalars,
    geometry_spectrum,
    manifold_harmonics,
    measure_artefacts,
    set_memory_limit,
    shape_dna,
)
from meshlab_spectral.errors import MemoryLimitError
from meshlab_spectral.files.request import Request
from meshlab_spectral.plugin.limits import (
    MEMORY,
    given_memory_limit,
    memory_remedy,
    name_memory_limit,
)
from meshlab_spectral.workers.process import JobLimits, MeshLabProcess
from shared_types import Decimated

MEBIBYTE = 2**20


@pytest.fixture(autouse=True)
def _restored() -> Iterator[None]:
    yield
    set_memory_limit(None)


@pytest.mark.parametrize("limit", [0, -1.5, float("nan"), float("inf"), "2GB"])
def test_an_invalid_limit_is_refused(limit: Any) -> None:
    with pytest.raises(OptionError, match=f"memory limit = {limit}: give a number of bytes"):
        set_memory_limit(limit)


@pytest.mark.parametrize("spectrum", ["full", "truncated"])
def test_a_filter_beyond_the_limit_is_refused_with_numbers(spectrum: str, samples: Path) -> None:
    meshes = loaded(samples / "cow.obj")
    before = meshes.current_mesh().vertex_matrix().copy()
    set_memory_limit(1)
    words = "needs about .* more memory, of which 0 MiB are free: simplify it"
    assert re.search(words, refusal(meshes, steps=1, spectrum=spectrum))
    np.testing.assert_array_equal(before, meshes.current_mesh().vertex_matrix())


def test_a_basis_beyond_the_limit_is_refused_with_the_size_that_fits(samples: Path) -> None:
    meshes = loaded(samples / "bunny.obj")  # 1000 harmonics take 290 MB, the rest 28 MB
    before = meshes.current_mesh().vertex_matrix().copy()
    set_memory_limit(psutil.Process().memory_info().rss + 150 * MEBIBYTE)
    words = r"harmonics of .* need about .* are free: choose at most (\d+).* spectrum = full"
    refused = re.search(words, refusal(meshes, steps=1, spectrum="truncated", basis_size=1000))
    assert refused
    assert 10 < int(refused[1]) < 1000
    np.testing.assert_array_equal(before, meshes.current_mesh().vertex_matrix())


Call = Callable[[np.ndarray, np.ndarray], object]
CALLS: dict[str, Call] = {
    "filter_mesh": filter_mesh,
    "denoise_mesh": denoise_mesh,
    "filter_scalars": lambda V, F: filter_scalars(V, F, V[:, 0]),
    "filter_colors": lambda V, F: filter_colors(V, F, np.abs(V) / np.abs(V).max()),
    "geometry_spectrum": geometry_spectrum,
    "measure_artefacts": lambda V, F: measure_artefacts(V, F, 0.1),
    "manifold_harmonics": lambda V, F: manifold_harmonics(V, F, 30),
    "shape_dna": shape_dna,
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_every_function_keeps_to_the_limit(
    call: Call, decimated: Decimated, monkeypatch: pytest.MonkeyPatch
) -> None:
    V, F = decimated("cow.obj", 2000)
    set_memory_limit(1)
    with pytest.raises(FilterError, match=r"memory, (of which )?0 MiB are free") as refused:
        call(V, F)
    assert re.search("raise set_memory_limit$|choose at most", str(refused.value))
    for value in ("", "4XB", "GB", "0", "0GB", "-1", "nan", "inf"):
        monkeypatch.setenv(MEMORY, value)
        with pytest.raises(FilterError, match=f"{MEMORY} = {value}: give a number of bytes"):
            call(V, F)
        with pytest.raises(OptionError, match=f"{MEMORY} = {value}: give a number of bytes"):
            given_memory_limit()
    for value, size in (("4e9", 4_000_000_000), ("4GB", 4 << 30), (" 3.5 gib ", 7 << 29)):
        monkeypatch.setenv(MEMORY, value)
        call(V, F)
        assert given_memory_limit() == size


def test_a_mesh_set_keeps_to_the_limit_of_the_environment(
    samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    meshes = loaded(samples / "cow.obj")
    used = psutil.Process().memory_info().rss // MEBIBYTE
    monkeypatch.setenv(MEMORY, f"{used // 2}MB")
    assert f"raise the environment variable {MEMORY}" in refusal(meshes, steps=1)
    for value in (f"{used + 2000}MB", f" {(used + 2000) / 1024:.2f} gib "):
        monkeypatch.setenv(MEMORY, value)
        meshes.apply_filter("apply_coord_spectral_filter_fractional", steps=1)


def job(source: Path, folder: Path) -> dict[str, Any]:
    request = Request(source, FilterOptions(steps=1))
    return {"call": "filter_to_scratch", "request": request, "scratch": folder / "out.ply"}


@pytest.mark.parametrize("is_set", [True, False], ids=["set", "environment"])
def test_a_job_without_a_limit_has_that_of_the_environment(
    is_set: bool, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    remedy = (
        "raise set_memory_limit" if is_set else f"raise or unset the environment variable {MEMORY}"
    )
    with MeshLabProcess() as process:
        process.run(job(samples / "cow.obj", tmp_path))
        limit = process.memory() + MEBIBYTE
        if is_set:
            set_memory_limit(limit)
        else:
            monkeypatch.setenv(MEMORY, str(limit))
        with pytest.raises(MemoryLimitError, match=f"its limit: {remedy};"):
            process.run(job(samples / "bunny.obj", tmp_path))
    with MeshLabProcess() as process:
        set_memory_limit(None)
        process.run(job(samples / "cow.obj", tmp_path))


@pytest.mark.parametrize("more", [5, 15, 20, 25])  # where reading takes too much, and filtering
def test_the_limit_of_a_job_is_that_of_the_plugin(more: int, samples: Path, tmp_path: Path) -> None:
    with MeshLabProcess() as process:
        process.run(job(samples / "cow.obj", tmp_path))
        limit = process.memory() + more * MEBIBYTE
        with pytest.raises(MemoryLimitError, match="raise the memory limit"):
            process.run(job(samples / "bunny.obj", tmp_path), limits=JobLimits(memory=limit))
        assert not (tmp_path / "out.ply.partial").exists()


def test_texts_name_the_limit_as_it_was_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(MEMORY, raising=False)
    assert memory_remedy(3e9) == "give it a machine with 2862MB more free memory"
    set_memory_limit(1e9)
    assert memory_remedy() == "raise set_memory_limit"
    name_memory_limit("--memory")
    assert memory_remedy(3e9) == "raise --memory to at least 2862MB"
    monkeypatch.setenv(MEMORY, "2e9")
    assert memory_remedy() == f"raise or unset the environment variable {MEMORY}"
