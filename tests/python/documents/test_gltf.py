"""glTF: positions, normals and tangents are replaced, and everything else stays."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from meshlab_spectral.documents.gltf import read
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.whole_files import writing_whole
from numpy.typing import NDArray

FIELD = Path(__file__).resolve().parents[4] / "shared" / "field"

# A cube's corners; its faces turn outwards.
CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype="<f4")
FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ],
    dtype="<u2",
)
COMPONENTS = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}


class Asset:
    """A glTF asset that grows by accessors."""

    def __init__(self) -> None:
        self.blob = bytearray()
        self.tree: dict[str, Any] = {
            "asset": {"version": "2.0", "extras": {"price": -0.0}},
            "unknown": {"big": 123456789012345678901234567890},
            "accessors": [],
            "bufferViews": [],
            "buffers": [{"byteLength": 0}],
            "meshes": [],
        }

    def view(self, data: bytes, **more: Any) -> int:
        self.blob.extend(bytes(-len(self.blob) % 4))
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data), **more}
        self.tree["bufferViews"].append(view)
        self.blob.extend(data)
        self.tree["buffers"][0]["byteLength"] = len(self.blob)
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, values: NDArray[Any], **more: Any) -> int:
        kind = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
        entry = {
            "bufferView": self.view(values.tobytes()) if "bufferView" not in more else None,
            "componentType": COMPONENTS[values.dtype.char],
            "count": len(values),
            "type": kind,
        }
        self.tree["accessors"].append({**entry, **more})
        return len(self.tree["accessors"]) - 1

    def mesh(self, *primitives: dict[str, Any], **more: Any) -> int:
        self.tree["meshes"].append({"primitives": list(primitives), **more})
        return len(self.tree["meshes"]) - 1

    def glb(self, *more: tuple[int, bytes]) -> bytes:
        return wrapped(json.dumps(self.tree).encode(), (0x004E4942, bytes(self.blob)), *more)

    def write(self, path: Path) -> Path:
        """Write .glb, or .gltf with a data URI."""
        if path.suffix == ".glb":
            path.write_bytes(self.glb())
        else:
            text = base64.b64encode(self.blob).decode()
            self.tree["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{text}"
            path.write_text(json.dumps(self.tree, indent=1))
        return path


def wrapped(text: bytes, *chunks: tuple[int, bytes]) -> bytes:
    """A GLB of JSON and more chunks."""
    body = b""
    for kind, data in [(0x4E4F534A, text), *chunks]:
        padded = data + (b"\0" if body else b" ") * (-len(data) % 4)
        body += struct.pack("<II", len(padded), kind) + padded
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def cube(points: NDArray[Any] = CUBE, **attributes: int) -> Asset:
    """A mesh of one primitive."""
    asset = Asset()
    attributes = {"POSITION": asset.accessor(points), **attributes}
    asset.mesh({"attributes": attributes, "indices": asset.accessor(FACES.ravel())})
    asset.tree["accessors"][0] |= {"min": [0, 0, 0], "max": [1, 1, 1]}
    return asset


def opened(path: Path) -> tuple[dict[str, Any], bytes]:
    """The JSON and the first buffer of a file, read without the package."""
    data = path.read_bytes()
    if path.suffix == ".gltf":
        tree = json.loads(data)
        uri = tree["buffers"][0]["uri"]
        if uri.startswith("data:"):
            return tree, base64.b64decode(uri.partition(",")[2])
        return tree, (path.parent / uri).read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    assert struct.unpack_from("<I", data, 8)[0] == len(data)
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def floats(path: Path, accessor: int, width: int = 3) -> NDArray[np.float32]:
    """The elements of an accessor of floats that lie one after the other."""
    tree, blob = opened(path)
    entry = tree["accessors"][accessor]
    assert entry["componentType"] == 5126
    view = tree["bufferViews"][entry["bufferView"]]
    assert view["byteOffset"] % 4 == 0
    assert view["byteOffset"] + view["byteLength"] <= tree["buffers"][0]["byteLength"]
    return np.frombuffer(blob, "<f4", entry["count"] * width, view["byteOffset"]).reshape(-1, width)


def bent(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move all vertices but the first."""
    moved = vertices + 0.05 * np.sin(7 * vertices[:, [1, 2, 0]] + np.arange(len(vertices))[:, None])
    moved[0] = vertices[0]
    return moved


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_a_mesh_that_has_not_moved_gives_an_identical_file(suffix: str, tmp_path: Path) -> None:
    path = cube().write(tmp_path / f"in{suffix}")
    document = read(path)
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, CUBE)
    np.testing.assert_array_equal(part.faces, FACES)
    target = tmp_path / f"out{suffix}"
    assert document.save(target, [part.vertices]) == []
    assert target.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_only_positions_and_their_bounds_change(suffix: str, tmp_path: Path) -> None:
    path = cube().write(tmp_path / f"in{suffix}")
    document = read(path)
    moved = bent(document.parts[0].vertices)
    target = tmp_path / f"out{suffix}"
    assert document.save(target, [moved]) == []
    np.testing.assert_array_equal(floats(target, 0), moved.astype(np.float32))
    (before, old), (after, new) = opened(path), opened(target)
    assert new[96:] == old[96:]
    assert after["accessors"][0]["min"] == moved.astype(np.float32).min(axis=0).tolist()
    assert after["accessors"][0]["max"] == moved.astype(np.float32).max(axis=0).tolist()
    for tree in (before, after):
        del tree["accessors"][0]["min"], tree["accessors"][0]["max"]
        tree["buffers"][0].pop("uri", None)
    assert json.dumps(before) == json.dumps(after)  # with the order of the keys


