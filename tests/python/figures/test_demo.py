"""The demonstration and its renderer: the files are there, and the pictures show what they say."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
from commands import python
from helpers import loaded
from meshlab_spectral.figures.pictures import Panel, View
from numpy.typing import NDArray
from shared_types import Decimated
from side_by_side import draw_side_by_side

SCRIPTS = Path(__file__).resolve().parents[3] / "screenshots" / "scripts"


def read_picture(path: Path) -> NDArray[Any]:
    """Height x width x 3, 0 to 1."""
    return np.asarray(matplotlib.image.imread(path))[:, :, :3]


def drawn_share(picture: NDArray[Any]) -> float:
    return float((picture < 0.98).any(axis=2).mean())


def test_the_demo_leaves_a_smoother_bunny_and_a_picture_of_both(
    samples: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "demo"
    done = python(SCRIPTS / "demo.py", folder)
    assert done.returncode == 0, done.stderr
    assert "Largest displacement" in done.stdout
    assert sorted(path.name for path in folder.iterdir()) == [
        "before_after.png",
        "bunny_filtered.ply",
    ]
    areas = []
    for path in (samples / "bunny.obj", folder / "bunny_filtered.ply"):
        mesh_set = loaded(path)
        areas.append(mesh_set.get_geometric_measures()["surface_area"])
    assert areas[1] < 0.95 * areas[0]

    picture = read_picture(folder / "before_after.png")
    assert picture.shape == (800, 1600, 3)
    before, after = picture[:, :800], picture[:, 800:]
    for panel in (before, after):
        assert 0.2 < drawn_share(panel) < 0.8
        assert (panel[:5] > 0.98).all(), "the mesh must not touch the edge"
    assert np.abs(before - after).max() > 0.2


def test_all_panels_have_the_camera_of_the_first(decimated: Decimated, tmp_path: Path) -> None:
    V, F = decimated("cow.obj")
    small = Panel("", 0.5 * V, F)
    whole = Panel("", V, F)
    path = tmp_path / "cows.png"
    draw_side_by_side([whole, small, whole], path, view=View((1, 0, 0)), panel_size=(300, 200))
    picture = read_picture(path)
    assert picture.shape == (200, 900, 3)
    first, second, third = picture[:, :300], picture[:, 300:600], picture[:, 600:]
    np.testing.assert_array_equal(first, third)
    # Half as large in both directions.
    assert 0.2 < drawn_share(second) / drawn_share(first) < 0.3


def test_a_panel_is_lit_as_if_it_were_alone(decimated: Decimated, tmp_path: Path) -> None:
    panel = Panel("", *decimated("cow.obj"))
    for count, name in ((1, "alone.png"), (3, "beside.png")):
        draw_side_by_side([panel] * count, tmp_path / name, panel_size=(300, 200))
    alone = read_picture(tmp_path / "alone.png")
    beside = np.split(read_picture(tmp_path / "beside.png"), 3, axis=1)
    for picture in beside:
        assert np.abs(picture - alone).mean() < 0.01
