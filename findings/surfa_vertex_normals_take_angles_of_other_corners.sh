#!/bin/sh
# surfa 0.6.3: Mesh.vertex_normals weights faces by the angles of other corners than the vertex's.
#
# Face normals are to be weighted by their angle at the vertex; the angles are put in another order before they are
# used, so that a face counts by an angle at one of its other vertices. The normals then depend on how the mesh was
# triangulated and on the order of its vertices, which such weights are there to avoid. Where triangles are nearly
# equilateral, as on a FreeSurfer surface, the error is small.
#
# Seen: at the corners of a cube, where the normal is the diagonal, errors of 28.1 or 29.5 degrees, by the order of
# the vertices; by trimesh, with weights of that kind, 0. On an icosphere of 642 vertices .8 degrees.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  surfa==0.6.3 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import surfa
import trimesh


def error(normals, truth):
    """The largest angle between two sets of unit vectors, in degrees."""
    return round(float(np.degrees(np.arccos(np.clip((normals * truth).sum(axis=1), -1, 1))).max()), 1)


errors = []
cube = trimesh.creation.box()
for seed in range(5):
    new = np.random.default_rng(seed).permutation(8)  # vertex i becomes new[i]
    vertices = cube.vertices[np.argsort(new)]
    faces = new[cube.faces]
    diagonals = np.sign(vertices) / np.sqrt(3)
    errors.append(error(surfa.Mesh(vertices, faces).vertex_normals, diagonals))
    assert error(trimesh.Trimesh(vertices, faces, process=False).vertex_normals, diagonals) == 0, "this has changed"
sphere = trimesh.creation.icosphere(subdivisions=3)
even = error(surfa.Mesh(sphere.vertices, sphere.faces).vertex_normals, sphere.vertices)
print(errors, even)
assert all(25 < one < 40 for one in errors) and even < 1, "this has changed"
END
