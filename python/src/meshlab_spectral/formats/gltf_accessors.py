"""The containers of glTF 2.0: JSON, GLB chunks, buffers, and accessors into them."""

from __future__ import annotations

import base64
import contextlib
import itertools
import json
import struct
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.formats.budget import Budget
from meshlab_spectral.formats.causes import unreadable, unsupported
from meshlab_spectral.formats.document import Array
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.side_files import beside

_FLOAT = 5126
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", _FLOAT: "<f4"}
_KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
_FAULTS = (ArithmeticError, LookupError, RuntimeError, ValueError)
Json = dict[str, Any]


@contextlib.contextmanager
def reporting_faults(path: Path) -> Iterator[None]:
    """Turn any exception that a malformed asset causes into MeshFileError."""
    try:
        with np.errstate(all="ignore"):
            yield
    except KeyError as error:
        raise unreadable(path, f"{error} is missing or unknown in its JSON") from error
    except (AttributeError, TypeError) as error:
        raise unreadable(path, "a value in its JSON has the wrong type") from error
    except _FAULTS as error:
        raise unreadable(path, error) from error


@dataclass
class Asset:
    """A glTF asset that can be patched: its JSON, and its buffers."""

    path: Path
    data: bytes  # the file
    tree: Json
    binary: bytes | None  # the buffer in a GLB
    rest: bytes  # its other chunks
    budget: Budget
    buffers: list[bytearray] = field(default_factory=list)
    _patched: set[int] = field(default_factory=set)
    _grown: set[int] = field(default_factory=set)  # to be written if any is patched
    _written: dict[int, list[tuple[int, Array]]] = field(default_factory=lambda: defaultdict(list))

    def entry(self, kind: str, index: object) -> Any:
        """Return an entry of one of the top-level arrays."""
        entries = self.tree.get(kind, [])
        if type(index) is not int or not 0 <= index < len(entries):
            raise ValueError(f"it refers to {kind}[{index!r:.80}], of {len(entries)}")
        return entries[index]

    def values(self, index: object, width: int) -> Array:
        """Return the elements of an accessor, count x `width`, decoded."""
        accessor = self.entry("accessors", index)
        count, component = accessor["count"], accessor["componentType"]
        if accessor["type"] != _KINDS[width]:
            raise ValueError(f"accessor {index} is a {accessor['type']!r:.80}")
        self.budget.take(8 * count * width, f"its accessors claim {count} elements")
        values = np.zeros((count, width))
        if "bufferView" in accessor:
            values = self._view(accessor, component, width, count).astype(np.float64)
        if "sparse" in accessor:
            rows, new, count = (accessor["sparse"][key] for key in ("indices", "values", "count"))
            changed = self._view(rows, rows["componentType"], 1, count).ravel()
            values[changed] = self._view(new, component, width, count)
        if accessor.get("normalized") and component != _FLOAT:
            values = np.maximum(values / np.iinfo(_COMPONENTS[component]).max, -1.0)
        return values

    def fill(self, index: object, values: NDArray[Any]) -> None:
        """Give an accessor without data its elements, count x width, in a new view of them."""
        accessor = self.entry("accessors", index)
        self.budget.take(8 * values.size, "its compressed geometry")
        data = values.astype(_COMPONENTS[accessor["componentType"]])
        accessor |= {"bufferView": self._new_view(data.tobytes()), "count": len(data)}
        for bound, of in (("min", np.min), ("max", np.max)):  # what was packed with loss has others
            if bound in accessor and len(data):
                accessor[bound] = of(data, axis=0).tolist()
        accessor.pop("byteOffset", None)
        self._grown = {0}

    def _new_view(self, content: bytes) -> int:
        """Append bytes to the first buffer; return the number of their view."""
        data, views = self.buffers[0], self.tree["bufferViews"]
        data.extend(bytes(-len(data) % 4))
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(content)})
        data.extend(content)
        self.tree["buffers"][0]["byteLength"] = len(data)
        return len(views) - 1

    def put(self, index: int, before: Array, values: Array) -> int:
        """Replace the elements of an accessor, or append a new accessor; return its number."""
        for number, others in self._written[index]:
            if np.array_equal(others, values):
                return number
        stays = np.array_equal(before, values, equal_nan=True)
        is_first = not self._written[index] and (stays or self._replaced(index, values))
        number = index if is_first else self._append(values)
        self._written[index].append((number, values))
        return number

    def side_files(self) -> list[str]:
        """Return the names of the files that the asset refers to."""
        entries = [*self.tree.get("buffers", []), *self.tree.get("images", [])]
        uris = [entry["uri"] for entry in entries if "uri" in entry]
        return [unquote(uri) for uri in uris if not uri.startswith(("data:", "http:", "https:"))]

    def write(self, target: Path) -> list[str]:
        """Write the asset, with patched buffers next to it; return the other files it refers to."""
        names = self.side_files()
        taken = set(names)
        for number in self._patched | self._grown if self._patched else ():
            entry, data = self.tree["buffers"][number], self.buffers[number]
            uri = entry.get("uri")
            if uri is None:
                self.binary = bytes(data)
            elif uri.startswith("data:"):
                entry["uri"] = f"{uri.partition(',')[0]},{base64.b64encode(data).decode()}"
            else:
                names.remove(unquote(uri))
                name = _name_for(unquote(uri), target, taken)
                taken.add(name)
                (target.parent / name).parent.mkdir(parents=True, exist_ok=True)
                (target.parent / name).write_bytes(data)
                entry["uri"] = quote(name)
        target.write_bytes(self._serialized() if self._patched else self.data)
        return names

    def read_buffers(self) -> None:
        """Read all buffers."""
        files: set[Path] = set()
        for number, entry in enumerate(self.tree.get("buffers", [])):
            data, uri = (self.binary or b"") if number == 0 else b"", entry.get("uri", "")
            if uri.startswith("data:"):
                data = base64.b64decode(uri.partition(";base64,")[2], validate=True)
            elif uri:
                file = beside(self.path, unquote(uri))
                if file in files:
                    raise ValueError(f"its file {shown(unquote(uri))} is named twice")
                files.add(file)
                data = file.read_bytes()
                self.budget.extend(len(data))
            if len(data) < entry["byteLength"]:
                raise ValueError(f"buffer {number} has {len(data)} bytes, of {entry['byteLength']}")
            self.buffers.append(bytearray(data))

    def _view(self, owner: Json, component: int, width: int, count: int) -> NDArray[Any]:
        """View elements in their buffer."""
        view = self.entry("bufferViews", owner["bufferView"])
        dtype = np.dtype(_COMPONENTS[component])
        begin, offset = view.get("byteOffset", 0), owner.get("byteOffset", 0)
        stride = view.get("byteStride", dtype.itemsize * width)
        room = memoryview(self.buffers[view["buffer"]])[begin : begin + view["byteLength"]]
        end = offset + stride * (count - 1) + dtype.itemsize * width
        if min(begin, offset, count - 1, stride - dtype.itemsize * width) < 0 or end > len(room):
            raise ValueError(f"bufferViews[{owner['bufferView']}] does not hold {count} elements")
        return np.ndarray((count, width), dtype, room, offset, (stride, dtype.itemsize))

    def _replaced(self, index: int, values: Array) -> bool:
        """Replace elements in place, if possible; return whether it was."""
        accessor = self.entry("accessors", index)
        if accessor["componentType"] != _FLOAT or "sparse" in accessor:
            return False
        self._view(accessor, _FLOAT, values.shape[1], len(values))[:] = values
        self._patched.add(self.entry("bufferViews", accessor["bufferView"])["buffer"])
        if "min" in accessor or "max" in accessor:
            accessor.update(_bounds(values))
        return True

    def _append(self, values: Array) -> int:
        """Append an accessor of floats to the first buffer; return its number."""
        self._patched.add(0)
        view, accessors = self._new_view(values.astype("<f4").tobytes()), self.tree["accessors"]
        layout = {"componentType": _FLOAT, "count": len(values), "type": _KINDS[values.shape[1]]}
        accessors.append({"bufferView": view, **layout, **_bounds(values)})
        return len(accessors) - 1

    def _serialized(self) -> bytes:
        text = json.dumps(self.tree, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        if self.binary is None:
            return text.encode()
        body = b""
        for kind, data, padding in ((b"JSON", text.encode(), b" "), (b"BIN\0", self.binary, b"\0")):
            padded = data + padding * (-len(data) % 4)
            body += struct.pack("<I4s", len(padded), kind) + padded if data else b""
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body + self.rest)) + body + self.rest


