"""3MF: a zip archive of models in XML."""

from __future__ import annotations

import contextlib
import copy
import graphlib
import io
import lzma
import re
import struct
import zipfile
import zlib
from array import array
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.digits import digits_for
from meshlab_spectral.documents.document import (
    Array,
    Document,
    Part,
    check_indices,
    check_vertices,
    unreadable,
    unsupported,
)
from meshlab_spectral.documents.placement import IDENTITY, Placement, placement_of, same_scale
from meshlab_spectral.errors import MeshFileError

# XML of vertices compresses to a tenth; what grows far more is made to fill the memory.
_LARGEST_RATIO, _HARMLESS = 200, 64 << 20
_ATTRIBUTE = re.compile(rb"""\s+([^\s=]+)\s*=\s*("[^"]*"|'[^']*')""")
_AXES = {b"x": 0, b"y": 1, b"z": 2}
_FAULTS = (
    ArithmeticError,
    EOFError,
    LookupError,
    OSError,  # of the decompression: the file itself has been read
    RuntimeError,
    TypeError,
    ValueError,
    lzma.LZMAError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)
_Key = tuple[str, str]  # model, object
_Placed = tuple[_Key, Array]


@dataclass
class _Object:
    """An object of a model: a mesh, or components."""

    name: str
    is_model: bool
    coordinates: array[float] = field(default_factory=lambda: array("d"))
    offsets: array[int] = field(default_factory=lambda: array("q"))  # bytes, of its vertices
    corners: array[int] = field(default_factory=lambda: array("q"))
    components: list[_Placed] = field(default_factory=list)


@dataclass(frozen=True)
class _Mesh:
    """What one part was read from."""

    model: str
    offsets: NDArray[np.int64]  # where the elements of its vertices begin
    own: Array  # vertices, without transforms
    placement: Placement


@dataclass
class ThreeMfDocument(Document):
    """A 3MF archive: digits in its models are replaced, and all else stays."""

    _data: bytes = field(kw_only=True, repr=False)
    _models: dict[str, bytes] = field(default_factory=dict, kw_only=True, repr=False)
    _meshes: list[_Mesh] = field(default_factory=list, kw_only=True, repr=False)

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        """Write the archive with other vertices; see Document."""
        changes: dict[str, list[tuple[_Mesh, Array]]] = defaultdict(list)
        for mesh, part, vertices in zip(self._meshes, self.parts, moved, strict=True):
            if not np.array_equal(vertices, part.vertices):
                after = mesh.placement.back(mesh.own, part.vertices, vertices)
                changes[mesh.model].append((mesh, after))
        if not changes:
            target.write_bytes(self._data)
            return []
        self._write(
            target, {name: _patched(self._models[name], meshes) for name, meshes in changes.items()}
        )
        return ["its slices stay as they are"] if "slices" in self.contents else []

    def _write(self, target: Path, patched: dict[str, bytes]) -> None:
        with (
            zipfile.ZipFile(io.BytesIO(self._data)) as source,
            zipfile.ZipFile(target, "w") as result,
        ):
            result.comment = source.comment
            for info in source.infolist():
                with _reporting_faults(self.path):
                    content = patched.get(info.filename) or source.read(info)
                result.writestr(copy.copy(info), content)


def read(path: Path) -> ThreeMfDocument:
    """Read a .3mf file; each object with a mesh is a part.

    Raises
    ------
    MeshFileError
        When it is damaged, encrypted, or without triangles.
    """
    data = path.read_bytes()
    with _reporting_faults(path), zipfile.ZipFile(io.BytesIO(data)) as archive:
        _check(path, archive, len(data))
        root = _root(path, archive)
        models = _read_models(path, archive, root)
        document = ThreeMfDocument(path, [], _data=data)
        document._models = {name: model.data for name, model in models.items()}
        objects = {
            (name, number): entry
            for name, model in models.items()
            for number, entry in model.objects.items()
        }
        matrices = _placements(objects, models[root].items)
        for key, entry in objects.items():
            _add_part(document, key, entry, matrices.get(key, []))
        if not document.parts:
            raise unsupported(path, "holds no triangles", "give a file with a triangle mesh")
        document.contents = _contents(models, models[root].unit, archive.namelist(), matrices)
        return document


@contextlib.contextmanager
def _reporting_faults(path: Path) -> Iterator[None]:
    """Turn what Python raises for a malformed archive into MeshFileError."""
    try:
        yield
    except _FAULTS as error:
        raise unreadable(path, f"{error!s:.300}") from error


def _check(path: Path, archive: zipfile.ZipFile, size: int) -> None:
    """Refuse archives that are encrypted, or made to do harm."""
    entries = archive.infolist()
    if len({info.filename for info in entries}) < len(entries):
        raise ValueError("two entries have one name")
    for info in entries:
        if ".." in re.split(r"[/\\]", info.filename):
            raise ValueError(f"an entry is named {info.filename[:80]}")
        if info.flag_bits & 1:
            raise _encrypted(path)
    compressed = [info.compress_size for info in entries]
    full = [info.file_size for info in entries]
    if sum(compressed) > size:
        raise ValueError("its entries overlap")
    for small, large in zip([*compressed, size], [*full, sum(full)], strict=True):
        if large > max(_HARMLESS, _LARGEST_RATIO * small):
            raise ValueError(f"{small} bytes would grow to {large}")


