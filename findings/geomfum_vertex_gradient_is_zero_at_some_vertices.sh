#!/bin/sh
# geomfum 1.0.0: Gradient, at the vertices, is 0 at some vertices and shrinks with the unit of length.
#
# It fits a plane to the differences along the edges that leave a vertex, and shape.edges has every edge once, from
# its lower to its higher index: a vertex with the highest index around has none, so its gradient is 0, and others
# hear a part of their neighbours. The fit adds 1e-5 to squared lengths, whatever the unit, so that edges of a
# thousandth (a millimetre, in metres) leave a fraction of the slope.
#
# Seen: the function x on a square of 10 x 10 vertices, slope 1 everywhere: lengths 0 on the side of the highest
# indices and .999 elsewhere; the same square in a unit a hundred times longer: at most .21.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps \
  geomfum==1.0.0 gsops==0.1.0 pyfmaps==1.3.1 potpourri3d==1.4.0 robust_laplacian==1.1.0 trimesh==5.2.0 \
  networkx==3.6.1 tqdm==4.70.1 meshio==5.3.5 rich==15.0.0 scikit-learn==1.9.1 joblib==1.6.0 cloudpickle==3.1.3 narwhals==2.29.0 \
  threadpoolctl==3.8.0 numpy==2.4.6 scipy==1.17.1
cd "$folder"
venv/bin/python - <<'END'
import numpy as np
from geomfum.operator import Gradient
from geomfum.shape import TriangleMesh

n = 10
x, y = (grid.ravel() / (n - 1) for grid in np.meshgrid(np.arange(n), np.arange(n)))
index = np.arange(n * n).reshape(n, n)
a, b, c, d = index[:-1, :-1].ravel(), index[:-1, 1:].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel()
F = np.r_[np.c_[a, b, d], np.c_[a, d, c]]
slopes = {}
for unit in (1, 0.01):
    V = np.c_[x, y, 0 * x] * unit
    slopes[unit] = np.linalg.norm(Gradient(TriangleMesh(V, F))(V[:, 0]), axis=-1)
    print(f"square of {unit}: slopes {slopes[unit].min():.3f} to {slopes[unit].max():.3f}, 0 at", (slopes[unit] == 0).sum())
assert (slopes[1] == 0).sum() == n, "this has changed"
assert np.isclose(slopes[1][slopes[1] > 0], 1, atol=0.01).all(), "this has changed"
assert slopes[0.01].max() < 0.3, "this has changed"
END
