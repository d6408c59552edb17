#!/bin/sh
# scikit-image 0.26.0: marching_cubes(spacing=...) returns the normals of cubic voxels.
#
# The vertices are multiplied by the spacing, but the normals, which are gradients, are not divided by it, by either
# method. Of a CT or MR scan whose slices are three times as far apart as its pixels they are off by up to 34 degrees:
# shading is, and whatever offsets or registers along them. Nothing warns. Divide them by the spacing and normalize, or
# compute them from the faces.
#
# Seen: largest angle between normals and radii of a sphere of 15 pixels: 2.1 degrees for a spacing of 1, 1, 1; 23 for
# 1, 1, 2; 34 for 1, 1, 3; divided by the spacing 2.1, 3.8 and 5.6.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  scikit-image==0.26.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
from skimage.measure import marching_cubes


def ball(spacing):
    """Distances inside a sphere of radius 15, at voxels of that spacing, and its centre."""
    counts = (60 / spacing * (2 / 3)).astype(int) + 1
    centre = spacing * (counts - 1) / 2
    steps = (np.arange(n) * step - c for n, step, c in zip(counts, spacing, centre))
    return 15 - np.linalg.norm(np.meshgrid(*steps, indexing="ij"), axis=0), centre


def angles(normals, points):
    """Degrees between the normals and the radii, whichever side the normals point to."""
    cosines = np.abs((normals * points).sum(axis=1))
    cosines = cosines / np.linalg.norm(normals, axis=1) / np.linalg.norm(points, axis=1)
    return np.degrees(np.arccos(cosines.clip(0, 1)))


largest = {}
for z in (1.0, 2.0, 3.0):
    spacing = np.array([1.0, 1.0, z])
    values, centre = ball(spacing)
    for method in ("lewiner", "lorensen"):
        vertices, _, normals, _ = marching_cubes(values, 0, spacing=tuple(spacing), method=method)
        largest[z, method] = angles(normals, vertices - centre).max()
    largest[z, "divided"] = angles(normals / spacing, vertices - centre).max()
print({key: round(float(angle), 1) for key, angle in largest.items()})
for method in ("lewiner", "lorensen"):
    assert largest[1.0, method] < 3, "this has changed"
    assert 20 < largest[2.0, method] < 26 and 30 < largest[3.0, method] < 38, "this has changed"
assert largest[3.0, "divided"] < 7, "this has changed"
END
