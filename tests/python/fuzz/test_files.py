"""Damaged files of every format: they are read, or refused with a message."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
import pytest
from format_samples import SAMPLES
from fuzz.damages import Damage, damaged, damages
from fuzz.runs import as_many_as
from hypothesis import given
from hypothesis import strategies as st
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.opening import open_document

# Readers of VTK and USD may end the process: the commands say so (below).
ENDING = (".vtk", ".vtp", ".usda", ".usdz")
PATCHED_HERE = [sample for sample in SAMPLES if not sample.name.endswith(ENDING)]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """The undamaged files by their numbers in PATCHED_HERE."""
    paths = {}
    for number, sample in enumerate(PATCHED_HERE):
        paths[number] = tmp_path_factory.mktemp("whole") / sample.name
        sample.write(paths[number])
    return paths


@as_many_as(400)
@given(st.integers(0, len(PATCHED_HERE) - 1), damages)
def test_a_damaged_file_is_read_or_refused(
    whole: dict[int, Path], number: int, damages: list[Damage]
) -> None:
    source = whole[number]
    path = source.with_name(f"damaged{source.suffix}")
    path.write_bytes(damaged(source.read_bytes(), damages))
    with contextlib.suppress(MeshFileError):
        document = open_document(path)
        assert all(np.isfinite(part.vertices).all() for part in document.parts)
        moved = [part.vertices + 1e-3 for part in document.parts]
        document.save(path.with_name(f"moved{path.suffix}"), moved)
