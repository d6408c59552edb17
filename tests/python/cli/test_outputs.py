"""The output files of `meshlab-spectral filter`: formats, textures, whole or unchanged."""

from __future__ import annotations

import shutil
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from commands import COMMAND, PRECIOUS, arrays_of, assert_fails, command, succeeded
from helpers import diagonal, largest_distance, loaded

MATERIAL = "bunny10k_textured.mtl"


@pytest.mark.parametrize("ending", [".ply", ".obj", ".stl", ".off"])
def test_every_usual_format_is_written(ending: str, cow: Path, tmp_path: Path) -> None:
    target = tmp_path / f"cow{ending}"
    succeeded("filter", cow, target, "--steps", 1)
    V, F = arrays_of(target)
    assert len(F) == len(arrays_of(cow)[1])
    reference = tmp_path / "reference.ply"
    succeeded("filter", cow, reference, "--steps", 1)
    if ending != ".stl":  # which has its vertices in another order
        expected, _ = arrays_of(reference)
        assert largest_distance(V, expected) < 1e-6 * diagonal(expected)


@pytest.mark.parametrize("ending", [".obj", ".off"])
def test_polygons_that_meet_in_a_non_manifold_edge_are_written(ending: str, tmp_path: Path) -> None:
    """On some of them MeshLab's polygon writer never returns."""
    source, target = tmp_path / "in.obj", tmp_path / f"out{ending}"
    corners = "0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1", "0 -1 0", "1 -1 0"
    quads = "1 2 3 4", "1 2 6 5", "1 2 8 7", "1 2 3 4"
    lines = [f"v {corner}" for corner in corners] + [f"f {quad}" for quad in quads]
    source.write_text("\n".join(lines) + "\n")
    succeeded("filter", source, target, "--steps", 1)
    assert len(arrays_of(target)[1]) == 8


def test_the_polygons_of_an_obj_stay_polygons(tmp_path: Path) -> None:
    source, target = tmp_path / "in.obj", tmp_path / "out.obj"
    source.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    succeeded("filter", source, target, "--steps", 1)
    faces = [line for line in target.read_text().splitlines() if line.startswith("f ")]
    assert [len(face.split()) for face in faces] == [5]


def test_colour_and_quality_are_in_the_output(samples: Path, tmp_path: Path) -> None:
    source, target = samples / "colored_airplane.ply", tmp_path / "airplane.ply"
    succeeded("filter", source, target, "--steps", 1)
    meshes = []
    for path in (source, target):
        mesh_set = loaded(path)
        meshes.append(mesh_set)
    before, after = (mesh_set.current_mesh() for mesh_set in meshes)
    np.testing.assert_array_equal(before.vertex_color_matrix(), after.vertex_color_matrix())
    np.testing.assert_array_equal(before.vertex_scalar_array(), after.vertex_scalar_array())


def test_material_and_texture_of_an_obj_appear_beside_it_under_their_names(
    samples: Path, tmp_path: Path
) -> None:
    target = tmp_path / "bunny.obj"
    arguments = ("filter", samples / "bunny10k_textured.obj", target, "--overwrite", "--steps", 1)
    for _ in range(2):  # the second run replaces its own files
        succeeded(*arguments)
        names = sorted(path.name for path in tmp_path.iterdir())
        assert names == ["TextureDouble_A.png", "bunny.obj", MATERIAL]
    assert f"mtllib ./{MATERIAL}" in target.read_text()
    assert (tmp_path / MATERIAL).read_bytes() == (samples / MATERIAL).read_bytes()
    mesh_set = loaded(target)
    assert mesh_set.current_mesh().has_wedge_tex_coord()
    assert list(mesh_set.current_mesh().textures()) == ["TextureDouble_A.png"]


def test_a_texture_in_a_folder_keeps_its_place(samples: Path, tmp_path: Path) -> None:
    source = textured_bunny(samples, tmp_path / "in", "maps/skin.png")
    target = tmp_path / "out" / "bunny.obj"
    target.parent.mkdir()
    succeeded("filter", source, target, "--steps", 1)
    assert (target.parent / "maps" / "skin.png").is_file()
    assert "map_Kd maps/skin.png" in (target.parent / MATERIAL).read_text()


