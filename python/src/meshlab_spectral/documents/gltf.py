"""glTF 2.0, as .gltf and .glb."""

from __future__ import annotations

import contextlib
import itertools
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple, dataclass, field
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote, unquote

import numpy as np

from meshlab_spectral.documents.digits import precision_warning
from meshlab_spectral.documents.document import (
    Array,
    Document,
    Indices,
    Part,
    check_indices,
    check_vertices,
    unsupported,
)
from meshlab_spectral.documents.gltf_accessors import (
    FLOAT,
    Asset,
    Json,
    parsed,
    relative_names,
    reporting_faults,
)
from meshlab_spectral.documents.normals import following_normals
from meshlab_spectral.documents.placement import IDENTITY, Placement, placement_of
from meshlab_spectral.documents.side_files import copy_side_files

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_COMPRESSIONS = (
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
)
_SHADING = ("POSITION", "NORMAL", "TANGENT")
_PARALLEL = 1e-6  # sine of the angle
_Use = tuple[int, int, str]  # mesh, primitive, attribute
_Key = TypeVar("_Key")


@dataclass
class _Nodes:
    """The nodes that place a mesh."""

    matrices: list[Array] = field(default_factory=list)
    name: str = ""
    has_skin: bool = False


@dataclass(frozen=True)
class _Primitive:
    """Triangles of one material."""

    attributes: Json  # accessors by name
    faces: Indices
    normals: Array | None
    tangents: Array | None

    @property
    def key(self) -> tuple[int, int]:
        """The accessors of positions and normals."""
        return self.attributes["POSITION"], self.attributes["NORMAL"]


@dataclass(frozen=True)
class _Mesh:
    """What one part was read from."""

    number: int
    primitives: list[_Primitive]
    rows: dict[int, slice]  # the vertices of each accessor of positions
    own: Array  # vertices, without transforms
    placement: Placement


@dataclass(frozen=True)
class _Change:
    """New values for an accessor, in the primitives that use it together."""

    uses: set[_Use]
    before: Array
    values: Array


@dataclass
class GltfDocument(Document):
    """A glTF asset: its JSON stays, its buffers are patched."""

    _data: bytes = field(kw_only=True, repr=False)
    _asset: Asset = field(kw_only=True, repr=False)
    _meshes: list[_Mesh] = field(default_factory=list, kw_only=True, repr=False)

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        """Write the asset with other positions, normals and tangents; see Document."""
        with reporting_faults(self.path):
            asset = parsed(self.path, self._data)
            asset.buffers = dict(self._asset.buffers)
            warnings = self._patch(asset, moved, target.name)
            if not asset.patched:
                target.write_bytes(self._data)
                return warnings + copy_side_files(self.path, target, relative_names(asset.tree))
            kept = _write_buffers(asset, target)
            target.write_bytes(asset.serialized())
            return warnings + copy_side_files(self.path, target, kept)

    def _patch(self, asset: Asset, moved: Sequence[Array], name: str) -> list[str]:
        """Put new values into the asset; return warnings."""
        warnings: list[str] = []
        changes: dict[int, list[_Change]] = defaultdict(list)
        for mesh, part, vertices in zip(self._meshes, self.parts, moved, strict=True):
            if np.array_equal(vertices, part.vertices):
                continue
            after = mesh.placement.back(mesh.own, part.vertices, vertices)
            entry = asset.entry("meshes", mesh.number)
            for accessor, change in _changes(mesh, entry, after, warnings):
                changes[accessor].append(change)
            warnings += filter(None, [precision_warning(mesh.own, after, name)])
            if any(primitive.get("targets") for primitive in entry["primitives"]):
                warnings.append(f"{part.name}: its morph targets are kept as displacements")
        if changes:
            uses, overlaps = _uses(asset.tree), _Overlaps(asset)
            for accessor, wanted in changes.items():
                _apply(asset, accessor, _merged(wanted), uses[accessor], overlaps)
        return list(dict.fromkeys(warnings))


