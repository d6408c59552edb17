"""Measurements of mesh files: description, harmonics, roughness, spectrum."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import _core
from meshlab_spectral.errors import MeshError, MeshFileError
from meshlab_spectral.files.comparison import Comparison, compare
from meshlab_spectral.files.meshes import in_scene, load_arrays, load_parts
from meshlab_spectral.files.meshlab_files import read_with_meshlab
from meshlab_spectral.files.region_vertices import restricted
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.touching import least_linked
from meshlab_spectral.filters.arrays import lengths_of, lumped_areas
from meshlab_spectral.filters.harmonics import manifold_harmonics
from meshlab_spectral.filters.options import FilterOptions, SpectrumOptions, TextureOptions
from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.filters.running import plain, run
from meshlab_spectral.filters.spectrum import measure
from meshlab_spectral.filters.texture import SurfaceTexture, surface_texture
from meshlab_spectral.formats.document import Array, Part, joined
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


def mesh_info(request: Request, on_stage: StageCallback) -> dict[str, Any]:
    """Describe a mesh file; several meshes are described together.

    Errors are those of `load_parts`; also FilterError when the mesh has no faces, no
    area or non-finite coordinates. `on_stage` is called with "reading" and "looking for
    noise" as these begin, and with their progress.

    Returns what `info --json` prints: names of the meshes, counts, lengths in the units of the
    file, entries of `GeometrySpectrum` and, of what Spectral Denoise would remove, of
    `DenoiseReport`; "rims" are boundary loops.
    """
    on_stage("reading", None)
    parts = load_parts(request.source, request.mesh)
    selected = _selected(request.source, parts)
    V, F = joined(parts)
    on_stage("looking for noise", None)
    denoised = run(DENOISE_NAME, V, F, {"strength": 0.0}, progress=on_stage).report
    lengths = lengths_of(V, F)
    copies = [
        Warned(
            "placement",
            f"{part.name} is placed {1 + len(part.copies)} times: it is described once, in its "
            "first place",
        )
        for part in parts
        if part.copies
    ]
    report = {
        "meshes": [part.name for part in parts if part.name],
        "vertices": len(V),
        "faces": len(F),
        **{name: denoised[name] for name in _OF_SURFACE},
        "rims": _boundary_loops(V, F),
        **selected,
        "extent": np.ptp(V, axis=0),
        "diagonal": lengths.diagonal,
        "mean_edge": lengths.mean_edge,
        "area": lumped_areas(V, F).sum(),
        "default_feature_size": FilterOptions().sizes(*lengths)["feature_size"],
        "noise_summary": denoised["summary"],
        **{name: denoised[name] for name in _OF_NOISE},
    }
    return plain(with_warnings(report, copies + warned(denoised)))


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


def basis_to_scratch(request: Request, scratch: Path, on_stage: StageCallback) -> dict[str, Any]:
    """Write the harmonics of a mesh file to a NumPy archive, `scratch` from `writing_whole`.

    All meshes of the file are one, unless one is named. The arrays are those of `Harmonics`, and
    the mesh as read, to whose vertices the rows belong. Errors are those of `load_arrays` and
    `manifold_harmonics`.
    """
    on_stage("reading", None)
    V, F = load_arrays(request.source, request.mesh)
    on_stage("computing", None)
    basis = manifold_harmonics(V, F, **request.options.as_dict(), progress=on_stage)
    on_stage("writing", None)
    with scratch.open("wb") as file:
        np.savez(
            file,
            eigenvalues=basis.eigenvalues,
            frequencies=basis.frequencies,
            harmonics=basis.harmonics,
            masses=basis.masses,
            vertices=V,
            faces=F,
        )
    return {"vertices": len(V), "harmonics": len(basis.eigenvalues)}


def comparison_of(
    a: Path, b: Path, max_distance: float | None, whole: bool, on_stage: StageCallback
) -> Comparison:
    """Compare two mesh files; only the `whole` comparison has meshes, and values at vertices."""
    on_stage("reading", None)
    found = compare(a, b, max_distance=max_distance)
    return found if whole else found.without_arrays


def texture_of(
    request: Request, on_stage: StageCallback
) -> tuple[Array, NDArray[Any], SurfaceTexture]:
    """Measure a mesh file or a region; several meshes are one.

    Returns the vertices, n x 3, and the faces, m x 3, too. Errors are those of `load_parts`,
    `restricted` and `surface_texture`.
    """
    options, region = request.options, request.region
    assert isinstance(options, TextureOptions)
    on_stage("reading", None)
    parts = in_scene(load_parts(request.source, request.mesh))
    V, F = joined(parts)
    if len(F) == 0:
        raise MeshError(f"{request.source} has no faces: there is no surface to measure")
    selection = None
    if options.selected or region:
        chosen = restricted(parts, region) if region else parts
        none = [replace(part, selected=None) for part in parts]
        selection = np.concatenate([(a or b).flags for a, b in zip(chosen, none, strict=True)])
    on_stage("measuring", None)
    texture = surface_texture(V, F, options, selection=selection, progress=on_stage)
    units = {part.unit for part in parts}
    return V, F, replace(texture, unit=units.pop() if len(units) == 1 else "")


def spectrum_of(request: Request, on_stage: StageCallback) -> dict[str, Any]:
    """Measure the spectrum of a mesh file, of all its meshes as one; errors as `geometry_spectrum`.

    Returns what `GeometrySpectrum.from_report` takes.
    """
    assert isinstance(request.options, SpectrumOptions)
    on_stage("reading", None)
    V, F = load_arrays(request.source, request.mesh)
    on_stage("measuring", None)
    return plain(measure(V, F, request.options, on_stage))
