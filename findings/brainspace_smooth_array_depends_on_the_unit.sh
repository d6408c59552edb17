#!/bin/sh
# brainspace 0.3.0: smooth_array, by its default Gaussian kernel, smooths by the unit of length, or makes all NaN.
#
# "Gaussian kernel width. If None, use standard deviation of edge lengths": it is that of the squared lengths, so
# the exponent, length^2 over its square, has the unit 1 / length^2. Of a surface in millimetres all neighbours count
# alike; of the same one in centimetres the shorter edges count more; in metres every weight is 0 and every value
# becomes NaN, by 0 / 0. Give sigma, or another kernel: both are free of the unit.
#
# Seen: noise on a sphere, five iterations: .418 of it is left at radius 100, .469 at radius 10, NaN everywhere at
# radius .1, with NumPy's warning of a division by zero; .42 at all three for the kernels "uniform" and
# "inverse_distance", and for a sigma of the mean edge.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps \
  brainspace==0.3.0 vtk==9.6.2 nibabel==5.4.2 typing_extensions==4.16.0 scikit-learn==1.9.1 joblib==1.6.0 \
  threadpoolctl==3.8.0 cloudpickle==3.1.3 narwhals==2.29.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import trimesh
from brainspace.mesh.array_operations import smooth_array
from brainspace.mesh.mesh_creation import build_polydata

seen = {}
for radius in (100, 10, 0.1):
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    surface = build_polydata(np.array(mesh.vertices), np.array(mesh.faces))
    noise = np.random.default_rng(1).normal(size=len(mesh.vertices))
    for name, options in {
        "default": {},
        "sigma": {"sigma": mesh.edges_unique_length.mean()},
        "uniform": {"kernel": "uniform"},
        "inverse_distance": {"kernel": "inverse_distance"},
    }.items():
        smooth = smooth_array(surface, noise.copy(), **options)
        seen[name, radius] = float(smooth.std() / noise.std())
        if np.isnan(smooth).any():
            assert np.isnan(smooth).all(), "this has changed"
print({f"{name} {radius}": round(left, 3) for (name, radius), left in seen.items()})
for name in ("sigma", "uniform", "inverse_distance"):
    assert np.isclose(seen[name, 100], seen[name, 0.1], rtol=1e-6), "this has changed"
    assert np.isclose(seen[name, 10], seen[name, 0.1], rtol=1e-6), "this has changed"
assert seen["default", 10] > seen["default", 100] + 0.02, "this has changed"
assert np.isnan(seen["default", 0.1]), "this has changed"
END
