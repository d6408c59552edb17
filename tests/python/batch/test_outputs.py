"""The names of a batch's outputs: no two alike, within their folder, never an input."""

from __future__ import annotations

import posixpath
import sys
from pathlib import Path

import pytest
from commands import python
from hypothesis import given
from hypothesis import strategies as st
from meshlab_spectral import InputError
from meshlab_spectral.batch.inputs import Input
from meshlab_spectral.batch.outputs import check_pattern, plan_outputs
from meshlab_spectral.errors import FormatError
from meshlab_spectral.files.extensions import READABLE, WRITABLE
from meshlab_spectral.formats.names import ending_of

NAMES = st.text("ab.{}_ é", min_size=1, max_size=8).filter(lambda name: name.strip(". "))
FOLDERS = st.sampled_from(["", "x", "x/y"])


def inputs(*places: str) -> list[Input]:
    return [Input(place) for place in places]


@pytest.mark.parametrize(
    ("pattern", "ending", "name"),
    [
        ("{stem}", None, "cow.v2.obj"),
        ("{stem}_smooth", None, "cow.v2_smooth.obj"),
        ("{stem}", "ply", "cow.v2.ply"),
        ("{stem}", ".ply", "cow.v2.ply"),
        ("{stem}_{ending}", "stl", "cow.v2_obj.stl"),
        ("{folder}/{stem}", None, "scans/cow.v2.obj"),
        ("{{{stem}}}", None, "{cow.v2}.obj"),
    ],
)
def test_a_name_follows_the_pattern(pattern: str, ending: str | None, name: str) -> None:
    (output,) = plan_outputs(inputs("/data/scans/cow.v2.obj"), "/out", pattern, ending)
    assert output.name == name
    assert output.target == f"/out/{name}"


def test_folders_within_the_inputs_are_kept() -> None:
    (output,) = plan_outputs([Input("/in/a/b/c.ply", "a/b")], "/out", "{stem}_x")
    assert output.target == "/out/a/b/c_x.ply"


@pytest.mark.parametrize("ending", ["ptx", "fbx", "mesh3", "xyz", "E57"])
def test_a_format_that_cannot_be_written_with_faces_becomes_ply(ending: str) -> None:
    (output,) = plan_outputs(inputs(f"/in/a.{ending}"), "/out")
    assert output.name == "a.ply"


def test_an_ending_keeps_its_spelling() -> None:
    (output,) = plan_outputs(inputs("/in/A.PLY"), "/out")
    assert output.name == "A.PLY"


def test_a_format_that_cannot_be_written_is_refused() -> None:
    with pytest.raises(FormatError, match="ptx"):
        plan_outputs(inputs("/in/a.ply"), "/out", ending="ptx")


def test_one_stem_with_two_endings_collides_only_in_one_format() -> None:
    both = inputs("/in/a.ply", "/in/a.obj")
    assert len(plan_outputs(both, "/out")) == 2
    with pytest.raises(InputError, match=r"a\.ply.*a\.obj.*\{stem\}_\{ending\}"):
        plan_outputs(both, "/out", ending="ply")
    assert len(plan_outputs(both, "/out", "{stem}_{ending}", "ply")) == 2


def test_one_name_in_two_folders_collides() -> None:
    both = inputs("/in1/a.ply", "/in2/a.ply")
    with pytest.raises(InputError, match=r"\{folder\}"):
        plan_outputs(both, "/out")
    assert len(plan_outputs(both, "/out", "{folder}_{stem}")) == 2


@pytest.mark.parametrize("how", ["same", "symbolic link", "hard link", "folder link"])
def test_an_input_is_never_an_output(how: str, tmp_path: Path) -> None:
    source = tmp_path / "in" / "a.ply"
    source.parent.mkdir()
    source.write_text("ply")
    out = tmp_path / "out"
    if how == "same":
        out = source.parent
    elif how == "folder link":
        out.symlink_to(source.parent)
    else:
        out.mkdir()
        link = out / "a.ply"
        link.symlink_to(source) if how == "symbolic link" else link.hardlink_to(source)
    with pytest.raises(InputError, match="input itself"):
        plan_outputs(inputs(str(source)), str(out))


