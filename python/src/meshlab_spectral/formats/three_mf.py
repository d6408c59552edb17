"""3MF, a zip archive of XML models: only the digits of vertices are replaced."""

from __future__ import annotations

import html
import io
import lzma
import struct
import zipfile
import zlib
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from graphlib import TopologicalSorter
from itertools import chain
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np

from meshlab_spectral._core import xml_elements
from meshlab_spectral.formats.budget import Budget
from meshlab_spectral.formats.causes import unreadable, unsupported
from meshlab_spectral.formats.digits import digits_for
from meshlab_spectral.formats.document import Array, Document, Indices, checked_part
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.placement import IDENTITY, Placement, placement_of
from meshlab_spectral.formats.text import Change, as_integers, write_patched
from meshlab_spectral.warned import Warned

_DECRYPT = "save it without encryption"
# What a package of the Open Packaging Conventions may have; zipfile unpacks others in one piece.
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_TAG_BYTES = 250  # of what ElementTree makes of a tag, at least
_ROW_BYTES = 48  # of a vertex or triangle: three numbers, and their places
_MOST_PLACEMENTS = 1000  # of an object: those of nested components multiply
_TAKEN = [("vertex", ("x", "y", "z")), ("triangle", ("v1", "v2", "v3"))]
_LEVEL = 1  # of zlib: takes a third of the default's time, for files a quarter larger
_UNITS = {
    "micron": "µm",
    "millimeter": "mm",
    "centimeter": "cm",
    "inch": "in",
    "foot": "ft",
    "meter": "m",
}
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
    except (*_DAMAGES, *_OF_ARCHIVES, ElementTree.ParseError, expat.ExpatError) as error:
        raise unreadable(path, f"{error!s:.300}") from error


@dataclass
class _Object:
    """An object of a model: a mesh, or components."""

    name: str
    is_part: bool
    own: Array  # vertices, without transforms
    places: Indices  # the byte offsets of their numbers in the model, n x 3
    faces: Indices
    components: list[_Placed]
    placement: Placement = Placement(IDENTITY)


@dataclass(eq=False)
class _Elements:
    """The elements of one name in a model, of which there may be millions; read in C++."""

    text: bytes
    attributes: tuple[str, str, str]
    values: Array  # n x 3
    places: Indices  # their byte offsets
    passed: int = 0  # rows of the objects before

    def among(self, elements: Iterable[ElementTree.Element]) -> tuple[Array, Indices]:
        """Return values and places of those that elements of the rest of the model stand for.

        Raises ValueError if elements of the file itself have the attributes `begin` and `end`.
        """
        spans = [slice(int(one.attrib["begin"]), int(one.attrib["end"])) for one in elements]
        for span in spans:
            if not self.passed == span.start <= span.stop <= len(self.values):
                raise ValueError(f"an element claims rows {span.start} to {span.stop}")
            self.passed = span.stop
        values, places = _joined(self.values, spans), _joined(self.places, spans)
        for row, column in np.argwhere(np.isnan(values)).tolist():  # blanks or &#49; in it
            start = int(places[row, column])
            if start < 0:
                raise KeyError(self.attributes[column])
            end = self.text.index(self.text[start - 1 : start], start)
            values[row, column] = float(html.unescape(self.text[start:end].decode()))
        return values, places


def _joined(rows: Any, spans: list[slice]) -> Any:
    return rows[spans[0]] if len(spans) == 1 else np.vstack([rows[:0], *(rows[s] for s in spans)])


