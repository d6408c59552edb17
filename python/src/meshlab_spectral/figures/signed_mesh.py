"""A mesh file with a signed number at each vertex, as quality and in colours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def write_signed(V: Array, F: NDArray[Any], values: Array, extent: float, scratch: Path) -> None:
    """Write a mesh as .ply: blue, white and red are -extent, 0 and extent, as in MeshLab."""
    import plyfile

    columns = [(name, "f8") for name in ("x", "y", "z", "quality")]
    columns += [(name, "u1") for name in ("red", "green", "blue")]
    vertices = np.empty(len(V), columns)
    for name, coordinates in zip("xyz", V.T, strict=True):
        vertices[name] = coordinates
    vertices["quality"] = values
    colours = _diverging(values / extent)
    for name, levels in zip(("red", "green", "blue"), colours.T, strict=True):
        vertices[name] = levels
    faces = np.empty(len(F), [("vertex_indices", "i4", (3,))])
    faces["vertex_indices"] = F
    elements = [
        plyfile.PlyElement.describe(vertices, "vertex"),
        plyfile.PlyElement.describe(faces, "face"),
    ]
    plyfile.PlyData(elements).write(scratch)


def _diverging(share: Array) -> NDArray[np.uint8]:
    """Return red, green and blue of -1 (blue), 0 (white) and 1 (red)."""
    fade = 1 - np.minimum(np.abs(share), 1)
    rgb = np.column_stack([np.where(share > 0, 1, fade), fade, np.where(share < 0, 1, fade)])
    levels: NDArray[np.uint8] = np.round(255 * rgb).astype(np.uint8)
    return levels
