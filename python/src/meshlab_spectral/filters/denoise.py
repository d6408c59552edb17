"""Spectral Denoise: its options, and the filter on NumPy arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.filters.calling import filtered_arrays
from meshlab_spectral.filters.option_types import Length, Limits, Options, option
from meshlab_spectral.filters.options import Boundary
from meshlab_spectral.plugin.loading import DENOISE_NAME


@dataclass(frozen=True, kw_only=True)
class DenoiseOptions(Options):
    """Options of Spectral Denoise, with the names and defaults they have in MeshLab.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    FILTER = DENOISE_NAME
    TABLE = "denoise"

    strength: float = option(
        1.0,
        "1 removes the noise as measured; more removes finer details, too; less leaves some noise.",
        Limits(0),
    )
    noise_height: Length = option(
        Length(automatic=True),
        "Standard deviation of the noise: a length such as 0.02, mean edge lengths such as 0.2e, a "
        "percentage of the model's diagonal, or auto: as measured.",
    )
    noise_size: Length = option(
        Length(automatic=True),
        "How far the noise of neighbouring vertices is alike, half the width of its bumps, such as "
        "2e; up to 1e it differs from vertex to vertex. auto: as measured.",
    )
    selected: bool = option(
        False,
        "Denoise only the selected faces and vertices, fading out around them within four edges.",
    )
    keep_creases: bool = option(True, "Do not smooth across edges.")
    boundary: Boundary = option(
        "free",
        "Boundary of an open surface, holes included: free lets it follow along its normals, fixed "
        "keeps it exactly in place.",
    )


def denoise_mesh(
    vertices: ArrayLike, faces: ArrayLike, options: DenoiseOptions | None = None, **named: Any
) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Find out what kind of noise a mesh has, and remove it; without noise, nothing moves.

    Parameters
    ----------
    vertices
        n x 3 coordinates, finite.
    faces
        m x 3 indices of the corners of triangles, from 0 to n - 1; any topology and orientation.
    options
        All options in one object, or
    **named
        fields of `DenoiseOptions` by name.

    Returns
    -------
    V : array
        n x 3 denoised coordinates; the faces do not change.
    report : dict
        "summary" says in one line what was found and done, such as "scanner noise: height 0.08
        edges (0.012), size 2.1 edges (0.31): removed". Numbers, in the units of the mesh:
        `noise_height` and `noise_size` of what was removed, both 0 if nothing was; as measured
        `estimated_noise_height`, `estimated_noise_size` and `noise_correlation` of neighbours;
        `spikes`, a number of vertices; `voxel_size` along each axis; `mean_edge`,
        `max_displacement`, `rms_displacement` and others. "warnings" lists what fell short and
        what to do about it; that nothing has changed is one.

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    OptionError
        When an option is unknown or has an invalid value.
    FilterError
        When the filter rejects the mesh: no faces, no area, or non-finite coordinates.
    PluginError
        When the plugin cannot be loaded.

    Examples
    --------
    >>> V, report = denoise_mesh(vertices, faces)
    >>> print(report["summary"])
    """
    mesh_set, report = filtered_arrays(vertices, faces, DenoiseOptions.given(options, named))
    return mesh_set.current_mesh().vertex_matrix().copy(), report