def read(path: Path) -> GltfDocument:
    """Read a .gltf or .glb file; each mesh with triangles is a part.

    Raises
    ------
    MeshFileError
        When it is damaged, compressed, of another version, or without triangles.
    """
    data = path.read_bytes()
    with reporting_faults(path):
        asset = parsed(path, data)
        _refuse_compression(asset)
        document = GltfDocument(path, [], _data=data, _asset=asset)
        nodes = _nodes_of_meshes(asset)
        for number in range(len(asset.tree.get("meshes", []))):
            _add_part(document, number, nodes[number])
        if not document.parts:
            raise unsupported(path, "holds no triangles", "give a file with a triangle mesh")
        document.contents = _contents(asset.tree, nodes)
        return document


def _refuse_compression(asset: Asset) -> None:
    tree = asset.tree
    holders = [*_primitives(tree), *tree.get("bufferViews", [])]
    named = {name for holder in holders for name in holder.get("extensions", {})}
    named.update(tree.get("extensionsUsed", []), tree.get("extensionsRequired", []))
    for name in _COMPRESSIONS:
        if name in named:
            raise unsupported(
                asset.path,
                f"is compressed with {name}",
                "export it again without compression from the program that made it",
            )


def _primitives(tree: Json) -> Iterator[Json]:
    for mesh in tree.get("meshes", []):
        yield from mesh["primitives"]


def _add_part(document: GltfDocument, number: int, nodes: _Nodes) -> None:
    """Read a mesh, unless it has no triangles."""
    asset = document._asset
    entry = asset.entry("meshes", number)
    positions: dict[int, Array] = {}
    primitives = [
        _read_primitive(asset, primitive, positions)
        for primitive in entry["primitives"]
        if _mode(primitive) >= _TRIANGLES and "POSITION" in primitive["attributes"]
    ]
    if not any(primitive.faces.size for primitive in primitives):
        return
    name = str(entry.get("name") or nodes.name or f"mesh {number}")
    own, rows = np.concatenate(list(positions.values())), _rows(positions)
    placement = placement_of(name, nodes.matrices, document.warnings)
    placed = placement.placed(own)
    check_vertices(document.path, placed)
    faces = np.concatenate([p.faces + rows[p.attributes["POSITION"]].start for p in primitives])
    document.parts.append(Part(name, placed, placement.oriented(faces)))
    document._meshes.append(_Mesh(number, primitives, rows, own, placement))
    if nodes.has_skin:
        document.warnings.append(
            f"{name} is posed by a skeleton: lengths are measured without its pose"
        )


def _rows(blocks: dict[_Key, Array]) -> dict[_Key, slice]:
    """Return the rows of each block when they are put together."""
    ends = list(itertools.accumulate(map(len, blocks.values())))
    return {key: slice(end - len(blocks[key]), end) for key, end in zip(blocks, ends, strict=True)}


def _mode(primitive: Json) -> int:
    mode = primitive.get("mode", _TRIANGLES)
    if type(mode) is not int or not 0 <= mode <= _FAN:
        raise ValueError(f"a primitive has the mode {mode!r:.80}")
    return mode


def _read_primitive(asset: Asset, entry: Json, positions: dict[int, Array]) -> _Primitive:
    """Read triangles and what follows them; put positions that are new into `positions`."""
    attributes = entry["attributes"]
    accessor = attributes["POSITION"]
    if accessor not in positions:
        positions[accessor] = asset.values(accessor, 3)
    vertices = len(positions[accessor])
    corners = asset.indices(entry["indices"]) if "indices" in entry else np.arange(vertices)
    faces = _triangles(corners, _mode(entry))
    check_indices(asset.path, faces, vertices)
    normals, tangents = (
        asset.values(attributes[key], width) if key in attributes else None
        for key, width in (("NORMAL", 3), ("TANGENT", 4))
    )
    if any(values is not None and len(values) != vertices for values in (normals, tangents)):
        raise ValueError(f"a primitive has other numbers of normals or tangents than {vertices}")
    return _Primitive(attributes, faces, normals, tangents)