def test_numbers_are_written_as_they_were_read(tmp_path: Path) -> None:
    asset = cube()
    asset.tree["extras"] = "HERE"
    tokens = "[1.10,-0,-0.0,1E400,12345678901234567890123,0.1000000000000000055511151231257827]"
    text = json.dumps(asset.tree).replace('"HERE"', tokens)
    path = tmp_path / "in.glb"
    path.write_bytes(wrapped(text.encode(), (0x004E4942, bytes(asset.blob))))
    document = read(path)
    document.save(tmp_path / "out.glb", [bent(document.parts[0].vertices)])
    assert tokens.encode() in (tmp_path / "out.glb").read_bytes()


def test_other_chunks_and_what_follows_them_stay(tmp_path: Path) -> None:
    path = tmp_path / "in.glb"
    path.write_bytes(cube().glb((0x12345678, b"abcdefgh")) + b"rest")
    document = read(path)
    document.save(tmp_path / "out.glb", [bent(document.parts[0].vertices)])
    ending = struct.pack("<II", 8, 0x12345678) + b"abcdefghrest"
    assert (tmp_path / "out.glb").read_bytes().endswith(ending)


def with_nodes(*nodes: dict[str, Any]) -> Asset:
    asset = cube()
    asset.tree |= {"nodes": list(nodes), "scenes": [{"nodes": [0]}], "scene": 0}
    return asset


def moved_in_place(asset: Asset, tmp_path: Path) -> Any:
    """Bend the only part of an asset; check that reading the result gives the bent shape."""
    document = read(asset.write(tmp_path / "in.glb"))
    moved = bent(document.parts[0].vertices)
    document.save(tmp_path / "out.glb", [moved])
    (again,) = read(tmp_path / "out.glb").parts
    size = np.abs(moved).max()
    np.testing.assert_allclose(again.vertices, moved, atol=1e-6 * size)
    np.testing.assert_array_equal(again.faces, document.parts[0].faces)
    np.testing.assert_array_equal(floats(tmp_path / "out.glb", 0)[0], CUBE[0])
    return document


def volume(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> float:
    return float(np.linalg.det(vertices[faces]).sum() / 6)


def test_nested_nodes_place_a_mesh(tmp_path: Path) -> None:
    half = np.sqrt(0.5)
    outer = {"scale": [2, 3, 4], "rotation": [0, 0, half, half], "translation": [5, 6, 7]}
    inner = {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1], "mesh": 0}
    document = moved_in_place(with_nodes({**outer, "children": [1]}, inner), tmp_path)
    x, y, z = CUBE.T.astype(float)
    expected = np.column_stack([5 - 3 * y, 6 + 2 * (x + 1), 7 + 4 * z])
    np.testing.assert_allclose(document.parts[0].vertices, expected, atol=1e-12)
    assert document.contents == ["placement"]


