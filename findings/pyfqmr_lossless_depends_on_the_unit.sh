#!/bin/sh
# pyfqmr 0.5.0: simplify_mesh_lossless removes the more of a mesh the smaller the unit of its lengths.
#
# Its default epsilon, 1e-3, is compared with squared distances in the mesh's own units, not relative to its
# size. Of a sphere of 5,120 triangles that has a radius of 1000 none is removed; of radius 1 (metres, say) five
# sixths, of 0.01 all but a few dozen, and of 0.0001 every one: the result is an empty mesh, without a message. Scale
# the mesh first, or give an epsilon that goes with the square of the size.
#
# Seen: 5120, 806, 30 and 0 triangles for radii of 1000, 1, 0.01 and 0.0001.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyfqmr==0.5.0 numpy==2.4.6 trimesh==5.2.0
cd "$folder"
venv/bin/python - <<'END'
import pyfqmr
import trimesh

seen = {}
for radius in (1000.0, 1.0, 0.01, 0.0001):
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    simplifier = pyfqmr.Simplify()
    simplifier.setMesh(sphere.vertices, sphere.faces)
    simplifier.simplify_mesh_lossless(verbose=False)
    seen[radius] = len(simplifier.getMesh()[1])
print(seen)
assert seen[1000.0] == 5120, "this has changed"
assert 600 < seen[1.0] < 1000 and 0 < seen[0.01] < 100 and seen[0.0001] == 0, "this has changed"
END
