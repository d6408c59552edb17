#!/bin/sh
# LaPy 1.7.0: TriaMesh.curvature() returns "curvature values" that do not depend on the size of the surface, halve
# with every subdivision, and are negative where it is convex.
#
# Edges are weighted by length over mean length, and sums are divided by the number of edges, not by an area: the
# values are mean angles between faces. Directions are right; values cannot be compared between meshes. On meshes
# of even triangles, divide by about -half the mean edge to get the mean curvature.
#
# Seen: mean curvature of spheres of radius 1, 2 and 10: -.0417 each (1, .5 and .1); divided once more -.0214.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check lapy==1.7.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import trimesh
from lapy import TriaMesh


def mean_curvature(radius, subdivisions):
    """Of an icosphere, as curvature() gives it; 1 / radius is right."""
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    sphere = TriaMesh(np.array(mesh.vertices), np.array(mesh.faces))
    assert sphere.volume() > 0  # normals point outwards
    return sphere.curvature()[4].mean()


sizes = [mean_curvature(radius, 3) for radius in (1, 2, 10)]
finer = mean_curvature(1, 4)
print("radius 1, 2, 10:", np.round(sizes, 4), "finer, radius 1:", round(finer, 4))
assert np.allclose(sizes, sizes[0]), "this has changed"
assert -0.05 < sizes[0] < -0.03, "this has changed"
assert np.isclose(finer / sizes[0], 0.5, atol=0.05), "this has changed"
END
