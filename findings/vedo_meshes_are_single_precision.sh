#!/bin/sh
# vedo 2026.6.3: a Mesh that is made of doubles keeps single precision, so that far from the origin areas are wrong.
#
# The array is converted to float32 without a message; pyvista, on the same VTK, keeps its doubles. A mesh in UTM
# coordinates moves to a grid of half a metre, where area, volume and what is written are those of steps. Subtract an
# origin first, or make the mesh from a pyvista.PolyData.
#
# Seen: a sphere of radius 1 at (500000, 5000000, 0): vertices up to .24 off, its area 25 % and its volume 4.9 % too
# large; 4e-10 and less in pyvista, and in a vedo.Mesh that is made of that.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  vedo==2026.6.3 vtk==9.7.2 pyvista==0.49.1 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import pyvista
import trimesh
import vedo

sphere = trimesh.creation.icosphere(subdivisions=3).apply_translation((500000, 5000000, 0))
vertices, faces = np.array(sphere.vertices), np.array(sphere.faces)
surface = pyvista.PolyData.from_regular_faces(vertices, faces)
seen = {}
for name, mesh in (("arrays", vedo.Mesh([vertices, faces])), ("pyvista", vedo.Mesh(surface))):
    moved = float(np.abs(np.array(mesh.vertices, float) - vertices).max())
    seen[name] = str(mesh.vertices.dtype), moved, mesh.area() / sphere.area, mesh.volume() / sphere.volume
print(seen, surface.points.dtype)
assert surface.points.dtype == np.float64 and np.array_equal(surface.points, vertices)
assert seen["arrays"][0] == "float32" and seen["arrays"][1] > 0.2 and seen["arrays"][2] > 1.2, "this has changed"
assert seen["pyvista"][0] == "float64" and seen["pyvista"][1] == 0, "this has changed"
assert abs(seen["pyvista"][2] - 1) < 1e-6, "this has changed"
END
