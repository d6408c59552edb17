"""3MF, a zip archive of XML models: only the digits of vertices are replaced."""

from __future__ import annotations

import io
import lzma
import re
import struct
import zipfile
import zlib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from graphlib import TopologicalSorter
from itertools import chain, islice
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from meshlab_spectral.documents.digits import digits_for
from meshlab_spectral.documents.document import (
    Array,
    Document,
    Indices,
    checked_part,
    unreadable,
    unsupported,
)
from meshlab_spectral.documents.placement import IDENTITY, Placement, placement_of, same_scale

# XML of vertices compresses to about a tenth; a far higher ratio indicates a zip bomb.
_LARGEST_RATIO, _HARMLESS = 200, 64 << 20
_VERTEX = re.compile(rb"<(?:[^\s<>/:!]+:)?vertex(?=\s)")
_ATTRIBUTE = re.compile(rb"""\s+([^\s=]+)\s*=\s*("[^"]*"|'[^']*')""")
_AXES = {b"x": 0, b"y": 1, b"z": 2}
_CONTENTS = {
    "basematerials": "materials",
    "colorgroup": "colours",
    "texture2d": "textures",
    "slicestack": "slices",
    "beamlattice": "beams",
}
_DAMAGES = (ValueError, LookupError, TypeError, ArithmeticError, EOFError, OSError, RuntimeError)
_OF_ARCHIVES = (zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error)
_Key = tuple[str, str]  # model, object
_Placed = tuple[_Key, Array]


def read(path: Path) -> Document:
    """Read a .3mf file; each object with a mesh is a part."""
    data = path.read_bytes()
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _document(path, data, archive)
    except KeyError as error:
        raise unreadable(path, f"not found: {error}") from error
    except (*_DAMAGES, *_OF_ARCHIVES, ElementTree.ParseError) as error:
        raise unreadable(path, f"{error!s:.300}") from error


@dataclass
class _Object:
    """An object of a model: a mesh, or components."""

    name: str
    is_part: bool
    own: Array  # vertices, without transforms
    offsets: list[int]  # their byte offsets in the model
    faces: Indices
    components: list[_Placed]
    placement: Placement = Placement(IDENTITY)


class _Model:
    """A model of an archive: its objects, and the items built from them."""

    def __init__(self, path: Path, name: str, data: bytes) -> None:
        if b"<!DOCTYPE" in data or b"\0" in data:  # UTF-16 has null bytes
            raise unsupported(path, f"has a document type or UTF-16 in {name}", "save it in UTF-8")
        root = ElementTree.fromstring(data)
        if not root.tag.endswith("model"):
            raise ValueError(f"{name} begins with {root.tag[-80:]}, not with a model")
        self.name, self.unit = name, root.get("unit", "millimeter")
        self.elements = {tag.rpartition("}")[2] for tag in {element.tag for element in root.iter()}}
        self._namespace = root.tag.removesuffix("model")
        self.items = [self._placed(item) for item in root.iter(f"{self._namespace}item")]
        places = [match.end() for match in _VERTEX.finditer(data)]
        self._places = iter(places)  # in the order of the elements
        elements = list(root.iter(f"{self._namespace}object"))
        self.objects = {element.attrib["id"]: self._object(element) for element in elements}
        if len(self.objects) < len(elements):
            raise ValueError(f"{name} has two objects with the same id")
        if len(places) != sum(len(entry.own) for entry in self.objects.values()):
            raise unsupported(path, f"has vertices outside meshes in {name}", "export it again")

    def _object(self, element: ElementTree.Element) -> _Object:
        ns, axes, corners = self._namespace, ("x", "y", "z"), ("v1", "v2", "v3")
        own = [[v.attrib[axis] for axis in axes] for v in element.iter(f"{ns}vertex")]
        faces = [[int(t.attrib[c]) for c in corners] for t in element.iter(f"{ns}triangle")]
        name = element.get("name") or element.get("partnumber")
        return _Object(
            name=name or f"object {element.attrib['id']}",
            is_part=bool(faces) and element.get("type", "model") == "model",
            own=np.array(own, dtype=np.float64).reshape(-1, 3),
            offsets=list(islice(self._places, len(own))),
            faces=np.array(faces, dtype=np.int64).reshape(-1, 3),
            components=[self._placed(c) for c in element.iter(f"{ns}component")],
        )

    def _placed(self, element: ElementTree.Element) -> _Placed:
        """Return the object that an element refers to, with its transform."""
        paths = [value for key, value in element.items() if key.endswith("}path")]
        model = paths[0].lstrip("/") if paths else self.name  # of the production extension
        matrix = np.eye(4)  # for column vectors; in the file it is for row vectors
        if transform := element.get("transform"):
            matrix[:3] = np.array(transform.split(), dtype=np.float64).reshape(4, 3).T
        return (model, element.attrib["objectid"]), matrix


