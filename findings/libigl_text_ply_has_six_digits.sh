#!/bin/sh
# libigl 2.6.3: write_triangle_mesh writes six digits of a coordinate into PLY, by default, and seven into STL.
#
# Its default encoding is text. The header says "property double", the other text formats, OBJ and OFF, have all
# digits, and nothing warns. A scan in UTM coordinates, in metres, becomes a pile of points ten metres apart in its
# northing; a mesh in CT coordinates loses a thousandth of a millimetre.
# encoding=igl.FileEncoding.Binary keeps PLY whole.
#
# Seen: a sphere of radius 1 at (500000, 5000000, 0): its vertices are up to 1 unit off in PLY, .7 in STL, 5e-9 in
# OBJ and OFF, 0 in binary PLY; of 642 places 253 are left in the text.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  libigl==2.6.3 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
from pathlib import Path

import igl
import numpy as np
import trimesh

sphere = trimesh.creation.icosphere(subdivisions=3).apply_translation((500000, 5000000, 0))
vertices, faces = np.array(sphere.vertices), np.array(sphere.faces)
errors = {}
for name in ("a.ply", "a.stl", "a.obj", "a.off", "binary.ply"):
    kind = igl.FileEncoding.Binary if name == "binary.ply" else igl.FileEncoding.Ascii
    igl.write_triangle_mesh(name, vertices, faces, encoding=kind)
    V, F = igl.read_triangle_mesh(name)[:2]
    errors[name] = float(np.abs(V[F] - vertices[faces]).max())
igl.write_triangle_mesh("default.ply", vertices, faces)
assert Path("default.ply").read_bytes() == Path("a.ply").read_bytes(), "this has changed"
places = len(np.unique(igl.read_triangle_mesh("a.ply")[0], axis=0))
print(errors, places, "of", len(vertices))
assert b"property double x" in Path("a.ply").read_bytes()
assert errors["a.ply"] > 0.4 and 0.4 < errors["a.stl"] < 1 and places < len(vertices) / 2, "this has changed"
assert max(errors[name] for name in ("a.obj", "a.off", "binary.ply")) < 1e-8, "this has changed"
END
