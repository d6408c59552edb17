"""`mesh.spectral` of PyVista's meshes, which finds this module by its entry point, from 0.48 on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pyvista

from meshlab_spectral.filters.denoise import denoise_mesh
from meshlab_spectral.filters.fractional import filter_mesh
from meshlab_spectral.filters.harmonics import Harmonics, manifold_harmonics
from meshlab_spectral.filters.running import plain
from meshlab_spectral.filters.signals import filter_colors, filter_scalars
from meshlab_spectral.filters.spectrum import GeometrySpectrum, geometry_spectrum
from meshlab_spectral.filters.texture import SurfaceTexture, surface_texture


@pyvista.register_dataset_accessor("spectral", pyvista.UnstructuredGrid)
@pyvista.register_dataset_accessor("spectral", pyvista.PolyData)
class SpectralAccessor:
    """The functions of this package as methods of a mesh; their options and errors are the same.

    Those that return a mesh leave this one as it is, so they can be chained, but for `filter` and
    `denoise` with ``inplace=True``; ``progress_bar=True`` of these is ``progress=True``. The report
    is in ``user_dict["spectral"]`` of the mesh returned.

    Examples
    --------
    >>> mesh.spectral.denoise().spectral.filter(feature_size="2%").plot()
    """

    def __init__(self, mesh: pyvista.DataSet) -> None:
        self._mesh = mesh

    def filter(self, **options: Any) -> pyvista.DataSet:
        """Return the filtered mesh: `filter_mesh`."""
        return self._moved(filter_mesh, **options)

    def denoise(self, **options: Any) -> pyvista.DataSet:
        """Return the mesh without its noise: `denoise_mesh`."""
        return self._moved(denoise_mesh, **options)

    def filter_scalars(self, name: str, **options: Any) -> pyvista.DataSet:
        """Return a mesh whose point array of this name is filtered: `filter_scalars`."""
        return self._with_array(name, *filter_scalars(self._mesh, values=name, **options))

    def filter_colors(self, name: str, **options: Any) -> pyvista.DataSet:
        """Return a mesh whose point array of colours is filtered: `filter_colors`."""
        return self._with_array(name, *filter_colors(self._mesh, colors=name, **options))

    def harmonics(self, basis_size: int, **options: Any) -> Harmonics:
        """Compute the lowest harmonics: `manifold_harmonics`."""
        return manifold_harmonics(self._mesh, None, basis_size, **options)

    def spectrum(self, **options: Any) -> GeometrySpectrum:
        """Measure how much of the shape lies in details of each size: `geometry_spectrum`."""
        return geometry_spectrum(self._mesh, **options)

    def texture(self, **options: Any) -> SurfaceTexture:
        """Measure the roughness: `surface_texture`."""
        return surface_texture(self._mesh, **options)

    def _moved(
        self,
        function: Callable[..., Any],
        *,
        inplace: bool = False,
        progress_bar: bool = False,
        **options: Any,
    ) -> pyvista.DataSet:
        """Apply a function; `inplace` and `progress_bar` are those of PyVista's own filters."""
        if progress_bar:
            options["progress"] = True
        moved = _with_report(*function(self._mesh, **options))
        if not inplace:
            return moved
        self._mesh.copy_from(moved)
        return self._mesh

    def _with_array(self, name: str, values: Any, report: Any) -> pyvista.DataSet:
        mesh = self._mesh.copy()
        mesh.point_data[name] = np.asarray(values)
        return _with_report(mesh, report)


def _with_report(mesh: pyvista.DataSet, report: Any) -> pyvista.DataSet:
    mesh.user_dict["spectral"] = plain(report)
    return mesh
