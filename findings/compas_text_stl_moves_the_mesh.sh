#!/bin/sh
# compas 2.15.1: Mesh.to_stl moves the mesh when it writes text, which is its default.
#
# If any coordinate is negative, all three axes are shifted so that the least coordinates are 0: an old rule of the
# format, that no other program keeps. With binary=True nothing moves. Neither the method's documentation nor a
# message says so, and the shift is not in the file: scans or teeth that were aligned, and a mask with its surface,
# no longer fit, and a mesh without negative coordinates beside them stays where it is.
#
# Seen: a sphere of radius 1 at (100, 0, -5) is written at (1, 1, 1), and read there by compas and trimesh; in
# binary, or as OBJ, at (100, 0, -5); one at (10, 20, 30) stays there.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check compas==2.15.1 trimesh==5.2.0 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import trimesh
from compas.datastructures import Mesh

seen = {}
sphere = trimesh.creation.icosphere(subdivisions=2)
for centre in ((100, 0, -5), (10, 20, 30)):
    mesh = Mesh.from_vertices_and_faces((sphere.vertices + centre).tolist(), sphere.faces.tolist())
    mesh.to_stl("text.stl")
    mesh.to_stl("binary.stl", binary=True)
    mesh.to_obj("a.obj")
    for name in ("text.stl", "binary.stl", "a.obj"):
        seen[centre, name] = trimesh.load(name).bounds.mean(axis=0).round(3).tolist()
    seen[centre, "text.stl, compas"] = np.round(Mesh.from_stl("text.stl").centroid(), 3).tolist()
for key, at in seen.items():
    print(*key, "is at", at)
    moved = key[0] == (100, 0, -5) and key[1].startswith("text.stl")
    assert np.allclose(at, (1, 1, 1) if moved else key[0], atol=1e-3), "this has changed"
END
