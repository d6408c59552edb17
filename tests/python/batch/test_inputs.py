"""Finding the inputs of a batch: files, folders, patterns, URLs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import fsspec
import numpy as np
import pytest
from meshlab_spectral import InputError
from meshlab_spectral.batch.inputs import Input, find_inputs
from meshlab_spectral.batch.outputs import plan_outputs
from meshlab_spectral.batch.storage import is_url
from nibabel import gifti


def files(folder: Path, *names: str) -> None:
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")


def names(found: Iterable[Input], folder: Path) -> list[str]:
    return [Path(file.location).relative_to(folder).as_posix() for file in found]


def test_a_folder_gives_its_meshes_sorted_without_hidden_files(tmp_path: Path) -> None:
    files(tmp_path, "b.ply", "a.OBJ", "c.stl", "notes.txt", "readme.md", ".a.ply", "._b.ply")
    assert names(find_inputs([str(tmp_path)]), tmp_path) == ["a.OBJ", "b.ply", "c.stl"]


def test_folders_in_folders_are_searched_only_when_asked(tmp_path: Path) -> None:
    files(tmp_path, "a.ply", "deep/b.ply", "deep/er/c.ply", ".hidden/d.ply")
    assert names(find_inputs([str(tmp_path)]), tmp_path) == ["a.ply"]
    found = find_inputs([str(tmp_path)], recursive=True)
    assert names(found, tmp_path) == ["a.ply", "deep/b.ply", "deep/er/c.ply"]
    assert [file.folder for file in found] == ["", "deep", "deep/er"]


def test_a_pattern_is_accepted_and_so_is_a_file_of_any_ending(tmp_path: Path) -> None:
    files(tmp_path, "a.ply", "b.ply", "b.obj", "odd.xyz3")
    found = find_inputs([str(tmp_path / "*.ply"), str(tmp_path / "odd.xyz3")])
    assert names(found, tmp_path) == ["a.ply", "b.ply", "odd.xyz3"]


def test_two_stars_reach_into_folders_when_recursive(tmp_path: Path) -> None:
    files(tmp_path, "a.ply", "x/b.ply", "x/y/c.ply")
    found = find_inputs([str(tmp_path / "**/*.ply")], recursive=True)
    assert names(found, tmp_path) == ["a.ply", "x/b.ply", "x/y/c.ply"]


def test_a_file_whose_name_looks_like_a_pattern_is_that_file(tmp_path: Path) -> None:
    files(tmp_path, "scan[1].ply", "scan1.ply")
    assert names(find_inputs([str(tmp_path / "scan[1].ply")]), tmp_path) == ["scan[1].ply"]


def test_a_file_that_is_given_twice_is_taken_once(tmp_path: Path) -> None:
    files(tmp_path, "a.ply")
    (tmp_path / "link.ply").symlink_to(tmp_path / "a.ply")
    arguments = [str(tmp_path), str(tmp_path / "a.ply"), str(tmp_path / "link.ply")]
    assert names(find_inputs(arguments), tmp_path) == ["a.ply"]


@pytest.mark.parametrize("recursive", [False, True])
def test_a_loop_of_links_is_an_input_that_will_fail_alone(recursive: bool, tmp_path: Path) -> None:
    files(tmp_path, "a.ply", "deep/b.ply")
    (tmp_path / "self.ply").symlink_to("self.ply")
    (tmp_path / "there.ply").symlink_to("back")
    (tmp_path / "back").symlink_to("there.ply")
    (tmp_path / "deep" / "up").symlink_to("..")
    expected = ["a.ply", *["deep/b.ply"] * recursive, "self.ply", "there.ply"]
    for argument in (tmp_path, tmp_path / "*"):
        found = find_inputs([str(argument)], recursive, leave_out=[tmp_path / "self.ply" / "out"])
        assert [name for name in names(found, tmp_path) if name in expected] == expected


def test_a_relative_path_starts_at_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files(tmp_path, "a.ply")
    monkeypatch.chdir(tmp_path)
    assert find_inputs(["a.ply"]) == [Input(str(tmp_path / "a.ply"))]


def test_outputs_among_the_inputs_are_left_out(tmp_path: Path) -> None:
    files(tmp_path, "a.ply", "a_smooth.ply", "out/b.ply", "raw/c.ply")
    leave_out = [tmp_path / "out", tmp_path / "a_smooth.ply"]
    for argument in (tmp_path, tmp_path / "**/*.ply"):
        found = find_inputs([str(argument)], recursive=True, leave_out=leave_out)
        assert names(found, tmp_path) == ["a.ply", "raw/c.ply"]


def test_a_folder_named_like_a_mesh_is_an_input_that_will_fail(tmp_path: Path) -> None:
    (tmp_path / "x.ply").mkdir()
    assert names(find_inputs([str(tmp_path)]), tmp_path) == ["x.ply"]
    files(tmp_path, "x.ply/a.ply")
    assert names(find_inputs([str(tmp_path)], recursive=True), tmp_path) == ["x.ply/a.ply"]


@pytest.mark.parametrize("wrong", ["missing.ply", "*.nothing", "empty"])
def test_an_argument_that_matches_nothing_is_named(wrong: str, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"missing\.ply|nothing|empty"):
        find_inputs([str(tmp_path / wrong)])


def test_urls_are_found_as_files_are() -> None:
    memory = fsspec.filesystem("memory")
    for name in ("/scans/a.ply", "/scans/b.obj", "/scans/.c.ply", "/scans/deep/d.ply"):
        memory.pipe(name, b"")
    try:
        flat = [file.location for file in find_inputs(["memory://scans"])]
        assert flat == ["memory:///scans/a.ply", "memory:///scans/b.obj"]
        deep = find_inputs(["memory://scans"], recursive=True)
        assert (deep[-1].location, deep[-1].folder) == ("memory:///scans/deep/d.ply", "deep")
        assert len(find_inputs(["memory://scans/*.ply"])) == 2
        with pytest.raises(InputError, match="does not exist"):
            find_inputs(["memory://scans/e.ply"])
    finally:
        memory.rm("/scans", recursive=True)


def test_a_url_of_an_unknown_kind_is_refused() -> None:
    with pytest.raises(InputError, match="nokind"):
        find_inputs(["nokind://scans"])


def test_a_file_with_colons_in_its_name_is_not_a_url(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names_ = ["a::b.ply", "a:b.ply", "memory::c/d.ply"]
    files(tmp_path, *names_)
    monkeypatch.chdir(tmp_path)
    assert names(find_inputs(names_), tmp_path) == names_
    assert is_url("filecache::s3://bucket/a.ply")


def test_a_file_url_is_a_path(tmp_path: Path) -> None:
    files(tmp_path, "a b.ply")
    assert find_inputs([(tmp_path / "a b.ply").as_uri()]) == [Input(str(tmp_path / "a b.ply"))]


SURFACES = ["lh.inflated", "lh.orig", "lh.pial", "lh.pial.T1", "lh.white.preaparc", "rh.sphere.reg"]


@pytest.mark.parametrize("remote", [False, True])
def test_a_folder_of_free_surfer_gives_all_its_surfaces(remote: bool, tmp_path: Path) -> None:
    """They are known by their first bytes; curvature and labels are none. Outputs keep names."""
    for name in SURFACES:
        (tmp_path / name).write_bytes(b"\xff\xff\xfe and more")
    for name in ("lh.curv", "lh.cortex.label", "lh.thickness"):
        (tmp_path / name).write_bytes(b"\xff\xff\xff and more")
    (tmp_path / "z.surf.gii.gz").write_bytes(b"")
    folder = str(tmp_path)
    if remote:
        folder = "memory://surf"
        fsspec.filesystem("memory").put(str(tmp_path), "/surf", recursive=True)
    found = find_inputs([folder])
    assert [file.name for file in found] == [*SURFACES, "z.surf.gii.gz"]
    outputs = plan_outputs(found, str(tmp_path / "out"))
    assert [output.name for output in outputs] == [*SURFACES, "z.surf.gii.gz"]
    outputs = plan_outputs(found, str(tmp_path / "out"), "{stem}_smooth")
    assert [output.name for output in outputs][3:] == [
        "lh.pial_smooth.T1",
        "lh.white_smooth.preaparc",
        "rh.sphere_smooth.reg",
        "z.surf_smooth.gii.gz",
    ]


def test_gifti_of_values_beside_surfaces_is_left_out(tmp_path: Path) -> None:
    """As in the folders of fmriprep and of templates, whatever the names."""
    V = np.eye(3, dtype="f4")
    surface = {"POINTSET": V, "TRIANGLE": np.array([[0, 1, 2]], "i4")}
    values = {"SHAPE": V[0], "TIME_SERIES": V[0], "LABEL": np.arange(3, dtype="i4")}
    files = {"lh.pial.surf.gii": surface, "white_left.gii.gz": surface}
    for name, intent in {"a.shape.gii": "SHAPE", "b.func.gii": "TIME_SERIES"}.items():
        files[name] = {intent: values[intent]}
    files |= {"lh.annot.label.gii": {"LABEL": values["LABEL"]}, "sulc_left.gii.gz": {"SHAPE": V[0]}}
    for name, arrays in files.items():
        image = gifti.GiftiImage()
        for intent, array in arrays.items():
            data = gifti.GiftiDataArray(array, f"NIFTI_INTENT_{intent}")
            image.add_gifti_data_array(data)
        image.to_filename(tmp_path / name)
    (tmp_path / "damaged.gii.gz").write_bytes(b"no gzip")
    found = [one.name for one in find_inputs([str(tmp_path)])]
    assert found == ["damaged.gii.gz", "lh.pial.surf.gii", "white_left.gii.gz"]
    assert len(find_inputs([str(tmp_path / "a.shape.gii")])) == 1  # a file that is named fails
