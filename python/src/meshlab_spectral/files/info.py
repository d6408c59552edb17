"""Description of a mesh file: its size, surface and noise, and a feature size to start with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import _core
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.meshes import StageCallback, load_parts
from meshlab_spectral.files.meshlab_files import read_with_meshlab
from meshlab_spectral.files.touching import least_linked
from meshlab_spectral.filters.options import SpectrumOptions
from meshlab_spectral.filters.running import plain, run
from meshlab_spectral.formats.document import Part, joined
from meshlab_spectral.plugin.loading import DENOISE_NAME, load
from meshlab_spectral.warned import Warned, warned, with_warnings

_OF_SURFACE = ("components", "joined_vertices", "unreferenced_vertices")
_OF_NOISE = (
    "noise_kind",
    "noise_height",
    "noise_size",
    "noise_share",
    "noise_searched",
    "spikes",
    "voxel_size",
)
_LENGTHS = ("diagonal", "mean_edge", "area", "default_feature_size")


def mesh_info(source: Path, on_stage: StageCallback, mesh: str | None = None) -> dict[str, Any]:
    """Describe a mesh file; several meshes are described together.

    Parameters and errors are those of `load_parts`; also FilterError when the mesh has no faces, no
    area or non-finite coordinates. `on_stage` is called with "reading", "measuring" and "looking
    for noise" as these begin, and with their progress.

    Returns
    -------
    dict
        "meshes", their names; the numbers of "vertices", "faces", "components", "rims" (boundary
        loops), "joined_vertices" (at seams) and "unreferenced_vertices", and, in a PLY file, of
        "selected_vertices" and "selected_faces"; in the units of the file, "extent" along each
        axis, "diagonal", "mean_edge", "area" (squared) and "default_feature_size"; what Spectral
        Denoise would remove: "noise_summary"; its "noise_kind", "noise_height", "noise_size" and
        "noise_share" of the surface; the number of "spikes", "voxel_size", and whether it could
        search, "noise_searched"; "warnings".
    """
    on_stage("reading", None)
    parts = load_parts(source, mesh)
    selected = _selected(source, parts)
    V, F = joined(parts)
    on_stage("measuring", None)
    spectrum = run(SpectrumOptions.FILTER, V, F, {}, progress=on_stage).report
    on_stage("looking for noise", None)
    denoised = run(DENOISE_NAME, V, F, {}, progress=on_stage).report
    copies = [
        Warned(
            "placement",
            f"{part.name} is placed {1 + len(part.copies)} times: it is described once, in its "
            "first place",
        )
        for part in parts
        if part.copies
    ]
    noise = [one for one in warned(denoised) if one.code != "nothing_removed"]
    report = {
        "meshes": [part.name for part in parts if part.name],
        "vertices": len(V),
        "faces": len(F),
        **{name: denoised[name] for name in _OF_SURFACE},
        "rims": _boundary_loops(V, F),
        **selected,
        "extent": np.ptp(V, axis=0),
        **{name: spectrum[name] for name in _LENGTHS},
        "noise_summary": spectrum["summary"],  # what was found; denoise says what it did
        **{name: denoised[name] for name in _OF_NOISE},
    }
    return plain(with_warnings(report, copies + noise))


def _boundary_loops(V: NDArray[np.float64], F: NDArray[np.int64]) -> int:
    """Count the connected sets of boundary edges, where the surface is not joined at a seam."""
    place = _core.joined_vertices(np.ascontiguousarray(V), np.ascontiguousarray(F, dtype=np.int32))
    corners = place[F]
    sides = np.vstack([corners[:, [k, (k + 1) % 3]] for k in range(3)])
    edges, faces = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    return len(set(least_linked(edges[faces == 1].tolist()).values()))


def _selected(source: Path, parts: list[Part]) -> dict[str, int]:
    """Count the selected vertices and faces; only MeshLab's PLY files hold a selection."""
    if source.suffix.lower() != ".ply":
        return {}
    if all(part.selected is None for part in parts):
        return {"selected_vertices": 0, "selected_faces": 0}
    load()
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    try:
        read_with_meshlab(mesh_set, source)
    except MeshFileError:  # `load_parts` has read it nevertheless
        return {}
    mesh = mesh_set.current_mesh()
    return {
        "selected_vertices": mesh.selected_vertex_number(),
        "selected_faces": mesh.selected_face_number(),
    }
