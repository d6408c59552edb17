#!/bin/sh
# vmtk 1.5.2: vmtksurfacearraysmoothing averages values with those of vertices that are no neighbours.
#
# Neighbours come from vtkExtractEdges, which numbers points anew, in the order in which edges meet them; the numbers
# are then used for the array of the surface. The result depends on the order of vertices and faces, and what is smooth
# becomes noise. Connexity=2 searches around the same vertex again, so that it is 1. Nothing warns. Smooth by another
# library, or number the vertices in the order of the faces first.
#
# Seen: the height z on a sphere of 642 vertices, one iteration: off by .63 of its spread, by .94 for the same sphere
# with its vertices in random order and by .02 in the order of first use. Both values of Connexity give the same.
# Needs: python3.12 (or later) with venv, a package index; 1 GB of disk.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.12 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  vmtk==1.5.2 vtk==9.6.2 pyvista==0.49.1 trimesh==5.2.0 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import pyvista
import trimesh
from vmtk import vmtkscripts

sphere = trimesh.creation.icosphere(subdivisions=3)


def smoothed(vertices, faces, values, connexity=1):
    script = vmtkscripts.vmtkSurfaceArraySmoothing()
    script.Surface = pyvista.PolyData.from_regular_faces(vertices, faces)
    script.Surface["values"] = values.copy()
    script.SurfaceArrayName, script.Connexity = "values", connexity
    script.Iterations, script.Relaxation = 1, 1.0
    script.Execute()
    return np.array(script.Surface["values"])


def renumbered(order):
    """The sphere with its vertices in that order."""
    return sphere.vertices[order], np.argsort(order)[sphere.faces]


_, first = np.unique(sphere.edges.ravel(), return_index=True)
orders = {
    "as made": np.arange(642),
    "random": np.random.default_rng(0).permutation(642),
    "by first use": np.argsort(first),
}
error = {}
for name, order in orders.items():
    vertices, faces = renumbered(order)
    height = vertices[:, 2]
    error[name] = (smoothed(vertices, faces, height) - height).std() / height.std()
vertices, faces = renumbered(orders["as made"])
print({name: round(float(e), 2) for name, e in error.items()})
assert error["by first use"] < 0.05
assert error["as made"] > 0.3 and error["random"] > 0.8, "this has changed"
both = [smoothed(vertices, faces, vertices[:, 0] ** 3, connexity) for connexity in (1, 2)]
assert np.array_equal(*both), "this has changed"
END
