"""Files that are one surface are filtered as one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from batches import REPORT, records
from commands import command, succeeded
from meshlab_spectral import OptionError, filter_mesh
from meshlab_spectral.batch.files import filter_files
from meshlab_spectral.formats import ply
from shapes import grid, quads
from tiled_meshes import Array, Indices, write_ply

OPTIONS: dict[str, Any] = {"feature_size": 8.0, "steps": 1}
Cut = tuple[Array, Indices, list[Indices]]


def _terrain(side: int = 41) -> tuple[Array, Indices]:
    """A rough plane with edges of length 1."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(side), np.arange(side), indexing="ij"))
    height = 2 * np.sin(x / 5) + np.random.default_rng(0).normal(size=len(x)) / 4
    V = np.column_stack([x, y, height]).astype("f4").astype(float)
    return V, quads(grid(side, side))


@pytest.fixture
def terrain(tmp_path: Path) -> Cut:
    """A terrain, and four files of parts of it with the numbers of their vertices."""
    V, F = _terrain()
    middle = (V[F].mean(axis=1)[:, :2] > 20).astype(int) @ [1, 2]
    parts = []
    for k in range(4):
        ids, corners = np.unique(F[middle == k], return_inverse=True)
        write_ply(tmp_path / "in" / f"part{k}.ply", V[ids], corners.reshape(-1, 3))
        parts.append(ids)
    return V, F, parts


@pytest.fixture(autouse=True)
def folder(tmp_path: Path) -> Path:
    (tmp_path / "in").mkdir()
    return tmp_path / "in"


def _vertices(path: Path) -> Array:
    return ply.read(path).parts[0].vertices


def test_parts_of_a_terrain_have_no_gaps_and_are_those_of_the_whole(
    folder: Path, terrain: Cut, tmp_path: Path
) -> None:
    V, F, parts = terrain
    whole, _ = filter_mesh(V, F, **OPTIONS)
    results = list(filter_files(folder, tmp_path / "out", joined=True, **OPTIONS))
    assert [result.outcome for result in results] == 4 * ["filtered"]
    together: dict[int, Array] = {}
    for k, ids in enumerate(parts):
        moved = _vertices(tmp_path / "out" / f"part{k}.ply")
        np.testing.assert_allclose(moved, whole[ids], atol=1e-4)
        for number, position in zip(ids.tolist(), moved, strict=True):
            np.testing.assert_array_equal(together.setdefault(number, position), position)
    assert len(together) == len(V)


def test_labels_that_touch_stay_together(folder: Path, tmp_path: Path) -> None:
    V, F = _terrain(21)
    rim = (V[:, :2] % 20 == 0).any(axis=1)
    for name, height in (("below", -8.0), ("above", 8.0)):
        far = np.where(rim[:, None], V, V * [1, 1, 0] + [0, 0, height])
        write_ply(folder / f"{name}.ply", np.vstack([V, far]), np.vstack([F, F[:, ::-1] + len(V)]))
    for result in filter_files(folder, tmp_path / "out", joined=True, **OPTIONS):
        assert result.outcome == "filtered"
    below, above = (_vertices(tmp_path / "out" / f"{name}.ply") for name in ("below", "above"))
    np.testing.assert_array_equal(below[: len(V)], above[: len(V)])
    assert np.abs(below[: len(V)] - V).max() > 0.1


@pytest.mark.usefixtures("terrain")
def test_one_changed_file_changes_all(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = ["batch", folder, "-o", out, "--joined", "--feature-size", 8, "--steps", 1]
    succeeded(*arguments)
    again = command(*arguments, "--resume")
    assert "4 already done" in again.stdout + again.stderr
    before = (out / "part0.ply").read_bytes()
    V, F = _terrain()
    write_ply(folder / "part3.ply", V + np.array([0, 0, 1e-3]), F)
    succeeded(*arguments, "--resume")
    assert len(records(out / REPORT)) == 8
    assert (out / "part0.ply").read_bytes() != before


@pytest.mark.usefixtures("terrain")
def test_one_bad_file_fails_all(folder: Path, tmp_path: Path) -> None:
    (folder / "part2.ply").write_bytes(b"ply\n")
    results = list(filter_files(folder, tmp_path / "out", joined=True, **OPTIONS))
    assert [result.outcome for result in results] == 4 * ["failed"]
    assert all("part2.ply" in str(result.reason) for result in results)
    assert not list((tmp_path / "out").glob("*.ply"))


@pytest.mark.parametrize(
    "more", [{"scheduler": "host:8786"}, {"result": "details"}], ids=["scheduler", "details"]
)
def test_what_cannot_be_joined_is_refused(
    more: dict[str, Any], folder: Path, terrain: Cut, tmp_path: Path
) -> None:
    with pytest.raises(OptionError, match="joined files"):
        next(filter_files(folder, tmp_path / "out", joined=True, **more))


def test_levels_of_detail_have_no_gaps(folder: Path, tmp_path: Path) -> None:
    """Tiles of an octree: to the bit where a vertex hangs in the middle of a coarser edge."""
    for row in range(3):
        for column in range(3):
            cells = 4 * 2 ** ((row + column) % 3)
            x, y = np.meshgrid(np.arange(cells + 1), np.arange(cells + 1), indexing="ij")
            F = quads(grid(cells + 1, cells + 1))
            x, y = (8 * one.ravel() / cells + 8 * k for one, k in ((x, row), (y, column)))
            height = np.where((x % 8 > 0) & (y % 8 > 0), np.sin(3 * x + 5 * y), 0)
            V = np.column_stack([x, y, 0.5 * height])
            write_ply(folder / f"tile{row}{column}.ply", V, F, "<f8")
    before = {path.name: _vertices(path) for path in sorted(folder.iterdir())}
    results = list(filter_files(folder, tmp_path / "out", joined=True, **OPTIONS))
    assert {result.outcome for result in results} == {"filtered"}
    after = {name: _vertices(tmp_path / "out" / name) for name in before}
    at: dict[tuple[float, ...], Array] = {}
    for name, V in before.items():
        for place, position in zip(V[:, :2].tolist(), after[name], strict=True):
            np.testing.assert_array_equal(at.setdefault(tuple(place), position), position)
    hanging = 0
    for name in before:
        row, column = int(name[4]), int(name[5])
        size = 2.0 / 2 ** ((row + column) % 3)
        for line in (0, 8):
            for start in np.arange(0, 8, size):
                for share in (0.25, 0.5, 0.75):
                    ends = [(line, start), (line, start + size), (line, start + share * size)]
                    for turn in (False, True):
                        places = [(p[::-1] if turn else p) for p in ends]
                        keys = [(8.0 * row + p[0], 8.0 * column + p[1]) for p in places]
                        if keys[2] in at:
                            a, b, h = (at[key] for key in keys)
                            np.testing.assert_array_equal(h, (1 - share) * a + share * b)
                            hanging += 1
    assert hanging > 50
