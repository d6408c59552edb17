"""Height maps of instruments and terrains, read as regular meshes; none of them is written."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import FormatError, SpectralError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.formats.budget import Budget, guarded
from meshlab_spectral.formats.causes import unreadable, unsupported
from meshlab_spectral.formats.document import Array, Document, Indices, Part, check_vertices
from meshlab_spectral.warned import Warned

# What the libraries take, whatever the file: bytes.
_OF_LIBRARY = 1 << 30
# The position of a pixel in x and y: x = a column + b row + c, y = d column + e row + f.
_Affine = tuple[float, float, float, float, float, float]


class _HeightMap(Document):
    """A map, whose coordinates are not replaced: vertices of a mesh leave the grid."""

    def keeps(self, target: Path) -> bool:
        return False

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        raise FormatError(f"{target.name}: height maps are only read; name the output .ply")


def read(path: Path) -> Document:
    """Read the heights of a map as a mesh: a vertex for each, z upwards, the first row at the back.

    Instruments' maps are in micrometres, GeoTIFF in the units of its reference system. Pixels that
    were not measured are left out, as holes. Raises MeshFileError if the file is damaged or holds
    no heights over a plane, and MissingPackageError for the extra "maps".
    """
    check_extras("maps")
    budget = Budget(path, path.stat().st_size)
    try:
        with warnings.catch_warnings(), guarded(budget, _OF_LIBRARY):
            warnings.simplefilter("ignore")
            reader = _of_terrain if path.suffix.lower() in (".tif", ".tiff") else _of_instrument
            heights, transform, unit = reader(path)
    except SpectralError:
        raise
    except Exception as error:  # of many kinds: readers of twenty formats
        raise unreadable(path, f"{error!s:.300}" or type(error).__name__) from error
    vertices, faces = _surface(heights, transform)
    if not len(faces):
        raise unsupported(
            path, "has no three measured heights next to each other", "measure it again"
        )
    check_vertices(path, vertices)
    return _HeightMap(path, [Part("", vertices, faces, unit=unit)])


def _of_instrument(path: Path) -> tuple[Array, _Affine, str]:
    import surfalize

    surface = surfalize.Surface.load(path)
    dx, dy = float(surface.step_x), float(surface.step_y)
    return np.asarray(surface.data, np.float64), (dx, 0, 0, 0, -dy, 0), "µm"


def _of_terrain(path: Path) -> tuple[Array, _Affine, str]:
    import rasterio

    with rasterio.open(path) as data:
        if data.count != 1:
            raise unsupported(path, f"has {data.count} bands", "save the heights alone")
        if data.transform.is_identity:
            raise unsupported(path, "has no size of a pixel", "save it as GeoTIFF, with its place")
        system: Any = data.crs
        if system is not None and system.is_geographic:
            remedy = "project it first, for instance with `gdalwarp -t_srs EPSG:...` to UTM"
            raise unsupported(path, "has x and y in degrees", remedy)
        band = data.read(1, masked=True).astype(np.float64).filled(np.nan)
        heights = band * data.scales[0] + data.offsets[0]
        unit = "" if system is None or system.linear_units_factor[1] != 1 else "m"
        a, b, c, d, e, f = data.transform[:6]  # of corners; heights are at centres
        return heights, (a, b, c + (a + b) / 2, d, e, f + (d + e) / 2), unit


def _quads(grid: NDArray[Any]) -> NDArray[Any]:
    """Return the values at the corners of each cell, around it."""
    corners = (grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:])
    return np.stack(corners, axis=-1).reshape(-1, 4)


def _surface(heights: Array, transform: _Affine) -> tuple[Array, Indices]:
    """Return vertices and triangles of the heights that are finite."""
    a, b, c, d, e, f = transform
    row, column = np.indices(heights.shape)
    vertices = np.stack([a * column + b * row + c, d * column + e * row + f, heights], axis=-1)
    there: NDArray[np.bool_] = np.isfinite(heights)
    number = np.arange(heights.size).reshape(heights.shape)
    corners, are = _quads(number), _quads(there)
    # Along the diagonal from 1 to 3; where one of these is missing, the other three.
    halves = [corners[are[:, t].all(axis=1)][:, t] for t in ([0, 1, 3], [1, 2, 3])]
    halves += [
        corners[are[:, t].all(axis=1) & ~are[:, missing]][:, t]
        for t, missing in (([0, 1, 2], 3), ([0, 2, 3], 1))
    ]
    faces = np.concatenate(halves)
    if a * e - b * d > 0:  # rows that go up would turn the surface over
        faces = faces[:, ::-1]
    used = np.zeros(heights.size, bool)
    used[faces] = True
    kept = np.cumsum(used) - 1
    return vertices.reshape(-1, 3)[used], kept[faces]
