"""
Shape analysis
==============

Manifold harmonics, signatures of vertices and the Shape-DNA of a whole shape.
"""

from pathlib import Path

import meshlab_spectral as spectral
import numpy as np
import pymeshlab
import pyvista

samples = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
bunny = pyvista.read(samples / "bunny.obj")

# %%
# Harmonics
# ---------
# The harmonics of a surface are its standing waves, from low to high frequencies. They are what
# sines and cosines are to a line: every function on the surface is a sum of them.

basis = spectral.manifold_harmonics(bunny, basis_size=200)
plotter = spectral.plot_harmonics(bunny, None, basis, [1, 2, 5, 20])
plotter.show()

# %%
# The bunny itself, as the sum of its first 20, 60 and 200 harmonics:

V = np.asarray(bunny.points, dtype=float)
coefficients = basis.project(V)
plotter = pyvista.Plotter(shape=(1, 3), window_size=(1500, 500), border=False)
for column, count in enumerate((20, 60, 200)):
    kept = np.where(np.arange(200)[:, None] < count, coefficients, 0)
    mesh = bunny.copy()
    mesh.points = basis.reconstruct(kept)
    mesh.point_data.clear()
    plotter.subplot(0, column)
    plotter.add_mesh(mesh, color="lightsteelblue")
    plotter.add_text(f"{count} harmonics", font_size=12)
plotter.link_views()
plotter.view_xy()
plotter.camera.zoom(1.3)
plotter.show()

# %%
# Signatures
# ----------
# The heat kernel signature is how much heat is left at a vertex after a time. It depends on
# distances along the surface alone, so that it stays the same when a shape moves or bends:
# tips, such as ears and tail, stand out.

heat = basis.heat_kernel_signature()
plotter = pyvista.Plotter(window_size=(700, 600))
title = {"title": "logarithm of the heat"}
plotter.add_mesh(bunny, scalars=np.log(heat[:, 8]), cmap="viridis", scalar_bar_args=title)
plotter.view_xy()
plotter.camera.zoom(1.3)
plotter.show()

# %%
# Shape-DNA
# ---------
# The lowest eigenvalues identify a shape, whatever its place, size and triangles. The coarse
# bunny has a fifth of the vertices, and is larger and turned:

coarse = bunny.decimate(0.8).rotate_x(40).scale(3)
sphere = pyvista.Icosphere(nsub=4)
expected = spectral.shape_dna(bunny, count=10)[1:]
for name, shape in {"coarse bunny": coarse, "sphere": sphere}.items():
    dna = spectral.shape_dna(shape, count=10)[1:]
    difference = 100 * np.abs(dna / expected - 1).mean()
    print(f"{name} of {shape.n_points} vertices: differs by {difference:.1f} %")
