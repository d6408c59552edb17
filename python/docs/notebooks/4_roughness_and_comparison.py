"""
Roughness, and what a filter changed
====================================

How rough a surface is, with the terms of ISO 25178-2 on any shape, and what a filter moved.
"""

from pathlib import Path

import meshlab_spectral as spectral
import numpy as np
import pymeshlab
import pyvista

samples = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
bunny = pyvista.read(samples / "bunny.obj")
V, F = np.asarray(bunny.points, dtype=float), bunny.regular_faces

# %%
# Roughness
# ---------
# What is larger than the nesting index of the *L-filter* is waviness, what is smaller than that of
# the *S-filter* is noise, and the *F-operator* takes the form: what varies more slowly than
# ``form_size``, or the nearest plane, sphere or cylinder. The *S-L surface* between them is the
# roughness: of the bunny, its fur.

texture = spectral.surface_texture(V, F, waviness="3%")
figure = spectral.plot_texture(V, F, texture, "bunny")

# %%
# Sa and Sq are the mean and the root mean square height, Sz the distance from the deepest valley,
# Sv, to the highest peak, Sp, all in the units of the mesh. Ssk below 0 tells of more valleys than
# peaks, Sku above 3 of few, but high ones. Sdq is the slope, Sdr the area that the roughness adds.
# Of the bearing curve, the heights that 10, 50 and 90 % of the area exceed:

for name in ("Sa", "Sq", "Sz", "Ssk", "Sku", "Sdq", "Sdr"):
    print(f"{name:4} {getattr(texture, name):.4g}")
print(texture.bearing_heights[[10, 50, 90]])

# %%
# What is within a cutoff of a boundary or a crease is left out, and so are parts thinner than it. A
# cutoff should be well below the radius of what is measured.

print(texture.vertices_evaluated, texture.vertices_left_out, texture.vertices_too_thin)

# %%
# What a filter changed
# ---------------------
# With the same faces each vertex is compared with itself; other meshes by the signed distances
# between them. Positive is outside of the first.

smooth, _ = spectral.filter_mesh(V, F, feature_size="6%")
change = spectral.compare((V, F), (smooth, F))
deviation = change.deviations["normal"]
print(f"rms {deviation.rms:.2g}, largest {deviation.largest:.2g}")
figure = spectral.plot_comparison(change, ("bunny", "smooth"))
