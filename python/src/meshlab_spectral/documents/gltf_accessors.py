"""The containers of glTF 2.0: JSON, GLB chunks, buffers, and accessors into them."""

from __future__ import annotations

import base64
import contextlib
import json
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.document import Array, unreadable, unsupported
from meshlab_spectral.errors import MeshFileError

FLOAT = 5126
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", FLOAT: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_MAGIC, _JSON, _BIN = b"glTF", 0x4E4F534A, 0x004E4942
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")
# Accessors may be shared, but a file cannot stand for more than so many elements for each byte.
_SHARED, _ALWAYS = 8, 1_000_000
# What Python raises for JSON of other keys and types than the format's.
_FAULTS = (ArithmeticError, LookupError, ValueError, struct.error)

Json = dict[str, Any]
Bytes = bytes | bytearray | memoryview


@contextlib.contextmanager
def reporting_faults(path: Path) -> Iterator[None]:
    """Turn what Python raises for a malformed asset into MeshFileError."""
    try:
        yield
    except KeyError as error:
        raise unreadable(path, f"{error} is missing in its JSON") from error
    except RecursionError as error:
        raise unreadable(path, "its JSON is nested too deeply") from error
    except (AttributeError, TypeError) as error:
        raise unreadable(path, f"its JSON has a value of a wrong type: {error}") from error
    except _FAULTS as error:
        raise unreadable(path, error) from error


class _Number(float):
    """A number that is written as it was read."""

    __slots__ = ("token",)
    token: str

    def __new__(cls, token: str) -> _Number:
        number = super().__new__(cls, token)
        number.token = token
        return number


@dataclass(frozen=True)
class Span:
    """The bytes of an accessor's elements in a buffer."""

    buffer: int
    start: int
    stride: int
    size: int  # of an element
    count: int

    @property
    def end(self) -> int:
        """Return the position after the last element."""
        return self.start + self.stride * (self.count - 1) + self.size


