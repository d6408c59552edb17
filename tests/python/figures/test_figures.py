"""The scripts that draw the figures of the paper and the pictures of the READMEs."""

from __future__ import annotations

import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import denoising
import draw
import matplotlib.image
import numpy as np
import parts
import pytest
import spectral_reference as reference
from commands import python
from eigenfunctions import most_alike
from figure_numbers import recorded
from helpers import diagonal, largest_distance, mesh_set_of
from meshlab_spectral import filter_mesh, manifold_harmonics
from meshlab_spectral.figures import sheet
from meshlab_spectral.figures.pictures import Frame, Panel, View, render
from meshlab_spectral.filters.arrays import lumped_areas
from meshlab_spectral.filters.options import FilterOptions
from numpy.typing import NDArray
from paper import FIGURES
from sequences import K, after
from shared_types import Decimated
from stability import BAND, LOW_PASS

REPOSITORY = Path(__file__).resolve().parents[3]
SCRIPTS = REPOSITORY / "screenshots" / "scripts"
BENCHMARKS = REPOSITORY / "tests" / "benchmarks"


def script(name: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    return python(SCRIPTS / name, *arguments, PYTHONPATH=str(BENCHMARKS))


@pytest.fixture
def meshes(decimated: Decimated, tmp_path: Path) -> list[Path]:
    """In place of the dragon and the angel: one lying, y up, and one standing, z up."""
    V, F = decimated("cow.obj", 1000)
    x, y, z = V.T
    standing = np.column_stack([y, z, x])  # turned: the longest axis points upwards
    paths = [tmp_path / "lying.ply", tmp_path / "standing.ply"]
    for path, vertices in zip(paths, (V, standing), strict=True):
        mesh_set_of(vertices, F).save_current_mesh(str(path))
    return paths


@pytest.mark.slow
def test_every_figure_of_every_mesh_is_drawn(meshes: list[Path], tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    done = script("paper.py", *meshes, "--output", folder, "--scale", 0.2)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    expected = {f"{name}_{mesh.stem}.png" for mesh in meshes for name, _ in FIGURES.values()}
    assert {path.name for path in folder.glob("*.png")} == expected
    assert recorded(folder).keys() == expected
    assert {Path(line).name for line in done.stdout.splitlines()} == expected
    for path in folder.glob("*.png"):
        picture = np.asarray(matplotlib.image.imread(path))[:, :, :3]
        assert 0.1 < (picture < 0.98).any(axis=2).mean() < 0.9, path.name
        edges = [picture[0], picture[-1], picture[:, 0], picture[:, -1]]
        assert all((edge > 0.98).all() for edge in edges), path.name


@pytest.mark.slow
def test_all_pictures_are_drawn_and_their_numbers_recorded(
    decimated: Decimated, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sheet, "_PAGE_PIXELS", 1e5)
    mesh_set = mesh_set_of(*decimated("cow.obj", 1000))
    for folder in (tmp_path / "meshes", tmp_path / Path(denoising.PAIRS).name):
        folder.mkdir()
    for name in (
        "meshes/dragon_40k.ply",
        "meshes/stanford-bunny.obj",
        "meshes/fandisk.off",
        "meshes/gears.stl",
        "meshes/lionstatue.obj",
        "denoise/trimstar_n3_noisy.ply",
        "denoise/trimstar_n3_clean.ply",
    ):
        mesh_set.save_current_mesh(str(tmp_path / name))
    names = [*parts.PICTURES, "harmonics_dragon_40k", "denoise_trimstar_n3"]
    words = ["draw.py", tmp_path / "meshes", tmp_path / "new", *names]
    monkeypatch.setattr(sys, "argv", [str(word) for word in words])
    draw._main()
    assert {path.stem for path in (tmp_path / "new").glob("*.png")} == set(names)
    numbers = recorded(tmp_path / "new")
    assert {Path(picture).stem for picture in numbers} == set(names)
    assert all(numbers.values())


@pytest.mark.parametrize(
    ("options", "update"), [(LOW_PASS, "conformal"), (BAND, "full")], ids=["low-pass", "band"]
)
def test_sequences_show_intermediate_shapes_of_the_filter(
    options: FilterOptions, update: Any, decimated: Decimated
) -> None:
    V, F = decimated("bunny.obj", 1000)

    def shape(options: FilterOptions) -> NDArray[np.float64]:
        return np.asarray(filter_mesh(V, F, options)[0])

    shapes = [V, *(shape(after(options, i, update)) for i in (3, 6, K))]
    ways = [largest_distance(a, b) for a, b in pairwise(shapes)]
    assert min(ways) > 1e-3 * diagonal(V)
    whole = shape(FilterOptions(**{**vars(options), "steps": K, "basis_update": update}))
    np.testing.assert_array_equal(shapes[-1], whole)


def test_harmonics_are_orthonormal_and_matched_in_any_order_and_sign(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 1000)
    d = lumped_areas(V, F)
    np.testing.assert_allclose(d, reference.lumped_areas(V, F), rtol=1e-12)
    Phi = manifold_harmonics(V, F, 12).harmonics
    np.testing.assert_allclose(Phi.T @ (d[:, None] * Phi), np.eye(12), atol=1e-8)
    number, correlation = most_alike(Phi[:, 7], -Phi[:, ::-1], d)
    assert number == 11 - 7
    assert correlation == pytest.approx(-1)


def test_a_mesh_too_small_for_its_eigenfunctions_is_refused(tmp_path: Path) -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    path = tmp_path / "tetrahedron.ply"
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    mesh_set_of(corners, faces).save_current_mesh(str(path))
    done = script("paper.py", path, "--output", tmp_path, "--only", 4, "--scale", 0.2)
    assert done.returncode == 1, done.stderr
    assert "basis_size" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_frame_holds_all_of_its_shapes(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    view = View.of_widest_side(V)
    large, small = Frame.row_by_row([[V, 1.5 * V], [0.5 * V]], view)
    assert large.width == small.width
    assert large.height > 2.5 * small.height
    picture = render(Panel("", 1.5 * V, F), large, 200)
    drawn = (picture < 250).any(axis=2)
    assert drawn.shape[1] == 200
    for edge in (drawn[0], drawn[-1], drawn[:, 0], drawn[:, -1]):
        assert not edge.any()
    assert drawn.any(axis=0).mean() > 0.94
    assert drawn.any(axis=1).mean() > 0.9


def test_signed_values_are_blue_and_red(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    view = View.of_widest_side(V)
    frame = Frame.around([V], view)
    x = V @ view.axes()[0]
    picture = render(Panel("", V, F, np.clip(9 * (x - np.median(x)), -1, 1)), frame, 300)
    red, blue = (picture[:, :, channel].astype(float) for channel in (0, 2))
    columns = np.arange(300)
    redder = (red - blue) > 40
    bluer = (blue - red) > 40
    assert (redder.sum(axis=0) @ columns) / redder.sum() > (
        bluer.sum(axis=0) @ columns
    ) / bluer.sum() + 60
