#!/bin/sh
# Open3D 0.20.0: a GLB file that it has written, it reads back as a mesh of nothing.
#
# write_triangle_mesh puts the numbers into the JSON part, as a base64 text, and leaves out the binary part. The format
# allows that, but Open3D's own reader looks for the binary part: a warning of a "buffer view out of range", an
# empty mesh and no error. trimesh reads the file; Open3D reads one by trimesh. Write PLY, or GLB by another library.
#
# Seen: of 642 vertices 0 by Open3D and 642 by trimesh; one binary chunk in trimesh's file, none in Open3D's.
# Needs: python3.11 (or 3.10 to 3.13) with venv, a package index, libgl1, libgomp1; 1 GB of disk.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  open3d==0.20.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
from pathlib import Path

import open3d
import trimesh

sphere = trimesh.creation.icosphere(subdivisions=3)
vertices = open3d.utility.Vector3dVector(sphere.vertices)
mesh = open3d.geometry.TriangleMesh(vertices, open3d.utility.Vector3iVector(sphere.faces))
assert open3d.io.write_triangle_mesh("open3d.glb", mesh)
sphere.export("trimesh.glb")
seen = {}
for name in ("open3d.glb", "trimesh.glb"):
    ours = len(open3d.io.read_triangle_mesh(name).vertices)
    seen[name] = ours, len(trimesh.load(name, force="mesh").vertices), Path(name).read_bytes().count(b"BIN\0")
print(seen)
assert seen == {"open3d.glb": (0, 642, 0), "trimesh.glb": (642, 642, 1)}, "this has changed"
END
