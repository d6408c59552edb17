#!/bin/sh
# PyGEL 0.8.2: Manifold.principal_curvatures become 0 for meshes whose edges are shorter than a hundredth.
#
# The fit of a quadratic surface to the neighbours of a vertex has a term that does not go with the unit of length:
# edges of 1 give 1 / radius, edges of .005 a third of it, and edges of .0005, half a millimetre in metres, a
# twenty-thousandth. Nothing warns; Gaussian and mean curvature of the same class are right at any size. Scale the
# mesh first: curvatures are 1 / length.
#
# Seen: curvature times radius of icospheres of 642 vertices: 1.00 at radius 1, .98 at .1, .29 at .03, .0053 at .01
# and 4e-5 at .003; 1.00 by mean_curvature at each.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  PyGEL3D==0.8.2 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import trimesh
from pygel3d import hmesh

seen = {}
for radius in (1, 0.1, 0.03, 0.01, 0.003):
    sphere = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    mesh = hmesh.Manifold.from_triangles(sphere.vertices, sphere.faces)
    smallest = np.mean([mesh.principal_curvatures(v)[0] for v in mesh.vertices()]) * radius
    mean = np.mean([mesh.mean_curvature(v) for v in mesh.vertices()]) * radius
    seen[radius] = (round(float(smallest), 6), round(float(mean), 3))
print(seen)
assert all(abs(mean - 1) < 0.01 for _, mean in seen.values()), "this has changed"
assert abs(seen[1][0] - 1) < 0.01 and 0.2 < seen[0.03][0] < 0.4 and seen[0.003][0] < 1e-4, "this has changed"
END
