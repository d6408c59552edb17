"""The vertices of a region."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import _core
from meshlab_spectral.errors import InputError, OptionError
from meshlab_spectral.files.region import Region
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.formats.document import Array, Indices, Part, joined, split
from meshlab_spectral.formats.normals import area_vectors, vertex_normals

Flags = NDArray[np.bool_]

NOTHING_SELECTED = (
    "nothing is selected: select faces or vertices in MeshLab and save as .ply, or leave out "
    "selected, for the whole mesh"
)

_CONDITIONS = (
    "give a condition of x, y, z, nx, ny, nz and, if the mesh has it, the quality q, such as "
    "z > 3 && nz > 0"
)


def vertices_in(region: Region, V: Array, F: Indices, quality: Array | None = None) -> Flags:
    """Return which of n vertices are in a region, whose components are those of this mesh.

    Raises OptionError when the region does not fit the mesh, InputError when the mask cannot be
    read.
    """
    chosen = np.ones(len(V), dtype=bool)
    for name in region.given():
        chosen &= _VERTICES[name](region, V, F, quality)
    return chosen


def _in_box(region: Region, V: Array, F: Indices, quality: Array | None) -> Flags:
    corners = np.reshape(region.corners(), (2, 3))
    inside: Flags = ((corners.min(axis=0) <= V) & (corners.max(axis=0) >= V)).all(axis=1)
    return inside


def _in_component(region: Region, V: Array, F: Indices, quality: Array | None) -> Flags:
    labels = _core.components(np.ascontiguousarray(V), np.ascontiguousarray(F, dtype=np.int32))
    areas = np.linalg.norm(area_vectors(V, F), axis=1)
    count = int(labels.max(initial=-1)) + 1
    # By area, descending; a triangle without any is in the component of its corners, or in none.
    sizes = np.bincount(labels[F[:, 0]] + 1, weights=areas, minlength=count + 1)[1:]
    if region.number > count:
        raise OptionError(f"component = {region.component}: there are {count}")
    wanted = np.argsort(-sizes, kind="stable")[region.number - 1]
    chosen: Flags = labels == wanted
    return chosen


def _where(region: Region, V: Array, F: Indices, quality: Array | None) -> Flags:
    columns = [V, vertex_normals(V, F)]
    names = ["x", "y", "z", "nx", "ny", "nz"]
    if quality is not None:
        columns.append(quality[:, None])
        names.append("q")
    values = np.ascontiguousarray(np.hstack(columns), dtype=np.float64)
    holds = _core.evaluated("where", str(region.where), _CONDITIONS, names, values)
    chosen: Flags = (holds != 0) & ~np.isnan(holds)
    return chosen


def _in_mask(region: Region, V: Array, F: Indices, quality: Array | None) -> Flags:
    assert region.mask is not None
    values = _read_mask(region.mask)
    if values.shape != (len(V),):
        raise OptionError(
            f"mask = {region.mask}: has {' x '.join(map(str, values.shape))} numbers for {len(V)} "
            "vertices; where a file "
            "has several meshes, name one with --mesh"
        )
    if not (finite := np.isfinite(values)).all():
        first = int(np.argmin(finite))
        raise InputError(
            f"the mask {region.mask} has {values[first]} for vertex {first}: give 0, which leaves "
            "it out, or another number"
        )
    chosen: Flags = values != 0
    return chosen


def _read_mask(path: Path) -> NDArray[np.float64]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)  # of a text without numbers
            values = np.load(path) if path.suffix.lower() == ".npy" else np.loadtxt(path, ndmin=1)
        if np.iscomplexobj(values):
            raise ValueError("it has complex numbers")
        # A column or a row of a table is one number for each vertex, too.
        return np.atleast_1d(np.squeeze(np.asarray(values, dtype=np.float64)))
    except OSError as error:
        raise InputError(f"the mask {path} cannot be read ({error.strerror or error})") from error
    except UnicodeDecodeError as error:
        raise InputError(f"the mask {path} is not text: give text or .npy") from error
    except (ValueError, TypeError, EOFError, UserWarning) as error:
        raise InputError(f"the mask {path} is not one number for each vertex: {error}") from error


# One for each field of Region.
_VERTICES: Mapping[str, Callable[[Region, Array, Indices, Array | None], Flags]] = {
    "box": _in_box,
    "component": _in_component,
    "where": _where,
    "mask": _in_mask,
}


def chosen_parts(parts: Iterable[Part], options: Options, region: Region) -> list[Part | None]:
    """Return meshes whose selection is what of them is filtered, or None where nothing is.

    Raises OptionError when nothing is selected or in the region, and as `vertices_in` does.
    """
    parts = list(parts)
    if region:
        return restricted(parts, region)
    if not getattr(options, "selected", False):
        return [*parts]
    if all(part.selected is None for part in parts):
        raise OptionError(NOTHING_SELECTED)
    return [None if part.selected is None else part for part in parts]


def restricted(parts: Sequence[Part], region: Region) -> list[Part | None]:
    """Return meshes whose selection is what of them is in a region, or None where nothing is.

    Raises OptionError when nothing is in the region at all, and as `vertices_in` does.
    """
    chosen = [
        vertices_in(replace(region, component=None), one.vertices, one.faces, one.quality)
        for one in parts
    ]
    if region.component is not None:  # counted over all meshes
        flags = split(_in_component(region, *joined(parts), None), parts)
        chosen = [one & more for one, more in zip(chosen, flags, strict=True)]
    if not any(flags.any() for flags in chosen):
        given = ", ".join(f"{name} = {value}" for name, value in region.given().items())
        raise OptionError(f"{given}: no vertex is there, so nothing would change")
    return [
        replace(part, selected=flags) if flags.any() else None
        for part, flags in zip(parts, chosen, strict=True)
    ]