@dataclass
class Asset:
    """A glTF asset that can be patched.

    Attributes
    ----------
    path
        Its file.
    tree
        Its JSON.
    chunks
        The type and bytes of each chunk of a GLB; of a .gltf file its JSON.
    is_glb
        Whether the file is a GLB.
    rest
        What follows the asset in its file.
    size
        The size of what has been read, in bytes.
    buffers
        The buffers that have been read so far.
    patched
        The numbers of the buffers that have been changed.
    is_edited
        Whether `tree` has been changed.
    """

    path: Path
    tree: Json
    chunks: list[tuple[int, Bytes]]
    is_glb: bool
    rest: Bytes
    size: int
    buffers: dict[int, Bytes] = field(default_factory=dict)
    patched: set[int] = field(default_factory=set)
    is_edited: bool = False
    _elements: int = 0
    _files: set[Path] = field(default_factory=set)

    def entry(self, kind: str, index: object) -> Json:
        """Return an object of one of the top-level arrays.

        Raises
        ------
        ValueError
            When there is none of that number.
        """
        entries = self.tree.get(kind, [])
        if type(index) is not int or not 0 <= index < len(entries):
            raise ValueError(f"it refers to {kind}[{index}], of {len(entries)}")
        entry = entries[index]
        if not isinstance(entry, dict):
            raise ValueError(f"{kind}[{index}] is not an object")
        return entry

    def buffer(self, index: int) -> Bytes:
        """Return the bytes of a buffer."""
        if index not in self.buffers:
            entry = self.entry("buffers", index)
            data = self._buffer_bytes(index, entry)
            if len(data) < _size(entry, "byteLength"):
                raise ValueError(f"buffer {index} has {len(data)} bytes, of {entry['byteLength']}")
            self.buffers[index] = data
        return self.buffers[index]

    def writable(self, index: int) -> bytearray:
        """Return the bytes of a buffer, to be changed."""
        data = self.buffer(index)
        if not isinstance(data, bytearray):
            data = self.buffers[index] = bytearray(data)
        self.patched.add(index)
        return data

    def span(self, index: object) -> Span | None:
        """Return where an accessor's elements are; None when it starts from zeros."""
        accessor = self.entry("accessors", index)
        if "bufferView" not in accessor:
            return None
        return self._span(accessor, accessor["bufferView"], _layout(accessor), _count(accessor))

    def values(self, index: object, width: int) -> Array:
        """Return the elements of an accessor, count x `width`, decoded."""
        accessor = self.entry("accessors", index)
        with np.errstate(invalid="ignore"):
            decoded = self._raw(index, width).astype(np.float64)
        if accessor.get("normalized") and accessor["componentType"] != FLOAT:
            limit = np.iinfo(_COMPONENTS[accessor["componentType"]]).max
            decoded = np.maximum(decoded / limit, -1.0)
        return decoded

    def indices(self, index: object) -> NDArray[np.int64]:
        """Return the elements of an accessor of integers."""
        raw = self._raw(index, 1).ravel()
        if raw.dtype.kind != "u":
            raise ValueError(f"the indices of accessor {index} are not unsigned integers")
        return raw.astype(np.int64)

    def replace(self, index: int, values: Array) -> None:
        """Replace the elements of an accessor of floats that is not sparse."""
        span = self.span(index)
        assert span is not None
        self.writable(span.buffer)
        self._at(span, np.dtype("<f4"), values.shape[1])[:] = values
        accessor = self.entry("accessors", index)
        self._set(accessor, {k: v for k, v in _bounds(values).items() if k in accessor})

    def append(self, index: int, values: Array, with_bounds: bool) -> int:
        """Append an accessor of floats to the buffer of another; return its number."""
        number = self._buffer_of(self.entry("accessors", index))
        data = self.writable(number)
        data.extend(bytes(-len(data) % 4))
        view = {"buffer": number, "byteOffset": len(data), "byteLength": 4 * values.size}
        data.extend(values.astype("<f4").tobytes())
        self._set(self.entry("buffers", number), {"byteLength": len(data)})
        self.tree["bufferViews"] = [*self.tree.get("bufferViews", []), view]
        accessor = {
            "bufferView": len(self.tree["bufferViews"]) - 1,
            "componentType": FLOAT,
            "count": len(values),
            "type": f"VEC{values.shape[1]}",
        }
        if with_bounds:
            accessor |= _bounds(values)
        self.tree["accessors"].append(accessor)
        return len(self.tree["accessors"]) - 1

    def uri(self, index: int) -> str | None:
        """Return the URI of a buffer; None for that in a chunk of the file."""
        uri = self.entry("buffers", index).get("uri")
        if uri is not None and not isinstance(uri, str):
            raise ValueError(f"the URI of buffer {index} is not a text")
        return uri

    def rename(self, index: int, uri: str) -> None:
        """Give a buffer another URI."""
        self._set(self.entry("buffers", index), {"uri": uri})

    def serialized(self) -> bytes:
        """Return the file, with what has been patched except buffers in other files."""
        self._embed()
        if self.is_edited:
            self.chunks[0] = (_JSON, _text(self.tree))
        if not self.is_glb:
            return bytes(self.chunks[0][1])
        pieces: list[Bytes] = []
        for kind, data in self.chunks:
            padding = (b" " if kind == _JSON else b"\0") * (-len(data) % 4)
            pieces += [struct.pack("<II", len(data) + len(padding), kind), data, padding]
        body = b"".join(pieces)
        return struct.pack("<4sII", _MAGIC, 2, 12 + len(body)) + body + self.rest

    def _embed(self) -> None:
        """Put patched buffers back into the chunk or the JSON that they were read from."""
        for number in self.patched:
            uri = self.uri(number)
            if uri is None:
                self.chunks[1] = (_BIN, self.buffers[number])
            elif uri.startswith("data:"):
                data = base64.b64encode(self.buffers[number]).decode()
                self._set(self.entry("buffers", number), {"uri": f"{uri.split(',')[0]},{data}"})

    def _set(self, entry: Json, values: Json) -> None:
        for key, value in values.items():
            if entry.get(key) != value:
                entry[key] = value
                self.is_edited = True

    def _buffer_of(self, accessor: Json) -> int:
        """Return the buffer of an accessor, the first if it has no bytes."""
        views = [accessor.get("bufferView")]
        if "sparse" in accessor:
            views.append(accessor["sparse"]["values"]["bufferView"])
        for view in views:
            if view is not None:
                return _size(self.entry("bufferViews", view), "buffer")
        return 0

    def _buffer_bytes(self, index: int, entry: Json) -> Bytes:
        uri = self.uri(index)
        if uri is None:
            if index or [kind for kind, _ in self.chunks[1:2]] != [_BIN]:
                raise ValueError(f"buffer {index} has neither a URI nor a chunk of the file")
            return self.chunks[1][1]
        if uri.startswith("data:"):
            head, _, text = uri.partition(",")
            if not head.endswith(";base64"):
                raise ValueError(f"the data URI of buffer {index} is not in base64")
            return base64.b64decode(unquote_to_bytes(text), validate=True)
        return self._external(index, uri)

    def _external(self, index: int, uri: str) -> bytes:
        if _SCHEME.match(uri):
            raise unsupported(
                self.path,
                f"has its buffer {index} at {uri[:80]}",
                "download it beside the file, and give its relative path there",
            )
        file = self.path.parent / unquote(uri)
        if not file.is_file():  # a device has no end
            raise MeshFileError(
                f"{self.path} refers to {unquote(uri)[:200]}, which is missing: put it there, or "
                "export the mesh as .glb, which is one file"
            )
        if file.resolve() in self._files:
            raise ValueError(f"buffer {index} is the same file as another")
        self._files.add(file.resolve())
        data = file.read_bytes()
        self.size += len(data)
        return data

    def _span(self, owner: Json, view_index: object, layout: tuple[str, int], count: int) -> Span:
        """Return where `count` elements are in a buffer view, checked against it."""
        view = self.entry("bufferViews", view_index)
        offset, length = _size(view, "byteOffset", 0), _size(view, "byteLength")
        size = np.dtype(layout[0]).itemsize * layout[1]
        stride = _size(view, "byteStride", size)
        if stride < size:
            raise ValueError(f"bufferViews[{view_index}] has the stride {stride}, of {size} bytes")
        number, begin = _size(view, "buffer"), _size(owner, "byteOffset", 0)
        span = Span(number, offset + begin, stride, size, count)
        if span.end > min(offset + length, _size(self.entry("buffers", number), "byteLength")):
            raise ValueError(
                f"{count} elements of {stride} bytes at {begin} reach beyond "
                f"bufferViews[{view_index}], or that beyond its buffer"
            )
        return span

    def _at(self, span: Span, dtype: np.dtype[Any], width: int) -> NDArray[Any]:
        """View elements in their buffer."""
        strides = (span.stride, dtype.itemsize)
        data = self.buffer(span.buffer)
        return np.ndarray((span.count, width), dtype, data, span.start, strides)

    def _raw(self, index: object, width: int) -> NDArray[Any]:
        """Copy elements as they are stored, sparse ones put in."""
        accessor = self.entry("accessors", index)
        component, stored = _layout(accessor)
        if stored != width:
            raise ValueError(f"accessor {index} is a {accessor['type']}")
        count, dtype = _count(accessor), np.dtype(component)
        span = self.span(index)
        if span is not None:
            raw = self._at(span, dtype, width)
        self._count_elements(count)
        raw = np.zeros((count, width), dtype) if span is None else raw.copy()
        if "sparse" in accessor:
            rows, values = self._sparse(accessor["sparse"], (component, width))
            if (rows >= count).any():
                raise ValueError(f"a sparse index of accessor {index} is not below {count}")
            raw[rows] = values
        return raw

    def _sparse(
        self, sparse: Json, layout: tuple[str, int]
    ) -> tuple[NDArray[np.int64], NDArray[Any]]:
        count, indices, values = _count(sparse), sparse["indices"], sparse["values"]
        component = _COMPONENTS[indices["componentType"]]
        if "u" not in component:
            raise ValueError("its sparse indices are not unsigned integers")
        rows = self._span(indices, indices["bufferView"], (component, 1), count)
        at = self._span(values, values["bufferView"], layout, count)
        raw_rows = self._at(rows, np.dtype(component), 1).ravel().astype(np.int64)
        return raw_rows, self._at(at, np.dtype(layout[0]), layout[1])

    def _count_elements(self, count: int) -> None:
        self._elements += count
        if self._elements > _SHARED * self.size + _ALWAYS:
            raise ValueError(f"it claims {self._elements} elements, in {self.size} bytes")


