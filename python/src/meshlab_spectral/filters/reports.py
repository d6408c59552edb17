"""The reports of the filters: entries, their meaning, their units.

Written by python/write_options.py from the tables in plugin/core/contract: edit those.
"""

from __future__ import annotations

from typing import TypedDict


class _WarningReport(TypedDict):
    warnings: list[str]
    """Problems that were not errors, and what to do about them."""
    warning_codes: list[str]
    """For each of them, what it is about."""


class _ShapeReport(_WarningReport):
    folded_faces: int
    """Number of faces that have folded over: turned against the input and the faces around them, of
    more than 1 % of the mean area."""
    has_volume: bool
    """Whether the surface is closed and consistently oriented."""
    limited_share: float
    """Share of the surface, 0 to 1, at which the bound on it was reached."""
    max_displacement: float
    """Largest displacement of a vertex, length."""
    mean_edge: float
    """Mean edge, length."""
    preserved_volumes: int
    """Number of closed components whose volume was preserved."""
    rms_displacement: float
    """Root mean square of the displacements, length."""
    volume_after: float
    """Signed volume of the filtered surface, length³; meaningless unless `has_volume`."""
    volume_before: float
    """Signed volume of the surface, length³; meaningless unless `has_volume`."""


class _SolvedReport(_WarningReport):
    accuracy_reached: bool
    """Whether the evaluation reached its accuracy."""
    cutoff_frequency: float
    """2 π / feature size, radians per length."""
    error_estimate: float
    """Estimated error of the evaluation, relative to the size of what is filtered."""
    factorizations: int
    """Number of sparse factorizations."""
    feature_size: float
    """As applied, length."""
    solves: int
    """Number of solves with one right-hand side."""


class _SurfaceReport(_WarningReport):
    components: int
    """Number of connected components of the surface."""
    fixed_vertices: int
    """Number of vertices on a fixed boundary or a crease, unchanged."""
    joined_vertices: int
    """Number of vertices at seams that were joined to another."""
    unreferenced_vertices: int
    """Number of vertices without faces, unchanged."""


class _FilterReport(_ShapeReport, _SolvedReport, _SurfaceReport):
    area_after: float
    """Of the filtered surface, length²."""
    area_before: float
    """Of the surface, length²."""
    passes: int
    """Passes of automatic steps: this number repeats the run exactly; 0: not automatic."""
    products: int
    """Number of products of the Laplacian with one coordinate, in place of solves."""
    rounded_creases: float
    """Largest displacement along sharp edges, which `crease_angle` 50 keeps, length; 0 where they
    hardly moved farther than the rest."""
    shrunken_part: float
    """Share of the surface, 0 to 1, that shrinks to lines or points."""
    singular_part: float
    """Share of the surface, 0 to 1, on which `tolerance` was not reached."""
    step_error: float
    """With automatic steps, estimated error over all but a thousandth of the input surface, without
    what collapses, length."""
    step_sizes: list[float]
    """Fractional powers of the steps, in order; their sum is 1."""
    steps: int
    """Number of steps; with automatic steps, of the last pass."""
    thin_part_factor: float
    """At the default size, by how much the thinnest part exceeds it, squared; above 2, thin parts
    are kept."""
    tolerance_reached: bool
    """With automatic steps, whether all but a thousandth of the input surface is within
    `tolerance`, what collapses included."""


class FilterReport(_FilterReport, total=False):
    """Report of `filter_mesh`; lengths are in the units of the mesh."""

    computed_bases: int
    """Number of bases computed in all steps."""
    cutoff_reached: bool
    """Whether the harmonics reach the cutoff frequency."""
    eigenvalues: list[float]
    """Of the last basis that was computed, ascending, 1 / length²."""
    inertia_count: int
    """Number of harmonics that the basis must hold, by Sylvester's law; 0 if unneeded."""
    residuals: list[float]
    """Residuals of the harmonics, relative."""


class _DenoiseReport(_ShapeReport, _SurfaceReport):
    estimated_noise_height: float
    """Measured standard deviation of the noise along the normals, length."""
    estimated_noise_size: float
    """Measured distance over which the noise is correlated, length."""
    noise_correlation: float
    """Measured correlation between neighbouring vertices; above 0.2 it is shape."""
    noise_height: float
    """Of the noise that was filtered or found, length; 0: none."""
    noise_kind: str
    """White, correlated (of a scanner), impulses, scan_lines, rounded (coordinates), local (in some
    regions) or voxels; without noise: none, shape (it may be noise), tessellation (of CAD),
    stretched (axis), or too_few (vertices)."""
    noise_searched: bool
    """Whether the mesh was searched for noise: not if it has needle triangles, voxels or too few
    vertices."""
    noise_share: float
    """Share of the surface with noise, 0 to 1."""
    noise_size: float
    """Of the noise that was filtered, length; 0: independent at every vertex, or none."""
    rounds: int
    """Number of weak filters that were applied to the normals; 0: nothing changed."""
    spikes: int
    """Number of vertices off the surface that were put back."""
    voxel_size: list[float]
    """Of the volume that was segmented, along each axis, length; 0: none."""
    summary: str
    """What was found and done, in one line."""


