#!/bin/sh
# libigl 2.6.3: read_triangle_mesh returns no faces of a Medit .mesh file that write_triangle_mesh has written.
#
# The triangles are in the file, with an empty list of tetrahedra; read_triangle_mesh takes the boundary of those and
# does not look at the triangles: vertices without faces, and no error. Both functions list the format. Other libraries
# read the file; write OFF or OBJ.
#
# Seen: of 162 vertices and 320 faces 162 and 0 by libigl, 320 by meshio; 320 by both in OFF.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  libigl==2.6.3 meshio==5.3.5 rich==15.0.0 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import igl
import meshio
import numpy as np
import trimesh

sphere = trimesh.creation.icosphere(subdivisions=2)
seen = {}
for name in ("a.mesh", "a.off"):
    igl.write_triangle_mesh(name, np.array(sphere.vertices), np.array(sphere.faces))
    V, F = igl.read_triangle_mesh(name)[:2]
    seen[name] = len(V), len(F), len(meshio.read(name).cells_dict["triangle"])
print(seen)
assert seen["a.off"] == (162, 320, 320)
assert seen["a.mesh"] == (162, 0, 320), "this has changed"
END
