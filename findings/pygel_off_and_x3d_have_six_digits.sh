#!/bin/sh
# PyGEL 0.8.2: coordinates are saved with six digits in OFF and X3D, and with twenty in OBJ.
#
# Of a scan in UTM coordinates, in metres, whole metres are left, of one in state plane feet as much: surfaces become
# stairs, without a message; at a northing of five million steps of ten metres. Save OBJ, or subtract an origin first.
#
# Seen: the area of a sphere of radius 1 at (500000, 500000, 500000), 12.5: 12.506 from OBJ, 24 from OFF and from X3D;
# at the origin all three are within 1e-6 of it.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  PyGEL3D==0.8.2 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import trimesh
from pygel3d import hmesh

sphere = trimesh.creation.icosphere(subdivisions=3)
seen = {}
for offset in (0.0, 500000.0):
    mesh = hmesh.Manifold.from_triangles(sphere.vertices + offset, sphere.faces)
    for name in ("a.obj", "a.off", "a.x3d"):
        hmesh.save(name, mesh)
        seen[name, offset] = hmesh.area(hmesh.load(name)) / sphere.area
print(seen)
assert all(abs(seen[name, 0.0] - 1) < 1e-6 for name in ("a.obj", "a.off", "a.x3d")), "this has changed"
assert abs(seen["a.obj", 500000.0] - 1) < 1e-9, "this has changed"
assert seen["a.off", 500000.0] > 1.5 and seen["a.x3d", 500000.0] > 1.5, "this has changed"
END