def test_a_mirrored_mesh_stays_outside_out(tmp_path: Path) -> None:
    document = moved_in_place(with_nodes({"mesh": 0, "scale": [-1, 1, 2]}), tmp_path)
    part = document.parts[0]
    assert volume(CUBE.astype(float), FACES.astype(int)) == pytest.approx(1)
    assert volume(part.vertices, part.faces) == pytest.approx(2)


@pytest.mark.parametrize("scale", [[0, 0, 0], [1, 0, 1], [1e300, 1e-300, 1]])
def test_a_flattened_mesh_is_taken_without_its_transform(
    scale: list[float], tmp_path: Path
) -> None:
    document = moved_in_place(with_nodes({"mesh": 0, "scale": scale, "name": "leaf"}), tmp_path)
    np.testing.assert_array_equal(document.parts[0].vertices, CUBE)
    assert "leaf is flattened" in document.warnings[0]


@pytest.mark.parametrize(("scale", "warns"), [([2, 2, 2], True), ([1, -1, 1], False)])
def test_the_first_placement_counts_and_another_scale_is_told(
    scale: list[float], warns: bool, tmp_path: Path
) -> None:
    asset = with_nodes({"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "scale": scale})
    document = moved_in_place(asset, tmp_path)
    np.testing.assert_array_equal(document.parts[0].vertices, CUBE)
    assert len(document.warnings) == warns


def test_a_scene_that_is_shown_goes_before_others(tmp_path: Path) -> None:
    asset = with_nodes({"mesh": 0, "scale": [2, 2, 2]}, {"mesh": 0, "scale": [3, 3, 3]})
    asset.tree["scenes"] = [{"nodes": [0]}, {"nodes": [1]}]
    asset.tree["scene"] = 1
    assert read(asset.write(tmp_path / "in.glb")).parts[0].vertices.max() == 3


def test_a_skinned_mesh_is_taken_without_its_node(tmp_path: Path) -> None:
    document = moved_in_place(with_nodes({"mesh": 0, "skin": 0, "scale": [9, 9, 9]}), tmp_path)
    np.testing.assert_array_equal(document.parts[0].vertices, CUBE)
    assert "skeleton" in document.warnings[0]


def test_parts_are_named_after_meshes_or_nodes(tmp_path: Path) -> None:
    asset = with_nodes({"mesh": 1, "name": "node"})
    primitive = asset.tree["meshes"][0]["primitives"][0]
    asset.mesh(primitive)
    asset.mesh(primitive, name="own")
    names = [part.name for part in read(asset.write(tmp_path / "in.glb")).parts]
    assert names == ["mesh 0", "node", "own"]


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        (4, [[0, 1, 2]]),
        (5, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
        (6, [[1, 2, 0], [2, 3, 0], [3, 4, 0]]),
    ],
)
@pytest.mark.parametrize("is_indexed", [True, False])
def test_triangles_strips_and_fans_are_read(
    mode: int, expected: list[list[int]], is_indexed: bool, tmp_path: Path
) -> None:
    asset = Asset()
    primitive = {"attributes": {"POSITION": asset.accessor(CUBE[:5])}, "mode": mode}
    if is_indexed:
        primitive["indices"] = asset.accessor(np.arange(5, dtype="u1"))
    asset.mesh(primitive)
    faces = read(asset.write(tmp_path / "in.glb")).parts[0].faces
    np.testing.assert_array_equal(faces, expected)


def test_primitives_of_one_mesh_are_one_part_and_share_vertices(tmp_path: Path) -> None:
    asset = Asset()
    shared, own, lines = (asset.accessor(CUBE + i) for i in np.arange(3, dtype="f4"))
    first, second = asset.accessor(FACES[:6].ravel()), asset.accessor(FACES[6:].ravel())
    asset.mesh(
        {"attributes": {"POSITION": shared}, "indices": first},
        {"attributes": {"POSITION": shared}, "indices": second},
        {"attributes": {"POSITION": own}, "indices": first},
        {"attributes": {"POSITION": lines}, "mode": 1},
        {"attributes": {"POSITION": shared}, "mode": 1},
    )
    document = read(asset.write(tmp_path / "in.glb"))
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, np.vstack([CUBE, CUBE + 1]))
    np.testing.assert_array_equal(part.faces, np.vstack([FACES, FACES[:6] + 8]))
    assert document.contents == ["points and lines"]
    moved = bent(part.vertices)
    document.save(tmp_path / "out.glb", [moved])
    single = moved.astype(np.float32)
    for accessor, expected in ((shared, single[:8]), (own, single[8:]), (lines, CUBE + 2)):
        np.testing.assert_array_equal(floats(tmp_path / "out.glb", accessor), expected)
    assert len(opened(tmp_path / "out.glb")[0]["accessors"]) == 5