class _Model:
    """A model of the archive: its objects, and the items built from them."""

    def __init__(self, path: Path, name: str, data: bytes, budget: Budget) -> None:
        called = shown(name)
        if b"<!DOCTYPE" in data or b"\0" in data:  # UTF-16 has null bytes
            what = f"has a document type or UTF-16 in {called}"
            raise unsupported(path, what, "save it in UTF-8")
        budget.take(_ROW_BYTES * data.count(b"<"), f"vertices and triangles of {called}")
        found, rest = xml_elements(data, _TAKEN)
        budget.take(_TAG_BYTES * rest.count(b"<"), f"elements of {called}")
        vertices, triangles = (
            _Elements(data, attributes, *one)
            for (_, attributes), one in zip(_TAKEN, found, strict=True)
        )
        try:
            root = ElementTree.fromstring(rest)
        except ElementTree.ParseError:
            expat.ParserCreate().Parse(data, True)  # for its line
            raise
        if not root.tag.endswith("model"):
            raise ValueError(f"{called} begins with {shown(root.tag[-80:])}, not with a model")
        self.name, self.unit = name, root.get("unit", "millimeter")
        self.elements = {tag.rpartition("}")[2] for tag in {element.tag for element in root.iter()}}
        self._namespace = ns = root.tag.removesuffix("model")
        self.items = [self._placed(item) for item in root.iter(f"{ns}item")]
        elements = root.findall(f"{ns}resources/{ns}object")
        if len(elements) < len(list(root.iter(f"{ns}object"))):
            raise ValueError(f"{called} has an object within another, or outside its resources")
        inside = sum(len(list(element.iter(f"{ns}vertex"))) for element in elements)
        if inside < len(list(root.iter(f"{ns}vertex"))):
            raise unsupported(path, f"has vertices outside meshes in {called}", "export it again")
        self.objects = {
            element.attrib["id"]: self._object(element, vertices, triangles) for element in elements
        }
        if len(self.objects) < len(elements):
            raise ValueError(f"{called} has two objects with the same id")

    def _object(
        self, element: ElementTree.Element, vertices: _Elements, triangles: _Elements
    ) -> _Object:
        ns = self._namespace
        own, places = vertices.among(element.iter(f"{ns}vertex"))
        faces = as_integers(triangles.among(element.iter(f"{ns}triangle"))[0])
        name = element.get("name") or element.get("partnumber")
        return _Object(
            name=shown(name or f"object {element.attrib['id']}"),
            is_part=len(faces) > 0 and element.get("type", "model") == "model",
            own=own,
            places=places,
            faces=faces,
            components=[self._placed(c) for c in element.iter(f"{ns}component")],
        )

    def _placed(self, element: ElementTree.Element) -> _Placed:
        """Return the object that an element refers to, with its transform."""
        paths = [value for key, value in element.items() if key.endswith("}path")]
        model = paths[0].lstrip("/") if paths else self.name  # of the production extension
        matrix = np.eye(4)  # for column vectors; in the file it is for row vectors
        if transform := element.get("transform"):
            numbers = transform.split()
            if len(numbers) != 12:
                raise ValueError(f"a transform has {len(numbers)} numbers, not 12")
            matrix[:3] = np.array([*map(float, numbers)]).reshape(4, 3).T
        return (model, element.attrib["objectid"]), matrix


@dataclass(kw_only=True)
class _ThreeMfDocument(Document):
    data: bytes
    meshes: list[tuple[str, _Object]]  # the model's name and the object of each part

    def add(self, model: str, mesh: _Object, matrices: Array) -> None:
        """Add an object to the parts."""
        mesh.placement = placement_of(mesh.name, matrices, self.warnings)
        if len(matrices) == _MOST_PLACEMENTS:
            text = f"is placed {_MOST_PLACEMENTS} times or more: other formats get only that many"
            self.warnings.append(Warned("placement", f"{mesh.name} {text}"))
        placed = mesh.placement.placed(mesh.own)
        faces = mesh.placement.oriented(mesh.faces)
        part = checked_part(self.path, placed, faces, mesh.name)
        self.parts.append(replace(part, copies=mesh.placement.copies))
        self.meshes.append((model, mesh))

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        changes: dict[str, list[tuple[_Object, Array]]] = defaultdict(list)
        for (model, mesh), part, vertices in zip(self.meshes, self.parts, moved, strict=True):
            if not np.array_equal(vertices, part.vertices):
                after = mesh.placement.back(mesh.own, part.vertices, vertices)
                changes[model].append((mesh, after))
        budget = Budget(self.path, len(self.data))
        with zipfile.ZipFile(io.BytesIO(self.data)) as source, zipfile.ZipFile(target, "w") as copy:
            copy.comment = source.comment
            for info in source.infolist():
                columns = _columns(changes.get(info.filename, []))
                content = _unpacked(source, info, budget)
                # Public is only writestr's argument, for an entry that is whole in memory.
                info._compresslevel = _LEVEL  # type: ignore[attr-defined]
                with copy.open(info, "w") as entry:
                    write_patched(entry, content, columns)
        return [Warned("kept_in_file", "its slices stay as they are")] * ("slices" in self.contents)


def _unpacked(archive: zipfile.ZipFile, info: zipfile.ZipInfo, budget: Budget) -> bytes:
    """Return what an entry of an archive holds."""
    with archive.open(info) as entry:
        return budget.unpacked(entry, f"its entry {shown(info.filename)}")


