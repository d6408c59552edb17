#!/bin/sh
# fast-simplification 0.2.0: meshes in small units, such as nanometres, are not simplified, without a message.
#
# Its bounds on an edge's error grow from 1e-9 to a few million by the iteration and are compared with squared
# lengths, not relative to the size of the mesh. Beyond edges of some thousands fewer or no edges are below them, and
# the mesh comes back whole, whatever target_reduction or target_count say; a neuron in nanometres is of that size.
# trimesh.simplify_quadric_decimation calls it. Scale the mesh first, or give agg=10, its most aggressive.
#
# Seen: a sphere of 5,120 triangles, to be reduced to 1,000: 1,000 at radius 1 and 10,000, 1,630 at 30,000, all 5,120
# at 100,000, by trimesh as well; with agg=10 1,000 at each.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  fast-simplification==0.2.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import fast_simplification
import numpy as np
import trimesh

seen = {}
for radius in (1, 10_000, 30_000, 100_000):
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    vertices, faces = np.array(sphere.vertices), np.array(sphere.faces)
    seen[radius] = (
        len(fast_simplification.simplify(vertices, faces, target_count=1000)[1]),
        len(sphere.simplify_quadric_decimation(face_count=1000).faces),
        len(fast_simplification.simplify(vertices, faces, target_count=1000, agg=10)[1]),
    )
print(seen)
assert seen[1] == seen[10_000] == (1000, 1000, 1000), "this has changed"
assert seen[100_000] == (5120, 5120, 1000) and 1200 < seen[30_000][0] < 2500, "this has changed"
END
