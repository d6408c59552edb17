"""What `meshlab-spectral filter` refuses: one message that says why, nothing written."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from commands import assert_fails, command, write_ply


def test_a_missing_input_is_named(existing: Path, tmp_path: Path) -> None:
    missing = tmp_path / "no such.ply"
    assert_fails(command("filter", missing, existing), 1, str(missing), "does not exist")


def test_a_folder_as_input_is_refused(existing: Path, tmp_path: Path) -> None:
    assert_fails(command("filter", tmp_path, existing), 1, "is a folder")


@pytest.mark.parametrize("ending", [".ply", ".obj", ".stl", ".off"])
@pytest.mark.parametrize("content", ["", "this is no mesh\n"], ids=["empty", "text"])
def test_a_broken_input_is_refused_with_advice(
    content: str, ending: str, existing: Path, tmp_path: Path
) -> None:
    broken = tmp_path / f"broken{ending}"
    broken.write_text(content)
    assert_fails(command("filter", broken, existing), 1, str(broken), "damaged")


def test_a_cut_off_input_is_refused(cow: Path, existing: Path, tmp_path: Path) -> None:
    whole, cut = tmp_path / "whole.ply", tmp_path / "cut.ply"
    command("filter", cow, whole, "--steps", 1)
    cut.write_bytes(whole.read_bytes()[:20_000])
    assert_fails(command("filter", cut, existing), 1, str(cut), "damaged")


def test_an_input_of_an_unknown_format_is_refused_with_the_known_ones(
    existing: Path, tmp_path: Path
) -> None:
    text = tmp_path / "notes.txt2"
    text.write_text("notes\n")
    assert_fails(command("filter", text, existing), 1, ".txt2", ".ply")


def test_an_empty_mesh_is_refused(existing: Path, tmp_path: Path) -> None:
    assert_fails(command("filter", write_ply(tmp_path / "m.ply", "", ""), existing), 1, "empty")


def test_a_point_cloud_is_refused_with_a_way_to_a_surface(existing: Path, tmp_path: Path) -> None:
    cloud = write_ply(tmp_path / "cloud.ply", "0 0 0\n1 0 0\n0 1 0", "")
    assert_fails(command("filter", cloud, existing), 1, "point cloud", "Surface Reconstruction")


def test_a_basis_as_large_as_the_mesh_is_refused(cow: Path, existing: Path) -> None:
    arguments = ("--spectrum", "truncated", "--basis-size", 5000)
    assert_fails(command("filter", cow, existing, *arguments), 1, "2904", "spectrum = full")


def test_a_missing_plugin_is_reported_without_traceback(cow: Path, existing: Path) -> None:
    done = command("filter", cow, existing, MESHLAB_SPECTRAL_PLUGIN="/no/such/plugin.so")
    assert_fails(done, 1, "/no/such/plugin.so", "MESHLAB_SPECTRAL_PLUGIN")


def test_names_that_are_not_utf_8_are_refused(cow: Path, existing: Path, tmp_path: Path) -> None:
    source = tmp_path / "caf\udce9.obj"
    shutil.copy(cow, source)
    folder = tmp_path / "d\udce9"
    folder.mkdir()
    for files in ((source, existing), (cow, folder / "out.ply"), (cow, tmp_path / "o\udce9.ply")):
        assert_fails(command("filter", *files), 1, "\\udce9", "not UTF-8", "rename")
    done = command("batch", source, cow, "--output", tmp_path / "smooth", "--workers", 1)
    assert done.returncode == 1
    assert "1 filtered, 1 failed" in done.stdout
    assert "not UTF-8" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.rglob("*.partial"))


def test_debug_shows_where_an_error_arose(existing: Path, tmp_path: Path) -> None:
    cloud = write_ply(tmp_path / "cloud.ply", "0 0 0\n1 0 0\n0 1 0", "")
    done = command("filter", cloud, existing, "--debug")
    assert done.returncode == 1
    assert "Traceback" in done.stderr
    assert "filter_to_scratch" in done.stderr


def test_colons_in_a_message_do_not_become_emoji(tmp_path: Path) -> None:
    assert ":x:none.ply does not exist" in command("info", tmp_path / ":x:none.ply").stderr
