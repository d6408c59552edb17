"""The meshes of a file: reading them, whichever format it has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.errors import OptionError
from meshlab_spectral.files.meshlab_files import read_with_meshlab
from meshlab_spectral.files.sources import check_source
from meshlab_spectral.filters.mesh_objects import PYMESHLAB
from meshlab_spectral.formats.document import Array, Document, Indices, Part, joined
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.opening import format_of, open_document
from meshlab_spectral.formats.placement import IDENTITY, Placement
from meshlab_spectral.plugin.loading import load

_NAMED = 50  # meshes to choose from


def load_arrays(source: Path, mesh: str | None = None) -> tuple[Array, Indices]:
    """Read a mesh file: n x 3 placed coordinates, and m x 3 vertex indices of triangles.

    Several meshes become one, with several components. Parameters and errors are those of
    `load_parts`.
    """
    return joined(load_parts(source, mesh))


def load_parts(source: Path, mesh: str | None = None) -> list[Part]:
    """Read the meshes of a file, or only the one named `mesh`.

    Raises MeshFileError when `source` cannot be read, OptionError when no mesh has the name.
    """
    check_source(source)
    if format_of(source):
        return chosen_by_name(open_document(source), mesh)
    load()
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    read_with_meshlab(mesh_set, source)
    return [part_of(mesh_set.current_mesh())]


def part_of(mesh: Any) -> Part:
    """Return a `pymeshlab.Mesh` as a part, without selection if nothing is selected."""
    data = {name: np.array(values) for name, values in PYMESHLAB.data(mesh).items()}
    selected = data["selection"] if data["selection"].any() else None
    V, F = PYMESHLAB.arrays(mesh)
    return Part("", V.copy(), F.astype(np.int64), data.get("quality"), selected)


def chosen_by_name(document: Document, name: str | None) -> list[Part]:
    """Return the meshes of a document, or only the one of this name; raise OptionError if none."""
    if name is None:
        return document.parts
    parts = [part for part in document.parts if part.name in (name, shown(name))]
    if not parts:
        names = [part.name or "one without a name" for part in document.parts]
        more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
        given = ", ".join(names[:_NAMED])
        raise OptionError(f"{document.path} has no mesh {name!r}: choose from {given}{more}")
    return parts


def whole_of(group: Sequence[Part]) -> Part:
    """Return the pieces of a surface as one part."""
    if len(group) == 1:
        return group[0]
    name = ", ".join(part.name for part in group)
    qualities = [part.quality for part in group if part.quality is not None]
    quality = np.concatenate(qualities) if len(qualities) == len(group) else None
    selected = None
    if any(part.selected is not None for part in group):
        selected = np.concatenate([part.flags for part in group])
    return Part(name, *joined(group), quality, selected)


def in_scene(parts: Sequence[Part]) -> list[Part]:
    """Return the parts of the scene, and each once more wherever else it has it."""
    return [
        replace(
            part, vertices=place.placed(part.vertices), faces=place.oriented(part.faces), copies=()
        )
        for part in parts
        if part.is_shown
        for place in map(Placement, (IDENTITY, *part.copies))
    ]
