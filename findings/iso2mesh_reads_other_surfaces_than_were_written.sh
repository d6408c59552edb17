#!/bin/sh
# iso2mesh 0.6.7 (Python): readgts turns faces over, and readobjmesh halves quadrilaterals and drops vertices.
#
# Of a GTS face it sorts the three vertices by their index, and the orientation is gone, also from its own savegts:
# normals point to both sides, and volumes are sums of both signs. Of an OBJ face it takes three corners, so that half
# of every quadrilateral is a hole; a vertex with an exponent that has a plus, as %g writes a million, is no match and
# is left out, and faces then name other vertices. Nothing warns. Read OBJ by another library; reorient after GTS.
#
# Seen: a sphere of volume 4.05 has 0 after savegts and readgts; of a box of 6 quadrilaterals half of the area is left;
# of a triangle with a corner at 1e+06 two vertices.
# Needs: python3 (3.10 or later) with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  iso2mesh==0.6.7 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python -W ignore - <<'END'
from pathlib import Path

import numpy as np
import trimesh
from iso2mesh.io import readgts, readobjmesh, savegts

sphere = trimesh.creation.icosphere(subdivisions=2)
savegts(np.array(sphere.vertices), np.array(sphere.faces) + 1, "sphere.gts")
vertices, faces = readgts("sphere.gts")[:2]
gts = trimesh.Trimesh(vertices, faces - 1, process=False)
same = np.array_equal(np.sort(gts.faces, axis=1), np.sort(sphere.faces, axis=1))
print(f"GTS: the same faces: {same}, volume {gts.volume:.3f} of {sphere.volume:.3f}")
assert same and abs(gts.volume) < 0.1, "this has changed"

corners = [f"v {i & 1} {i >> 1 & 1} {i >> 2}" for i in range(8)]
quads = ["f 1 3 4 2", "f 5 6 8 7", "f 1 2 6 5", "f 3 7 8 4", "f 1 5 7 3", "f 2 4 8 6"]
Path("box.obj").write_text("\n".join(corners + quads) + "\n")
vertices, faces = readobjmesh("box.obj")
box = trimesh.Trimesh(vertices, faces - 1, process=False)
peer = trimesh.load("box.obj", force="mesh")
print(f"OBJ: area {box.area} of {peer.area}, {len(box.faces)} triangles of {len(peer.faces)}")
assert (box.area, peer.area) == (3, 6), "this has changed"

Path("far.obj").write_text("v 0 0 0\nv %g 0 0\nv 0 1 0\nf 1 2 3\n" % 1e6)
far = len(readobjmesh("far.obj")[0]), len(trimesh.load("far.obj", force="mesh").vertices)
print("vertices of a triangle, by iso2mesh and trimesh:", far)
assert far == (2, 3), "this has changed"
END
