"""How rough a surface is: roughness separated from waviness and form, on arrays and meshes."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.options import TextureKeywords, TextureOptions
from meshlab_spectral.filters.running import Progress, run

if TYPE_CHECKING:
    from typing_extensions import Unpack


@dataclass(frozen=True, eq=False)
class SurfaceTexture:
    """The roughness of a surface, with the parameters of ISO 25178-2.

    Lengths are in the units of the mesh; means are over the reference surface.

    Attributes
    ----------
    height
        Height of each of the n vertices above the reference surface, along its normal; 0 where
        nothing is evaluated.
    Sa, Sq
        Mean magnitude and root mean square of the height.
    Ssk, Sku
        Skewness and kurtosis of the heights; 3 is the kurtosis of a normal distribution.
    Sp, Sv, Sz
        Height of the highest peak, depth of the deepest valley, their sum.
    Sdq, Sdr
        Root mean square of the slope; additional area relative to the reference surface.
    waviness, noise
        Cutoffs that were applied, length units; noise = 0: none.
    area
        Area that was evaluated.
    vertices_evaluated, vertices_left_out
        Numbers of vertices that count, and of those within a cutoff of a boundary or a crease.
    error_estimate
        Estimated largest error of the filtered coordinates, length units.
    warnings
        Problems that were not errors.
    """

    height: NDArray[np.float64]
    Sa: float
    Sq: float
    Ssk: float
    Sku: float
    Sp: float
    Sv: float
    Sz: float
    Sdq: float
    Sdr: float
    waviness: float
    noise: float
    area: float
    vertices_evaluated: int
    vertices_left_out: int
    error_estimate: float
    warnings: list[str]

    @property
    def report(self) -> dict[str, Any]:
        """All numbers but the heights, for JSON."""
        names = (one.name for one in fields(self))
        return {name: getattr(self, name) for name in names if name != "height"}


@takes_options(TextureOptions)
@takes_mesh_alone
def surface_texture(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    options: TextureOptions | None = None,
    *,
    progress: Progress | None = None,
    threads: int | None = None,
    **named: Unpack[TextureKeywords],
) -> SurfaceTexture:
    """Measure how rough a surface is, whatever its shape.

    The Gaussian filters of ISO 16610-61, on the surface itself, separate the roughness: waves of
    the length of a cutoff keep half of their height. Heights are those above the low-passed
    surface, along its normals.

    A size is a string such as "2%" (of the bounding box diagonal) or "6e" (mean edges), or a length
    in the units of the mesh.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `filter_mesh`.
    options
        All options below in one object, instead of by name.
    progress, threads
        As for `filter_mesh`.
    **named

    Returns
    -------
    SurfaceTexture

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    OptionError
        When a size or the angle is out of range, or nothing is left to evaluate.
    FilterError
        When the mesh has no faces, no area, or non-finite coordinates.

    Examples
    --------
    >>> texture = surface_texture(vertices, faces, waviness=0.8, noise=0.0025)
    >>> texture.Sa, texture.Sz
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    parameters = TextureOptions.given(options, named).core_parameters()
    done = run(TextureOptions.FILTER, V, F, parameters, progress=progress, threads=threads)
    assert done.values is not None
    return SurfaceTexture(height=done.values[:, 0], **done.report)