def test_positions_among_normals_are_replaced_where_they_are(tmp_path: Path) -> None:
    asset = Asset()
    normals = np.tile(np.array([0, 0, 1], "<f4"), (8, 1))
    view = asset.view(np.hstack([CUBE, normals]).tobytes(), byteStride=24)
    position = asset.accessor(CUBE, bufferView=view)
    colour = asset.accessor(normals, bufferView=view, byteOffset=12)
    indices = asset.accessor(FACES.ravel())
    asset.mesh({"attributes": {"POSITION": position, "_WIND": colour}, "indices": indices})
    document = read(asset.write(tmp_path / "in.glb"))
    moved = bent(document.parts[0].vertices)
    document.save(tmp_path / "out.glb", [moved])
    tree, blob = opened(tmp_path / "out.glb")
    assert tree == asset.tree
    rows = np.frombuffer(blob, "<f4", 48).reshape(8, 6)
    np.testing.assert_array_equal(rows, np.hstack([moved.astype(np.float32), normals]))


def appended(asset: Asset, tmp_path: Path, points: NDArray[Any]) -> NDArray[np.float32]:
    """Bend an asset whose positions cannot be replaced; the new ones."""
    document = read(asset.write(tmp_path / "in.glb"))
    np.testing.assert_allclose(document.parts[0].vertices, points, atol=1e-7)
    moved = bent(document.parts[0].vertices)
    document.save(tmp_path / "out.glb", [moved])
    tree, blob = opened(tmp_path / "out.glb")
    assert blob[: len(asset.blob)] == bytes(asset.blob)
    old = asset.tree["accessors"]
    assert tree["accessors"][: len(old)] == old
    assert tree["meshes"][0]["primitives"][0]["attributes"]["POSITION"] == len(old)
    result = floats(tmp_path / "out.glb", len(old))
    np.testing.assert_array_equal(result, moved.astype(np.float32))
    assert tree["accessors"][-1]["max"] == result.max(axis=0).tolist()
    return result


def test_quantized_positions_get_a_successor(tmp_path: Path) -> None:
    asset = cube((127 * CUBE - 10).astype("i1"))
    asset.tree["accessors"][0]["normalized"] = True
    appended(asset, tmp_path, np.maximum((127 * CUBE - 10) / 127, -1))


@pytest.mark.parametrize("has_base", [True, False])
def test_sparse_positions_get_a_successor(has_base: bool, tmp_path: Path) -> None:
    asset = cube()
    rows = {"bufferView": asset.view(bytes([1, 7])), "componentType": 5121}
    values = {"bufferView": asset.view((CUBE[:2] + 5).tobytes())}
    asset.tree["accessors"][0]["sparse"] = {"count": 2, "indices": rows, "values": values}
    points = CUBE.copy()
    if not has_base:
        del asset.tree["accessors"][0]["bufferView"]
        points[:] = 0
    points[[1, 7]] = CUBE[:2] + 5
    appended(asset, tmp_path, points)


def test_positions_that_serve_as_something_else_get_a_successor(tmp_path: Path) -> None:
    asset = cube()
    asset.tree["meshes"][0]["primitives"][0]["attributes"]["_REST"] = 0
    appended(asset, tmp_path, CUBE)


def test_positions_under_another_accessor_get_a_successor(tmp_path: Path) -> None:
    asset = cube()
    asset.tree["accessors"].append({**asset.tree["accessors"][0], "count": 2})
    appended(asset, tmp_path, CUBE)


@pytest.mark.parametrize("alike", [True, False])
def test_meshes_that_share_positions_part_only_if_they_move_apart(
    alike: bool, tmp_path: Path
) -> None:
    asset = cube()
    asset.mesh(*asset.tree["meshes"][0]["primitives"])
    document = read(asset.write(tmp_path / "in.glb"))
    first, second = (part.vertices for part in document.parts)
    moved = [bent(first), bent(second) if alike else second]
    document.save(tmp_path / "out.glb", moved)
    again = read(tmp_path / "out.glb")
    for part, expected in zip(again.parts, moved, strict=True):
        np.testing.assert_array_equal(part.vertices, expected.astype(np.float32))
    assert len(opened(tmp_path / "out.glb")[0]["accessors"]) == (2 if alike else 3)