def parsed(path: Path, data: bytes) -> Asset:
    """Parse the JSON of a .gltf or .glb file.

    Raises
    ------
    MeshFileError
        When it is of another version.
    """
    is_glb = data[:4] == _MAGIC
    chunks: list[tuple[int, Bytes]] = [(_JSON, data)]
    rest: Bytes = b""
    if is_glb:
        chunks, rest = _chunks(path, data)
    tree = _parsed_json(bytes(chunks[0][1]))
    if not isinstance(tree, dict):
        raise ValueError("its JSON is not an object")
    version = tree["asset"]["version"]
    if str(version).split(".")[0] != "2":
        raise _other_version(path, version)
    return Asset(path, tree, chunks, is_glb, rest, len(data))


def relative_names(tree: Json) -> list[str]:
    """Return the files that an asset refers to by relative URIs."""
    uris = [
        entry["uri"]
        for kind in ("buffers", "images")
        for entry in tree.get(kind, [])
        if isinstance(entry.get("uri"), str)
    ]
    return [unquote(uri) for uri in uris if not _SCHEME.match(uri)]


def _other_version(path: Path, version: object) -> MeshFileError:
    return unsupported(
        path,
        f"is of glTF version {version}",
        "convert it to glTF 2.0, for example by importing and exporting it in Blender",
    )