def _triangles(corners: Indices, mode: int) -> Indices:
    if mode == _TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    count = max(len(corners) - 2, 0)
    step = np.arange(count)
    if mode == _FAN:
        return corners[np.column_stack([step + 1, step + 2, np.zeros_like(step)])]
    odd = step % 2
    return corners[np.column_stack([step, step + 1 + odd, step + 2 - odd])]


def _nodes_of_meshes(asset: Asset) -> dict[int, _Nodes]:
    nodes = [asset.entry("nodes", number) for number in range(len(asset.tree.get("nodes", [])))]
    result: dict[int, _Nodes] = defaultdict(_Nodes)
    for node, matrix in _walk(nodes, _roots_shown(asset)):
        if "mesh" not in node:
            continue
        asset.entry("meshes", node["mesh"])
        found = result[node["mesh"]]
        found.name = found.name or node.get("name", "")
        if "skin" in node:  # its joints place it, the node does not
            found.has_skin, matrix = True, IDENTITY
        found.matrices.append(matrix)
    return result


def _roots_shown(asset: Asset) -> list[int]:
    """Return the nodes of the scene that is shown."""
    if not asset.tree.get("scenes"):
        return []
    nodes: list[int] = asset.entry("scenes", asset.tree.get("scene", 0)).get("nodes", [])
    for node in nodes:
        asset.entry("nodes", node)
    return nodes


def _walk(nodes: list[Json], first: list[int]) -> Iterator[tuple[Json, Array]]:
    """Yield every node with its global transform, those under `first` before others."""
    parents = _parents(nodes)
    roots = [node for node in [*first, *range(len(nodes))] if parents[node] < 0]
    matrices: dict[int, Array] = {}
    stack = roots[::-1]
    while stack:
        number = stack.pop()
        if number in matrices:
            continue
        with np.errstate(all="ignore"):
            matrices[number] = _placed_in(
                matrices.get(parents[number], IDENTITY), _local_matrix(nodes[number])
            )
        yield nodes[number], matrices[number]
        stack.extend(reversed(nodes[number].get("children", [])))
    if len(matrices) < len(nodes):
        raise ValueError("its nodes are children of each other, in a circle")


def _placed_in(outer: Array, inner: Array) -> Array:
    return outer if inner is IDENTITY else outer @ inner


def _parents(nodes: list[Json]) -> list[int]:
    parents = [-1] * len(nodes)
    for number, node in enumerate(nodes):
        for child in node.get("children", []):
            if type(child) is not int or not 0 <= child < len(nodes):
                raise ValueError(f"node {number} has the child {child!r:.80}, of {len(nodes)}")
            if parents[child] >= 0:
                raise ValueError(f"node {child} is the child of two nodes")
            parents[child] = number
    return parents


def _local_matrix(node: Json) -> Array:
    if "matrix" in node:
        return _floats(node, "matrix", 16).reshape(4, 4).T
    if not node.keys() & {"translation", "rotation", "scale"}:
        return IDENTITY
    matrix = np.eye(4)
    if "rotation" in node:
        matrix[:3, :3] = _rotation(_floats(node, "rotation", 4))
    if "scale" in node:
        matrix[:3, :3] *= _floats(node, "scale", 3)
    if "translation" in node:
        matrix[:3, 3] = _floats(node, "translation", 3)
    return matrix


def _floats(node: Json, key: str, count: int) -> Array:
    values = node[key]
    if len(values) != count or not all(type(v) is int or isinstance(v, float) for v in values):
        raise ValueError(f"the {key} of a node is not of {count} numbers")
    return np.array(values, dtype=np.float64)


