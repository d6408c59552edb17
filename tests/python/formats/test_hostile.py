"""What a stranger's file may not do: read elsewhere, grow, take long, write on the terminal."""

from __future__ import annotations

import resource
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import hostile_files
import numpy as np
import pytest
from hostile_files import KINDS, SECRET, write_hostile
from meshlab_spectral.errors import MemoryLimitError, MeshFileError
from meshlab_spectral.files.meshlab_files import named_files
from meshlab_spectral.formats import budget
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.opening import open_document
from meshlab_spectral.formats.polygons import triangles
from meshlab_spectral.formats.side_files import beside

OTHERS = {"x3d", "dae", "wrl"} | (set() if find_spec("pxr") else {"usda", "usdz"})
OWN = [name for name, (ending, _) in KINDS.items() if ending not in OTHERS]
SIZE = 100_000  # bytes, about
# Beyond 40 times the file: what a file of a few bytes may grow to, a few times over, since arrays
# are copied; and seconds, on a machine that does other work, too.
LEAST_MEMORY, LEAST_TIME = 256 << 20, 5.0


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "in").mkdir()
    (tmp_path / "out").mkdir()
    return tmp_path / "in"


def peak() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (
        1 if sys.platform == "darwin" else 1024
    )


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", OWN)
def test_a_hostile_file_is_read_or_refused_within_its_budget(
    name: str, seed: int, folder: Path
) -> None:
    path = write_hostile(name, folder, SIZE, seed)
    size = sum(one.stat().st_size for one in folder.iterdir() if not one.is_symlink())
    before, begin = peak(), time.process_time()
    try:
        document = open_document(path)
        moved = [part.vertices + 1e-3 for part in document.parts]
        told = document.save(folder.parent / "out" / path.name, moved)
        texts = [*document.warnings, *told, *document.contents]
        texts += [part.name for part in document.parts]
    except MeshFileError as error:
        texts = [str(error)]
    assert time.process_time() - begin < LEAST_TIME
    assert peak() - before < LEAST_MEMORY + 40 * size
    for text in texts:
        assert text.isprintable()
        assert len(text) < 500
    for written in (folder.parent / "out").rglob("*"):
        assert SECRET.encode() not in written.read_bytes()


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("name", [name for name in OWN if "outside" in name])
def test_no_format_reads_a_file_outside_the_folder_of_the_mesh(
    name: str, seed: int, folder: Path
) -> None:
    path = write_hostile(name, folder, SIZE, seed)
    try:
        document = open_document(path)
        (told,) = document.save(folder.parent / "out" / path.name, [document.parts[0].vertices])
    except MeshFileError as error:
        told = str(error)
    assert "is outside its folder: keep it next to the mesh" in told


def test_a_file_that_a_mesh_names_is_one_in_its_folder_links_resolved(tmp_path: Path) -> None:
    folder = tmp_path / "in"
    (folder / "maps").mkdir(parents=True)
    (folder / "maps/a.png").write_bytes(b"a")
    (tmp_path / "far.png").write_bytes(b"far")
    (folder / "near.png").symlink_to("maps/a.png")
    (folder / "far.png").symlink_to(tmp_path / "far.png")
    (folder / "loop.png").symlink_to("loop.png")
    mesh = folder / "a.ply"
    for name in ("maps/a.png", "near.png", "./maps/a.png"):
        assert beside(mesh, name).read_bytes() == b"a"
    refused = {
        "../far.png": "outside",
        "far.png": "outside",
        str(tmp_path / "far.png"): "outside",
        "C:\\far.png": "outside",
        "maps/../../far.png": "outside",
        "maps": "not a file",
        "no.png": "missing",
        "loop.png": "not a file",
        "a\0b": "not a file name",
        "x" * 5000: "missing",
    }
    for name, why in refused.items():
        with pytest.raises(MeshFileError, match=why):
            beside(mesh, name)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("blanks.3mf", "would grow from"),
        ("wrong size.3mf", "in a compression that 3MF does not allow"),
        ("nested objects.3mf", "an object within another"),
        ("no indices.gltf", "would grow from"),
        ("zeros.surf.gii", "would grow from|has more"),
        ("zeros.surf.gii.gz", "would grow from"),
        ("dimensions.surf.gii", "200000000 dimensions, of 6 at most"),
        ("counts.vtp", "it claims"),
        ("counts.vtk", "it claims"),
        ("elements without end.ply", "before the end of its header"),
    ],
)
def test_the_reason_is_told_with_the_number(name: str, words: str, folder: Path) -> None:
    with pytest.raises(MeshFileError, match=words):
        open_document(write_hostile(name, folder, SIZE, 1))


