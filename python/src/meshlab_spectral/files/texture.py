"""The roughness of the surface in a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.errors import MeshError
from meshlab_spectral.files.meshes import StageCallback, in_scene, load_parts
from meshlab_spectral.files.region import Region
from meshlab_spectral.files.region_vertices import restricted
from meshlab_spectral.filters.options import TextureOptions
from meshlab_spectral.filters.texture import surface_texture
from meshlab_spectral.formats.document import joined


def texture_of(
    source: Path,
    options: TextureOptions,
    on_stage: StageCallback,
    mesh: str | None = None,
    archive: Path | None = None,
    region: Region | None = None,
) -> dict[str, Any]:
    """Measure a mesh file or a region; several meshes are one. Returns `SurfaceTexture.report`.

    Parameters and errors are those of `load_parts`, `restricted` and `surface_texture`. An
    `archive` of NumPy is written with the vertices, n x 3, the faces, m x 3, and the height of each
    vertex.
    """
    on_stage("reading", None)
    parts = in_scene(load_parts(source, mesh))
    V, F = joined(parts)
    if len(F) == 0:
        raise MeshError(f"{source} has no faces: there is no surface to measure")
    selection = None
    if options.selected or region is not None:
        chosen = parts if region is None else restricted(parts, region)
        flags = [
            np.zeros(len(part.vertices), bool)
            if one is None or one.selected is None
            else one.selected
            for part, one in zip(parts, chosen, strict=True)
        ]
        selection = np.concatenate(flags)
    on_stage("measuring", None)
    texture = surface_texture(V, F, options, selection=selection, progress=on_stage)
    if archive is not None:
        np.savez(archive, vertices=V, faces=F, height=texture.height)
    units = {part.unit for part in parts}
    return {**texture.report, **({"unit": units.pop()} if len(units) == 1 and any(units) else {})}
