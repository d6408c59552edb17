#!/bin/sh
# Open3D 0.20.0: simplify_quadric_decimation of a mesh in world coordinates puts vertices far off the surface.
#
# Errors are quadratic forms around the origin of the coordinates: at a northing of five million their terms are
# 1e13 times a square metre, and what is left of double precision is noise for details of a metre or less. Vertices are
# placed by it, and stand out as spikes. Nothing warns; a mean is hardly changed. Subtract an origin first.
#
# Seen: a sphere of radius 1 m, from 5,120 triangles to 1,000: distances from its centre .996 to .999 at the origin, .994
# to 1.33 at (500000, 5000000, 0), with an area 19 % larger; by fast-simplification 1.00 to 1.02 there.
# Needs: python3.11 (or 3.10 to 3.13) with venv, a package index, libgl1, libgomp1; 1 GB of disk.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  open3d==0.20.0 fast-simplification==0.2.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import fast_simplification
import numpy as np
import open3d
import trimesh

sphere = trimesh.creation.icosphere(subdivisions=4)
seen = {}
for offset in ((0.0, 0.0, 0.0), (500000.0, 5000000.0, 0.0)):
    vertices = open3d.utility.Vector3dVector(sphere.vertices + offset)
    mesh = open3d.geometry.TriangleMesh(vertices, open3d.utility.Vector3iVector(sphere.faces))
    decimated = np.asarray(mesh.simplify_quadric_decimation(1000).vertices)
    other = fast_simplification.simplify(sphere.vertices + offset, np.array(sphere.faces), target_count=1000)[0]
    seen[offset] = []
    for name, points in (("Open3D", decimated), ("fast-simplification", other)):
        radii = np.linalg.norm(points - offset, axis=1)
        seen[offset].append((radii.min(), radii.max()))
        print(offset, name, radii.min(), radii.max())
(near, _), (far, far_by_other) = seen.values()
assert 0.98 < near[0] and near[1] < 1.01, "this has changed"
assert far[1] > 1.15 and 0.98 < far_by_other[0] and far_by_other[1] < 1.05, "this has changed"
END