def _chunks(path: Path, data: bytes) -> tuple[list[tuple[int, Bytes]], Bytes]:
    """Return the chunks of a GLB, and what follows it."""
    _, version, length = struct.unpack_from("<4sII", data)
    if version != 2:
        raise _other_version(path, version)
    if length > len(data):
        raise ValueError(f"it has {len(data)} bytes, of {length}")
    chunks: list[tuple[int, Bytes]] = []
    position = 12
    while position < length:
        size, kind = struct.unpack_from("<II", data, position)
        position += 8
        if position + size > length:
            raise ValueError(f"a chunk of {size} bytes at byte {position} reaches beyond its end")
        chunks.append((kind, memoryview(data)[position : position + size]))
        position += size
    if not chunks or chunks[0][0] != _JSON:
        raise ValueError("its first chunk is not JSON")
    return chunks, data[length:]


def _parsed_json(text: bytes) -> Any:
    def refuse(token: str) -> Any:
        raise ValueError(f"{token} is not a number in JSON")

    return json.loads(
        text,
        object_pairs_hook=_unique,
        parse_float=_Number,
        parse_int=lambda token: _Number(token) if token == "-0" else int(token),
        parse_constant=refuse,
    )


def _unique(pairs: list[tuple[str, Any]]) -> Json:
    entries = dict(pairs)
    if len(entries) < len(pairs):
        raise ValueError(f"a key stands twice in one object of {', '.join(entries)[:80]}")
    return entries


def _text(tree: Any) -> bytes:
    pieces: list[str] = []
    _write(tree, pieces)
    return "".join(pieces).encode()


def _write(value: Any, pieces: list[str]) -> None:
    """Append the tokens of a value."""
    if isinstance(value, dict):
        separator = "{"
        for key, entry in value.items():
            pieces.append(f"{separator}{json.dumps(key)}:")
            _write(entry, pieces)
            separator = ","
        pieces.append("}" if value else "{}")
    elif isinstance(value, list):
        separator = "["
        for entry in value:
            pieces.append(separator)
            _write(entry, pieces)
            separator = ","
        pieces.append("]" if value else "[]")
    else:
        pieces.append(value.token if isinstance(value, _Number) else json.dumps(value))


def _size(entry: Json, key: str, default: int | None = None) -> int:
    """Return a count or an offset."""
    value = entry[key] if default is None else entry.get(key, default)
    if type(value) is not int or value < 0:
        raise ValueError(f"{key} is {value!r:.80}, not a number of bytes or elements")
    return value


def _count(entry: Json) -> int:
    count = _size(entry, "count")
    if count == 0:
        raise ValueError("an accessor has no elements")
    return count


def _layout(accessor: Json) -> tuple[str, int]:
    """Return the type of an accessor's components, and how many an element has."""
    component, kind = accessor["componentType"], accessor["type"]
    if component not in _COMPONENTS or kind not in _WIDTHS:
        raise ValueError(f"an accessor has the type {kind!r:.80} of {component!r:.80}")
    return _COMPONENTS[component], _WIDTHS[kind]


def _bounds(values: Array) -> dict[str, list[float]]:
    single = values.astype(np.float32).astype(np.float64)
    return {"min": single.min(axis=0).tolist(), "max": single.max(axis=0).tolist()}
