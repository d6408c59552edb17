"""glTF: positions, normals and tangents are replaced, and everything else stays."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.meshes import in_scene
from meshlab_spectral.files.whole_files import writing_whole
from meshlab_spectral.formats.gltf import GltfDocument, read
from numpy.typing import NDArray

# A cube's corners; its normals point outwards.
CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype="<f4")
FACES = np.array([*"013032467475045051237276026064157173"], dtype="<u2").reshape(-1, 3)
COMPONENTS = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}


class Asset:
    """A glTF asset that grows by accessors."""

    def __init__(self) -> None:
        self.blob = bytearray()
        self.tree: dict[str, Any] = {"asset": {"version": "2.0", "extras": {"price": 1e-7, "é": 1}}}
        self.tree |= {"accessors": [], "bufferViews": [], "buffers": [{}], "meshes": []}

    def view(self, data: bytes, **more: Any) -> int:
        self.blob.extend(bytes(-len(self.blob) % 4))
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data), **more}
        self.tree["bufferViews"].append(view)
        self.blob.extend(data)
        self.tree["buffers"][0]["byteLength"] = len(self.blob)
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, values: NDArray[Any], **more: Any) -> int:
        entry = {
            "bufferView": self.view(values.tobytes()) if "bufferView" not in more else None,
            "componentType": COMPONENTS[values.dtype.char],
            "count": len(values),
            "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
        }
        self.tree["accessors"].append({**entry, **more})
        return len(self.tree["accessors"]) - 1

    def mesh(self, *primitives: dict[str, Any], **more: Any) -> None:
        self.tree["meshes"].append({"primitives": list(primitives), **more})

    def write(self, path: Path) -> Path:
        """Write .glb, or .gltf with a data URI."""
        if path.suffix == ".gltf":
            text = base64.b64encode(self.blob).decode()
            self.tree["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{text}"
            path.write_text(json.dumps(self.tree, indent=1))
            return path
        text, blob = json.dumps(self.tree).encode(), bytes(self.blob)
        text, blob = text + b" " * (-len(text) % 4), blob + bytes(-len(blob) % 4)
        body = struct.pack("<I4s", len(text), b"JSON") + text
        body += struct.pack("<I4s", len(blob), b"BIN\0") + blob
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
        return path


def cube(points: NDArray[Any] = CUBE, *nodes: dict[str, Any]) -> Asset:
    """A mesh of one primitive."""
    asset = Asset()
    attributes = {"POSITION": asset.accessor(points, min=[0, 0, 0], max=[1, 1, 1])}
    asset.mesh({"attributes": attributes, "indices": asset.accessor(FACES.ravel())})
    asset.tree |= {"nodes": list(nodes), "scenes": [{"nodes": [0]}], "scene": 0} if nodes else {}
    return asset


def opened(path: Path) -> tuple[dict[str, Any], bytes]:
    """The JSON and the first buffer of a file, read without the package."""
    data = path.read_bytes()
    if path.suffix == ".gltf":
        tree = json.loads(data)
        return tree, base64.b64decode(tree["buffers"][0]["uri"].partition(",")[2])
    size = struct.unpack_from("<I", data, 12)[0]
    assert struct.unpack_from("<I", data, 8)[0] == len(data)
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def floats(path: Path, accessor: int, width: int = 3) -> NDArray[np.float32]:
    """The elements of an accessor of contiguous floats."""
    tree, blob = opened(path)
    entry = tree["accessors"][accessor]
    view = tree["bufferViews"][entry["bufferView"]]
    assert (entry["componentType"], view["byteOffset"] % 4) == (5126, 0)
    return np.frombuffer(blob, "<f4", entry["count"] * width, view["byteOffset"]).reshape(-1, width)


def bent(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move all vertices but the first."""
    moved = vertices + 0.05 * np.sin(7 * vertices[:, [1, 2, 0]] + np.arange(len(vertices))[:, None])
    moved[0] = vertices[0]
    return moved


