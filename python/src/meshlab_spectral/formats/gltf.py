"""glTF 2.0, as .gltf and .glb."""

from __future__ import annotations

import copy
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.formats.causes import unsupported
from meshlab_spectral.formats.digits import precision_warnings
from meshlab_spectral.formats.document import (
    Array,
    Document,
    Indices,
    Part,
    check_indices,
    check_vertices,
)
from meshlab_spectral.formats.gltf_accessors import (
    Asset,
    Json,
    numbers_of,
    parsed,
    reporting_faults,
)
from meshlab_spectral.formats.gltf_compression import uncompress
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.normals import following_normals
from meshlab_spectral.formats.placement import IDENTITY, Placement, placement_of
from meshlab_spectral.formats.side_files import copy_side_files
from meshlab_spectral.warned import Warned

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_LISTED = ("materials", "textures", "skins", "animations", "cameras")
_ATTRIBUTES = {"TEXCOORD": "texture coordinates", "COLOR": "colours", "NORMAL": "normals"}
_TRANSFORM = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}
# The columns of a vertex table.
_COLUMNS = {"POSITION": slice(0, 3), "NORMAL": slice(3, 6), "TANGENT": slice(6, 10)}
_P, _N, _ = _COLUMNS.values()
_ROUND_OFF = 2.0**-22  # of the largest value: a few of the last digits of single precision
_Key = tuple[int | None, ...]  # the accessor of each column
_Node = tuple[Json, Array]  # a node, and its transform to the scene


@dataclass(frozen=True)
class _Mesh:
    """The source of one part."""

    number: int
    rows: dict[_Key, slice]  # the table's rows for each key
    table: Array  # zeros where there are no normals or tangents
    placement: Placement


@dataclass
class _User:
    """What a mesh makes of an accessor."""

    mesh: str
    attribute: str
    primitives: list[Json]
    used: NDArray[np.bool_]  # the rows that its faces use
    before: Array
    after: Array
    is_common: bool = False  # whether others agree


@dataclass
class GltfDocument(Document):
    """A glTF asset; its JSON is kept, its buffers are patched."""

    _asset: Asset = field(kw_only=True, repr=False)
    _meshes: list[_Mesh] = field(default_factory=list, kw_only=True, repr=False)
    _compression: list[Warned] = field(default_factory=list, kw_only=True, repr=False)

    def side_files(self) -> list[str]:  # noqa: D102
        return self._asset.side_files()

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        """Write the asset with new positions, normals and tangents."""
        warnings: list[Warned] = []
        with reporting_faults(self.path):
            asset = copy.deepcopy(self._asset)
            users = defaultdict[int, list[_User]](list)
            for mesh, part, vertices in zip(self._meshes, self.parts, moved, strict=True):
                table = mesh.table
                if not np.array_equal(vertices, part.vertices):
                    table = _moved(mesh, part, vertices)
                    warnings += precision_warnings(mesh.table[:, _P], table[:, _P], target.name)
                for accessor, user in _users(asset, mesh, part, table):
                    users[accessor].append(user)
            for accessor, sharing in users.items():
                warnings += _put(asset, accessor, sharing)
            warnings += self._compression
            warnings += copy_side_files(self.path, target, asset.write(target))
        return warnings


def read(path: Path) -> GltfDocument:
    """Read a .gltf or .glb file; each mesh with triangles is a part."""
    data = path.read_bytes()
    with reporting_faults(path):
        document = GltfDocument(path, [], _asset=parsed(path, data))
        document._compression = uncompress(document._asset)
        nodes, shown = _nodes_of_meshes(document._asset)
        for number, mesh in enumerate(document._asset.tree.get("meshes", [])):
            _add_part(document, number, mesh, nodes[number], not shown or number in shown)
        if not document.parts:
            raise unsupported(path, "holds no triangles", "give a file with a triangle mesh")
        document.contents = _contents(document._asset.tree, nodes)
        return document


def _key(primitive: Json) -> _Key:
    return tuple(primitive["attributes"].get(name) for name in _COLUMNS)


