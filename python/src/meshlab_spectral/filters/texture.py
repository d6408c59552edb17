"""How rough a surface is: roughness separated from waviness and form, on arrays and meshes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mesh_arrays, selected_vertices
from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.options import TextureKeywords, TextureOptions
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.reports import TextureReport
from meshlab_spectral.filters.representations import brief, line, table
from meshlab_spectral.filters.running import plain, run

if TYPE_CHECKING:
    from typing_extensions import Unpack


@dataclass(frozen=True, eq=False)
class SurfaceTexture:
    """The roughness of a surface, with the parameters of ISO 25178-2.

    Lengths are in the units of the mesh; means are over the reference surface. Besides `height`,
    the attributes are the entries of `TextureReport`, arrays in place of its lists; None or ""
    where there is no such number. `Sal` and `Str` are of height maps, whose vertices are on a
    regular grid.

    Attributes
    ----------
    height
        Height of each of the n vertices above the reference surface, along its normal; 0 where
        nothing is evaluated.
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
    Sk: float
    Spk: float
    Svk: float
    Smr1: float
    Smr2: float
    waviness: float
    noise: float
    area: float
    histogram_heights: NDArray[np.float64]
    histogram_shares: NDArray[np.float64]
    bearing_heights: NDArray[np.float64]
    vertices_evaluated: int
    vertices_left_out: int
    Sq_left_out: float
    vertices_too_thin: int
    error_estimate: float
    warnings: list[str]
    warning_codes: list[str]
    Sal: float | None = None
    Str: float | None = None
    form_radius: float | None = None
    unit: str = ""

    def material_ratio(self, height: ArrayLike) -> NDArray[np.float64]:
        """Return Smr(c): shares of the area, 0 to 1, that are at least as high as `height`.

        Interpolated in `bearing_heights`, and so to half a percent. Heights of any shape, length
        units above the reference surface; NaN for those that are not finite.
        """
        c = np.asarray(height, dtype=np.float64)
        heights, shares = self.bearing_heights[::-1], np.linspace(1, 0, len(self.bearing_heights))
        return np.where(np.isfinite(c), np.interp(c, heights, shares, left=1, right=0), np.nan)

    @property
    def report(self) -> TextureReport:
        """All numbers but the heights of the vertices, for JSON."""
        numbers = {one.name: getattr(self, one.name) for one in fields(self)}
        del numbers["height"]
        for name in ("Sal", "Str", "form_radius", "unit"):
            if not numbers[name]:
                del numbers[name]
        return cast(TextureReport, plain(numbers))

    def __repr__(self) -> str:
        return line(self)

    def _repr_html_(self) -> str:
        return table((one.name, brief(getattr(self, one.name))) for one in fields(self))


# What the standard calls the cutoffs.
_STANDARD = {"nesting_index_l": "waviness", "nesting_index_s": "noise"}


def _by_our_names(named: Mapping[str, object]) -> dict[str, object]:
    """Return options whose names may be those of the standard; OptionError if one is twice."""
    ours = {_STANDARD.get(name, name): value for name, value in named.items()}
    if len(ours) < len(named):
        twice = ", ".join(f"{name} = {_STANDARD[name]}" for name in named if name in _STANDARD)
        raise OptionError(f"{twice}: give one of the two")
    return ours


@takes_options(TextureOptions)
@takes_mesh_alone
def surface_texture(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    options: TextureOptions | None = None,
    *,
    selection: ArrayLike | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[TextureKeywords],
) -> SurfaceTexture:
    """Measure how rough a surface is, whatever its shape.

    The Gaussian filters of ISO 16610-61, on the surface itself, separate the roughness: waves of
    the length of a cutoff keep half of their height. Heights are those above the low-passed
    surface, along its normals.

    A size is a string such as "2%" (of the bounding box diagonal) or "6e" (mean edges), or a length
    in the units of the mesh. `waviness` and `noise` may be given by the names of the standard,
    `nesting_index_l` and `nesting_index_s`.

    End effects: nothing within a cutoff of a boundary or a crease counts. Holes of up to a quarter
    of a cutoff are points missing instead: there the filters see the mean of their rims.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `filter_mesh`.
    options
        All options below in one object, instead of by name.
    selection
        What to measure, and fit a plane, sphere or cylinder to: n booleans, one per vertex, or
        indices of faces.
    progress, threads
        As for `filter_mesh`.
    **named

    Returns
    -------
    SurfaceTexture

    Raises
    ------
    SpectralError
        As from `filter_mesh`: an OptionError when a size or the angle is out of range, or nothing
        is left to evaluate.

    Examples
    --------
    >>> texture = surface_texture(vertices, faces, waviness=0.8, noise=0.0025)
    >>> texture.Sa, texture.Sz
    >>> bore = surface_texture(vertices, faces, form="cylinder", selection=faces_of_the_bore)
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    parameters = TextureOptions.from_call(options, _by_our_names(named)).core_parameters()
    selected = selected_vertices(mesh_or_vertices, selection, len(V), F, parameters)
    done = run(
        TextureOptions.FILTER,
        V,
        F,
        parameters,
        selected=selected,
        progress=progress,
        threads=threads,
    )
    assert done.values is not None
    return SurfaceTexture(height=done.values[:, 0], **done.report)