def moved_file(asset: Asset, tmp_path: Path, suffix: str = ".glb") -> tuple[GltfDocument, Path]:
    """Bend all parts of an asset; check that reading the result gives the bent shapes."""
    document, target = read(asset.write(tmp_path / f"in{suffix}")), tmp_path / f"out{suffix}"
    moved = [bent(part.vertices) for part in document.parts]
    assert document.save(target, moved) == []
    for part, again, expected in zip(document.parts, read(target).parts, moved, strict=True):
        np.testing.assert_allclose(again.vertices, expected, atol=1e-6 * np.abs(expected).max())
        np.testing.assert_array_equal(again.faces, part.faces)
    return document, target


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_only_positions_and_their_bounds_change(suffix: str, tmp_path: Path) -> None:
    asset = cube()
    asset.tree["meshes"][0]["primitives"][0]["extensions"] = {}
    path, target = asset.write(tmp_path / f"in{suffix}"), tmp_path / f"out{suffix}"
    document = read(path)
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, CUBE)
    np.testing.assert_array_equal(part.faces, FACES)
    assert document.save(target, [part.vertices]) == []
    assert target.read_bytes() == path.read_bytes()
    moved = bent(part.vertices)
    assert document.save(target, [moved]) == []
    np.testing.assert_array_equal(floats(target, 0), moved.astype(np.float32))
    (before, old), (after, new) = opened(path), opened(target)
    assert new[96:] == old[96:]
    assert after["accessors"][0].pop("min") == floats(target, 0).min(axis=0).tolist()
    assert after["accessors"][0].pop("max") == floats(target, 0).max(axis=0).tolist()
    del before["accessors"][0]["min"], before["accessors"][0]["max"]
    for tree in (before, after):
        tree["buffers"][0].pop("uri", None)
    assert json.dumps(before) == json.dumps(after)  # including the order of the keys


def test_nested_nodes_place_a_mesh_and_a_mirrored_one_stays_outside_out(tmp_path: Path) -> None:
    half = np.sqrt(0.5)
    outer = {"scale": [-2, 3, 4], "rotation": [0, 0, half, half], "translation": [5, 6, 7]}
    inner = {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1], "mesh": 0}
    document, target = moved_file(cube(CUBE, {**outer, "children": [1]}, inner), tmp_path)
    x, y, z = CUBE.T.astype(float)
    expected = np.column_stack([5 - 3 * y, 6 - 2 * (x + 1), 7 + 4 * z])
    (part,) = document.parts
    np.testing.assert_allclose(part.vertices, expected, atol=1e-12)
    assert np.linalg.det(part.vertices[part.faces]).sum() / 6 == pytest.approx(24)
    np.testing.assert_array_equal(floats(target, 0)[0], CUBE[0])
    assert document.contents == ["placement"]