def _add_part(
    document: GltfDocument, number: int, mesh: Json, nodes: list[_Node], is_shown: bool
) -> None:
    """Add a mesh as a part, unless it has no triangles."""
    tables: list[Array] = []
    rows: dict[_Key, slice] = {}
    faces: list[Indices] = []
    for primitive in mesh["primitives"]:
        key = _key(primitive)
        if primitive.get("mode", _TRIANGLES) < _TRIANGLES or key[0] is None:
            continue
        if key not in rows:
            start = sum(map(len, tables))
            tables.append(_read_table(document._asset, key))
            rows[key] = slice(start, start + len(tables[-1]))
        faces.append(_read_faces(document._asset, primitive, rows[key]) + rows[key].start)
    if not sum(map(len, faces)):
        return
    names = [holder.get("name") for holder in [mesh, *(node for node, _ in nodes)]]
    name = shown(next(filter(None, names), f"mesh {number}"))
    placement = placement_of(name, [matrix for _, matrix in nodes], document.warnings)
    table = np.concatenate(tables)
    placed = placement.placed(table[:, _P])
    check_vertices(document.path, placed)
    oriented = placement.oriented(np.concatenate(faces))
    part = Part(name, placed, oriented, copies=placement.copies, is_shown=is_shown)
    document.parts.append(part)
    document._meshes.append(_Mesh(number, rows, table, placement))
    if any("skin" in node for node, _ in nodes):
        text = f"{name} has a skeleton: lengths are measured without its pose"
        document.warnings.append(Warned("skeleton", text))
    if any("targets" in primitive for primitive in mesh["primitives"]):
        text = f"{name}: its morph targets are kept as displacements"
        document.warnings.append(Warned("kept_in_file", text))


def _read_table(asset: Asset, key: _Key) -> Array:
    columns = [asset.values(key[0], 3)]
    asset.budget.take(80 * len(columns[0]), f"a table of {len(columns[0])} vertices")
    for accessor, width in zip(key[1:], (3, 4), strict=True):
        missing = np.zeros((len(columns[0]), width))
        columns.append(missing if accessor is None else asset.values(accessor, width))
    return np.hstack(columns)


def _read_faces(asset: Asset, primitive: Json, rows: slice) -> Indices:
    vertices = rows.stop - rows.start
    if "indices" in primitive:
        corners = asset.values(primitive["indices"], 1).ravel().astype(np.int64)
    else:
        asset.budget.take(32 * vertices, "primitives without indices")
        corners = np.arange(vertices)
    step = np.arange(len(corners) - 2)
    modes = {
        _TRIANGLES: (step[::3], step[::3] + 1, step[::3] + 2),
        _STRIP: (step, step + 1 + step % 2, step + 2 - step % 2),
        _FAN: (step + 1, step + 2, 0 * step),
    }
    faces = corners[np.column_stack(modes[primitive.get("mode", _TRIANGLES)])]
    check_indices(asset.path, faces, vertices)
    return faces


def _nodes_of_meshes(asset: Asset) -> tuple[dict[int, list[_Node]], set[int]]:
    """Return the nodes that place each mesh, and the meshes in the default scene, by their indices.

    Nodes of other scenes count for meshes that are not in it.
    """
    nodes = asset.tree.get("nodes", [])
    children = [child for node in nodes for child in node.get("children", [])]
    inner = set(children)
    if len(inner) < len(children):
        raise ValueError("a node has two parents")
    default = set(range(len(nodes)))
    if scenes := asset.tree.get("scenes"):
        default = set(scenes[asset.tree.get("scene", 0)].get("nodes", []))
    # Nodes in the default scene, and others.
    placed: list[dict[int, list[_Node]]] = [defaultdict(list), defaultdict(list)]
    roots = [number for number in range(len(nodes)) if number not in inner]
    found = [(number, IDENTITY, number in default) for number in roots]
    for number, outer, is_default in found:  # grows while iterating
        node = asset.entry("nodes", number)
        matrix = outer @ _local_matrix(node)
        found += [(child, matrix, is_default) for child in node.get("children", [])]
        if "mesh" in node:
            # A mesh with a skin is placed by its joints, not by its node.
            node_and_matrix = node, IDENTITY if "skin" in node else matrix
            placed[not is_default][node["mesh"]].append(node_and_matrix)
    if len(found) < len(nodes):
        raise ValueError("its node hierarchy has a cycle")
    shown, others = placed
    return defaultdict(list, others | shown), set(shown)


