#!/bin/sh
# meshio 5.3.5 and trimesh 5.2.0: faces of an OBJ with relative (negative) indices get other vertices.
#
# The format counts from 1, or back from the last vertex above the face: -1. trimesh counts back from the last
# vertex of the file, so that in a file of several objects, each with its vertices and faces, all faces are those
# of the last object. meshio does, too, and moreover subtracts 1, as from positive indices: -3 -2 -1 becomes
# -4 -3 -2, which NumPy takes from the end. Neither says anything; where there are few vertices, meshio's are out
# of range. pyvista reads such files right.
#
# Seen: of two triangles, at heights 0 and 5, trimesh has the upper one twice, meshio twice one that leads from 0
#   to 5.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  meshio==5.3.5 numpy==2.4.6 trimesh==5.2.0 pyvista==0.49.1 vtk==9.7.2
cd "$folder"
venv/bin/python - <<'END'
from pathlib import Path

import meshio
import pyvista
import trimesh

low = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\n"
Path("two.obj").write_text(low + low.replace(" 0\n", " 5\n"))
mesh = meshio.read("two.obj")
faces = mesh.cells_dict["triangle"]
heights = {
    "meshio": mesh.points[faces][..., 2].tolist(),
    "trimesh": trimesh.load("two.obj", process=False).triangles[..., 2].tolist(),
    "pyvista": (lambda one: one.points[one.regular_faces][..., 2].tolist())(pyvista.read("two.obj")),
}
print(faces.tolist(), heights)
assert heights["pyvista"] == [[0, 0, 0], [5, 5, 5]], "this has changed"
assert heights["trimesh"] == 2 * [[5, 5, 5]], "this has changed"
assert faces.tolist() == 2 * [[-4, -3, -2]], "this has changed"
assert heights["meshio"] == 2 * [[0, 5, 5]], "this has changed"
END