def test_the_texture_of_the_input_is_left_alone_when_the_output_lies_beside_it(
    samples: Path, tmp_path: Path
) -> None:
    source = textured_bunny(samples, tmp_path / "in", "skin.png")
    skin = source.parent / "skin.png"
    before = skin.read_bytes()
    succeeded("filter", source, source.parent / "new.obj", "--steps", 1)
    assert skin.read_bytes() == before
    assert sorted(path.name for path in source.parent.iterdir()) == [
        MATERIAL,
        source.name,
        "new.obj",
        "skin.png",
    ]


def test_a_texture_outside_of_the_folder_is_never_written(samples: Path, tmp_path: Path) -> None:
    source = textured_bunny(samples, tmp_path / "in", "../skin.png")
    target = tmp_path / "out" / "bunny.obj"
    target.parent.mkdir()
    done = succeeded("filter", source, target, "--steps", 1)
    assert "../skin.png" in done.stderr
    names = sorted(path.name for path in target.parent.iterdir())
    assert names == ["bunny.obj", MATERIAL]


def test_a_foreign_file_in_place_of_a_texture_is_not_replaced(
    samples: Path, existing: Path, tmp_path: Path
) -> None:
    source = textured_bunny(samples, tmp_path / "in", "skin.png")
    foreign = existing.parent / "skin.png"
    foreign.write_bytes(PRECIOUS)
    done = command("filter", source, existing.with_suffix(".obj"), "--overwrite", "--steps", 1)
    assert_fails(done, 1, "skin.png", "folder of its own")
    assert foreign.read_bytes() == PRECIOUS
    foreign.unlink()


def textured_bunny(samples: Path, folder: Path, texture: str) -> Path:
    """Copy pymeshlab's textured bunny; its texture gets the given path."""
    place = folder / texture
    place.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(exist_ok=True)
    shutil.copy(samples / "TextureDouble_A.png", place)
    material = (samples / MATERIAL).read_text()
    (folder / MATERIAL).write_text(material.replace("TextureDouble_A.png", texture))
    return Path(shutil.copy(samples / "bunny10k_textured.obj", folder))


def test_an_existing_output_is_replaced_and_keeps_its_permissions(
    cow: Path, tmp_path: Path
) -> None:
    target = tmp_path / "cow.ply"
    target.write_bytes(PRECIOUS)
    target.chmod(0o640)
    succeeded("filter", cow, target, "--overwrite", "--steps", 1)
    assert len(arrays_of(target)[0]) == len(arrays_of(cow)[0])
    assert target.stat().st_mode & 0o777 == 0o640


def test_a_symbolic_link_as_output_stays_a_link(cow: Path, tmp_path: Path) -> None:
    real, link = tmp_path / "real.ply", tmp_path / "link.ply"
    link.symlink_to(real)
    for content in (None, PRECIOUS):
        if content is not None:
            real.write_bytes(content)
        succeeded("filter", cow, link, "--overwrite", "--steps", 1)
        assert link.is_symlink()
        assert len(arrays_of(real)[0]) == len(arrays_of(cow)[0])


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder here that even root may not")
def test_an_unwritable_output_folder_is_refused_before_the_work(cow: Path) -> None:
    begin = time.monotonic()
    assert_fails(command("filter", cow, "/proc/out.ply", "--steps", 1000), 1, "another folder")
    assert time.monotonic() - begin < 10


def test_a_full_disk_leaves_the_old_output(cow: Path, existing: Path, tmp_path: Path) -> None:
    """A limit on the size of files stands in for a full disk."""
    new = tmp_path / "new.obj"
    words = {existing: (), new: ("new.obj cannot be", "make room on the disk")}
    for target, said in words.items():
        limited = ["bash", "-c", 'ulimit -f 20; exec "$@"', "bash", *COMMAND]
        done = subprocess.run(
            [*limited, "filter", str(cow), str(target), "--overwrite", "--steps", "1"],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert_fails(done, 1, *said)
    assert not new.exists()


@pytest.mark.parametrize("how", ["same name", "symbolic link", "hard link"])
def test_the_input_is_never_the_output(how: str, cow: Path, tmp_path: Path) -> None:
    source = tmp_path / "cow.obj"
    shutil.copy(cow, source)
    target = source if how == "same name" else tmp_path / "other.obj"
    if how == "symbolic link":
        target.symlink_to(source)
    if how == "hard link":
        target.hardlink_to(source)
    assert_fails(command("filter", source, target), 2, "INPUT itself")
    assert source.read_bytes() == cow.read_bytes()
