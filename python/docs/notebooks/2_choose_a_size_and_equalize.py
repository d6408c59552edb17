"""
Choose a size, and equalize
===========================

Look at the spectrum, choose a feature size, filter, see what was removed, and set the gain of
each size.
"""

from pathlib import Path

import meshlab_spectral as spectral
import numpy as np
import pymeshlab
import pyvista

samples = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
bunny = pyvista.read(samples / "bunny.obj")
edge = spectral.geometry_spectrum(bunny).mean_edge
noise = 0.2 * edge * np.random.default_rng(1).normal(size=bunny.points.shape)
scan = bunny.copy()
scan.points = bunny.points + noise


def show(meshes, **options):
    """Draw meshes next to each other, from the front."""
    count = len(meshes)
    plotter = pyvista.Plotter(
        shape=(1, count), window_size=(max(500 * count, 700), 500), border=False
    )
    for column, (name, mesh) in enumerate(meshes.items()):
        plotter.subplot(0, column)
        plotter.add_mesh(mesh, **({"color": "lightsteelblue"} | options))
        plotter.add_text(name, font_size=12)
    plotter.link_views()
    plotter.view_xy()
    plotter.camera.zoom(1.3)
    plotter.show()


# %%
# Look first
# ----------
# The spectrum says how high the details of each size are. A size is a wavelength, a bump and
# the hollow next to it, in percent of the diagonal of the bounding box; a height is a root mean
# square over the surface.

spectrum = spectral.geometry_spectrum(scan)
figure = spectral.plot_spectrum(spectrum)

# %%
# The lower plot says how high noise would have to be to explain the details of each size. Where
# the curve becomes flat, the noise begins:

print(f"noise: {spectrum.noise_height / spectrum.mean_edge:.2f} edges high")
below = spectrum.noise_feature_size / spectrum.diagonal
print(f"it dominates below {100 * below:.1f} %")

# %%
# Filter
# ------
# A low-pass removes what is smaller than its feature size. One and a half times the size at
# which the noise begins is a good start.

size = 1.5 * spectrum.noise_feature_size
smooth, report = spectral.filter_mesh(scan, feature_size=size)
print("warnings:", report["warnings"])
show({"scan": scan, "low-pass": smooth})

# %%
# See what was removed
# --------------------
# With ``result="details"`` the filter returns what it would take away. Along the normals,
# positive is outside:

details, _ = spectral.filter_mesh(
    scan.points, scan.regular_faces, feature_size=size, result="details"
)
removed = (details * smooth.point_normals).sum(axis=1) / edge
limit = np.percentile(np.abs(removed), 98)
show(
    {"removed, in edges": smooth.copy()},
    scalars=removed,
    cmap="RdBu_r",
    clim=(-limit, limit),
    scalar_bar_args={"vertical": True, "title": "", "fmt": "%.1f", "position_x": 0.86},
)

# %%
# All over the bunny it is noise; at the creases of ears and legs it is also shape, which a
# low-pass rounds.
#
# Equalize
# --------
# A gain for each size, joined by a smooth curve: here the body stays, the folds of the fur are
# doubled, and what is smaller than they are is removed. In MeshLab the sliders of *Spectral
# Equalizer* do the same, with a preview.

enhanced, _ = spectral.filter_mesh(
    scan, filter_type="custom", transfer_function="20%:1, 8%:2.2, 5%:2.2, 2.5%:0.1"
)
show({"low-pass": smooth, "equalized": enhanced})

# %%
# For a folder of scans
# ---------------------
# The same in the shell: save the options as a recipe, then filter the whole folder.
#
# .. code-block:: none
#
#    meshlab-spectral filter scan.ply smooth.ply --feature-size 5% --save-recipe smooth.toml
#    meshlab-spectral batch scans --output smooth --recipe smooth.toml