def _rotation(quaternion: Array) -> Array:
    x, y, z, w = quaternion / (np.linalg.norm(quaternion) or 1.0)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _contents(tree: Json, nodes: dict[int, _Nodes]) -> list[str]:
    matrices = [matrix for found in nodes.values() for matrix in found.matrices]
    primitives = list(_primitives(tree))
    attributes = {name for primitive in primitives for name in primitive["attributes"]}
    found = {
        "materials": "materials" in tree,
        "textures": "textures" in tree,
        "texture coordinates": any(name.startswith("TEXCOORD") for name in attributes),
        "colours": any(name.startswith("COLOR") for name in attributes),
        "normals": "NORMAL" in attributes,
        "skins": "skins" in tree,
        "animations": "animations" in tree,
        "morph targets": any("targets" in primitive for primitive in primitives),
        "cameras and lights": "cameras" in tree
        or "KHR_lights_punctual" in tree.get("extensions", {}),
        "placement": not all(np.array_equal(matrix, IDENTITY) for matrix in matrices),
        "names": any("name" in entry for entry in [*tree["meshes"], *tree.get("nodes", [])]),
        "points and lines": any(_mode(primitive) < _TRIANGLES for primitive in primitives),
    }
    return [name for name, is_there in found.items() if is_there]


def _uses(tree: Json) -> dict[int, set[_Use]]:
    """Return which attributes of which primitives each accessor is used for."""
    uses: dict[int, set[_Use]] = defaultdict(set)
    for m, mesh in enumerate(tree["meshes"]):
        for p, primitive in enumerate(mesh["primitives"]):
            for name, accessor in primitive["attributes"].items():
                uses[accessor].add((m, p, name))
            others = [a for target in primitive.get("targets", []) for a in target.values()]
            for accessor in [*others, primitive.get("indices")]:
                uses[accessor].add((m, p, ""))
    return uses


def _changes(
    mesh: _Mesh, entry: Json, after: Array, warnings: list[str]
) -> Iterator[tuple[int, _Change]]:
    """Yield the accessors of a moved mesh with what changes in them."""
    users = _users(mesh.number, entry)
    for accessor, rows in mesh.rows.items():
        yield accessor, _Change(users[accessor,], mesh.own[rows], after[rows])
    normals = _new_normals(mesh, after)
    for key, (before, values) in normals.items():
        yield key[1], _Change(users[key], before, values)
    tangents = {
        (*p.key, p.attributes["TANGENT"]): p.tangents
        for p in mesh.primitives
        if p.normals is not None and p.tangents is not None
    }
    for (position, normal, tangent), old in tangents.items():
        new = _following_tangents(old, *normals[position, normal], warnings)
        yield tangent, _Change(users[position, normal, tangent], old, new)


def _users(number: int, mesh: Json) -> dict[tuple[int, ...], set[_Use]]:
    """Return who uses accessors of positions, of normals with them, and of tangents with both."""
    users: dict[tuple[int, ...], set[_Use]] = defaultdict(set)
    for p, primitive in enumerate(mesh["primitives"]):
        key: tuple[int, ...] = ()
        for name in itertools.takewhile(primitive["attributes"].__contains__, _SHADING):
            key += (primitive["attributes"][name],)
            users[key].add((number, p, name))
    return users


def _new_normals(mesh: _Mesh, after: Array) -> dict[tuple[int, int], tuple[Array, Array]]:
    """Return normals before and after, by the accessors of positions and normals."""
    shaded = [p for p in mesh.primitives if p.normals is not None]
    blocks = {p.key: p.normals for p in shaded if p.normals is not None}
    if not blocks:
        return {}
    rows = _rows(blocks)
    faces = [p.faces + mesh.rows[p.key[0]].start for p in shaded]
    which = [p.faces + rows[p.key].start for p in shaded]
    before = np.concatenate(list(blocks.values()))
    values = following_normals(
        mesh.own, after, np.concatenate(faces), before, np.concatenate(which)
    )
    return {key: (before[r], values[r]) for key, r in rows.items()}


def _following_tangents(
    tangents: Array, before: Array, normals: Array, warnings: list[str]
) -> Array:
    """Turn tangents back into the planes of normals that have changed."""
    T = tangents[:, :3]
    new = T - np.einsum("ij,ij->i", T, normals)[:, None] * normals
    length = np.linalg.norm(new, axis=1)
    turned = (normals != before).any(axis=1)
    chosen = turned & (length > _PARALLEL * np.linalg.norm(T, axis=1))
    if (turned & ~chosen).any():
        warnings.append("some tangents are parallel to the new normals, and are kept")
    result = tangents.copy()
    result[chosen, :3] = new[chosen] / length[chosen, None]
    return result