@pytest.mark.parametrize(
    "name", ["blanks.3mf", "no indices.gltf", "zeros.surf.gii.gz", "counts.vtp", "counts.vtk"]
)
def test_a_lack_of_memory_is_not_called_a_fault_of_the_file(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(budget._core, "available_memory", lambda: 1000.0)
    with pytest.raises(MemoryLimitError, match="50% of the memory that is free"):
        open_document(write_hostile(name, folder, SIZE, 1))


@pytest.mark.parametrize(("there_is", "kind"), [(1e6, MemoryLimitError), (1e12, MeshFileError)])
def test_a_reader_without_memory_is_told_whose_fault_it_is(
    there_is: float, kind: type[Exception], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(budget._core, "available_memory", lambda: there_is)
    taken = budget.Budget(folder / "a.vtp", 1000)
    with pytest.raises(kind, match="what its reader makes of it"), budget.guarded(taken):
        raise MemoryError


def test_meshlab_gets_memory_for_the_files_that_a_mesh_names(folder: Path) -> None:
    (folder / "maps").mkdir()
    for name in ("maps/a b.png", "c.jpg", "near.mtl", "data 1.bin", "other.png", "e.x3d"):
        (folder / name).write_bytes(b"c.jpg" if name == "other.png" else b"")
    texts = {
        "a.obj": ("mtllib near.mtl", {"near.mtl"}),
        "a.mtl": ("map_Kd maps/a b.png\nmap_Ks -s 1 1 1 c.jpg", {"maps/a b.png", "c.jpg"}),
        "a.gltf": ('{"uri":"data%201.bin"}', {"data 1.bin"}),
        "a.dae": ("<init_from>./maps/a%20b.png</init_from>", {"./maps/a b.png"}),
        "a.x3d": ("<Inline url='\"e.x3d\"'/><a b='no.png'/>", {"e.x3d"}),
    }
    for name, (text, named) in texts.items():
        (folder / name).write_text(text)
        assert named_files(folder / name) == {f"{folder}/{one}" for one in named}


@pytest.mark.parametrize("value", ["0.5", "1e300", "nan"])
def test_an_index_of_a_3mf_that_is_none_is_named(value: str, folder: Path) -> None:
    path = folder / "a.3mf"
    spoiled = hostile_files.TETRAHEDRON_OBJECT.replace('v1="1"', f'v1="{value}"')
    hostile_files.three_mf(path, spoiled)
    with pytest.raises(MeshFileError, match=r"is not an integer|has the corners"):
        open_document(path)


@pytest.mark.parametrize(
    ("key", "value"),
    [("matrix", [1, 2]), ("matrix", "text"), ("scale", [[1], 2, 3]), ("rotation", {"a": 1})],
)
def test_a_transform_of_a_gltf_that_is_none_is_named(key: str, value: object, folder: Path) -> None:
    asset = hostile_files.gltf(hostile_files.INLINE, nodes=[{"mesh": 0, key: value}])
    path = folder / "a.gltf"
    path.write_text(hostile_files.json.dumps(asset))
    with pytest.raises(MeshFileError, match=f"{key} is not a list of"):
        open_document(path)


def test_a_transform_of_a_3mf_has_twelve_numbers(folder: Path) -> None:
    parts = (
        '<object id="2"><components><component objectid="1" transform="1 0"/></components></object>'
    )
    hostile_files.three_mf(folder / "a.3mf", hostile_files.TETRAHEDRON_OBJECT + parts, item=2)
    with pytest.raises(MeshFileError, match="a transform has 2 numbers, not 12"):
        open_document(folder / "a.3mf")


def test_a_star_of_20_000_corners_is_divided_without_a_fold() -> None:
    """As a section of a CAD model, whose corners all lie on its outline."""
    angles = np.arange(20_000) * 2 * np.pi / 20_000
    radii = np.where(np.arange(20_000) % 2, 1, 0.5)
    V = np.column_stack([radii * np.cos(angles), radii * np.sin(angles), 0 * angles])
    F = triangles(np.arange(len(V)), np.array([len(V)]), V)
    P = V[F]
    areas = np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0])[:, 2] / 2
    x, y = V[:, 0], V[:, 1]
    outline = (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(outline, rel=1e-9)
    assert len(F) == len(V) - 2


@pytest.mark.parametrize("between", [1, 2, 5])
def test_corners_on_a_straight_side_are_corners_of_triangles(between: int) -> None:
    """A T-junction would be a crack in the next polygon."""
    shape = np.array([[0, 0, 0], [4, 0, 0], [4, 1, 0], [1, 1, 0], [1, 4, 0], [0, 4, 0]], float)
    share = np.arange(between + 1)[:, None] / (between + 1)
    V = (shape[:, None] * (1 - share) + np.roll(shape, -1, axis=0)[:, None] * share).reshape(-1, 3)
    for first in range(len(V)):
        polygon = np.roll(np.arange(len(V)), first)
        F = triangles(polygon, np.array([len(V)]), V)
        P = V[F]
        areas = np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0])[:, 2] / 2
        assert set(F.ravel().tolist()) == set(range(len(V)))
        assert len(F) == len(V) - 2
        assert (areas > -1e-12).all()
        assert areas.sum() == pytest.approx(7)


def test_a_name_is_shown_in_one_line() -> None:
    assert shown("a\x1b[31m\r\n\u202e") == r"a\x1b[31m\r\n\u202e"
    assert shown("Straße 東京 №5") == "Straße 東京 №5"
    assert len(shown("x" * 3_000_000)) == 100
