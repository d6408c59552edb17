#!/bin/sh
# surfa 0.6.3: smooth_overlay carries values along an open boundary, to one side.
#
# A vertex hears the neighbours to which an edge of a face leads from it. Inside a surface each edge leads both ways;
# along a boundary there is one face, so each vertex hears the next one and not the one before. Values on
# the rim of a patch, or of a cortex without its medial wall, move around it, by a quarter of an edge in the first
# iteration. remove_self_intersections moves vertices by such weights, too. Closed surfaces are smoothed right.
#
# Seen: a value of 1 at the middle of a side of 41 x 41 vertices: after one iteration one neighbour on the side
# has .167 (without weights by length), the other 0; after 20 the centre of what is on the side is 1.6 edges away. A
# value at the centre of the square stays there.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  surfa==0.6.3 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
import surfa

n = 41
x, y = (grid.ravel() for grid in np.meshgrid(np.arange(n), np.arange(n)))
index = np.arange(n * n).reshape(n, n)
a, b, c, d = index[:-1, :-1].ravel(), index[:-1, 1:].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel()
mesh = surfa.Mesh(np.c_[x, y, 0 * x].astype(float), np.r_[np.c_[a, b, d], np.c_[a, d, c]])


def smooth(row, iterations):
    """What is left in a row of vertices of a value of 1 at its middle."""
    value = np.zeros(n * n)
    value[index[row, n // 2]] = 1
    smoothed = mesh.smooth_overlay(surfa.Overlay(value), iters=iterations, weighted=False)
    return np.asarray(smoothed.data).reshape(n, n)[row]


shifts = {}
for row in (0, n // 2):
    values = smooth(row, 20)
    shifts[row] = (values * (np.arange(n) - n // 2)).sum() / values.sum()
once = smooth(0, 1)[n // 2 - 1 : n // 2 + 2]
print(shifts, once)
assert min(once[0], once[2]) == 0 and 0.1 < max(once[0], once[2]) < 0.3, "this has changed"
assert 1 < abs(shifts[0]) < 3 and abs(shifts[n // 2]) < 1e-9, "this has changed"
END