def _merged(changes: Iterable[_Change]) -> list[_Change]:
    """Unite equal changes, leaving out what changes nothing."""
    merged: list[_Change] = []
    for change in changes:
        if np.array_equal(change.before, change.values):
            continue
        equal = (other for other in merged if np.array_equal(other.values, change.values))
        if (other := next(equal, None)) is None:
            merged.append(change)
        else:
            other.uses.update(change.uses)
    return merged


class _Overlaps:
    """Which accessors share bytes with others."""

    def __init__(self, asset: Asset) -> None:
        spans = []
        for number in range(len(asset.tree["accessors"])):
            with contextlib.suppress(LookupError, TypeError, ValueError):  # not one of ours
                if span := asset.span(number):
                    spans.append((number, *astuple(span), span.end))
        self._table = np.array(spans, dtype=np.int64).reshape(-1, 7)

    def is_free(self, accessor: int) -> bool:
        """Return whether an accessor can be written without a change to others."""
        number, buffer, start, stride, size, _, end = self._table.T
        own = number == accessor
        if not own.any():
            return False
        _, b, s, d, z, _, e = self._table[own][0]
        near = (buffer == b) & (start < e) & (end > s) & ~own
        # Interleaved, such as positions and normals by turns.
        gap = (start - s) % d
        apart = (stride == d) & (gap >= z) & (gap + size <= d)
        return not (near & ~apart).any()


def _apply(
    asset: Asset, accessor: int, changes: list[_Change], uses: set[_Use], overlaps: _Overlaps
) -> None:
    """Replace the elements of an accessor if nothing else uses it, or else give it successors."""
    entry = asset.entry("accessors", accessor)
    is_plain = entry["componentType"] == FLOAT and "sparse" not in entry
    if len(changes) == 1 and changes[0].uses == uses and is_plain and overlaps.is_free(accessor):
        asset.replace(accessor, changes[0].values)
        return
    for change in changes:
        is_position = any(name == "POSITION" for _, _, name in change.uses)
        successor = asset.append(accessor, change.values, with_bounds=is_position)
        for m, p, name in change.uses:
            asset.tree["meshes"][m]["primitives"][p]["attributes"][name] = successor


def _write_buffers(asset: Asset, target: Path) -> list[str]:
    """Write patched buffers that are files of their own; return the files that stay."""
    names = relative_names(asset.tree)
    taken = {(asset.path.parent / name).resolve() for name in names}
    for number in sorted(asset.patched):
        uri = asset.uri(number)
        if uri is None or uri.startswith("data:"):
            continue
        names.remove(unquote(uri))
        data = bytes(asset.buffers[number])
        name = _name_for(unquote(uri), data, target, taken)
        if name != unquote(uri):
            asset.rename(number, quote(name))
        (target.parent / name).parent.mkdir(parents=True, exist_ok=True)
        (target.parent / name).write_bytes(data)
    return names


def _name_for(name: str, data: bytes, target: Path, taken: set[Path]) -> str:
    """Return the name for a buffer: its own, unless that is another file's or leads elsewhere."""
    # The target may lie in a scratch folder in its own.
    folders = [folder.resolve() for folder in (target.parent, target.parent.parent)]
    own = (folders[0] / name).resolve()
    if own.is_relative_to(folders[0]) and not any(
        _is_another(folder / name, data) for folder in folders
    ):
        return name
    for ending in itertools.chain([".bin"], (f".{i}.bin" for i in itertools.count(1))):
        places = {folder / f"{target.name}{ending}" for folder in folders}
        if not places & taken:
            taken |= places
            return f"{target.name}{ending}"
    raise AssertionError


def _is_another(path: Path, data: bytes) -> bool:
    same_size = path.is_file() and path.stat().st_size == len(data)
    return path.exists() and not (same_size and path.read_bytes() == data)
