#!/bin/sh
# mouette 1.2.8: area_weight_matrix, "diagonal matrix of vertex areas", sums to three times the surface's area.
#
# Every corner gets the whole area of its triangle, not a third. laplacian() has the usual halves of
# cotangents, so with both the eigenvalues of any surface are a third of the right ones: of a unit sphere .67 and
# 1.99 for l (l + 1) = 2 and 6. Divide the matrix by 3.
#
# Seen: areas of 37.52 on an icosphere of area 12.51; eigenvalues 0, 3 times .667, 5 times 1.989.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check mouette==1.2.8 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import mouette
import numpy as np
from scipy.sparse.linalg import eigsh

sphere = mouette.procedural.icosphere(3)
V = np.array(sphere.vertices)
F = np.array(sphere.faces)
sides = V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]
area = np.linalg.norm(np.cross(*sides), axis=1).sum() / 2
W = mouette.operators.laplacian(sphere)
D = mouette.operators.area_weight_matrix(sphere)
total = D.diagonal().sum()
radius2 = (V**2).sum(axis=1).mean()
eigenvalues = eigsh(W, 9, D, sigma=-0.01)[0] * radius2
print(f"area {area:.2f}, vertex areas {total:.2f}, eigenvalues", np.round(eigenvalues, 3))
assert np.isclose(total, 3 * area), "this has changed"
assert np.allclose(3 * eigenvalues[1:4], 2, rtol=0.02), "this has changed"
assert np.allclose(3 * eigenvalues[4:], 6, rtol=0.02), "this has changed"
END
