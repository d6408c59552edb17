"""What `meshlab-spectral filter` refuses: one message that says why, nothing written."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from commands import COMMAND, assert_fails, command, write_ply


def test_a_missing_input_is_named(existing: Path, tmp_path: Path) -> None:
    missing = tmp_path / "no such.ply"
    assert_fails(
        command("filter", missing, existing, "--overwrite"), 1, str(missing), "does not exist"
    )


NO_FILES = {
    "http://example.org/scan.ply": "`meshlab-spectral batch http://example.org/scan.ply --output",
    "s3://scans/a.ply": "`meshlab-spectral batch s3://scans/a.ply --output",
    "folder": "`meshlab-spectral batch folder --output FOLDER`",
    "notes.txt": "name it after its format",
    "scan.e57": "is PLY, not .e57: rename it to .ply",
    "scan.vtm": "extract its surface first",
    "pipe": "is a device or a pipe",
}


@pytest.mark.parametrize("name", NO_FILES)
@pytest.mark.parametrize("verb", ["denoise", "filter", "info"])
def test_what_is_no_mesh_file_is_refused_with_a_remedy(
    verb: str, name: str, existing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    Path("notes.txt").write_text("1 2 3\n")
    write_ply(Path("scan.e57"), "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    Path("scan.vtm").write_text('<VTKFile type="vtkMultiBlockDataSet" version="1.0"></VTKFile>')
    os.mkfifo("pipe")
    done = command(verb, name, *([existing, "--overwrite"] if verb != "info" else []))
    assert_fails(done, 1, name, NO_FILES[name])
    assert "please report it" not in done.stderr


def test_an_address_is_no_place_for_a_file(cow: Path) -> None:
    address = "http://example.org/out.ply"
    refused = "to which only `meshlab-spectral batch` writes"
    assert_fails(command("filter", cow, address), 1, address, refused)


def test_a_stream_needs_its_format(cow: Path) -> None:
    assert_fails(command("filter", cow, "-"), 2, "--format: name the format")


def test_a_full_disk_is_called_so(cow: Path, tmp_path: Path) -> None:
    """The limit on the size of a file stands for the disk."""
    target = tmp_path / "out.obj"
    limited = f"ulimit -f 20; exec {' '.join(COMMAND)} filter {cow} {target}"
    done = subprocess.run(["bash", "-c", limited], capture_output=True, text=True, check=False)
    assert_fails(done, 1, "out.obj cannot be", "make room on the disk")
    assert not list(tmp_path.iterdir())


def test_a_length_beyond_the_mesh_is_refused(cow: Path, existing: Path) -> None:
    done = command("filter", cow, existing, "--overwrite", "--feature-size", 50)
    assert_fails(done, 2, "--feature-size 50: is", "did you mean 50%?")
    done = command("denoise", cow, existing, "--overwrite", "--noise-height", 15)
    assert_fails(done, 2, "--noise-height 15: is", "did you mean 15%?")
    done = command("filter", cow, existing, "--overwrite", "--feature-size", 5000)
    assert_fails(done, 2, "give at most 100%")


@pytest.mark.parametrize("ending", [".ply", ".obj", ".stl", ".off"])
@pytest.mark.parametrize(("content", "cause"), [("", "is empty"), ("this is no mesh\n", "is not")])
def test_a_broken_input_is_refused_with_the_cause(
    content: str, cause: str, ending: str, existing: Path, tmp_path: Path
) -> None:
    broken = tmp_path / f"broken{ending}"
    broken.write_text(content)
    assert_fails(command("filter", broken, existing, "--overwrite"), 1, str(broken), cause)


def test_a_cut_off_input_is_refused(cow: Path, existing: Path, tmp_path: Path) -> None:
    whole, cut = tmp_path / "whole.ply", tmp_path / "cut.ply"
    command("filter", cow, whole, "--steps", 1)
    cut.write_bytes(whole.read_bytes()[:20_000])
    assert_fails(command("filter", cut, existing, "--overwrite"), 1, str(cut), "was cut off")


def test_an_input_of_an_unknown_format_is_refused_with_the_known_ones(
    existing: Path, tmp_path: Path
) -> None:
    text = tmp_path / "notes.txt2"
    text.write_text("notes\n")
    assert_fails(command("filter", text, existing, "--overwrite"), 1, ".txt2", ".ply")


def test_an_empty_mesh_is_refused(existing: Path, tmp_path: Path) -> None:
    assert_fails(
        command("filter", write_ply(tmp_path / "m.ply", "", ""), existing, "--overwrite"),
        1,
        "empty",
    )


def test_a_point_cloud_is_refused_with_a_way_to_a_surface(existing: Path, tmp_path: Path) -> None:
    cloud = write_ply(tmp_path / "cloud.ply", "0 0 0\n1 0 0\n0 1 0", "")
    assert_fails(
        command("filter", cloud, existing, "--overwrite"),
        1,
        "point cloud",
        "Surface Reconstruction",
    )


def test_a_basis_as_large_as_the_mesh_is_refused(cow: Path, existing: Path) -> None:
    arguments = ("--spectrum", "truncated", "--basis-size", 5000)
    assert_fails(
        command("filter", cow, existing, "--overwrite", *arguments), 2, "2904", "--spectrum full"
    )


def test_a_missing_plugin_is_reported_without_traceback(cow: Path, existing: Path) -> None:
    done = command(
        "filter", cow, existing, "--overwrite", MESHLAB_SPECTRAL_PLUGIN="/no/such/plugin.so"
    )
    assert_fails(done, 1, "/no/such/plugin.so", "MESHLAB_SPECTRAL_PLUGIN")


def test_names_that_are_not_utf_8_are_refused(cow: Path, existing: Path, tmp_path: Path) -> None:
    source = tmp_path / "caf\udce9.obj"
    shutil.copy(cow, source)
    folder = tmp_path / "d\udce9"
    folder.mkdir()
    for files in (
        (source, existing, "--overwrite"),
        (cow, folder / "out.ply"),
        (cow, tmp_path / "o\udce9.ply"),
    ):
        assert_fails(command("filter", *files), 1, "\\udce9", "not UTF-8", "rename")
    done = command("batch", source, cow, "--output", tmp_path / "smooth", "--workers", 1)
    assert done.returncode == 1
    assert "1 filtered, 1 failed" in done.stdout
    assert "not UTF-8" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.rglob("*.partial"))


def test_debug_shows_where_an_error_arose(existing: Path, tmp_path: Path) -> None:
    cloud = write_ply(tmp_path / "cloud.ply", "0 0 0\n1 0 0\n0 1 0", "")
    done = command("filter", cloud, existing, "--overwrite", "--debug")
    assert done.returncode == 1
    assert "Traceback" in done.stderr
    assert "filter_to_scratch" in done.stderr


def test_colons_in_a_message_do_not_become_emoji(tmp_path: Path) -> None:
    assert ":x:none.ply does not exist" in command("info", tmp_path / ":x:none.ply").stderr
