#!/bin/sh
# vtk 9.7.2 by pyvista 0.49.1: coordinates that a PLY has as double are read in single precision.
#
# vtkPLYReader makes floats of them, without a message; vtkOBJReader keeps the doubles of
# the same mesh. Of a scan in UTM coordinates, in metres, with a northing of five million, a quarter of a metre
# is lost. trimesh and meshio keep doubles. Subtract an origin first, or read by one of them.
#
# Seen: largest error 0.24 from PLY, 0 from OBJ; trimesh and meshio 0 from PLY.
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
import numpy as np
import pyvista
import trimesh

sphere = trimesh.creation.icosphere(subdivisions=2)
points = np.array(sphere.vertices) + [500000.0, 5000000.0, 0.0]
rows = [" ".join(f"{x:.17g}" for x in p) for p in points]
faces = np.array(sphere.faces)
properties = "".join(f"property double {axis}\n" for axis in "xyz")
text = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n{properties}element face {len(faces)}\n"
text += "property list uchar int vertex_indices\nend_header\n" + "\n".join(rows) + "\n"
Path("a.ply").write_text(text + "".join("3 {} {} {}\n".format(*f) for f in faces))
obj = [f"v {row}" for row in rows] + ["f {} {} {}".format(*f) for f in faces + 1]
Path("a.obj").write_text("\n".join(obj) + "\n")
seen = {
    "vtk, PLY": pyvista.read("a.ply").points,
    "vtk, OBJ": pyvista.read("a.obj").points,
    "trimesh, PLY": trimesh.load("a.ply", process=False).vertices,
    "meshio, PLY": meshio.read("a.ply").points,
}
errors = {name: float(np.abs(np.asarray(P, float) - points).max()) for name, P in seen.items()}
print(errors)
assert 0.2 < errors.pop("vtk, PLY") < 0.3, "this has changed"
assert set(errors.values()) == {0.0}, "this has changed"
END
