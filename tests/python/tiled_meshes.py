"""Meshes for the tests of tiles: a bumpy torus with any number of vertices, and files of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


def bumpy_torus(side: int, roughness: float = 0.02) -> tuple[Array, Indices]:
    """Return a closed surface of side^2 vertices, with bumps of many sizes, and a little noise."""
    angle = np.linspace(0, 2 * np.pi, side, endpoint=False)
    u, v = np.meshgrid(angle, angle, indexing="ij")
    r = 1 + 0.15 * np.sin(5 * u) * np.cos(4 * v) + 0.02 * np.sin(23 * u + 11 * v)
    ring = 2.5 + r * np.cos(v)
    X = np.stack([ring * np.cos(u), ring * np.sin(u), r * np.sin(v)], -1).reshape(-1, 3)
    X += roughness / side * np.random.default_rng(side).normal(size=X.shape)
    a = np.arange(side * side).reshape(side, side)
    b, d = np.roll(a, -1, 0), np.roll(a, -1, 1)
    c = np.roll(b, -1, 1)
    corners = [np.stack(three, -1).reshape(-1, 3) for three in ((a, b, c), (a, c, d))]
    return X, np.concatenate(corners)


def shuffled(V: Array, F: Indices) -> tuple[Array, Indices]:
    """Return the same mesh with vertices and faces in any order."""
    rng = np.random.default_rng(0)
    order = rng.permutation(len(V))
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    return V[order], place[F][rng.permutation(len(F))]


def write_ply(
    path: Path,
    V: Array,
    F: Indices,
    kind: str = "<f4",
    columns: dict[str, Any] | None = None,
    flags: NDArray[np.int32] | None = None,
) -> None:
    """Write a binary file: `kind` of the coordinates, further columns, and flags of the faces."""
    order, more = kind[0], columns or {}
    types = {name: np.asarray(column).dtype.str[1:] for name, column in more.items()}
    named = {"f4": "float", "f8": "double", "u1": "uchar", "i4": "int"}
    fields = [(axis, kind) for axis in "xyz"]
    fields += [(name, order + type_) for name, type_ in types.items()]
    rows = np.zeros(len(V), fields)
    for axis, column in zip("xyz", V.T, strict=True):
        rows[axis] = column
    for name, column in more.items():
        rows[name] = column
    corners: list[Any] = [("n", "u1"), ("v", order + "i4", 3)]
    faces = np.zeros(len(F), corners + ([("flags", order + "i4")] if flags is not None else []))
    faces["n"], faces["v"] = 3, F
    if flags is not None:
        faces["flags"] = flags
    end = "little" if order == "<" else "big"
    header = [f"ply\nformat binary_{end}_endian 1.0\ncomment kept\nelement vertex {len(V)}"]
    header += [f"property {named[type_[1:]]} {name}" for name, type_ in fields]
    header += [f"element face {len(F)}", "property list uchar int vertex_indices"]
    header += ["property int flags"] if flags is not None else []
    text = "\n".join([*header, "end_header", ""]).encode()
    path.write_bytes(text + rows.tobytes() + faces.tobytes() + b"")


def write_stl(path: Path, V: Array, F: Indices) -> None:
    """Write a binary file with normals."""
    rows = np.zeros(len(F), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    rows["corners"] = V[F]
    normals = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    rows["normal"] = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    path.write_bytes(bytes(80) + len(F).to_bytes(4, "little") + rows.tobytes())
