"""What `meshlab-spectral filter` refuses: one message that says why, nothing written."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from commands import assert_fails, command, write_ply

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
