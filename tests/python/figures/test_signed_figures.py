"""`plot_comparison` and `plot_texture`: in a notebook, as the commands draw them."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
import pyvista
from commands import succeeded
from helpers import mesh_set_of
from meshlab_spectral import compare, plot_comparison, plot_texture, surface_texture
from numpy.typing import NDArray

Arrays = tuple[NDArray[np.float64], NDArray[Any]]


@pytest.fixture
def rough() -> Arrays:
    """A sphere with waves of the tenth degree."""
    ball = pyvista.Icosphere(nsub=4)
    V = np.asarray(ball.points, dtype=np.float64)
    wave = np.hypot(V[:, 0], V[:, 1]) ** 10 * np.cos(10 * np.arctan2(V[:, 1], V[:, 0]))
    return V * (1 + 0.02 * wave)[:, None], ball.regular_faces


def shown(figure: Any) -> NDArray[np.float64]:
    """What a notebook shows, as red, green and blue."""
    pixels: NDArray[np.float64] = matplotlib.image.imread(io.BytesIO(figure._repr_png_()))
    return pixels[..., :3]


def saved(mesh: Arrays, path: Path) -> Path:
    mesh_set_of(*mesh).save_current_mesh(str(path))
    return path


@pytest.mark.slow
def test_a_notebook_shows_the_comparison_that_the_command_draws(
    rough: Arrays, tmp_path: Path
) -> None:
    V, F = rough
    a, b = saved((V, F), tmp_path / "a.ply"), saved((1.1 * V, F), tmp_path / "b.ply")
    picture = tmp_path / "change.png"
    succeeded("compare", a, b, "--picture", picture)
    figure = plot_comparison(compare(a, b), ("a.ply", "b.ply"))
    drawn = matplotlib.image.imread(picture)[..., :3]
    np.testing.assert_allclose(shown(figure), drawn, atol=0.01)


@pytest.mark.slow
def test_a_notebook_shows_the_texture_that_the_command_draws(rough: Arrays, tmp_path: Path) -> None:
    source, picture = saved(rough, tmp_path / "rough.ply"), tmp_path / "texture.png"
    succeeded("texture", source, "--waviness", "1.5", "--picture", picture)
    figure = plot_texture(rough, surface_texture(rough, waviness=1.5), name="rough.ply")
    drawn = matplotlib.image.imread(picture)[..., :3]
    in_colours = np.ptp(drawn[: -drawn.shape[0] // 3], axis=2) > 0.15
    half = drawn.shape[1] // 2
    assert not in_colours[:, :half].any(), "the shape is grey"
    assert in_colours[:, half:].mean() > 0.1
    np.testing.assert_allclose(shown(figure), drawn, atol=0.01)


def test_a_texture_of_another_mesh_is_refused(rough: Arrays) -> None:
    texture = surface_texture(rough, waviness=1.5)
    with pytest.raises(ValueError, match="pass that of this mesh"):
        plot_texture(rough[0][:-1], rough[1][:2], texture)
