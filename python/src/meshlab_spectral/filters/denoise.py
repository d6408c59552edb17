"""Spectral Denoise: its options, and the filter on arrays and meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypedDict

from numpy.typing import ArrayLike

from meshlab_spectral.filters.calling import filtered, given_back
from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.option_types import Length, Limits, Options, option
from meshlab_spectral.filters.options import Boundary, Size
from meshlab_spectral.plugin.loading import DENOISE_NAME

if TYPE_CHECKING:
    from typing_extensions import Unpack


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
        "Distance over which the noise is correlated, half the width of its bumps, such as 2e; up "
        "to 1e it is independent at each vertex. auto: as measured.",
    )
    selected: bool = option(
        False,
        "Denoise only the selected faces and vertices, fading out around them within four edges.",
    )
    keep_creases: bool = option(True, "Do not smooth across creases; off: creases are rounded.")
    boundary: Boundary = option(
        "free",
        "Boundary of an open surface, holes included: free lets it follow along its normals, fixed "
        "keeps it exactly in place.",
    )


class DenoiseKeywords(TypedDict, total=False):
    """All fields of `DenoiseOptions`."""

    strength: float
    noise_height: Size
    noise_size: Size
    selected: bool
    keep_creases: bool
    boundary: Boundary


@takes_options(DenoiseOptions)
def denoise_mesh(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    options: DenoiseOptions | None = None,
    *,
    selection: ArrayLike | None = None,
    **named: Unpack[DenoiseKeywords],
) -> tuple[Any, dict[str, Any]]:
    """Detect what kind of noise a mesh has, and remove it; without noise, nothing moves.

    Parameters
    ----------
    mesh_or_vertices
        Finite n x 3 coordinates, or a pyvista, trimesh, meshio, Open3D or pymeshlab triangle mesh.
    faces
        With coordinates: m x 3 vertex indices of triangles, from 0 to n - 1; any topology and
        orientation.
    options
        All options below in one object, instead of by name.
    selection
        What to denoise: n booleans, one per vertex, or indices of faces; around it, the effect
        fades out within four edges.
    **named

    Returns
    -------
    denoised
        n x 3 coordinates, or a mesh of the type passed, with its data; the faces do not change.
    report : dict
        "summary" says in one line what was found and done, such as "scanner noise: height 0.08
        edges (0.012), size 2.1 edges (0.31): removed". Numbers, lengths in the units of the mesh:
        `noise_height` and `noise_size` of the removed noise, both 0 if none was; the measured
        `estimated_noise_height`, `estimated_noise_size` and `noise_correlation` of neighbours;
        `spikes`, a number of vertices; `voxel_size` along each axis; `mean_edge`,
        `max_displacement`, `rms_displacement` and others. "warnings" lists problems and what to
        do about them, and says so if nothing has changed.

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    TypeError
        When the mesh is of none of these libraries.
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
    parameters = DenoiseOptions.given(options, named)
    mesh_set, report = filtered(mesh_or_vertices, faces, parameters, selection=selection)
    return given_back(mesh_or_vertices, mesh_set), report