def shaded_cube(hard: bool) -> tuple[Asset, NDArray[np.float32]]:
    """A cube with normals and tangents, its corners split into three or whole."""
    asset = Asset()
    if hard:
        corners = CUBE[FACES.ravel()]
        P = corners.reshape(-1, 3, 3)
        normals = np.repeat(np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]), 3, axis=0)
    else:
        corners, normals = CUBE, 2 * CUBE - 1
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype("<f4")
    tangents = np.cross(normals, [0.3, 0.5, 0.7])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    sign = np.where(np.arange(len(tangents)) % 2, 1, -1)
    attributes = {
        "POSITION": asset.accessor(corners),
        "NORMAL": asset.accessor(normals),
        "TANGENT": asset.accessor(np.column_stack([tangents, sign]).astype("<f4")),
    }
    primitive: dict[str, Any] = {"attributes": attributes}
    if not hard:
        primitive["indices"] = asset.accessor(FACES.ravel())
    asset.mesh(primitive)
    return asset, normals


@pytest.mark.parametrize("hard", [True, False])
def test_normals_and_tangents_follow_and_edges_stay_as_hard_as_they_are(
    hard: bool, tmp_path: Path
) -> None:
    asset, normals = shaded_cube(hard)
    path = asset.write(tmp_path / "in.glb")
    document = read(path)
    (part,) = document.parts
    # Sheared: x follows y. Flat faces stay flat.
    moved = part.vertices + 0.5 * part.vertices[:, [1, 1, 1]] * [1, 0, 0]
    assert document.save(tmp_path / "out.glb", [moved]) == []
    N, T = floats(tmp_path / "out.glb", 1), floats(tmp_path / "out.glb", 2, 4)
    assert not np.array_equal(N, normals)
    np.testing.assert_allclose(np.linalg.norm(N, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(T[:, :3], axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.einsum("ij,ij->i", N, T[:, :3]), 0, atol=1e-6)
    np.testing.assert_array_equal(T[:, 3], floats(path, 2, 4)[:, 3])
    if hard:
        P = moved[part.faces]
        flat = np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0])
        flat /= np.linalg.norm(flat, axis=1, keepdims=True)
        np.testing.assert_allclose(N.reshape(-1, 3, 3), flat[:, None].repeat(3, 1), atol=1e-6)


