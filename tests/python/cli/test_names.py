"""What files are called, and call their parts, is shown in one line that no terminal obeys."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from commands import command
from hostile_files import CONTROL, write_hostile
from meshlab_spectral.cli.messages import one_line

NAMED = ["names.gltf", "names.3mf", "names.ply", "names.obj"]
LONGEST = 12_000  # characters that a command prints, with tables of 200 columns


def assert_plain(done: subprocess.CompletedProcess[str]) -> None:
    for text in (done.stdout, done.stderr):
        assert all(c.isprintable() or c == "\n" for c in text)
        assert len(text) < LONGEST
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(("seed", "name"), list(enumerate(NAMED)))
def test_names_in_a_file_are_escaped_and_shortened(seed: int, name: str, tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    source = write_hostile(name, folder, 100_000, seed)
    for arguments in (["info", source], ["filter", source, tmp_path / "out.ply"]):
        assert_plain(command(*arguments))
    assert_plain(command("filter", source, tmp_path / f"out{source.suffix}", "--mesh", CONTROL))


def test_the_name_of_a_file_is_escaped(tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "red\x1b[31m\n.ply").write_bytes(b"no mesh")
    done = command("batch", folder, "--output", tmp_path / "out")
    assert done.returncode == 1
    assert r"red\x1b[31m\n.ply" in done.stderr
    assert_plain(done)


def test_of_a_long_message_the_begin_and_the_end_are_shown() -> None:
    assert one_line("a" * 4000 + "b" * 1000) == "a" * 4000 + "b" * 1000
    assert one_line("a" * 4000 + "b" * 1001) == "a" * 4000 + "b" * 100 + " ... " + "b" * 900


@pytest.mark.parametrize("key", [CONTROL, "k" * 3_000_000])
def test_keys_of_a_recipe_are_escaped_and_shortened(key: str, tmp_path: Path) -> None:
    recipe = tmp_path / "a.toml"
    for text in (f"{json.dumps(key)} = 1", f"[filter]\n{json.dumps(key)} = 1"):
        recipe.write_text(text)
        done = command("batch", tmp_path, "--output", tmp_path / "out", "--recipe", recipe)
        assert done.returncode == 2
        assert "there is no option" in done.stderr or "outside it" in done.stderr
        assert_plain(done)
