"""A mesh that a scene has in several places: all are written where each is a mesh of its own."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from helpers import filter_file
from meshlab_spectral import DenoiseOptions, FilterOptions, compare
from meshlab_spectral.files.measures import mesh_info
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.files.request import Request
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.formats.placement import Placement, placement_of
from meshlab_spectral.warned import Warned
from numpy.typing import NDArray

SMOOTH = FilterOptions(feature_size="30%")
SHIFT, MIRROR, HIDDEN = (np.eye(4), np.diag([1.0, 1.0, -1.0, 1.0]), np.diag([0.0, 0.0, 0.0, 1.0]))
SHIFT[0, 3], MIRROR[1, 3] = 5, 7


def scene(path: Path, *others: NDArray[Any]) -> Path:
    """A noisy sphere, and the same once more for each transform."""
    ball = trimesh.creation.icosphere(3)
    ball.vertices *= 1 + 0.01 * np.random.default_rng(4).standard_normal((len(ball.vertices), 1))
    if path.suffix == ".3mf":
        return write_3mf(path, ball, (np.eye(4), *others))
    made = trimesh.Scene()
    made.add_geometry(ball, geom_name="ball", node_name="0")
    for number, matrix in enumerate(others, 1):
        made.graph.update(frame_to=str(number), geometry="ball", matrix=matrix)
    made.export(path)
    return path


def write_3mf(path: Path, mesh: trimesh.Trimesh, matrices: Sequence[NDArray[Any]]) -> Path:
    """Write a mesh that is built several times."""
    rows = ["<vertex x='{}' y='{}' z='{}'/>".format(*row) for row in mesh.vertices.tolist()]
    faces = ["<triangle v1='{}' v2='{}' v3='{}'/>".format(*row) for row in mesh.faces.tolist()]
    items = [
        f"<item objectid='1' transform='{' '.join(map(str, matrix[:3].T.ravel().tolist()))}'/>"
        for matrix in matrices
    ]
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("_rels/.rels", "<r><r Type='/3dmodel' Target='/3D/a.model'/></r>")
        file.writestr(
            "3D/a.model",
            f"<model><resources><object id='1' name='ball'><mesh><vertices>{''.join(rows)}"
            f"</vertices><triangles>{''.join(faces)}</triangles></mesh></object></resources>"
            f"<build>{''.join(items)}</build></model>",
        )
    return path


@pytest.mark.parametrize("options", [SMOOTH, DenoiseOptions()], ids=["filter", "denoise"])
@pytest.mark.parametrize("ending", ["glb", "gltf", "3mf"])
def test_a_conversion_writes_every_place(ending: str, options: Options, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    source = scene(tmp_path / "in" / f"in.{ending}", SHIFT, MIRROR, SHIFT)
    kept, converted = tmp_path / "out" / f"out.{ending}", tmp_path / "out.ply"
    kept.parent.mkdir()
    report = filter_file(source, kept, options)
    again = filter_file(source, converted, options)
    assert again["max_displacement"] == report["max_displacement"]
    V, F = load_arrays(kept)
    expected = np.vstack([V, *(V @ m[:3, :3].T + m[:3, 3] for m in (SHIFT, MIRROR))])
    found, faces = load_arrays(converted)
    np.testing.assert_allclose(found, expected, atol=1e-5)
    assert len(faces) == 3 * len(F)
    a, b, c = (found[faces[:, k]] for k in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)).reshape(3, -1).sum(axis=1)
    np.testing.assert_allclose(volumes, volumes[0], rtol=1e-4)  # no copy is inside out
    assert compare(kept, converted).same_faces


def test_what_is_hidden_by_a_scale_of_zero_is_not_written(tmp_path: Path) -> None:
    source = scene(tmp_path / "in.glb", HIDDEN)
    filter_file(source, tmp_path / "out.obj", SMOOTH)
    assert len(load_arrays(tmp_path / "out.obj")[1]) == len(load_arrays(source)[1])


def test_the_description_says_that_it_is_of_one_place(tmp_path: Path) -> None:
    source = scene(tmp_path / "in.glb", SHIFT)
    warnings = mesh_info(Request(source), lambda *stage: None)["warnings"]
    assert any("ball is placed 2 times: it is described once" in one for one in warnings)
    alone = scene(tmp_path / "alone.glb")
    assert not any(
        "placed" in one for one in mesh_info(Request(alone), lambda *stage: None)["warnings"]
    )


def test_copies_are_where_the_first_place_would_be_taken_to() -> None:
    own = np.random.default_rng(3).standard_normal((5, 3))
    turned = trimesh.transformations.rotation_matrix
    first, second = turned(0.7, [1, 2, 3]), turned(-1.9, [0, 1, -2])
    first[:3, 3], second[:3, 3] = (1, 2, 3), (-5, 0, 4)
    told: list[Warned] = []
    placement = placement_of("ball", [first, second], told)
    (copy,) = placement.copies
    moved = Placement(copy).placed(placement.placed(own))
    np.testing.assert_allclose(moved, Placement(second).placed(own), atol=1e-12)
    assert not told
    placement_of("ball", [first, second @ np.diag([1.001, 1, 1, 1])], told)
    assert "at different scales" in told[0]