def test_an_output_is_never_another_input() -> None:
    with pytest.raises(InputError, match="input itself"):
        plan_outputs(inputs("/in/a.ply", "/in/a_x.ply"), "/in", "{stem}_x")


@pytest.mark.parametrize(
    "pattern",
    ["", "/{stem}", "../{stem}", "{stem}/", "a//b", "{stem}/../x", "{name}", "{stem!r}", "{", "{}"],
)
def test_a_wrong_pattern_is_refused(pattern: str) -> None:
    with pytest.raises(InputError):
        check_pattern(pattern)


@pytest.mark.parametrize(
    ("place", "pattern"), [("/in/scan", "{ending}/{stem}"), ("/scan.ply", "{folder}/{stem}")]
)
def test_a_pattern_that_leaves_the_folder_for_one_file_is_refused(place: str, pattern: str) -> None:
    with pytest.raises(InputError, match=r"'/scan'"):
        plan_outputs(inputs(place), "/out", pattern)


@given(
    stems=st.lists(st.tuples(FOLDERS, NAMES), min_size=1, max_size=6, unique=True),
    pattern=st.sampled_from(["{stem}", "x_{stem}", "{folder}/{stem}_{ending}", "{stem}/{folder}"]),
)
def test_outputs_differ_and_stay_in_their_folder(
    stems: list[tuple[str, str]], pattern: str
) -> None:
    files = [Input(posixpath.join("/in", folder, f"{stem}.ply"), folder) for folder, stem in stems]
    outputs = plan_outputs(files, "/out", pattern)
    assert len({output.target for output in outputs}) == len(files)
    for file, output in zip(files, outputs, strict=True):
        assert output.source == file.location
        assert posixpath.normpath(output.target) == output.target
        assert output.target.startswith("/out/")
        assert output.target.endswith(".ply")


PROBE = """
import os, sys, pymeshlab
folder, ending = sys.argv[1:]
path = os.path.join(folder, "probe." + ending)
ms = pymeshlab.MeshSet()
corners = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
ms.add_mesh(pymeshlab.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
try:
    ms.save_current_mesh(path)
    print("writes")
except pymeshlab.PyMeshLabException:
    pass
if not os.path.exists(path):
    with open(path, "w") as file:
        file.write("x")
try:
    pymeshlab.MeshSet().load_new_mesh(path)
    print("reads")
except pymeshlab.PyMeshLabException as error:
    if "nknown format" not in str(error):
        print("reads")
sys.stdout.flush()
os._exit(0)
"""


@pytest.mark.parametrize("ending", sorted((READABLE & WRITABLE) | {"mlp", "mesh3", "dxf"}))
def test_the_formats_are_those_of_pymeshlab(ending: str, tmp_path: Path) -> None:
    done = python("-c", PROBE, tmp_path, ending)
    said = done.stdout.split()
    assert ("writes" in said) == (ending in WRITABLE)
    assert ("reads" in said) == (ending in READABLE)


@pytest.mark.parametrize(
    ("name", "ending"), [("a.ply", "ply"), ("a.b.OBJ", "OBJ"), ("a", ""), (".ply", ""), ("a.", "")]
)
def test_the_ending_of_a_name_is_recognized(name: str, ending: str) -> None:
    assert ending_of(name) == ending


def test_outputs_that_differ_in_case_alone_are_refused_where_they_are_one_file(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    files = inputs("x/Cow.ply", "y/cow.ply")
    for platform in ("win32", "darwin"):
        monkeypatch.setattr(sys, "platform", platform)
        with pytest.raises(InputError, match=r"x/Cow.ply, y/cow.ply would all be written to"):
            plan_outputs(files, "out")
        plan_outputs(files, "out", "{folder}_{stem}")
    monkeypatch.setattr(sys, "platform", "linux")
    plan_outputs(files, "out")