def _columns(changes: list[tuple[_Object, Array]]) -> list[Change]:
    """Return the changes of a model; x, y and z may be in any order in the text."""
    return [
        (mesh.places[:, k], 0, mesh.own[:, [k]], after[:, [k]], digits_for(mesh.own, after))
        for mesh, after in changes
        for k in range(3)
    ]


def _document(path: Path, data: bytes, archive: zipfile.ZipFile) -> Document:
    budget, entries = Budget(path, len(data)), archive.infolist()
    if any(info.flag_bits & 1 for info in entries):
        raise unsupported(path, "is encrypted", _DECRYPT)
    if strange := [info for info in entries if info.compress_type not in _PACKED]:
        what = f"has {shown(strange[0].filename)} in a compression that 3MF does not allow"
        raise unsupported(path, what, "zip it again, with Deflate")
    unpacked = {info.filename: _unpacked(archive, info, budget) for info in entries}  # checks all
    if b"/keystore" in unpacked["_rels/.rels"]:
        raise unsupported(path, "is encrypted", _DECRYPT)
    relationships = ElementTree.fromstring(unpacked["_rels/.rels"])
    targets = {r.attrib["Type"].rpartition("/")[2]: r.attrib["Target"] for r in relationships}
    root = targets["3dmodel"].lstrip("/")
    models = _models(path, unpacked, root, budget)
    if len([info for info in entries if info.filename in models]) > len(models):
        raise ValueError("two models in it have the same name")
    objects = {(m, o): found for m, model in models.items() for o, found in model.objects.items()}
    contents = _contents(models, shown(models[root].unit), list(unpacked))
    document = _ThreeMfDocument(path, [], contents, data=data, meshes=[])
    for key, matrices in _matrices(objects, models[root].items, budget).items():
        if objects[key].is_part:
            document.add(key[0], objects[key], matrices)
    unit = _UNITS.get(models[root].unit, "")
    document.parts = [replace(part, unit=unit) for part in document.parts]
    if not document.parts:
        raise unsupported(path, "holds no triangles", "give a file with a triangle mesh")
    return document


def _models(path: Path, unpacked: dict[str, bytes], root: str, budget: Budget) -> dict[str, _Model]:
    """Read the root model and all models that it refers to."""
    models: dict[str, _Model] = {}
    wanted = [root]
    while wanted:
        name = wanted.pop()
        if name not in models:
            model = models[name] = _Model(path, name, unpacked[name], budget)
            placed = [c for entry in model.objects.values() for c in entry.components]
            wanted += [key[0] for key, _ in [*placed, *model.items]]
    return models


def _matrices(
    objects: dict[_Key, _Object], items: list[_Placed], budget: Budget
) -> dict[_Key, Array]:
    """Return the transforms of each object, k x 4 x 4, at most _MOST_PLACEMENTS."""
    graph = {key: [child for child, _ in found.components] for key, found in objects.items()}
    for key in [*(key for key, _ in items), *chain(*graph.values())]:
        if key not in objects:
            raise ValueError(f"{shown(key[0])} has no object {shown(key[1])}")
    found: dict[_Key, list[Array]] = {key: [np.zeros((0, 4, 4))] for key in objects}
    matrices: dict[_Key, Array] = {}

    def add_items(placed: list[_Placed], outer: Array) -> None:
        for key, inner in placed:
            room = _MOST_PLACEMENTS - sum(map(len, found[key]))
            if room > 0 and len(outer):
                budget.take(128 * min(room, len(outer)), "places of its objects")
                with np.errstate(all="ignore"):
                    found[key].append(outer[:room] @ inner)

    add_items(items, IDENTITY[None])
    for key in reversed([*TopologicalSorter(graph).static_order()]):  # parents before components
        matrices[key] = np.concatenate(found.pop(key))
        add_items(objects[key].components, matrices[key])
    return {key: matrices[key] for key in objects}


def _contents(models: dict[str, _Model], unit: str, names: list[str]) -> list[str]:
    elements = {element for model in models.values() for element in model.elements}
    contents = [f"units ({unit})", *(_CONTENTS[one] for one in _CONTENTS if one in elements)]
    if any(not name.endswith(("/", ".rels", ".model", "[Content_Types].xml")) for name in names):
        contents.append("thumbnails and settings")
    return contents
