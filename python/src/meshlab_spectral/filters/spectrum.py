"""The geometry spectrum of a mesh: how much of its shape is in details of which size."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.calling import call_filter
from meshlab_spectral.filters.options import Boundary, LaplacianKind
from meshlab_spectral.plugin.loading import load

FILTER_NAME = "get_geometry_spectrum"
DEFAULT_BASIS_SIZE = 200

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GeometrySpectrum:
    """How much of a shape is in details of which size.

    An amplitude is the root mean square height over the surface that a part of the spectrum
    contributes to the shape, ``sqrt(energy / area)``; the amplitudes of all parts, squared, sum to
    that of the shape. Feature sizes are wavelengths, those of the filter. Lengths are in the units
    of the mesh.

    The shape is what a filter with the same boundary acts on: the positions less the centroid of
    their connected component; with a fixed boundary, less their harmonic extension from there.

    Attributes
    ----------
    diagonal
        Of the bounding box.
    default_feature_size
        What the filter takes when no feature size is given.
    area
        Of the surface, all of it.
    total_energy
        Integral over the surface of the squared lengths of the shape, length^4.
    frequencies
        Of the lowest harmonics, ascending, in radians per length unit, 0 for the constant ones; at
        least `basis_size` of them, as no group of equal frequencies is cut, or all there are.
    amplitudes
        Of these harmonics; 0 for the constant ones.
    octave_feature_sizes
        Middles of the octaves, from large to small: the diagonal times powers of two. The last one
        is the last that holds anything of the shape.
    octave_energies
        Of the octaves, length^4; they sum to `total_energy`. From one octave to the next it is half
        an octave, over which a detail counts in parts to both.
    octave_amplitudes
        ``sqrt(octave_energies / area)``.
    cumulative_energy
        Part of the energy in every octave and all larger ones, ascending to 1.
    band_feature_sizes
        Middles of thirds of octaves, from large to small: those that hold as much as 30 harmonics;
        perhaps none.
    band_amplitudes
        Of the shape in these.
    band_noise
        Amplitudes that white noise of the vertices, of height 1 across the surface, has in these;
        above 0.
    noise_height
        Root mean square height of the noise of which all details smaller than `noise_feature_size`
        are no more: noise, or what is too fine for the mesh to tell it from noise. 0 where no such
        details are seen. Up to 20 % too large, by what the shape itself has there.
    noise_feature_size
        Where that begins; 0 where it is not seen.
    feature_size_50, feature_size_90, feature_size_99
        Feature sizes at and above which 50, 90 and 99 % of the energy are.
    mismatch
        Part by which the octave energies beyond the harmonics missed their known sum before they
        were scaled to it: a measure of their error.
    """

    diagonal: float
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
    noise_feature_size: float
    feature_size_50: float
    feature_size_90: float
    feature_size_99: float
    mismatch: float

    @property
    def noise_heights(self) -> Array:
        """Heights of the vertex noise that would explain each band alone.

        They fall towards small features, and turn level where there is noise.
        """
        heights: Array = self.band_amplitudes / self.band_noise
        return heights

    @classmethod
    def from_report(cls, report: dict[str, Any]) -> GeometrySpectrum:
        """Take the filter's report, with arrays or with lists."""
        values: dict[str, Any] = {}
        for field in fields(cls):
            value = report[field.name]
            values[field.name] = np.array(value) if np.ndim(value) else float(value)
        return cls(**values)


def geometry_spectrum(
    vertices: ArrayLike,
    faces: ArrayLike,
    basis_size: int = DEFAULT_BASIS_SIZE,
    laplacian: LaplacianKind = "intrinsic delaunay",
    boundary: Boundary = "free",
) -> GeometrySpectrum:
    """Measure how much of a shape is in details of which size.

    With the harmonics ``W phi_i = omega_i^2 D phi_i`` of the mesh and its shape U, an energy
    is a sum of ``|phi_i^T D U|^2``: of single harmonics for the lowest ones, and of octaves over
    the whole spectrum.

    Parameters
    ----------
    vertices
        n x 3 coordinates, finite.
    faces
        m x 3 indices of the corners of triangles, from 0 to n - 1; any topology.
    basis_size
        How many harmonics are told one by one, the constant ones included; at least 1. Below the
        number of vertices that are not fixed, unless these are 2,000 at most.
    laplacian
        "intrinsic delaunay" works on any triangles; for "cotangent" every one needs an area.
    boundary
        Rims of an open surface and of its holes. "free": part of the shape, they add to the details
        of every size; "fixed": only what they do not determine is measured.

    Returns
    -------
    GeometrySpectrum
        In the units of the mesh.

    Raises
    ------
    ValueError
        When an array does not have the shape or the type above, or an index is out of range.
    OptionError
        When there is no such `laplacian` or `boundary`, or `basis_size` is no whole number above 0.
    FilterError
        When the mesh has no faces, no area, or coordinates that are not finite, `basis_size` is
        too large for it, or a fixed boundary leaves nothing to measure, as in a flat mesh.
    PluginError
        When the plugin cannot be loaded.

    Examples
    --------
    >>> spectrum = geometry_spectrum(mesh.vertex_matrix(), mesh.face_matrix())
    >>> for size, height in zip(spectrum.octave_feature_sizes, spectrum.octave_amplitudes):
    ...     print(f"details of {size:.3g}: {height:.3g} high")
    """
    V, F = mesh_arrays(vertices, faces)
    parameters = spectrum_parameters(basis_size, laplacian, boundary)
    return GeometrySpectrum.from_report(measure(V, F, parameters))


def measure(
    V: Array, F: NDArray[Any], parameters: dict[str, Any], verbose: bool = False
) -> dict[str, Any]:
    """Apply the filter to a mesh; its report. With `verbose`, MeshLab writes its log."""
    load()
    import pymeshlab

    mesh_set = pymeshlab.MeshSet(verbose=verbose)
    mesh_set.add_mesh(pymeshlab.Mesh(V, F))
    return call_filter(mesh_set, FILTER_NAME, parameters)


def spectrum_parameters(basis_size: int, laplacian: str, boundary: str) -> dict[str, Any]:
    """Check the options of the filter, and name them as pymeshlab does.

    Raises
    ------
    OptionError
        When one has a value that it cannot take.
    """
    if isinstance(basis_size, bool) or not isinstance(basis_size, int) or basis_size < 1:
        raise OptionError(f"basis_size = {basis_size}: must be a whole number, at least 1")
    for name, value, kind in (
        ("laplacian", laplacian, LaplacianKind),
        ("boundary", boundary, Boundary),
    ):
        if value not in get_args(kind):
            raise OptionError(f"{name} = {value}: choose {', '.join(get_args(kind))}")
    return {"basis_size": basis_size, "laplacian": laplacian, "boundary": boundary}