def _local_matrix(node: Json) -> Array:
    if "matrix" in node:
        return numbers_of(node, "matrix", 16 * [0]).reshape(4, 4).T
    matrix = np.eye(4)
    matrix[:3, 3], (x, y, z, w), scale = (
        numbers_of(node, key, default) for key, default in _TRANSFORM.items()
    )
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = 2 / (x * x + y * y + z * z + w * w or 1.0) * (w * cross + cross @ cross)
    matrix[:3, :3] = (np.eye(3) + turn) * scale
    return matrix


def _contents(tree: Json, nodes: dict[int, list[_Node]]) -> list[str]:
    primitives = [p for mesh in tree["meshes"] for p in mesh["primitives"]]
    attributes = " ".join(name for primitive in primitives for name in primitive["attributes"])
    found = {kind: kind in tree for kind in _LISTED}
    found |= {content: name in attributes for name, content in _ATTRIBUTES.items()}
    found["morph targets"] = any("targets" in p for p in primitives)
    found["placement"] = any((m != IDENTITY).any() for placed in nodes.values() for _, m in placed)
    found["other scenes"] = len(tree.get("scenes", [])) > 1
    found["instances"] = "EXT_mesh_gpu_instancing" in tree.get("extensionsUsed", [])
    found["points and lines"] = any(p.get("mode", _TRIANGLES) < _TRIANGLES for p in primitives)
    return [content for content, is_there in found.items() if is_there]


def _moved(mesh: _Mesh, part: Part, vertices: Array) -> Array:
    """Return the table of a mesh whose placed vertices have moved."""
    before, after = mesh.table, mesh.table.copy()
    after[:, _P] = mesh.placement.back(before[:, _P], part.vertices, vertices)
    if before[:, _N].any():
        after[:, _N] = following_normals(before[:, _P], after[:, _P], part.faces, before[:, _N])
    # Project tangents onto the planes of the new normals, except those parallel to them.
    T, N = before[:, 6:9], after[:, _N]
    new = T - np.einsum("ij,ij->i", T, N)[:, None] * N
    length = np.linalg.norm(new, axis=1, keepdims=True)
    turned = (before[:, _N] != N).any(axis=1, keepdims=True) & (length > 1e-6)
    after[:, 6:9] = np.where(turned, new / length, T)
    return after


def _users(asset: Asset, mesh: _Mesh, part: Part, table: Array) -> Iterator[tuple[int, _User]]:
    """Yield the accessors of a mesh, and what it makes of each."""
    primitives = defaultdict[_Key, list[Json]](list)
    for primitive in asset.entry("meshes", mesh.number)["primitives"]:
        primitives[_key(primitive)].append(primitive)
    used = np.zeros(len(table), bool)
    used[part.faces] = True
    for key, rows in mesh.rows.items():
        for (name, columns), accessor in zip(_COLUMNS.items(), key, strict=True):
            if accessor is not None:
                tables = mesh.table[rows, columns], table[rows, columns]
                yield accessor, _User(part.name, name, primitives[key], used[rows], *tables)


def _put(asset: Asset, accessor: int, users: list[_User]) -> list[Warned]:
    """Write what users have made of an accessor to it, and to new ones where they disagree."""
    before = users[0].before
    values, taken, apart = before.copy(), np.zeros(len(before), bool), list[_User]()
    for user in users:
        tolerance = _ROUND_OFF * np.abs(user.after).max()
        both = taken & user.used
        if (np.abs(values - user.after)[both] > tolerance).any():
            apart.append(user)
            continue
        new = user.used & ~taken
        values[new] = user.after[new]
        taken |= new
        user.is_common = True
    number = asset.put(accessor, before, values)
    for user in users:
        own = number if user.is_common else asset.put(accessor, before, user.after)
        for primitive in user.primitives:
            primitive["attributes"][user.attribute] = own
    alike = f"vertices in common with {users[0].mesh} that move apart: it gets its own"
    return [
        Warned("parted_meshes", f"{user.mesh} has {alike}")
        for user in apart
        if user.attribute == "POSITION"
    ]