def _encrypted(path: Path) -> MeshFileError:
    return unsupported(path, "is encrypted", "save it without encryption")


def _root(path: Path, archive: zipfile.ZipFile) -> str:
    """Return the name of the model that is built."""
    targets: dict[str, str] = {}

    def start(name: str, attributes: dict[str, str]) -> None:
        if name.endswith(" Relationship"):
            kind = attributes["Type"].rpartition("/")[2]
            targets.setdefault(kind, attributes["Target"])

    _parse("_rels/.rels", archive.read("_rels/.rels"), lambda parser: start)
    if "keystore" in targets:
        raise _encrypted(path)
    if "3dmodel" not in targets:
        raise ValueError("_rels/.rels names no 3D model")
    return targets["3dmodel"].lstrip("/")


_Start = Callable[[str, dict[str, str]], None]


def _parse(name: str, data: bytes, starting: Callable[[expat.XMLParserType], _Start]) -> None:
    """Parse an entry, and tell the place of an error."""
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = starting(parser)
    parser.StartDoctypeDeclHandler = _refuse_doctype
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise ValueError(f"{name}: {error}") from error
    except KeyError as error:
        raise ValueError(f"{name}, line {parser.CurrentLineNumber}: {error} is missing") from error
    except (ArithmeticError, ValueError) as error:
        raise ValueError(f"{name}, line {parser.CurrentLineNumber}: {error}") from error


def _refuse_doctype(*_: object) -> None:
    raise ValueError("a document type declaration, which 3MF forbids")


class _Model:
    """A model as it is read: objects, and what is built of them."""

    def __init__(self, path: Path, name: str, data: bytes) -> None:
        if b"\0" in data[:4] or data[:2] in (b"\xff\xfe", b"\xfe\xff"):
            raise unsupported(path, f"has {name} in UTF-16", "save it in UTF-8")
        self.data = data
        self.objects: dict[str, _Object] = {}
        self.items: list[_Placed] = []
        self.unit = "millimeter"
        self.elements: set[str] = set()
        self.textures: set[str] = set()
        self._name = name
        self._current: _Object | None = None
        self._handlers: dict[str, Callable[[dict[str, str]], None]] = {}
        _parse(name, data, self._starting)

    def _starting(self, parser: expat.XMLParserType) -> _Start:
        self._parser = parser
        return self._start

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        handler = self._handlers.get(name)
        if handler is not None:
            handler(attributes)
        elif not self._handlers:
            self._model(name, attributes)
        else:
            self._other(name.rpartition(" ")[2], attributes)

    def _model(self, name: str, attributes: dict[str, str]) -> None:
        namespace, separator, local = name.rpartition(" ")
        if local != "model":
            raise ValueError(f"<{local[:80]}> instead of <model>")
        self.unit = attributes.get("unit", self.unit)
        handlers = {
            "vertex": self._vertex,
            "triangle": self._triangle,
            "object": self._object,
            "component": self._component,
            "item": self._item,
        }
        self._handlers = {
            f"{namespace}{separator}{local}": handler for local, handler in handlers.items()
        }

    def _object(self, attributes: dict[str, str]) -> None:
        number = attributes["id"]
        if number in self.objects:
            raise ValueError(f"a second object {number[:80]}")
        if "name" in attributes:
            self.elements.add("name")
        name = attributes.get("name") or attributes.get("partnumber") or f"object {number}"
        self._current = _Object(name, attributes.get("type", "model") == "model")
        self.objects[number] = self._current

    def _vertex(self, attributes: dict[str, str]) -> None:
        current = self._of_object()
        current.coordinates.extend(
            (float(attributes["x"]), float(attributes["y"]), float(attributes["z"]))
        )
        current.offsets.append(self._parser.CurrentByteIndex)

    def _triangle(self, attributes: dict[str, str]) -> None:
        self._of_object().corners.extend(
            (int(attributes["v1"]), int(attributes["v2"]), int(attributes["v3"]))
        )

    def _component(self, attributes: dict[str, str]) -> None:
        self._of_object().components.append(self._placed(attributes))

    def _item(self, attributes: dict[str, str]) -> None:
        self.items.append(self._placed(attributes))

    def _of_object(self) -> _Object:
        if self._current is None:
            raise ValueError("an element of a mesh outside an object")
        return self._current

    def _placed(self, attributes: dict[str, str]) -> _Placed:
        """Return the object that an element refers to, with its transform."""
        # Of the production extension.
        paths = [value for key, value in attributes.items() if key.endswith(" path")]
        model = paths[0].lstrip("/") if paths else self._name
        return (model, attributes["objectid"]), _matrix(attributes.get("transform"))

    def _other(self, element: str, attributes: dict[str, str]) -> None:
        self.elements.add(element)
        if element == "texture2d":
            self.textures.add(attributes.get("path", "").lstrip("/"))