def test_normals_in_bytes_get_a_successor(tmp_path: Path) -> None:
    asset = cube()
    normals = np.round((2 * CUBE - 1) * 73).astype("i1")
    padded = np.hstack([normals, np.zeros((8, 1), "i1")])
    view = asset.view(padded.tobytes(), byteStride=4)
    normal = asset.accessor(normals, bufferView=view, normalized=True)
    asset.tree["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normal
    document = read(asset.write(tmp_path / "in.glb"))
    assert document.contents == ["normals"]
    document.save(tmp_path / "out.glb", [bent(document.parts[0].vertices)])
    assert opened(tmp_path / "out.glb")[0]["meshes"][0]["primitives"][0]["attributes"] == {
        "POSITION": 0,
        "NORMAL": 3,
    }
    np.testing.assert_allclose(
        np.linalg.norm(floats(tmp_path / "out.glb", 3), axis=1), 1, atol=1e-6
    )


def test_a_tangent_along_the_new_normal_is_kept_with_a_word(tmp_path: Path) -> None:
    asset = Asset()
    attributes = {
        "POSITION": asset.accessor(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")),
        "NORMAL": asset.accessor(np.tile(np.array([0, 0, 1], "<f4"), (3, 1))),
        "TANGENT": asset.accessor(np.tile(np.array([1, 0, 0, 1], "<f4"), (3, 1))),
    }
    asset.mesh({"attributes": attributes})
    document = read(asset.write(tmp_path / "in.glb"))
    moved = np.array([[0.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    (warning,) = document.save(tmp_path / "out.glb", [moved])
    assert "tangents" in warning
    np.testing.assert_array_equal(floats(tmp_path / "out.glb", 2, 4)[:, 0], 1)


def test_morph_targets_stay_with_a_warning(tmp_path: Path) -> None:
    asset = cube()
    asset.tree["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": asset.accessor(CUBE)}]
    document = read(asset.write(tmp_path / "in.glb"))
    assert "morph targets" in document.contents
    (warning,) = document.save(tmp_path / "out.glb", [bent(document.parts[0].vertices)])
    assert warning == "mesh 0: its morph targets are kept as displacements"
    np.testing.assert_array_equal(floats(tmp_path / "out.glb", 2), CUBE)


def test_what_single_precision_cannot_hold_is_told(tmp_path: Path) -> None:
    document = read(cube(CUBE + np.float32(4e6)).write(tmp_path / "in.glb"))
    moved = document.parts[0].vertices + 0.01
    (warning,) = document.save(tmp_path / "out.glb", [moved])
    assert "single precision" in warning


def external(folder: Path) -> Path:
    """A .gltf with its buffer and a texture in files of their own."""
    asset = cube()
    folder.mkdir()
    asset.tree["buffers"][0]["uri"] = "my%20data.bin"
    asset.tree["images"] = [{"uri": "skin.png"}]
    (folder / "my data.bin").write_bytes(asset.blob)
    (folder / "skin.png").write_bytes(b"skin")
    (folder / "in.gltf").write_text(json.dumps(asset.tree))
    return folder / "in.gltf"


@pytest.mark.parametrize("moves", [True, False])
def test_side_files_go_along_to_another_folder(moves: bool, tmp_path: Path) -> None:
    document = read(external(tmp_path / "in"))
    vertices = document.parts[0].vertices
    moved = bent(vertices) if moves else vertices
    (tmp_path / "out").mkdir()
    with writing_whole(tmp_path / "out" / "new.gltf") as scratch:
        assert document.save(scratch, [moved]) == []
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"new.gltf", "my data.bin", "skin.png"}
    again = read(tmp_path / "out" / "new.gltf").parts[0].vertices
    np.testing.assert_array_equal(again, moved.astype(np.float32))


@pytest.mark.parametrize("name", ["new.gltf", "in.gltf"])
def test_the_buffer_of_the_input_is_never_overwritten(name: str, tmp_path: Path) -> None:
    path = external(tmp_path / "in")
    before = (path.parent / "my data.bin").read_bytes()
    for step in range(2):  # the second replaces what the first has written
        document = read(path)
        moved = bent(document.parts[0].vertices) + step
        with writing_whole(path.parent / name) as scratch:
            document.save(scratch, [moved])
        (again,) = read(path.parent / name).parts
        np.testing.assert_array_equal(again.vertices, moved.astype(np.float32))
    assert (path.parent / "my data.bin").read_bytes() == before


def test_a_buffer_outside_its_folder_is_written_beside_the_output(tmp_path: Path) -> None:
    path = external(tmp_path / "in")
    tree = json.loads(path.read_text())
    (path.parent / "my data.bin").rename(tmp_path / "far.bin")
    tree["buffers"][0]["uri"] = "../far.bin"
    path.write_text(json.dumps(tree))
    document = read(path)
    (tmp_path / "a" / "b").mkdir(parents=True)
    document.save(tmp_path / "a" / "b" / "new.gltf", [bent(document.parts[0].vertices)])
    names = {path.name for path in (tmp_path / "a").rglob("*")}
    assert names == {"b", "new.gltf", "new.gltf.bin", "skin.png"}


@pytest.mark.parametrize(
    ("uri", "match"),
    [
        ("lost.bin", "lost.bin, which is missing"),
        ("https://example.com/a.bin", "download"),
        ("/dev/zero", "missing"),
        ("data:application/octet-stream,abc", "base64"),
        ("data:x;base64,A", "padding|base64"),
        (7, "not a text"),
    ],
)
def test_a_buffer_that_cannot_be_read_is_named(uri: Any, match: str, tmp_path: Path) -> None:
    path = external(tmp_path / "in")
    tree = json.loads(path.read_text())
    tree["buffers"][0]["uri"] = uri
    path.write_text(json.dumps(tree))
    with pytest.raises(MeshFileError, match=match):
        read(path)


@pytest.mark.parametrize(
    "name", ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"]
)
@pytest.mark.parametrize("declared", [True, False])
def test_compressed_meshes_are_refused_by_name(name: str, declared: bool, tmp_path: Path) -> None:
    asset = cube()
    if declared:
        asset.tree["extensionsUsed"] = [name]
    elif "draco" in name:
        asset.tree["meshes"][0]["primitives"][0]["extensions"] = {name: {}}
    else:
        asset.tree["bufferViews"][0]["extensions"] = {name: {}}
    with pytest.raises(MeshFileError, match=f"{name}.*without compression"):
        read(asset.write(tmp_path / "in.glb"))


def test_the_first_version_is_refused(tmp_path: Path) -> None:
    asset = cube()
    asset.tree["asset"]["version"] = "1.0"
    with pytest.raises(MeshFileError, match=r"version 1\.0.*convert"):
        read(asset.write(tmp_path / "in.gltf"))
    data = bytearray(cube().glb())
    data[4] = 1
    (tmp_path / "in.glb").write_bytes(data)
    with pytest.raises(MeshFileError, match="version 1"):
        read(tmp_path / "in.glb")


def spoiled(*keys: Any, value: Any) -> Asset:
    """A cube with one value of its JSON replaced."""
    asset = with_nodes({"mesh": 0})
    entry: Any = asset.tree
    for key in keys[:-1]:
        entry = entry[key]
    entry[keys[-1]] = value
    return asset


P = ("meshes", 0, "primitives", 0)


@pytest.mark.parametrize(
    ("keys", "value", "match"),
    [
        (("accessors", 0, "count"), 10**9, "reach beyond"),
        (("accessors", 0, "count"), 9, "reach beyond"),
        (("accessors", 0, "count"), 0, "no elements"),
        (("accessors", 0, "count"), -1, "count is -1"),
        (("accessors", 0, "count"), 10**30, "reach beyond"),
        (("accessors", 0, "count"), 8.0, "count is"),
        (("accessors", 0, "byteOffset"), -4, "byteOffset is -4"),
        (("accessors", 0, "componentType"), 5130, "type"),
        (("accessors", 0, "type"), "VEC2", "VEC2"),
        (("accessors", 0, "bufferView"), 99, r"bufferViews\[99\]"),
        (("accessors", 0), {"componentType": 5126, "count": 10**9, "type": "VEC3"}, "claims"),
        (("accessors", 1, "componentType"), 5122, "unsigned"),
        (("bufferViews", 0, "byteStride"), 4, "stride"),
        (("bufferViews", 0, "byteOffset"), 10**6, "reach beyond"),
        (("bufferViews", 0, "buffer"), 1, r"buffers\[1\]"),
        (("buffers", 0, "byteLength"), 10**12, "bytes, of"),
        (("buffers",), {}, "refers to"),
        (("meshes", 0), [], "indices|not an object"),
        (("meshes",), "text", "wrong type"),
        ((*P, "attributes", "POSITION"), 7, r"accessors\[7\]"),
        ((*P, "attributes", "NORMAL"), 1, "SCALAR"),
        ((*P, "attributes"), None, "wrong type"),
        ((*P, "indices"), 0, "VEC3"),
        ((*P, "mode"), 9, "mode"),
        ((*P, "mode"), 0, "no triangles"),
        (("accessors", 1, "count"), 2, "no triangles"),
        (P, 5, "wrong type"),
        (("nodes", 0, "mesh"), 3, r"meshes\[3\]"),
        (("nodes", 0, "children"), [0], "circle"),
        (("nodes", 0, "children"), [5], "child"),
        (("nodes", 0, "scale"), [1, 2], "scale"),
        (("nodes", 0, "matrix"), ["a"] * 16, "matrix"),
        (("nodes", 0), None, "not an object"),
        (("scenes", 0, "nodes"), [4], r"nodes\[4\]"),
        (("asset",), {}, "'version' is missing"),
    ],
)
def test_malformed_json_is_told(
    keys: tuple[Any, ...], value: Any, match: str, tmp_path: Path
) -> None:
    with pytest.raises(MeshFileError, match=match):
        read(spoiled(*keys, value=value).write(tmp_path / "in.glb"))


def test_any_value_of_another_type_is_told_or_harmless(tmp_path: Path) -> None:
    def places(entry: Any, *keys: Any) -> list[tuple[Any, ...]]:
        below = entry.items() if isinstance(entry, dict) else []
        below = enumerate(entry) if isinstance(entry, list) else below
        return [keys, *(place for key, value in below for place in places(value, *keys, key))]

    for keys in places(with_nodes({"mesh": 0}).tree)[1:]:
        for value in (None, -1, 1.5, "text", [], {}, [{}], 2**70):
            path = spoiled(*keys, value=value).write(tmp_path / "in.glb")
            try:
                document = read(path)
                moved = [bent(part.vertices) for part in document.parts]
                document.save(tmp_path / "out.glb", moved)
            except MeshFileError:
                pass


def test_a_file_cut_anywhere_is_told(tmp_path: Path) -> None:
    data = cube().glb()
    path = tmp_path / "in.glb"
    for size in range(len(data)):
        path.write_bytes(data[:size])
        with pytest.raises(MeshFileError):
            read(path)


@pytest.mark.parametrize("position", [8, 12])
def test_a_wrong_length_is_told(position: int, tmp_path: Path) -> None:
    data = bytearray(cube().glb())
    struct.pack_into("<I", data, position, 2**32 - 1)
    (tmp_path / "in.glb").write_bytes(data)
    with pytest.raises(MeshFileError):
        read(tmp_path / "in.glb")


@pytest.mark.parametrize("text", ["[" * 10**5, '{"a":' * 10**5, '{"a":1,"a":2}', '{"a":NaN}', "[]"])
def test_json_that_is_no_asset_is_told(text: str, tmp_path: Path) -> None:
    (tmp_path / "in.gltf").write_text(text)
    with pytest.raises(MeshFileError):
        read(tmp_path / "in.gltf")


def test_an_index_beyond_its_primitive_is_told(tmp_path: Path) -> None:
    asset = cube()
    primitive = {"attributes": {"POSITION": asset.accessor(CUBE[:3])}, "indices": 1}
    asset.tree["meshes"][0]["primitives"].insert(0, primitive)
    with pytest.raises(MeshFileError, match="of 3 vertices"):
        read(asset.write(tmp_path / "in.glb"))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_vertex_that_is_not_finite_is_told(value: float, tmp_path: Path) -> None:
    points = CUBE.copy()
    points[3, 1] = value
    with pytest.raises(MeshFileError, match="vertex 3"):
        read(cube(points).write(tmp_path / "in.glb"))


def test_many_primitives_over_one_accessor_are_bounded(tmp_path: Path) -> None:
    asset = Asset()
    accessor = asset.accessor(np.zeros((3000, 3), "<f4"))
    asset.mesh(*[{"attributes": {"POSITION": accessor}, "indices": 1}] * 3000)
    asset.accessor(np.zeros(3000, "<u2"))
    with pytest.raises(MeshFileError, match="claims"):
        read(asset.write(tmp_path / "in.glb"))


def test_nodes_that_form_a_circle_or_a_deep_chain_end(tmp_path: Path) -> None:
    count = 20_000
    nodes = [{"children": [number + 1]} for number in range(count)]
    chain = with_nodes(*nodes, {"mesh": 0, "translation": [1, 0, 0]})
    assert read(chain.write(tmp_path / "in.glb")).parts[0].vertices.max() == 2
    circle = with_nodes(*nodes, {"mesh": 0, "children": [1]})
    with pytest.raises(MeshFileError, match="child of two"):
        read(circle.write(tmp_path / "in.glb"))
    apart = with_nodes({"mesh": 0}, {"children": [2]}, {"children": [1]})
    with pytest.raises(MeshFileError, match="circle"):
        read(apart.write(tmp_path / "in.glb"))


@pytest.mark.skipif(not FIELD.is_dir(), reason="the files that users brought are not here")
@pytest.mark.parametrize("name", ["embedded_texture", "two_meshes", "node_transform"])
def test_files_that_users_brought_keep_all_but_vertices(name: str, tmp_path: Path) -> None:
    path = FIELD / f"{name}.glb"
    document = read(path)
    target = tmp_path / "out.glb"
    document.save(target, [part.vertices for part in document.parts])
    assert target.read_bytes() == path.read_bytes()
    moved = [bent(part.vertices) for part in document.parts]
    document.save(target, moved)
    for part, expected in zip(read(target).parts, moved, strict=True):
        np.testing.assert_allclose(part.vertices, expected, atol=1e-6)
    (before, old), (after, new) = opened(path), opened(target)
    assert len(old) == len(new)
    for accessor in (*before["accessors"], *after["accessors"]):
        accessor.pop("min", None)
        accessor.pop("max", None)
    assert before == after
