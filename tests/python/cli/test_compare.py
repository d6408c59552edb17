"""The command `meshlab-spectral compare`: numbers, the coloured mesh, the picture, messages."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib.image
import numpy as np
import plyfile
import pytest
from commands import command, succeeded
from helpers import loaded, mesh_set_of
from meshlab_spectral import compare
from shapes import sphere


@pytest.fixture
def pair(tmp_path: Path) -> tuple[Path, Path]:
    """A sphere, and the same faces on a larger one with a dent."""
    V, F = sphere(4)
    a, b = tmp_path / "a.ply", tmp_path / "b.ply"
    mesh_set_of(V, F).save_current_mesh(str(a))
    W = 1.02 * V - np.outer(0.1 * np.exp(-20 * ((V - [1, 0, 0]) ** 2).sum(1)), [1, 0, 0])
    mesh_set_of(W, F).save_current_mesh(str(b))
    return a, b


def test_the_numbers_are_those_of_the_function(pair: tuple[Path, Path]) -> None:
    record = json.loads(succeeded("compare", *pair, "--json").stdout)
    assert record.pop("a") == str(pair[0])
    assert record.pop("b") == str(pair[1])
    assert record == compare(*pair).report
    shown = succeeded("compare", *pair)
    assert "Along the normal" in shown.stdout
    assert "Volume" in shown.stdout
    equal = command("compare", pair[0], pair[0]).stdout
    assert "the surfaces are equal" in equal
    assert "vertex" not in equal


def test_the_coloured_mesh_is_b_with_the_deviation(pair: tuple[Path, Path], tmp_path: Path) -> None:
    output = tmp_path / "change.ply"
    assert (
        json.loads(succeeded("compare", *pair, "--output", output, "--json").stdout)[
            "colour_extent"
        ]
        == compare(*pair).color_extent
    )
    read, b = plyfile.PlyData.read(output)["vertex"], plyfile.PlyData.read(pair[1])["vertex"]
    for axis in "xyz":
        np.testing.assert_array_equal(read[axis], b[axis])
    signed = compare(*pair).signed
    np.testing.assert_array_equal(read["quality"], signed)
    outside, inside = signed > 0.01, signed < -0.01
    assert outside.any()
    assert inside.any()
    assert (read["red"][outside] == 255).all()
    assert (read["blue"][outside] < 255).all()
    assert (read["blue"][inside] == 255).all()
    assert (read["red"][inside] < 255).all()
    opened = loaded(output)
    assert opened.current_mesh().has_vertex_scalar()
    assert opened.current_mesh().has_vertex_color()


def test_the_picture_shows_both_meshes_and_the_deviation_in_colours(
    pair: tuple[Path, Path], tmp_path: Path
) -> None:
    path = tmp_path / "change.png"
    succeeded("compare", *pair, "--picture", path)
    pixels = matplotlib.image.imread(path)
    assert pixels.shape[1] > 900
    saturation = np.ptp(pixels[: -pixels.shape[0] // 3, :, :3], axis=2) > 0.3
    third = pixels.shape[1] // 3
    assert not saturation[:, : 2 * third].any()
    assert saturation[:, 2 * third :].mean() > 0.2


def test_no_input_is_replaced_under_another_name(pair: tuple[Path, Path], tmp_path: Path) -> None:
    other = tmp_path / "other.ply"
    other.hardlink_to(pair[0])
    refused = command("compare", *pair, "--output", other, "--overwrite")
    assert refused.returncode == 2
    assert "is an input itself and would be lost" in refused.stderr
