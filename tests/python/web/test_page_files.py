"""The page's own readers of mesh files: what does not move keeps every byte."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import trimesh
from format_samples import SAMPLES, placed
from numpy.typing import NDArray
from scipy.spatial import cKDTree

REPOSITORY = Path(__file__).resolve().parents[3]
PAGE = REPOSITORY / "plugin" / "web" / "page"
ENDINGS = {".ply", ".stl", ".obj", ".glb", ".3mf"}
OURS = [sample for sample in SAMPLES if Path(sample.name).suffix in ENDINGS]
SINGLE = 1e-6  # of coordinates of about 5, in single precision


def run(folder: Path) -> None:
    if shutil.which("node") is None:
        pytest.skip("no Node here")
    command = ["node", str(REPOSITORY / "tests" / "web" / "run_files.mjs"), str(PAGE), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def rows(path: Path) -> NDArray[np.float64]:
    return np.fromfile(path).reshape(-1, 3)


@pytest.mark.parametrize("sample", OURS, ids=lambda one: f"{one.name}-{OURS.index(one)}")
def test_only_coordinates_and_normals_of_what_moves_are_replaced(sample, tmp_path: Path) -> None:
    folder = tmp_path / "files"
    folder.mkdir()
    source = folder / sample.name
    sample.write(source)
    for extra in folder.iterdir():  # images and materials, which the page is not given
        if extra != source:
            extra.rename(tmp_path / extra.name)
    run(folder)
    assert not (folder / f"{sample.name}.error").exists()
    assert (folder / "same" / sample.name).read_bytes() == source.read_bytes()

    before, after = sample.read(source), sample.read(folder / "moved" / sample.name)
    assert before.keys() == after.keys()
    for key in before.keys() - {"coordinates", "normals"}:
        assert before[key] == after[key], key
    V, X = rows(folder / f"{sample.name}.before"), rows(folder / f"{sample.name}.after")
    if source.suffix == ".3mf":  # the page filters objects before they are placed
        V, X = placed(V), placed(X)
    assert 0 < np.count_nonzero((V != X).any(axis=1)) < len(V)
    nearest = cKDTree(V).query(before["coordinates"])[1]
    np.testing.assert_allclose(after["coordinates"], X[nearest], rtol=0, atol=SINGLE)
    if source.suffix in (".3mf", ".ply"):  # not read by trimesh
        return
    moved = trimesh.load(folder / "moved" / sample.name, process=False, force="mesh")
    bounds = np.array([X.min(axis=0), X.max(axis=0)])
    np.testing.assert_allclose(moved.bounds, bounds, rtol=0, atol=SINGLE)


@pytest.mark.parametrize("sample", OURS, ids=lambda one: f"{one.name}-{OURS.index(one)}")
def test_a_file_that_ends_early_or_is_of_another_kind_is_told(sample, tmp_path: Path) -> None:
    folder = tmp_path / "files"
    folder.mkdir()
    sample.write(tmp_path / sample.name)
    data = (tmp_path / sample.name).read_bytes()
    stem, ending = Path(sample.name).stem, Path(sample.name).suffix
    (folder / f"{stem}1{ending}").write_bytes(data[: len(data) // 2])
    (folder / f"{stem}2{ending}").write_bytes(b"")
    (folder / f"{stem}3{ending}").write_bytes(bytes(range(256)) * 40)
    run(folder)
    for number in (1, 2, 3):
        error = folder / f"{stem}{number}{ending}.error"
        if number == 1 and ending in (".obj", ".stl") and not error.exists():
            continue  # half of a list of facets or vertices is one, too
        assert error.read_text().startswith("FileError: ")
