"""The command `meshlab-spectral texture`: numbers, the coloured mesh, messages."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import matplotlib.image
import numpy as np
import plyfile
import pymeshlab
import pytest
from commands import PRECIOUS, command, succeeded
from helpers import mesh_set_of
from meshlab_spectral import compare, surface_texture
from shapes import grid, quads, sphere


@pytest.fixture
def rough(tmp_path: Path) -> Path:
    """A sphere with random heights."""
    V, F = sphere(5)
    V = V * (1 + 0.003 * np.random.default_rng(1).standard_normal(len(V)))[:, None]
    path = tmp_path / "rough.ply"
    mesh_set_of(V, F).save_current_mesh(str(path))
    return path


def test_numbers_and_mesh_are_those_of_the_function(rough: Path, tmp_path: Path) -> None:
    output = tmp_path / "heights.ply"
    record = json.loads(
        succeeded("texture", rough, "--waviness", "0.3", "--json", "--output", output).stdout
    )
    read = plyfile.PlyData.read(rough)
    V = np.column_stack([read["vertex"][axis] for axis in "xyz"]).astype(float)
    F = np.vstack(read["face"]["vertex_indices"])
    texture = surface_texture(V, F, waviness=0.3)
    for name, value in texture.report.items():
        assert record[name] == value, name
    written = plyfile.PlyData.read(output)["vertex"]
    np.testing.assert_array_equal(written["quality"], texture.height)
    assert (written["red"][texture.height > 0] == 255).all()
    assert (written["blue"][texture.height < 0] == 255).all()


def test_the_table_has_the_parameters_of_the_standard(rough: Path) -> None:
    done = succeeded("texture", rough, "--waviness", "0.3")
    for name in ("Sa", "Sq", "Ssk", "Sku", "Sp", "Sv", "Sz", "Sdq", "Sdr"):
        assert f"{name}, " in done.stdout


def assert_shows_the_deviation(path: Path) -> None:
    """Before and after are grey, on their right is the deviation in colours."""
    pixels = matplotlib.image.imread(path)
    saturated = np.ptp(pixels[: -pixels.shape[0] // 3, :, :3], axis=2) > 0.15
    third = pixels.shape[1] // 3
    assert not saturated[:, : 2 * third].any()
    assert saturated[:, 2 * third :].mean() > 0.05


def test_filter_draws_before_after_and_deviation(rough: Path, tmp_path: Path) -> None:
    path = tmp_path / "change.png"
    succeeded("filter", rough, tmp_path / "out.ply", "--picture", path)
    assert_shows_the_deviation(path)


def test_files_in_colours_are_replaced_only_with_overwrite(rough: Path, tmp_path: Path) -> None:
    for option, ending in (("--picture", "png"), ("--color-displacement", "ply")):
        output, path = tmp_path / f"out{ending}.ply", tmp_path / f"change.{ending}"
        path.write_bytes(PRECIOUS)
        done = command("denoise", rough, output, option, path)
        assert done.returncode == 2
        assert f"{path} exists" in done.stderr
        assert not output.exists()
        assert path.read_bytes() == PRECIOUS
        done = succeeded("denoise", rough, output, option, path, "--overwrite")
        assert path.read_bytes() != PRECIOUS
    assert_shows_the_deviation(tmp_path / "change.png")


def test_the_coloured_mesh_of_a_filter_is_that_of_the_comparison(
    rough: Path, tmp_path: Path
) -> None:
    output, coloured, change = (tmp_path / f"{name}.ply" for name in ("out", "colours", "change"))
    done = succeeded("filter", rough, output, "--color-displacement", coloured)
    succeeded("compare", rough, output, "--output", change)
    assert coloured.read_bytes() == change.read_bytes()
    compared = compare(rough, output)
    vertices = plyfile.PlyData.read(coloured)["vertex"]
    levels = np.column_stack([vertices[name] for name in ("red", "green", "blue")])
    np.testing.assert_array_equal(levels, compared.colors)
    assert f"red {compared.color_extent:.3g} outwards" in done.stdout
    same = command("filter", rough, output, "--color-displacement", output, "--overwrite")
    assert same.returncode == 2
    assert "is OUTPUT" in same.stderr


def test_the_selection_of_a_file_is_measured(tmp_path: Path) -> None:
    made = pymeshlab.MeshSet()
    made.create_sphere(subdiv=4)
    made.compute_selection_by_condition_per_face(condselect="z0 > 0")
    path = tmp_path / "half.ply"
    made.save_current_mesh(str(path), save_vertex_flag=True, save_face_flag=True)
    record = json.loads(
        succeeded(
            "texture", path, "--waviness", "0.3", "--form", "sphere", "--json", "--selected"
        ).stdout
    )
    assert 0 < record["vertices_evaluated"] < made.current_mesh().vertex_number() * 0.6
    assert record["form_radius"] == pytest.approx(1, rel=0.01)


def test_other_files_are_replaced_on_request_only(rough: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.ply"
    for arguments in (["texture", rough], ["compare", rough, rough]):
        other.write_text("precious")
        done = command(*arguments, "--output", other)
        assert (done.returncode, other.read_text()) == (2, "precious")
        assert "replace it with --overwrite" in done.stderr
        succeeded(*arguments, "--output", other, "-f")
        assert other.read_bytes().startswith(b"ply")


@pytest.fixture
def block(tmp_path: Path) -> Path:
    """A closed box of 4 x 4 x 1 with a rough top."""
    n = 61
    x, y = (axis.ravel() for axis in np.meshgrid(*2 * [np.linspace(0, 4, n)], indexing="ij"))
    rim = (x == 0) | (x == 4) | (y == 0) | (y == 4)
    wave = np.where(rim, 0, 0.02 * np.cos(2 * np.pi * x / 0.5))
    top, base = np.column_stack([x, y, 1 + wave]), np.column_stack([x, y, 0 * x])
    i = grid(n, n)
    up = quads(i)
    loop = np.concatenate([i[:-1, 0], i[-1, :-1], i[:0:-1, -1], i[0, :0:-1]])
    after, below = np.roll(loop, -1), n * n
    sides = [[loop, loop + below, after + below], [loop, after + below, after]]
    F = np.vstack([up, up[:, ::-1] + below, *(np.column_stack(one) for one in sides)])
    path = tmp_path / "block.ply"
    mesh_set_of(np.vstack([top, base]), F).save_current_mesh(str(path))
    return path


def test_a_region_of_a_closed_block_is_its_top(block: Path, tmp_path: Path) -> None:
    measure = ["texture", block, "--form", "plane", "--waviness", "1", "--json"]
    refused = command(*measure)
    assert refused.returncode == 2
    assert "as much of the surface faces backwards" in refused.stderr
    mask = tmp_path / "mask.txt"
    np.savetxt(mask, np.repeat([1, 0], 61 * 61))
    exact = 0.02 / np.sqrt(2) * (1 - 2**-4)
    for region in (["--where", "nz > 0.5"], ["--box", "0,0,0.5,4,4,inf"], ["--mask", mask]):
        done = succeeded(*measure, *region)
        assert json.loads(done.stdout)["Sq"] == pytest.approx(exact, rel=0.03)
    nowhere = command(*measure, "--box", "9,9,9,10,10,10")
    assert nowhere.returncode == 2
    assert "no vertex is there" in nowhere.stderr


def test_many_files_are_one_table(rough: Path, tmp_path: Path) -> None:
    other, broken = tmp_path / "other.ply", tmp_path / "broken.ply"
    other.write_bytes(rough.read_bytes())
    broken.write_text("no mesh")
    rows = tmp_path / "table.csv"
    measure = ["texture", rough, broken, other, "--waviness", "0.3", "--unit", "mm"]
    done = command(*measure, "--csv", rows, "--smr", "0")
    assert done.returncode == 1
    assert "broken.ply" in done.stderr
    assert "lengths in mm" in done.stdout
    with rows.open(newline="", encoding="utf-8") as file:
        read = list(csv.DictReader(file))
    assert [Path(row["input"]).name for row in read] == ["rough.ply", "other.ply"]
    assert read[0]["Sq"] == read[1]["Sq"]
    assert read[0]["unit"] == "mm"
    assert float(read[0]["Smr(0)"]) == pytest.approx(0.5, abs=0.02)
    assert command(*measure, "--csv", rows).returncode == 2  # not replaced
    record = json.loads(command(*measure, "--json").stdout)
    assert len(record["files"]) == 2
    assert float(read[0]["Sq"]) == record["files"][0]["Sq"]
    alone = succeeded("texture", rough, *measure[4:], "--smr", "0").stdout
    share = re.search(r"Smr\(0\) .* ([0-9.]+) %", alone)
    assert share
    assert float(share[1]) == pytest.approx(100 * float(read[0]["Smr(0)"]), rel=1e-3)
    one = command("texture", rough, other, "--picture", tmp_path / "one.png")
    assert one.returncode == 2
    assert "name only one" in one.stderr


def test_lengths_have_their_unit_and_cutoffs_the_names_of_the_standard(rough: Path) -> None:
    done = succeeded("texture", rough, "--nesting-index-l", "0.3", "--unit", "mm")
    assert "0.3 mm" in done.stdout