class DenoiseReport(_DenoiseReport, total=False):
    """Report of `denoise_mesh`; lengths are in the units of the mesh."""

    noise_heights: list[float]
    """With `store_noise_height`, height of the noise at each of the n vertices, length; 0: none."""


class ScalarsReport(_WarningReport, total=False):
    """Report of `filter_scalars`; lengths are in the units of the mesh."""

    columns: list[ScalarsReport]
    """Of values n x k, their k reports, in place of these."""
    accuracy_reached: bool
    """Whether the evaluation reached its accuracy."""
    components: int
    """Number of connected components of the surface."""
    cutoff_frequency: float
    """2 π / feature size, radians per length."""
    error_estimate: float
    """Estimated error of the evaluation, relative to the size of what is filtered."""
    factorizations: int
    """Number of sparse factorizations."""
    feature_size: float
    """As applied, length."""
    fixed_vertices: int
    """Number of vertices on a fixed boundary or a crease, unchanged."""
    joined_vertices: int
    """Number of vertices at seams that were joined to another."""
    max_change: float
    """Largest change of a value, in its units (colours: levels of 0 to 255)."""
    rms_change: float
    """Root mean square of the changes over the surface, in the units of the values."""
    solves: int
    """Number of solves with one right-hand side."""
    unreferenced_vertices: int
    """Number of vertices without faces, unchanged."""
    vertices_without_data: int
    """Number of vertices whose value is NaN, unchanged."""


class ColorsReport(_SolvedReport, _SurfaceReport):
    """Report of `filter_colors`; lengths are in the units of the mesh."""

    clamped_values: int
    """Number of red, green and blue levels that were clamped to 0 to 255."""
    max_change: float
    """Largest change of a value, in its units (colours: levels of 0 to 255)."""
    rms_change: float
    """Root mean square of the changes over the surface, in the units of the values."""
    vertices_without_data: int
    """Number of vertices whose value is NaN, unchanged."""


class _TextureReport(_WarningReport):
    Sa: float
    """Mean of the magnitude of the height, length."""
    Sdq: float
    """Root mean square of the slope."""
    Sdr: float
    """Additional area of the texture, relative to that of the reference surface."""
    Sk: float
    """Height of the core, length."""
    Sku: float
    """Kurtosis of the heights, 3 if they are normally distributed."""
    Smr1: float
    """Share of the area above the core, 0 to 1."""
    Smr2: float
    """Share of the area above the lower end of the core, 0 to 1."""
    Sp: float
    """Height of the highest peak, length."""
    Spk: float
    """Reduced height of the peaks above the core, length."""
    Sq: float
    """Root mean square of the height, length."""
    Sq_left_out: float
    """Root mean square height of those near a boundary, length; 0: none."""
    Ssk: float
    """Skewness of the heights."""
    Sv: float
    """Depth of the deepest valley, length."""
    Svk: float
    """Reduced depth of the valleys below the core, length."""
    Sz: float
    """From the deepest valley to the highest peak, length."""
    area: float
    """Of the reference surface where it is evaluated, length²."""
    bearing_heights: list[float]
    """Bearing curve (Abbott-Firestone): the heights that 0, 1, ..., 100 % of the area exceed,
    length."""
    error_estimate: float
    """Estimated root mean square error of the heights, length."""
    histogram_heights: list[float]
    """Centres of the 64 bins of the histogram, ascending, length."""
    histogram_shares: list[float]
    """Share of the area with a height in each of these bins."""
    noise: float
    """Cutoff of the S-filter, length; 0: none."""
    vertices_evaluated: int
    """Number of vertices that count."""
    vertices_left_out: int
    """Number of selected vertices within a cutoff of a boundary or a crease, or not on the fitted
    shape, as the caps of a cylinder."""
    vertices_too_thin: int
    """Number of others on parts thinner than the waviness cutoff, left out, too."""
    waviness: float
    """Cutoff of the L-filter, length."""


class TextureReport(_TextureReport, total=False):
    """Report of `SurfaceTexture`; lengths are in the units of the mesh."""

    Sal: float
    """Of a height map: shortest lag at which the autocorrelation falls to .2, length."""
    Str: float
    """Of a height map: Sal over the longest such lag, 1 without a direction; none if that is longer
    than half of the map."""
    form_radius: float
    """Of the sphere or cylinder that was fitted, length."""
    unit: str
    """What a length is, if the file says so."""