@pytest.mark.parametrize(
    ("nodes", "warning"),
    [
        ([{"mesh": 0, "scale": [1, 0, 1], "name": "leaf"}], "leaf is flattened"),
        ([{"mesh": 0, "skin": 0, "scale": [9, 9, 9]}], "skeleton"),
        ([{"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "scale": [2, 2, 2]}], "several times"),
        ([{"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "scale": [1, -1, 1]}], None),
    ],
)
def test_the_first_placement_counts(nodes: Any, warning: str | None, tmp_path: Path) -> None:
    document, _ = moved_file(cube(CUBE, *nodes), tmp_path)
    np.testing.assert_array_equal(document.parts[0].vertices, CUBE)
    assert len(document.warnings) == (warning is not None)
    assert all(str(warning) in given for given in document.warnings)


def test_triangles_strips_and_fans_are_read(tmp_path: Path) -> None:
    asset = Asset()
    attributes = {"POSITION": asset.accessor(CUBE[:5])}
    asset.mesh(*({"attributes": attributes, "mode": mode} for mode in (4, 5, 6)))
    (part,) = read(asset.write(tmp_path / "in.glb")).parts
    strip, fan = [[0, 1, 2], [1, 3, 2], [2, 3, 4]], [[1, 2, 0], [2, 3, 0], [3, 4, 0]]
    np.testing.assert_array_equal(part.faces, [[0, 1, 2], *strip, *fan])


def test_primitives_of_one_mesh_are_one_part_and_share_vertices(tmp_path: Path) -> None:
    asset = cube()
    own, lines = asset.accessor(CUBE + np.float32(1)), asset.accessor(CUBE + np.float32(2))
    primitives = asset.tree["meshes"][0]["primitives"]
    primitives += [{"attributes": {"POSITION": own}, "indices": 1}, primitives[0]]
    primitives += [{"attributes": {"POSITION": number}, "mode": 1} for number in (0, lines)]
    document, target = moved_file(asset, tmp_path)
    np.testing.assert_array_equal(document.parts[0].vertices, np.vstack([CUBE, CUBE + 1]))
    np.testing.assert_array_equal(document.parts[0].faces, np.vstack([FACES, FACES + 8, FACES]))
    assert document.contents == ["points and lines"]
    np.testing.assert_array_equal(floats(target, lines), CUBE + 2)
    assert len(opened(target)[0]["accessors"]) == 4


def test_interleaved_positions_are_replaced_where_they_are(tmp_path: Path) -> None:
    asset = cube()
    wind = CUBE[::-1] + np.float32(3)
    view = asset.view(np.hstack([CUBE, wind]).tobytes(), byteStride=24)
    attributes = {"POSITION": asset.accessor(CUBE, bufferView=view)}
    attributes["_WIND"] = asset.accessor(wind, bufferView=view, byteOffset=12)
    asset.tree["meshes"][0]["primitives"][0]["attributes"] = attributes
    document, target = moved_file(asset, tmp_path)
    tree, blob = opened(target)
    assert tree == asset.tree
    rows = np.frombuffer(blob, "<f4", offset=tree["bufferViews"][view]["byteOffset"]).reshape(8, 6)
    moved = bent(document.parts[0].vertices).astype(np.float32)
    np.testing.assert_array_equal(rows, np.hstack([moved, wind]))


@pytest.mark.parametrize("kind", ["quantized", "sparse"])
def test_positions_that_are_not_plain_floats_get_a_new_accessor(kind: str, tmp_path: Path) -> None:
    asset, points = cube(), CUBE.copy()
    if kind == "quantized":
        asset = cube((255 * CUBE - 128).astype("i1"))
        asset.tree["accessors"][0]["normalized"] = True
        points = np.maximum((255 * CUBE - 128) / 127, -1)
    else:
        values = {"bufferView": asset.view((CUBE[:2] + 5).tobytes())}
        # The buffer ends at no multiple of 4; new floats begin at one.
        rows = {"bufferView": asset.view(bytes([1, 7])), "componentType": 5121}
        asset.tree["accessors"][0]["sparse"] = {"count": 2, "indices": rows, "values": values}
        points[[1, 7]] = CUBE[:2] + 5
    document, target = moved_file(asset, tmp_path, ".gltf")
    np.testing.assert_allclose(document.parts[0].vertices, points, atol=1e-7)
    tree, blob = opened(target)
    assert blob.startswith(asset.blob)
    assert tree["accessors"][:2] == asset.tree["accessors"]
    assert tree["meshes"][0]["primitives"][0]["attributes"] == {"POSITION": 2}
    assert tree["accessors"][2]["max"] == floats(target, 2).max(axis=0).tolist()


@pytest.mark.parametrize("alike", [True, False])
def test_meshes_that_share_positions_split_if_they_move_apart(alike: bool, tmp_path: Path) -> None:
    asset = cube()
    asset.mesh(*asset.tree["meshes"][0]["primitives"])
    document, target = read(asset.write(tmp_path / "in.glb")), tmp_path / "out.glb"
    first, second = (part.vertices for part in document.parts)
    moved = [bent(first), bent(second) if alike else second]
    document.save(target, moved)
    for part, expected in zip(read(target).parts, moved, strict=True):
        np.testing.assert_array_equal(part.vertices, expected.astype(np.float32))
    assert len(opened(target)[0]["accessors"]) == (2 if alike else 3)


def test_normals_and_tangents_follow_and_hard_edges_stay_hard(tmp_path: Path) -> None:
    asset = Asset()
    P = CUBE[FACES]
    normals = np.repeat(np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]), 3, axis=0)
    tangents = np.cross(normals, [0.3, 0.5, 0.7])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    tangents = np.column_stack([tangents, np.tile([1, -1], 18)]).astype("<f4")
    attributes = {"POSITION": asset.accessor(P.reshape(-1, 3))}
    attributes["NORMAL"] = asset.accessor((127 * normals).astype("i1"), normalized=True)
    attributes["TANGENT"] = asset.accessor(tangents)
    asset.mesh({"attributes": attributes})
    document, target = read(asset.write(tmp_path / "in.glb")), tmp_path / "out.glb"
    # Sheared: x follows y. Flat faces stay flat.
    vertices = document.parts[0].vertices
    moved = vertices + 0.5 * vertices[:, [1, 1, 1]] * [1, 0, 0]
    assert document.save(target, [moved]) == []
    N, T = floats(target, 3), floats(target, 2, 4)
    Q = moved.reshape(-1, 3, 3)
    flat = np.cross(Q[:, 1] - Q[:, 0], Q[:, 2] - Q[:, 0])
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    np.testing.assert_allclose(N, np.repeat(flat, 3, axis=0), atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(T[:, :3], axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.einsum("ij,ij->i", N, T[:, :3]), 0, atol=1e-6)
    np.testing.assert_array_equal(T[:, 3], tangents[:, 3])


def test_data_that_cannot_follow_the_shape_are_reported(tmp_path: Path) -> None:
    asset = cube(CUBE + np.float32(4e6))
    asset.tree["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": asset.accessor(CUBE)}]
    document = read(asset.write(tmp_path / "in.glb"))
    assert document.warnings == ["mesh 0: its morph targets are kept as displacements"]
    (warning,) = document.save(tmp_path / "out.glb", [document.parts[0].vertices + 0.01])
    assert "single precision" in warning


@pytest.mark.parametrize("name", ["new.gltf", "in.gltf"])
def test_the_buffer_of_the_input_is_never_overwritten(name: str, tmp_path: Path) -> None:
    asset, path = cube(), tmp_path / "in.gltf"
    asset.tree["buffers"][0]["uri"] = "my%20data.bin"
    path.write_text(json.dumps(asset.tree))
    (tmp_path / "my data.bin").write_bytes(asset.blob)
    for step in range(2):  # the second replaces what the first has written
        document = read(path)
        moved = bent(document.parts[0].vertices) + step
        with writing_whole(tmp_path / name) as scratch:
            document.save(scratch, [moved])
        np.testing.assert_array_equal(read(tmp_path / name).parts[0].vertices, np.float32(moved))
    assert (tmp_path / "my data.bin").read_bytes() == asset.blob


@pytest.mark.parametrize(
    ("keys", "value", "match"),
    [
        (("extensionsRequired",), ["EXT_meshopt_compression"], "meshopt.*without compression"),
        (("asset", "version"), "1.0", r"version 1\.0.*convert"),
        (("accessors", 0, "count"), 9, "does not hold 9"),
        (("accessors", 0), {"componentType": 5126, "count": 10**9, "type": "VEC3"}, "claim"),
        (("buffers", 0, "byteLength"), 10**12, "bytes, of"),
        (("buffers", 0, "uri"), "lost.bin", "lost.bin, which in.glb refers to, is missing"),
        (("meshes", 0, "primitives", 0, "indices"), 7, r"accessors\[7\]"),
        (("nodes", 0, "children"), [0], "cycle"),
        (("nodes", 0, "children"), [1, 1], "two parents"),
    ],
)
def test_a_damaged_file_is_refused(keys: Any, value: Any, match: str, tmp_path: Path) -> None:
    with pytest.raises(MeshFileError, match=match):
        read(spoiled(keys, value).write(tmp_path / "in.glb"))


def spoiled(keys: tuple[Any, ...], value: Any) -> Asset:
    """A cube with one value of its JSON replaced."""
    asset = cube(CUBE, {"mesh": 0})
    entry: Any = asset.tree
    for key in keys[:-1]:
        entry = entry[key]
    entry[keys[-1]] = value
    return asset


def test_any_value_of_the_wrong_type_is_refused_or_harmless(tmp_path: Path) -> None:
    def places(entry: Any, *keys: Any) -> list[tuple[Any, ...]]:
        below = entry.items() if isinstance(entry, dict) else []
        below = enumerate(entry) if isinstance(entry, list) else below
        return [keys, *(place for key, value in below for place in places(value, *keys, key))]

    for keys in places(cube(CUBE, {"mesh": 0}).tree)[1:]:
        for value in (None, -1, 1.5, "text", [], {}, [{}], 2**70):
            told = ""
            try:
                document = read(spoiled(keys, value).write(tmp_path / "in.glb"))
                document.save(tmp_path / "out.glb", [bent(p.vertices) for p in document.parts])
            except MeshFileError as error:
                told = str(error)
            assert " object" not in told  # Python's words


def test_chosen_normals_turn_as_their_surface_turns(tmp_path: Path) -> None:
    """As on leaves, whose normals point to the sky."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 9)))
    V = np.column_stack([x, y, 0 * x]).astype("<f4")
    k = np.arange(81).reshape(9, 9)
    F = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[:-1, :-1], k[1:, 1:], k[1:, :-1]], axis=2)
    chosen = np.column_stack([0.6 + 0 * x, 0.5 * x, 0.5 + 0 * x])
    chosen = (chosen / np.linalg.norm(chosen, axis=1, keepdims=True)).astype("<f4")
    asset = Asset()
    attributes = {"POSITION": asset.accessor(V), "NORMAL": asset.accessor(chosen)}
    indices = asset.accessor(F.reshape(-1).astype("<u2"))
    asset.mesh({"attributes": attributes, "indices": indices})
    document = read(asset.write(tmp_path / "in.glb"))
    angle = 0.3  # the sheet turns around y
    turn = np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    )
    document.save(tmp_path / "out.glb", [V.astype(float) @ turn.T])
    np.testing.assert_allclose(floats(tmp_path / "out.glb", 1), chosen @ turn.T, atol=1e-6)


def test_the_default_scene_is_what_a_conversion_takes(tmp_path: Path) -> None:
    asset = cube(CUBE, {"mesh": 0}, {"mesh": 1}, {"children": [3]}, {"mesh": 1, "scale": [2, 2, 2]})
    asset.mesh(*asset.tree["meshes"][0]["primitives"])
    asset.tree |= {"scenes": [{"nodes": [0, 1]}, {"nodes": [2]}], "scene": 1}
    document = read(asset.write(tmp_path / "in.glb"))
    assert [part.is_shown for part in document.parts] == [False, True]
    assert "other scenes" in document.contents
    np.testing.assert_array_equal(document.parts[1].vertices, 2 * CUBE)
    assert document.parts[1].copies == ()
    (part,) = in_scene(document.parts)
    np.testing.assert_array_equal(part.vertices, 2 * CUBE)


@pytest.mark.parametrize(
    ("is_required", "has_indices"), [(False, True), (True, True), (True, False)]
)
def test_draco_is_decoded_and_told(is_required: bool, has_indices: bool, tmp_path: Path) -> None:
    """Where the file has an uncompressed copy, too, that is taken."""
    asset = cube()
    primitive = asset.tree["meshes"][0]["primitives"][0]
    labels = np.arange(8, dtype="<f4")
    primitive["attributes"]["_LABEL"] = label = asset.accessor(labels, min=[0], max=[8])
    if is_required:
        draco = pytest.importorskip("DracoPy")
        packed = draco.encode(
            CUBE.astype(float),
            FACES.astype("u4"),
            quantization_bits=20,
            preserve_order=True,
            generic_attributes={5: labels[:, None]},
        )
        ids = {one["attribute_type"]: one["unique_id"] for one in draco.decode(packed).attributes}
        for number in (*primitive["attributes"].values(), primitive["indices"]):
            del asset.tree["accessors"][number]["bufferView"]
        asset.tree["extensionsRequired"] = ["KHR_draco_mesh_compression"]
        attributes = {"POSITION": ids[0], "_LABEL": 5}
    else:
        packed, attributes = b"nobody decodes it", {"POSITION": 0}
    extension = {"bufferView": asset.view(packed), "attributes": attributes}
    primitive["extensions"] = {"KHR_draco_mesh_compression": extension}
    if not has_indices:  # accessors are numbered: one that nobody refers to stays
        del primitive["indices"]
    asset.tree["extensionsUsed"] = ["KHR_draco_mesh_compression", "KHR_materials_unlit"]
    source, target = asset.write(tmp_path / "in.glb"), tmp_path / "out.glb"
    document = read(source)
    (part,) = document.parts
    corners = [part.vertices[part.faces], CUBE[FACES]]
    rows = [np.sort(np.round(one, 4).reshape(-1, 9), axis=1) for one in corners]
    assert sorted(rows[0].tolist()) == sorted(rows[1].tolist())
    assert document.save(target, [part.vertices]) == []
    assert target.read_bytes() == source.read_bytes()
    moved = bent(part.vertices)
    (warning,) = document.save(target, [moved])
    assert warning == "it is written without its compression, KHR_draco_mesh_compression"
    tree, _ = opened(target)
    assert tree["extensionsUsed"] == ["KHR_materials_unlit"]
    assert "extensionsRequired" not in tree
    assert tree["accessors"][label]["max"] == [7 if is_required else 8]  # of what was decoded
    assert "extensions" not in tree["meshes"][0]["primitives"][0]
    np.testing.assert_allclose(read(target).parts[0].vertices, moved, atol=1e-6)
    written = tree["meshes"][0]["primitives"][0]["attributes"]["_LABEL"]
    assert sorted(floats(target, written, 1).ravel().tolist()) == labels.tolist()


def test_the_uncompressed_copy_beside_meshopt_is_taken(tmp_path: Path) -> None:
    asset = cube()
    for view in asset.tree["bufferViews"]:
        view["extensions"] = {"EXT_meshopt_compression": {"buffer": 0, "byteLength": 1}}
    asset.tree["extensionsUsed"] = ["EXT_meshopt_compression"]
    document = read(asset.write(tmp_path / "in.glb"))
    moved = bent(document.parts[0].vertices)
    assert len(document.save(tmp_path / "out.glb", [moved])) == 1
    tree, _ = opened(tmp_path / "out.glb")
    assert "extensionsUsed" not in tree
    assert not any("extensions" in view for view in tree["bufferViews"])
    np.testing.assert_allclose(read(tmp_path / "out.glb").parts[0].vertices, moved, atol=1e-6)