def _matrix(transform: str | None) -> Array:
    """Return a transform as 4 x 4 for column vectors; in the file it is for row vectors."""
    if transform is None:
        return IDENTITY
    numbers = np.array(transform.split(), dtype=np.float64)
    if numbers.shape != (12,):
        raise ValueError(f"a transform of {numbers.size} numbers instead of 12")
    matrix = np.eye(4)
    matrix[:3] = numbers.reshape(4, 3).T
    return matrix


def _read_models(path: Path, archive: zipfile.ZipFile, root: str) -> dict[str, _Model]:
    """Read a model, and those that it refers to."""
    models: dict[str, _Model] = {}
    wanted = [root]
    while wanted:
        name = wanted.pop()
        if name in models:
            continue
        model = models[name] = _Model(path, name, archive.read(name))
        components = (c for entry in model.objects.values() for c in entry.components)
        wanted.extend({key[0] for key, _ in [*components, *model.items]} - models.keys())
    return models


def _placements(objects: dict[_Key, _Object], items: list[_Placed]) -> dict[_Key, list[Array]]:
    """Return each object's first transform, and if there is one the first of another scale."""
    graph = {key: [c for c, _ in entry.components] for key, entry in objects.items()}
    for key in (*(key for key, _ in items), *(c for cs in graph.values() for c in cs)):
        if key not in objects:
            raise ValueError(f"{key[0]} has no object {key[1]}")
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        raise ValueError("objects are components of each other, in a circle") from error
    result: dict[_Key, list[Array]] = {}
    stack = items[::-1]
    while stack:
        key, matrix = stack.pop()
        found = result.setdefault(key, [])
        if len(found) == 2 or (found and same_scale(found[0], matrix)):
            continue
        found.append(matrix)
        with np.errstate(all="ignore"):
            stack.extend((c, matrix @ inner) for c, inner in reversed(objects[key].components))
    return result


def _add_part(document: ThreeMfDocument, key: _Key, entry: _Object, matrices: list[Array]) -> None:
    """Add an object to the parts if it is a mesh with triangles."""
    if not (entry.is_model and entry.corners):
        return
    own = np.array(entry.coordinates, dtype=np.float64).reshape(-1, 3)
    faces = np.array(entry.corners, dtype=np.int64).reshape(-1, 3)
    placement = placement_of(entry.name, matrices, document.warnings)
    placed = placement.placed(own)
    check_vertices(document.path, placed)
    check_indices(document.path, faces, len(own))
    document.parts.append(Part(entry.name, placed, placement.oriented(faces)))
    offsets = np.array(entry.offsets, dtype=np.int64)
    document._meshes.append(_Mesh(key[0], offsets, own, placement))


def _contents(
    models: dict[str, _Model], unit: str, names: list[str], matrices: dict[_Key, list[Array]]
) -> list[str]:
    elements = {element for model in models.values() for element in model.elements}
    known = {texture for model in models.values() for texture in model.textures} | models.keys()
    transforms = [matrix for found in matrices.values() for matrix in found]
    found = {
        f"units ({unit})": True,
        "placement": not all(np.array_equal(matrix, IDENTITY) for matrix in transforms),
        "materials and colours": bool(elements & {"basematerials", "colorgroup"}),
        "textures": bool(elements & {"texture2d", "texture2dgroup"}),
        "names": "name" in elements,
        "slices": "slicestack" in elements,
        "beams": "beamlattice" in elements,
        "thumbnails and settings": any(
            name not in known and not name.endswith(("/", ".rels", "[Content_Types].xml"))
            for name in names
        ),
    }
    return [name for name, is_there in found.items() if is_there]


def _patched(data: bytes, changes: Iterable[tuple[_Mesh, Array]]) -> bytes:
    """Return a model with other coordinates where they have changed."""
    pieces: list[bytes] = []
    position = 0
    # In the order of the file, in which they were read.
    for mesh, after in changes:
        digits = digits_for(mesh.own, after)
        rows = np.flatnonzero((after != mesh.own).any(axis=1))
        arrays = (array[rows].tolist() for array in (mesh.offsets, mesh.own, after))
        for offset, old, new in zip(*arrays, strict=True):
            for axis, start, end in _values(data, offset):
                if old[axis] != new[axis]:
                    pieces += (data[position:start], b"%.*g" % (digits, new[axis]))
                    position = end
    return b"".join([*pieces, data[position:]])


def _values(data: bytes, offset: int) -> Iterator[tuple[int, int, int]]:
    """Yield axis, begin and end of the three values of the vertex element at an offset."""
    left = 3
    for match in _ATTRIBUTE.finditer(data, offset):
        axis = _AXES.get(match[1])
        if axis is not None:
            yield axis, match.start(2) + 1, match.end(2) - 1
            left -= 1
            if not left:
                return