def parsed(path: Path, data: bytes) -> Asset:
    """Parse a .gltf or .glb file and read its buffers."""
    text, binary, rest = data, None, b""
    if data[:4] == b"glTF":
        length, size = (int.from_bytes(data[at : at + 4], "little") for at in (8, 12))
        if length > len(data):
            raise ValueError(f"it has {len(data)} bytes, of {length}")
        text, rest = data[20 : 20 + size], data[20 + size : length]
        end = 8 + int.from_bytes(rest[:4], "little")
        binary, rest = rest[8:end], rest[end:]
    asset = Asset(
        path, data, json.loads(text.decode("utf-8-sig")), binary, rest, Budget(path, len(data))
    )
    version = str(asset.tree["asset"]["version"])
    if version.split(".")[0] != "2":
        remedy = "convert it to glTF 2.0, for example by importing and exporting it in Blender"
        raise unsupported(path, f"is of glTF version {shown(version)}", remedy)
    asset.read_buffers()
    return asset


def numbers_of(entry: Json, key: str, default: list[int]) -> Array:
    """Return the numbers of an entry, as many as by default."""
    value = entry.get(key, default)
    is_list = isinstance(value, list) and len(value) == len(default)
    if not is_list or any(type(x) not in (int, float) for x in value):
        raise ValueError(f"{key} is not a list of {len(default)} numbers")
    return np.array(value, dtype=np.float64)


def _bounds(values: Array) -> dict[str, list[float]]:
    single = values.astype(np.float32)
    return {"min": single.min(axis=0).tolist(), "max": single.max(axis=0).tolist()}


def _name_for(name: str, target: Path, taken: set[str]) -> str:
    """Return the name for a buffer: its own, unless that is taken or leads outside the folder."""
    folders = [folder.resolve() for folder in target.parents[:2]]  # it may be in a scratch folder
    is_within = (folders[0] / name).resolve().is_relative_to(folders[0])
    if is_within and not any((folder / name).exists() for folder in folders):
        return name
    names = (f"{target.name}{k or ''}.bin" for k in itertools.count())
    return next(name for name in names if name not in taken)
