#!/bin/sh
# pyntcloud 0.3.1: to_file appends to an OBJ that exists, and the faces of the new mesh then show the old one.
#
# The lines of the new vertices and faces follow those in the file, and the faces count from 1 again, which is the
# first vertex of the old mesh. So a scan that is saved twice, or after a correction, is the old one, with unused
# vertices; without faces, the cloud is the sum of all that was ever saved. Nothing warns. Remove the file first.
#
# Seen: a mesh of 42 vertices and 80 faces, saved, doubled in size and saved again: 84 vertices, 160 faces, and a
# surface of the old area, twice; as points 42 and 84.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  pyntcloud==0.3.1 pandas==3.1.1 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import pandas as pd
import trimesh
from pyntcloud import PyntCloud

sphere = trimesh.creation.icosphere(subdivisions=1)
faces = pd.DataFrame(np.array(sphere.faces), columns=["v1", "v2", "v3"])
sizes, areas, clouds = [], [], []
for size in (1.0, 2.0):
    points = pd.DataFrame(np.array(sphere.vertices) * size, columns=["x", "y", "z"])
    PyntCloud(points, mesh=faces).to_file("mesh.obj", also_save=["mesh"])
    read = trimesh.load("mesh.obj", process=False, maintain_order=True)
    sizes.append((len(read.vertices), len(read.faces)))
    areas.append(float(read.area / sphere.area))
    PyntCloud(points).to_file("points.obj")
    clouds.append(len(PyntCloud.from_file("points.obj").points))
print("vertices and faces", sizes, "areas", np.round(areas, 3), "points", clouds)
assert sizes[0] == (42, 80) and clouds == [42, 84], "this has changed"
assert sizes[1][1] == 160 and np.allclose(areas, (1, 2)), "this has changed"
END
