"""
Denoise a scan
==============

Remove the noise of a scanner and keep the shape, without parameters.

A clean mesh with added noise serves as the scan, so that the result can be compared with the
truth: the noise is a fifth of a mean edge length.
"""

from pathlib import Path

import meshlab_spectral as spectral
import numpy as np
import pymeshlab
import pyvista

samples = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
truth = pyvista.read(samples / "bunny.obj")
edge = spectral.geometry_spectrum(truth).mean_edge
noise = 0.2 * edge * np.random.default_rng(1).normal(size=truth.points.shape)
scan = truth.copy()
scan.points = truth.points + noise

# %%
# Detect and remove
# -----------------
# ``denoise_mesh`` finds out what kind of noise there is, how high it is, and where. It returns
# the mesh and a report.

clean, report = spectral.denoise_mesh(scan)
print(report["summary"])

# %%
# Before, after, and the truth:

meshes = {"scan": scan, "denoised": clean, "truth": truth}
plotter = pyvista.Plotter(shape=(1, 3), window_size=(1500, 500), border=False)
for column, (name, mesh) in enumerate(meshes.items()):
    plotter.subplot(0, column)
    plotter.add_mesh(mesh, color="lightsteelblue")
    plotter.add_text(name, font_size=12)
plotter.link_views()
plotter.view_xy()
plotter.camera.zoom(1.3)
plotter.show()

# %%
# Measure
# -------
# How a surface looks depends on its normals, so the mean angle to the true ones is measured
# first, then the distance from the true surface, as a root mean square along its normals.

for name, mesh in {"before": scan, "after": clean}.items():
    cosines = (mesh.face_normals * truth.face_normals).sum(axis=1)
    angle = np.degrees(np.arccos(np.clip(cosines, -1, 1))).mean()
    distance = spectral.compare(truth, mesh).deviations["normal"].rms
    print(f"{name}: {angle:.1f} degrees, {distance / edge:.3f} edges")

# %%
# What is not noise stays
# -----------------------
# The denoised bunny has no noise left, and is returned bit-for-bit unchanged.

again, report = spectral.denoise_mesh(clean)
print("unchanged:", np.array_equal(again.points, clean.points))
