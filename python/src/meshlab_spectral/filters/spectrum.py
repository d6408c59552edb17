"""The geometry spectrum of a mesh: its energy by feature size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.options import Boundary, LaplacianKind, SpectrumOptions
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.representations import table
from meshlab_spectral.filters.running import run

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GeometrySpectrum:
    """The distribution of a shape over feature sizes.

    An amplitude is the root mean square height that a part of the spectrum contributes to the
    shape, ``sqrt(energy / area)``; the squared amplitudes of all parts sum to that of the shape.
    Feature sizes are wavelengths, as in the filter. Lengths are in the units of the mesh.

    The shape is what a filter with the same boundary acts on: the positions relative to the
    centroid of their connected component or, with a fixed boundary, to the harmonic extension of
    the boundary.

    Attributes
    ----------
    diagonal
        Diagonal of the bounding box of all vertices, to which percentages refer.
    mean_edge
        Mean edge length.
    default_feature_size
        The filter's default feature size for this mesh.
    area
        Total surface area.
    total_energy
        Surface integral of the squared length of the shape, length^4.
    frequencies
        Frequencies of the lowest harmonics, ascending, radians per length unit, 0 for constants. At
        least `basis_size` of them, since groups of equal frequencies are not split, or all that
        exist; empty if `basis_size` is 0.
    amplitudes
        Amplitudes of these harmonics; 0 for constants.
    octave_feature_sizes
        Centres of the octaves, descending, down to the last octave with any energy: the diagonal,
        without vertices that no face uses, times powers of two.
    octave_energies
        Energies of the octaves, length^4; they sum to `total_energy`. Adjacent octaves overlap by
        half an octave, in which a detail is shared between them.
    octave_amplitudes
        ``sqrt(octave_energies / area)``.
    cumulative_energy
        Fraction of the energy in each octave and all larger ones, ascending to 1.
    band_feature_sizes
        Centres of the third-octave bands with at least 30 harmonics, descending; may be empty.
    band_amplitudes
        Amplitudes of the shape in these bands.
    band_noise
        Amplitudes in these bands of white vertex noise of height 1 across the surface; > 0.
    noise_height
        Height of the noise that `denoise_mesh` would remove; 0 if there is none. Details too fine
        for the mesh to tell from noise are none.
    noise_summary
        What noise that is, in words, or why none was found. Empty if made from pymeshlab's report.
    noise_feature_size
        In details smaller than this there is more noise than shape; 0 if in none.
    feature_size_50, feature_size_90, feature_size_99
        Feature sizes above which 50, 90 and 99 % of the energy lie.
    mismatch
        Fraction of the energy that may belong to another octave: the estimated error of the
        energies beyond the harmonics, and the energies of harmonics times their relative residuals.
        Above 0.01 the filter warns.
    """

    diagonal: float
    mean_edge: float
    default_feature_size: float
    area: float
    total_energy: float
    frequencies: Array
    amplitudes: Array
    octave_feature_sizes: Array
    octave_energies: Array
    octave_amplitudes: Array
    cumulative_energy: Array
    band_feature_sizes: Array
    band_amplitudes: Array
    band_noise: Array
    noise_height: float
    noise_summary: str
    noise_feature_size: float
    feature_size_50: float
    feature_size_90: float
    feature_size_99: float
    mismatch: float

    def __repr__(self) -> str:
        shown = ", ".join(
            f"{name}={getattr(self, name):.4g}"
            for name in ("area", "diagonal", "mean_edge", "noise_height", "feature_size_99")
        )
        return f"GeometrySpectrum({len(self.octave_feature_sizes)} octaves, {shown})"

    def _repr_html_(self) -> str:
        octaves = zip(self.octave_feature_sizes, self.octave_amplitudes, strict=True)
        return table(
            [
                (f"{size:.3g}", f"{100 * size / self.diagonal:.3g} %", f"{height:.3g}")
                for size, height in octaves
            ],
            ("feature size", "of the diagonal", "height of its details"),
        )

    @property
    def noise_heights(self) -> Array:
        """Heights of the vertex noise that would explain each band on its own.

        They fall towards small features and level off where there is noise.
        """
        heights: Array = self.band_amplitudes / self.band_noise
        return heights

    @classmethod
    def from_report(cls, report: Mapping[str, Any]) -> GeometrySpectrum:
        """Convert the filter's report, with arrays or lists."""
        values: dict[str, Any] = {}
        for field in fields(cls):
            if field.name != "noise_summary":
                value = report[field.name]
                values[field.name] = np.array(value) if np.ndim(value) else float(value)
        return cls(**values, noise_summary=report.get("summary", ""))


@takes_mesh_alone
def geometry_spectrum(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    basis_size: int = SpectrumOptions.basis_size,
    laplacian: LaplacianKind = "intrinsic delaunay",
    boundary: Boundary = "free",
    *,
    progress: Progress | bool | None = None,
    threads: int | None = None,
) -> GeometrySpectrum:
    """Measure the geometry spectrum of a mesh.

    With the harmonics ``W phi_i = omega_i^2 D phi_i`` of the mesh and its shape U, an energy is a
    sum of ``|phi_i^T D U|^2``: over each octave of the whole spectrum, to about a percent, and, on
    request, for each harmonic of the lowest frequencies.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `filter_mesh`.
    basis_size
        Number of harmonics to measure individually, including constants, which takes most of the
        time; 0 for the octaves alone. Less than the number of vertices not fixed if there are more
        than 2,000 of these.
    laplacian
        "intrinsic delaunay" works with any triangles; "cotangent" needs non-degenerate ones;
        "uniform" uses the connectivity only.
    boundary
        Boundary of an open surface. "free": part of the shape, it contributes at every size;
        "fixed": measures the shape relative to the harmonic extension of the boundary.
    progress, threads
        As for `filter_mesh`.

    Returns
    -------
    GeometrySpectrum
        In the units of the mesh.

    Raises
    ------
    SpectralError
        As from `filter_mesh`: an OptionError when `basis_size` is not an integer >= 0, a
        FilterError when it is too large, or a fixed boundary leaves nothing to measure, as in a
        flat mesh.

    Examples
    --------
    >>> spectrum = geometry_spectrum(mesh.vertex_matrix(), mesh.face_matrix())
    >>> for size, height in zip(spectrum.octave_feature_sizes, spectrum.octave_amplitudes):
    ...     print(f"details of {size:.3g}: {height:.3g} high")
    """
    options = SpectrumOptions(basis_size=basis_size, laplacian=laplacian, boundary=boundary)
    V, F = mesh_arrays(mesh_or_vertices, faces)
    return GeometrySpectrum.from_report(measure(V, F, options, progress, threads))


def measure(
    V: Array,
    F: NDArray[Any],
    options: SpectrumOptions,
    progress: Progress | bool | None = None,
    threads: int | None = None,
) -> dict[str, Any]:
    """Run the filter on validated arrays and return its report."""
    parameters = options.core_parameters()
    return run(options.FILTER, V, F, parameters, progress=progress, threads=threads).report
