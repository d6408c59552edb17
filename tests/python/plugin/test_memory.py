"""A mesh that needs more memory than there is is refused before the memory is taken."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
from helpers import refusal
from meshlab_spectral import FilterOptions, OptionError, set_memory_limit
from meshlab_spectral.errors import MemoryLimitError
from meshlab_spectral.process.parent import JobLimits, MeshLabProcess

MEBIBYTE = 2**20


@pytest.fixture(autouse=True)
def _restored() -> Iterator[None]:
    yield
    set_memory_limit(None)


def test_an_invalid_limit_is_refused() -> None:
    with pytest.raises(OptionError, match="memory limit = 0: give a number"):
        set_memory_limit(0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"steps": 1}, "needs about .* more memory, of which 0 MiB are free: simplify it"),
        ({"steps": 1, "spectrum": "truncated"}, "harmonics of .* need about .* spectrum = full"),
    ],
)
def test_a_filter_beyond_the_limit_is_refused_with_numbers(
    options: dict[str, Any], words: str, samples: Path
) -> None:
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(samples / "cow.obj"))
    before = meshes.current_mesh().vertex_matrix().copy()
    set_memory_limit(1)
    assert re.search(words, refusal(meshes, **options))
    np.testing.assert_array_equal(before, meshes.current_mesh().vertex_matrix())


def test_the_limit_of_a_job_is_that_of_the_plugin(samples: Path, tmp_path: Path) -> None:
    def job(name: str) -> dict[str, Any]:
        options = FilterOptions(steps=1).as_dict()
        files = {"source": str(samples / name), "scratch": str(tmp_path / "out.ply")}
        return {"task": "filter", "options": options, **files}

    with MeshLabProcess() as process:
        process.run(job("cow.obj"))
        limit = process.memory() + 25 * MEBIBYTE
        with pytest.raises(MemoryLimitError, match="raise the memory limit"):
            process.run(job("bunny.obj"), limits=JobLimits(memory=limit))
        assert not (tmp_path / "out.ply.partial").exists()
