"""A mesh denoised in tiles is as good as one denoised as a whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from meshlab_spectral import DenoiseOptions
from meshlab_spectral.errors import UntiledError
from meshlab_spectral.files.filtering import filter_to_scratch
from meshlab_spectral.files.request import Request
from meshlab_spectral.formats import ply
from meshlab_spectral.formats.opening import open_rows
from meshlab_spectral.tiles.cells import near_cells, split
from meshlab_spectral.tiles.run import filter_in_tiles
from meshlab_spectral.tiles.survey import survey
from tiled_meshes import Array, Indices, bumpy_torus, write_ply

SIDE, SMALL, TILES = 300, 200, 4
NOISY = 4.0  # a quarter of an edge


def _ignore(*_: object) -> None:
    pass


def _degrees(V: Array, truth: Array, F: Indices) -> Array:
    """Angles between the normals of faces and the true ones."""
    normals = [np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]]) for X in (V, truth)]
    a, b = (N / np.linalg.norm(N, axis=1, keepdims=True) for N in normals)
    return np.degrees(np.arccos(np.clip((a * b).sum(axis=1), -1, 1)))


def _tiles_of(source: Path, V: Array) -> Indices:
    """The tile that owns each vertex."""
    tree = split(survey(open_rows(source), _ignore).sample, TILES)
    owner = np.zeros(len(V), int)
    for tile, rows in near_cells(tree, V, V, 0.0):
        owner[rows] = tile
    return owner


def _with_correlated_noise(V: Array, F: Indices) -> Array:
    """A surface with noise that is alike over two edges, along its normals."""
    noise = np.random.default_rng(1).normal(size=len(V))
    ends = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    for _ in range(2):
        noise = (noise + np.bincount(ends[:, 0], noise[ends[:, 1]], len(V)) / 6) / 2
    corners = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    N = np.stack([np.bincount(F.ravel(), np.repeat(one, 3), len(V)) for one in corners.T], -1)
    N /= np.linalg.norm(N, axis=1, keepdims=True)
    return np.asarray(V + 0.01 * (noise / noise.std())[:, None] * N)


@pytest.mark.parametrize("kind", ["white", "correlated"])
def test_tiles_come_as_near_to_the_truth_as_the_whole(kind: str, tmp_path: Path) -> None:
    truth, F = bumpy_torus(SIDE, 0.0)
    V = bumpy_torus(SIDE, NOISY)[0] if kind == "white" else _with_correlated_noise(truth, F)
    source, whole, tiled = (tmp_path / f"{name}.ply" for name in ("mesh", "whole", "tiled"))
    write_ply(source, V, F, "<f8")
    filter_to_scratch(Request(source, DenoiseOptions(), verbose=False), whole, _ignore)
    report = filter_in_tiles(source, tiled, DenoiseOptions(), _ignore, TILES, _ignore)
    given, as_whole, in_tiles = (
        _degrees(ply.read(path).parts[0].vertices, truth, F) for path in (source, whole, tiled)
    )
    assert report["tiles"] == TILES
    assert "as measured in tiles" in report["summary"]
    assert as_whole.mean() < 0.9 * given.mean()
    assert abs(in_tiles.mean() - as_whole.mean()) < 0.1
    owner = _tiles_of(source, V)[F]
    at_seam = (owner != owner[:, :1]).any(axis=1)
    assert 500 < at_seam.sum() < 0.1 * len(F)
    # The whole may be better or worse there.
    assert in_tiles[at_seam].mean() < as_whole[at_seam].mean() + 0.1


def test_a_clean_mesh_keeps_every_bit(tmp_path: Path) -> None:
    source, tiled = tmp_path / "mesh.ply", tmp_path / "tiled.ply"
    write_ply(source, *bumpy_torus(SIDE, 0.0))
    report = filter_in_tiles(source, tiled, DenoiseOptions(), _ignore, TILES, _ignore)
    assert report["rounds"] == 0
    assert tiled.read_bytes() == source.read_bytes()


def test_noise_that_differs_from_place_to_place_needs_a_height(tmp_path: Path) -> None:
    truth, F = bumpy_torus(SMALL, 0.0)
    noisy = bumpy_torus(SMALL, NOISY)[0]
    source, tiled = tmp_path / "mesh.ply", tmp_path / "tiled.ply"
    write_ply(source, np.where(truth[:, :1] > 0, noisy, truth), F)
    with pytest.raises(UntiledError, match="give noise_height"):
        filter_in_tiles(source, tiled, DenoiseOptions(), _ignore, TILES, _ignore)
    stored = DenoiseOptions(store_noise_height=True)
    with pytest.raises(UntiledError, match="store_noise_height"):
        filter_in_tiles(source, tiled, stored, _ignore, TILES, _ignore)
    assert not tiled.exists()
    given = DenoiseOptions(noise_height="0.2e")
    assert filter_in_tiles(source, tiled, given, _ignore, TILES, _ignore)["rounds"] > 0
