"""Output files are whole or absent, and never replace another file unasked."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from commands import PRECIOUS
from meshlab_spectral.batch.storage import sibling
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.whole_files import remove_leftovers, writing_whole


def test_leftovers_of_killed_processes_are_removed_and_nothing_else(tmp_path: Path) -> None:
    target = tmp_path / "out.ply"
    leftover = tmp_path / ".out.ply.abcd1234.partial"
    (leftover / "maps").mkdir(parents=True)
    (leftover / "maps" / "skin.png").write_bytes(b"half")
    another = tmp_path / ".other.ply.abcd1234.partial"
    another.mkdir()
    kept = [tmp_path / name for name in ("a.partial", ".b.abcd1234.partial", "c.ply")]
    for path in kept:
        path.write_bytes(PRECIOUS)  # files: not ours
    with writing_whole(target) as scratch:
        remove_leftovers(tmp_path, "out.ply")
        assert scratch.parent.is_dir()  # in use
        assert not leftover.exists()
        assert another.is_dir()
        scratch.write_bytes(b"whole")
    remove_leftovers(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted([target, *kept])


def test_a_scratch_folder_that_another_process_removes_as_a_leftover_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folders = []

    @contextlib.contextmanager
    def held_at_first(folder: Path) -> Iterator[None]:
        folders.append(folder)
        if len(folders) == 1:
            raise BlockingIOError
        yield

    monkeypatch.setattr("meshlab_spectral.files.whole_files._locked", held_at_first)
    with writing_whole(tmp_path / "out.ply") as scratch:
        assert scratch.parent == folders[1]
        scratch.write_bytes(b"whole")
    assert list(tmp_path.iterdir()) == [tmp_path / "out.ply"]


def put_there_meanwhile(monkeypatch: pytest.MonkeyPatch, path: Path, content: bytes) -> None:
    """Have another program write a file after all checks, before the moves."""
    monkeypatch.setattr(
        "meshlab_spectral.files.whole_files._sync", lambda path_: path.write_bytes(content)
    )


@pytest.mark.parametrize("content", [b"another skin", b"skin"])
def test_a_texture_that_another_mesh_has_just_brought_is_not_replaced(
    content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    texture = tmp_path / "skin.png"
    put_there_meanwhile(monkeypatch, texture, content)
    same = content == b"skin"
    expected = contextlib.nullcontext() if same else pytest.raises(MeshFileError, match="skin")
    with expected, writing_whole(tmp_path / "out.obj") as scratch:
        scratch.write_bytes(b"mesh")
        (scratch.parent / "skin.png").write_bytes(b"skin")
    assert texture.read_bytes() == content
    assert (tmp_path / "out.obj").exists() == same


@pytest.mark.parametrize("when", ["while MeshLab works", "in the last moment"])
@pytest.mark.parametrize("content", [PRECIOUS, b"mesh"])
def test_an_output_that_has_appeared_is_kept_unless_it_is_the_same(
    content: bytes, when: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same if a worker that died had written it, and the mesh was filtered again."""
    target = tmp_path / "out.ply"
    same = content == b"mesh"
    expected = (
        contextlib.nullcontext() if same else pytest.raises(MeshFileError, match="another program")
    )
    with expected, writing_whole(target, overwrite=False) as scratch:
        scratch.write_bytes(b"mesh")
        if when == "in the last moment":
            put_there_meanwhile(monkeypatch, target, content)
        else:
            target.write_bytes(content)
    assert target.read_bytes() == content
    assert list(tmp_path.iterdir()) == [target]


def test_a_loop_of_links_is_not_replaced(tmp_path: Path) -> None:
    loop = tmp_path / "loop.ply"
    loop.symlink_to("loop.ply")
    with pytest.raises(MeshFileError, match="loop"), writing_whole(loop):
        pass
    assert list(tmp_path.iterdir()) == [loop]


@pytest.mark.parametrize("overwrite", [True, False])
def test_a_link_is_written_through_side_files_included(overwrite: bool, tmp_path: Path) -> None:
    link, real = tmp_path / "link.obj", tmp_path / "far" / "real.obj"
    real.parent.mkdir()
    link.symlink_to(real)
    with writing_whole(link, overwrite) as scratch:
        scratch.write_bytes(b"mesh")
        (scratch.parent / "skin.png").write_bytes(b"skin")
    assert link.is_symlink()
    assert real.read_bytes() == b"mesh"
    assert Path(sibling(str(link), "skin.png")).read_bytes() == b"skin"