@dataclass(kw_only=True)
class _ThreeMfDocument(Document):
    data: bytes
    meshes: list[tuple[str, _Object]]  # the model's name and the object of each part

    def add(self, model: str, mesh: _Object, matrices: list[Array]) -> None:
        """Add an object to the parts."""
        mesh.placement = placement_of(mesh.name, matrices, self.warnings)
        placed = mesh.placement.placed(mesh.own)
        faces = mesh.placement.oriented(mesh.faces)
        self.parts.append(checked_part(self.path, placed, faces, mesh.name))
        self.meshes.append((model, mesh))

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        changes: dict[str, list[tuple[_Object, Array]]] = defaultdict(list)
        for (model, mesh), part, vertices in zip(self.meshes, self.parts, moved, strict=True):
            if not np.array_equal(vertices, part.vertices):
                after = mesh.placement.back(mesh.own, part.vertices, vertices)
                changes[model].append((mesh, after))
        if not changes:
            target.write_bytes(self.data)
            return []
        with zipfile.ZipFile(io.BytesIO(self.data)) as source, zipfile.ZipFile(target, "w") as copy:
            copy.comment = source.comment
            for info in source.infolist():
                content = _patched(source.read(info), changes.get(info.filename, []))
                copy.writestr(info, content)
        return ["its slices stay as they are"] * ("slices" in self.contents)


def _patched(data: bytes, changes: list[tuple[_Object, Array]]) -> bytes:
    """Return a model with the changed coordinates replaced."""
    pieces: list[bytes] = []
    position = 0
    for mesh, after in changes:  # in the order of the file
        digits = digits_for(mesh.own, after)
        for row in np.flatnonzero((after != mesh.own).any(axis=1)).tolist():
            old, new = mesh.own[row], after[row]
            for axis, start, end in _values(data, mesh.offsets[row]):
                if old[axis] != new[axis]:
                    pieces += (data[position:start], b"%.*g" % (digits, new[axis]))
                    position = end
    return b"".join([*pieces, data[position:]])


def _values(data: bytes, offset: int) -> Iterator[tuple[int, int, int]]:
    """Yield axis, begin and end of the three values of the vertex at an offset."""
    found = (match for match in _ATTRIBUTE.finditer(data, offset) if match[1] in _AXES)
    for match in islice(found, 3):
        yield _AXES[match[1]], match.start(2) + 1, match.end(2) - 1


def _document(path: Path, data: bytes, archive: zipfile.ZipFile) -> Document:
    entries = archive.infolist()
    if any(e.flag_bits & 1 for e in entries) or b"/keystore" in archive.read("_rels/.rels"):
        raise unsupported(path, "is encrypted", "save it without encryption")
    if sum(info.file_size for info in entries) > max(_HARMLESS, _LARGEST_RATIO * len(data)):
        raise ValueError(
            f"its {len(data)} bytes would grow more than {_LARGEST_RATIO} times when unpacked"
        )
    if damaged := archive.testzip():
        raise ValueError(f"{damaged} in it is damaged")
    relationships = ElementTree.fromstring(archive.read("_rels/.rels"))
    targets = {r.attrib["Type"].rpartition("/")[2]: r.attrib["Target"] for r in relationships}
    root = targets["3dmodel"].lstrip("/")
    models = _models(path, archive, root)
    objects = {(m, o): found for m, model in models.items() for o, found in model.objects.items()}
    contents = _contents(models, models[root].unit, archive.namelist())
    document = _ThreeMfDocument(path, [], contents, data=data, meshes=[])
    for key, matrices in _matrices(objects, models[root].items).items():
        if objects[key].is_part:
            document.add(key[0], objects[key], matrices)
    if not document.parts:
        raise unsupported(path, "holds no triangles", "give a file with a triangle mesh")
    return document


def _models(path: Path, archive: zipfile.ZipFile, root: str) -> dict[str, _Model]:
    """Read the root model and all models that it refers to."""
    models: dict[str, _Model] = {}
    wanted = [root]
    while wanted:
        name = wanted.pop()
        if name not in models:
            model = models[name] = _Model(path, name, archive.read(name))
            placed = [c for entry in model.objects.values() for c in entry.components]
            wanted += [key[0] for key, _ in [*placed, *model.items]]
    return models


def _matrices(objects: dict[_Key, _Object], items: list[_Placed]) -> dict[_Key, list[Array]]:
    """Return each object's first transform and, if any, the first one of another scale."""
    graph = {key: [child for child, _ in found.components] for key, found in objects.items()}
    for key in [*(key for key, _ in items), *chain(*graph.values())]:
        if key not in objects:
            raise ValueError(f"{key[0]} has no object {key[1]}")
    matrices: dict[_Key, list[Array]] = {key: [] for key in objects}
    _place(matrices, items, IDENTITY)
    for key in reversed([*TopologicalSorter(graph).static_order()]):  # parents before components
        for matrix in matrices[key]:
            _place(matrices, objects[key].components, matrix)
    return matrices


def _place(matrices: dict[_Key, list[Array]], placed: list[_Placed], outer: Array) -> None:
    for key, inner in placed:
        with np.errstate(all="ignore"):
            matrix = outer @ inner
        found = matrices[key]
        if not found or (len(found) == 1 and not same_scale(found[0], matrix)):
            found.append(matrix)


def _contents(models: dict[str, _Model], unit: str, names: list[str]) -> list[str]:
    elements = {element for model in models.values() for element in model.elements}
    contents = [f"units ({unit})", *(_CONTENTS[one] for one in _CONTENTS if one in elements)]
    if any(not name.endswith(("/", ".rels", ".model", "[Content_Types].xml")) for name in names):
        contents.append("thumbnails and settings")
    return contents
