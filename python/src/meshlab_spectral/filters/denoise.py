"""Spectral Denoise: its options, and the filter on arrays and meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar, cast, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.options import DenoiseKeywords, DenoiseOptions
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.reports import DenoiseReport
from meshlab_spectral.filters.shapes import filter_shape

if TYPE_CHECKING:
    from typing_extensions import Unpack

Mesh = TypeVar("Mesh")


@overload
def denoise_mesh(
    mesh_or_vertices: ArrayLike,
    faces: ArrayLike,
    options: DenoiseOptions | None = None,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[DenoiseKeywords],
) -> tuple[NDArray[np.float64], DenoiseReport]: ...
@overload
def denoise_mesh(
    mesh_or_vertices: Mesh,
    faces: None = None,
    options: DenoiseOptions | None = None,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[DenoiseKeywords],
) -> tuple[Mesh, DenoiseReport]: ...


@takes_options(DenoiseOptions)
@takes_mesh_alone
def denoise_mesh(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    options: DenoiseOptions | None = None,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[DenoiseKeywords],
) -> tuple[Any, DenoiseReport]:
    """Detect what kind of noise a mesh has, and remove it; without noise, nothing moves.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `filter_mesh`.
    options
        All options below in one object, instead of by name.
    weights
        n factors on `noise_height`, from 0 to 1, one per vertex, or the name of such data of the
        mesh: for noise that differs from place to place. Heights h of your own are
        ``noise_height=h.max(), weights=h / h.max()``.
    selection
        What to denoise: n booleans, one per vertex, or indices of faces; around it, the effect
        fades out within four edges.
    progress, threads
        As for `filter_mesh`.
    **named

    Returns
    -------
    denoised
        n x 3 coordinates, or a mesh of the type passed, with its data; the faces do not change.
    report : DenoiseReport
        A dict. "summary" says in one line what was found and done, such as "scanner noise: height
        0.08 edges (0.012), size 2.1 edges (0.31): removed"; `noise_kind` is the kind as one word,
        `noise_share` the share of the surface with it. Numbers, lengths in the units of the mesh:
        `noise_height` and `noise_size` of the removed noise, both 0 if none was; the measured
        `estimated_noise_height`, `estimated_noise_size` and `noise_correlation` of neighbours;
        `spikes`, a number of vertices; `voxel_size` along each axis; `mean_edge`,
        `max_displacement`, `rms_displacement` and others; with `store_noise_height` also
        `noise_heights`, the height at each vertex, 0 where there is no noise. "warnings" lists
        problems and what to do about them, and says so if nothing has changed.

    Raises
    ------
    SpectralError
        As from `filter_mesh`.

    Examples
    --------
    >>> V, report = denoise_mesh(vertices, faces)
    >>> print(report["summary"])
    """
    moved, report = filter_shape(
        mesh_or_vertices,
        faces,
        DenoiseOptions.from_call(options, named),
        weights=weights,
        selection=selection,
        progress=progress,
        threads=threads,
    )
    return moved, cast(DenoiseReport, report)
