"""A mesh filtered in tiles is that filtered as a whole."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from meshlab_spectral import FilterOptions
from meshlab_spectral.files.filtering import filter_to_scratch
from meshlab_spectral.files.request import Request
from meshlab_spectral.formats import ply, stl
from meshlab_spectral.tiles.run import filter_in_tiles
from shapes import grid, quads
from tiled_meshes import bumpy_torus, shuffled, write_ply, write_stl

TOLERATED = 1e-6  # of the diagonal
SIDE = 200
Both = Callable[..., tuple[Path, Path, dict[str, Any]]]


def _ignore(*_: object) -> None:
    pass


@pytest.fixture
def both(tmp_path: Path) -> Both:
    """A file filtered as a whole, and in tiles."""

    def run(source: Path, tiles: int, **options: Any) -> tuple[Path, Path, dict[str, Any]]:
        whole, tiled = (tmp_path / f"{name}{source.suffix}" for name in ("whole", "tiled"))
        given = FilterOptions(**options)
        filter_to_scratch(Request(source, given, verbose=False), whole, _ignore)
        report = filter_in_tiles(source, tiled, given, _ignore, tiles, _ignore)
        assert sorted(tmp_path.iterdir()) == sorted([source, whole, tiled])
        return whole, tiled, report

    return run


def _largest_difference(whole: Path, tiled: Path) -> float:
    reader = stl if whole.suffix == ".stl" else ply
    (a,), (b,) = (reader.read(path).parts for path in (whole, tiled))
    difference = np.linalg.norm(a.vertices - b.vertices, axis=1).max()
    return float(difference / np.linalg.norm(np.ptp(a.vertices, axis=0)))


LOW_PASS: dict[str, Any] = {"feature_size": "6e"}
BUTTERWORTH = {**LOW_PASS, "response": "butterworth"}
BAND = {"feature_size": "4e", "filter_type": "band-pass", "stop_gain": 1.0, "pass_gain": 2.0}
SHARPENING = {"feature_size": "4e", "filter_type": "high-pass", "stop_gain": 1.0, "pass_gain": 1.5}
EQUALIZER = {
    "filter_type": "custom",
    "transfer_function": "96e:1, 48e:1, 24e:1, 12e:1, 6e:0.8, 3e:0.5",
}
CURVE = {**LOW_PASS, "filter_type": "custom", "transfer_function": "1/(1+0.5*w^4)"}


@pytest.mark.parametrize(
    ("options", "tiles"),
    [
        (LOW_PASS, 64),
        ({**LOW_PASS, "laplacian": "cotangent", "steps": 2}, 8),
        ({**LOW_PASS, "basis_update": "none"}, 8),
        ({**LOW_PASS, "boundary": "fixed", "crease_angle": 30.0}, 8),
        (BUTTERWORTH, 8),
        ({**BAND, "steps": 2}, 8),
        ({**SHARPENING, "steps": 2}, 8),
        ({**EQUALIZER, "steps": 1}, 8),
        (CURVE, 8),
    ],
    ids=[
        "low-pass",
        "cotangent",
        "none",
        "fixed",
        "butterworth",
        "band",
        "sharpening",
        "equalizer",
        "curve",
    ],
)
def test_every_filter_in_tiles_is_that_of_the_whole(
    options: dict[str, Any], tiles: int, tmp_path: Path, both: Both
) -> None:
    source = tmp_path / "mesh.ply"
    write_ply(source, *bumpy_torus(SIDE), "<f8")
    whole, tiled, report = both(source, tiles, **options)
    assert report["tiles"] == tiles
    assert _largest_difference(source, whole) > 100 * TOLERATED
    assert _largest_difference(whole, tiled) < TOLERATED


def test_shuffled_and_big_endian_files_keep_all_their_properties(
    tmp_path: Path, both: Both
) -> None:
    V, F = shuffled(*bumpy_torus(SIDE))
    source, rng = tmp_path / "mesh.ply", np.random.default_rng(1)
    normals = rng.normal(size=V.shape).astype("f4")
    columns = dict(zip(["nx", "ny", "nz"], normals.T, strict=True))
    columns |= {"red": rng.integers(0, 256, len(V)).astype("u1"), "quality": V[:, 0]}
    write_ply(source, V, F, ">f8", columns)
    whole, tiled, _ = both(source, 8, **LOW_PASS)
    assert _largest_difference(whole, tiled) < TOLERATED
    a, b = (ply.read(path) for path in (whole, tiled))
    assert a.header == b.header
    np.testing.assert_array_equal(a.rows["red"], b.rows["red"])
    np.testing.assert_array_equal(a.rows["quality"], b.rows["quality"])
    assert a.normals is not None
    assert b.normals is not None
    np.testing.assert_allclose(a.normals, b.normals, atol=1e-3)
    np.testing.assert_array_equal(a.parts[0].faces, b.parts[0].faces)


def test_single_precision_is_widened_where_the_whole_file_would_be(
    tmp_path: Path, both: Both
) -> None:
    V, F = bumpy_torus(100)
    source = tmp_path / "mesh.ply"
    write_ply(source, V + np.array([3e5, 0, 0]), F)
    whole, tiled, report = both(source, 8, **LOW_PASS)
    assert ply.read(whole).header == ply.read(tiled).header
    assert b"double x" in ply.read(tiled).header
    assert any("double precision" in warning for warning in report["warnings"])


def test_corners_of_an_stl_file_stay_together(tmp_path: Path, both: Both) -> None:
    source = tmp_path / "mesh.stl"
    V, F = shuffled(*bumpy_torus(SIDE))
    write_stl(source, V, F)
    whole, tiled, _ = both(source, 8, **LOW_PASS)
    (part,) = stl.read(tiled).parts
    assert part.vertices.shape == V.shape
    assert _largest_difference(whole, tiled) < TOLERATED


def test_only_what_is_selected_moves_by_its_weight(tmp_path: Path, both: Both) -> None:
    V, F = bumpy_torus(SIDE)
    source, flags = tmp_path / "mesh.ply", np.zeros(len(F), "i4")
    flags[V[F[:, 0], 0] > 1.0] = 0x20
    weight = np.clip(0.5 + V[:, 1], 0, 1).astype("f4")
    write_ply(source, V, F, "<f8", {"quality": weight}, flags)
    whole, tiled, _ = both(source, 16, **LOW_PASS, selected=True, weight="vertex quality")
    moved = (ply.read(tiled).parts[0].vertices != V).any(axis=1)
    assert 0.1 < moved.mean() < 0.5
    assert _largest_difference(whole, tiled) < TOLERATED


def test_a_thin_part_in_one_tile_counts_in_all(tmp_path: Path, both: Both) -> None:
    V, F = bumpy_torus(100)
    thin = V * [1, 1, 0.02] * 0.3 + [8, 0, 0]
    source = tmp_path / "mesh.ply"
    write_ply(source, np.vstack([V, thin]), np.vstack([F, F + len(V)]), "<f8")
    # By default, factorizations are accurate to two thousandths of an edge.
    whole, tiled, report = both(source, 8, tolerance="0.0004%", passes=2)
    assert report["thin_part_factor"] > 2
    # Less accurate at vertices with hardly any area; decided by each tile, parts differ by 1e-3.
    assert _largest_difference(whole, tiled) < 10 * TOLERATED


def test_debris_and_points_without_faces_are_no_obstacle(tmp_path: Path, both: Both) -> None:
    V, F = bumpy_torus(100)
    debris = np.array([[9.0, 0, 0], [9.01, 0, 0], [9, 0.01, 0], [-9, 1, 1]])
    source = tmp_path / "mesh.ply"
    write_ply(source, np.vstack([V, debris]), np.vstack([F, [[10000, 10001, 10002]]]), "<f8")
    whole, tiled, _ = both(source, 8, feature_size="6e", passes=1)
    # Debris needs factorizations, which are accurate to two thousandths of an edge, here of a
    # hundredth of the diagonal.
    assert _largest_difference(whole, tiled) < 20 * TOLERATED
    np.testing.assert_array_equal(ply.read(tiled).parts[0].vertices[-1], debris[-1])


def test_missing_data_of_a_terrain_are_left_out_of_sizes(tmp_path: Path, both: Both) -> None:
    side = 80
    V = np.array([[i, j, np.sin(i / 4) * np.cos(j / 5)] for i in range(side) for j in range(side)])
    V[[1000, 1001, 1002, 1081, 1082], 2] = -9999.0
    write_ply(source := tmp_path / "terrain.ply", V, quads(grid(side, side)), "<f8")
    whole, tiled, report = both(source, 4, feature_size="6e", steps=1)
    assert report["feature_size"] < 9.0
    (warning,) = [one for one in report["warnings"] if "enlarge the diagonal" in one]
    assert warning.startswith("vertices without faces, or for missing data, enlarge")
    assert _largest_difference(whole, tiled) < 0.01 * TOLERATED  # of a diagonal of 10,000
