#!/bin/sh
# numpy-stl 4.1.1: Mesh.rotate and rotation_matrix turn clockwise, by minus the angle; transform does not.
#
# "Generate a 3x3 rotation matrix ... Euler-Rodrigues": its signs are those for rows that are multiplied from the left,
# and the coordinates are multiplied from the right. A part that is to be turned by 90 degrees about z points the
# other way, and one that is turned by the angle of another program, or of a matrix that `transform` takes, no longer
# fits. Give minus the angle. The documentation does not say it.
#
# Seen: (1, 0, 0), turned by 90 degrees about (0, 0, 1): (0, -1, 0) by rotate, (0, 1, 0) by transform with the matrix of
# that rotation, by trimesh and by SciPy.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  numpy-stl==4.1.1 trimesh==5.2.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import trimesh
from scipy.spatial.transform import Rotation
from stl.mesh import Mesh


def stl():
    data = np.zeros(1, dtype=Mesh.dtype)
    data["vectors"][0] = [[1, 0, 0], [2, 0, 0], [1, 0, 1]]
    return Mesh(data)


by_angle, by_matrix = stl(), stl()
matrix = trimesh.transformations.rotation_matrix(np.pi / 2, [0, 0, 1])
by_angle.rotate([0, 0, 1], np.pi / 2)
by_matrix.transform(matrix)
seen = [by_angle.vectors[0, 0], by_matrix.vectors[0, 0], matrix[:3, :3] @ [1, 0, 0]]
seen.append(Rotation.from_rotvec([0, 0, np.pi / 2]).apply([1, 0, 0]))
print(np.round(seen, 6).tolist())
assert np.allclose(seen[0], [0, -1, 0], atol=1e-6), "this has changed"
assert np.allclose(seen[1:], [0, 1, 0], atol=1e-6), "this has changed"
END
